//! The schemas and channels of an MCAP file to its topics, and their messages to a column for each field that is asked for.

use super::chunk::Chunk;
use super::column::Column;
use super::json;
use super::message_type::{ChannelInfo, MessageTypes, SchemaInfo, implied_unit};
use super::path::{self, FieldPath};
use super::plan::{Leaf, MOST_LEAVES, Plan};
use super::scanned::Losses;
use super::topic::{Gathered, Message, Part, Stream, Topic};
use crate::data::{ChannelSpec, Finding, McapFinding};
use crate::ingest::Limits;
use mcap::records::{Record, op};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// So many topics and fields are listed in all, each counted once more for every kilobyte of its names: a recording of hundreds of
/// sensors has thousands, and each takes 3 kB. An HDF5 file lists as many objects.
const MOST_LISTED: usize = 10_000;

/// What is asked of a file.
#[derive(Clone, Copy)]
pub(super) enum Asked<'a> {
    /// The fields that these sources name.
    Sources(&'a [ChannelSpec]),
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
    /// The stream of each channel, the first of an id; `None` where its messages are not asked for.
    by_channel: HashMap<u16, Option<usize>>,
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
            same: HashMap::new(),
            room: Room { left: MOST_LISTED, topics_out: 0, fields_out: 0 },
            held_bytes: 0,
        }
    }

    /// Takes a schema or channel that was not there before; `is_ahead` of the data, where a channel may lack its schema.
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
                    self.by_channel.insert(channel.id, stream);
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
        if let Asked::Sources(specs) = self.asked
            && specs.iter().all(|spec| path::field_in(&spec.source, info.topic).is_none())
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
                for (path, _) in self.asked_of(topic) {
                    self.all[topic].field(&path, false, None);
                }
            }
            Ok(message_type) => {
                let leaves = message_type.leaves();
                stream.message_type = Some(message_type);
                // A message in JSON tells its fields itself.
                if leaves.is_some() || matches!(self.asked, Asked::Sources(_)) {
                    self.prepare(&mut stream, leaves.unwrap_or_default());
                }
            }
        }
        stream
    }

    /// Settles which fields of messages with such `leaves` are taken.
    fn prepare(&mut self, stream: &mut Stream, leaves: Vec<Leaf>) {
        let Some(message_type) = &stream.message_type else { return };
        let fields: Vec<(FieldPath, bool)> = match self.asked {
            Asked::Sources(_) => self.asked_of(stream.topic),
            Asked::Everything => self.listed(stream.topic, &leaves),
        };
        let topic = &mut self.all[stream.topic];
        topic.leaves.extend(leaves);
        let mut paths = Vec::with_capacity(fields.len());
        for (path, is_array) in fields {
            let at = topic.field(&path, is_array, implied_unit(&stream.schema_name, &path.to_string()));
            if !stream.fields.contains(&at) {
                stream.fields.push(at);
                paths.push(path);
            }
        }
        stream.plan = Plan::new(&paths);
        stream.decoder = Some(message_type.decoder(&stream.plan));
    }

    /// The fields of a topic that sources name, none of them known to be an array.
    fn asked_of(&self, topic: usize) -> Vec<(FieldPath, bool)> {
        let Asked::Sources(specs) = self.asked else { return Vec::new() };
        let name = &self.all[topic].name;
        specs.iter().filter_map(|spec| Some((path::field_in(&spec.source, name)?, false))).collect()
    }

    /// The leaves of a topic that there is room to list, and whether they are arrays.
    fn listed(&mut self, topic: usize, leaves: &[Leaf]) -> Vec<(FieldPath, bool)> {
        let Topic { name, encoding, fields, .. } = &self.all[topic];
        let mut listed = Vec::new();
        for leaf in leaves.iter().filter(|leaf| !leaf.is_about_others()) {
            let Some(path) = FieldPath::parse(&leaf.path) else { continue };
            let is_known = fields.iter().any(|field| field.path == path);
            // The topic stands for its first field.
            let is_first = listed.is_empty() && fields.is_empty();
            let name_bytes = name.len() + encoding.len() + leaf.path.len();
            if is_known || is_first || (listed.len() < MOST_LEAVES && self.room.takes(name_bytes)) {
                listed.push((path, leaf.is_array));
            } else {
                self.room.fields_out += 1;
            }
        }
        listed
    }

    /// Takes from an unpacked chunk what its messages need to be taken: schemas, channels, and which fields messages in JSON have.
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
        let Some(&Some(at)) = self.by_channel.get(&message.channel) else { return };
        if !self.streams[at].is_undecided() {
            return;
        }
        let mut stream = std::mem::take(&mut self.streams[at]);
        if message.data.len() as u64 > self.limits.part_bytes() / TREE_BYTES {
            stream.message_type = None;
            self.all[stream.topic].unreadable = Some(format!(
                "its fields were not looked for: a message takes {} MiB; allow more with --max-memory",
                message.data.len() >> 20
            ));
        } else {
            let leaves = json::leaves(message.data);
            if !leaves.is_empty() {
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
        if let Some(at) = *self.by_channel.get(&message.channel).ok_or("whose channel is missing")? {
            let stream = &self.streams[at];
            part.take(&self.all[stream.topic], stream, &message);
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

    /// The topics of the file, in its order, each with what its messages gave.
    pub(super) fn finish(self, taken: Part) -> Vec<(Topic, Gathered)> {
        let mut gathered = taken.gathered;
        gathered.resize_with(self.all.len(), Gathered::default);
        gathered.iter_mut().flat_map(|gathered| &mut gathered.columns).for_each(Column::settle_clock);
        self.all.into_iter().zip(gathered).collect()
    }
}
