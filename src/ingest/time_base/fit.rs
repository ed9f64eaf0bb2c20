//! Rising times to the uniform base nearest to them: start, period, and which sample belongs where.

use super::error;
use crate::ingest::clock::RATE_TOLERANCE;
use crate::ingest::refusal::Refusal;
use crate::numerics::{as_count, as_f64, robust, to_f32};
use rayon::prelude::*;
use std::ops::Range;

/// A stretch of samples without a gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    /// Its first sample among those recorded.
    pub first: usize,
    /// The place of that sample on the base.
    pub place: usize,
}

/// The base nearest to the times, t ≈ start + period · place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BaseFit {
    pub start_s: f64,
    pub period_s: f64,
    /// Runs, the first at place 0; a new one after each gap.
    pub runs: Vec<Run>,
    /// RMS distance of the times from the base, s.
    pub rms_s: f64,
    /// Largest distance, s.
    pub max_s: f64,
    /// What the times are rounded to, s; 0 where no rounding shows.
    pub resolution_s: f64,
}

/// Interval beyond which samples are missing, in periods.
const GAP_PERIODS: f64 = 1.5;

/// How many intervals the first guess of the period looks at; its median only has to be good to a third.
const GUESS_INTERVALS: usize = 4096;

/// Filling gaps may cost this many times the samples present, and `FILL_FLOOR` samples more.
pub(super) const FILL_FACTOR: f64 = 4.0;
/// See [`FILL_FACTOR`]: 8 MB, so that a short record with a long pause still reads.
pub(super) const FILL_FLOOR: f64 = 1e6;

impl BaseFit {
    /// The base nearest to strictly rising, finite times (at least two).
    pub(super) fn new(times_s: &[f64]) -> Result<Self, Refusal> {
        let guess_s = median_interval(times_s);
        let mut period_s = mean_interval(times_s, 1.75 * guess_s).unwrap_or(guess_s);
        period_s = mean_interval(times_s, GAP_PERIODS * period_s).unwrap_or(period_s);
        let mut runs = runs(times_s, period_s)?;
        let (mut line_s, mut period_s) = line_of_runs(times_s, &runs);
        if runs.len() > 1 {
            runs = self::runs(times_s, period_s)?;
            (line_s, period_s) = line_of_runs(times_s, &runs);
        }
        let (rms_s, max_s) = residual(times_s, &runs, line_s, period_s);
        let first_s = times_s[0];
        let start_s = if (line_s - first_s).abs() < 1e-6 * period_s { first_s } else { line_s };
        Ok(Self { start_s, period_s, runs, rms_s, max_s, resolution_s: resolution_s(times_s, period_s) })
    }

    /// Number of places up to the last of `count` recorded samples.
    pub(super) fn places(&self, count: usize) -> usize {
        self.runs.last().map_or(count, |run| run.place + (count - run.first))
    }
}

/// Least and largest period of parts of the times, s, where they come apart by more than both parts' scatter:
/// two rates, and no jitter.
pub(super) fn two_periods(times_s: &[f64]) -> Option<(f64, f64)> {
    const PARTS: usize = 16;
    /// Of fewer times a late one tilts the line.
    const FEWEST: usize = 16;
    /// In RMS distances of both parts' times from their lines: stamps that walk at random come apart by 8,
    /// and by 18 at most in 1200 records.
    const APART: f64 = 20.0;
    let count = FEWEST.max(times_s.len() / PARTS);
    let parts = times_s.chunks_exact(count).filter_map(|part| BaseFit::new(part).ok());
    // Beyond a gap the samples need not lie at the same phase.
    let whole: Vec<BaseFit> = parts.filter(|part| part.runs.len() == 1).collect();
    let by_period = |a: &&BaseFit, b: &&BaseFit| a.period_s.total_cmp(&b.period_s);
    let (short, long) = (whole.iter().min_by(by_period)?, whole.iter().max_by(by_period)?);
    let apart_s = (long.period_s - short.period_s) * as_f64(count);
    let is_clock = apart_s > APART * (short.rms_s + long.rms_s)
        && long.period_s > (1.0 + RATE_TOLERANCE) * short.period_s;
    is_clock.then_some((short.period_s, long.period_s))
}

/// Median of intervals taken evenly over the record.
fn median_interval(times_s: &[f64]) -> f64 {
    let count = times_s.len() - 1;
    let stride = count.div_ceil(GUESS_INTERVALS).max(1);
    let mut intervals: Vec<f64> = (0..count).step_by(stride).map(|i| times_s[i + 1] - times_s[i]).collect();
    robust::median(&mut intervals)
}

/// Mean of the intervals no longer than `limit_s`: all of them together less the few that are longer.
fn mean_interval(times_s: &[f64], limit_s: f64) -> Option<f64> {
    let last = times_s.len() - 1;
    let longer = longer_intervals(times_s, limit_s);
    let sum_s = times_s[last] - times_s[0] - longer.iter().map(|&i| times_s[i + 1] - times_s[i]).sum::<f64>();
    let count = last - longer.len();
    (count > 0 && sum_s > 0.0).then(|| sum_s / as_f64(count))
}

/// Which intervals are longer than `limit_s`, by the index of the time before each.
fn longer_intervals(times_s: &[f64], limit_s: f64) -> Vec<usize> {
    /// Intervals asked at once whether any is longer, which costs less than to ask each.
    const TOGETHER: usize = 64;
    let is_longer = |(a, b): (&f64, &f64)| b - a > limit_s;
    let of_piece = |piece: Range<usize>| {
        let mut longer = Vec::new();
        for from in piece.clone().step_by(TOGETHER) {
            let to = (from + TOGETHER).min(piece.end);
            let pairs = times_s[from..to].iter().zip(&times_s[from + 1..=to]);
            if pairs.clone().fold(false, |any, pair| any | is_longer(pair)) {
                longer.extend((from..to).zip(pairs).filter(|(_, pair)| is_longer(*pair)).map(|(i, _)| i));
            }
        }
        longer
    };
    pieces(0..times_s.len() - 1).into_par_iter().map(of_piece).collect::<Vec<_>>().concat()
}

/// A range in parts that threads take side by side.
fn pieces(whole: Range<usize>) -> Vec<Range<usize>> {
    const PIECE: usize = 1 << 16;
    whole.clone().step_by(PIECE).map(|from| from..(from + PIECE).min(whole.end)).collect()
}

/// Cuts the times at their gaps and gives each run its place on the base.
fn runs(times_s: &[f64], period_s: f64) -> Result<Vec<Run>, Refusal> {
    let limit = FILL_FACTOR.mul_add(as_f64(times_s.len()), FILL_FLOOR);
    let mut runs = vec![Run { first: 0, place: 0 }];
    let mut lost_total = 0.0;
    let mut widest = (0.0, 0);
    for i in longer_intervals(times_s, GAP_PERIODS * period_s) {
        if is_jitter(times_s, i, period_s) {
            continue;
        }
        let interval_s = times_s[i + 1] - times_s[i];
        let steps = (interval_s / period_s).round().max(1.0);
        lost_total += steps - 1.0;
        if steps > widest.0 {
            widest = (steps, i);
        }
        if lost_total > limit {
            let (steps, at) = widest;
            return Err(error::jump(times_s[at], times_s[at + 1], steps - 1.0, 1.0 / period_s));
        }
        let last = runs[runs.len() - 1];
        runs.push(Run { first: i + 1, place: last.place + (i - last.first) + as_count(steps) });
    }
    Ok(runs)
}

/// Whether a slightly long interval is made good by its neighbours: then a stamp came late, and nothing is
/// missing.
fn is_jitter(times_s: &[f64], at: usize, period_s: f64) -> bool {
    let interval_s = times_s[at + 1] - times_s[at];
    let (from, to) = (at.saturating_sub(2), (at + 3).min(times_s.len() - 1));
    let expected = as_f64(to - from) + 0.5;
    interval_s < 2.5 * period_s && to - from > 1 && times_s[to] - times_s[from] < expected * period_s
}

/// Start and period of the base nearest to the times: least squares of t over place, on what is left after a
/// first line, so that round-off stays below 1e-9 of a sample.
fn line_of_runs(times_s: &[f64], runs: &[Run]) -> (f64, f64) {
    let last = times_s.len() - 1;
    let last_place = runs.last().map_or(last, |run| run.place + (last - run.first));
    let first_s = times_s[0];
    let period_s = (times_s[last] - first_s) / as_f64(last_place);
    let middle = as_f64(last_place) / 2.0;
    let sums = over_places(times_s, runs, |sums: &mut [[f64; LANES]; 4], lane, t, place| {
        let k = place - middle;
        let r = t - first_s - period_s * place;
        for (sum, x) in sums.iter_mut().zip([r, k, k * k, k * r]) {
            sum[lane] += x;
        }
    });
    let total = |i: usize| sums.iter().flat_map(|part| part[i]).sum::<f64>();
    let (sum, sum_k, square, cross) = (total(0), total(1), total(2), total(3));
    let n = as_f64(times_s.len());
    let variance = square - sum_k * sum_k / n;
    let slope = if variance > 0.0 { (cross - sum_k * sum / n) / variance } else { 0.0 };
    let intercept = sum / n - slope * (sum_k / n + middle);
    (first_s + intercept, period_s + slope)
}

/// RMS and largest distance of the times from a base.
fn residual(times_s: &[f64], runs: &[Run], start_s: f64, period_s: f64) -> (f64, f64) {
    let parts = over_places(times_s, runs, |[squares, largest]: &mut [[f64; LANES]; 2], lane, t, place| {
        let r = t - start_s - period_s * place;
        squares[lane] += r * r;
        largest[lane] = if r.abs() > largest[lane] { r.abs() } else { largest[lane] };
    });
    let sum: f64 = parts.iter().flat_map(|part| part[0]).sum();
    ((sum / as_f64(times_s.len())).sqrt(), parts.iter().flat_map(|part| part[1]).fold(0.0, f64::max))
}

/// Sums that do not wait for one another.
const LANES: usize = 4;

/// Has `add` add each time and its place on the base to the sums of its lane; the sums of the parts that
/// threads took side by side.
fn over_places<const N: usize>(
    times_s: &[f64],
    runs: &[Run],
    add: impl Fn(&mut [[f64; LANES]; N], usize, f64, f64) + Sync,
) -> Vec<[[f64; LANES]; N]> {
    let ends = runs.iter().skip(1).map(|next| next.first).chain([times_s.len()]);
    let of_run = |(run, to): (&Run, usize)| {
        let (first, place) = (run.first, run.place);
        pieces(first..to).into_iter().map(move |piece| (as_f64(place + piece.start - first), piece))
    };
    let parts: Vec<_> = runs.iter().zip(ends).flat_map(of_run).collect();
    let of_part = |(place, piece): (f64, Range<usize>)| {
        let mut sums = [[0.0; LANES]; N];
        let mut places: [f64; LANES] = std::array::from_fn(|lane| place + as_f64(lane));
        let (lanes, rest) = times_s[piece].as_chunks::<LANES>();
        for times in lanes {
            for lane in 0..LANES {
                add(&mut sums, lane, times[lane], places[lane]);
                places[lane] += as_f64(LANES);
            }
        }
        for (lane, (&t, place)) in rest.iter().zip(places).enumerate() {
            add(&mut sums, lane, t, place);
        }
        sums
    };
    parts.into_par_iter().map(of_part).collect()
}

/// What the times are rounded to: a power of ten (printed times), single precision, or the f64 they are held
/// in.
///
/// Stretches of neighbours are looked at: times taken at a stride may all be round although those between are
/// not.
fn resolution_s(times_s: &[f64], period_s: f64) -> f64 {
    const STRETCH: usize = 300;
    let last = times_s.len().saturating_sub(STRETCH);
    let looked_at: Vec<f64> = [0, last / 2, last]
        .into_iter()
        .flat_map(|from| times_s.iter().skip(from).take(STRETCH))
        .copied()
        .collect();
    let largest_s = looked_at.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let held_s = 2.0 * largest_s * f64::EPSILON;
    if looked_at.iter().all(|&t| f64::from(to_f32(t)).total_cmp(&t).is_eq()) {
        return largest_s * f64::from(f32::EPSILON);
    }
    for digits in 0..=9 {
        let unit_s = 10_f64.powi(-digits);
        let is_multiple = |t: f64| {
            let steps = t / unit_s;
            (steps - steps.round()).abs() < 1e-3_f64.max(4.0 * steps.abs() * f64::EPSILON)
        };
        if unit_s > held_s && unit_s <= period_s && looked_at.iter().all(|&t| is_multiple(t)) {
            return unit_s;
        }
    }
    held_s
}
