//! Two columns or datasets of times for the same samples to where they run apart.

use super::time_base::{self, RATE_TOLERANCE, short, to_digits};
use super::time_reading::{self, Scale};

/// Times further apart than this part of the record leave open which are right.
pub(super) const FAR: f64 = 1e-2;

/// Times without a unit are taken to be meant as those that they are within this factor of: other units are farther.
const ALIKE: f64 = 3.0;

/// Two columns of times in the same rows.
pub(super) struct Pair {
    /// Of the rows that hold both, the first as s.
    rows: Vec<(f64, f64)>,
    /// Of either, what its times are cut to.
    steps: (f64, f64),
}

impl Pair {
    /// `None` where the second does not rise: it is no time that goes on.
    pub(super) fn of(times_s: &[f64], others: &[f64]) -> Option<Self> {
        let both = times_s.iter().copied().zip(others.iter().copied());
        let rows: Vec<(f64, f64)> = both.filter(|(a, b)| a.is_finite() && b.is_finite()).collect();
        let (times_s, others): (Vec<f64>, Vec<f64>) = rows.iter().copied().unzip();
        let steps = (step(&times_s), step(&others));
        let is_rising = steps.1 > 0.0 && others.windows(2).all(|pair| pair[0] <= pair[1]);
        is_rising.then_some(Self { rows, steps })
    }

    /// By what part of the record the two are apart at most, or in their whole where it is the clocks that differ, and how, in words.
    pub(super) fn contradiction(&self, scale: Scale, is_start_shared: bool) -> Option<(f64, String)> {
        match scale {
            Scale::Known(unit_s) => self.contradiction_at(unit_s, is_start_shared),
            Scale::Unknown | Scale::Twofold(..) => None,
            Scale::Open => {
                // A counter of the rows.
                if self.rows.windows(2).all(|pair| (pair[1].1 - pair[0].1 - 1.0).abs() < 1e-9) {
                    return None;
                }
                let (from, to) = (self.rows.first()?, self.rows.last()?);
                let ratio = |unit_s: f64| (to.1 - from.1) * unit_s / (to.0 - from.0);
                // In ticks of something else it says nothing.
                let near = time_reading::UNITS.iter().map(|unit| unit.1).chain([60.0, 3600.0, 86_400.0]);
                let unit_s =
                    near.into_iter().find(|unit_s| (1.0 / ALIKE..ALIKE).contains(&ratio(*unit_s)))?;
                self.contradiction_at(unit_s, false)
            }
        }
    }

    fn contradiction_at(&self, unit_s: f64, is_start_shared: bool) -> Option<(f64, String)> {
        let (first, last) = (*self.rows.first()?, *self.rows.last()?);
        let spans_s = (last.0 - first.0, (last.1 - first.1) * unit_s);
        let cut_s = self.steps.0 + self.steps.1 * unit_s;
        let part = |miss_s: f64| ((miss_s.abs() - cut_s) / spans_s.0.abs()).max(0.0);
        let apart_s = |row: &(f64, f64)| (row.1 - first.1) * unit_s - (row.0 - first.0);
        let (worst, worst_s) = self
            .rows
            .iter()
            .map(apart_s)
            .enumerate()
            .fold((0, 0.0_f64), |held, (i, s)| if s.abs() > held.1.abs() { (i, s) } else { held });
        let start_s = if is_start_shared { first.1 * unit_s - first.0 } else { 0.0 };
        // Stamps of a day are no start.
        let start_s = if start_s.abs() < spans_s.0.abs() { start_s } else { 0.0 };
        if part(worst_s) > RATE_TOLERANCE {
            // A clock that is another at the end, or one that stepped on the way.
            let whole = part(spans_s.0 - spans_s.1);
            let [one_s, other_s] = [spans_s.0, spans_s.1].map(seconds);
            if whole > RATE_TOLERANCE {
                let says = format!("from the first row to the last they say {one_s} s and {other_s} s");
                return Some((whole, says));
            }
            let says =
                format!("in row {} of the table they are {} s apart", worst + 1, seconds(worst_s.abs()));
            return self.changes(unit_s).and_then(|changes| changes.rate()).or(Some((whole, says)));
        }
        let whole = part(start_s);
        let says = format!("they begin {} s apart", seconds(start_s.abs()));
        if whole > RATE_TOLERANCE {
            return Some((whole, says));
        }
        let changes = self.changes(unit_s)?;
        changes.rate().or_else(|| changes.step())
    }

    /// The rows in which the second column changes; `None` where the first goes back between them.
    fn changes(&self, unit_s: f64) -> Option<Changes> {
        let later = self.rows.windows(2).enumerate().filter(|(_, pair)| pair[1].1 > pair[0].1);
        let rows: Vec<(usize, f64, f64)> =
            later.map(|(i, pair)| (i + 2, pair[1].0, pair[1].1 * unit_s)).collect();
        let is_rising = rows.windows(2).all(|pair| pair[1].1 > pair[0].1);
        is_rising.then_some(Changes { rows, interval_s: self.steps.0 })
    }
}

/// Where a column of times changes, beside another: a clock that is read with each row changes within one row of what it says.
struct Changes {
    /// Row of the table, from 1, and both times, s.
    rows: Vec<(usize, f64, f64)>,
    /// Of the rows by the first column, s.
    interval_s: f64,
}

impl Changes {
    /// How far the second column's own rate is off, as a part of it, where its changes tell one.
    fn rate(&self) -> Option<(f64, String)> {
        let &(_, first_s, first_other_s) = self.rows.first()?;
        let points: Vec<(f64, f64)> = self
            .rows
            .iter()
            .map(|row| ((row.1 - first_s) / self.interval_s, row.2 - first_other_s))
            .collect();
        let held_s = self.rows.last().map_or(0.0, |row| 4.0 * f64::EPSILON * row.2.abs());
        let (period_s, uncertainty) = time_base::period_of_changes(&points, held_s)?;
        let pace = period_s / self.interval_s;
        let span_s = self.rows.last()?.1 - first_s;
        let says = format!(
            "by when the second changes it runs on by {} s while the first does by {} s",
            seconds(span_s * pace),
            seconds(span_s)
        );
        let off = (pace - 1.0).abs();
        (off > RATE_TOLERANCE.max(uncertainty)).then_some((off, says))
    }

    /// Where the second column steps against the first for good; the largest step where there are several. No part of the rate is off.
    fn step(&self) -> Option<(f64, String)> {
        /// Changes on either side that have to keep to their level, at least and at most: stamps late once come back to it.
        const LEAST: usize = 5;
        const MOST: usize = 8;
        let apart_s: Vec<f64> = self.rows.iter().map(|row| row.2 - row.1).collect();
        let steps_s: Vec<f64> = apart_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut sizes_s: Vec<f64> = steps_s.iter().map(|step_s| step_s.abs()).collect();
        if sizes_s.len() < 2 * LEAST {
            return None;
        }
        // What the clocks jitter against each other, nine of ten steps, and the row within which they change.
        let usual = sizes_s.len() * 9 / 10;
        let usual_s = *sizes_s.select_nth_unstable_by(usual, f64::total_cmp).1;
        let jitter_s = usual_s + self.interval_s;
        let level = |range: std::ops::Range<usize>| {
            let mut level: Vec<f64> = apart_s[range.clone()].to_vec();
            level.sort_unstable_by(f64::total_cmp);
            let drift_s = RATE_TOLERANCE * (self.rows[range.end - 1].1 - self.rows[range.start].1);
            // Stamps of blocks saw: they are on no level.
            let is_level = level[level.len() - 1] - level[0] <= 2.0 * jitter_s + drift_s;
            is_level.then_some((level[level.len() / 2], drift_s))
        };
        let mut largest: Option<(usize, f64)> = None;
        for i in (0..steps_s.len()).filter(|&i| steps_s[i].abs() > jitter_s) {
            // The step itself makes a change, within what it steps by.
            let behind = i + 2;
            let count = MOST.min(i + 1).min(apart_s.len().saturating_sub(behind));
            if count < LEAST {
                continue;
            }
            let Some((before_s, drift_s)) = level(i + 1 - count..i + 1) else { continue };
            let Some((behind_s, further_s)) = level(behind..behind + count) else { continue };
            let by_s = (behind_s - before_s).abs();
            // Across a tick the rate may be off as within the levels.
            let drift_s = drift_s + further_s + RATE_TOLERANCE * (self.rows[behind].1 - self.rows[i].1);
            if by_s > 2.0 * jitter_s + drift_s && largest.is_none_or(|(_, held_s)| by_s > held_s) {
                largest = Some((self.rows[i + 1].0, by_s));
            }
        }
        let (row, by_s) = largest?;
        let says = format!(
            "at row {row} of the table the second steps by {} s against the first, as where rows are missing or a clock was set",
            seconds(by_s)
        );
        Some((0.0, says))
    }
}

fn seconds(s: f64) -> String {
    short(to_digits(s, 5))
}

/// The usual step from a time to a later one: their interval, or what they are cut to where that is longer; 0 without any.
pub(super) fn step(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|d| *d > 0.0).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}
