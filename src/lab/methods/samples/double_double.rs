//! Numbers as the unevaluated sum of two f64: 106 bits, for references.

use std::ops::{Add, Mul, Neg, Sub};

/// high + low, |low| at most half the last place of high (Dekker 1971).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DoubleDouble {
    high: f64,
    low: f64,
}

/// 2²⁷ + 1 splits a double into two halves of 26 bits.
const SPLIT: f64 = 134_217_729.0;

fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let part = high - a;
    DoubleDouble { high, low: (a - (high - part)) + (b - part) }
}

fn halves(a: f64) -> (f64, f64) {
    let spread = SPLIT * a;
    let high = spread - (spread - a);
    (high, a - high)
}

fn two_product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    let ((a1, a2), (b1, b2)) = (halves(a), halves(b));
    DoubleDouble { high, low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2 }
}

impl DoubleDouble {
    /// π to 32 digits.
    pub(super) const PI: Self = Self { high: std::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };

    /// The nearest double.
    pub(super) fn value(self) -> f64 {
        self.high + self.low
    }

    /// One over it: Newton's step doubles the digits of the double's quotient.
    pub(super) fn reciprocal(self) -> Self {
        let guess = Self::from(1.0 / self.high);
        guess + guess * (Self::from(1.0) - self * guess)
    }

    /// Sine and cosine by their series; for arguments up to 1.6, where 32 terms leave 1e-36.
    pub(super) fn sine_and_cosine(self) -> (Self, Self) {
        let (mut sums, mut term) = ([Self::from(0.0), Self::from(1.0)], Self::from(1.0));
        for k in 1..=32_u32 {
            term = term * self * Self::from(f64::from(k)).reciprocal();
            let signed = if k % 4 >= 2 { -term } else { term };
            let sum = &mut sums[usize::from(k % 2 == 0)];
            *sum = *sum + signed;
        }
        (sums[0], sums[1])
    }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let sum = two_sum(self.high, other.high);
        let small = two_sum(self.low, other.low);
        let sum = two_sum(sum.high, sum.low + small.high);
        two_sum(sum.high, sum.low + small.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_thirty_digits() {
        let third = DoubleDouble::from(3.0).reciprocal();
        // Three thirds less one is below 2⁻¹⁰⁴ = 5e-32.
        assert!((third * DoubleDouble::from(3.0) - DoubleDouble::from(1.0)).value().abs() < 5e-32);
        let sixth = DoubleDouble::PI * DoubleDouble::from(6.0).reciprocal();
        let (sine, cosine) = sixth.sine_and_cosine();
        assert!((sine - DoubleDouble::from(0.5)).value().abs() < 1e-31);
        assert!((cosine * cosine - DoubleDouble::from(0.75)).value().abs() < 1e-31);
    }
}
