//! A record to the same with both ends continued, so that a filter need not begin and end on nothing.

/// The samples continued by `pad` at both ends, at most by all but the end sample, and how many stand in front of them.
///
/// `beyond` makes a sample outside of the end sample and the one that lies as far inside.
pub(crate) fn continued(samples: &[f64], pad: usize, beyond: impl Fn(f64, f64) -> f64) -> (Vec<f64>, usize) {
    let n = samples.len();
    let pad = pad.min(n.saturating_sub(1));
    if pad == 0 {
        return (samples.to_vec(), 0);
    }
    let (head, tail) = (samples[0], samples[n - 1]);
    let mut work = Vec::with_capacity(n + 2 * pad);
    work.extend(samples[1..=pad].iter().rev().map(|x| beyond(head, *x)));
    work.extend_from_slice(samples);
    work.extend(samples[n - 1 - pad..n - 1].iter().rev().map(|x| beyond(tail, *x)));
    (work, pad)
}

/// The `count` samples behind the first `head`.
pub(crate) fn cut(mut work: Vec<f64>, head: usize, count: usize) -> Vec<f64> {
    work.drain(..head);
    work.truncate(count);
    work
}
