//! What the messages of one topic gave for one field, to uniform samples.

use super::block_rate::{Derived, FAR, few_blocks};
use super::numbers::{append, push};
use super::plan::Value;
use super::shared_stamps::Shared;
use super::twice::{Rates, Units};
use crate::data::{Issue, Samples};
use crate::ingest::stated_rate::shown_hz;
use crate::ingest::time_base::{self, Block, TimeBaseError, Uniform};

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
pub(super) struct RawBlock {
    pub(super) time_ns: i64,
    /// As stated; `None` where the message has no such field.
    pub(super) rate_hz: Option<f64>,
    /// Number of its samples.
    pub(super) count: usize,
}

/// How many messages of a column carry what stamp.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Stamps {
    /// One that was used.
    pub(super) good: u64,
    /// One that is zero or not understood.
    pub(super) bad: u64,
}

/// What a listing shows of samples.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Extent {
    pub(super) samples: u64,
    /// The least and the largest that is finite.
    pub(super) range: Option<(f64, f64)>,
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
    /// Of all messages, one after another; without those of blocks where there is an extent.
    samples: Samples,
    blocks: Vec<RawBlock>,
    pub(super) extent: Option<Extent>,
    pub(super) stamps: Stamps,
    /// All that were stated.
    pub(super) units: Units,
    /// Two rates that a message states, and contradict each other.
    pub(super) two_rates: Option<Rates>,
    /// Which sample or block came last with a stamp of exactly zero.
    zero_stamp: Option<usize>,
}

impl Extent {
    fn see(&mut self, value: &Value) {
        match value {
            Value::Number { value, .. } => self.see_all(std::iter::once(*value)),
            Value::Array(Samples::F32(samples)) => self.see_all(samples.iter().copied().map(f64::from)),
            Value::Array(Samples::F64(samples)) => self.see_all(samples.iter().copied()),
            _ => {}
        }
    }

    fn see_all(&mut self, samples: impl ExactSizeIterator<Item = f64>) {
        self.samples += samples.len() as u64;
        for value in samples.filter(|value| value.is_finite()) {
            self.widen((value, value));
        }
    }

    fn widen(&mut self, (least, largest): (f64, f64)) {
        self.range =
            Some(self.range.map_or((least, largest), |(low, high)| (low.min(least), high.max(largest))));
    }
}

/// Why a column gives no uniform samples.
#[derive(Debug, thiserror::Error)]
pub(super) enum ColumnError {
    #[error("its messages state a sample rate of {0} Hz")]
    StatedRate(f64),
    #[error("it is one block of samples without a sample rate")]
    NoRate,
    #[error(
        "its messages state a sample rate of {} Hz, their stamps and lengths say {} Hz: one of the two is wrong, or samples are missing behind \
         every message{}",
        shown_hz(*stated_hz), shown_hz(*own_hz), shared.map(|shared| format!("; {shared}")).unwrap_or_default()
    )]
    Contradiction { stated_hz: f64, own_hz: f64, shared: Option<Shared> },
    #[error("{0}, and no rate is stated by which they could be laid one behind another")]
    SharedStamps(Shared),
    #[error(transparent)]
    TimeBase(#[from] TimeBaseError),
}

impl Column {
    /// Without samples; with an extent in place of the samples of blocks where it is for a listing.
    pub(super) fn new(is_listed: bool) -> Self {
        Self {
            times_ns: Vec::new(),
            samples: Samples::F32(Vec::new()),
            blocks: Vec::new(),
            extent: is_listed.then(Extent::default),
            stamps: Stamps::default(),
            units: Units::default(),
            two_rates: None,
            zero_stamp: None,
        }
    }

    /// Takes what one message gave.
    pub(super) fn take(&mut self, value: Value, time: MessageTime, rate_hz: Option<f64>) {
        let count = match &value {
            Value::Number { .. } => 1,
            Value::Array(samples) => samples.len(),
            _ => 0,
        };
        if count == 0 {
            return;
        }
        if let Some(extent) = &mut self.extent {
            extent.see(&value);
        }
        if matches!(value, Value::Array(_)) && self.blocks.is_empty() {
            self.turn_to_blocks();
        }
        let is_block = matches!(value, Value::Array(_)) || !self.blocks.is_empty();
        if is_block {
            self.blocks.push(RawBlock { time_ns: time.ns, rate_hz, count });
        } else {
            self.times_ns.push(time.ns);
        }
        match value {
            _ if is_block && self.extent.is_some() => {}
            Value::Number { value, is_narrow } => push(&mut self.samples, value, is_narrow),
            Value::Array(mut samples) => append(&mut self.samples, &mut samples),
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

    /// Takes single numbers for blocks of one sample: some writers leave out the brackets of such a block.
    fn turn_to_blocks(&mut self) {
        let block = |time_ns| RawBlock { time_ns, rate_hz: None, count: 1 };
        self.blocks.extend(self.times_ns.drain(..).map(block));
        if self.extent.is_some() {
            self.samples = Samples::F32(Vec::new());
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
        self.times_ns.append(&mut other.times_ns);
        self.blocks.append(&mut other.blocks);
        append(&mut self.samples, &mut other.samples);
        if matches!(other.samples, Samples::F64(_)) {
            other.samples = Samples::F32(Vec::new());
        }
        if let (Some(own), Some(more)) = (&mut self.extent, &mut other.extent) {
            let Extent { samples, range } = std::mem::take(more);
            own.samples += samples;
            range.into_iter().for_each(|range| own.widen(range));
        }
        let Stamps { good, bad } = std::mem::take(&mut other.stamps);
        self.stamps.good += good;
        self.stamps.bad += bad;
        self.units.append(&std::mem::take(&mut other.units));
        let two_rates = other.two_rates.take();
        self.two_rates = self.two_rates.take().or(two_rates);
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
        self.stamps = Stamps { good: self.stamps.good + 1, bad: 0 };
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
        (4 * narrow + 8 * (wide + self.times_ns.len()) + size_of::<RawBlock>() * self.blocks.len()) as u64
    }

    /// The earliest and the latest time of a message, ns since 1970.
    pub(super) fn span_ns(&self) -> Option<(i64, i64)> {
        Some((self.starts_ns().min()?, self.starts_ns().max()?))
    }

    /// The samples on a uniform base, times counted from `zero_ns`; `declared_rate_hz` overrides what the messages say.
    ///
    /// # Errors
    /// Rate or times that give no base.
    pub(super) fn uniform(
        mut self,
        zero_ns: i64,
        declared_rate_hz: Option<f64>,
    ) -> Result<Uniform, ColumnError> {
        if self.blocks.is_empty() {
            let times_s: Vec<f64> =
                self.times_ns.iter().map(|&time_ns| seconds_from(time_ns, zero_ns)).collect();
            return Ok(time_base::from_times(&times_s, self.samples, declared_rate_hz)?);
        }
        let shared = Shared::of(&self.blocks, &self.samples);
        let laid = self.laid(shared, declared_rate_hz)?;
        let derived = Derived::of(&self.blocks);
        let derived_hz = declared_rate_hz.or(derived.as_ref().map(|derived| derived.rate_hz));
        if declared_rate_hz.is_none()
            && let Some((stated_hz, own_hz)) =
                derived.as_ref().and_then(|own| own.contradiction(&self.blocks, &self.samples))
        {
            return Err(ColumnError::Contradiction { stated_hz, own_hz, shared });
        }
        let is_derived =
            declared_rate_hz.is_none() && self.blocks.iter().all(|block| block.rate_hz.is_none());
        let resolution = match &derived {
            Some(derived) if is_derived => derived.resolution(self.samples.len())?,
            _ => None,
        };
        // At a rate that is far off, steady stamps would leave a gap behind every block, or let each cover the next.
        let own_hz = declared_rate_hz.and_then(|declared_hz| {
            let is_far = |rate_hz: &f64| (declared_hz / rate_hz - 1.0).abs() > FAR;
            let own = derived.as_ref().filter(|own| own.is_steady && !own.is_explained_by(declared_hz));
            own.map(|own| own.rate_hz).filter(is_far)
        });
        let few_hz = derived.as_ref().filter(|own| own.is_few()).map(|own| own.rate_hz);
        let mut blocks = Vec::with_capacity(self.blocks.len());
        for block in self.blocks {
            let sample_rate_hz = match (own_hz.or(declared_rate_hz), block.rate_hz) {
                (Some(rate_hz), _) => rate_hz,
                (None, Some(rate_hz)) if rate_hz.is_finite() && rate_hz > 0.0 => rate_hz,
                (None, Some(rate_hz)) => return Err(ColumnError::StatedRate(rate_hz)),
                (None, None) => derived_hz.ok_or(ColumnError::NoRate)?,
            };
            let start_s = seconds_from(block.time_ns, zero_ns);
            blocks.push(Block { start_s, sample_rate_hz, count: block.count });
        }
        let mut placed = time_base::from_blocks(&blocks, self.samples)?;
        // Between many blocks a rate shows in every one; between few it looks like samples that are missing.
        placed.issues.extend(few_hz.and_then(|own_hz| few_blocks(own_hz, placed.sample_rate_hz)));
        placed.issues.extend(resolution);
        placed.issues.extend(laid);
        let is_decided = declared_rate_hz.is_some()
            || derived.is_some_and(|derived| derived.bears_out(placed.sample_rate_hz));
        placed.issues.extend(self.two_rates.filter(|_| !is_decided).map(|rates| rates.issue()));
        Ok(match (own_hz, declared_rate_hz) {
            (Some(_), Some(declared_hz)) => placed.at(declared_hz)?,
            _ => placed,
        })
    }

    /// As [`Column::uniform`] as far as a listing shows it, which needs no samples of blocks.
    pub(super) fn timing(self, zero_ns: i64) -> Result<Timing, ColumnError> {
        if self.blocks.is_empty() {
            let uniform = self.uniform(zero_ns, None)?;
            let (count, gaps) = (uniform.samples.len(), uniform.gaps.len());
            return Ok(Timing { start_s: uniform.start_s, sample_rate_hz: uniform.sample_rate_hz, count, gaps });
        }
        let own_hz = Derived::of(&self.blocks).map(|derived| derived.rate_hz);
        let stated_hz = self.blocks.iter().find_map(|block| block.rate_hz);
        let sample_rate_hz = stated_hz.or(own_hz).ok_or(ColumnError::NoRate)?;
        let block = |block: &RawBlock| {
            let start_s = seconds_from(block.time_ns, zero_ns);
            Block { start_s, sample_rate_hz, count: block.count }
        };
        let blocks: Vec<Block> = self.blocks.iter().map(block).collect();
        let laid = time_base::lay_blocks(&blocks, &|_, _| true)?;
        Ok(Timing {
            start_s: laid.start_s,
            sample_rate_hz: laid.sample_rate_hz,
            count: laid.count(),
            gaps: laid.gap_count(),
        })
    }

    /// Stamps anew blocks that share stamps and follow one another at the rate that is stated; a warning where that was done.
    fn laid(
        &mut self,
        shared: Option<Shared>,
        declared_rate_hz: Option<f64>,
    ) -> Result<Option<Issue>, ColumnError> {
        let Some(shared) = shared else { return Ok(None) };
        let stated_hz = declared_rate_hz.or(self.blocks.first().and_then(|block| block.rate_hz));
        let rate_hz = stated_hz.ok_or(ColumnError::SharedStamps(shared))?;
        let is_rate = rate_hz.is_finite() && rate_hz > 0.0;
        let Some((stamps, issue)) = shared.laid(&self.blocks, rate_hz).filter(|_| is_rate) else {
            return Ok(None);
        };
        for (block, time_ns) in self.blocks.iter_mut().zip(stamps) {
            block.time_ns = time_ns;
        }
        Ok(Some(issue))
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
