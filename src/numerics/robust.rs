//! Centre and spread of samples, insensitive to a few wild values.

use super::{as_count, as_f64, reduce};

/// Median; NaN for an empty slice. Reorders `values`.
pub fn median(values: &mut [f64]) -> f64 {
    let n = values.len();
    if n == 0 {
        return f64::NAN;
    }
    let (below, &mut middle, _) = values.select_nth_unstable_by(n / 2, f64::total_cmp);
    if n % 2 == 1 {
        middle
    } else {
        let lower = below.iter().copied().max_by(f64::total_cmp).unwrap_or(middle);
        f64::midpoint(lower, middle)
    }
}

/// The value below which this share of `ascending` lies, with linear interpolation (Hyndman & Fan 1996, type
/// 7); NaN if it is empty.
pub fn quantile(ascending: &[f64], share: f64) -> f64 {
    quantile_by(ascending.len(), share, |rank| ascending[rank])
}

/// Like [`quantile`] for `count` values, each by its rank.
pub fn quantile_by(count: usize, share: f64, value: impl Fn(usize) -> f64) -> f64 {
    let Some(last) = count.checked_sub(1) else { return f64::NAN };
    let place = share * as_f64(last);
    let below = as_count(place).min(last);
    let (low, high) = (value(below), value((below + 1).min(last)));
    // Equal neighbours may be infinite.
    let beyond = place - as_f64(below);
    if beyond > 0.0 && low < high { low + beyond * (high - low) } else { low }
}

/// Most values that a spread is computed from.
const MOST: usize = 4000;

/// Every n-th value, so that at most some 4000 remain: for normal noise they give the spread to 1.8 %.
pub fn thin(values: &[f64]) -> impl Iterator<Item = f64> {
    values.iter().step_by(stride(values.len())).copied()
}

/// Distance between the values of such a sample of `count`.
pub fn stride(count: usize) -> usize {
    (count / MOST).max(1)
}

/// Standard deviation of Gaussian noise from the median distance to the median (factor 1.4826; Hampel 1974);
/// for many values from a sample.
pub fn spread(values: &[f64]) -> f64 {
    centre_and_spread(values).1
}

/// The median of such a sample, and its [`spread`].
pub fn centre_and_spread(values: &[f64]) -> (f64, f64) {
    let mut work: Vec<f64> = thin(values).collect();
    let centre = median(&mut work);
    for w in &mut work {
        *w = (*w - centre).abs();
    }
    (centre, 1.482_602_218_505_602 * median(&mut work))
}

/// Mean and its standard uncertainty: white noise averages out, a difference between the two halves does not.
pub fn mean_and_u(values: &[f64]) -> (f64, f64) {
    let (mean, rms) = mean_and_rms(values);
    let (first, second) = values.split_at(values.len() / 2);
    let wander = (mean_and_rms(first).0 - mean_and_rms(second).0).abs();
    (mean, (rms / as_f64(values.len()).sqrt()).max(wander / 2.0))
}

/// Mean and root mean square about it; NaN for an empty slice.
pub fn mean_and_rms(values: &[f64]) -> (f64, f64) {
    let n = as_f64(values.len());
    let mean = reduce::sum(values) / n;
    (mean, (reduce::sum_by(values, |v| (v - mean).powi(2)) / n).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert!((median(&mut [3.0, 1.0, 2.0]) - 2.0).abs() < 1e-15);
        assert!((median(&mut [4.0, 1.0, 2.0, 3.0]) - 2.5).abs() < 1e-15);
        assert!(median(&mut []).is_nan());
    }

    #[test]
    fn a_wild_value_does_not_move_the_spread() {
        let mut values: Vec<f64> = (-50..=50).map(f64::from).collect();
        let calm = spread(&values);
        values[0] = 1e9;
        assert!((spread(&values) - calm).abs() <= 1.5);
    }
}
