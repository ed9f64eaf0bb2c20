//! What the messages of one topic gave for one field, to uniform samples.

use super::extent::Extent;
use super::numbers::{append, push};
use super::plan::{StatedRate, Value};
use crate::data::{Samples, acceleration_unit_m_s2};
use crate::ingest::clock::{Claims, Refusal};
use crate::ingest::shown;
use crate::ingest::statement::Statement;
use crate::ingest::time_base::{self, Block, BlockContent, PREFIX, TimeBaseError, Uniform};
use crate::ingest::vocabulary::Meaning;

/// Where a message's time comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TimeOrigin {
    /// Its own stamp.
    Stamp,
    /// The log time: it has no stamp.
    LogTime,
    /// The log time: its stamp is zero or not understood.
    LogTimeForBadStamp,
}

/// The time of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct MessageTime {
    /// Since 1970.
    ns: i64,
    origin: TimeOrigin,
}

impl MessageTime {
    /// From a message's stamp or else from its log time.
    pub(super) fn of(stamp: &Value, log_time_ns: i64) -> Self {
        match stamp {
            Value::Stamp(0) | Value::BadStamp => {
                Self { ns: log_time_ns, origin: TimeOrigin::LogTimeForBadStamp }
            }
            Value::Stamp(ns) => Self { ns: *ns, origin: TimeOrigin::Stamp },
            _ => Self { ns: log_time_ns, origin: TimeOrigin::LogTime },
        }
    }
}

/// 6 January 1980, ns since 1970: the origin of GPS time. A clock that shows less counts from its own start.
pub(super) const CLOCK_IS_SET_NS: i64 = 315_964_800_000_000_000;

/// One message with an array.
#[derive(Debug, Clone, Copy)]
struct RawBlock {
    time_ns: i64,
    /// Number of its samples.
    count: usize,
}

/// How many messages of a column carry what stamp.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct StampCounts {
    /// One that was used.
    pub(super) good: u64,
    /// One that is zero or not understood.
    pub(super) bad: u64,
}

/// When the samples of a column were taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Timing {
    pub(super) start_s: f64,
    pub(super) sample_rate_hz: f64,
    /// Number of samples, missing ones too.
    pub(super) count: usize,
    /// Number of gaps.
    pub(super) gaps: usize,
}

/// The samples of one field, message by message, in the order of the file.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// Of single numbers, one a sample.
    times_ns: Vec<i64>,
    /// Of all messages, one after another; of the first blocks alone where there is an extent.
    samples: Samples,
    blocks: Vec<RawBlock>,
    /// For a listing.
    pub(super) extent: Option<Extent>,
    pub(super) stamps: StampCounts,
    /// The units that messages state, each once, as they come.
    units: Vec<String>,
    /// The rates that messages state, each once, as they come.
    rates: Vec<StatedRate>,
    /// Which sample or block came last with a stamp of exactly zero.
    zero_stamp: Option<usize>,
}

/// Of what messages state so many are kept that differ: two tell that they change.
const MOST_STATED: usize = 4;

/// Adds what is not there yet.
fn state<T: PartialEq>(known: &mut Vec<T>, stated: T) {
    if known.len() < MOST_STATED && !known.contains(&stated) {
        known.push(stated);
    }
}

impl Column {
    /// Without samples; with an extent in place of the samples of blocks where it is for a listing.
    pub(super) fn new(is_listed: bool) -> Self {
        Self {
            times_ns: Vec::new(),
            samples: Samples::F32(Vec::new()),
            blocks: Vec::new(),
            extent: is_listed.then(Extent::default),
            stamps: StampCounts::default(),
            units: Vec::new(),
            rates: Vec::new(),
            zero_stamp: None,
        }
    }

    /// Takes what one message gave.
    pub(super) fn take(&mut self, value: Value, time: MessageTime) {
        let count = match &value {
            Value::Number { .. } => 1,
            Value::Array(samples) => samples.len(),
            _ => 0,
        };
        if count == 0 {
            return;
        }
        let is_array = matches!(value, Value::Array(_));
        if is_array && self.blocks.is_empty() {
            self.turn_to_blocks();
        }
        let is_block = is_array || !self.blocks.is_empty();
        let is_kept = !is_block || self.is_prefix();
        if let Some(extent) = &mut self.extent {
            extent.see(&value, is_block);
        }
        if is_block {
            self.blocks.push(RawBlock { time_ns: time.ns, count });
        } else {
            self.times_ns.push(time.ns);
        }
        match value {
            Value::Number { value, is_narrow } if is_kept => push(&mut self.samples, value, is_narrow),
            Value::Array(mut samples) if is_kept => append(&mut self.samples, &mut samples),
            _ => {}
        }
        match time.origin {
            TimeOrigin::Stamp => self.stamps.good += 1,
            TimeOrigin::LogTimeForBadStamp => {
                self.stamps.bad += 1;
                self.zero_stamp = Some(self.len() - 1);
            }
            TimeOrigin::LogTime => {}
        }
    }

    /// Takes a unit that a message states.
    pub(super) fn state_unit(&mut self, unit: &str) {
        if !self.units.iter().any(|known| known == unit) {
            state(&mut self.units, unit.to_owned());
        }
    }

    /// Takes a rate that a message states.
    pub(super) fn state_rate(&mut self, rate: StatedRate) {
        state(&mut self.rates, rate);
    }

    /// Whether all samples so far are held, and those of one more block are: for a listing the first of them will do.
    fn is_prefix(&self) -> bool {
        let held = self.samples.len();
        self.extent.as_ref().is_none_or(|extent| held < PREFIX && held as u64 == extent.samples)
    }

    /// Takes single numbers for blocks of one sample: some writers leave out the brackets of such a block.
    fn turn_to_blocks(&mut self) {
        if self.times_ns.is_empty() {
            return;
        }
        self.blocks.extend(self.times_ns.drain(..).map(|time_ns| RawBlock { time_ns, count: 1 }));
        if let Some(extent) = &mut self.extent {
            let mut of_numbers = Extent::default();
            for i in 0..self.samples.len() {
                of_numbers.see(&Value::Number { value: self.samples.get(i), is_narrow: false }, true);
            }
            (extent.holes, extent.digests) = (of_numbers.holes, of_numbers.digests);
        }
    }

    /// Moves over what another column took of the messages that follow; that one is as new, but for the memory it has.
    pub(super) fn append(&mut self, other: &mut Self) {
        let before = self.len();
        self.zero_stamp = other.zero_stamp.take().map(|position| before + position).or(self.zero_stamp);
        if !self.blocks.is_empty() {
            other.turn_to_blocks();
        } else if !other.blocks.is_empty() {
            self.turn_to_blocks();
        }
        if self.blocks.is_empty() || self.is_prefix() {
            append(&mut self.samples, &mut other.samples);
        }
        self.times_ns.append(&mut other.times_ns);
        self.blocks.append(&mut other.blocks);
        match &mut other.samples {
            Samples::F32(samples) => samples.clear(),
            Samples::F64(_) => other.samples = Samples::F32(Vec::new()),
        }
        if let (Some(own), Some(more)) = (&mut self.extent, &mut other.extent) {
            own.append(std::mem::take(more));
        }
        let StampCounts { good, bad } = std::mem::take(&mut other.stamps);
        self.stamps.good += good;
        self.stamps.bad += bad;
        other.units.drain(..).for_each(|unit| state(&mut self.units, unit));
        other.rates.drain(..).for_each(|rate| state(&mut self.rates, rate));
    }

    /// Gives the memory of times and samples back, in a listing.
    pub(super) fn forget_times(&mut self) {
        if let (false, Some(extent)) = (self.is_empty(), &mut self.extent) {
            let kept = Extent { digests: Vec::new(), is_without_times: true, ..std::mem::take(extent) };
            let (units, rates) = (std::mem::take(&mut self.units), std::mem::take(&mut self.rates));
            *self = Self { extent: Some(kept), units, rates, ..Self::new(true) };
        }
    }

    /// Takes a single stamp of zero for a time where the other stamps show a clock that counts from its own start.
    pub(super) fn settle_clock(&mut self) {
        let (1, Some(position)) = (self.stamps.bad, self.zero_stamp) else { return };
        let is_own_clock = |(at, time_ns): (usize, i64)| at == position || time_ns.abs() < CLOCK_IS_SET_NS;
        if self.stamps.good == 0 || !self.starts_ns().enumerate().all(is_own_clock) {
            return;
        }
        match self.blocks.get_mut(position) {
            Some(block) => block.time_ns = 0,
            None => self.times_ns[position] = 0,
        }
        self.stamps = StampCounts { good: self.stamps.good + 1, bad: 0 };
    }

    /// The times of the messages, since 1970.
    fn starts_ns(&self) -> impl Iterator<Item = i64> {
        self.times_ns.iter().copied().chain(self.blocks.iter().map(|block| block.time_ns))
    }

    /// Number of messages that gave samples.
    fn len(&self) -> usize {
        self.times_ns.len() + self.blocks.len()
    }

    /// Whether there are no samples.
    pub(super) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Memory of its times and samples.
    pub(super) fn held_bytes(&self) -> u64 {
        let (narrow, wide) = match &self.samples {
            Samples::F32(samples) => (samples.len(), 0),
            Samples::F64(samples) => (0, samples.len()),
        };
        let digests = self.extent.as_ref().map_or(0, |extent| extent.digests.len());
        let eights = wide + self.times_ns.len() + digests;
        (4 * narrow + 8 * eights + size_of::<RawBlock>() * self.blocks.len()) as u64
    }

    /// The earliest and the latest time of a message, ns since 1970.
    pub(super) fn span_ns(&self) -> Option<(i64, i64)> {
        Some((self.starts_ns().min()?, self.starts_ns().max()?))
    }

    /// The unit that its messages state first.
    pub(super) fn unit(&self) -> Option<&str> {
        self.units.first().map(String::as_str)
    }

    /// The units of its messages where it changes between them: the first, and one that is another.
    pub(super) fn unit_change(&self) -> Option<[&str; 2]> {
        let (first, others) = self.units.split_first()?;
        let is_other = |unit: &&String| match (acceleration_unit_m_s2(first), acceleration_unit_m_s2(unit)) {
            (Some(one), Some(other)) => one.total_cmp(&other).is_ne(),
            _ => !unit.trim().eq_ignore_ascii_case(first.trim()),
        };
        let other = others.iter().find(is_other)?;
        Some([first, other])
    }

    /// What is said of its rate but by its stamps.
    fn claims(&self, cask_hz: Option<f64>) -> Result<Claims, Refusal> {
        let is_rate = |rate: &StatedRate| rate.hz.is_finite() && rate.hz > 0.0;
        if let (None, Some(StatedRate { name, hz, .. })) =
            (cask_hz, self.rates.iter().find(|rate| !is_rate(rate)))
        {
            return Err(Refusal::new(
                format!("its messages state a sample rate of {} Hz ({name})", shown::short(*hz)),
                "write the true `sample_rate_hz` in this channel of the cask file: it overrides the recording",
            ));
        }
        let nearest = self.rates.iter().map(|rate| rate.level).min().unwrap_or(0);
        let mut rates: Vec<&StatedRate> = self.rates.iter().collect();
        rates.sort_by_key(|rate| rate.level);
        let statement = |rate: &StatedRate| {
            let stated = Statement::of(rate.name, &rate.hz.to_string(), Meaning::Rate(1.0));
            stated.map(|stated| stated.at(rate.level - nearest))
        };
        let stated = rates.into_iter().filter_map(statement).collect();
        Ok(Claims { cask_hz, stated, ..Claims::default() })
    }

    /// Its blocks, times counted from `zero_ns`.
    fn blocks_from(&self, zero_ns: i64) -> Vec<Block> {
        let block =
            |block: &RawBlock| Block { start_s: seconds_from(block.time_ns, zero_ns), count: block.count };
        self.blocks.iter().map(block).collect()
    }

    /// The samples on a uniform base, times counted from `zero_ns`; `cask_hz` overrides what the messages say.
    ///
    /// # Errors
    /// Rate or times that give no base.
    pub(super) fn uniform(self, zero_ns: i64, cask_hz: Option<f64>) -> Result<Uniform, TimeBaseError> {
        if self.blocks.is_empty() {
            // A rate in messages of single numbers is that of something else, such as blocks beside them.
            let times_s: Vec<f64> =
                self.times_ns.iter().map(|&time_ns| seconds_from(time_ns, zero_ns)).collect();
            return time_base::from_times(&times_s, self.samples, cask_hz);
        }
        let claims = self.claims(cask_hz)?;
        time_base::place_blocks(&self.blocks_from(zero_ns), &claims, self.samples)
    }

    /// As [`Column::uniform`] as far as a listing shows it, which holds no samples of blocks.
    ///
    /// # Errors
    /// As that.
    pub(super) fn timing(self, zero_ns: i64) -> Result<Timing, TimeBaseError> {
        let Some(extent) = self.extent.as_ref().filter(|_| !self.blocks.is_empty()) else {
            let uniform = self.uniform(zero_ns, None)?;
            let (count, gaps) = (uniform.samples.len(), uniform.gaps.len());
            return Ok(Timing {
                start_s: uniform.start_s,
                sample_rate_hz: uniform.sample_rate_hz,
                count,
                gaps,
            });
        };
        let content = BlockContent { samples: &self.samples, digests: Some(&extent.digests) };
        let laid = time_base::lay_blocks(&self.blocks_from(zero_ns), &self.claims(None)?, &content)?;
        Ok(Timing {
            start_s: laid.start_s,
            sample_rate_hz: laid.sample_rate_hz,
            count: laid.count(),
            gaps: laid.gap_count() + extent.holes,
        })
    }
}

/// Seconds from `zero_ns` to `time_ns`, subtracted as integers: absolute times lose a microsecond as f64.
#[allow(clippy::cast_precision_loss, reason = "spans of a recording are far below 2^53 ns")]
pub(super) fn seconds_from(time_ns: i64, zero_ns: i64) -> f64 {
    time_ns.saturating_sub(zero_ns) as f64 / 1e9
}

#[cfg(test)]
#[path = "column_tests.rs"]
mod tests;
