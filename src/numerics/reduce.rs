//! Sums, means and extremes of samples, in as many partial results as a processor computes at once: a single
//! one waits for each step.

use super::{as_count, as_f64};

const LANES: usize = 8;

/// Number of samples averaged into one, to reduce the rate to about `rate_hz`.
pub fn block_size(rate_hz: f64, sample_rate_hz: f64) -> usize {
    as_count(sample_rate_hz / rate_hz).max(1)
}

/// Means of whole blocks; remaining samples at the end are ignored.
pub fn block_means(samples: &[f64], block: usize) -> Vec<f64> {
    if block < LANES {
        // The blocks are summed one by one: parallel lanes would cost more than the few sums.
        return samples.chunks_exact(block).map(|chunk| chunk.iter().sum::<f64>() / as_f64(block)).collect();
    }
    samples.chunks_exact(block).map(|chunk| sum(chunk) / as_f64(block)).collect()
}

/// A moving mean of the values, and its width: wide enough that white noise of `noise` falls to `least`, but
/// at most a tenth of the pulse's length, which is its sum over its `peak`. `None` if that is below three.
pub fn average_noise(values: &[f64], noise: f64, least: f64, peak: f64) -> Option<(Vec<f64>, usize)> {
    let longest = as_count(sum(values).abs() / peak / 10.0);
    let half = as_count((noise / least).powi(2)).min(longest) / 2;
    if half == 0 || half >= values.len() {
        return None;
    }
    let mut sums = vec![0.0; values.len() + 1];
    for (i, value) in values.iter().enumerate() {
        sums[i + 1] = sums[i] + value;
    }
    let mean = |i: usize| {
        let (from, to) = (i.saturating_sub(half), (i + half + 1).min(values.len()));
        (sums[to] - sums[from]) / as_f64(to - from)
    };
    Some(((0..values.len()).map(mean).collect(), 2 * half + 1))
}

/// Means of the finite values in each block, the last of which may be shorter; NaN for a block without any.
pub fn finite_block_means<T: Copy + Into<f64>>(samples: &[T], block: usize) -> Vec<f64> {
    let mean = |chunk: &[T]| {
        let whole = sum_by(chunk, Into::into) / as_f64(chunk.len());
        if whole.is_finite() {
            return whole;
        }
        let finite = || chunk.iter().map(|&x| x.into()).filter(|x: &f64| x.is_finite());
        finite().sum::<f64>() / as_f64(finite().count())
    };
    samples.chunks(block.max(1)).map(mean).collect()
}

/// Smallest |x − y| of neighbours above `least`; infinite if there is none.
pub fn least_step<T: Copy + Into<f64>>(samples: &[T], least: f64) -> f64 {
    let mut smallest = [f64::INFINITY; LANES];
    let Some(next) = samples.get(1..) else { return f64::INFINITY };
    for (x, y) in samples.chunks(LANES).zip(next.chunks(LANES)) {
        for ((smallest, &x), &y) in smallest.iter_mut().zip(x).zip(y) {
            let step = (x.into() - y.into()).abs();
            let step = if step > least { step } else { f64::INFINITY };
            *smallest = if step < *smallest { step } else { *smallest };
        }
    }
    smallest.into_iter().fold(f64::INFINITY, f64::min)
}

/// Evaluates [`least_step`]; 0 if there is none or if it does not exceed `limit`, which the first samples
/// often decide.
pub fn least_step_beyond(samples: &[f64], least: f64, limit: f64) -> f64 {
    const FIRST: usize = 4096;
    let within = |samples: &[f64]| least_step(samples, least);
    if within(&samples[..samples.len().min(FIRST)]) <= limit {
        return 0.0;
    }
    Some(within(samples)).filter(|step| *step > limit && step.is_finite()).unwrap_or(0.0)
}

/// Step of the converter behind the samples: the smallest change that exceeds rounding; 0 if nothing changes.
pub fn converter_step(samples: &[f64]) -> f64 {
    least_step_beyond(samples, 1e-9 * peak(samples), 0.0)
}

/// Σ x.
pub fn sum(values: &[f64]) -> f64 {
    sum_by(values, |x| x)
}

/// Σ f(x).
pub fn sum_by<T: Copy>(values: &[T], f: impl Fn(T) -> f64) -> f64 {
    let (lanes, rest) = values.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for chunk in lanes {
        for (sum, x) in sums.iter_mut().zip(chunk) {
            *sum += f(*x);
        }
    }
    sums.iter().sum::<f64>() + rest.iter().map(|x| f(*x)).sum::<f64>()
}

/// Σ x y, as far as the shorter one goes.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (&a[..a.len().min(b.len())], &b[..b.len().min(a.len())]);
    let ((a_lanes, a_rest), (b_lanes, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (x, y) in a_lanes.iter().zip(b_lanes) {
        for ((sum, x), y) in sums.iter_mut().zip(x).zip(y) {
            *sum += x * y;
        }
    }
    sums.iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum::<f64>()
}

/// Smallest and largest of the finite values and `start`.
pub fn extremes<T: Copy + Into<f64>>(values: &[T], start: f64) -> (f64, f64) {
    // Comparisons with NaN are false, so these two are one instruction each.
    let follow = |(low, high): (&mut f64, &mut f64), x: f64| {
        *low = if x < *low { x } else { *low };
        *high = if x > *high { x } else { *high };
    };
    let (mut low, mut high) = ([start; LANES], [start; LANES]);
    let (lanes, rest) = values.as_chunks::<LANES>();
    for chunk in lanes {
        for ((low, high), &x) in low.iter_mut().zip(&mut high).zip(chunk) {
            follow((low, high), x.into());
        }
    }
    for &x in rest {
        follow((&mut low[0], &mut high[0]), x.into());
    }
    let found = (low.into_iter().fold(start, f64::min), high.into_iter().fold(start, f64::max));
    if found.0.is_finite() && found.1.is_finite() {
        return found;
    }
    let finite = values.iter().map(|&x| x.into()).filter(|x: &f64| x.is_finite());
    finite.fold((start, start), |(low, high), x| (low.min(x), high.max(x)))
}

/// Largest finite |x|; 0 if there is none.
pub fn peak(values: &[f64]) -> f64 {
    let (low, high) = extremes(values, 0.0);
    high.max(-low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_means_are_those_by_hand() {
        let values: Vec<f64> = (1..=21).map(f64::from).collect();
        assert!((sum(&values) - 231.0).abs() < 1e-12);
        // Σ n² to 21 is 21 · 22 · 43 / 6; only the first three of the other are there.
        assert!((dot(&values, &values) - 3311.0).abs() < 1e-12);
        assert!((sum_by(&values, |x| x * x) - 3311.0).abs() < 1e-12);
        assert!((dot(&values, &[1.0, 1.0, 2.0]) - 9.0).abs() < 1e-12);
        assert_eq!(block_means(&values, 10), [5.5, 15.5]);
        assert_eq!((block_size(2e3, 5e5), block_size(2e3, 1e3)), (250, 1));
    }

    #[test]
    fn blocks_and_steps_pass_over_what_is_missing() {
        let samples = [1.0_f32, 3.0, f32::NAN, 5.0, f32::NAN, f32::NAN, 7.0];
        let means = finite_block_means(&samples, 2);
        assert_eq!(means[..2], [2.0, 5.0]);
        assert!(means[2].is_nan() && (means[3] - 7.0).abs() < 1e-12);
        // Across the ends of lanes too: 12 even steps of 4, one of 0.5, one below what counts.
        let mut samples: Vec<f64> = (0..13).map(|i| 4.0 * f64::from(i)).collect();
        samples.extend([48.5, 48.5 + 1e-10]);
        assert!((least_step(&samples, 1e-9) - 0.5).abs() < 1e-12);
        assert!(least_step(&[1.0_f32], 0.0).is_infinite() && least_step::<f32>(&[], 0.0).is_infinite());
    }

    #[test]
    fn extremes_are_of_numbers_only() {
        let mut values: Vec<f32> = (0..19_u8).map(|i| f32::from(i) - 9.0).collect();
        values[3] = f32::NAN;
        assert_eq!(extremes(&values, 0.0), (-9.0, 9.0));
        values[12] = f32::INFINITY;
        values[18] = f32::NEG_INFINITY;
        assert_eq!(extremes(&values, 0.0), (-9.0, 8.0));
        assert_eq!(extremes(&values, 20.0), (-9.0, 20.0));
        assert_eq!(extremes::<f64>(&[], 3.0), (3.0, 3.0));
        assert!((peak(&[1.0, -4.0, f64::NAN]) - 4.0).abs() < 1e-15);
    }
}
