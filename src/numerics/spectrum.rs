//! Uniform samples to the magnitude of their Fourier integral.

use rustfft::{Fft, FftPlanner, num_complex::Complex};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Plans are kept: the sines that one is made of cost more than to use it once.
static PLANS: LazyLock<Mutex<FftPlanner<f64>>> = LazyLock::new(|| Mutex::new(FftPlanner::new()));

/// The forward transform of `count` values.
pub(super) fn forward(count: usize) -> Arc<dyn Fft<f64>> {
    PLANS.lock().unwrap_or_else(PoisonError::into_inner).plan_fft_forward(count)
}

/// Frequencies (Hz) and |∫ x e^{−iωt} dt| up to half the sample rate; padded with zeros to the next power of two.
///
/// The unit of the magnitude is that of `samples` times seconds.
#[must_use]
#[allow(clippy::cast_precision_loss, reason = "sample counts stay below 2^52")]
pub fn magnitude(samples: &[f64], sample_rate_hz: f64) -> (Vec<f64>, Vec<f64>) {
    if samples.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let n = samples.len().next_power_of_two();
    let mut work: Vec<Complex<f64>> = samples.iter().map(|&x| Complex::new(x, 0.0)).collect();
    work.resize(n, Complex::new(0.0, 0.0));
    forward(n).process(&mut work);
    let bins = n / 2 + 1;
    let frequency_hz = (0..bins).map(|i| i as f64 * sample_rate_hz / n as f64).collect();
    let magnitude = work[..bins].iter().map(|c| c.norm_sqr().sqrt() / sample_rate_hz).collect();
    (frequency_hz, magnitude)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_zero_frequency_is_the_area() {
        let (f, m) = magnitude(&[1.0, 2.0, 3.0, 4.0, 5.0], 10.0);
        assert!(f[0].abs() < 1e-15 && (m[0] - 1.5).abs() < 1e-12);
        assert!((f[f.len() - 1] - 5.0).abs() < 1e-12);
    }
}
