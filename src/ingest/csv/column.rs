//! The wanted columns of a table in memory: each value, or of times on an even grid their rule.

use super::super::time_base::{self, RATE_TOLERANCE, TimeBaseError, Uniform};
use super::rows::{Rows, Sink, Wanted};
use super::stamp::Stamps;
use super::witness;
use crate::data::Samples;
use crate::ingest::time_reading::Clock;
use rayon::prelude::*;
use std::borrow::Cow;

/// One wanted column.
#[derive(Debug, Clone, Default)]
pub(super) struct Column {
    /// All values but these are none, where they keep to a rule.
    even: Option<Even>,
    each: Vec<f64>,
}

impl Column {
    /// For so many values without a second thought.
    pub(super) fn with_capacity(count: usize) -> Self {
        Self { even: None, each: Vec::with_capacity(count) }
    }

    /// Takes the next values; `is_time`: those of rising times, which may keep to a rule.
    fn extend(&mut self, values: &[f64], is_time: bool) {
        if is_time && self.even.is_none() && self.each.is_empty() {
            self.even = Even::of(values);
        }
        match &mut self.even {
            Some(even) if even.keeps(values) => even.count += values.len(),
            _ => self.each_mut().extend_from_slice(values),
        }
    }

    /// How many values it holds.
    pub(super) fn len(&self) -> usize {
        self.even.map_or(self.each.len(), |even| even.count)
    }

    /// The rule that all values keep.
    pub(super) fn even(&self) -> Option<Even> {
        self.even
    }

    /// The values, none where they keep to a rule.
    pub(super) fn each(&self) -> &[f64] {
        &self.each
    }

    /// The values, whether or not they keep to a rule.
    pub(super) fn values(&self) -> Cow<'_, [f64]> {
        self.even.map_or(Cow::Borrowed(&self.each), |even| Cow::Owned(even.values().collect()))
    }

    /// The values, written out.
    pub(super) fn each_mut(&mut self) -> &mut Vec<f64> {
        if let Some(even) = self.even.take() {
            self.each.extend(even.values());
        }
        &mut self.each
    }

    /// What the numbers of times say before their unit is known.
    pub(super) fn clock(&self) -> Option<Clock> {
        self.even.map_or_else(|| Clock::of(&self.each), |even| even.clock())
    }

    /// The values times `scale`.
    pub(super) fn scale(&mut self, scale: f64) {
        match &mut self.even {
            Some(even) => even.scale *= scale,
            None if (scale - 1.0).abs() > 0.0 => self.each.iter_mut().for_each(|value| *value *= scale),
            None => {}
        }
    }

    /// How far off the rate of times may be for what they are rounded to, as a part of it.
    pub(super) fn rounding(&self) -> f64 {
        // The step over the record; on an even grid nothing is rounded.
        if self.even.is_some() { 0.0 } else { witness::rounding(&self.each) }
    }
}

/// Times whose digits stand on an even grid, (first + i·step) / divisor · scale: most recorders write such, and they need no memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Even {
    first: i64,
    step: i64,
    /// A power of ten.
    divisor: f64,
    scale: f64,
    count: usize,
}

/// Whole numbers below are exact in f64.
const EXACT: i64 = 1 << 53;

impl Even {
    /// The rule of the first two values, read with as few decimals as they have, where they rise; it counts none of them yet.
    fn of(values: &[f64]) -> Option<Self> {
        /// Decimals of picoseconds in s.
        const MOST_DECIMALS: i32 = 12;
        let &[from, to, ..] = values else { return None };
        (0..=MOST_DECIMALS).find_map(|decimals| {
            let divisor = 10_f64.powi(decimals);
            let first = whole(from, divisor)?;
            let step = whole(to, divisor)? - first;
            (step > 0).then_some(Self { first, step, divisor, scale: 1.0, count: 0 })
        })
    }

    /// Value `index`, before scaling to the bit what its digits are read as.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_wrap, reason = "`keeps` stays below 2^53")]
    fn at(&self, index: usize) -> f64 {
        (self.first + self.step * index as i64) as f64 / self.divisor * self.scale
    }

    fn values(self) -> impl Iterator<Item = f64> {
        (0..self.count).map(move |index| self.at(index))
    }

    /// Whether `values` are the next ones.
    fn keeps(&self, values: &[f64]) -> bool {
        /// Values asked at once, which costs less than to ask each.
        const TOGETHER: usize = 64;
        let last = i64::try_from(self.count + values.len())
            .ok()
            .and_then(|count| self.step.checked_mul(count)?.checked_add(self.first));
        let is_next = |(index, value): (usize, &f64)| self.at(index).to_bits() == value.to_bits();
        let mut chunks = values.chunks(TOGETHER).zip((self.count..).step_by(TOGETHER));
        last.is_some_and(|last| last < EXACT)
            && chunks.all(|(chunk, from)| (from..).zip(chunk).fold(true, |all, next| all & is_next(next)))
    }

    /// Rows per unit.
    #[allow(clippy::cast_precision_loss, reason = "`keeps` stays below 2^53")]
    fn rate(&self) -> f64 {
        self.divisor / self.step as f64 / self.scale
    }

    fn clock(&self) -> Option<Clock> {
        let (first, last) = (self.at(0), self.at(self.count.checked_sub(2)? + 1));
        let counts = (self.rate() - 1.0).abs() < f64::EPSILON && self.first % self.step == 0;
        Some(Clock { first, last, rate: self.rate(), span: last - first, counts })
    }

    /// Samples at these times, s, on their base; a declared rate in Hz wins over theirs.
    ///
    /// # Errors
    /// As [`time_base::Times::place`].
    pub(super) fn place(
        &self,
        samples: Samples,
        declared_rate_hz: Option<f64>,
    ) -> Result<Uniform, TimeBaseError> {
        if samples.len() != self.count {
            return Err(TimeBaseError::Lengths { times: self.count, samples: samples.len() });
        }
        let mut uniform = time_base::from_rate(self.at(0), self.rate(), samples)?;
        match declared_rate_hz {
            Some(rate_hz) if (rate_hz / self.rate() - 1.0).abs() > RATE_TOLERANCE => uniform.at(rate_hz),
            _ => {
                uniform.sample_rate_hz = declared_rate_hz.unwrap_or(uniform.sample_rate_hz);
                Ok(uniform)
            }
        }
    }
}

/// `value` · `divisor` where that is a whole number to the last bit.
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "below 2^53")]
fn whole(value: f64, divisor: f64) -> Option<i64> {
    let whole = (value * divisor).round();
    let is_it = whole.abs() < EXACT as f64 && (whole / divisor).to_bits() == value.to_bits();
    is_it.then_some(whole as i64)
}

/// Keeps the wanted columns whole.
pub(super) struct Keep<'a> {
    wanted: &'a Wanted,
    pub columns: Vec<Column>,
    pub stamps: Stamps,
    /// Of columns that bear out others.
    other_stamps: Stamps,
}

impl<'a> Keep<'a> {
    pub(super) fn new(wanted: &'a Wanted, columns: Vec<Column>) -> Self {
        Self { wanted, columns, stamps: Stamps::default(), other_stamps: Stamps::default() }
    }
}

/// Some rows of the wanted columns.
pub(super) struct Part(Vec<Vec<f64>>);

impl Rows for Part {
    fn word(&mut self, _slot: usize, _cell: &[u8]) -> Option<f64> {
        None
    }

    fn row(&mut self, values: &[f64]) {
        for (column, &value) in self.0.iter_mut().zip(values) {
            column.push(value);
        }
    }
}

impl Rows for Keep<'_> {
    fn word(&mut self, slot: usize, cell: &[u8]) -> Option<f64> {
        if self.wanted.is_witness[slot] {
            return Some(self.other_stamps.seconds(slot, cell).unwrap_or(f64::NAN));
        }
        if self.wanted.is_time[slot] { self.stamps.seconds(slot, cell) } else { None }
    }

    fn row(&mut self, values: &[f64]) {
        for (column, &value) in self.columns.iter_mut().zip(values) {
            column.extend(&[value], false);
        }
    }
}

impl Sink for Keep<'_> {
    type Part = Part;

    fn part(&self) -> Part {
        Part(vec![Vec::new(); self.columns.len()])
    }

    fn append(&mut self, parts: &mut [Part]) {
        // Most of the time the system hands out the memory, a page after the other.
        self.columns.par_iter_mut().zip(&self.wanted.is_time).enumerate().for_each(
            |(slot, (column, is_time))| {
                for part in &*parts {
                    column.extend(&part.0[slot], *is_time);
                }
            },
        );
        parts.iter_mut().flat_map(|part| &mut part.0).for_each(Vec::clear);
    }

    fn held_bytes(&self) -> u64 {
        self.columns.iter().map(|column| 8 * column.each.len() as u64).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ingest::time_base::Times;
    use proptest::prelude::*;

    fn column(pieces: &[&[f64]]) -> Column {
        let mut column = Column::default();
        for piece in pieces {
            column.extend(piece, true);
        }
        column
    }

    /// Times as a recorder writes them: a rule in decimal digits.
    fn times(first: i64, step: i64, decimals: usize, count: i64) -> Vec<f64> {
        let digits = |value: i64| {
            let digits = format!("{:0>width$}", value.abs(), width = decimals + 1);
            let (whole, fraction) = digits.split_at(digits.len() - decimals);
            format!("{}{whole}.{fraction}", if value < 0 { "-" } else { "" }).parse().unwrap()
        };
        (0..count).map(|i| digits(first + i * step)).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

        #[test]
        fn even_times_are_a_rule_and_come_back_to_the_bit(
            first in -1_000_000_i64..1_000_000_000,
            step in 1_i64..100_000,
            decimals in 0_usize..10,
            cut in 2_usize..300,
            odd in proptest::option::of((0_usize..300, -1.0e-3_f64..1.0)),
        ) {
            // A negative zero is written by nobody and kept apart.
            prop_assume!(first >= 0 || (-first) % step != 0);
            let mut values = times(first, step, decimals, 300);
            if let Some((at, by)) = odd {
                values[at] += by;
            }
            let is_odd = values != times(first, step, decimals, 300);
            let held = column(&[&values[..cut], &values[cut..]]);
            prop_assert_eq!(held.even().is_some(), !is_odd);
            prop_assert_eq!((held.values(), held.len()), (Cow::Borrowed(&values[..]), 300));
            let mut spelled = held.clone();
            prop_assert_eq!(spelled.each_mut(), &values);
        }
    }

    #[test]
    fn a_rule_gives_the_base_of_its_times() {
        let values = times(-5, 2, 5, 1000);
        let mut samples = vec![1.0; 1000];
        samples[7] = f64::NAN;
        let even = column(&[&values]).even().expect("a rule");
        for declared_hz in [None, Some(50_010.0), Some(48_000.0)] {
            let ours = even.place(Samples::F64(samples.clone()), declared_hz).unwrap();
            let theirs = Times::new(&values).place(Samples::F64(samples.clone()), declared_hz).unwrap();
            assert!((ours.sample_rate_hz / theirs.sample_rate_hz - 1.0).abs() < 1e-12);
            assert_eq!((ours.start_s, &ours.gaps), (theirs.start_s, &theirs.gaps));
            let said = |uniform: &Uniform| {
                let mut said: Vec<_> = uniform.issues.iter().map(|issue| issue.message.clone()).collect();
                said.sort();
                said
            };
            assert_eq!(said(&ours), said(&theirs));
        }
        assert!(even.place(Samples::F64(vec![0.0; 999]), None).is_err());
    }

    #[test]
    fn a_rule_has_the_clock_of_its_times_in_any_unit() {
        let values = times(3, 20, 3, 500);
        let mut held = column(&[&values]);
        let (ours, theirs) = (held.clock().unwrap(), Clock::of(&values).unwrap());
        for (own, other) in [
            (ours.first, theirs.first),
            (ours.last, theirs.last),
            (ours.rate, theirs.rate),
            (ours.span, theirs.span),
        ] {
            assert!((own / other - 1.0).abs() < 1e-9, "{own} {other}");
        }
        for (first, counts) in [(7, true), (5, false)] {
            let values: Vec<f64> = (0..99).map(|i| f64::from(i) + f64::from(first) / 7.0).collect();
            let [ours, theirs] =
                [column(&[&values]).clock(), Clock::of(&values)].map(|clock| clock.unwrap().counts);
            assert_eq!((ours, theirs), (counts, counts));
        }
        held.scale(1e-3);
        let even = held.even().expect("a rule");
        assert!((even.rate() - 50_000.0).abs() < 1e-6 && (even.at(499) - 9.983e-3).abs() < 1e-15);
    }

    #[test]
    fn times_that_do_not_rise_or_are_no_decimals_keep_no_rule() {
        for values in
            [vec![], vec![1.0], vec![1.0, 1.0], vec![2.0, 1.0], vec![0.0, 1.0 / 3.0], vec![f64::NAN, 1.0]]
        {
            assert_eq!(column(&[&values]).even(), None, "{values:?}");
        }
    }
}
