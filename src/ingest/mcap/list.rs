//! An MCAP file to its listing: every numeric field of every topic, read once and kept nowhere.

use super::column::CLOCK_IS_SET_NS;
use super::message_type::{MessageType, MessageTypes};
use super::plan::Slots;
use super::scan::scan;
use super::scanned::{ChannelInfo, Scanned, Sink};
use super::topic::{Room, Topic};
use crate::data::{ListedChannel, Listing, RecordingFormat};
use crate::ingest::error::{self, IngestError};
use crate::ingest::{Limits, Progress};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// Lists what the file at `path` holds.
///
/// # Errors
/// Only where the file cannot be read at all.
pub(in crate::ingest) fn list(
    path: &Path,
    limits: Limits,
    progress: Progress,
) -> Result<Listing, IngestError> {
    let bytes = std::fs::metadata(path).map_err(|source| error::io(path, source))?.len();
    let mut walk = ListWalk::new(limits, bytes);
    let scanned = scan(path, limits, &mut walk, progress)?;
    let ListWalk { topics, slots, .. } = &mut walk;
    for topic in topics {
        topic.release(slots);
    }
    let mut issues = scanned.issues();
    issues.extend(walk.topics.iter().filter_map(Topic::issue));
    issues.extend(walk.room.issue());
    Ok(Listing {
        schema: "dropcheck.inspect/1",
        recording: path.display().to_string(),
        bytes,
        format: RecordingFormat::Mcap,
        counts: scanned.counts.named(),
        facts: facts(&scanned, walk.zero_ns()),
        channels: walk.finish(),
        issues,
    })
}

fn facts(scanned: &Scanned, zero_ns: Option<i64>) -> BTreeMap<String, String> {
    let is_set = |ns: &i64| *ns >= CLOCK_IS_SET_NS;
    let start = zero_ns.filter(is_set).and_then(|ns| jiff::Timestamp::from_nanosecond(ns.into()).ok());
    let compressions: Vec<&str> = scanned
        .compressions
        .iter()
        .map(|name| if name.is_empty() { "none" } else { name.as_str() })
        .collect();
    [
        ("profile", scanned.profile.clone()),
        ("library", scanned.library.clone()),
        ("compression", compressions.join(", ")),
        ("start", start.map(|start| start.to_string()).unwrap_or_default()),
    ]
    .into_iter()
    .filter(|(_, value)| !value.is_empty())
    .map(|(name, value)| (name.to_owned(), value))
    .collect()
}

pub(super) struct ListWalk {
    topics: Vec<Topic>,
    room: Room,
    types: MessageTypes,
    by_id: HashMap<u16, usize>,
    /// By name and encoding.
    by_name: HashMap<(String, String), usize>,
    slots: Slots,
    /// The longest JSON message that is taken apart.
    longest_json_bytes: u64,
    /// Chunks begun.
    chunk: u64,
    /// Topics with a message in this chunk.
    touched: Vec<usize>,
    held_bytes: u64,
}

impl Sink for ListWalk {
    type Part = ();

    fn channel(&mut self, id: u16, info: &ChannelInfo) {
        let encoding = match info.schema {
            Some(schema) if !schema.name.is_empty() => format!("{} ({})", info.message_encoding, schema.name),
            _ => info.message_encoding.to_owned(),
        };
        let same = (info.topic.to_owned(), encoding.clone());
        let known = self.by_name.get(&same).copied();
        if known.is_none() && !self.room.takes(info.topic.len() + encoding.len()) {
            self.room.topics_out += 1;
            return;
        }
        let index = known.unwrap_or_else(|| {
            let mut topic = Topic::new(info, encoding, self.types.of(info));
            if let Some(leaves) = topic.message_type.as_ref().ok().and_then(MessageType::leaves) {
                topic.prepare(leaves, &mut self.room);
            }
            self.held_bytes += topic.held_bytes();
            self.topics.push(topic);
            self.by_name.insert(same, self.topics.len() - 1);
            self.topics.len() - 1
        });
        self.by_id.insert(id, index);
    }

    fn message(&mut self, id: u16, log_time_ns: i64, data: &[u8]) {
        let Some(&index) = self.by_id.get(&id) else { return };
        let Some(topic) = self.topics.get_mut(index) else { return };
        if topic.marked_chunk != self.chunk {
            topic.set_mark(self.chunk);
            self.touched.push(index);
        }
        let before = topic.held_bytes();
        topic.message(log_time_ns, data, (&mut self.slots, &mut self.room), self.longest_json_bytes);
        self.held_bytes = (self.held_bytes + topic.held_bytes()).saturating_sub(before);
    }

    fn chunk_begins(&mut self) {
        // A topic is marked with its first message: there may be many topics, and many chunks of a message each.
        self.chunk += 1;
        self.touched.clear();
    }

    fn held_bytes(&self) -> u64 {
        self.held_bytes
    }

    fn chunk_rejected(&mut self) {
        for index in std::mem::take(&mut self.touched) {
            let Some(topic) = self.topics.get_mut(index) else { continue };
            topic.roll_back();
        }
    }
}

impl ListWalk {
    pub(super) fn new(limits: Limits, file_bytes: u64) -> Self {
        /// A tree of JSON values takes up to so many times its text: two letters become 32 bytes.
        const TREE_BYTES: u64 = 32;
        Self {
            topics: Vec::new(),
            room: Room::default(),
            types: MessageTypes::new(limits, file_bytes),
            by_id: HashMap::new(),
            by_name: HashMap::new(),
            slots: Slots::default(),
            longest_json_bytes: limits.part_bytes() / TREE_BYTES,
            chunk: 0,
            touched: Vec::new(),
            held_bytes: 0,
        }
    }

    /// The earliest sample of all, ns since 1970.
    fn zero_ns(&self) -> Option<i64> {
        self.topics.iter().filter_map(Topic::first_ns).min()
    }

    /// Every source, times counted from the earliest sample of all.
    fn finish(&self) -> Vec<ListedChannel> {
        let zero_ns = self.zero_ns();
        self.topics.iter().flat_map(|topic| topic.listed(zero_ns)).collect()
    }
}

#[cfg(test)]
#[path = "list_tests.rs"]
mod tests;
