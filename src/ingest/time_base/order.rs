//! Times as recorded to times that rise: sorted, without doubles.

use super::error;
use crate::data::{Finding, Samples, TimesFinding};
use crate::ingest::{clock::usual_step, refusal::Refusal, shown::show};
use crate::numerics::{as_f64, extent};
use std::borrow::Cow;

/// Times that rise with their samples.
pub(super) struct Ordered<'a> {
    pub times_s: Cow<'a, [f64]>,
    pub samples: Samples,
    /// Whether many are equal to the one before although the samples differ: the times are coarser than the
    /// interval.
    pub is_coarse: bool,
}

/// From so many rows a time on they are too coarse even where the samples are equal, as those of a dead
/// channel: a file may have been written twice, but not three times.
const COARSE_ROWS: f64 = 2.5;

/// From this part of repeated times with different samples on, the times are too coarse rather than rows
/// doubled.
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
) -> Result<Ordered<'a>, Refusal> {
    if times_s.len() < 2 {
        return Err(error::too_few(times_s.len()));
    }
    if rise {
        return Ok(Ordered { times_s: Cow::Borrowed(times_s), samples, is_coarse: false });
    }
    let filled = filled(times_s, &samples);
    if filled < times_s.len() {
        issues.push(TimesFinding::Unfilled { samples: times_s.len() - filled }.into());
        let (times_s, rows) = (&times_s[..filled], (0..filled).collect::<Vec<_>>());
        return ordered(times_s, self::rise(times_s), samples.select(&rows), issues);
    }
    if let Some(index) = times_s.iter().position(|t| !t.is_finite()) {
        return Err(error::not_finite(index + 1, times_s[index]));
    }
    let taken = Ordered { times_s: without_wraps(times_s)?, samples, is_coarse: false };
    Ok(taken.sorted(issues)?.without_doubles(issues))
}

/// How many rows come before those at the end that were laid out and never filled: one time and one value in
/// all of them, and the time falls back.
fn filled(times_s: &[f64], samples: &Samples) -> usize {
    let last = times_s.len() - 1;
    let is_as_last =
        |row: &usize| is_same(times_s[*row], times_s[last]) && is_same(samples.get(*row), samples.get(last));
    let filled = times_s.len() - (0..=last).rev().take_while(is_as_last).count();
    let is_behind = filled >= 2 && filled < last && times_s[last] < times_s[filled - 1];
    if is_behind { filled } else { times_s.len() }
}

/// Times that go on where they count within each second, minute, hour or day, and fall back by one of it less
/// an interval: `999.95, 0, 0.05` in ms, beside a column of whole seconds. Sorted they would put the end of a
/// recording before its beginning.
///
/// # Errors
/// They begin at 0, as two recordings do that follow one another.
fn without_wraps(times_s: &[f64]) -> Result<Cow<'_, [f64]>, Refusal> {
    const WHOLE_S: [f64; 4] = [1.0, 60.0, 3600.0, 86_400.0];
    let falls: Vec<usize> = (1..times_s.len()).filter(|&i| times_s[i] < times_s[i - 1]).collect();
    let Some(&at) = falls.first() else { return Ok(Cow::Borrowed(times_s)) };
    let interval_s = usual_step(times_s);
    let (least_s, most_s) = extent(times_s.iter().copied());
    let is_of = |at: usize, whole_s: f64| {
        let off_s = times_s[at - 1] - times_s[at] + interval_s - whole_s;
        least_s >= 0.0 && most_s < whole_s && off_s.abs() < interval_s / 2.0
    };
    let Some(whole_s) = WHOLE_S.into_iter().find(|whole_s| is_of(at, *whole_s)) else {
        return Ok(Cow::Borrowed(times_s));
    };
    if times_s[0] > times_s[at] + 2.0 * interval_s && falls.iter().all(|&at| is_of(at, whole_s)) {
        let gone = |i: usize| whole_s * as_f64(falls.partition_point(|&fall| fall <= i));
        return Ok(times_s.iter().enumerate().map(|(i, time_s)| time_s + gone(i)).collect());
    }
    Err(Refusal::new(
        format!(
            "time number {} falls back by {whole_s} s: the times count within each, and something else holds \
             what has gone by",
            at + 1
        ),
        "write one column of times that goes on, in s, in a copy: whole seconds and fraction together",
    ))
}

/// Refuses times, in the order of the file, that begin anew and run once more over those before, or that
/// mostly do not rise: samples of several recordings or sensors are never one signal. A few late ones do no
/// harm, nor do parts that are swapped or written twice; `order` is that of the times, `is_copy` tells what
/// was written twice.
pub(super) fn no_mixture(
    times_s: &[f64],
    order: impl Iterator<Item = usize>,
    is_copy: impl Fn(usize, usize) -> bool,
) -> Result<(), Refusal> {
    /// Of so many times one may fall behind the one before, and so many of a few.
    const RISING_OF: usize = 10;
    const FEW: usize = 8;
    /// Changes from one run of rising times to another, in the order of time, that a late one makes, and one
    /// more.
    const CHANGES: usize = 4;
    let backward: Vec<usize> = (1..times_s.len()).filter(|&i| times_s[i] < times_s[i - 1]).collect();
    let Some(&first) = backward.first() else { return Ok(()) };
    let (mut last, mut changes) = (None, 0);
    for next in order {
        if last.is_some_and(|last| is_copy(last, next)) {
            continue;
        }
        let run = |at: usize| backward.partition_point(|start| *start <= at);
        changes += usize::from(last.is_some_and(|last| run(last) != run(next)));
        last = Some(next);
    }
    let count = backward.len();
    let place =
        format!("behind number {first}, from {} s to {} s", show(times_s[first - 1]), show(times_s[first]));
    if count > FEW && RISING_OF * count > times_s.len() {
        return Err(Refusal::new(
            format!(
                "{count} of its {} times fall back, first {place}: those of several sensors, or none",
                times_s.len()
            ),
            "name another source of times (`time`), or the rows of one sensor (`where`); or write \
             sample_rate_hz and take the times out",
        ));
    }
    if changes > CHANGES * count {
        return Err(Refusal::new(
            format!(
                "its times begin anew {count} time(s), first {place}: {} recordings follow one another, or \
                 the clock was set back, and samples of all would lie on the same times",
                count + 1
            ),
            "cut it there in a copy, and name the file that holds the recording of the drop",
        ));
    }
    Ok(())
}

impl Ordered<'_> {
    fn sorted(self, issues: &mut Vec<Finding>) -> Result<Self, Refusal> {
        let times_s = &self.times_s;
        let backward: Vec<usize> = (1..times_s.len()).filter(|&i| times_s[i] < times_s[i - 1]).collect();
        let Some(&first) = backward.first() else { return Ok(self) };
        let mut order: Vec<usize> = (0..times_s.len()).collect();
        order.sort_by(|&a, &b| times_s[a].total_cmp(&times_s[b]));
        let is_copy = |a: usize, b: usize| times_s[a].total_cmp(&times_s[b]).is_eq() && self.is_same(a, b);
        no_mixture(times_s, order.iter().copied(), is_copy)?;
        let (from_s, to_s) = (times_s[first - 1], times_s[first]);
        let found = TimesFinding::Backward { count: backward.len(), from_s, to_s };
        issues.push(Finding::from(found).span(to_s, from_s));
        Ok(self.picked(&order))
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
        issues.push(Finding::from(found).span(times_s[first], times_s[last]));
        self.picked(&kept)
    }

    fn picked(self, rows: &[usize]) -> Self {
        let times_s = rows.iter().map(|&row| self.times_s[row]).collect();
        Self { times_s: Cow::Owned(times_s), samples: self.samples.select(rows), ..self }
    }

    fn is_same(&self, row: usize, other: usize) -> bool {
        is_same(self.samples.get(row), self.samples.get(other))
    }
}

/// Equal, or both no number.
pub(super) fn is_same(a: f64, b: f64) -> bool {
    a.total_cmp(&b).is_eq() || (a.is_nan() && b.is_nan())
}
