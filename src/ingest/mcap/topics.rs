//! The schemas and channels of an MCAP file to its topics, and their messages to a column for each field that
//! is asked for.

use super::chunk::Chunk;
use super::json;
use super::message_type::{MessageType, MessageTypes};
use super::path::{self, FieldPath};
use super::plan::{AskedField, Leaf, MOST_LEAVES, Plan};
use super::scanned::Scanned;
use super::topic::{Gathered, Message, Part, Topic, TopicSeries};
use crate::data::{CaskFile, ChannelSpec, Finding, McapFinding, Source};
use crate::ingest::{Limits, factors};
use mcap::Schema;
use mcap::records::{Channel, Record, SchemaHeader, op};
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

/// So many topics and fields are listed in all, each counted once more for every kilobyte of its names: a
/// recording of hundreds of sensors has thousands, and each takes 3 kB. An HDF5 file lists as many objects.
const MOST_LISTED: usize = 10_000;

/// The word by which a cask file takes the log times instead of the messages' own.
pub(super) const LOG_TIME: &str = "log_time";

/// Why a topic of such messages cannot be read.
pub(super) const LISTS_OF_RECORDS: &str =
    "its messages hold lists of records: a message a record is read, or an array of numbers for each field";

/// A channel that is asked for.
struct AskedChannel {
    /// The place of its topic.
    topic: usize,
    number: u16,
    /// What its record states that may be a factor of its samples.
    factors: Vec<String>,
}

/// What may still be listed, and what was left out.
#[derive(Default)]
struct Room {
    left: usize,
    topics_out: usize,
    fields_out: usize,
}

impl Room {
    /// Whether one more with names of so many bytes is listed.
    fn takes(&mut self, name_bytes: usize) -> bool {
        let left = self.left.checked_sub(1 + name_bytes / 1024);
        self.left = left.unwrap_or(0);
        left.is_some()
    }
}

/// The schemas, channels and topics met so far, and how to take their messages.
#[derive(Default)]
pub(super) struct Topics<'a> {
    /// Whose channels name the fields that are asked for; every numeric one is for a listing.
    asked: Option<&'a CaskFile>,
    limits: Limits,
    types: MessageTypes,
    /// The first of an id stands.
    pub(super) schemas: HashMap<u16, Schema<'static>>,
    /// In the order of the file.
    all: Vec<Topic>,
    /// How many of them are undecided: to ask all of them at each chunk takes the square of a large file.
    undecided: usize,
    /// The place of each topic with its schema and encoding, `None` where it is not asked for: a file may
    /// announce one of them under every number.
    by_type: HashMap<(String, u16, String), Option<usize>>,
    /// The topic of each channel, the first of an id, and its place in the file; `None` where its messages
    /// are not asked for.
    pub(super) by_channel: HashMap<u16, Option<(usize, usize)>>,
    /// The channels that are asked for, in the order of the file.
    channels: Vec<AskedChannel>,
    room: Room,
    /// Memory of the names and schemas.
    pub(super) held_bytes: u64,
}

impl<'a> Topics<'a> {
    /// For a file of `file_bytes`.
    pub(super) fn new(asked: Option<&'a CaskFile>, limits: Limits, file_bytes: u64) -> Self {
        Self {
            asked,
            limits,
            types: MessageTypes::new(limits, file_bytes),
            room: Room { left: MOST_LISTED, ..Room::default() },
            ..Self::default()
        }
    }

    /// Takes a schema or channel that was not there before; `is_ahead` of the data, where a channel may lack
    /// its schema.
    ///
    /// # Errors
    /// Why the record cannot be used.
    pub(super) fn announce(&mut self, opcode: u8, body: &[u8], is_ahead: bool) -> Result<(), &'static str> {
        if !matches!(opcode, op::SCHEMA | op::CHANNEL) {
            return Ok(());
        }
        match mcap::parse_record(opcode, body).map_err(|_| "that does not parse")? {
            Record::Schema { header, data } => {
                if let Entry::Vacant(free) = self.schemas.entry(header.id) {
                    self.held_bytes += (header.name.len() + header.encoding.len() + data.len()) as u64;
                    let (data, SchemaHeader { id, name, encoding }) = (data.into_owned().into(), header);
                    free.insert(Schema { id, name, encoding, data });
                }
            }
            Record::Channel(channel) if !self.by_channel.contains_key(&channel.id) => {
                let is_complete = channel.schema_id == 0 || self.schemas.contains_key(&channel.schema_id);
                if is_complete || !is_ahead {
                    self.held_bytes += (channel.topic.len() + channel.message_encoding.len()) as u64;
                    let (topic, number) = (self.topic(&channel), channel.id);
                    self.by_channel.insert(number, topic.map(|topic| (topic, self.channels.len())));
                    let factors = factors::among(&channel.metadata);
                    self.channels.extend(topic.map(|topic| AskedChannel { topic, number, factors }));
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// The place of the topic that a channel writes on; `None` where it is not asked for, or there is no room
    /// to list it.
    fn topic(&mut self, channel: &Channel) -> Option<usize> {
        let of_type = (channel.topic.clone(), channel.schema_id, channel.message_encoding.clone());
        if let Some(known) = self.by_type.get(&of_type) {
            return *known;
        }
        let at = self.new_topic(channel);
        self.by_type.insert(of_type, at);
        at
    }

    fn new_topic(&mut self, channel: &Channel) -> Option<usize> {
        let schema = self.schemas.get(&channel.schema_id);
        let schema_name = schema.map_or_else(String::new, |schema| schema.name.clone());
        let encoding = match schema_name.as_str() {
            "" => channel.message_encoding.clone(),
            name => format!("{} ({name})", channel.message_encoding),
        };
        let is_asked = match self.asked {
            Some(file) => {
                file.channels.iter().any(|spec| path::field_in(&spec.source, &channel.topic).is_some())
            }
            None => self.room.takes(channel.topic.len() + encoding.len()),
        };
        if self.asked.is_none() && !is_asked {
            self.room.topics_out += 1;
            return None;
        }
        let message_type = is_asked.then(|| self.types.of(channel, schema)).transpose();
        let mut topic = Topic { name: channel.topic.clone(), encoding, schema_name, ..Topic::default() };
        topic.unreadable = message_type.as_ref().err().cloned();
        topic.message_type = message_type.ok().flatten();
        // A message in JSON tells its fields itself.
        if let Some(leaves) = topic.message_type.as_ref().and_then(MessageType::leaves) {
            self.prepare(&mut topic, leaves);
        }
        self.undecided += usize::from(topic.is_undecided());
        self.all.push(topic);
        is_asked.then_some(self.all.len() - 1)
    }

    /// Settles which fields of messages with such `leaves` are taken.
    fn prepare(&mut self, topic: &mut Topic, leaves: Vec<Leaf>) {
        let asked = match self.asked {
            Some(file) => asked_of(file, &topic.name),
            None => self.listed(topic, &leaves),
        };
        let Some(message_type) = &topic.message_type else { return };
        topic.plan = Plan::new(&asked, &leaves, |path| message_type.has(path));
        topic.decoder = Some(message_type.decoder(&topic.plan));
        topic.leaves = leaves;
    }

    /// The leaves of a topic that there is room to list.
    fn listed(&mut self, topic: &Topic, leaves: &[Leaf]) -> Vec<AskedField> {
        let mut listed = Vec::new();
        for leaf in leaves.iter().filter(|leaf| !leaf.is_about_others()) {
            let Some(path) = FieldPath::parse(&leaf.path) else { continue };
            let name_bytes = topic.name.len() + topic.encoding.len() + leaf.path.len();
            // The topic stands for its first field.
            if listed.is_empty() || (listed.len() < MOST_LEAVES && self.room.takes(name_bytes)) {
                listed.push(AskedField { is_array: leaf.is_array, ..AskedField::plain(path) });
            } else {
                self.room.fields_out += 1;
            }
        }
        listed
    }

    /// Takes from an unpacked chunk what its messages need to be taken: schemas, channels, and which fields
    /// messages in JSON have.
    pub(super) fn meet(&mut self, chunk: &Chunk, scanned: &mut Scanned) {
        if chunk.counts.has_channels() {
            for (opcode, body) in chunk.records() {
                if let Err(why) = self.announce(opcode, body, false)
                    && !chunk.is_bad()
                {
                    scanned.lose_records(opcode, chunk.start, 1, why);
                }
            }
        }
        if !chunk.is_bad() && self.undecided > 0 {
            let messages = chunk.records().filter(|(opcode, _)| *opcode == op::MESSAGE);
            messages.for_each(|(_, body)| self.look_at(body));
        }
    }

    /// Looks at a message that may be the first to tell the fields of its topic.
    pub(super) fn look_at(&mut self, body: &[u8]) {
        /// A tree of JSON values takes up to so many times its text: two letters become 32 bytes.
        const TREE_BYTES: u64 = 32;
        let Some(message) = Message::parse(body) else { return };
        let Some(&Some((at, _))) = self.by_channel.get(&message.channel) else { return };
        if !self.all[at].is_undecided() {
            return;
        }
        let mut topic = std::mem::take(&mut self.all[at]);
        let is_asked = self.asked.is_some();
        let is_large = message.data.len() as u64 > self.limits.part_bytes() / TREE_BYTES;
        if is_large && !is_asked {
            topic.message_type = None;
            topic.unreadable = Some(format!(
                "its fields were not looked for: a message takes {} MiB; allow more with --max-memory",
                message.data.len() >> 20
            ));
        } else {
            let json::Fields { leaves, has_records } =
                if is_large { json::Fields::default() } else { json::Fields::of(message.data) };
            let has_signals = leaves.iter().any(|leaf| leaf.is_signal);
            if !has_signals && has_records {
                topic.unreadable = Some(LISTS_OF_RECORDS.into());
            }
            if has_signals || is_asked {
                self.prepare(&mut topic, leaves);
            }
        }
        self.undecided -= usize::from(!topic.is_undecided());
        self.all[at] = topic;
    }

    /// Takes a message into a part.
    ///
    /// # Errors
    /// Why it cannot be used.
    pub(super) fn take(&self, part: &mut Part, body: &[u8]) -> Result<(), &'static str> {
        let message = Message::parse(body).ok_or("that does not parse")?;
        if let Some((at, place)) = *self.by_channel.get(&message.channel).ok_or("whose channel is missing")? {
            part.take(place, &self.all[at], &message);
        }
        Ok(())
    }

    /// An empty part, which in a listing may hold the `share`th part of what samples may take.
    pub(super) fn part(&self, share: usize) -> Part {
        Part::new(self.asked.is_none().then(|| self.limits.samples_bytes() / share as u64))
    }

    /// A note on what there was no room to list.
    pub(super) fn unlisted(&self) -> Option<Finding> {
        let Room { topics_out: topics, fields_out: fields, .. } = self.room;
        let (most, most_of_topic) = (MOST_LISTED, MOST_LEAVES);
        (topics + fields > 0).then(|| McapFinding::Unlisted { most, most_of_topic, topics, fields }.into())
    }

    /// What each channel with messages gave for each field, by topics in the order of the file; of types
    /// without a message one that no other has on its topic.
    pub(super) fn finish(self, taken: Part) -> Vec<TopicSeries> {
        let mut channels: Vec<Vec<(u16, Gathered)>> = self.all.iter().map(|_| Vec::new()).collect();
        for (AskedChannel { topic, number, factors }, mut gathered) in
            self.channels.into_iter().zip(taken.gathered)
        {
            if gathered.messages > 0 {
                gathered.factors = factors;
                channels[topic].push((number, gathered));
            }
        }
        let mut topics: Vec<_> = self.all.into_iter().zip(channels).collect();
        // First those with messages; what follows of the same name has none.
        let mut names: HashSet<String> =
            topics.iter().filter(|it| !it.1.is_empty()).map(|it| it.0.name.clone()).collect();
        topics.retain(|(topic, channels)| !channels.is_empty() || names.insert(topic.name.clone()));
        let mut all = Vec::new();
        for (topic, mut channels) in topics {
            if channels.is_empty() {
                channels.push((0, Gathered::default()));
            }
            let topic = Rc::new(topic);
            for (number, gathered) in channels {
                all.extend(gathered.series(topic.clone(), number));
            }
        }
        all
    }
}

/// The fields of a topic that sources name, none of them known to be an array.
fn asked_of(file: &CaskFile, topic: &str) -> Vec<AskedField> {
    let within = |field: &str| {
        let whole = path::field_in(&Source::Path(field.to_owned()), topic);
        whole.or_else(|| FieldPath::parse(field.trim_start_matches('/')))
    };
    let asked = |spec: &ChannelSpec| {
        let path = path::field_in(&spec.source, topic)?;
        let beside = |field: &str| {
            let own = within(field)?;
            let nearer = path.enclosing().map(|message| FieldPath([message.0, own.0.clone()].concat()));
            Some(nearer.collect())
        };
        let times = file.time_source(spec).map(|time| match time {
            LOG_TIME => Vec::new(),
            time => beside(time).unwrap_or_default(),
        });
        let sensor = spec.rows.as_ref().and_then(|rows| within(&rows.column));
        Some(AskedField { path, is_array: false, times, sensor, is_scaled: spec.scale.is_some() })
    };
    file.channels.iter().filter_map(asked).collect()
}
