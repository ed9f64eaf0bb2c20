//! Judges the set-up of the channels from their levels at rest before the drop.

use super::sampling::low_rate;
use crate::data::{
    AtRest, Axis, Channel, Coupling, Drop, ExpectedPeak, Finding, RestCause, RestFinding,
    STANDARD_GRAVITY_M_S2 as G, Signal,
};
use std::f64::consts::PI;

/// Largest accepted deviation of a level at rest, g: there an offset cannot be separated from a scale, and it
/// is removed in the free fall.
const MOST_OFF_G: f64 = 0.4;
/// Level below which a channel reads nothing, g.
const NOTHING_G: f64 = 0.05;
/// A factor explains a reading within this share.
const FACTOR_SHARE: f64 = 0.25;
/// Factors between units that are often confused, and typical factors of a wrong gain.
const UNITS: [f64; 4] = [G, 1.0 / G, 1000.0, 0.001];
const GAINS: [f64; 6] = [2.0, 0.5, 10.0, 0.1, 100.0, 0.01];

/// Durations of a first impact if none is stated, s: the longest with an impact limiter, the shortest of bare
/// contact.
const LIMITER_S: f64 = 0.02;
const BARE_S: f64 = 0.005;

/// Standard uncertainty of an offset that adds 0.05 m/s over contact and flight of 60 ms, m/s².
const MOST_U_OFFSET_M_S2: f64 = 0.83;

/// Shortest free fall in a recording before the impact, s.
pub const LEAST_BEFORE_S: f64 = 0.1;

/// Compares the levels at rest with gravity on each axis; an AC-coupled channel has none.
pub fn judge_levels(all: &[(&Channel, AtRest)], drop: &Drop) -> Vec<Finding> {
    let found = |(channel, rest): &(&Channel, AtRest)| {
        let (reads_g, expected_g) = (rest.level_m_s2 / G, drop.weight_m_s2(channel.axis) / G);
        let most_g = MOST_OFF_G + 2.0 * rest.u_m_s2 / G;
        let found = if rest.least_step_m_s2 == 0.0 {
            RestFinding::OneValue
        } else if !rest.is_still {
            RestFinding::Unsteady
        } else if channel.coupling == Coupling::Dc && (reads_g - expected_g).abs() > most_g {
            let cause = find_cause(channel.axis, reads_g, all, drop);
            RestFinding::Reads { reads_g, expected_g, most_g, cause }
        } else {
            return None;
        };
        Some(found.tag(&channel.name))
    };
    all.iter().filter_map(found).collect()
}

/// Lists the mistakes that this level cannot reveal: with any of them the channel could read the same, given
/// an offset.
pub fn hidden_causes(channel: &Channel, rest: AtRest, drop: &Drop) -> Vec<RestCause> {
    let reads_g = rest.level_m_s2 / G;
    let levels = other_levels(channel.axis, drop).into_iter();
    let hidden = levels.filter(|(makes_g, _)| channel.coupling == Coupling::Dc && is_near(reads_g, *makes_g));
    hidden.map(|(_, cause)| cause).collect()
}

/// Levels of a channel with its sign reversed, on the other axis, and without gravity, g.
fn other_levels(axis: Axis, drop: &Drop) -> [(f64, RestCause); 3] {
    let [own_g, across_g] = [axis, other_axis(axis)].map(|axis| drop.weight_m_s2(axis) / G);
    [(-own_g, RestCause::Sign), (across_g, RestCause::Axis), (0.0, RestCause::Nothing)]
}

fn other_axis(axis: Axis) -> Axis {
    if axis == Axis::Axial { Axis::Transverse } else { Axis::Axial }
}

fn is_near(reads_g: f64, expected_g: f64) -> bool {
    (reads_g - expected_g).abs() <= MOST_OFF_G
}

fn find_cause(axis: Axis, reads_g: f64, all: &[(&Channel, AtRest)], drop: &Drop) -> RestCause {
    let other_axis = other_axis(axis);
    let [expected_g, across_g] = [axis, other_axis].map(|axis| drop.weight_m_s2(axis) / G);
    let is_exchanged = |(other, rest): &&(&Channel, AtRest)| {
        let theirs_g = rest.level_m_s2 / G;
        other.axis == other_axis
            && is_near(reads_g, across_g)
            && !is_near(theirs_g, across_g)
            && is_near(theirs_g, expected_g)
    };
    if let Some((other, _)) = all.iter().find(is_exchanged) {
        return RestCause::Exchanged(other.name.clone());
    }
    if reads_g.abs() < NOTHING_G {
        return RestCause::Nothing;
    }
    let ratio = reads_g / expected_g;
    let units = UNITS.map(|factor| (factor, RestCause::Unit(ratio)));
    let factors = units.into_iter().chain(GAINS.map(|factor| (factor, RestCause::Gain(ratio))));
    let factors = factors.map(|(factor, cause)| ((ratio / factor - 1.0).abs(), cause));
    // Causes other than a factor may have an offset as well.
    let others = other_levels(axis, drop)
        .map(|(makes_g, cause)| (FACTOR_SHARE * (reads_g - makes_g).abs() / MOST_OFF_G, cause));
    let likeliest = factors.chain(others).min_by(|a, b| a.0.total_cmp(&b.0));
    likeliest.filter(|(off, _)| *off < FACTOR_SHARE).map_or(RestCause::Open, |(_, cause)| cause)
}

/// Longest and shortest duration of a first impact, s: as stated, else with a limiter and of bare contact.
pub fn pulse_lengths_s(drop: &Drop) -> (f64, f64) {
    let stated_s = drop.contact_duration_s;
    if stated_s > 0.0 { (stated_s, stated_s) } else { (LIMITER_S, BARE_S) }
}

/// Peaks of half sines that change the velocity by `step_m_s`, π/2 times the mean, the longest pulse
/// first   (47)
pub fn expected_peaks(step_m_s: f64, drop: &Drop) -> Vec<ExpectedPeak> {
    let (longest_s, shortest_s) = pulse_lengths_s(drop);
    let peak = |lasts_s| ExpectedPeak { lasts_s, peak_g: PI / 2.0 * step_m_s / lasts_s / G };
    [longest_s].into_iter().chain((shortest_s < longest_s).then_some(shortest_s)).map(peak).collect()
}

/// Compares offset, range and rate of a channel with the peaks of a first impact, the last one the shortest.
pub fn judge_chain(channel: &Channel, quiet: &Signal, peaks: &[ExpectedPeak]) -> Vec<Finding> {
    let range_g = channel.range_m_s2().map(|range_m_s2| range_m_s2 / G);
    let too_small = |(i, peak): (usize, &ExpectedPeak)| {
        let (range_g, ExpectedPeak { lasts_s: pulse_s, peak_g }) = (range_g?, *peak);
        let finding = RestFinding::Range { range_g, peak_g, pulse_s, is_sure: i == 0 };
        (range_g < peak_g).then(|| finding.tag(&channel.name))
    };
    let range = peaks.iter().enumerate().find_map(too_small);
    let rate =
        peaks.last().and_then(|peak| low_rate(&channel.name, channel.sample_rate_hz, peak.lasts_s, 1.0));
    let u_offset_m_s2 = quiet.u_offset_m_s2;
    let offset = RestFinding::OpenOffset { u95_g: 2.0 * u_offset_m_s2 / G };
    let offset = (u_offset_m_s2 > MOST_U_OFFSET_M_S2).then(|| offset.tag(&channel.name));
    [range, rate, offset].into_iter().flatten().collect()
}

/// Compares the record before and after its trigger with the free fall and the flight.
pub fn judge_record(before_s: Option<f64>, length_s: f64, needs_s: f64) -> Vec<Finding> {
    let Some(before_s) = before_s else { return Vec::new() };
    let after_s = length_s - before_s;
    let early = RestFinding::ShortPretrigger { before_s, least_s: LEAST_BEFORE_S };
    let late = RestFinding::ShortRecord { after_s, needs_s };
    let found = [(before_s < LEAST_BEFORE_S, early), (after_s < needs_s, late)];
    found.into_iter().filter(|(is_short, _)| *is_short).map(|(_, found)| found.into()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{FindingKind, example};

    /// Cause for a transverse channel at 15° that reads this, beside an axial one that reads correctly.
    fn of(reads_g: f64) -> Option<RestCause> {
        let drop = Drop::from_height(9.0, 15_f64.to_radians());
        let at_rest = |level_g: f64| AtRest {
            level_m_s2: level_g * G,
            u_m_s2: 0.0,
            is_still: true,
            least_step_m_s2: 0.1,
        };
        let across = example::channel(vec![]);
        let along = Channel { axis: Axis::Axial, name: "B1".into(), ..across.clone() };
        let found = judge_levels(&[(&across, at_rest(reads_g)), (&along, at_rest(0.259))], &drop);
        assert!(found.len() < 2, "{found:?}");
        match found.into_iter().next()?.what {
            FindingKind::Rest(RestFinding::Reads { cause, .. }) => Some(cause),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_reading_has_its_likeliest_cause() {
        for sound in [0.966, 0.7, 1.3] {
            assert_eq!(of(sound), None);
        }
        assert_eq!(of(-0.95), Some(RestCause::Sign));
        assert_eq!(of(0.27), Some(RestCause::Axis));
        assert_eq!(of(0.01), Some(RestCause::Nothing));
        assert!(matches!(of(9.47), Some(RestCause::Unit(_))));
        assert!(matches!(of(0.098), Some(RestCause::Unit(_))));
        assert!(matches!(of(9.67), Some(RestCause::Gain(_))));
        assert!(matches!(of(97.0), Some(RestCause::Gain(_))));
        assert_eq!(of(5.0), Some(RestCause::Open));
    }
}
