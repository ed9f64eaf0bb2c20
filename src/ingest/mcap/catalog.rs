//! Records to the schemas and channels of a file, and to messages of known channels.

use super::scan::parse;
use super::scanned::{ChannelInfo, Scanned, SchemaInfo, Sink};
use mcap::records::{Record, op};
use std::collections::{HashMap, HashSet};

/// The schemas and channels met so far; the first of an id stands.
#[derive(Debug, Default)]
pub(super) struct Catalog {
    schemas: HashMap<u16, SchemaInfo>,
    channels: HashSet<u16>,
    held_bytes: u64,
}

impl Catalog {
    /// Takes a record and hands it on; `false` where its body does not parse.
    pub(super) fn take(
        &mut self,
        opcode: u8,
        body: &[u8],
        sink: &mut impl Sink,
        scanned: &mut Scanned,
    ) -> bool {
        if !matches!(opcode, op::HEADER | op::SCHEMA | op::CHANNEL | op::MESSAGE | op::STATISTICS) {
            return true;
        }
        match parse(opcode, body) {
            Some(Record::Message { header, data }) if self.channels.contains(&header.channel_id) => {
                let log_time_ns = i64::try_from(header.log_time).unwrap_or(i64::MAX);
                sink.message(header.channel_id, log_time_ns, &data);
                true
            }
            Some(Record::Schema { header, data }) => {
                if !self.schemas.contains_key(&header.id) {
                    self.held_bytes += body.len() as u64;
                }
                self.schemas.entry(header.id).or_insert_with(|| SchemaInfo {
                    name: header.name,
                    encoding: header.encoding,
                    data: data.into_owned(),
                });
                true
            }
            Some(Record::Channel(channel)) => {
                if self.channels.insert(channel.id) {
                    self.held_bytes += body.len() as u64;
                    let info = ChannelInfo {
                        topic: &channel.topic,
                        message_encoding: &channel.message_encoding,
                        schema_id: channel.schema_id,
                        schema: self.schemas.get(&channel.schema_id),
                    };
                    sink.channel(channel.id, &info);
                }
                true
            }
            Some(Record::Header(header)) => {
                (scanned.profile, scanned.library) = (header.profile, header.library);
                true
            }
            Some(Record::Statistics(statistics)) => {
                scanned.claimed_messages = Some(statistics.message_count);
                true
            }
            _ => false,
        }
    }

    /// Takes a record of the summary section, except a channel whose schema is not repeated there.
    pub(super) fn take_ahead(
        &mut self,
        opcode: u8,
        body: &[u8],
        sink: &mut impl Sink,
        scanned: &mut Scanned,
    ) {
        let is_complete = match parse(opcode, body) {
            Some(Record::Channel(channel)) => {
                channel.schema_id == 0 || self.schemas.contains_key(&channel.schema_id)
            }
            _ => true,
        };
        if is_complete {
            self.take(opcode, body, sink, scanned);
        }
    }

    /// Takes a record of a chunk into a part; `false` where [`Catalog::take`] would do more with it than hand on a message.
    pub(super) fn take_into<S: Sink>(&self, opcode: u8, body: &[u8], sink: &S, part: &mut S::Part) -> bool {
        match (opcode, parse(opcode, body)) {
            (op::MESSAGE, Some(Record::Message { header, data })) => {
                let is_known = self.channels.contains(&header.channel_id);
                if is_known {
                    let log_time_ns = i64::try_from(header.log_time).unwrap_or(i64::MAX);
                    sink.message_into(part, header.channel_id, log_time_ns, &data);
                }
                is_known
            }
            (op::SCHEMA, Some(Record::Schema { header, .. })) => self.schemas.contains_key(&header.id),
            (op::CHANNEL, Some(Record::Channel(channel))) => self.channels.contains(&channel.id),
            (op::HEADER | op::STATISTICS | op::MESSAGE | op::SCHEMA | op::CHANNEL, _) => false,
            _ => true,
        }
    }

    /// Bytes of the records that it keeps.
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
