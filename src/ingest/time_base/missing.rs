//! Samples with gaps to samples with NaN in them, and the issues that say so.

use super::fit::{Fit, Run};
use super::order::as_f64;
use super::uniform::Number;
use crate::data::{Finding, Span, TimesFinding};

/// Up to this many gaps get an issue each; more are summed up in one.
const GAPS_TOLD_SINGLY: usize = 5;

/// Stretches of NaN.
pub(super) fn spans<S: Number>(samples: &[S]) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut from = None;
    for (i, sample) in samples.iter().enumerate() {
        match (sample.to_f64().is_finite(), from) {
            (false, None) => from = Some(i),
            (true, Some(start)) => {
                spans.push(Span { from: start, to: i });
                from = None;
            }
            _ => {}
        }
    }
    if let Some(start) = from {
        spans.push(Span { from: start, to: samples.len() });
    }
    spans
}

/// The samples of all runs at their places, NaN between.
pub(super) fn spread<S: Number>(samples: &[S], fit: &Fit) -> Vec<S> {
    let mut placed = vec![S::MISSING; fit.places(samples.len())];
    for (number, run) in fit.runs.iter().enumerate() {
        let to = fit.runs.get(number + 1).map_or(samples.len(), |next| next.first);
        let source = &samples[run.first..to];
        placed[run.place..run.place + source.len()].copy_from_slice(source);
    }
    placed
}

/// Turns infinite samples into NaN and says how many are no numbers beside the `lost` ones between blocks; `clock` is start and rate. The spans.
pub(super) fn mark_non_finite<S: Number>(
    samples: &mut [S],
    lost: usize,
    clock: (f64, f64),
    issues: &mut Vec<Finding>,
) -> Vec<Span> {
    let Some((count, span)) = count_non_finite(samples) else {
        return Vec::new();
    };
    let time_s = |index: usize| clock.0 + as_f64(index) / clock.1;
    if count > lost {
        issues.push(non_finite(count - lost, time_s(span.from), time_s(span.to)));
    }
    spans(samples)
}

/// The same for samples with a time each; the count alone.
pub(super) fn mark_non_finite_timed<S: Number>(
    samples: &mut [S],
    times_s: &[f64],
    issues: &mut Vec<Finding>,
) -> usize {
    let Some((count, span)) = count_non_finite(samples) else {
        return 0;
    };
    issues.push(non_finite(count, times_s[span.from], times_s[span.to]));
    count
}

/// How many samples are no numbers, and the first and the last of them.
fn count_non_finite<S: Number>(samples: &mut [S]) -> Option<(usize, Span)> {
    let count = samples.iter().filter(|s| !s.to_f64().is_finite()).count();
    if count == 0 {
        return None;
    }
    let first = samples.iter().position(|s| !s.to_f64().is_finite())?;
    let last = samples.iter().rposition(|s| !s.to_f64().is_finite())?;
    for sample in samples.iter_mut().filter(|s| !s.to_f64().is_finite()) {
        *sample = S::MISSING;
    }
    Some((count, Span { from: first, to: last }))
}

fn non_finite(samples: usize, from_s: f64, to_s: f64) -> Finding {
    Finding::from(TimesFinding::NonFinite { samples }).between(from_s, to_s)
}

/// A stretch without samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gap {
    /// Samples that are missing.
    pub lost: usize,
    /// Time of the last sample before, s.
    pub from_s: f64,
    /// Time of the first sample after, s.
    pub to_s: f64,
}

/// One finding a gap, or one for all where they are many.
pub(super) fn report_gaps(fit: &Fit, times_s: &[f64], issues: &mut Vec<Finding>) {
    let between = |runs: &[Run]| Gap {
        lost: runs[1].place - runs[0].place - (runs[1].first - runs[0].first),
        from_s: times_s[runs[1].first - 1],
        to_s: times_s[runs[1].first],
    };
    push_gaps(&fit.runs.windows(2).map(between).collect::<Vec<Gap>>(), issues);
}

/// The same of gaps between blocks.
pub(super) fn push_gaps(gaps: &[Gap], issues: &mut Vec<Finding>) {
    if gaps.len() <= GAPS_TOLD_SINGLY {
        issues.extend(gaps.iter().map(|&Gap { lost, from_s, to_s }| {
            Finding::from(TimesFinding::Gap { lost, over_s: to_s - from_s }).between(from_s, to_s)
        }));
        return;
    }
    let Some(widest) = gaps.iter().max_by_key(|gap| gap.lost) else { return };
    let lost = gaps.iter().map(|gap| gap.lost).sum();
    let over_s = widest.to_s - widest.from_s;
    let found = TimesFinding::Gaps { lost, gaps: gaps.len(), longest: widest.lost, over_s };
    issues.push(Finding::from(found).between(widest.from_s, widest.to_s));
}
