//! What else a table says of its times to whether it bears them out.

use super::super::error::{self, IngestError};
use super::super::stated_rate::{Agreement, StatedRate, shown_hz};
use super::column::Column;
use super::layout::Layout;
use super::plan::Plan;
use super::rows::Wanted;
use crate::data::{Issue, IssueCode, Severity};
use crate::ingest::clock_pair::{FAR, Pair, step};
use crate::ingest::time_reading::Scale;
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
    (taken_hz, times_s): (f64, Option<&Column>),
) -> Result<Option<Issue>, IngestError> {
    let Some(stated) = &plan.stated else { return Ok(None) };
    let agreement = stated.agreement(taken_hz, times_s.map_or(0.0, Column::rounding));
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
    Issue::new(IssueCode::Clock, Severity::Warning, message)
}

/// A warning for each other column of times that contradicts the one in column `time` by more than 0.1 % and what both are cut to, or that
/// by its changes runs at another rate or steps.
///
/// # Errors
/// It does so by more than 1 %, and the cask file leaves open which to go by.
pub(super) fn of_columns<'a>(
    path: &Path,
    (time, held): (usize, &[Column]),
    (layout, wanted): (&Layout, &Wanted),
    (plans, name): (&[Plan], &dyn Fn(usize) -> &'a str),
) -> Result<Vec<Issue>, IngestError> {
    let mut issues = Vec::new();
    for (other, is_apart) in layout.witnesses(time) {
        let slot = wanted.slot(other);
        let scale = if wanted.is_time[slot] { Scale::Known(1.0) } else { layout.time_scale(other) };
        let pair = Pair::of(&held[wanted.slot(time)].values(), &held[slot].values());
        let Some((miss, says)) = pair.and_then(|pair| pair.contradiction(scale, is_apart)) else { continue };
        let headers = [time, other].map(|column| &layout.columns[column].header);
        let problem = format!(
            "the times in the columns {:?} and {:?} contradict each other: {says}",
            headers[0], headers[1]
        );
        let is_open = |plan: &&Plan| plan.time_column == Some(time) && !plan.is_settled;
        let open = plans.iter().position(|plan| is_open(&plan));
        let mend = if is_apart {
            format!("give each [[channel]] of the cask file its own, such as time = {:?}", headers[1])
        } else {
            format!(
                "write which is right into the cask file, under [recording]: time = {:?} or time = {:?}; or sample_rate_hz in each [[channel]]",
                headers[0], headers[1]
            )
        };
        match open.filter(|_| miss > FAR) {
            Some(spec) => return Err(error::source(path, name(spec), problem, mend)),
            None => issues
                .push(warning(format!("{problem}; the first was taken, and every velocity goes with it"))),
        }
    }
    Ok(issues)
}

/// A warning where a column that counts the rows jumps, and the times beside it, headed so, do not: those between are lost.
pub(super) fn of_counter(header: &str, counts: &[f64], times: Option<(&str, &Column)>) -> Option<Issue> {
    let steps = || counts.windows(2).map(|pair| pair[1] - pair[0]);
    // One that begins anew, or counts something else, tells nothing.
    let is_counter = steps().all(|step| step >= 1.0 && step.fract().abs() < f64::EPSILON);
    let mut jumps: Vec<(usize, f64)> = steps().enumerate().filter(|(_, step)| *step > 1.0).collect();
    if !is_counter || jumps.is_empty() || 10 * jumps.len() >= counts.len() {
        return None;
    }
    if let Some((_, times)) = times {
        jumps.retain(hidden(counts, &times.values()));
    }
    let &(row, first) = jumps.first()?;
    let lost: f64 = jumps.iter().map(|(_, step)| step - 1.0).sum();
    let (others, mend) = match times {
        None => (
            "the others were taken as one after another".to_owned(),
            format!("write time = {header:?} under [recording] of the cask file"),
        ),
        Some((name, _)) => (
            format!("the times in {name:?} do not show that, so that those behind are early"),
            format!(
                "write time = {header:?} under [recording] of the cask file and sample_rate_hz in each [[channel]]"
            ),
        ),
    };
    let message = format!(
        "the column {header:?} counts the rows, and {lost} of them are missing, the first {} behind row {} of the table; {others}: {mend}, \
         which keeps their places",
        first - 1.0,
        row + 1
    );
    Some(Issue::new(IssueCode::Gap, Severity::Warning, message))
}

/// Whether times hide a jump of the rows' count: they step by fewer intervals, or are so coarse that the rows between them are taken as evenly
/// spaced.
#[allow(clippy::cast_precision_loss, reason = "row counts stay below 2^52")]
fn hidden<'a>(counts: &'a [f64], times: &'a [f64]) -> impl Fn(&(usize, f64)) -> bool + 'a {
    /// In intervals: beyond, the time base finds a gap. And as a part of a long one, for what times are rounded to.
    const SHORT: f64 = 0.5;
    const SHORT_PART: f64 = 0.02;
    let steps = || times.windows(2).map(|pair| pair[1] - pair[0]);
    let next = counts.windows(2).map(|pair| pair[1] - pair[0] < 2.0).zip(steps());
    let (count, span) = next
        .filter(|(is_next, step)| *is_next && step.is_finite())
        .fold((0_usize, 0.0), |(count, span), (_, step)| (count + 1, span + step));
    let interval = span / count.max(1) as f64;
    // As the time base has it.
    let is_coarse = 10 * steps().filter(|step| *step <= 0.0).count() > times.len();
    move |&(row, step)| {
        let told = (times[row + 1] - times[row]) / interval;
        is_coarse || step - told > SHORT.max(SHORT_PART * step)
    }
}

/// How far off the rate of times may be for what they are rounded to, as a part of it: one step over the record.
pub(super) fn rounding(times_s: &[f64]) -> f64 {
    let span_s = times_s.last().zip(times_s.first()).map_or(0.0, |(last, first)| last - first);
    let rounding = step(times_s) / span_s;
    if rounding > 0.0 { rounding.min(MOST_ROUNDING) } else { 0.0 }
}
