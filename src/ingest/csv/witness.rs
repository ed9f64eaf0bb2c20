//! What else a table says of its times to whether it bears them out.

use super::super::error::{self, IngestError};
use super::super::stated_rate::{Agreement, StatedRate, shown_hz};
use super::plan::Plan;
use crate::data::{Issue, IssueCode, Severity};
use std::path::Path;

/// What rounding is believed to do to the rate of a column of times at most: coarser ones give none.
const MOST_ROUNDING: f64 = 1e-2;

/// A warning where the header states another rate than the one that was taken, in Hz.
///
/// # Errors
/// It is more than 1 % off the times, and the cask file leaves open which to go by.
pub(super) fn of_header(
    path: &Path,
    channel: &str,
    plan: &Plan,
    (taken_hz, times_s): (f64, Option<&[f64]>),
) -> Result<Option<Issue>, IngestError> {
    let Some(stated) = &plan.stated else { return Ok(None) };
    let agreement = stated.agreement(taken_hz, times_s.map_or(0.0, rounding));
    if agreement == Agreement::FarApart && !plan.is_settled {
        let hz = [stated.rate_hz, taken_hz].map(shown_hz);
        return Err(error::source(
            path,
            channel,
            contradiction(stated, taken_hz, "the times say"),
            format!(
                "write the right one in each [[channel]] of the cask file: sample_rate_hz = {} or sample_rate_hz = {}",
                hz[0], hz[1]
            ),
        ));
    }
    let origin = if times_s.is_some() { "by the times or by sample_rate_hz of" } else { "by" };
    let taken = format!("{origin} the cask file they were taken at");
    Ok((agreement != Agreement::Same).then(|| warning(contradiction(stated, taken_hz, &taken))))
}

/// A warning where the header states another rate than the times, for a listing.
pub(super) fn of_times(stated: Option<&StatedRate>, taken_hz: f64, times_s: &[f64]) -> Option<Issue> {
    let stated = stated.filter(|stated| stated.agreement(taken_hz, rounding(times_s)) != Agreement::Same)?;
    Some(warning(contradiction(stated, taken_hz, "the times say")))
}

fn contradiction(stated: &StatedRate, taken_hz: f64, says: &str) -> String {
    format!(
        "the header states {} for the samples, {says} {} Hz: one of the two is wrong, and every velocity goes with the rate",
        stated.shown(),
        shown_hz(taken_hz)
    )
}

fn warning(message: String) -> Issue {
    Issue::new(IssueCode::TimeJitter, Severity::Warning, message)
}

/// How far off the rate of times may be for what they are rounded to, as a part of it: one step over the record.
fn rounding(times_s: &[f64]) -> f64 {
    let span_s = times_s.last().zip(times_s.first()).map_or(0.0, |(last, first)| last - first);
    let rounding = step(times_s) / span_s;
    if rounding > 0.0 { rounding.min(MOST_ROUNDING) } else { 0.0 }
}

/// The usual step from a time to a later one: their interval, or what they are cut to where that is longer; 0 without any.
fn step(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|d| *d > 0.0).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}
