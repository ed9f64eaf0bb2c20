//! Finds a low-pass in the measuring chain below that of the report, from the noise of the free fall.

use crate::data::{Axis, ChannelFinding, Events, Finding, IssueCode, Signal};
use crate::numerics::as_f64;

/// Noise is filtered if it is this many times as dense below a corner as in the octave that begins an octave
/// above it, and beyond: 1/f gives 8. Of 267 channels of 65 simulated sound drops none exceeds 7.1; of 278
/// with a Butterworth low-pass of the second to eighth order below the report's cut-off, and the converter's
/// noise after it, 233 are named.
const LEAST_FALL: f64 = 12.0;
/// Noise below the corner is level: the means of its halves differ by less than this factor.
const LEVEL_FACTOR: f64 = 2.0;
/// Bands of the noise as factors of the corner: the level from the first to the second, the fall from the
/// third to the fourth, and beyond.
const LEVEL_FROM: f64 = 1.0 / 6.0;
const LEVEL_TO: f64 = 0.8;
const FALLEN_FROM: f64 = 2.0;
const FALLEN_TO: f64 = 4.0;
/// Fewest bins of a level, and the largest factor of the corner at which it begins: chance or a drift makes
/// one of fewer bins.
const FEWEST_BINS: usize = 3;
const BEGINS: f64 = 1.0 / 3.0;
/// A low-pass with −3 dB at f rises from 10 to 90 % within this factor / f, for any order.
const RISE_FACTOR: f64 = 0.35;

/// Names each transverse channel whose noise ends below `cutoff_hz`, the −3 dB frequency of the report's
/// low-pass; hum among the findings `found` hides its noise.
pub fn judge_bandwidth(
    signals: &[Signal],
    events: &Events,
    cutoff_hz: f64,
    found: &[Finding],
) -> Vec<Finding> {
    let Some((from_s, to_s)) = events.first_contact_s().zip(events.separation_s()) else { return Vec::new() };
    let has_hum =
        |s: &Signal| found.iter().any(|f| f.code == IssueCode::Hum && f.channel.as_ref() == Some(&s.name));
    let across = signals.iter().filter(|signal| signal.axis == Axis::Transverse && !has_hum(signal));
    let filtered = across.filter_map(|signal| {
        let corner_hz = corner_hz(&signal.noise_spectrum, cutoff_hz)?;
        let contact_s = to_s - from_s;
        // Share of a half sine as long as the contact that a low-pass of second order at that corner passes.
        let left = 1.0 / (1.0 + (0.5 / (contact_s * corner_hz)).powi(4)).sqrt();
        let rise_s = RISE_FACTOR / corner_hz;
        let finding = ChannelFinding::Filtered { corner_hz, cutoff_hz, rise_s, contact_s, lost: 1.0 - left };
        Some(finding.tag(&signal.name))
    });
    filtered.collect()
}

/// Frequency below `cutoff_hz` at which a spectrum of noise, as in [`Signal`], falls permanently to half of
/// its level.
fn corner_hz(spectrum: &[(f64, f64)], cutoff_hz: f64) -> Option<f64> {
    let between = |from_hz: f64, to_hz: f64| {
        let from = spectrum.partition_point(|bin| bin.0 < from_hz);
        &spectrum[from..spectrum.partition_point(|bin| bin.0 <= to_hz).max(from)]
    };
    let mean = |bins: &[(f64, f64)]| bins.iter().map(|bin| bin.1).sum::<f64>() / as_f64(bins.len().max(1));
    let corners = spectrum.iter().map(|bin| bin.0).take_while(|corner_hz| *corner_hz <= cutoff_hz);
    let falls = corners.filter_map(|corner_hz| {
        let level = between(LEVEL_FROM * corner_hz, LEVEL_TO * corner_hz);
        let [fallen, beyond] =
            [FALLEN_TO, f64::INFINITY].map(|to| between(FALLEN_FROM * corner_hz, to * corner_hz));
        let (first, second) = level.split_at(level.len() / 2);
        let is_level = level.len() >= FEWEST_BINS
            && level[0].0 <= BEGINS * corner_hz
            && mean(first) < LEVEL_FACTOR * mean(second);
        let fall = mean(level) / mean(fallen).max(mean(beyond)).max(f64::MIN_POSITIVE);
        (is_level && fallen.len() > 1 && fall > LEAST_FALL).then_some((fall, mean(level)))
    });
    let (_, level) = falls.max_by(|one, other| one.0.total_cmp(&other.0))?;
    let last = spectrum.iter().rposition(|bin| bin.1 > level / 2.0)?;
    spectrum.get(last + 1).map(|next| (spectrum[last].0 * next.0).sqrt()).filter(|hz| *hz < cutoff_hz)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{At, example};

    /// Bins a quarter apart from 20 Hz to 4 kHz of noise of this density.
    fn named(density: impl Fn(f64) -> f64) -> Option<f64> {
        let bins = std::iter::successors(Some(20.0), |hz| Some(hz * 1.25)).take_while(|hz| *hz < 4e3);
        let noise_spectrum = bins.map(|hz| (hz, density(hz))).collect();
        let signal = Signal { noise_spectrum, ..example::signal(1e4, vec![]) };
        let events = Events { separation: Some(At::exact(0.11)), ..example::events(0.1, 0.16) };
        let found = judge_bandwidth(&[signal], &events, 400.0, &[]);
        found.first().map(|found| match found.what {
            crate::data::FindingKind::Channel(ChannelFinding::Filtered { corner_hz, .. }) => corner_hz,
            _ => panic!("{found:?}"),
        })
    }

    #[test]
    fn noise_that_ends_below_the_reports_cut_off_is_filtered_and_no_other_is() {
        let low_pass =
            |corner_hz: f64, floor: f64| move |hz: f64| floor + 1.0 / (1.0 + (hz / corner_hz).powi(8));
        for corner_hz in [120.0, 200.0, 300.0] {
            let found_hz = named(low_pass(corner_hz, 0.01)).expect("named");
            assert!((found_hz / corner_hz - 1.0).abs() < 0.2, "{corner_hz} {found_hz}");
        }
        assert_eq!(named(low_pass(900.0, 0.01)), None, "above the report's");
        assert_eq!(named(low_pass(200.0, 0.2)), None, "the converter's noise hides it");
        assert_eq!(named(|_| 1.0), None);
        assert_eq!(named(|hz| 1.0 / hz), None, "1/f");
        assert_eq!(named(|hz| 1.0 / (hz * hz)), None, "a drift");
    }
}
