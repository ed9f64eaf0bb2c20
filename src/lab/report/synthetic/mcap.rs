//! Writes a synthetic recording as MCAP: blocks `dropcheck.AccelerationBlock` in JSON or protobuf, stamped,
//! with their schema.

use super::SyntheticPlace;
use crate::lab::data::{SyntheticChannel, SyntheticRecording};
use crate::numerics::{as_count, as_f64, nanoseconds};
use crate::report::ReportError;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};
use prost_reflect::prost::encoding::{double, float, message, string};
use prost_reflect::prost_types::Timestamp;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Cursor;

/// The first sample of every synthetic recording: 9 October 2025, 08:53:20 UTC, so that the same scene gives
/// the same bytes.
const START_NS: i64 = 1_760_000_000_000_000_000;

/// Length of a block, s: the amount that a recorder passes on at a time.
const BLOCK_S: f64 = 0.02;

const SCHEMA: &str = "dropcheck.AccelerationBlock";

/// The descriptor set of the block message of docs/formats.md, with the well-known Timestamp that it uses.
const DESCRIPTORS: &[u8] = include_bytes!("acceleration_block.binpb");

/// Schema of the JSON messages.
const JSON_SCHEMA: &[u8] = include_bytes!("acceleration_block.json");

/// The file as bytes.
///
/// # Errors
///
/// [`ReportError::Mcap`] if the writer fails.
pub(super) fn bytes(
    recording: &SyntheticRecording,
    places: &[SyntheticPlace],
    is_json: bool,
) -> Result<Vec<u8>, ReportError> {
    let options = WriteOptions::new()
        .compression(Some(Compression::Zstd))
        .library(concat!("dropcheck ", env!("CARGO_PKG_VERSION")));
    let mut writer = options.create(Cursor::new(Vec::new()))?;
    let (encoding, name) = if is_json { ("jsonschema", "json") } else { ("protobuf", "protobuf") };
    let schema = writer.add_schema(SCHEMA, encoding, if is_json { JSON_SCHEMA } else { DESCRIPTORS })?;
    let mut messages = Vec::new();
    for (channel, place) in recording.channels.iter().zip(places) {
        let id = writer.add_channel(schema, &format!("/daq/{}", place.name), name, &BTreeMap::new())?;
        // A recorder passes a block on when it is complete.
        let log_ns = |block: &SyntheticBlock| {
            block.timestamp.ns() + nanoseconds(as_f64(block.samples.len()) / block.sample_rate_hz)
        };
        messages.extend(blocks(channel).into_iter().map(|block| (log_ns(&block), id, block)));
    }
    messages.sort_by_key(|(log_ns, id, _)| (*log_ns, *id));
    for (sequence, (log_ns, channel_id, block)) in messages.iter().enumerate() {
        let header = MessageHeader {
            channel_id: *channel_id,
            sequence: u32::try_from(sequence).unwrap_or(u32::MAX),
            log_time: u64::try_from(*log_ns).unwrap_or(0),
            publish_time: u64::try_from(block.timestamp.ns()).unwrap_or(0),
        };
        let data = if is_json { serde_json::to_vec(block)? } else { block.protobuf() };
        writer.write_to_known_channel(&header, &data)?;
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

/// Consecutive samples in the form of JSON.
#[derive(Serialize)]
struct SyntheticBlock<'a> {
    timestamp: BlockStamp,
    sample_rate_hz: f64,
    unit: &'a str,
    samples: &'a [f32],
}

#[derive(Serialize)]
struct BlockStamp {
    sec: i64,
    nsec: i64,
}

impl BlockStamp {
    fn from_ns(ns: i64) -> Self {
        Self { sec: ns.div_euclid(1_000_000_000), nsec: ns.rem_euclid(1_000_000_000) }
    }

    fn ns(&self) -> i64 {
        1_000_000_000 * self.sec + self.nsec
    }
}

/// The channel in blocks; no block continues across a loss.
fn blocks(channel: &SyntheticChannel) -> Vec<SyntheticBlock<'_>> {
    let longest = as_count(BLOCK_S * channel.sample_rate_hz).max(2);
    let block = |(from, samples)| SyntheticBlock {
        timestamp: BlockStamp::from_ns(START_NS + nanoseconds(channel.time_s(from))),
        sample_rate_hz: channel.sample_rate_hz,
        unit: &channel.unit,
        samples,
    };
    let parts = channel.runs().flat_map(|(from, run)| (from..).step_by(longest).zip(run.chunks(longest)));
    parts.map(block).collect()
}

impl SyntheticBlock<'_> {
    /// The block message on the wire, its fields numbered as in docs/formats.md.
    fn protobuf(&self) -> Vec<u8> {
        let BlockStamp { sec, nsec } = self.timestamp;
        let stamp = Timestamp { seconds: sec, nanos: i32::try_from(nsec).unwrap_or(0) };
        let mut data = Vec::with_capacity(4 * self.samples.len() + 64);
        message::encode(1, &stamp, &mut data);
        double::encode(2, &self.sample_rate_hz, &mut data);
        string::encode(3, &self.unit.to_owned(), &mut data);
        float::encode_packed(4, self.samples, &mut data);
        data
    }
}
