//! Two columns or datasets of times for the same samples to whether they contradict each other.

use super::time_base::{RATE_TOLERANCE, short, to_digits};
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
        let seconds = |s: f64| short(to_digits(s, 5));
        if part(worst_s) > RATE_TOLERANCE {
            // A clock that is another at the end, or one that stepped on the way.
            let whole = part(spans_s.0 - spans_s.1);
            let [one_s, other_s] = [spans_s.0, spans_s.1].map(seconds);
            let says = if whole > RATE_TOLERANCE {
                format!("from the first row to the last they say {one_s} s and {other_s} s")
            } else {
                format!("in row {} they are {} s apart", worst + 1, seconds(worst_s.abs()))
            };
            return Some((whole, says));
        }
        let whole = part(start_s);
        let says = format!("they begin {} s apart", seconds(start_s.abs()));
        (whole > RATE_TOLERANCE).then_some((whole, says))
    }
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
