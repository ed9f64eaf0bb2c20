//! Combines repeats of one quantity, each with its interval: mean, scatter, and the repeats that do not fit
//! the others.

use super::as_f64;

/// Half-width of a 95 % interval over its standard uncertainty.
const COVERAGE: f64 = 1.96;

/// Combined result of repeats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pooled {
    /// Number of repeats.
    pub count: usize,
    /// Mean, weighted with 1/u².
    pub mean: f64,
    /// Root mean square of the half-widths: no mean reduces an error that repeats share, such as a
    /// calibration.
    pub u95: f64,
    /// Standard deviation of the repeats about their mean, n − 1; NaN for a single one.
    pub scatter: f64,
    /// Σ ((x − mean) / u)² with u = u95 / 1.96, with n − 1 degrees of freedom if the intervals are
    /// independent.
    pub chi_square: f64,
}

/// Comparison of a scatter with the stated intervals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScatterWord {
    /// χ² below its 5 % quantile.
    Smaller,
    /// Between.
    AsStated,
    /// χ² above its 95 % quantile.
    Larger,
}

/// E_n = (a − b) / √(U_a² + U_b²) of values with half-widths (ISO 13528): within ±1 they agree.
fn e_n(a: (f64, f64), b: (f64, f64)) -> f64 {
    (a.0 - b.0) / a.1.hypot(b.1)
}

/// Combines (value, half-width) pairs; `None` without any. Half-widths are above 0.
pub fn combine(values: &[(f64, f64)]) -> Option<Pooled> {
    let count = as_f64(values.len());
    let mean = mean(values)?;
    let square = |of: &dyn Fn(&(f64, f64)) -> f64| values.iter().map(|value| of(value).powi(2)).sum::<f64>();
    Some(Pooled {
        count: values.len(),
        mean,
        u95: (square(&|value| value.1) / count).sqrt(),
        scatter: (square(&|value| value.0 - mean) / (count - 1.0)).sqrt(),
        chi_square: square(&|value| COVERAGE * (value.0 - mean) / value.1),
    })
}

/// Mean weighted with 1/u².
fn mean(values: &[(f64, f64)]) -> Option<f64> {
    let weight: f64 = values.iter().map(|value| value.1.powi(-2)).sum();
    let sum: f64 = values.iter().map(|value| value.0 * value.1.powi(-2)).sum();
    (weight > 0.0).then(|| sum / weight)
}

impl Pooled {
    /// Compares the scatter with the intervals; `None` for a single repeat.
    pub fn word(&self) -> Option<ScatterWord> {
        let degrees = self.count.checked_sub(1).filter(|degrees| *degrees > 0)?;
        Some(if self.chi_square > chi_square_quantile(degrees, 1.645) {
            ScatterWord::Larger
        } else if self.chi_square < chi_square_quantile(degrees, -1.645) {
            ScatterWord::Smaller
        } else {
            ScatterWord::AsStated
        })
    }
}

/// The quantile of χ² at the normal quantile `z` (Wilson and Hilferty 1931): within 1 % of it from three
/// degrees of freedom on.
pub fn chi_square_quantile(degrees: usize, z: f64) -> f64 {
    let nu = as_f64(degrees);
    let share = 2.0 / (9.0 * nu);
    nu * (1.0 - share + z * share.sqrt()).max(0.0).powi(3)
}

/// E_n of each value against the mean of the others, and true if it is an outlier.
///
/// The value with the largest |E_n| above 1 is removed, then the others are compared again, as long as three
/// remain (largest consistent subset, Cox 2007): one wrong value does not make the correct ones look wrong.
/// If two contradict each other both are outliers.
pub fn compare_with_others(values: &[(f64, f64)]) -> Vec<(Option<f64>, bool)> {
    let weight = |i: usize| values[i].1.powi(-2);
    // The sums cover the remaining values: the mean of the others follows by subtracting one share.
    let (mut weights, mut sum) = (0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        weights += weight(i);
        sum += weight(i) * value.0;
    }
    let mut is_out = vec![false; values.len()];
    let mut left = values.len();
    let against = |i: usize, is_out: bool, weights: f64, sum: f64| {
        let own = if is_out { 0.0 } else { weight(i) };
        let others = weights - own;
        e_n(values[i], ((sum - own * values[i].0) / others, others.sqrt().recip()))
    };
    while left > 2 {
        let kept = (0..values.len()).filter(|i| !is_out[*i]);
        let sizes = kept.map(|i| (i, against(i, false, weights, sum).abs()));
        let Some((worst, size)) = sizes.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if size <= 1.0 {
            break;
        }
        is_out[worst] = true;
        left -= 1;
        weights -= weight(worst);
        sum -= weight(worst) * values[worst].0;
    }
    let found = (0..values.len()).map(|i| {
        let e_n = (values.len() > 1).then(|| against(i, is_out[i], weights, sum));
        (e_n, is_out[i] || left == 2 && e_n.is_some_and(|e_n| e_n.abs() > 1.0))
    });
    found.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pool_is_its_textbook_values() {
        let pool = combine(&[(1.0, 0.196), (1.2, 0.196), (1.1, 0.196)]).unwrap();
        assert!((pool.mean - 1.1).abs() < 1e-12 && (pool.u95 - 0.196).abs() < 1e-12);
        // u = 0.1: (1² + 1² + 0²).
        assert!((pool.chi_square - 2.0).abs() < 1e-12 && (pool.scatter - 0.1).abs() < 1e-12);
        assert_eq!(pool.word(), Some(ScatterWord::AsStated));
        assert_eq!(combine(&[(1.0, 0.1)]).unwrap().word(), None);
        assert_eq!(combine(&[]), None);
        let far = combine(&[(1.0, 0.1), (2.0, 0.1), (3.0, 0.1)]).unwrap();
        assert_eq!(far.word(), Some(ScatterWord::Larger));
        let near = combine(&[(1.0, 0.1), (1.0001, 0.1), (1.0, 0.1), (1.0, 0.1)]).unwrap();
        assert_eq!(near.word(), Some(ScatterWord::Smaller));
    }

    #[test]
    fn quantiles_are_those_of_tables() {
        for (degrees, expected) in [(3, 7.815), (10, 18.307), (30, 43.773)] {
            assert!((chi_square_quantile(degrees, 1.645) / expected - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn one_wrong_value_is_named_and_the_right_ones_are_not() {
        let found = compare_with_others(&[(1.0, 0.1), (1.02, 0.1), (1.6, 0.1), (0.99, 0.1)]);
        assert_eq!(found.iter().map(|(_, is_out)| *is_out).collect::<Vec<_>>(), [false, false, true, false]);
        assert!(found[2].0.unwrap() > 4.0 && found[0].0.unwrap().abs() < 0.2);
        assert!(compare_with_others(&[(1.0, 0.1), (2.0, 0.1)]).iter().all(|(_, is_out)| *is_out));
        assert!(compare_with_others(&[(1.0, 0.1), (1.1, 0.1)]).iter().all(|(_, is_out)| !is_out));
        assert_eq!(compare_with_others(&[(1.0, 0.1)]), [(None, false)]);
        assert!((e_n((1.0, 0.3), (2.0, 0.4)) + 2.0).abs() < 1e-12);
    }
}
