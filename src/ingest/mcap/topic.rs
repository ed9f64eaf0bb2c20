//! A topic of an MCAP file with the fields that are asked for, and what its messages gave for each.

use super::column::{Column, MessageTime};
use super::json;
use super::message_type::MessageType;
use super::path::FieldPath;
use super::plan::{Decode, Leaf, Plan, Slots, Value};
use crate::data::McapFinding;
use rayon::prelude::*;

/// A topic, whatever the number of channels that write on it.
pub(super) struct Topic {
    pub(super) name: String,
    /// Encoding and schema of the first of its channels, for people.
    pub(super) encoding: String,
    /// Those that are asked for, of all its channels.
    pub(super) fields: Vec<Field>,
    /// The numeric fields that its schemas tell.
    pub(super) leaves: Vec<Leaf>,
    /// Why the messages of one of its channels cannot be read.
    pub(super) unreadable: Option<String>,
}

/// A field of a topic that is asked for.
pub(super) struct Field {
    pub(super) path: FieldPath,
    /// Whether it is an array, as its schema or first message says; of no meaning where a cask file names it.
    pub(super) is_array: bool,
    /// The unit that its message type fixes.
    pub(super) unit: Option<&'static str>,
}

impl Topic {
    /// The place of the field `path`, which is added where it is not there yet.
    pub(super) fn field(&mut self, path: &FieldPath, is_array: bool, unit: Option<&'static str>) -> usize {
        if let Some(at) = self.fields.iter().position(|field| field.path == *path) {
            return at;
        }
        self.fields.push(Field { path: path.clone(), is_array, unit });
        self.fields.len() - 1
    }
}

/// A message of a channel.
pub(super) struct Message<'a> {
    pub(super) channel: u16,
    log_time_ns: i64,
    pub(super) data: &'a [u8],
}

impl<'a> Message<'a> {
    /// From its record: channel, sequence (4 bytes), log time, publish time (8 bytes), data.
    pub(super) fn parse(body: &'a [u8]) -> Option<Self> {
        let (&channel, rest) = body.split_first_chunk()?;
        let (&log_time, rest) = rest.get(4..)?.split_first_chunk()?;
        let log_time_ns = i64::try_from(u64::from_le_bytes(log_time)).unwrap_or(i64::MAX);
        Some(Self { channel: u16::from_le_bytes(channel), log_time_ns, data: rest.get(8..)? })
    }
}

/// How to take the messages of a channel.
#[derive(Default)]
pub(super) struct Stream {
    /// Which topic they are on.
    pub(super) topic: usize,
    /// Schema and field fix a unit together.
    pub(super) schema_name: String,
    /// `None` where they cannot be read.
    pub(super) message_type: Option<MessageType>,
    pub(super) plan: Plan,
    /// `None` where they cannot be read, or the first of them must tell which fields they have.
    pub(super) decoder: Option<Box<dyn Decode>>,
    /// Which fields of the topic, one for each target of the plan.
    pub(super) fields: Vec<usize>,
}

impl Stream {
    /// Whether its first message that holds numbers must tell which fields there are.
    pub(super) fn is_undecided(&self) -> bool {
        self.decoder.is_none() && matches!(self.message_type, Some(MessageType::Json))
    }
}

/// What the messages of a topic gave.
#[derive(Default)]
pub(super) struct Gathered {
    pub(super) messages: u64,
    /// Those that do not decode.
    pub(super) malformed: u64,
    /// Why the first of them does not.
    pub(super) first_problem: Option<String>,
    /// One for each field of the topic.
    pub(super) columns: Vec<Column>,
    /// The numeric fields of a message in JSON that lacks one that is asked for.
    pub(super) leaves: Vec<Leaf>,
}

impl Gathered {
    /// Takes a message.
    fn take(&mut self, stream: &Stream, message: &Message, slots: &mut Slots) {
        self.messages += 1;
        let Some(decoder) = &stream.decoder else { return };
        slots.clear(stream.plan.wants.len());
        if let Err(problem) = decoder.decode(message.data, slots) {
            self.malformed += 1;
            self.first_problem.get_or_insert(problem);
            return;
        }
        for (target, &field) in stream.plan.targets.iter().zip(&stream.fields) {
            let Some(column) = self.columns.get_mut(field) else { continue };
            slots.unit(target).into_iter().for_each(|unit| column.state_unit(unit));
            slots.rates(target).for_each(|rate| column.state_rate(rate));
            let time = MessageTime::of(&slots.stamp(target), message.log_time_ns);
            let value = slots.samples(target);
            if value == Value::Missing
                && self.leaves.is_empty()
                && matches!(stream.message_type, Some(MessageType::Json))
            {
                self.leaves = json::leaves(message.data);
            }
            column.take(value, time);
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
        let known = self.columns.len().min(other.columns.len());
        self.columns.iter_mut().zip(&mut other.columns).for_each(|(own, more)| own.append(more));
        self.columns.extend(other.columns.drain(known..));
    }
}

/// What some of the messages of a file gave, as those of a chunk.
#[derive(Default)]
pub(super) struct Part {
    /// By topic, as far as one had a message.
    pub(super) gathered: Vec<Gathered>,
    /// The topics with a message: a file may have thousands, and chunks of a message each.
    touched: Vec<usize>,
    slots: Slots,
    /// So many bytes of times may be held for a listing; `None` where samples are read, which have a limit of their own.
    most_listed_bytes: Option<u64>,
    /// Memory of times and samples.
    pub(super) held_bytes: u64,
}

impl Part {
    /// Without messages so far.
    pub(super) fn new(most_listed_bytes: Option<u64>) -> Self {
        Self { most_listed_bytes, ..Self::default() }
    }

    /// Takes a message of the `stream` on the `topic`.
    pub(super) fn take(&mut self, topic: &Topic, stream: &Stream, message: &Message) {
        self.make_room(stream.topic + 1);
        let gathered = &mut self.gathered[stream.topic];
        if gathered.messages == 0 {
            self.touched.push(stream.topic);
        }
        if gathered.columns.len() < topic.fields.len() {
            let is_listed = self.most_listed_bytes.is_some();
            gathered.columns.resize_with(topic.fields.len(), || Column::new(is_listed));
        }
        let held = |gathered: &Gathered| gathered.columns.iter().map(Column::held_bytes).sum::<u64>();
        let before = held(gathered);
        gathered.take(stream, message, &mut self.slots);
        self.held_bytes = (self.held_bytes + held(gathered)).saturating_sub(before);
        self.keep_within();
    }

    /// Moves over what the messages that follow gave, and leaves `other` as new but for its memory.
    pub(super) fn append(&mut self, other: &mut Self) {
        self.make_room(other.gathered.len());
        let Self { gathered, touched, .. } = self;
        let mut pairs: Vec<(usize, Gathered, Gathered)> = Vec::with_capacity(other.touched.len());
        for at in other.touched.drain(..) {
            let own = std::mem::take(&mut gathered[at]);
            if own.messages == 0 {
                touched.push(at);
            }
            pairs.push((at, own, std::mem::take(&mut other.gathered[at])));
        }
        // Most of the time the system hands out the memory, a page after the other.
        pairs.par_iter_mut().for_each(|(_, own, more)| own.append(more));
        for (at, own, more) in pairs {
            (self.gathered[at], other.gathered[at]) = (own, more);
        }
        self.held_bytes += std::mem::take(&mut other.held_bytes);
        self.keep_within();
    }

    /// Lists a file that holds more times than there is memory for without them.
    fn keep_within(&mut self) {
        if self.most_listed_bytes.is_some_and(|most| self.held_bytes > most) {
            self.gathered
                .iter_mut()
                .flat_map(|gathered| &mut gathered.columns)
                .for_each(Column::forget_times);
            self.held_bytes = 0;
        }
    }

    fn make_room(&mut self, topics: usize) {
        if self.gathered.len() < topics {
            self.gathered.resize_with(topics, Gathered::default);
        }
    }
}
