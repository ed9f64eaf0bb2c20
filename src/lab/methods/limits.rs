//! Compares each limit of the acceptance table with its measured value.

use super::references::{FINITE_ELEMENTS, OWN, References, built_in};
use super::ways::ALL_CLASSES;
use crate::data::Verdict;
use crate::lab::campaign::{BODIES, half_widths_off, is_missed};
use crate::lab::data::{CampaignRow, TrialDrop, TrialFate, TrialLimit, TrialMap, TrialPoint};
use crate::numerics::as_f64;
use crate::numerics::filter::LowPass;
use crate::numerics::robust::{mean_and_rms, quantile};
use std::f64::consts::PI;

/// Columns of the table: property, least, most, unit, reason.
const TABLE: &str = include_str!("../limits.tsv");

/// Measured value and the item that decides it; `None` if it could not be determined.
type Found = (Option<f64>, String);

/// Compares every limit with its measured value: those of the table, then a site's own recordings.
pub fn limits(
    points: &[TrialPoint],
    maps: &[TrialMap],
    campaign: &[CampaignRow],
    site: Option<&References>,
) -> Vec<TrialLimit> {
    let finite_elements = built_in(FINITE_ELEMENTS).unwrap_or_default();
    let found = |name: &str| match name.split_once(": ") {
        Some(("campaign", measured)) => measure_campaign(measured, campaign),
        Some(("map", measured)) => measure_maps(measured, maps),
        Some(("filter", _)) => (gain_at_300_hz(), String::new()),
        Some(("recordings", _)) => measure_own_recordings(),
        Some(("finite elements", measured)) => measure_elastic_bars(measured, &finite_elements),
        Some((family, class)) => (measure_points(family, class, points), String::new()),
        None => Found::default(),
    };
    let of_table = table().map(|limit| {
        let (value, which) = found(&limit.name);
        TrialLimit { value, which, ..limit }
    });
    of_table.chain(site.into_iter().flat_map(References::limits)).collect()
}

/// Limits of the table, without measured values.
fn table() -> impl Iterator<Item = TrialLimit> {
    let of_line = |line: &str| {
        let mut cells = line.split('\t');
        let mut next = || cells.next().unwrap_or_default().to_owned();
        TrialLimit {
            name: next(),
            least: next().parse().ok(),
            most: next().parse().ok(),
            unit: next(),
            reason: next(),
            ..TrialLimit::default()
        }
    };
    TABLE.lines().filter(|line| !line.is_empty() && !line.starts_with('#')).map(of_line)
}

/// Measures the program's default method: the 95th percentile of the error on a class, or the share of
/// intervals that hold the truth.
fn measure_points(family: &str, class: &str, points: &[TrialPoint]) -> Option<f64> {
    let taken = |class| points.iter().find(|p| p.is_default && p.family == family && p.class == class);
    if class == "held" { taken(ALL_CLASSES)?.held } else { Some(taken(class)?.p95_error) }
}

/// Measures random sound drops: the share with a body that passes or has no numbers, the wrong ones, or the
/// error of a quantity in half-widths.
fn measure_campaign(measured: &str, rows: &[CampaignRow]) -> Found {
    let has_passed = |row: &&CampaignRow| row.verdict == Some(Verdict::Pass);
    if let Some((what, body)) = measured.split_once(" of ") {
        let is_counted =
            |row: &CampaignRow| if what == "pass" { has_passed(&row) } else { !row.has_numbers() };
        let of_body = rows.iter().filter(|row| BODIES[usize::from(row.facts.elastic)] == body);
        let counts: Vec<f64> = of_body.map(|row| f64::from(u8::from(is_counted(row)))).collect();
        return (Some(100.0 * mean_and_rms(&counts).0), String::new());
    }
    if measured == "passed and wrong" {
        return count_and_list(rows.iter().filter(|row| is_missed(row)).map(|row| row.scene.to_string()));
    }
    let scored = rows.iter().filter(has_passed).filter_map(|row| row.quantities.get(measured));
    let mut off: Vec<f64> = scored.filter_map(half_widths_off).collect();
    off.sort_by(f64::total_cmp);
    (Some(quantile(&off, 0.95)).filter(|off| off.is_finite()), String::new())
}

/// A silent error counts from this many half-widths on: one just beyond its interval may be the one in
/// twenty.
pub(super) const SILENT_BY: f64 = 2.0;

/// Counts damages that went unnoticed although the recording shows them, whose largest size no finding named,
/// or whose harmless end leaves a drop with a body without sound intervals.
fn measure_maps(measured: &str, maps: &[TrialMap]) -> Found {
    let is_wrong = |drop: &TrialDrop| {
        drop.fate == TrialFate::Silent && drop.half_widths_off.is_some_and(|off| off > SILENT_BY)
    };
    let is_alarm = |drop: &TrialDrop, body: &str| {
        BODIES[usize::from(drop.is_elastic)] == body && drop.fate != TrialFate::Inside
    };
    let is_counted = |map: &&TrialMap| match (measured.strip_prefix("false alarms of "), measured) {
        (Some(body), _) => map.sizes.len() > 1 && map.sizes[0].drops.iter().any(|drop| is_alarm(drop, body)),
        (None, "silent though a record can tell") => {
            map.instead.is_empty() && map.sizes.iter().flat_map(|size| &size.drops).any(is_wrong)
        }
        _ => map.count_unnamed() > 0,
    };
    count_and_list(maps.iter().filter(is_counted).map(|map| map.name.clone()))
}

fn measure_own_recordings() -> Found {
    let Some(limits) = built_in(OWN) else { return Found::default() };
    let lost = limits.into_iter().filter(|limit| !limit.is_met());
    count_and_list(lost.map(|limit| {
        if limit.which.is_empty() { limit.name } else { format!("{}: {}", limit.name, limit.which) }
    }))
}

/// Property that counts the drops without a slap-down speed.
const NO_SPEED: &str = "no speed";

/// Measures drops of elastic bars: those without a slap-down speed, or the largest error of a quantity in
/// half-widths, and the drop with it.
fn measure_elastic_bars(measured: &str, limits: &[TrialLimit]) -> Found {
    let quantity = if measured == NO_SPEED { "slap_down_speed_m_s" } else { measured };
    let drops = limits.iter().filter_map(|limit| {
        let drop = limit.name.strip_suffix(quantity)?.strip_suffix(": ")?;
        Some((drop.to_owned(), limit.half_widths_off()))
    });
    if measured == NO_SPEED {
        return count_and_list(drops.filter(|(_, off)| off.is_none()).map(|(drop, _)| drop));
    }
    let known = drops.filter_map(|(drop, off)| Some((drop, off?)));
    known.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(drop, off)| (Some(off), drop)).unwrap_or_default()
}

/// Most names listed of failed items.
const MOST_NAMES: usize = 8;

/// Counts the names, and lists them.
fn count_and_list(names: impl Iterator<Item = String>) -> Found {
    let names: Vec<String> = names.collect();
    let listed = names.iter().take(MOST_NAMES).cloned().collect::<Vec<_>>().join(", ");
    let more = if names.len() > MOST_NAMES { ", …" } else { "" };
    (Some(as_f64(names.len())), format!("{listed}{more}"))
}

/// Gain of the class 180 filter for a sine of 300 Hz in the middle of a long record.
fn gain_at_300_hz() -> Option<f64> {
    const RATE_HZ: f64 = 1e5;
    let sine: Vec<f64> = (0..40_000).map(|i| (2.0 * PI * 300.0 * f64::from(i) / RATE_HZ).sin()).collect();
    let left = LowPass::with_cfc(180.0, RATE_HZ)?.apply(&sine);
    Some(left[18_000..22_000].iter().fold(0.0, |most, x| x.abs().max(most)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_the_table_is_a_limit_with_its_reason() {
        for limit in table() {
            assert!(limit.least.is_some() || limit.most.is_some(), "{}", limit.name);
            assert!(!limit.reason.is_empty() && !limit.unit.is_empty() && !limit.is_met(), "{}", limit.name);
        }
    }

    #[test]
    fn drops_of_elastic_bars_are_told_as_accepted() {
        let known = built_in(FINITE_ELEMENTS).expect("the recordings");
        for limit in table() {
            let Some(measured) = limit.name.strip_prefix("finite elements: ") else { continue };
            let (value, which) = measure_elastic_bars(measured, &known);
            assert!(TrialLimit { value, ..limit.clone() }.is_met(), "{measured}: {value:?} on {which}");
        }
    }

    #[test]
    fn the_class_passes_what_its_standard_says() {
        // |H|² of both passes is 1/2 at 300 Hz: 2.0775 times the class is the design frequency of each.
        assert!((gain_at_300_hz().expect("a filter") - std::f64::consts::FRAC_1_SQRT_2).abs() < 5e-3);
    }
}
