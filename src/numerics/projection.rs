//! Residual of samples after subtracting the best combination of a few regressors.

use super::reduce::dot;

/// A regressor that keeps less than this share of itself beside the others is redundant.
const DEPENDENT_SHARE: f64 = 1e-9;

/// If less than this share of a square remains, the projection is subtracted again: its rounding error is no
/// longer small beside the residual.
const NEARLY_ALL: f64 = 1e-4;

/// Sum of squares of the residual of `values` after a least-squares fit by `regressors` (each as long as
/// `values`).
///
/// Modified Gram-Schmidt; regressors that are zero or depend on the others are omitted.
pub fn residual_square(values: &[f64], regressors: Vec<Vec<f64>>) -> f64 {
    let mut left = values.to_vec();
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(regressors.len());
    for mut column in regressors {
        let before = dot(&column, &column);
        subtract_projections(&mut column, &basis);
        let mut after = dot(&column, &column);
        if after < NEARLY_ALL * before {
            subtract_projections(&mut column, &basis);
            after = dot(&column, &column);
        }
        if after > 0.0 && after > DEPENDENT_SHARE * DEPENDENT_SHARE * before {
            let length = after.sqrt();
            for c in &mut column {
                *c /= length;
            }
            subtract_projection(&mut left, &column);
            basis.push(column);
        }
    }
    dot(&left, &left)
}

fn subtract_projections(values: &mut [f64], basis: &[Vec<f64>]) {
    for unit in basis {
        subtract_projection(values, unit);
    }
}

fn subtract_projection(values: &mut [f64], unit: &[f64]) {
    let share = dot(values, unit);
    for (v, u) in values.iter_mut().zip(unit) {
        *v -= share * u;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_combination_leaves_nothing_and_the_rest_stays() {
        let regressors = vec![vec![1.0, 1.0, 1.0, 1.0], vec![0.0, 1.0, 2.0, 3.0], vec![2.0, 3.0, 4.0, 5.0]];
        // The third is twice the first and the second: it must not spoil the fit.
        assert!(residual_square(&[5.0, 7.0, 9.0, 11.0], regressors.clone()) < 1e-24);
        // (1, −1, −1, 1) is orthogonal to every line: all of its 4 stays.
        assert!((residual_square(&[6.0, 6.0, 8.0, 12.0], regressors) - 4.0).abs() < 1e-12);
        assert!((residual_square(&[3.0, 4.0], Vec::new()) - 25.0).abs() < 1e-12);
    }
}
