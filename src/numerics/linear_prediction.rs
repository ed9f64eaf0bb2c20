//! Difference between each value of a series and its linear prediction from the values before it (a robust
//! fit).

use super::{as_f64, reduce, robust};
use nalgebra::{DMatrix, DVector};

/// Largest number of earlier values in a prediction: an offset and three damped sines need seven, noise and
/// filters on them more.
pub const MOST_BEFORE: usize = 12;
/// Least number of values per unknown, so that a short series is not fitted to its noise.
const VALUES_EACH: usize = 8;
/// Least number of unknowns: an offset and one damped sine, and noise.
const LEAST_BEFORE: usize = 4;
/// Rounds of the robust fit: a further one changes the largest residual over its spread by less than 2 %.
const ROUNDS: usize = 8;
/// A value off by this many spreads counts half (Cauchy's weight, 95 % as sharp as least squares on normal
/// noise; Holland & Welsch 1977).
const HALF_AT: f64 = 2.385;
/// Regularisation of the fit of a series without any noise, as a share of its largest square: noise a
/// millionth of the series.
const RIDGE: f64 = 1e-12;

/// Residual of a series after its prediction from earlier values.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearPrediction {
    /// Number of values at its beginning that have too few before them.
    pub before: usize,
    /// Each other value less its prediction.
    pub left: Vec<f64>,
    /// Standard deviation of the residual by the median, corrected for the fitted unknowns.
    pub spread: f64,
    /// Factor by which independent errors of single values grow in the residual.
    pub gain: f64,
}

/// x_i = c + Σ_k a_k x_(i−k) + e_i   (21c), c and a by least squares in which wild e_i count little; `None`
/// for too short a series.
pub fn predict_linearly(values: &[f64]) -> Option<LinearPrediction> {
    let before = (values.len() / VALUES_EACH).min(MOST_BEFORE);
    if before < LEAST_BEFORE {
        return None;
    }
    let count = values.len() - before;
    let ones = vec![1.0; count];
    let columns: Vec<&[f64]> =
        std::iter::once(&ones[..]).chain((1..=before).map(|k| &values[before - k..][..count])).collect();
    let target = &values[before..];
    let unknowns = as_f64(columns.len());
    let finest = RIDGE.sqrt() * reduce::peak(values);
    let mut weights = ones.clone();
    let mut solved = DVector::zeros(columns.len());
    let (mut left, mut spread) = (target.to_vec(), 0.0);
    for _ in 0..ROUNDS {
        solved = weighted_fit(&columns, target, &weights)?;
        left.copy_from_slice(target);
        for (column, share) in columns.iter().zip(&solved) {
            for (l, x) in left.iter_mut().zip(*column) {
                *l -= share * x;
            }
        }
        spread = robust::spread(&left) * (as_f64(count) / (as_f64(count) - unknowns)).sqrt();
        let wild = (HALF_AT * spread).max(finest).max(f64::MIN_POSITIVE);
        for (weight, l) in weights.iter_mut().zip(&left) {
            *weight = 1.0 / (1.0 + (l / wild).powi(2));
        }
    }
    let gain = (1.0 + solved.iter().skip(1).map(|a| a * a).sum::<f64>()).sqrt();
    Some(LinearPrediction { before, left, spread, gain })
}

/// The coefficients of the columns that leave the smallest residual of the target, each row with its weight.
fn weighted_fit(columns: &[&[f64]], target: &[f64], weights: &[f64]) -> Option<DVector<f64>> {
    let size = columns.len();
    let (mut normal, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
    for (i, column) in columns.iter().enumerate() {
        let weighted: Vec<f64> = column.iter().zip(weights).map(|(x, w)| x * w).collect();
        for (j, other) in columns.iter().enumerate().take(i + 1) {
            normal[(i, j)] = reduce::dot(&weighted, other);
            normal[(j, i)] = normal[(i, j)];
        }
        right[i] = reduce::dot(&weighted, target);
    }
    let ridge = RIDGE * normal.diagonal().max();
    for i in 0..size {
        normal[(i, i)] += ridge;
    }
    Some(normal.cholesky()?.solve(&right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn noise(i: u32) -> f64 {
        let mut hash = (u64::from(i) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        hash = (hash ^ (hash >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        f64::from(((hash >> 32) & 0xFFFF) as u16) / 65_536.0 - 0.5
    }

    /// Two damped sines on an offset, 60 ms at 8 kHz, with noise of ± 0.5.
    fn ringing(i: u32) -> f64 {
        let t = f64::from(i) / 8e3;
        let mode = |hz: f64, size: f64| size * (-3.0 * hz * 0.02 * t).exp() * (TAU * hz * t).cos();
        3.0 + mode(80.0, 200.0) + mode(310.0, 90.0) + noise(i)
    }

    fn largest(found: &LinearPrediction) -> (usize, f64) {
        let far = found.left.iter().map(|l| l.abs() / found.spread).enumerate();
        far.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, far)| (i + found.before, far)).expect("a value")
    }

    #[test]
    fn damped_sines_foretell_themselves() {
        let found = predict_linearly(&(0..480).map(ringing).collect::<Vec<_>>()).expect("long enough");
        // Noise of 0.29 and what the twelve values before carry of it; of 468 normal values the largest is 3
        // spreads off.
        assert!(found.spread < 0.29 * found.gain && found.spread > 0.25, "{found:?}");
        assert!(largest(&found).1 < 5.0, "{:?}", largest(&found));
    }

    #[test]
    fn a_blow_is_not_foretold() {
        // Half a sine of 2 ms, an eighth of what rings.
        let blow = |i: u32| {
            if (200..216).contains(&i) { 30.0 * (f64::from(i - 200) * TAU / 32.0).sin() } else { 0.0 }
        };
        let values: Vec<f64> = (0..480).map(|i| ringing(i) + blow(i)).collect();
        let (at, far) = largest(&predict_linearly(&values).expect("long enough"));
        assert!((199..219).contains(&at) && far > 9.0, "{at} {far}");
    }

    #[test]
    fn neither_too_few_values_nor_none_that_differ_are_a_fault() {
        assert!(predict_linearly(&[1.0; 31]).is_none());
        let flat = predict_linearly(&[1.0; 200]).expect("long enough");
        assert!(flat.left.iter().all(|l| l.abs() < 1e-6), "{flat:?}");
    }
}
