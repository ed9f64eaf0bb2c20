//! A record to the same with both ends continued, so that a filter need not begin and end on nothing.

/// The samples mirrored at both ends for `pad` samples, at most for all but the end sample, and how many
/// stand in front of them.
pub(super) fn mirrored(samples: &[f64], pad: usize) -> (Vec<f64>, usize) {
    let n = samples.len();
    let pad = pad.min(n.saturating_sub(1));
    if pad == 0 {
        return (samples.to_vec(), 0);
    }
    let mut work = Vec::with_capacity(n + 2 * pad);
    work.extend(samples[1..=pad].iter().rev());
    work.extend_from_slice(samples);
    work.extend(samples[n - 1 - pad..n - 1].iter().rev());
    (work, pad)
}

/// The `count` samples behind the first `head`.
pub(super) fn cut(mut work: Vec<f64>, head: usize, count: usize) -> Vec<f64> {
    work.drain(..head);
    work.truncate(count);
    work
}
