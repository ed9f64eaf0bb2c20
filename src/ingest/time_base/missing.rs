//! Samples with gaps to samples with NaN in them, and the findings that say so.

use super::fit::{BaseFit, Run};
use crate::data::{Finding, Samples, Span, TimesFinding, is_number};

/// Up to this many gaps get a finding each; more are summed up in one.
const GAPS_TOLD_SINGLY: usize = 5;

/// Stretches of NaN.
pub(super) fn spans(samples: &Samples) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    for at in (0..samples.len()).filter(|&i| !samples.get(i).is_finite()) {
        match spans.last_mut() {
            Some(span) if span.to == at => span.to = at + 1,
            _ => spans.push(Span { from: at, to: at + 1 }),
        }
    }
    spans
}

/// The samples of all runs at their places, NaN between.
pub(super) fn spread(samples: &Samples, fit: &BaseFit) -> Samples {
    let ends = fit.runs.iter().skip(1).map(|next| next.first).chain([samples.len()]);
    let stretch = |(run, to): (&Run, usize)| (Span { from: run.first, to }, run.place);
    let stretches: Vec<(Span, usize)> = fit.runs.iter().zip(ends).map(stretch).collect();
    samples.distribute(fit.places(samples.len()), &stretches)
}

/// Turns infinite samples and those over the range into NaN and says how many are no numbers beside the
/// `lost` ones between blocks. The spans.
pub(super) fn mark(
    samples: &mut Samples,
    lost: usize,
    time_s: impl Fn(usize) -> f64,
    issues: &mut Vec<Finding>,
) -> Vec<Span> {
    let count = samples.missing();
    if count == 0 {
        return Vec::new();
    }
    samples.change(|x| if is_number(x) { x } else { f64::NAN });
    let spans = spans(samples);
    if let ([first, ..], [.., last]) = (&spans[..], &spans[..])
        && count > lost
    {
        let found = Finding::from(TimesFinding::NonFinite { samples: count - lost });
        issues.push(found.span(time_s(first.from), time_s(last.to - 1)));
    }
    spans
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
pub(super) fn report_gaps(fit: &BaseFit, times_s: &[f64], issues: &mut Vec<Finding>) {
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
            Finding::from(TimesFinding::Gap { lost, over_s: to_s - from_s }).span(from_s, to_s)
        }));
        return;
    }
    let Some(widest) = gaps.iter().max_by_key(|gap| gap.lost) else { return };
    let lost = gaps.iter().map(|gap| gap.lost).sum();
    let over_s = widest.to_s - widest.from_s;
    let found = TimesFinding::Gaps { lost, gaps: gaps.len(), longest: widest.lost, over_s };
    issues.push(Finding::from(found).span(widest.from_s, widest.to_s));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::as_f64;

    #[test]
    fn overrange_marks_of_instruments_are_missing_samples() {
        let marks = [1.0, 9.9e37, -2.0, -9.91e37, 9.999_999_99e37, 3.0, f64::INFINITY];
        #[allow(clippy::cast_possible_truncation, reason = "as an f32 holds them")]
        let single = Samples::F32(marks.map(|mark| mark as f32).to_vec());
        for mut samples in [Samples::F64(marks.to_vec()), single] {
            let mut issues = Vec::new();
            let gaps = mark(&mut samples, 0, as_f64, &mut issues);
            let gaps: Vec<_> = gaps.iter().map(|gap| (gap.from, gap.to)).collect();
            assert_eq!((gaps, issues.len()), (vec![(1, 2), (3, 5), (6, 7)], 1));
        }
    }
}
