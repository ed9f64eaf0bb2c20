//! Ratings of two curves on one uniform base by ISO/TS 18571: corridor, phase, magnitude, slope.

use super::{as_count, as_f64, extent};
use std::ops::Range;

/// The grid for which ISO/TS 18571 states its parameters, s.
pub const RATING_STEP_S: f64 = 1e-4;
/// A slope is the mean of this many differences: a shorter curve has none.
const SLOPE_WIDTH: usize = 9;

/// Corridors and limits of ISO/TS 18571, as shares of the largest reference value, of the length, or of the
/// reference's own sum.
const INNER_CORRIDOR: f64 = 0.05;
const OUTER_CORRIDOR: f64 = 0.5;
const MOST_SHIFT: f64 = 0.2;
/// Warping stays within one of this many parts of the length.
const WARPING_PARTS: usize = 10;
const MOST_MAGNITUDE_ERROR: f64 = 0.5;
const MOST_SLOPE_ERROR: f64 = 2.0;
/// Weights in the total; the corridor has the first, the others the second.
const WEIGHTS: [f64; 2] = [0.4, 0.2];

/// Ratings of two curves: 1 is equal, 0 is beyond every limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveRating {
    /// Share of the curve within the corridors, the outer one weighted.
    pub corridor: f64,
    /// Rating by the shift with which both curves correlate best.
    pub phase: f64,
    /// Rating by the difference that remains after that shift and a warping of time.
    pub magnitude: f64,
    /// Rating by the slopes after that shift.
    pub slope: f64,
}

impl CurveRating {
    /// The weighted sum.
    pub fn total(&self) -> f64 {
        WEIGHTS[0] * self.corridor + WEIGHTS[1] * (self.phase + self.magnitude + self.slope)
    }
}

/// Rates `curve` against `reference`, both of one length on steps of [`RATING_STEP_S`]; `None` if they are
/// too short for a slope, or the reference is constant.   (54)
pub fn rate(reference: &[f64], curve: &[f64]) -> Option<CurveRating> {
    let count = reference.len();
    // The shortest part that a shift may leave must have a slope.
    let (least, most) = extent(reference.iter().copied());
    if count != curve.len() || count < 2 * SLOPE_WIDTH || least >= most {
        return None;
    }
    let most_steps = MOST_SHIFT * as_f64(count);
    let [reference_at, curve_at] = best_shift(reference, curve);
    let steps = as_f64(count - curve_at.len());
    let (moved, against) = (&curve[curve_at], &reference[reference_at]);
    let slope_error = relative_difference(slopes(moved).zip(slopes(against)));
    let magnitude_error = relative_difference(warp_time(moved, against).into_iter());
    Some(CurveRating {
        corridor: corridor(reference, curve),
        phase: (1.0 - steps / most_steps).max(0.0),
        magnitude: (1.0 - magnitude_error / MOST_MAGNITUDE_ERROR).max(0.0),
        slope: (1.0 - slope_error / MOST_SLOPE_ERROR).max(0.0),
    })
}

fn corridor(reference: &[f64], curve: &[f64]) -> f64 {
    let norm = reference.iter().fold(0.0_f64, |most, r| most.max(r.abs()));
    let within = |(r, c): (&f64, &f64)| {
        let share = (OUTER_CORRIDOR - (r - c).abs() / norm) / (OUTER_CORRIDOR - INNER_CORRIDOR);
        share.clamp(0.0, 1.0).powi(2)
    };
    reference.iter().zip(curve).map(within).sum::<f64>() / as_f64(reference.len())
}

/// Sum of the absolute differences over that of the absolute second values.
fn relative_difference(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (off, all) = pairs.fold((0.0, 0.0), |(off, all), (c, r)| (off + (c - r).abs(), all + r.abs()));
    if off > 0.0 { off / all } else { 0.0 }
}

/// The overlapping samples of reference and curve at the smallest of the shifts that correlate best.
fn best_shift(reference: &[f64], curve: &[f64]) -> [Range<usize>; 2] {
    let count = reference.len();
    let most = as_count(MOST_SHIFT * as_f64(count));
    // For equal shifts a curve that is late comes first.
    let shifts = (0..=most).flat_map(|n| [[0..count - n, n..count], [n..count, 0..count - n]]);
    let mut best = (f64::NEG_INFINITY, [0..count, 0..count]);
    for [of_reference, of_curve] in shifts {
        let correlation = correlation(&reference[of_reference.clone()], &curve[of_curve.clone()]);
        if correlation > best.0 {
            best = (correlation, [of_reference, of_curve]);
        }
    }
    best.1
}

/// Pearson's coefficient; NaN if a curve is constant.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let [mean_a, mean_b] = [a, b].map(|values| values.iter().sum::<f64>() / as_f64(values.len()));
    let mut sums = [0.0; 3];
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        for (sum, product) in sums.iter_mut().zip([a * b, a * a, b * b]) {
            *sum += product;
        }
    }
    sums[0] / (sums[1] * sums[2]).sqrt()
}

/// Central differences per step, each the mean of up to nine of its neighbours.
fn slopes(values: &[f64]) -> impl Iterator<Item = f64> {
    let last = values.len() - 1;
    let differences: Vec<f64> = (0..=last)
        .map(|i| {
            let (from, to) = (i.saturating_sub(1), (i + 1).min(last));
            (values[to] - values[from]) / as_f64(to - from)
        })
        .collect();
    (0..=last).map(move |i| {
        let beside = i.min(last - i).min(SLOPE_WIDTH / 2);
        let mean = &differences[i - beside..=i + beside];
        mean.iter().sum::<f64>() / as_f64(mean.len())
    })
}

/// The values of both curves along the path of least squared difference through a band about equal times
/// (dynamic time warping).
fn warp_time(curve: &[f64], reference: &[f64]) -> Vec<(f64, f64)> {
    let count = curve.len();
    // The part is rounded up, and the last place within it is one less.
    let reach = count.div_ceil(WARPING_PARTS) - 1;
    let width = 2 * reach + 1;
    // Column `reach` of a row is the sample of equal time; the origin of the path is stored with the cost.
    let mut from = vec![[0_u8; 2]; count * width];
    let mut above = vec![f64::INFINITY; width + 1];
    for (i, value) in curve.iter().enumerate() {
        let mut left = f64::INFINITY;
        for column in reach.saturating_sub(i)..width.min(count + reach - i) {
            let (up, diagonal) = (above[column + 1], above[column]);
            let steps = [(up, [1, 0]), (left, [0, 1]), (diagonal, [1, 1])];
            let begins = (if i == 0 && column == reach { 0.0 } else { f64::INFINITY }, [0, 0]);
            // The first of equal ones is used, as in the reference program.
            let (cost, step) = steps.into_iter().fold(begins, |a, b| if b.0 < a.0 { b } else { a });
            left = cost + (value - reference[i + column - reach]).powi(2);
            (above[column], from[i * width + column]) = (left, step);
        }
    }
    let (mut i, mut j) = (count - 1, count - 1);
    let mut path = vec![(curve[i], reference[j])];
    while (i, j) != (0, 0) {
        let [up, left] = from[i * width + j + reach - i].map(usize::from);
        (i, j) = (i - up, j - left);
        path.push((curve[i], reference[j]));
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A half sine, and a decaying sine from its beginning on, as in tests/reference/ratings.py.
    fn value(t: f64, pulse_s: f64, ring_hz: f64) -> f64 {
        let pulse = if (0.0..=pulse_s).contains(&t) { (TAU / 2.0 * t / pulse_s).sin() } else { 0.0 };
        let ring = if t >= 0.0 { 0.3 * (-t / 0.03).exp() * (TAU * ring_hz * t).sin() } else { 0.0 };
        pulse + ring
    }

    /// A curve of so many samples, or its running sum.
    fn curve(count: f64, [scale, late_s]: [f64; 2], [pulse_s, ring_hz]: [f64; 2], is_sum: bool) -> Vec<f64> {
        let at = |i: usize| scale * value(as_f64(i) * RATING_STEP_S - late_s, pulse_s, ring_hz);
        let mut sum = 0.0;
        let value = |i| {
            sum = if is_sum { sum + at(i) } else { at(i) };
            sum
        };
        (0..as_count(count)).map(value).collect()
    }

    #[test]
    fn ratings_are_those_of_the_reference_program() {
        let table = include_str!("../../tests/reference/ratings.tsv");
        let rows: Vec<Vec<f64>> = table
            .lines()
            .skip(1)
            .map(|line| line.split('\t').map(|cell| cell.parse().expect("a number")).collect())
            .collect();
        assert_eq!(rows.len(), 40);
        for row in rows {
            let [count, pulse_s, scale, late_s, ring_hz, is_sum, parts @ ..] = &row[..] else { panic!() };
            let is_sum = *is_sum > 0.0;
            let reference = curve(*count, [1.0, 0.0], [*pulse_s, 60.0], is_sum);
            let compared = curve(*count, [*scale, *late_s], [*pulse_s, *ring_hz], is_sum);
            let rating = rate(&reference, &compared).expect("a rating");
            let CurveRating { corridor, phase, magnitude, slope } = rating;
            for (own, reference) in [corridor, phase, magnitude, slope, rating.total()].iter().zip(parts) {
                assert!((own - reference).abs() < 0.005, "{row:?}: {rating:?}");
            }
        }
    }

    #[test]
    fn a_constant_or_a_short_reference_is_not_rated() {
        let sine = curve(40.0, [1.0, 0.0], [0.004, 60.0], false);
        assert_eq!(rate(&[3.0; 40], &sine), None);
        assert_eq!(rate(&sine[..17], &sine[..17]), None);
        assert_eq!(rate(&sine, &sine[1..]), None);
        let nothing = rate(&sine, &[0.0; 40]).expect("a rating");
        assert!(nothing.magnitude.abs() < 1e-12 && nothing.total() < 0.7, "{nothing:?}");
    }
}
