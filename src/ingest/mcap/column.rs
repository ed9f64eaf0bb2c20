//! What the messages of one topic gave for one field, message by message.

use super::numbers::{Extent, append, push};
use super::plan::{Beside, StatedRate, Value};
use crate::data::{Samples, acceleration_unit_m_s2};
use crate::ingest::{counting::SteadyNumbers, factors, refusal::Refusal};

mod based;

/// The time of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct MessageTime {
    /// Since 1970.
    ns: i64,
    /// Whether it is the message's own stamp, not the log time for one that is zero or not understood;
    /// `None` for the log time of a message without a stamp.
    is_stamp: Option<bool>,
    log_ns: i64,
}

impl MessageTime {
    /// From a message's stamp or else from its log time.
    pub(super) fn of(stamp: Option<&Value>, log_ns: i64) -> Self {
        let (ns, is_stamp) = match stamp {
            Some(Value::Stamp(0) | Value::BadStamp) => (log_ns, Some(false)),
            Some(Value::Stamp(ns)) => (*ns, Some(true)),
            _ => (log_ns, None),
        };
        Self { ns, is_stamp, log_ns }
    }
}

/// 6 January 1980, ns since 1970: the origin of GPS time. A clock that shows less counts from its own start.
pub(super) const CLOCK_IS_SET_NS: i64 = 315_964_800_000_000_000;

/// The samples of one field, message by message, in the order of the file.
#[derive(Debug, Clone, Default)]
pub(super) struct Column {
    /// Of each message that gave samples, since 1970.
    times_ns: Vec<i64>,
    /// Of all messages, one after another.
    samples: Samples,
    /// How many samples each message gave, where one gave an array.
    counts: Vec<usize>,
    /// Earlier ones that did not fit in memory, for a listing.
    pub(super) forgotten: Option<Extent>,
    /// How many messages carry a stamp that was used.
    pub(super) good_stamps: u64,
    /// How many carry one that is zero or not understood.
    pub(super) bad_stamps: u64,
    /// The units that messages state, each once, as they come.
    units: Vec<String>,
    /// The rates that messages state, each once, as they come.
    rates: Vec<StatedRate>,
    /// Numbers that may be factors of the samples, with their fields.
    factors: Vec<(String, f64)>,
    /// Numbers of other fields beside the samples, by their slots and names.
    others: Vec<(usize, String, SteadyNumbers)>,
    /// Which sample or block came last with a stamp of exactly zero.
    zero_stamp: Option<usize>,
    /// Numbers that are the times of messages, where these carry such.
    ticks: Option<SentTimes>,
    /// Some of the messages, by their place, with their log times in ns.
    logged: Vec<(usize, i64)>,
    /// The place of the next that is kept.
    next_logged: usize,
    /// What messages say of the samples that is not done here.
    refused: Option<Refusal>,
}

/// Numbers that messages carry as their times.
#[derive(Debug, Clone)]
struct SentTimes {
    /// Their field.
    field: String,
    /// One a message, NaN where it carries none.
    each: Vec<f64>,
}

/// What the number of a message in its own record is called.
pub(super) const SEQUENCE: &str = "sequence";

/// Of so many messages the log times are kept: enough to tell how they run against the stamps.
const MOST_LOGGED: usize = 512;

/// Of what messages state so many are kept that differ: two tell that they change.
const MOST_STATED: usize = 4;

/// Adds what is not there yet.
fn state<T: PartialEq>(known: &mut Vec<T>, stated: T) {
    if known.len() < MOST_STATED && !known.contains(&stated) {
        known.push(stated);
    }
}

impl Column {
    /// Takes what one message gave; `tick` is the number that is its time, where it carries one.
    pub(super) fn take(&mut self, value: Value, time: MessageTime, tick: Option<(f64, &Beside)>) {
        let count = match &value {
            Value::Number { .. } => 1,
            Value::Array(samples) => samples.len(),
            _ => 0,
        };
        if count == 0 {
            return;
        }
        let is_array = matches!(value, Value::Array(_));
        if is_array {
            self.turn_to_blocks();
        }
        let is_block = is_array || !self.counts.is_empty();
        self.times_ns.push(time.ns);
        self.counts.extend(is_block.then_some(count));
        match value {
            Value::Number { value, is_narrow } => push(&mut self.samples, value, is_narrow),
            Value::Array(mut samples) => append(&mut self.samples, &mut samples),
            _ => {}
        }
        let place = self.times_ns.len() - 1;
        match time.is_stamp {
            Some(true) => self.good_stamps += 1,
            Some(false) => {
                self.bad_stamps += 1;
                self.zero_stamp = Some(place);
            }
            None => {}
        }
        if let Some((tick, beside)) = tick {
            let none = || SentTimes { field: beside.field.clone(), each: Vec::new() };
            let ticks = self.ticks.get_or_insert_with(none);
            ticks.each.resize(place, f64::NAN);
            ticks.each.push(tick);
        }
        if place >= self.next_logged {
            self.log(place, time.log_ns);
            self.next_logged = place + 1 + place / (MOST_LOGGED / 2);
        }
    }

    /// Notes when a message was logged; of many the earlier ones are thinned.
    fn log(&mut self, place: usize, log_ns: i64) {
        if self.logged.len() >= MOST_LOGGED {
            let mut number = 0_usize;
            self.logged.retain(|_| {
                number += 1;
                number % 2 == 1
            });
        }
        self.logged.push((place, log_ns));
    }

    /// Whether all is done that its messages say of the samples.
    ///
    /// # Errors
    /// What is not.
    pub(super) fn heeded(&self) -> Result<(), Refusal> {
        self.refused.clone().map_or(Ok(()), Err)
    }

    /// Takes that messages say what is not done here.
    pub(super) fn refuse(&mut self, refusal: Refusal) {
        self.refused.get_or_insert(refusal);
    }

    /// Takes a unit that a message states.
    pub(super) fn state_unit(&mut self, unit: &str) {
        if !self.units.iter().any(|known| known == unit) {
            state(&mut self.units, unit.to_owned());
        }
    }

    /// Takes a number that may be a factor of the samples.
    pub(super) fn state_factor(&mut self, field: &str, factor: f64) {
        if self.factors.iter().all(|(known, value)| known != field || *value - factor != 0.0) {
            state(&mut self.factors, (field.to_owned(), factor));
        }
    }

    /// Takes a number that stands beside the samples of a message.
    pub(super) fn see_other(&mut self, slot: usize, field: &str, number: f64) {
        let known = self.others.iter().position(|other| other.0 == slot);
        let at = known.unwrap_or_else(|| {
            self.others.push((slot, field.to_owned(), SteadyNumbers::default()));
            self.others.len() - 1
        });
        self.others[at].2.push(number);
    }

    /// Numbers that may be factors of the samples, for people.
    pub(super) fn factors(&self) -> Vec<String> {
        let shown = |(field, factor): &(String, f64)| factors::unexplained(field, &factor.to_string());
        let constant = self
            .others
            .iter()
            .filter_map(|(_, field, numbers)| factors::unexplained(field, &numbers.constant()?.to_string()));
        self.factors.iter().filter_map(shown).chain(constant).collect()
    }

    /// Takes a rate that a message states.
    pub(super) fn state_rate(&mut self, rate: &StatedRate) {
        state(&mut self.rates, rate.clone());
    }

    /// How many samples there are, and their range.
    pub(super) fn extent(&self) -> Extent {
        Extent::of(&self.samples).with(self.forgotten.as_ref())
    }

    /// Takes single numbers for blocks of one sample: some writers leave out the brackets of such a block.
    fn turn_to_blocks(&mut self) {
        if self.counts.len() == self.times_ns.len() {
            return;
        }
        self.counts.resize(self.times_ns.len(), 1);
    }

    /// Moves over what another column took of the messages that follow; that one is as new, but for the
    /// memory it has.
    pub(super) fn append(&mut self, other: &mut Self) {
        let before = self.times_ns.len();
        self.zero_stamp = other.zero_stamp.take().map(|position| before + position).or(self.zero_stamp);
        if !self.counts.is_empty() {
            other.turn_to_blocks();
        } else if !other.counts.is_empty() {
            self.turn_to_blocks();
        }
        append(&mut self.samples, &mut other.samples);
        self.times_ns.append(&mut other.times_ns);
        self.counts.append(&mut other.counts);
        match &mut other.samples {
            Samples::F32(samples) => samples.clear(),
            wide @ Samples::F64(_) => *wide = Samples::default(),
        }
        if let Some(more) = other.forgotten.take() {
            self.forgotten = Some(more.with(self.forgotten.as_ref()));
        }
        if let Some(more) = other.ticks.take() {
            let ticks = self.ticks.get_or_insert_with(|| SentTimes { each: Vec::new(), ..more.clone() });
            ticks.each.resize(before, f64::NAN);
            ticks.each.extend(more.each);
        }
        for (place, log_ns) in other.logged.drain(..) {
            self.log(before + place, log_ns);
        }
        self.next_logged = self.next_logged.max(before + std::mem::take(&mut other.next_logged));
        for (field, factor) in other.factors.drain(..) {
            self.state_factor(&field, factor);
        }
        for (slot, field, mut numbers) in other.others.drain(..) {
            match self.others.iter_mut().find(|own| own.0 == slot) {
                Some(own) => own.2.append(&mut numbers),
                None => self.others.push((slot, field, numbers)),
            }
        }
        self.refused = self.refused.take().or(other.refused.take());
        self.good_stamps += std::mem::take(&mut other.good_stamps);
        self.bad_stamps += std::mem::take(&mut other.bad_stamps);
        other.units.drain(..).for_each(|unit| state(&mut self.units, unit));
        other.rates.drain(..).for_each(|rate| state(&mut self.rates, rate));
    }

    /// Gives the memory of times and samples back, in a listing.
    pub(super) fn forget(&mut self) {
        if !self.is_empty() {
            let forgotten = Some(self.extent());
            let Self { units, rates, refused, .. } = std::mem::take(self);
            *self = Self { forgotten, units, rates, refused, ..Self::default() };
        }
    }

    /// Takes a single stamp of zero for a time where the other stamps show a clock that counts from its own
    /// start.
    pub(super) fn settle_clock(&mut self) {
        let (1, Some(position)) = (self.bad_stamps, self.zero_stamp) else { return };
        let is_own_clock = |(at, time_ns): (usize, &i64)| at == position || time_ns.abs() < CLOCK_IS_SET_NS;
        if self.good_stamps == 0 || !self.times_ns.iter().enumerate().all(is_own_clock) {
            return;
        }
        self.times_ns[position] = 0;
        (self.good_stamps, self.bad_stamps) = (self.good_stamps + 1, 0);
    }

    /// Whether there are no samples.
    pub(super) fn is_empty(&self) -> bool {
        self.times_ns.is_empty()
    }

    /// Whether its messages hold samples, be they refused.
    pub(super) fn is_there(&self) -> bool {
        !self.is_empty() || self.refused.is_some()
    }

    /// Memory of its times and samples.
    pub(super) fn held_bytes(&self) -> u64 {
        let sample_bytes = if matches!(self.samples, Samples::F32(_)) { 4 } else { 8 };
        let others = self.times_ns.len() + self.counts.len();
        (sample_bytes * self.samples.len() + 8 * others) as u64
    }

    /// The earliest and the latest time of a message, ns since 1970.
    pub(super) fn span_ns(&self) -> Option<(i64, i64)> {
        Some((*self.times_ns.iter().min()?, *self.times_ns.iter().max()?))
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
}

/// Seconds from `zero_ns` to `time_ns`, subtracted as integers: absolute times lose a microsecond as f64.
#[allow(clippy::cast_precision_loss, reason = "spans of a recording are far below 2^53 ns")]
pub(super) fn seconds_from(time_ns: i64, zero_ns: i64) -> f64 {
    time_ns.saturating_sub(zero_ns) as f64 / 1e9
}

#[cfg(test)]
#[path = "column_tests.rs"]
mod tests;
