//! Times that keep to a rule to their base, without holding each.
//!
//! At 1e7 samples 70 of 244 MiB and a tenth of the reading are the times of a recorder that writes such, as
//! most do.

use super::super::clock::{self, Claims};
use super::super::refusal::Refusal;
use super::super::time_base::{self, Uniform};
use super::super::times::Counted;
use crate::data::Samples;

/// Times whose digits stand on an even grid, (first + i·step) / divisor · scale: most recorders write such,
/// and they need no memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Even {
    first: i64,
    step: i64,
    /// A power of ten.
    divisor: f64,
    /// Seconds a unit.
    pub scale: f64,
    /// How many there are.
    pub count: usize,
}

/// Whole numbers below are exact in f64.
const EXACT: i64 = 1 << 53;

impl Even {
    /// The rule of the first two values, read with as few decimals as they have, where they rise; it counts
    /// none of them yet.
    pub(super) fn of(values: &[f64]) -> Option<Self> {
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

    pub(super) fn values(self) -> impl Iterator<Item = f64> {
        (0..self.count).map(move |index| self.at(index))
    }

    /// Whether `values` are the next ones.
    pub(super) fn keeps(&self, values: &[f64]) -> bool {
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

    /// What the bare numbers say of the time that they count.
    pub(super) fn counted(&self) -> Option<Counted> {
        let (first, last) = (self.at(0), self.at(self.count.checked_sub(2)? + 1));
        let is_counter = (self.rate() - 1.0).abs() < f64::EPSILON && self.first % self.step == 0;
        Some(Counted { first, last, rate: self.rate(), span: last - first, is_counter })
    }

    /// Samples at these times, s, on their base, at the rate that [`Claims::weigh`] takes.
    ///
    /// # Errors
    /// As [`time_base::ChannelTimes::place`].
    pub(super) fn place(&self, samples: Samples, claims: &Claims) -> Result<Uniform, Refusal> {
        time_base::check_lengths(self.count, samples.len())?;
        let taken = claims.weigh(Some(&clock::of_times(self.rate(), 0.0)))?;
        let span_s = Some((self.at(0), self.at(self.count.max(1) - 1)));
        Ok(Uniform { span_s, ..time_base::at_taken(self.at(0), taken, samples)? })
    }
}

/// `value` · `divisor` where that is a whole number to the last bit.
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "below 2^53")]
fn whole(value: f64, divisor: f64) -> Option<i64> {
    let whole = (value * divisor).round();
    let is_it = whole.abs() < EXACT as f64 && (whole / divisor).to_bits() == value.to_bits();
    is_it.then_some(whole as i64)
}
