//! Records to the schemas and channels of a file, and to messages of known channels.

use super::scanned::{ChannelInfo, Message, Scanned, SchemaInfo};
use super::topics::Topics;
use mcap::records::{Record, op};
use std::collections::{HashMap, HashSet};

/// The schemas and channels met so far; the first of an id stands.
#[derive(Debug, Default)]
pub(super) struct Catalog {
    schemas: HashMap<u16, SchemaInfo>,
    channels: HashSet<u16>,
    held_bytes: u64,
}

/// What a record holds for who reads the file.
pub(super) enum Sorted<'a> {
    /// A message of a known channel.
    Message(Message<'a>),
    /// Something to be added to the catalog, or to what is known of the file.
    New(Record<'a>),
    /// Nothing: a schema or channel that was there before, or a record of the file's index.
    Nothing,
    /// Why the record cannot be used.
    Bad(&'static str),
}

impl Catalog {
    /// What a record holds.
    pub(super) fn sorted<'a>(&self, opcode: u8, body: &'a [u8]) -> Sorted<'a> {
        if !matches!(opcode, op::HEADER | op::SCHEMA | op::CHANNEL | op::MESSAGE | op::STATISTICS) {
            return Sorted::Nothing;
        }
        match mcap::parse_record(opcode, body).ok() {
            Some(Record::Message { header, .. }) if !self.channels.contains(&header.channel_id) => {
                Sorted::Bad("whose channel is missing")
            }
            Some(Record::Message { header, data }) => Sorted::Message(Message {
                channel: header.channel_id,
                log_time_ns: i64::try_from(header.log_time).unwrap_or(i64::MAX),
                data,
            }),
            Some(Record::Schema { header, .. }) if self.schemas.contains_key(&header.id) => Sorted::Nothing,
            Some(Record::Channel(channel)) if self.channels.contains(&channel.id) => Sorted::Nothing,
            Some(record) => Sorted::New(record),
            None => Sorted::Bad("that does not parse"),
        }
    }

    /// Adds what a record tells that is new.
    pub(super) fn add(&mut self, record: Record, topics: &mut Topics, scanned: &mut Scanned) {
        match record {
            Record::Schema { header, data } => {
                self.held_bytes += (header.name.len() + header.encoding.len() + data.len()) as u64;
                let info =
                    SchemaInfo { name: header.name, encoding: header.encoding, data: data.into_owned() };
                self.schemas.insert(header.id, info);
            }
            Record::Channel(channel) => {
                self.channels.insert(channel.id);
                self.held_bytes += (channel.topic.len() + channel.message_encoding.len()) as u64;
                let info = ChannelInfo {
                    topic: &channel.topic,
                    message_encoding: &channel.message_encoding,
                    schema_id: channel.schema_id,
                    schema: self.schemas.get(&channel.schema_id),
                };
                topics.channel(channel.id, &info);
            }
            Record::Header(header) => (scanned.profile, scanned.library) = (header.profile, header.library),
            Record::Statistics(statistics) => scanned.claimed_messages = Some(statistics.message_count),
            _ => {}
        }
    }

    /// Adds a record of the summary section, except a channel whose schema is not repeated there.
    pub(super) fn add_ahead(&mut self, record: Record, topics: &mut Topics, scanned: &mut Scanned) {
        let is_complete = match &record {
            Record::Channel(channel) => {
                channel.schema_id == 0 || self.schemas.contains_key(&channel.schema_id)
            }
            _ => true,
        };
        if is_complete {
            self.add(record, topics, scanned);
        }
    }

    /// Bytes of the names and schemas that it keeps.
    pub(super) fn held_bytes(&self) -> u64 {
        self.held_bytes
    }

    pub(super) fn schema_count(&self) -> u64 {
        self.schemas.len() as u64
    }

    pub(super) fn channel_count(&self) -> u64 {
        self.channels.len() as u64
    }
}
