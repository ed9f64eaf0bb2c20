//! The schemas and channels of an MCAP file to its topics, and their messages to a column for each field that
//! is asked for.

use super::chunk::Chunk;
use super::json;
use super::message_type::{ChannelInfo, MessageTypes, SchemaInfo};
use super::path::{self, FieldPath};
use super::plan::{AskedField, Leaf, MOST_LEAVES, Plan};
use super::scanned::Losses;
use super::topic::{Channels, Gathered, Message, Part, Stream, Topic};
use crate::data::{CaskFile, ChannelSpec, Finding, McapFinding, Source};
use crate::ingest::Limits;
use mcap::records::{Record, op};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// So many topics and fields are listed in all, each counted once more for every kilobyte of its names: a
/// recording of hundreds of sensors has thousands, and each takes 3 kB. An HDF5 file lists as many objects.
const MOST_LISTED: usize = 10_000;

/// The word by which a cask file takes the log times instead of the messages' own.
pub(super) const LOG_TIME: &str = "log_time";

/// Why a topic of such messages cannot be read.
pub(super) const LISTS_OF_RECORDS: &str =
    "its messages hold lists of records: a message a record is read, or an array of numbers for each field";

/// What is asked of a file.
#[derive(Clone, Copy)]
pub(super) enum Asked<'a> {
    /// The fields that the channels of a cask file name.
    Sources(&'a CaskFile),
    /// Every numeric field, for a listing.
    Everything,
}

/// What may still be listed, and what was left out.
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
pub(super) struct Topics<'a> {
    asked: Asked<'a>,
    limits: Limits,
    types: MessageTypes,
    /// The first of an id stands.
    schemas: HashMap<u16, SchemaInfo>,
    /// In the order of the file.
    all: Vec<Topic>,
    by_name: HashMap<String, usize>,
    streams: Vec<Stream>,
    /// The stream of each channel, the first of an id, and its place in the file; `None` where its messages
    /// are not asked for.
    by_channel: HashMap<u16, Option<(usize, usize)>>,
    /// The topic and the number of each channel that is asked for, in the order of the file.
    channels: Vec<(usize, u16)>,
    /// By topic, schema and encoding: a file may announce one of them under every number.
    same: HashMap<(usize, u16, String), usize>,
    room: Room,
    /// Memory of the names and schemas.
    pub(super) held_bytes: u64,
}

impl<'a> Topics<'a> {
    /// For a file of `file_bytes`.
    pub(super) fn new(asked: Asked<'a>, limits: Limits, file_bytes: u64) -> Self {
        Self {
            asked,
            limits,
            types: MessageTypes::new(limits, file_bytes),
            schemas: HashMap::new(),
            all: Vec::new(),
            by_name: HashMap::new(),
            streams: Vec::new(),
            by_channel: HashMap::new(),
            channels: Vec::new(),
            same: HashMap::new(),
            room: Room { left: MOST_LISTED, topics_out: 0, fields_out: 0 },
            held_bytes: 0,
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
                    let (name, encoding) = (header.name, header.encoding);
                    free.insert(SchemaInfo { name, encoding, data: data.into_owned() });
                }
            }
            Record::Channel(channel) if !self.by_channel.contains_key(&channel.id) => {
                let is_complete = channel.schema_id == 0 || self.schemas.contains_key(&channel.schema_id);
                if is_complete || !is_ahead {
                    self.held_bytes += (channel.topic.len() + channel.message_encoding.len()) as u64;
                    let stream = self.channel(&channel);
                    let placed = stream.map(|stream| (stream, self.channels.len()));
                    self.channels.extend(stream.map(|stream| (self.streams[stream].topic, channel.id)));
                    self.by_channel.insert(channel.id, placed);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// The stream of a channel, before its first message; `None` where it is not asked for.
    fn channel(&mut self, channel: &mcap::records::Channel) -> Option<usize> {
        let schemas = std::mem::take(&mut self.schemas);
        let info = ChannelInfo {
            topic: &channel.topic,
            message_encoding: &channel.message_encoding,
            schema_id: channel.schema_id,
            schema: schemas.get(&channel.schema_id),
        };
        let stream = self.stream_of(&info);
        self.schemas = schemas;
        stream
    }

    fn stream_of(&mut self, info: &ChannelInfo) -> Option<usize> {
        let topic = self.topic(info)?;
        if let Asked::Sources(file) = self.asked
            && file.channels.iter().all(|spec| path::field_in(&spec.source, info.topic).is_none())
        {
            return None;
        }
        let same = (topic, info.schema_id, info.message_encoding.to_owned());
        let known = self.same.get(&same).copied();
        Some(known.unwrap_or_else(|| {
            let stream = self.stream(topic, info);
            self.streams.push(stream);
            self.same.insert(same, self.streams.len() - 1);
            self.streams.len() - 1
        }))
    }

    /// The place of the topic that a channel writes on; `None` where there is no room to list it.
    fn topic(&mut self, info: &ChannelInfo) -> Option<usize> {
        if let Some(&known) = self.by_name.get(info.topic) {
            return Some(known);
        }
        let encoding = match info.schema {
            Some(schema) if !schema.name.is_empty() => format!("{} ({})", info.message_encoding, schema.name),
            _ => info.message_encoding.to_owned(),
        };
        let is_listed = matches!(self.asked, Asked::Everything);
        if is_listed && !self.room.takes(info.topic.len() + encoding.len()) {
            self.room.topics_out += 1;
            return None;
        }
        self.all.push(Topic {
            name: info.topic.to_owned(),
            encoding,
            fields: Vec::new(),
            leaves: Vec::new(),
            unreadable: None,
        });
        self.by_name.insert(info.topic.to_owned(), self.all.len() - 1);
        Some(self.all.len() - 1)
    }

    fn stream(&mut self, topic: usize, info: &ChannelInfo) -> Stream {
        let schema_name = info.schema.map_or_else(String::new, |schema| schema.name.clone());
        let mut stream = Stream { topic, schema_name, ..Stream::default() };
        match self.types.of(info) {
            Err(reason) => {
                self.all[topic].unreadable = Some(reason);
                for (asked, _) in self.asked_of(topic) {
                    self.all[topic].field(&asked.path, false, None);
                }
            }
            Ok(message_type) => {
                let leaves = message_type.leaves();
                stream.message_type = Some(message_type);
                // A message in JSON tells its fields itself.
                if let Some(leaves) = leaves {
                    self.prepare(&mut stream, leaves);
                }
            }
        }
        stream
    }

    /// Settles which fields of messages with such `leaves` are taken.
    fn prepare(&mut self, stream: &mut Stream, leaves: Vec<Leaf>) {
        let Some(message_type) = &stream.message_type else { return };
        let fields: Vec<(AskedField, bool)> = match self.asked {
            Asked::Sources(_) => self.asked_of(stream.topic),
            Asked::Everything => self.listed(stream.topic, &leaves),
        };
        let topic = &mut self.all[stream.topic];
        let mut taken = Vec::with_capacity(fields.len());
        for (asked, is_array) in fields {
            let unit = message_type.implied_unit(&stream.schema_name, &asked.path.to_string());
            let at = topic.field(&asked.path, is_array, unit);
            if !stream.fields.contains(&at) {
                stream.fields.push(at);
                taken.push(asked);
            }
        }
        stream.plan = Plan::new(&taken, &leaves, |path| message_type.has(path));
        topic.leaves.extend(leaves);
        stream.decoder = Some(message_type.decoder(&stream.plan));
    }

    /// The fields of a topic that sources name, none of them known to be an array.
    fn asked_of(&self, topic: usize) -> Vec<(AskedField, bool)> {
        let Asked::Sources(file) = self.asked else { return Vec::new() };
        let name = &self.all[topic].name;
        let within = |field: &str| {
            let whole = path::field_in(&Source::Path(field.to_owned()), name);
            whole.or_else(|| FieldPath::parse(field.trim_start_matches('/')))
        };
        let asked = |spec: &ChannelSpec| {
            let path = path::field_in(&spec.source, name)?;
            let beside = |field: &str| {
                let own = within(field)?;
                let nearer = path.enclosing().map(|message| FieldPath([message.0, own.0.clone()].concat()));
                Some(nearer.collect())
            };
            let times = file.time_of(spec).map(|time| match time {
                LOG_TIME => Vec::new(),
                time => beside(time).unwrap_or_default(),
            });
            let sensor = spec.rows.as_ref().and_then(|rows| within(&rows.column));
            Some((AskedField { path, times, sensor }, false))
        };
        file.channels.iter().filter_map(asked).collect()
    }

    /// The leaves of a topic that there is room to list, and whether they are arrays.
    fn listed(&mut self, topic: usize, leaves: &[Leaf]) -> Vec<(AskedField, bool)> {
        let Topic { name, encoding, fields, .. } = &self.all[topic];
        let mut listed = Vec::new();
        for leaf in leaves.iter().filter(|leaf| !leaf.is_about_others()) {
            let Some(path) = FieldPath::parse(&leaf.path) else { continue };
            let is_known = fields.iter().any(|field| field.path == path);
            // The topic stands for its first field.
            let is_first = listed.is_empty() && fields.is_empty();
            let name_bytes = name.len() + encoding.len() + leaf.path.len();
            if is_known || is_first || (listed.len() < MOST_LEAVES && self.room.takes(name_bytes)) {
                listed.push((AskedField::plain(path), leaf.is_array));
            } else {
                self.room.fields_out += 1;
            }
        }
        listed
    }

    /// Takes from an unpacked chunk what its messages need to be taken: schemas, channels, and which fields
    /// messages in JSON have.
    pub(super) fn meet(&mut self, chunk: &Chunk, losses: &mut Losses) {
        if chunk.counts.has_channels() {
            for (opcode, body) in chunk.records() {
                if let Err(why) = self.announce(opcode, body, false)
                    && !chunk.is_bad()
                {
                    losses.push_records(opcode, chunk.start, 1, why);
                }
            }
        }
        if !chunk.is_bad() && self.streams.iter().any(Stream::is_undecided) {
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
        if !self.streams[at].is_undecided() {
            return;
        }
        let mut stream = std::mem::take(&mut self.streams[at]);
        let is_asked = matches!(self.asked, Asked::Sources(_));
        let is_large = message.data.len() as u64 > self.limits.part_bytes() / TREE_BYTES;
        if is_large && !is_asked {
            stream.message_type = None;
            self.all[stream.topic].unreadable = Some(format!(
                "its fields were not looked for: a message takes {} MiB; allow more with --max-memory",
                message.data.len() >> 20
            ));
        } else {
            let leaves = if is_large { Vec::new() } else { json::leaves(message.data) };
            let has_signals = leaves.iter().any(|leaf| leaf.is_signal);
            if !has_signals && json::holds_records(message.data) {
                self.all[stream.topic].unreadable = Some(LISTS_OF_RECORDS.into());
            }
            if has_signals || is_asked {
                self.prepare(&mut stream, leaves);
            }
        }
        self.streams[at] = stream;
    }

    /// Takes a message into a part.
    ///
    /// # Errors
    /// Why it cannot be used.
    pub(super) fn take(&self, part: &mut Part, body: &[u8]) -> Result<(), &'static str> {
        let message = Message::parse(body).ok_or("that does not parse")?;
        if let Some((at, place)) = *self.by_channel.get(&message.channel).ok_or("whose channel is missing")? {
            part.take(place, &self.streams[at], &message);
        }
        Ok(())
    }

    /// An empty part, one of so many that are held at a time.
    pub(super) fn part(&self, count: usize) -> Part {
        let is_listed = matches!(self.asked, Asked::Everything);
        Part::new(is_listed.then(|| self.limits.samples_bytes() / (2 * count as u64)))
    }

    pub(super) fn schema_count(&self) -> usize {
        self.schemas.len()
    }

    pub(super) fn channel_count(&self) -> usize {
        self.by_channel.len()
    }

    /// A note on what there was no room to list.
    pub(super) fn unlisted(&self) -> Option<Finding> {
        let Room { topics_out: topics, fields_out: fields, .. } = self.room;
        let (most, most_of_topic) = (MOST_LISTED, MOST_LEAVES);
        (topics + fields > 0).then(|| McapFinding::Unlisted { most, most_of_topic, topics, fields }.into())
    }

    /// The topics of the file, in its order, each with its channels and what their messages gave, one at
    /// least.
    pub(super) fn finish(self, taken: Part) -> Vec<Channels> {
        let mut topics: Vec<_> = self.all.into_iter().map(|topic| (topic, Vec::new())).collect();
        for ((topic, number), mut gathered) in self.channels.into_iter().zip(taken.gathered) {
            gathered.settle();
            if gathered.messages > 0 {
                topics[topic].1.push((number, gathered));
            }
        }
        for (_, channels) in topics.iter_mut().filter(|(_, channels)| channels.is_empty()) {
            channels.push((0, Gathered::default()));
        }
        topics
    }
}
