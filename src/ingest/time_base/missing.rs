//! Samples with gaps to samples with NaN in them, and the issues that say so.

use super::fit::Fit;
use super::order::as_f64;
use super::uniform::Number;
use crate::data::{Issue, IssueCode, Severity, Span};

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

/// Turns infinite samples into NaN and says how many are no numbers; `clock` is start and rate. Count and spans.
pub(super) fn mark_non_finite<S: Number>(
    samples: &mut [S],
    clock: (f64, f64),
    issues: &mut Vec<Issue>,
) -> (usize, Vec<Span>) {
    let Some((count, first, last)) = count_non_finite(samples) else {
        return (0, Vec::new());
    };
    let time_s = |index: usize| clock.0 + as_f64(index) / clock.1;
    issues.push(non_finite(count, time_s(first), time_s(last)));
    (count, spans(samples))
}

/// The same for samples with a time each; the count alone.
pub(super) fn mark_non_finite_timed<S: Number>(
    samples: &mut [S],
    times_s: &[f64],
    issues: &mut Vec<Issue>,
) -> usize {
    let Some((count, first, last)) = count_non_finite(samples) else {
        return 0;
    };
    issues.push(non_finite(count, times_s[first], times_s[last]));
    count
}

fn count_non_finite<S: Number>(samples: &mut [S]) -> Option<(usize, usize, usize)> {
    let count = samples.iter().filter(|s| !s.to_f64().is_finite()).count();
    if count == 0 {
        return None;
    }
    let first = samples.iter().position(|s| !s.to_f64().is_finite())?;
    let last = samples.iter().rposition(|s| !s.to_f64().is_finite())?;
    for sample in samples.iter_mut().filter(|s| !s.to_f64().is_finite()) {
        *sample = S::MISSING;
    }
    Some((count, first, last))
}

fn non_finite(count: usize, from_s: f64, to_s: f64) -> Issue {
    Issue::new(
        IssueCode::NonFinite,
        Severity::Warning,
        format!("{count} sample(s) are empty, NaN or infinite and count as missing"),
    )
    .between(from_s, to_s)
}

/// One issue a gap, or one for all where they are many.
pub(super) fn report_gaps(fit: &Fit, times_s: &[f64], issues: &mut Vec<Issue>) {
    let gaps: Vec<(usize, f64, f64)> = fit
        .runs
        .windows(2)
        .map(|w| {
            let lost = w[1].place - w[0].place - (w[1].first - w[0].first);
            (lost, times_s[w[1].first - 1], times_s[w[1].first])
        })
        .collect();
    push_gaps(&gaps, issues);
}

/// Gaps as (samples lost, last time before, first time after).
pub(super) fn push_gaps(gaps: &[(usize, f64, f64)], issues: &mut Vec<Issue>) {
    if gaps.len() <= GAPS_TOLD_SINGLY {
        issues.extend(gaps.iter().map(|&(lost, from_s, to_s)| {
            let message = format!("{lost} sample(s) are missing over {:.2} ms", 1e3 * (to_s - from_s));
            Issue::new(IssueCode::Gap, Severity::Warning, message).between(from_s, to_s)
        }));
        return;
    }
    let Some(widest) = gaps.iter().max_by_key(|gap| gap.0) else { return };
    let lost: usize = gaps.iter().map(|gap| gap.0).sum();
    let message = format!(
        "{lost} samples are missing in {} gaps, the longest of {} samples over {:.3e} s (the span given)",
        gaps.len(),
        widest.0,
        widest.2 - widest.1
    );
    issues.push(Issue::new(IssueCode::Gap, Severity::Warning, message).between(widest.1, widest.2));
}
