//! Samples to their low-passed selves by way of the spectrum.

use crate::numerics::filter::stage::{Sample, constant};
use rustfft::{FftPlanner, num_complex::Complex};
use std::f64::consts::PI;

/// The samples with each line of their spectrum times `gain` of tan(π f/f_s).
///
/// Lengths grow to 2ⁿ, 3·2ⁿ or 9·2ⁿ; the gap is bridged by a line, so that the ring closes without a jump.
#[allow(clippy::cast_precision_loss, reason = "sample counts stay below 2^52")]
pub(super) fn filtered<T: Sample>(mut samples: Vec<T>, gain: impl Fn(f64) -> f64) -> Vec<T> {
    let n = samples.len();
    let (Some(&head), Some(&tail)) = (samples.first(), samples.last()) else { return samples };
    let length = fast_length(n);
    let step = (head - tail) * constant(1.0 / (length - n + 1) as f64);
    samples.extend((1..=length - n).map(|i| tail + step * constant(i as f64)));
    let mut work: Vec<Complex<T>> = samples.iter().map(|x| Complex::new(*x, T::zero())).collect();
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(length).process(&mut work);
    for (k, line) in work.iter_mut().enumerate() {
        let turn = k.min(length - k) as f64 / length as f64;
        let weight: T = constant(gain((PI * turn).tan()) / length as f64);
        *line = *line * weight;
    }
    planner.plan_fft_inverse(length).process(&mut work);
    work.truncate(n);
    work.into_iter().map(|c| c.re).collect()
}

/// The least of 2ⁿ, 3·2ⁿ, 9·2ⁿ that is not below `n`.
fn fast_length(n: usize) -> usize {
    [1, 3, 9].map(|odd| odd * n.div_ceil(odd).next_power_of_two()).into_iter().min().unwrap_or(n)
}
