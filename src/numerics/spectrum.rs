//! Magnitude of the Fourier integral of uniform samples.

use super::as_f64;
use rustfft::{Fft, FftPlanner, num_complex::Complex};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// The last plans with their lengths: computing the sines of a plan costs more than using it once.
static PLANS: Mutex<VecDeque<Arc<dyn Fft<f64>>>> = Mutex::new(VecDeque::new());

/// Number of plans to keep: the channels of a recording have a few lengths, those of a campaign's recordings
/// many, and a planner would keep all.
const MOST_PLANS: usize = 16;

/// The forward transform of `count` values.
pub(super) fn forward_transform(count: usize) -> Arc<dyn Fft<f64>> {
    let mut plans = PLANS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(plan) = plans.iter().find(|plan| plan.len() == count) {
        return Arc::clone(plan);
    }
    plans.truncate(MOST_PLANS - 1);
    let plan = FftPlanner::new().plan_fft_forward(count);
    plans.push_front(Arc::clone(&plan));
    plan
}

/// Frequencies (Hz) and |∫ x e^{−iωt} dt| up to half the sample rate; padded with zeros to the next power of
/// two.
///
/// The unit of the magnitude is that of `samples` times seconds.
pub fn magnitude(samples: impl ExactSizeIterator<Item = f64>, sample_rate_hz: f64) -> (Vec<f64>, Vec<f64>) {
    if samples.len() == 0 {
        return (Vec::new(), Vec::new());
    }
    let n = samples.len().next_power_of_two();
    let padding = std::iter::repeat_n(0.0, n - samples.len());
    let mut work: Vec<Complex<f64>> = samples.chain(padding).map(|x| Complex::new(x, 0.0)).collect();
    forward_transform(n).process(&mut work);
    let bins = n / 2 + 1;
    let frequency_hz = (0..bins).map(|i| as_f64(i) * sample_rate_hz / as_f64(n)).collect();
    let magnitude = work[..bins].iter().map(|c| c.norm_sqr().sqrt() / sample_rate_hz).collect();
    (frequency_hz, magnitude)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_plans_are_kept() {
        for count in 1000..1100 {
            assert_eq!(forward_transform(count).len(), count);
        }
        assert!(PLANS.lock().is_ok_and(|plans| plans.len() <= MOST_PLANS));
    }

    #[test]
    fn the_zero_frequency_is_the_area() {
        let (f, m) = magnitude([1.0, 2.0, 3.0, 4.0, 5.0].into_iter(), 10.0);
        assert!(f[0].abs() < 1e-15 && (m[0] - 1.5).abs() < 1e-12);
        assert!((f[f.len() - 1] - 5.0).abs() < 1e-12);
    }
}
