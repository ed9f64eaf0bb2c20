//! The channels of an MCAP file to its topics, and their messages to a column for each field that is asked for.

use super::column::Column;
use super::json;
use super::message_type::{MessageType, MessageTypes, implied_unit};
use super::path::{self, FieldPath};
use super::plan::{Leaf, MOST_LEAVES, Plan};
use super::scanned::{ChannelInfo, Message};
use super::topic::{Gathered, Part, Stream, Topic};
use crate::data::{ChannelSpec, Issue, IssueCode, Severity};
use crate::ingest::Limits;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

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

/// What a walk through a file collects.
pub(super) struct Topics<'a> {
    asked: Asked<'a>,
    pub(super) limits: Limits,
    types: MessageTypes,
    /// In the order of the file.
    all: Vec<Topic>,
    by_name: HashMap<String, usize>,
    streams: Vec<Stream>,
    by_channel: HashMap<u16, usize>,
    /// By topic, schema and encoding: a file may announce one of them under every number.
    same: HashMap<(usize, u16, String), usize>,
    room: Room,
    taken: Part,
    /// Emptied parts, for their memory.
    spare: Mutex<Vec<Part>>,
}

impl<'a> Topics<'a> {
    /// For a file of `file_bytes`.
    pub(super) fn new(asked: Asked<'a>, limits: Limits, file_bytes: u64) -> Self {
        Self {
            asked,
            limits,
            types: MessageTypes::new(limits, file_bytes),
            all: Vec::new(),
            by_name: HashMap::new(),
            streams: Vec::new(),
            by_channel: HashMap::new(),
            same: HashMap::new(),
            room: Room { left: MOST_LISTED, topics_out: 0, fields_out: 0 },
            taken: Part::new(most_listed(asked, limits, 1)),
            spare: Mutex::default(),
        }
    }

    /// A channel, before its first message; once for each id.
    pub(super) fn channel(&mut self, id: u16, info: &ChannelInfo) {
        let Some(topic) = self.topic(info) else { return };
        if let Asked::Sources(specs) = self.asked
            && specs.iter().all(|spec| path::field_in(&spec.source, info.topic).is_none())
        {
            return;
        }
        let same = (topic, info.schema_id, info.message_encoding.to_owned());
        let at = self.same.get(&same).copied().unwrap_or_else(|| {
            let stream = self.stream(topic, info);
            self.streams.push(stream);
            self.same.insert(same, self.streams.len() - 1);
            self.streams.len() - 1
        });
        self.by_channel.insert(id, at);
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

    /// Takes a message into a part; `false` where it must be taken in turn, because the topic's fields are not known yet.
    pub(super) fn take(&self, part: &mut Part, message: &Message) -> bool {
        let Some(stream) = self.by_channel.get(&message.channel).and_then(|&at| self.streams.get(at)) else {
            return true;
        };
        part.take(&self.all[stream.topic], stream, message);
        stream.decoder.is_some() || stream.message_type.is_none()
    }

    /// [`Topics::take`] of a message that may be the first to tell the fields of its topic.
    pub(super) fn take_in_turn(&mut self, part: &mut Part, message: &Message) {
        /// A tree of JSON values takes up to so many times its text: two letters become 32 bytes.
        const TREE_BYTES: u64 = 32;
        if let Some(&at) = self.by_channel.get(&message.channel)
            && let Some(MessageType::Json) = self.streams[at].message_type
            && self.streams[at].decoder.is_none()
        {
            let mut stream = std::mem::take(&mut self.streams[at]);
            if message.data.len() as u64 > self.limits.part_bytes() / TREE_BYTES {
                stream.message_type = None;
                self.all[stream.topic].unreadable = Some(format!(
                    "its fields were not looked for: a message takes {} MiB; allow more with --max-memory",
                    message.data.len() >> 20
                ));
            }
            let leaves = json::leaves(&message.data);
            if !leaves.is_empty() {
                self.prepare(&mut stream, leaves);
            }
            self.streams[at] = stream;
        }
        self.take(part, message);
    }

    /// Takes a message that stands in no chunk.
    pub(super) fn take_alone(&mut self, message: &Message) {
        let mut taken = std::mem::take(&mut self.taken);
        self.take_in_turn(&mut taken, message);
        self.taken = taken;
    }

    /// An empty part.
    pub(super) fn part(&self) -> Part {
        let spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner).pop();
        spare.unwrap_or_else(|| Part::new(most_listed(self.asked, self.limits, rayon::current_num_threads())))
    }

    /// Adds a part behind what there is.
    pub(super) fn join(&mut self, mut part: Part) {
        self.taken.append(&mut part);
        self.spare.get_mut().unwrap_or_else(PoisonError::into_inner).push(part);
    }

    /// Memory that the times and samples taken so far hold.
    pub(super) fn held_bytes(&self) -> u64 {
        self.taken.held_bytes
    }

    /// A note on what there was no room to list.
    pub(super) fn unlisted(&self) -> Option<Issue> {
        let Room { topics_out, fields_out, .. } = self.room;
        (topics_out + fields_out > 0).then(|| {
            let message = format!(
                "it holds more than is listed, {MOST_LISTED} in all and {MOST_LEAVES} of a topic: {topics_out} more topics and {fields_out} more fields of the listed ones; a source that is not listed is read all the same"
            );
            Issue::new(IssueCode::Unlisted, Severity::Note, message)
        })
    }

    /// The topics of the file, in its order, each with what its messages gave.
    pub(super) fn finish(self) -> Vec<(Topic, Gathered)> {
        let mut gathered = self.taken.gathered;
        gathered.resize_with(self.all.len(), Gathered::default);
        gathered.iter_mut().flat_map(|gathered| &mut gathered.columns).for_each(Column::settle_clock);
        self.all.into_iter().zip(gathered).collect()
    }
}

/// What each of so many parts that are held at a time may hold for a listing, bytes.
fn most_listed(asked: Asked, limits: Limits, parts: usize) -> Option<u64> {
    matches!(asked, Asked::Everything).then(|| limits.samples_bytes() / (2 * parts as u64))
}
