//! Finds the stretches in which every sample, or every step between samples, meets a condition.

use crate::data::Span;

/// Finds the stretches in which every sample is `inside`.
pub(super) fn find_runs(force: &[f64], inside: impl Fn(f64) -> bool) -> Vec<Span> {
    find_pair_runs(force, force, |f, _| inside(f))
}

/// Finds the stretches in which `inside` holds for each sample with the next one.
pub(super) fn find_step_runs(force: &[f64], inside: impl Fn(f64, f64) -> bool) -> Vec<Span> {
    force.split_first().map_or(Vec::new(), |(_, next)| find_pair_runs(force, next, inside))
}

/// Finds the stretches of indices at which `inside` holds for both values.
fn find_pair_runs(firsts: &[f64], seconds: &[f64], inside: impl Fn(f64, f64) -> bool) -> Vec<Span> {
    /// Samples that are tested at once: if none is inside, that costs less than to follow each.
    const CHUNK: usize = 64;
    let mut spans = Vec::new();
    let mut from = None;
    let count = firsts.len().min(seconds.len());
    let chunks = firsts[..count].chunks(CHUNK).zip(seconds[..count].chunks(CHUNK));
    for (n, (firsts, seconds)) in chunks.enumerate() {
        let pairs = firsts.iter().zip(seconds);
        if from.is_none() && !pairs.clone().fold(false, |any, (a, b)| any | inside(*a, *b)) {
            continue;
        }
        for (i, (a, b)) in (n * CHUNK..).zip(pairs) {
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
