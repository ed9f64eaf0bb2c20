//! Samples and a few regressors to what no combination of the regressors explains.

use super::reduce::dot;

/// A regressor that keeps less than this share of itself beside the others says nothing of its own.
const DEPENDENT: f64 = 1e-9;

/// Where less than this share of a square is left, what was taken off is taken off again: the rounding of it
/// is no longer small beside the rest.
const NEARLY_ALL: f64 = 1e-4;

/// Sum of squares that `values` keep after their least-squares fit by `regressors` (each as long as
/// `values`).
///
/// Modified Gram-Schmidt; regressors that are zero or depend on the others are left out.
pub fn residual_square(values: &[f64], regressors: Vec<Vec<f64>>) -> f64 {
    let mut left = values.to_vec();
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(regressors.len());
    for mut column in regressors {
        let before = dot(&column, &column);
        take_all_off(&mut column, &basis);
        let mut after = dot(&column, &column);
        if after < NEARLY_ALL * before {
            take_all_off(&mut column, &basis);
            after = dot(&column, &column);
        }
        if after > 0.0 && after > DEPENDENT * DEPENDENT * before {
            let length = after.sqrt();
            for c in &mut column {
                *c /= length;
            }
            take_off(&mut left, &column);
            basis.push(column);
        }
    }
    dot(&left, &left)
}

fn take_all_off(values: &mut [f64], basis: &[Vec<f64>]) {
    for unit in basis {
        take_off(values, unit);
    }
}

fn take_off(values: &mut [f64], unit: &[f64]) {
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
