//! The messages of a topic with the fields that are asked for, and what they gave for each.

use super::beside::SaidBeside;
use super::column::{Column, MessageTime, SEQUENCE};
use super::json;
use super::message_type::MessageType;
use super::plan::{Beside, Decode, Field, Leaf, Plan, Slots, Value};
use crate::data::{McapFinding, RowsOf};
use crate::ingest::limits::MOST_SENSORS;
use crate::ingest::refusal::Refusal;
use rayon::prelude::*;
use std::borrow::Cow;
use std::rc::Rc;

/// The messages of one type on a topic, whatever the number of channels that write them.
#[derive(Default)]
pub(super) struct Topic {
    pub(super) name: String,
    /// Encoding and schema, for people.
    pub(super) encoding: String,
    /// Schema and field fix a unit together.
    pub(super) schema_name: String,
    /// `None` where they cannot be read.
    pub(super) message_type: Option<MessageType>,
    /// The fields that are asked for.
    pub(super) plan: Plan,
    /// `None` where they cannot be read, or the first of them must tell which fields they have.
    pub(super) decoder: Option<Box<dyn Decode>>,
    /// The numeric fields that the schema or a first message tells.
    pub(super) leaves: Vec<Leaf>,
    /// Why they cannot be read.
    pub(super) unreadable: Option<String>,
}

impl Topic {
    /// Whether the first message that holds numbers must tell which fields there are.
    pub(super) fn is_undecided(&self) -> bool {
        self.decoder.is_none() && self.is_json()
    }

    fn is_json(&self) -> bool {
        matches!(self.message_type, Some(MessageType::Json))
    }
}

/// A message of a channel.
pub(super) struct Message<'a> {
    pub(super) channel: u16,
    sequence: u32,
    log_time_ns: i64,
    pub(super) data: &'a [u8],
}

impl<'a> Message<'a> {
    /// From its record: channel, sequence (4 bytes), log time, publish time (8 bytes), data.
    pub(super) fn parse(body: &'a [u8]) -> Option<Self> {
        let (&channel, rest) = body.split_first_chunk()?;
        let (&sequence, rest) = rest.split_first_chunk()?;
        let (&log_time, rest) = rest.split_first_chunk()?;
        let log_time_ns = i64::try_from(u64::from_le_bytes(log_time)).unwrap_or(i64::MAX);
        let (channel, sequence) = (u16::from_le_bytes(channel), u32::from_le_bytes(sequence));
        Some(Self { channel, sequence, log_time_ns, data: rest.get(8..)? })
    }
}

/// What the messages of one sensor gave.
struct Sensor {
    /// The sensor and where the messages name it.
    rows: Option<RowsOf>,
    /// One for each field of the topic.
    columns: Vec<Column>,
}

/// A channel with its topic and what its messages told besides samples.
pub(super) struct TopicChannel {
    pub(super) topic: Rc<Topic>,
    pub(super) number: u16,
    pub(super) gathered: Gathered,
}

/// What a channel gave for one field, of one sensor where its messages name such.
pub(super) struct TopicSeries {
    pub(super) channel: Rc<TopicChannel>,
    /// `None` where its topic has none.
    pub(super) field: Option<Field>,
    pub(super) rows: Option<RowsOf>,
    pub(super) column: Column,
}

impl TopicSeries {
    pub(super) fn topic(&self) -> &Topic {
        &self.channel.topic
    }

    /// Whether both are of one channel.
    pub(super) fn is_beside(&self, other: &Self) -> bool {
        Rc::ptr_eq(&self.channel, &other.channel)
    }

    /// The unit that the messages state for it, or that their type fixes.
    pub(super) fn unit(&self) -> Option<String> {
        let topic = self.topic();
        let path = self.field.as_ref().map(|field| field.asked.path.to_string());
        let of_type = || topic.message_type.as_ref()?.implied_unit(&topic.schema_name, &path?);
        self.column.unit().or_else(of_type).map(str::to_owned)
    }
}

/// What the messages of a channel gave.
#[derive(Default)]
pub(super) struct Gathered {
    pub(super) messages: u64,
    /// Those that do not decode.
    pub(super) malformed: u64,
    /// Why the first of them does not.
    pub(super) first_problem: Option<String>,
    /// What each sensor gave that the messages name, or all of them together where they name none.
    sensors: Vec<Sensor>,
    /// Whether they name more than are told apart; what further ones gave lies with the last.
    has_further: bool,
    /// The numeric fields of a message in JSON that lacks one that is asked for.
    pub(super) leaves: Vec<Leaf>,
    /// What the channel's own record states that may be a factor of its samples.
    pub(super) factors: Vec<String>,
}

impl Gathered {
    /// Takes a message.
    fn take(&mut self, topic: &Topic, message: &Message, slots: &mut Slots, is_listed: bool) {
        self.messages += 1;
        let Some(decoder) = &topic.decoder else { return };
        slots.clear(topic.plan.count);
        if let Err(problem) = decoder.decode(message.data, slots) {
            self.malformed += 1;
            let is_packed = message.data.starts_with(&[0x28, 0xb5, 0x2f, 0xfd]);
            let problem = if is_packed { PACKED_ALONE.to_owned() } else { problem };
            self.first_problem.get_or_insert(problem);
            return;
        }
        for (at, field) in topic.plan.fields.iter().enumerate() {
            let value = slots.samples(field);
            let said = slots.beside(field);
            if value == Value::Missing && self.leaves.is_empty() && topic.is_json() {
                self.leaves = json::Fields::of(message.data).leaves;
            }
            let column = self.column_of(said.sensor.as_ref(), at);
            said.unit.into_iter().for_each(|unit| column.state_unit(unit));
            said.rates.iter().for_each(|rate| column.state_rate(rate));
            let time = MessageTime::of(said.stamp, message.log_time_ns);
            said.factors().for_each(|(factor, beside)| column.state_factor(&beside.field, factor));
            if !is_listed {
                said.others()
                    .for_each(|(number, beside)| column.see_other(beside.slot, &beside.field, number));
                column.see_other(usize::MAX, SEQUENCE, f64::from(message.sequence));
            }
            match said.applied(value, field.asked.is_scaled) {
                Ok(value) => take_each(column, value, time, &said),
                Err(refusal) => column.refuse(refusal),
            }
        }
    }

    /// That messages do not decode, where there are such; `topic` is told in a listing.
    pub(super) fn undecoded(&self, topic: Option<&str>) -> Option<McapFinding> {
        let (first, topic) = (self.first_problem.clone()?, topic.map(str::to_owned));
        Some(McapFinding::Undecoded { count: self.malformed, messages: self.messages, topic, first })
    }

    /// Moves over what the messages that follow gave, and leaves memory for others.
    fn append(&mut self, other: &mut Self) {
        self.messages += std::mem::take(&mut other.messages);
        self.malformed += std::mem::take(&mut other.malformed);
        let problem = other.first_problem.take();
        self.first_problem = self.first_problem.take().or(problem);
        if self.leaves.is_empty() {
            self.leaves = std::mem::take(&mut other.leaves);
        }
        self.has_further |= other.has_further;
        for more in &mut other.sensors {
            let known = self.sensors.iter().position(|own| own.rows == more.rows);
            let at = known.unwrap_or_else(|| self.add(more.rows.clone()));
            let own = &mut self.sensors[at];
            let known = own.columns.len().min(more.columns.len());
            own.columns.iter_mut().zip(&mut more.columns).for_each(|(own, more)| own.append(more));
            own.columns.extend(more.columns.drain(known..));
        }
    }

    /// Adds a sensor, or takes the last for it where there is no room; its place.
    fn add(&mut self, rows: Option<RowsOf>) -> usize {
        if self.sensors.len() < MOST_SENSORS {
            self.sensors.push(Sensor { rows, columns: Vec::new() });
        } else {
            self.has_further = true;
        }
        self.sensors.len() - 1
    }

    /// The column of a field, of the sensor that a message names.
    fn column_of(&mut self, named: Option<&(Cow<str>, &Beside)>, field: usize) -> &mut Column {
        let is = named.map(|(is, _)| &**is);
        let known = self.sensors.iter().position(|own| own.rows.as_ref().map(|rows| &*rows.is) == is);
        let rows =
            |(is, beside): &(Cow<str>, &Beside)| RowsOf { column: beside.field.clone(), is: is.to_string() };
        let at = known.unwrap_or_else(|| self.add(named.map(rows)));
        let columns = &mut self.sensors[at].columns;
        if columns.len() <= field {
            columns.resize_with(field + 1, Column::default);
        }
        &mut columns[field]
    }

    /// A series for each sensor and field of the channel `number`, after its last message; one without a
    /// field where its topic has none.
    pub(super) fn series(mut self, topic: Rc<Topic>, number: u16) -> Vec<TopicSeries> {
        let mut sensors = std::mem::take(&mut self.sensors);
        if sensors.is_empty() {
            sensors.push(Sensor { rows: None, columns: Vec::new() });
        }
        let has_further = self.has_further;
        let mut fields: Vec<Option<Field>> = topic.plan.fields.iter().cloned().map(Some).collect();
        fields.resize(fields.len().max(1), None);
        let channel = Rc::new(TopicChannel { topic, number, gathered: self });
        let mut all = Vec::with_capacity(sensors.len() * fields.len());
        for Sensor { rows, mut columns } in sensors {
            columns.resize_with(fields.len(), Column::default);
            for (field, mut column) in fields.iter().cloned().zip(columns) {
                column.settle_clock();
                if has_further {
                    column.refuse(Refusal::new(
                        format!(
                            "its messages name more than {MOST_SENSORS} sensors, which are not told apart"
                        ),
                        "have the recorder write a channel for each sensor",
                    ));
                }
                all.push(TopicSeries { channel: channel.clone(), field, rows: rows.clone(), column });
            }
        }
        all
    }

    /// The columns of all sensors.
    fn columns(&self) -> impl Iterator<Item = &Column> {
        self.sensors.iter().flat_map(|sensor| &sensor.columns)
    }

    /// The columns of all sensors.
    fn columns_mut(&mut self) -> impl Iterator<Item = &mut Column> {
        self.sensors.iter_mut().flat_map(|sensor| &mut sensor.columns)
    }
}

/// Takes what one message gave, samples with times of their own each at its time.
fn take_each(column: &mut Column, value: Value, time: MessageTime, said: &SaidBeside) {
    if let Value::Array(samples) = &value
        && let Some((times, beside)) = said.times(samples.len())
    {
        for at in 0..samples.len() {
            let sample = Value::Number { value: samples.get(at), is_narrow: false };
            column.take(sample, time, Some((times.get(at), beside)));
        }
    } else {
        column.take(value, time, said.tick());
    }
}

/// Why messages do not decode that are packed one by one.
const PACKED_ALONE: &str = "each message is packed by itself with zstd, as `ros2 bag record \
                            --compression-mode message` does, which is not read: \
     unpack them with `ros2 bag convert`";

/// What some of the messages of a file gave, as those of a chunk.
#[derive(Default)]
pub(super) struct Part {
    /// By the channel's place in the file, as far as one had a message.
    pub(super) gathered: Vec<Gathered>,
    slots: Slots,
    /// So many bytes of times and samples may be held for a listing; `None` where samples are read, which
    /// have a limit of their own.
    most_listed_bytes: Option<u64>,
    /// Memory of times and samples.
    pub(super) held_bytes: u64,
}

impl Part {
    /// Without messages so far.
    pub(super) fn new(most_listed_bytes: Option<u64>) -> Self {
        Self { most_listed_bytes, ..Self::default() }
    }

    /// Takes a message of the channel at `place`.
    pub(super) fn take(&mut self, place: usize, topic: &Topic, message: &Message) {
        self.make_room(place + 1);
        let gathered = &mut self.gathered[place];
        let held = |gathered: &Gathered| gathered.columns().map(Column::held_bytes).sum::<u64>();
        let before = held(gathered);
        gathered.take(topic, message, &mut self.slots, self.most_listed_bytes.is_some());
        self.held_bytes = (self.held_bytes + held(gathered)).saturating_sub(before);
        self.keep_within();
    }

    /// Moves over what the messages that follow gave, and leaves `other` as new but for its memory.
    pub(super) fn append(&mut self, other: &mut Self) {
        self.make_room(other.gathered.len());
        // Most of the time the system hands out the memory, a page after the other.
        let pairs = self.gathered.par_iter_mut().zip(&mut other.gathered);
        pairs.filter(|(_, more)| more.messages > 0).for_each(|(own, more)| own.append(more));
        self.held_bytes += std::mem::take(&mut other.held_bytes);
        self.keep_within();
    }

    /// Lists a file that holds more than there is memory for without times.
    fn keep_within(&mut self) {
        if self.most_listed_bytes.is_some_and(|most| self.held_bytes > most) {
            self.gathered.iter_mut().flat_map(Gathered::columns_mut).for_each(Column::forget);
            self.held_bytes = 0;
        }
    }

    fn make_room(&mut self, channels: usize) {
        if self.gathered.len() < channels {
            self.gathered.resize_with(channels, Gathered::default);
        }
    }
}
