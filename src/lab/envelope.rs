//! The envelope of drop tests: the ranges from which the laboratory draws its drops, with their reasons.

/// The least and the greatest value.
pub(super) type Range = [f64; 2];

/// Length, m. Packages of 0.3 m to casks with limiters; \[P\] Table 3: 4.5 to 5.5.
pub(super) const LENGTH_M: Range = [0.3, 8.0];
/// Length over section. \[P\] Table 3: VHLW 3.9, ANF-18 7.0, ANF-10 8.4.
pub(super) const SLENDERNESS: Range = [2.0, 8.0];
/// Mass over length and squared section, kg/m³. \[P\] Table 3: ANF-10 950, VHLW 3500.
pub(super) const DENSITY_KG_M3: Range = [900.0, 3500.0];
/// Contact of either end, ms. \[P\] Fig. 13: 10; limiters that stop an end of 18 m/s at 70 g take 26 and the
/// rebound.
pub(super) const PULSE_MS: Range = [1.0, 45.0];
/// k of either end. \[P\] Table 3: from k → 0 with limiters to a clear rebound without.
pub(super) const RESTITUTION: Range = [0.05, 0.8];
/// Force plateau of either end, in one of three, over the elastic peak. Assumed: wood, foam and honeycomb
/// crush at a nearly constant force.
pub(super) const PLATEAU: Range = [0.5, 0.95];
/// First bending mode of an elastic body, Hz. Assumed: steel casks of 8 m to 1 m as free beams.
pub(super) const FIRST_BENDING_HZ: Range = [40.0, 600.0];
/// Damping of the modes of an elastic body. Assumed: between welded and bolted structures.
pub(super) const DAMPING: Range = [0.005, 0.03];
/// Transverse sensors. One at each end suffices; test laboratories use up to 23 in 21 planes (HAW/TB2).
pub(super) const SENSORS: Range = [2.0, 12.0];
/// Sensors around the skin from the lowest line, in steps of 90°. Planes of sensors at 0, 90 and 180° are
/// usual.
pub(super) const AROUND_DEG: [f64; 3] = [0.0, 90.0, 180.0];
/// Sample rate, Hz. Assumed: 25 samples a contact, and usual recorders.
pub(super) const RATES_HZ: [f64; 5] = [5e3, 1e4, 2e4, 5e4, 1e5];
/// Second recorder beside the first, in one of five, ms. Assumed: both begin at one trigger, within a few
/// samples.
pub(super) const CLOCK_MS: Range = [-0.1, 0.1];

#[cfg(test)]
mod tests {
    #[test]
    fn the_document_has_every_range_with_its_source() {
        let document = include_str!("../../docs/validation.md");
        let (ranges, _) = include_str!("envelope.rs").split_once("#[cfg(test)]").expect("ranges");
        let (mut words, mut count) = (String::new(), 0);
        for line in ranges.lines() {
            let values = line
                .split_once("] = [")
                .or_else(|| line.split_once(": Range = ["))
                .and_then(|(_, rest)| rest.strip_suffix("];"));
            if let Some(values) = values {
                let values: Vec<f64> =
                    values.split(", ").map(|value| value.parse().expect("a number")).collect();
                let (name, source) = words.trim().split_once(". ").expect("a name and a source");
                let source = source.trim_end_matches('.').replace('\\', "");
                let (low, high) = (values[0], values[values.len() - 1]);
                let row = format!("| {name} | {low} to {high} | {source} |");
                assert!(low < high && document.contains(&row), "docs/validation.md lacks\n{row}");
                count += 1;
            }
            words = line.strip_prefix("///").map_or_else(String::new, |more| words.clone() + more);
        }
        assert_eq!(count, 12);
    }
}
