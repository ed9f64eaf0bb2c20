//! Judges everything that the stages found: findings and a verdict.

mod across;
mod at_rest;
mod bandwidth;
mod blows;
mod channels;
mod closures;
mod copies;
mod coupling;
mod fall;
mod jumps;
mod late_blow;
mod limits;
mod missing;
mod others;
mod result;
mod rigid;
mod sampling;
mod separation;
mod silent;
mod skew;
mod taps;
mod tilt;

pub use across::{judge_across, judge_alone};
pub use at_rest::{
    LEAST_BEFORE_S, expected_peaks, hidden_causes, judge_chain, judge_levels, judge_record, pulse_lengths_s,
};
pub use bandwidth::judge_bandwidth;
pub use blows::{is_sharp, judge_blows};
pub use channels::{downgrade_harmless, is_cut_off, judge_channels, judge_noise, judge_places};
pub use closures::{MOST_U95_K, MOST_U95_SPEED, determines_lost_steps, judge_closures, judge_strained};
pub use copies::judge_copies;
pub use coupling::judge_coupling;
pub use fall::{judge_fall, judge_fall_time, judge_several_drops, judge_slowed};
pub use jumps::judge_jumps;
pub use late_blow::{changes_motion, judge_force_pause, judge_late_blow};
pub use limits::compare_limit;
pub use missing::{judge_no_impact, judge_no_slap_down, judge_overlap};
pub use others::{judge_other, judge_rate_level, judge_rotation, sort_other_channels_last};
pub use result::{
    compare_observed, is_restitution, judge_comparison, judge_motion, judge_observed, judge_pressed,
    judge_touch,
};
pub use rigid::{SensorPlace, judge_rigid, transverse_places};
pub use sampling::{fit_rate_hz, nothing_from_hz};
pub use separation::{judge_separation, judge_unresolved};
pub use silent::{judge_at_stop, judge_quiet, judge_silent};
pub use skew::judge_skew;
pub use taps::judge_taps;

use crate::data::{Events, Finding, Severity, Verdict};

/// Length of free fall before first contact that may determine the offset, s.
const OFFSET_WINDOW_S: f64 = 0.25;
/// Interval after the slap-down that its onset includes, s.
const ONSET_S: f64 = 2e-3;

/// Turns a local warning far from the drop into a note, since it does not affect the result.
pub fn weigh_by_distance(findings: &mut [Finding], events: &Events) {
    let Some(contact_s) = events.first_contact_s() else { return };
    let from_s = contact_s - OFFSET_WINDOW_S;
    let to_s = events.slap_down_s().map_or(f64::INFINITY, |t| t + ONSET_S);
    for finding in findings.iter_mut().filter(|f| f.effect.is_local()) {
        let is_far =
            finding.to_s.is_some_and(|to| to < from_s) || finding.from_s.is_some_and(|from| from > to_s);
        if is_far {
            finding.severity = Severity::Note;
        }
    }
}

/// Sorts the findings, errors first, and returns the verdict: any error fails, any warning asks for a review.
pub fn verdict(findings: &mut [Finding]) -> Verdict {
    findings.sort_by(|a, b| b.severity.cmp(&a.severity).then(a.code.cmp(&b.code)));
    match findings.first().map(|f| f.severity) {
        Some(Severity::Error) => Verdict::Fail,
        Some(Severity::Warning) => Verdict::Review,
        _ => Verdict::Pass,
    }
}
