//! Times as recorded to times that rise: sorted, without doubles.

use super::error::TimeBaseError;
use crate::data::{Finding, Samples, TimesFinding};
use crate::ingest::clock::{Refusal, usual_step};
use crate::numerics::as_f64;
use std::borrow::Cow;

/// Times that rise with their samples.
pub(super) struct Ordered<'a> {
    pub times_s: Cow<'a, [f64]>,
    pub samples: Samples,
    /// Whether many are equal to the one before although the samples differ: the times are coarser than the interval.
    pub is_coarse: bool,
}

/// From so many rows a time on they are too coarse even where the samples are equal, as those of a dead channel: a file may have been
/// written twice, but not three times.
const COARSE_ROWS: f64 = 2.5;

/// From this part of repeated times with different samples on, the times are too coarse rather than rows doubled.
const COARSE_PART: f64 = 0.1;

/// Whether each time is finite and later than the one before.
pub(super) fn rise(times_s: &[f64]) -> bool {
    /// Times asked at once, which costs less than to ask each.
    const TOGETHER: usize = 64;
    let Some((first_s, next_s)) = times_s.split_first() else { return false };
    // A NaN fails this comparison as well.
    let pairs = times_s.chunks(TOGETHER).zip(next_s.chunks(TOGETHER));
    let rising = pairs.map(|(a, b)| a.iter().zip(b).filter(|(a, b)| a < b).count()).sum::<usize>();
    first_s.is_finite() && rising == next_s.len() && times_s[times_s.len() - 1] < f64::MAX
}

/// Sorts by time where needed and drops rows that came twice; `rise` is what [`rise`] says of the times.
pub(super) fn ordered<'a>(
    times_s: &'a [f64],
    rise: bool,
    samples: Samples,
    issues: &mut Vec<Finding>,
) -> Result<Ordered<'a>, TimeBaseError> {
    if times_s.len() < 2 {
        return Err(TimeBaseError::TooFew { count: times_s.len() });
    }
    let taken = Ordered { times_s: Cow::Borrowed(times_s), samples, is_coarse: false };
    if rise {
        return Ok(taken);
    }
    if let Some(index) = times_s.iter().position(|t| !t.is_finite()) {
        return Err(TimeBaseError::NotFinite { number: index + 1, time_s: times_s[index] });
    }
    if let Some(refusal) = wrapped(times_s) {
        return Err(refusal.into());
    }
    Ok(taken.sorted(issues).without_doubles(issues))
}

/// Times that count within each second, minute, hour or day, and fall back by one of it less an interval: `999.95, 0, 0.05` in ms, beside a
/// column of whole seconds. Sorted they would put the end of a recording before its beginning.
fn wrapped(times_s: &[f64]) -> Option<Refusal> {
    const WHOLE_S: [f64; 4] = [1.0, 60.0, 3600.0, 86_400.0];
    let at = (1..times_s.len()).find(|&i| times_s[i] < times_s[i - 1])?;
    let interval_s = usual_step(times_s);
    let (least_s, most_s) = times_s.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), t| (a.min(*t), b.max(*t)));
    let is_it = |whole_s: &f64| {
        let off_s = times_s[at - 1] - times_s[at] + interval_s - whole_s;
        least_s >= 0.0 && most_s < *whole_s && off_s.abs() < interval_s / 2.0
    };
    let whole_s = WHOLE_S.into_iter().find(is_it)?;
    Some(Refusal::new(
        format!(
            "time number {} falls back by {whole_s} s: the times count within each, and something else holds what has gone by",
            at + 1
        ),
        "write one column of times that goes on, in s, in a copy: whole seconds and fraction together",
    ))
}

/// Where times in the order of the file begin anew and run once more over those before; late ones and parts that are swapped do not.
pub(super) fn restart(times_s: &[f64]) -> Option<usize> {
    /// So many lie before the last of the first run.
    const OVER: usize = 3;
    let mut backward = (1..times_s.len()).filter(|&i| times_s[i] < times_s[i - 1]);
    let (at, None) = (backward.next()?, backward.next()) else { return None };
    let is_over = times_s.get(at + OVER - 1).is_some_and(|time_s| *time_s < times_s[at - 1]);
    (at >= OVER && is_over && times_s[0] < times_s[times_s.len() - 1]).then_some(at)
}

/// A warning that says so.
pub(super) fn restarted(times_s: &[f64], at: usize) -> Finding {
    let (rise_to_s, next_s) = (times_s[at - 1], times_s[at]);
    Finding::from(TimesFinding::Restarted { count: at, rise_to_s, next_s }).between(next_s, rise_to_s)
}

impl Ordered<'_> {
    fn sorted(self, issues: &mut Vec<Finding>) -> Self {
        let times_s = &self.times_s;
        let backward: Vec<usize> = (1..times_s.len()).filter(|&i| times_s[i] < times_s[i - 1]).collect();
        let Some(&first) = backward.first() else { return self };
        let (from_s, to_s) = (times_s[first - 1], times_s[first]);
        let found = TimesFinding::Backward { count: backward.len(), from_s, to_s };
        issues.push(Finding::from(found).between(to_s, from_s));
        let mut order: Vec<usize> = (0..times_s.len()).collect();
        order.sort_by(|&a, &b| times_s[a].total_cmp(&times_s[b]));
        let restart = restart(times_s).filter(|&at| self.are_mixed(&order, at));
        issues.extend(restart.map(|at| restarted(times_s, at)));
        self.picked(&order)
    }

    /// Whether samples from `at` on lie among those before, in the order of their times; rows that were written twice do not, nor do a few
    /// runs that were swapped.
    fn are_mixed(&self, order: &[usize], at: usize) -> bool {
        /// Changes from one part to the other that two runs out of place make.
        const SWAPPED: usize = 4;
        let is_copy =
            |a: usize, b: usize| self.times_s[a].total_cmp(&self.times_s[b]).is_eq() && self.is_same(a, b);
        let (mut last, mut changes) = (order[0], 0);
        for &next in &order[1..] {
            if !is_copy(last, next) {
                changes += usize::from((last < at) != (next < at));
                last = next;
            }
        }
        changes > SWAPPED
    }

    /// Drops rows whose time equals the one before.
    fn without_doubles(self, issues: &mut Vec<Finding>) -> Self {
        let times_s = &self.times_s;
        let mut kept: Vec<usize> = vec![0];
        let (mut doubles, mut different) = (Vec::new(), 0_usize);
        for i in 1..times_s.len() {
            let last = kept[kept.len() - 1];
            if times_s[i] > times_s[last] {
                kept.push(i);
            } else {
                doubles.push(i);
                different += usize::from(!self.is_same(i, last));
            }
        }
        let (Some(&first), Some(&last)) = (doubles.first(), doubles.last()) else { return self };
        let rows = as_f64(times_s.len());
        let is_coarse = as_f64(different) > COARSE_PART * rows
            || rows > COARSE_ROWS * as_f64(kept.len())
            || kept.len() < 2;
        if is_coarse {
            return Self { is_coarse, ..self };
        }
        let found = TimesFinding::CameTwice { samples: doubles.len(), different };
        issues.push(Finding::from(found).between(times_s[first], times_s[last]));
        self.picked(&kept)
    }

    fn picked(self, rows: &[usize]) -> Self {
        let times_s = rows.iter().map(|&row| self.times_s[row]).collect();
        Self { times_s: Cow::Owned(times_s), samples: self.samples.picked(rows), ..self }
    }

    fn is_same(&self, row: usize, other: usize) -> bool {
        is_same(self.samples.get(row), self.samples.get(other))
    }
}

/// Equal, or both no number.
pub(super) fn is_same(a: f64, b: f64) -> bool {
    a.total_cmp(&b).is_eq() || (a.is_nan() && b.is_nan())
}
