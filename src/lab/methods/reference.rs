//! Samples to their low-passed selves in 106 bits, from rest at both ends; and to how far others are off.

use super::contest::DIVERGED;
use std::f64::consts::SQRT_2;
use std::ops::{Add, Mul, Sub};

/// high + low, |low| at most half the last place of high (Dekker 1971).
#[derive(Debug, Clone, Copy)]
struct Doubled {
    high: f64,
    low: f64,
}

impl Doubled {
    const ONE: Self = Self { high: 1.0, low: 0.0 };
    /// √2 to 32 digits.
    const ROOT_2: Self = Self { high: SQRT_2, low: -9.667_293_313_452_913e-17 };

    /// One over it: Newton's step doubles the digits of the double's quotient.
    fn reciprocal(self) -> Self {
        let guess = Self::from(1.0 / self.high);
        guess + guess * (Self::ONE - self * guess)
    }
}

impl From<f64> for Doubled {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

/// The sum of two doubles and what it rounds off.
fn sum(a: f64, b: f64) -> Doubled {
    let high = a + b;
    let part = high - a;
    Doubled { high, low: (a - (high - part)) + (b - part) }
}

impl Add for Doubled {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let large = sum(self.high, other.high);
        let small = sum(self.low, other.low);
        let both = sum(large.high, large.low + small.high);
        sum(both.high, both.low + small.low)
    }
}

impl Sub for Doubled {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + Self { high: -other.high, low: -other.low }
    }
}

impl Mul for Doubled {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let low = self.high.mul_add(other.high, -high);
        sum(high, low + (self.high * other.low + self.low * other.high))
    }
}

/// Two passes of a second-order Butterworth low-pass of this g = tan(π f/f_s), in direct form I.
///
/// Direct form loses (f_s / 2π f)² of its digits: at f/f_s = 1e-6 that is 3e10 of 1e32.
pub(super) fn low_passed(samples: &[f64], gain: f64) -> Vec<f64> {
    let g = Doubled::from(gain);
    let (square, cross) = (g * g, Doubled::ROOT_2 * g);
    let scale = (Doubled::ONE + cross + square).reciprocal();
    let (b, a2) = (square * scale, (Doubled::ONE - cross + square) * scale);
    let a1 = Doubled::from(2.0) * (square - Doubled::ONE) * scale;
    let mut work: Vec<Doubled> = samples.iter().map(|x| Doubled::from(*x)).collect();
    for _ in 0..2 {
        let [mut x1, mut x2, mut y1, mut y2] = [Doubled::from(0.0); 4];
        for x in &mut work {
            let y = b * (*x + x1 + x1 + x2) - a1 * y1 - a2 * y2;
            (x2, x1, y2, y1) = (x1, *x, y1, y);
            *x = y;
        }
        work.reverse();
    }
    work.into_iter().map(|x| x.high + x.low).collect()
}

/// Largest difference of two curves over the peak of the second.
pub(super) fn worst_of_peak(made: &[f64], truth: &[f64]) -> f64 {
    let peak = truth.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let off = made.iter().zip(truth).map(|(made, truth)| (made - truth).abs());
    let worst = off.fold(0.0, |worst, off| if off.is_nan() { DIVERGED } else { off.max(worst) });
    worst / peak.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn it_keeps_thirty_digits() {
        let third = Doubled::from(3.0).reciprocal();
        // Three thirds less one is below 2⁻¹⁰⁴ = 5e-32; so is the square of √2 less two, but for its own size.
        let off = third * Doubled::from(3.0) - Doubled::ONE;
        assert!((off.high + off.low).abs() < 5e-32);
        let off = Doubled::ROOT_2 * Doubled::ROOT_2 - Doubled::from(2.0);
        assert!((off.high + off.low).abs() < 2e-31);
    }

    #[test]
    fn a_sine_takes_the_butterworth_gain() {
        // Angles of up to 190 are rounded by 1.4e-14, and so is the sine.
        let turn = 0.01_f64;
        let x: Vec<f64> = (0..6000).map(|i| (2.0 * PI * turn * f64::from(i)).cos()).collect();
        let y = low_passed(&x, (PI * 0.02).tan());
        let ratio = (PI * turn).tan() / (PI * 0.02).tan();
        let gain = 1.0 / (1.0 + ratio.powi(4));
        // 3000 samples from either end: 60/f, of which the slowest pole leaves e^(−0.7 · 2π · 60).
        assert!((2900..3100).all(|i| (y[i] - gain * x[i]).abs() < 4e-14));
    }

    #[test]
    fn a_curve_that_is_no_number_has_diverged() {
        assert!(worst_of_peak(&[1.0, f64::NAN], &[1.0, 1.0]) >= DIVERGED);
        assert!((worst_of_peak(&[1.0, 3.0], &[1.0, 2.0]) - 0.5).abs() < 1e-15);
    }
}
