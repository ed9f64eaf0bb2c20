//! Samples to their low-passed selves in 106 bits: second-order sections in direct form I, from rest at both ends; and to how far others are off.

use super::double_double::DoubleDouble;
use crate::lab::methods::contest::DIVERGED;

/// b0 (= b2 = b1/2), a1, a2.
type DoubledSection = [DoubleDouble; 3];

/// Two passes of a Butterworth low-pass of this order a pass, by the bilinear transform.
///
/// Direct form loses (f_s / 2π f)² of its digits: at f/f_s = 1e-6 that is 3e10 of 1e32.
pub(super) fn low_passed(samples: &[f64], order: u32, design_over_rate: f64) -> Vec<f64> {
    let mut work: Vec<DoubleDouble> = samples.iter().map(|x| DoubleDouble::from(*x)).collect();
    let sections: Vec<DoubledSection> = (0..order / 2).map(|i| section(order, i, design_over_rate)).collect();
    for _ in 0..2 {
        for section in &sections {
            one_pass(section, &mut work);
        }
        work.reverse();
    }
    work.into_iter().map(DoubleDouble::value).collect()
}

fn section(order: u32, index: u32, design_over_rate: f64) -> DoubledSection {
    let number = |x: f64| DoubleDouble::from(x);
    let (sine, cosine) = (DoubleDouble::PI * number(design_over_rate)).sine_and_cosine();
    let angle =
        DoubleDouble::PI * number(f64::from(2 * index + 1)) * number(f64::from(2 * order)).reciprocal();
    let damping = number(2.0) * angle.sine_and_cosine().0;
    // s = cos/sin (1 − z⁻¹)/(1 + z⁻¹), all times sin².
    let (square, cross) = (sine * sine, damping * sine * cosine);
    let scale = (number(1.0) + cross).reciprocal();
    [square * scale, number(2.0) * (square - cosine * cosine) * scale, (number(1.0) - cross) * scale]
}

fn one_pass([b, a1, a2]: &DoubledSection, samples: &mut [DoubleDouble]) {
    let nothing = DoubleDouble::from(0.0);
    let (mut x1, mut x2, mut y1, mut y2) = (nothing, nothing, nothing, nothing);
    for x in samples {
        let input = *x;
        let y = *b * (input + x1 + x1 + x2) - *a1 * y1 - *a2 * y2;
        (x2, x1, y2, y1) = (x1, input, y1, y);
        *x = y;
    }
}

/// Largest difference of two curves over the peak of the second.
pub(super) fn worst_of_peak(made: impl Iterator<Item = f64>, truth: &[f64]) -> f64 {
    let peak = truth.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let mut worst = 0.0_f64;
    for (made, true_value) in made.zip(truth) {
        let off = (made - true_value).abs();
        if off.is_nan() {
            return DIVERGED;
        }
        worst = worst.max(off);
    }
    worst / peak.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_sine_takes_the_butterworth_gain() {
        // Angles of up to 190 are rounded by 1.4e-14, and so is the sine.
        let turn = 0.01_f64;
        let x: Vec<f64> = (0..6000).map(|i| (2.0 * PI * turn * f64::from(i)).cos()).collect();
        for order in [2, 4] {
            let y = low_passed(&x, order, 0.02);
            let ratio = (PI * turn).tan() / (PI * 0.02).tan();
            let gain = 1.0 / (1.0 + ratio.powi(2 * i32::try_from(order).unwrap()));
            // 3000 samples from either end: 60/f, of which the slowest pole leaves e^(−0.38 · 2π · 60).
            assert!((2900..3100).all(|i| (y[i] - gain * x[i]).abs() < 4e-14), "{order}");
        }
    }

    #[test]
    fn a_curve_that_is_no_number_has_diverged() {
        assert!(worst_of_peak([1.0, f64::NAN].into_iter(), &[1.0, 1.0]) >= DIVERGED);
        assert!((worst_of_peak([1.0, 3.0].into_iter(), &[1.0, 2.0]) - 0.5).abs() < 1e-15);
    }
}
