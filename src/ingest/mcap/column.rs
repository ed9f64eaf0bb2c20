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

/// The time of a message, ns since 1970, from its stamp or else from its log time.
pub(super) fn message_time(stamp: &Value, log_time_ns: i64) -> (i64, TimeOrigin) {
    match stamp {
        Value::Stamp(0) | Value::BadStamp => (log_time_ns, TimeOrigin::LogTimeForBadStamp),
        Value::Stamp(ns) => (*ns, TimeOrigin::Stamp),
        _ => (log_time_ns, TimeOrigin::LogTime),
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

/// A number and its time in memory.
const NUMBER_BYTES: u64 = 16;
/// A block in memory, without its samples.
const BLOCK_BYTES: u64 = size_of::<RawBlock>() as u64;

/// How much a column held when a chunk began.
#[derive(Debug, Clone, Copy, Default)]
struct Mark {
    times: usize,
    samples: usize,
    blocks: usize,
    tally: Tally,
    held_bytes: u64,
}

/// Counts of messages.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Tally {
    /// All of the topic.
    pub(super) messages: u64,
    /// Those that do not decode.
    pub(super) malformed: u64,
    /// Those whose stamp is zero or not understood.
    pub(super) bad_stamps: u64,
    /// Those with a stamp that was used.
    pub(super) stamps: u64,
}

/// The samples of one field, message by message, in the order of the file.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// Of single numbers, one a sample.
    times_ns: Vec<i64>,
    /// Of all messages, one after another.
    samples: Samples,
    blocks: Vec<RawBlock>,
    pub(super) tally: Tally,
    /// Memory of its times and samples.
    pub(super) held_bytes: u64,
    pub(super) unit: Option<String>,
    /// All that were stated.
    pub(super) units: Units,
    /// Two rates that a message states, and contradict each other.
    pub(super) two_rates: Option<Rates>,
    /// Why the first malformed message is so.
    pub(super) first_problem: Option<String>,
    mark: Mark,
    /// Which sample or block came first with a stamp of exactly zero.
    zero_stamp: Option<usize>,
}

impl Default for Column {
    fn default() -> Self {
        Self {
            times_ns: Vec::new(),
            samples: Samples::F32(Vec::new()),
            blocks: Vec::new(),
            tally: Tally::default(),
            held_bytes: 0,
            unit: None,
            units: Units::default(),
            two_rates: None,
            first_problem: None,
            mark: Mark::default(),
            zero_stamp: None,
        }
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
    /// Takes what one message gave.
    pub(super) fn take(&mut self, value: Value, time: (i64, TimeOrigin), rate_hz: Option<f64>) {
        self.tally.messages += 1;
        match (value, self.is_blocks()) {
            (Value::Number { value, is_narrow }, None | Some(false)) => {
                self.times_ns.push(time.0);
                self.held_bytes += NUMBER_BYTES;
                push(&mut self.samples, value, is_narrow);
            }
            (Value::Number { value, is_narrow }, Some(true)) => {
                self.held_bytes += BLOCK_BYTES + NUMBER_BYTES;
                self.blocks.push(RawBlock { time_ns: time.0, rate_hz, count: 1 });
                push(&mut self.samples, value, is_narrow);
            }
            (Value::Array(mut samples), None | Some(true)) => {
                if samples.is_empty() {
                    return;
                }
                let width_bytes = if matches!(samples, Samples::F32(_)) { 4 } else { 8 };
                self.held_bytes += BLOCK_BYTES + width_bytes * samples.len() as u64;
                self.blocks.push(RawBlock { time_ns: time.0, rate_hz, count: samples.len() });
                append(&mut self.samples, &mut samples);
            }
            (Value::Array(_), Some(false)) => {
                self.malformed("the field is a number in some messages and an array in others");
                self.tally.messages -= 1;
                return;
            }
            _ => return,
        }
        match time.1 {
            TimeOrigin::Stamp => self.tally.stamps += 1,
            TimeOrigin::LogTimeForBadStamp => {
                self.tally.bad_stamps += 1;
                self.zero_stamp = Some(self.times_ns.len().max(self.blocks.len()) - 1);
            }
            TimeOrigin::LogTime => {}
        }
    }

    /// Counts a message that does not decode.
    pub(super) fn malformed(&mut self, problem: &str) {
        self.tally.messages += 1;
        self.tally.malformed += 1;
        self.first_problem.get_or_insert_with(|| problem.to_owned());
    }

    /// What follows may be taken back.
    pub(super) fn mark(&mut self) {
        self.mark = Mark {
            times: self.times_ns.len(),
            samples: self.samples.len(),
            blocks: self.blocks.len(),
            tally: self.tally,
            held_bytes: self.held_bytes,
        };
    }

    /// Takes back everything since the last mark.
    pub(super) fn roll_back(&mut self) {
        self.times_ns.truncate(self.mark.times);
        match &mut self.samples {
            Samples::F32(samples) => samples.truncate(self.mark.samples),
            Samples::F64(samples) => samples.truncate(self.mark.samples),
        }
        self.blocks.truncate(self.mark.blocks);
        self.tally = self.mark.tally;
        self.held_bytes = self.mark.held_bytes;
    }

    /// Whether [`Column::append`] gives what taking the other's messages one by one would have given.
    pub(super) fn continues_with(&self, other: &Self) -> bool {
        self.is_blocks().is_none_or(|own| other.is_blocks().is_none_or(|others| own == others))
    }

    /// Moves over what another column took of the messages that follow; that one is as new, but for the memory it has.
    pub(super) fn append(&mut self, other: &mut Self) {
        let before = self.times_ns.len().max(self.blocks.len());
        self.zero_stamp = other.zero_stamp.map(|position| before + position).or(self.zero_stamp);
        self.times_ns.append(&mut other.times_ns);
        self.blocks.append(&mut other.blocks);
        append(&mut self.samples, &mut other.samples);
        self.tally.messages += other.tally.messages;
        self.tally.malformed += other.tally.malformed;
        self.tally.bad_stamps += other.tally.bad_stamps;
        self.tally.stamps += other.tally.stamps;
        self.held_bytes += other.held_bytes;
        self.unit = other.unit.take().or(self.unit.take());
        self.units.append(&other.units);
        self.two_rates = self.two_rates.take().or(other.two_rates.take());
        self.first_problem = self.first_problem.take().or(other.first_problem.take());
        *other = Self {
            times_ns: std::mem::take(&mut other.times_ns),
            samples: std::mem::replace(&mut other.samples, Samples::F32(Vec::new())),
            blocks: std::mem::take(&mut other.blocks),
            ..Self::default()
        };
    }

    /// Takes a single stamp of zero for a time where the other stamps show a clock that counts from its own start.
    pub(super) fn settle_clock(&mut self) {
        let (1, Some(position)) = (self.tally.bad_stamps, self.zero_stamp) else { return };
        let is_own_clock = |time_ns: i64| time_ns.abs() < CLOCK_IS_SET_NS;
        let others = self.times_ns.iter().copied().chain(self.blocks.iter().map(|block| block.time_ns));
        if self.tally.stamps == 0
            || !others.enumerate().all(|(index, time_ns)| index == position || is_own_clock(time_ns))
        {
            return;
        }
        let place = match self.blocks.get_mut(position) {
            Some(block) => Some(&mut block.time_ns),
            None => self.times_ns.get_mut(position),
        };
        if let Some(time_ns) = place {
            *time_ns = 0;
            self.tally.bad_stamps = 0;
            self.tally.stamps += 1;
        }
    }

    /// Whether there are no samples.
    pub(super) fn is_empty(&self) -> bool {
        self.times_ns.is_empty() && self.blocks.is_empty()
    }

    /// The earliest and the latest time of a message, ns since 1970.
    pub(super) fn span_ns(&self) -> Option<(i64, i64)> {
        let times = || self.times_ns.iter().copied().chain(self.blocks.iter().map(|block| block.time_ns));
        Some((times().min()?, times().max()?))
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

    fn is_blocks(&self) -> Option<bool> {
        if self.is_empty() { None } else { Some(!self.blocks.is_empty()) }
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
