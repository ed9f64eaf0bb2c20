//! Whole numbers beside samples to what they are by content: a counter of the rows, or the ids of sensors by
//! turns.

use super::clock::usual_step;
use super::refusal::Refusal;
use crate::data::{Finding, TableFinding};
use crate::numerics::{as_count, as_f64, robust};
use std::borrow::Cow;

/// Fewer numbers show no pattern.
const LEAST: usize = 16;
/// More sensors than this by turns are not told from a counter that begins anew.
const MOST_BY_TURNS: usize = 4;
/// A counter loses at most so many rows as its first wrap ends, where no second wrap confirms it.
const MOST_LOST_IN_WRAP: f64 = 64.0;

/// A clock that counts keeps its steps within this part.
const JITTER: f64 = 0.05;

/// A column that counts the rows, or blocks of as many rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Counter {
    step: f64,
    /// At which it begins anew.
    wrap: Option<f64>,
    /// So many rows have one number.
    rows_each: usize,
}

impl Counter {
    /// The rule of numbers that rise, or fall, by one step in nine rows of ten, modulo the wrap that they
    /// show.
    pub(super) fn of(counts: &[f64]) -> Option<Self> {
        if counts.len() < LEAST || !counts.iter().all(|count| count.abs() < 2_f64.powi(53)) {
            return None;
        }
        let changes = counts.windows(2).filter(|pair| pair[0].total_cmp(&pair[1]).is_ne()).count();
        // Of single rows two may have one number where as many are missing as the counter has.
        let (numbers, rows_each) = if 3 * changes > 2 * counts.len() {
            (Cow::Borrowed(counts), 1)
        } else {
            (counts.chunk_by(PartialEq::eq).map(|run| run[0]).collect(), rows_each(counts)?)
        };
        let steps: Vec<f64> = numbers.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let step = robust::median(&mut steps.clone());
        let falls = steps.iter().filter(|d| **d * step < 0.0);
        let wraps: Vec<f64> = falls.map(|d| (step - d).abs()).collect();
        if numbers.len() < LEAST || step == 0.0 || 3 * wraps.len() > counts.len() {
            return None;
        }
        let are_whole = || counts.iter().all(|count| count.fract() == 0.0);
        let wrap = if wraps.is_empty() { None } else { Some(wrap_of(&wraps, step.abs())?) };
        let counter = Self { step, wrap, rows_each };
        let lost = || steps.iter().map(|d| counter.lost(*d));
        // One that stands still or rises by less now and then is a clock.
        let is_clock =
            lost().any(|lost| lost < -JITTER || (lost - lost.round()).abs() > JITTER * (lost + 1.0));
        let is_steady = 10 * lost().filter(|lost| lost.round() == 0.0).count() >= 9 * steps.len();
        (is_steady && !is_clock && (wrap.is_none() || are_whole())).then_some(counter)
    }

    /// How many numbers a step leaves out.
    fn lost(&self, step: f64) -> f64 {
        let step = if step * self.step <= 0.0 {
            step + self.wrap.unwrap_or_default() * self.step.signum()
        } else {
            step
        };
        step / self.step - 1.0
    }

    /// Where rows are missing: the row before, and how many.
    pub(super) fn jumps(&self, counts: &[f64]) -> Vec<(usize, f64)> {
        let (mut row, mut jumps) = (0, Vec::new());
        let is_one = |one: &f64, other: &f64| self.rows_each > 1 && one.total_cmp(other).is_eq();
        let runs = counts.chunk_by(is_one);
        for (at, (run, next)) in runs.clone().zip(runs.skip(1)).enumerate() {
            row += run.len();
            let short = if at == 0 { 0 } else { self.rows_each.saturating_sub(run.len()) };
            let lost = self.lost(next[0] - run[0]).round() * as_f64(self.rows_each) + as_f64(short);
            jumps.extend((lost >= 1.0).then_some((row - 1, lost)));
        }
        jumps
    }

    /// The counts without their wraps, where there are any.
    pub(super) fn unwrapped(&self, counts: &[f64]) -> Option<Vec<f64>> {
        let wrap = self.wrap? * self.step.signum();
        let (mut turns, mut before) = (0.0, counts[0] - self.step);
        let all = counts.iter().map(|count| {
            turns += if (*count - before) * self.step <= 0.0 { wrap } else { 0.0 };
            before = *count;
            count + turns
        });
        Some(all.collect())
    }
}

/// How many rows have one number each time: as many in nine blocks of ten, and none more; the first and the
/// last may be cut.
fn rows_each(counts: &[f64]) -> Option<usize> {
    let runs: Vec<usize> = counts.chunk_by(PartialEq::eq).map(<[f64]>::len).collect();
    let mut lengths = runs[..runs.len() - 1].to_vec();
    lengths.sort_unstable();
    let rows_each = *lengths.get(lengths.len() / 2)?;
    let even = lengths.iter().filter(|length| **length == rows_each).count();
    let is_over = runs.iter().any(|length| *length > rows_each);
    (!is_over && 10 * (even + 1) >= 9 * lengths.len()).then_some(rows_each)
}

/// The wrap that most falls show; a single one must be that of a converter or of decimal digits, since a
/// second recording begins anew too.
fn wrap_of(wraps: &[f64], step: f64) -> Option<f64> {
    let count = |wrap: f64| wraps.iter().filter(|own| **own - wrap == 0.0).count();
    let most = wraps.iter().copied().max_by(|a, b| (count(*a), *a).partial_cmp(&(count(*b), *b)).unwrap())?;
    if wraps.len() > 1 && 2 * count(most) > wraps.len() {
        return Some(most);
    }
    let natural = (4..=32).map(|bits| 2_f64.powi(bits)).chain((1..=9).map(|digits| 10_f64.powi(digits)));
    let least = wraps.iter().copied().fold(0.0, f64::max);
    let fitting = natural.filter(|wrap| (0.0..=MOST_LOST_IN_WRAP * step).contains(&(wrap - least)));
    fitting.min_by(f64::total_cmp)
}

/// Numbers beside samples as stretches of even steps, as long as these are few: those of a counter or a
/// constant are, and those of a signal are not kept.
#[derive(Debug, Clone, Default)]
pub(super) struct SteadyNumbers {
    stretches: Vec<EvenSteps>,
    count: usize,
}

#[derive(Debug, Clone)]
struct EvenSteps {
    first: f64,
    step: f64,
    count: usize,
}

impl SteadyNumbers {
    pub(super) fn push(&mut self, number: f64) {
        self.count += 1;
        match self.stretches.last_mut() {
            None if self.count > 1 => {}
            Some(last) if last.count == 1 => (last.step, last.count) = (number - last.first, 2),
            Some(last) if last.goes_on(number) => last.count += 1,
            _ => self.stretches.push(EvenSteps { first: number, step: 0.0, count: 1 }),
        }
        self.keep_few();
    }

    /// Moves over those that follow.
    pub(super) fn append(&mut self, other: &mut Self) {
        let is_lost = self.is_lost() || other.is_lost();
        self.count += std::mem::take(&mut other.count);
        self.stretches.append(&mut other.stretches);
        if is_lost {
            self.stretches.clear();
        }
        self.keep_few();
    }

    fn is_lost(&self) -> bool {
        self.count > 0 && self.stretches.is_empty()
    }

    fn keep_few(&mut self) {
        if self.stretches.len() > 64 + self.count / 4 {
            self.stretches = Vec::new();
        }
    }

    /// Each of them; none of a signal.
    pub(super) fn values(&self) -> Vec<f64> {
        let each =
            |it: &EvenSteps| (0..it.count).map(|at| it.first + it.step * as_f64(at)).collect::<Vec<_>>();
        self.stretches.iter().flat_map(each).collect()
    }

    /// The one number that all are.
    pub(super) fn constant(&self) -> Option<f64> {
        let first = self.stretches.first()?.first;
        let is_it = |it: &EvenSteps| it.first - first == 0.0 && it.step == 0.0;
        (self.count > 1 && self.stretches.iter().all(is_it)).then_some(first)
    }
}

impl EvenSteps {
    fn goes_on(&self, number: f64) -> bool {
        (self.first + self.step * as_f64(self.count) - number).abs() <= 1e-3 * self.step.abs()
    }
}

/// The number in a cell of words that may count the rows: `R00535`, `0x217`.
pub(super) fn of_words(cell: &str) -> Option<f64> {
    if let Some(digits) = cell.strip_prefix("0x") {
        return u32::from_str_radix(digits, 16).ok().map(f64::from);
    }
    let digits = cell.trim_start_matches(|c: char| !c.is_ascii_digit());
    digits.parse::<u32>().ok().map(f64::from)
}

/// Values with rows put in that are missing, so many behind each row that is named.
pub(super) fn with_missing(held: &[f64], missing: &[(usize, f64)]) -> Vec<f64> {
    let (mut all, mut from) = (Vec::new(), 0);
    for &(row, count) in missing {
        all.extend_from_slice(&held[from..=row]);
        all.resize(all.len() + as_count(count), f64::NAN);
        from = row + 1;
    }
    all.extend_from_slice(&held[from..]);
    all
}

/// A counter of rows, and where it shows some to be missing.
#[derive(Debug, Clone)]
pub(super) struct RowCounter {
    /// Its column or field.
    pub header: String,
    /// The rows, from 0, behind which some are missing, and how many.
    pub jumps: Vec<(usize, f64)>,
    rows: usize,
}

impl RowCounter {
    /// By its numbers, one a row; `None` where they count nothing.
    pub(super) fn of(header: &str, counts: &[f64]) -> Option<Self> {
        let jumps = Counter::of(counts)?.jumps(counts);
        Some(Self { header: header.to_owned(), jumps, rows: counts.len() })
    }

    /// How many rows are missing.
    pub(super) fn lost(&self) -> f64 {
        self.jumps.iter().map(|(_, lost)| lost).sum()
    }

    /// Whether rows are missing, and no more than there are.
    pub(super) fn shows_loss(&self) -> bool {
        !self.jumps.is_empty() && self.lost() <= as_f64(self.rows)
    }

    /// That the missing rows were put in, where it shows some.
    pub(super) fn finding(&self) -> Finding {
        let (row, count) = self.jumps[0];
        TableFinding::CounterJumps { header: self.header.clone(), lost: self.lost(), count, row: row + 1 }
            .into()
    }

    /// What it says of times, called `times`, that go on over missing rows; nothing where they leave room.
    ///
    /// # Errors
    /// They go on, and are not those that the cask file names.
    pub(super) fn beside(
        &self,
        times_s: &[f64],
        times: &str,
        are_named: bool,
    ) -> Result<Option<Finding>, Refusal> {
        // As many times as rows, or they are refused where they are taken.
        let is_each = times_s.len() == self.rows;
        if !is_each || self.jumps.iter().all(|(row, lost)| is_room(times_s, *row, *lost)) {
            return Ok(None);
        }
        let ((row, first), lost, header) = (self.jumps[0], self.lost(), self.header.clone());
        let row = row + 1;
        if are_named {
            let times = times.to_owned();
            return Ok(Some(TableFinding::CounterBesideTimes { header, lost, row, times }.into()));
        }
        Err(Refusal::new(
            format!(
                "{header:?} counts the rows, and {lost} of them are missing, the first {first} behind row \
                 {row}, where the times in {times:?} go on without a gap"
            ),
            format!(
                "where the counter is right write time = {header:?} under [recording] of the cask file and \
                 sample_rate_hz into each [[channel]]; where it counts something else write time = {times:?}"
            ),
        ))
    }
}

/// Whether times leave room for so many rows that are missing behind a row; those that are cut to more than
/// the samples' interval show nothing.
fn is_room(times: &[f64], row: usize, lost: f64) -> bool {
    let (near, next) = (&times[row.saturating_sub(8)..=row], &times[row + 1..times.len().min(row + 9)]);
    let is_cut = |times: &[f64]| times.windows(2).any(|pair| pair[1] <= pair[0]);
    let usual = usual_step(&[near, next].concat());
    !is_cut(near) && !is_cut(next) && times[row + 1] - times[row] > (lost + 0.5) * usual
}

/// Whether few whole numbers return one after another in nine rows of ten: the ids of sensors by turns.
pub(super) fn are_ids_by_turns(ids: &[f64]) -> bool {
    let mut seen: Vec<f64> = Vec::new();
    for id in ids {
        if id.fract() != 0.0 || id.is_nan() {
            return false;
        }
        if !seen.contains(id) {
            seen.push(*id);
        }
        if seen.len() > MOST_BY_TURNS {
            return false;
        }
    }
    let count = seen.len();
    let is_next = |pair: &&[f64]| {
        let place = |id: f64| seen.iter().position(|own| *own - id == 0.0).unwrap_or_default();
        (place(pair[0]) + 1) % count == place(pair[1])
    };
    let next = ids.windows(2).filter(is_next).count();
    count > 1 && ids.len() >= LEAST.max(4 * count) && as_f64(next) >= 0.9 * as_f64(ids.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(rows: std::ops::Range<u32>, step: u32, wrap: u32, lost: &[u32]) -> Vec<f64> {
        rows.filter(|row| !lost.contains(row)).map(|row| f64::from(row * step % wrap)).collect()
    }

    #[test]
    fn whole_numbers_that_rise_by_one_step_count_the_rows_whatever_their_wrap() {
        for (step, wrap) in
            [(1, u32::MAX), (1, 256), (1, 100), (1, 1000), (10, u32::MAX), (10, 65_536), (3, 256)]
        {
            let all = counts(0..1000, step, wrap, &[535, 536, 537, 538]);
            let counter = Counter::of(&all).unwrap();
            assert_eq!(counter.jumps(&all), [(534, 4.0)], "{step} {wrap}");
            let plain = counter.unwrapped(&all).unwrap_or(all);
            assert_eq!(plain.last(), Some(&f64::from(999 * step)), "{step} {wrap}");
        }
        let lost_in_wrap = counts(0..400, 1, 256, &[255, 256, 257]);
        assert_eq!(Counter::of(&lost_in_wrap).unwrap().jumps(&lost_in_wrap), [(254, 3.0)]);
        let from_one: Vec<f64> = counts(0..1000, 1, 100, &[7]).iter().map(|count| count + 1.0).collect();
        assert_eq!(Counter::of(&from_one).unwrap().jumps(&from_one), [(6, 1.0)]);
    }

    #[test]
    fn a_counter_is_held_against_as_many_times_as_it_has_rows() {
        let all = counts(0..1000, 1, u32::MAX, &[535, 536]);
        let counter = RowCounter::of("n", &all).unwrap();
        let times_s: Vec<f64> = (0..all.len()).map(as_f64).collect();
        assert!(counter.shows_loss() && counter.beside(&times_s, "t", false).is_err());
        assert!(matches!(counter.beside(&times_s, "t", true), Ok(Some(_))));
        assert!(matches!(counter.beside(&times_s[..500], "t", false), Ok(None)));
        assert!(matches!(counter.beside(&all, "t", false), Ok(None)));
    }

    #[test]
    fn numbers_that_fall_and_blocks_and_clocks_of_another_name_count_too() {
        let lost = |row: &u32| !(535..539).contains(row);
        let rows = || (0..1000_u32).filter(lost).map(f64::from);
        let ticks = |row: f64| 100.0 * row + f64::from(u8::from(row % 7.0 > 5.0));
        for counts in [
            rows().map(|row| 5000.0 - row).collect::<Vec<f64>>(),
            rows().map(|row| 255.0 - row % 256.0).collect(),
            rows().map(|row| row % 8.0).collect(),
            rows().map(|row| row % 5.0).collect(),
            rows().map(|row| 1e-4 * row).collect(),
            rows().map(ticks).collect(),
        ] {
            assert_eq!(Counter::of(&counts).unwrap().jumps(&counts), [(534, 4.0)], "{counts:?}");
        }
        let blocks: Vec<f64> = rows().map(|row| (row / 4.0).floor()).collect();
        assert_eq!(Counter::of(&blocks).unwrap().jumps(&blocks), [(534, 1.0), (535, 3.0)]);
    }

    #[test]
    fn clocks_constants_and_records_that_begin_anew_are_no_counters() {
        let none: [Vec<f64>; 5] = [
            vec![21.0; 100],
            (0..100).map(|i| f64::from(i / 16)).collect(),
            (0..100).map(|i| f64::from(i) + f64::from(u8::from(i % 20 == 7))).collect(),
            (0..100).map(|i| f64::from(i * i)).collect(),
            counts(0..859, 1, 600, &[]),
        ];
        assert!(none.iter().all(|counts| Counter::of(counts).is_none()));
    }

    #[test]
    fn numbers_that_return_one_after_another_are_ids() {
        for cycle in [&[0.0, 1.0][..], &[7.0, 3.0, 5.0], &[1.0, 2.0, 3.0, 4.0]] {
            let ids: Vec<f64> = cycle.iter().copied().cycle().take(100).collect();
            assert!(are_ids_by_turns(&ids), "{cycle:?}");
        }
        let flag: Vec<f64> = (0..100).map(|i| f64::from(u8::from(i % 20 > 9))).collect();
        let low_bits: Vec<f64> = (0_u32..100).map(|i| f64::from(i * i * 7 % 11 % 3)).collect();
        for other in [flag, low_bits, vec![0.0; 100], counts(0..100, 1, 7, &[])] {
            assert!(!are_ids_by_turns(&other), "{other:?}");
        }
    }
}
