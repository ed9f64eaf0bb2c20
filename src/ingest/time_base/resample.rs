//! Samples at jittering times to samples at uniform times, by local cubic interpolation.

use super::fit::{BaseFit, two_periods};
use crate::data::{Jitter, Samples, of_either};
use crate::numerics::{as_count, as_f64, reduce};

/// Samples moved onto a base, and how far their times are from it: what that may cost is how far cubic and
/// linear interpolation lie apart, in percent of the largest sample.
pub(super) struct Resampled {
    pub start_s: f64,
    pub samples: Samples,
    pub jitter: Jitter,
}

/// The samples at the places of the base that the record covers, NaN in gaps; a place half a period beyond an
/// end holds its value.
pub(super) fn resample(times_s: &[f64], samples: &Samples, fit: &BaseFit) -> Resampled {
    let last = times_s.len() - 1;
    let place = |t: f64| (t - fit.start_s) / fit.period_s;
    let first_place = place(times_s[0]).round();
    let count = as_count(place(times_s[last]).round() - first_place).saturating_add(1);
    let start_s = fit.start_s + first_place * fit.period_s;
    let mut next_run = 1;
    let (mut at, mut sum, mut max) = (0, 0.0, 0.0_f64);
    let mut moved = Vec::with_capacity(count);
    let (low, high) = of_either!(samples, v => reduce::extremes(v, samples.get(0)));
    for i in 0..count {
        let t = fit.start_s + (first_place + as_f64(i)) * fit.period_s;
        while at + 2 < times_s.len() && times_s[at + 1] <= t {
            at += 1;
        }
        while fit.runs.get(next_run).is_some_and(|run| run.first <= at) {
            next_run += 1;
        }
        let in_gap = fit.runs.get(next_run).is_some_and(|run| run.first == at + 1);
        if in_gap {
            moved.push(nearest(times_s, samples, at, (t, fit.period_s)));
            continue;
        }
        let linear = linear(times_s, samples, at, t);
        // Beyond what was recorded a cubic would leave the flat top of a pulse that was cut off.
        let cubic = cubic(times_s, samples, at, t).map_or(linear, |value| value.clamp(low, high));
        if linear.is_finite() {
            let difference = (cubic - linear).abs();
            sum += difference * difference;
            max = max.max(difference);
        }
        moved.push(cubic);
    }
    let largest = high.max(-low);
    let percent = if largest > 0.0 { 100.0 / largest } else { 0.0 };
    let rms = (sum / as_f64(count.max(1))).sqrt();
    let (rms_percent, max_percent) = (rms * percent, max * percent);
    let rates_hz = two_periods(times_s).map(|(short_s, long_s)| (1.0 / short_s, 1.0 / long_s));
    let &BaseFit { period_s, rms_s, max_s, .. } = fit;
    let jitter = Jitter { period_s, rms_s, max_s, rms_percent, max_percent, rates_hz };
    Resampled { start_s, samples: samples.match_precision(moved), jitter }
}

/// In a gap: the sample at its edge where that is within half a period, else none.
fn nearest(times_s: &[f64], samples: &Samples, at: usize, place: (f64, f64)) -> f64 {
    let (t, period_s) = place;
    if t - times_s[at] < 0.5 * period_s {
        samples.get(at)
    } else if times_s[at + 1] - t <= 0.5 * period_s {
        samples.get(at + 1)
    } else {
        f64::NAN
    }
}

fn linear(times_s: &[f64], samples: &Samples, at: usize, t: f64) -> f64 {
    let (a, b) = (samples.get(at), samples.get(at + 1));
    let part = ((t - times_s[at]) / (times_s[at + 1] - times_s[at])).clamp(0.0, 1.0);
    a + part * (b - a)
}

/// Lagrange's cubic through the two samples on either side; `None` at ends and where neighbours are missing
/// or too unevenly spaced.
fn cubic(times_s: &[f64], samples: &Samples, at: usize, t: f64) -> Option<f64> {
    let from = at.checked_sub(1)?;
    let x: &[f64; 4] = times_s.get(from..from + 4)?.try_into().ok()?;
    let (before, middle, after) = (x[1] - x[0], x[2] - x[1], x[3] - x[2]);
    // Spacings beyond 3 : 1 make the cubic overshoot, and a gap among them has no meaning for the slope.
    if before.max(after) > 3.0 * middle || middle > 3.0 * before.min(after) {
        return None;
    }
    // Newton's divided differences.
    let [y0, y1, y2, y3] = [0, 1, 2, 3].map(|i| samples.get(from + i));
    let slope = (y2 - y1) / middle;
    let left = (slope - (y1 - y0) / before) / (x[2] - x[0]);
    let right = ((y3 - y2) / after - slope) / (x[3] - x[1]);
    let third = (right - left) / (x[3] - x[0]);
    let value = y1 + (t - x[1]) * (slope + (t - x[2]) * (left + (t - x[0]) * third));
    value.is_finite().then_some(value)
}
