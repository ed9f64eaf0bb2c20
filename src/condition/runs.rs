//! Samples to the stretches in which something holds of each of them.

use crate::data::Span;

/// Stretches in which every sample is `inside`.
pub(super) fn runs(force: &[f64], inside: impl Fn(f64) -> bool) -> Vec<Span> {
    runs_of_pairs(force, force, |f, _| inside(f))
}

/// The same of the steps from one sample to the next: where `inside` holds of a sample and its next.
pub(super) fn runs_of_steps(force: &[f64], inside: impl Fn(f64, f64) -> bool) -> Vec<Span> {
    force.split_first().map_or(Vec::new(), |(_, next)| runs_of_pairs(force, next, inside))
}

/// Stretches of indices at which `inside` holds of both values, as far as there are two.
fn runs_of_pairs(firsts: &[f64], seconds: &[f64], inside: impl Fn(f64, f64) -> bool) -> Vec<Span> {
    /// Samples asked at once whether any is inside, which costs less than to follow each.
    const TOGETHER: usize = 64;
    let mut spans = Vec::new();
    let mut from = None;
    let count = firsts.len().min(seconds.len());
    let chunks = firsts[..count].chunks(TOGETHER).zip(seconds[..count].chunks(TOGETHER));
    for (n, (firsts, seconds)) in chunks.enumerate() {
        let pairs = firsts.iter().zip(seconds);
        if from.is_none() && !pairs.clone().fold(false, |any, (a, b)| any | inside(*a, *b)) {
            continue;
        }
        for (i, (a, b)) in (n * TOGETHER..).zip(pairs) {
            match (inside(*a, *b), from) {
                (true, None) => from = Some(i),
                (false, Some(start)) => {
                    spans.push(Span { from: start, to: i });
                    from = None;
                }
                _ => {}
            }
        }
    }
    spans.extend(from.map(|from| Span { from, to: count }));
    spans
}
