//! Fits a sinusoid of known frequency to samples, by least squares.

use super::as_f64;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Sinusoid a cos ωt + b sin ωt, with t counted from the middle of the fitted samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sinusoid {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// a.
    pub cosine: f64,
    /// b.
    pub sine: f64,
    /// Standard uncertainty of the amplitude, if the residual is white.
    pub u_amplitude: f64,
}

impl Sinusoid {
    /// √(a² + b²).
    pub fn amplitude(&self) -> f64 {
        self.cosine.hypot(self.sine)
    }

    /// Value at a time after the middle of the fitted samples.
    pub fn value_at(&self, since_middle_s: f64) -> f64 {
        let (sin, cos) = (TAU * self.frequency_hz * since_middle_s).sin_cos();
        self.cosine * cos + self.sine * sin
    }
}

/// The sinusoid of this frequency beside a constant and a slope; `None` below eight samples or one period.
pub fn fit(samples: &[f64], sample_rate_hz: f64, frequency_hz: f64) -> Option<Sinusoid> {
    let n = samples.len();
    let length_s = as_f64(n) / sample_rate_hz;
    if n < 8 || length_s * frequency_hz < 1.0 || frequency_hz >= 0.5 * sample_rate_hz {
        return None;
    }
    let middle = as_f64(n - 1) / 2.0;
    let mut matrix = nalgebra::Matrix4::zeros();
    let mut right = nalgebra::Vector4::zeros();
    let step = TAU * frequency_hz / sample_rate_hz;
    // The phase is advanced from sample to sample: a thousand steps cost a thousandth of a billionth of it.
    let turn = Complex::cis(step);
    let mut phase = Complex::cis(-step * middle);
    let mut square = 0.0;
    for (i, x) in samples.iter().enumerate() {
        let row = nalgebra::Vector4::new(phase.re, phase.im, 1.0, (as_f64(i) - middle) / as_f64(n));
        matrix.syger(1.0, &row, &row, 1.0);
        right += row * *x;
        square += x * x;
        phase *= turn;
    }
    matrix.fill_upper_triangle_with_lower_triangle();
    let inverse = matrix.try_inverse()?;
    let found = inverse * right;
    let left = (square - found.dot(&right)).max(0.0) / as_f64(n - 4);
    let u_amplitude = (left * (inverse[(0, 0)] + inverse[(1, 1)]) / 2.0).sqrt();
    Some(Sinusoid { frequency_hz, cosine: found[0], sine: found[1], u_amplitude })
}

/// The strongest sinusoid between two frequencies: eleven are tried, then eleven between the neighbours of
/// the best.
pub fn search(samples: &[f64], sample_rate_hz: f64, (low_hz, high_hz): (f64, f64)) -> Option<Sinusoid> {
    let best = |low: f64, high: f64, steps: u32| {
        let step = (high - low) / f64::from(steps);
        (0..=steps)
            .filter_map(|i| fit(samples, sample_rate_hz, low + step * f64::from(i)))
            .max_by(|a, b| a.amplitude().total_cmp(&b.amplitude()))
    };
    let coarse = best(low_hz, high_hz, 10)?;
    let step_hz = (high_hz - low_hz) / 10.0;
    let about = coarse.frequency_hz;
    best((about - step_hz).max(low_hz), (about + step_hz).min(high_hz), 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amplitude_phase_and_frequency_are_found_beside_offset_and_slope() {
        let rate_hz = 5000.0;
        let wave = |t: f64| 3.0 * (TAU * 50.2 * t + 0.7).cos();
        let samples: Vec<f64> =
            (0..1000).map(|i| f64::from(i) / rate_hz).map(|t| 12.0 - 4.0 * t + wave(t)).collect();
        let found = search(&samples, rate_hz, (49.5, 50.5)).expect("ten periods");
        // Frequencies 20 mHz apart are tried.
        assert!((found.frequency_hz - 50.2).abs() < 0.013, "{found:?}");
        // Half a step over ± 0.1 s is a phase of 6e-3 at most, whose square the amplitude loses.
        assert!((found.amplitude() - 3.0).abs() < 0.01, "{found:?}");
        let middle_s = 999.0 / 2.0 / rate_hz;
        for since_s in [-0.09, 0.0, 0.05, 0.15] {
            let off = found.value_at(since_s) - wave(middle_s + since_s);
            assert!(off.abs() < 3.0 * TAU * 0.013 * 0.15 + 0.01, "{since_s}: {off}");
        }
    }

    #[test]
    fn too_short_a_stretch_has_none() {
        assert!(fit(&[1.0; 50], 5000.0, 50.0).is_none());
        assert!(fit(&[1.0; 5], 10.0, 2.0).is_none());
    }
}
