//! An MCAP file to what its messages give, in the order of the file, whole or not: chunks are unpacked
//! several at once.

use super::chunk::{Chunk, ChunkFault};
use super::records::RECORD_HEADER_BYTES;
use super::scanned::{Scanned, record_name};
use super::summary::{self, Summary, Summed};
use super::topic::{Part, TopicSeries};
use super::topics::Topics;
use crate::data::{CaskFile, FileEnd, McapFinding};
use crate::ingest::ReadRequest;
use crate::ingest::error::{self, IngestError};
use crate::ingest::factors;
use mcap::records::{Record, op};
use rayon::prelude::*;
use std::io::{BufReader, Read};
use std::ops::ControlFlow::{self, Break, Continue};

/// Larger than most chunks' share between two looks at the progress; smaller than any cache.
const READ_BUFFER_BYTES: usize = 1 << 18;
/// At most so many packed bytes are unpacked as one batch of chunks.
const MOST_PACKED_BYTES: u64 = 16 << 20;
/// The chunks of a batch unpack to at most so many bytes, by their own word; a larger chunk is a batch by
/// itself.
const MOST_UNPACKED_BYTES: u64 = 64 << 20;

/// A longer metadata record holds files, not what a sensor's samples are multiplied by.
const MOST_METADATA_BYTES: u64 = 1 << 16;

/// A walk through a file: where it stands, and what it found.
pub(super) struct Walk<'a> {
    request: ReadRequest<'a>,
    file: BufReader<Summed>,
    length: u64,
    at: u64,
    summary: Option<Summary>,
    /// Chunks that were read and not yet taken.
    waiting: Vec<Chunk>,
    /// Chunks that were taken, for their memory.
    spare: Vec<Chunk>,
    /// What all chunks so far claim to unpack to.
    claimed_bytes: u64,
    /// Re-used for the record at hand.
    body: Vec<u8>,
    pub(super) scanned: Scanned,
    pub(super) topics: Topics<'a>,
    taken: Part,
}

impl<'a> Walk<'a> {
    /// Reads a file from start to end: how it is made, and what its messages gave of the fields that the
    /// channels of a cask file name; without one, for a listing, of every numeric field.
    ///
    /// # Errors
    /// Only where the file cannot be read at all, or passes a limit; damage and truncation are in the answer.
    pub(super) fn of(request: ReadRequest<'a>, asked: Option<&'a CaskFile>) -> Result<Self, IngestError> {
        let ReadRequest { file: recording, limits, .. } = request;
        let io = |source| error::io(recording.path, &source);
        let mut file = recording.opened().map_err(io)?;
        let length = recording.length().map_err(io)?;
        let summary = summary::read(&mut file, length, limits.part_bytes()).map_err(io)?;
        let topics = Topics::new(asked, limits, length);
        let mut walk = Self {
            request,
            file: BufReader::with_capacity(READ_BUFFER_BYTES, Summed::of(file, summary.as_ref())),
            length,
            at: mcap::MAGIC.len() as u64,
            summary,
            waiting: Vec::new(),
            spare: Vec::new(),
            claimed_bytes: 0,
            body: Vec::new(),
            scanned: Scanned::default(),
            taken: topics.part(1),
            topics,
        };
        walk.run()?;
        Ok(walk)
    }

    /// What each channel gave for each field, by topics in the order of the file.
    pub(super) fn finish(self) -> (Scanned, Vec<TopicSeries>) {
        (self.scanned, self.topics.finish(self.taken))
    }

    fn run(&mut self) -> Result<(), IngestError> {
        for (opcode, body) in self.summary.iter().flat_map(Summary::records) {
            // A record that does not parse here may do so where it stands in the data.
            let _ = self.topics.announce(opcode, body, true);
        }
        if self.summary.as_ref().is_some_and(|summary| summary.is_changed) {
            self.scanned.lose(McapFinding::SummaryChanged);
        }
        self.skip(self.at)?;
        let mut said_at = 0;
        while self.record()?.is_continue() {
            self.keep_within()?;
            if self.at - said_at >= READ_BUFFER_BYTES as u64 {
                said_at = self.at;
                #[allow(clippy::cast_precision_loss, reason = "a fraction for a progress bar")]
                (self.request.progress)(self.at as f64 / self.length as f64);
            }
        }
        // What was told by its place is in the sum as well.
        if self.file.get_ref().is_changed() && self.scanned.is_whole() {
            self.scanned.lose(McapFinding::DataChanged);
        }
        Ok(())
    }

    /// Leaves out so many bytes, which are read where they are summed up.
    fn skip(&mut self, bytes: u64) -> Result<(), IngestError> {
        let skipped = if self.file.get_ref().sum.is_some() {
            std::io::copy(&mut (&mut self.file).take(bytes), &mut std::io::sink()).map(|_| ())
        } else {
            self.file.seek_relative(bytes.cast_signed())
        };
        skipped.map_err(|source| self.io(&source))
    }

    fn io(&self, source: &std::io::Error) -> IngestError {
        error::io(self.request.file.path, source)
    }

    /// The next so many bytes, as far as they are there, in `body`.
    fn read(&mut self, bytes: u64) -> Result<(), IngestError> {
        self.body.clear();
        let read = (&mut self.file).take(bytes).read_to_end(&mut self.body);
        read.map(|_| ()).map_err(|source| self.io(&source))
    }

    /// Holds `what` to so many bytes.
    fn hold(&self, what: &str, bytes: u64, most: u64) -> Result<(), IngestError> {
        self.request.limits.hold(self.request.file.path, what, bytes, most)
    }

    /// Whether the walk stands behind the data: what looks like a message there is none.
    fn is_behind_data(&self) -> bool {
        let data_end = self.summary.as_ref().and_then(|summary| summary.data_end);
        data_end.is_some_and(|end| self.at > end.at)
    }

    /// Whether what was read so far stays within the limits.
    fn keep_within(&self) -> Result<(), IngestError> {
        let (Self { scanned, topics, taken, .. }, limits) = (self, self.request.limits);
        let unpacked = limits.unpacked_bytes(self.length);
        self.hold("the samples of the channels read take", taken.held_bytes, limits.samples_bytes())?;
        self.hold("its schemas and topics take", topics.held_bytes, limits.part_bytes())?;
        self.hold("its chunks claim to unpack to", self.claimed_bytes, unpacked)?;
        self.hold("its chunks unpack to", scanned.counts.unpacked_bytes, unpacked)
    }

    /// One record at the file's level.
    fn record(&mut self) -> Result<ControlFlow<()>, IngestError> {
        let (at, left) = (self.at, self.length.saturating_sub(self.at));
        if left < RECORD_HEADER_BYTES {
            self.settle()?;
            self.scanned.end(FileEnd::Early { at, bytes: left, inside: "record" });
            return Ok(Break(()));
        }
        let mut header = [0; 9];
        self.file.read_exact(&mut header).map_err(|source| self.io(&source))?;
        let [opcode, length @ ..] = header;
        let claimed = u64::from_le_bytes(length);
        let available = left - RECORD_HEADER_BYTES;
        let is_known = (op::HEADER..=op::DATA_END).contains(&opcode);
        if opcode == 0 || (claimed > available && (!is_known || self.summary.is_some())) {
            return self.resume_after_garbage();
        }
        if opcode == op::CHUNK && !self.is_behind_data() {
            return self.chunk(claimed, available);
        }
        if claimed > available {
            self.settle()?;
            let inside = record_name(opcode);
            self.scanned.end(FileEnd::Early { at, bytes: left, inside });
            return Ok(Break(()));
        }
        self.whole_record(opcode, claimed)
    }

    /// A record other than a chunk that lies wholly in the file.
    fn whole_record(&mut self, opcode: u8, length: u64) -> Result<ControlFlow<()>, IngestError> {
        let (start, is_behind_data) = (self.at, self.is_behind_data());
        self.at += RECORD_HEADER_BYTES + length;
        let is_short = opcode == op::METADATA && length <= MOST_METADATA_BYTES;
        let is_data = (is_short || matches!(opcode, op::HEADER | op::SCHEMA | op::CHANNEL | op::MESSAGE))
            && !is_behind_data;
        if !is_behind_data {
            self.scanned.counts.add(opcode);
        }
        if !is_data && !matches!(opcode, op::STATISTICS | op::FOOTER) {
            self.skip(length)?;
            return Ok(Continue(()));
        }
        self.settle()?;
        self.hold("one of its messages takes", length, self.request.limits.part_bytes())?;
        self.read(length)?;
        if opcode == op::FOOTER {
            return self.end_magic();
        }
        let Self { body, scanned, topics, taken, .. } = self;
        let outcome = match opcode {
            op::MESSAGE => {
                topics.look_at(body);
                topics.take(taken, body)
            }
            op::SCHEMA | op::CHANNEL => topics.announce(opcode, body, false),
            _ => match mcap::parse_record(opcode, body) {
                Ok(Record::Header(header)) => {
                    (scanned.profile, scanned.library) = (header.profile, header.library);
                    Ok(())
                }
                Ok(Record::Metadata(stated)) => {
                    scanned.factors.extend(factors::among(&stated.metadata));
                    scanned.factors.truncate(factors::MOST_METADATA);
                    Ok(())
                }
                Ok(Record::Statistics(statistics)) => {
                    scanned.claimed_messages = Some(statistics.message_count);
                    Ok(())
                }
                _ => Err("that does not parse"),
            },
        };
        if let Err(why) = outcome {
            scanned.lose_records(opcode, start, 1, why);
        }
        Ok(Continue(()))
    }

    /// A chunk, which waits until there are enough to be unpacked beside one another.
    fn chunk(&mut self, claimed: u64, available: u64) -> Result<ControlFlow<()>, IngestError> {
        let part_bytes = self.request.limits.part_bytes();
        self.hold("one of its chunks takes", claimed.min(available), part_bytes)?;
        let mut chunk = self
            .spare
            .pop()
            .unwrap_or_else(|| Chunk::new(self.topics.part(2 * rayon::current_num_threads())));
        (chunk.start, chunk.claimed) = (self.at, claimed);
        std::mem::swap(&mut self.body, &mut chunk.body);
        self.read(claimed.min(available))?;
        std::mem::swap(&mut self.body, &mut chunk.body);
        self.at += RECORD_HEADER_BYTES + claimed.min(available);
        chunk.begin();
        // The sum of all is for what has none of its own; Rust's writer leaves chunks without one out of it.
        if chunk.has_sum() || self.scanned.library.starts_with("mcap-rust") {
            self.file.get_mut().sum = None;
        }
        self.hold("one of its chunks claims to unpack to", chunk.claim(), part_bytes)?;
        self.claimed_bytes = self.claimed_bytes.saturating_add(chunk.claim());
        self.keep_within()?;
        let sum = |bytes: fn(&Chunk) -> u64| self.waiting.iter().chain([&chunk]).map(bytes).sum::<u64>();
        let is_last = chunk.fault == Some(ChunkFault::Cut);
        let is_beyond = sum(Chunk::claim) > MOST_UNPACKED_BYTES;
        let is_full = self.waiting.len() + 1 >= rayon::current_num_threads()
            || sum(|chunk| chunk.body.len() as u64) >= MOST_PACKED_BYTES;
        if is_beyond {
            self.settle()?;
        }
        self.waiting.push(chunk);
        if is_full || is_last {
            self.settle()?;
        }
        Ok(if is_last { Break(()) } else { Continue(()) })
    }

    /// Takes the chunks that wait: unpacks them, looks in turn at what they tell of channels, and takes their
    /// messages.
    fn settle(&mut self) -> Result<(), IngestError> {
        let Self { waiting, request: ReadRequest { limits, .. }, scanned, topics, taken, .. } = self;
        waiting.par_iter_mut().for_each(|chunk| chunk.unpack(limits.part_bytes()));
        for chunk in &*waiting {
            topics.meet(chunk, scanned);
        }
        let most_held = limits.samples_bytes().saturating_sub(taken.held_bytes);
        waiting.par_iter_mut().for_each(|chunk| take(chunk, topics, most_held));
        for mut chunk in std::mem::take(waiting) {
            self.join(&mut chunk);
            self.spare.push(chunk);
            self.keep_within()?;
        }
        Ok(())
    }

    /// Adds what a chunk gave, or that it was lost.
    fn join(&mut self, chunk: &mut Chunk) {
        let Self { scanned, taken, .. } = self;
        let &mut Chunk { start: at, claimed, counts, .. } = chunk;
        let compression = chunk.compression().map(|name| if name.is_empty() { "none" } else { name });
        scanned.compressions.extend(compression.map(str::to_owned));
        scanned.counts.add(op::CHUNK);
        let messages = counts.messages();
        match chunk.fault.take() {
            Some(ChunkFault::Bad(reason)) => {
                scanned.counts.unpacked_bytes += counts.unpacked_bytes;
                let lasts_s = chunk.lasts_s();
                scanned.lose(McapFinding::BadChunk { at, reason, messages, lasts_s });
                return;
            }
            Some(ChunkFault::Cut) => {
                let (never_closed, bytes) = (claimed == u64::MAX, chunk.packed_bytes() as u64);
                scanned.end(FileEnd::InChunk { at, never_closed, bytes, messages });
            }
            None => {}
        }
        scanned.counts.append(&counts);
        taken.append(&mut chunk.part);
        if let Some((count, why)) = chunk.unusable {
            scanned.lose_records(op::MESSAGE, at, count, why);
        }
    }

    /// After bytes that are no record: the next chunk that the summary's index names, else the end.
    fn resume_after_garbage(&mut self) -> Result<ControlFlow<()>, IngestError> {
        self.settle()?;
        let at = self.at;
        let next = self.summary.as_ref().and_then(|summary| summary.next_chunk(at));
        let to = next.unwrap_or(self.length);
        let resumed = next.is_some();
        self.scanned.lose(McapFinding::Garbage { at, bytes: to - at, resumed });
        if !resumed {
            return Ok(Break(()));
        }
        let ahead = (to - at).cast_signed() - RECORD_HEADER_BYTES.cast_signed();
        let sought = self.file.seek_relative(ahead);
        sought.map_err(|source| self.io(&source))?;
        self.at = to;
        Ok(Continue(()))
    }

    fn end_magic(&mut self) -> Result<ControlFlow<()>, IngestError> {
        self.read(mcap::MAGIC.len() as u64)?;
        if self.body != mcap::MAGIC {
            self.scanned.end(FileEnd::InMagic { at: self.at });
        }
        Ok(Break(()))
    }
}

/// Takes the messages of a chunk, as long as their samples take no more than `most_held` bytes.
fn take(chunk: &mut Chunk, topics: &Topics, most_held: u64) {
    if chunk.is_bad() {
        return;
    }
    let mut part = std::mem::take(&mut chunk.part);
    let (mut unusable, mut first) = (0, None);
    for (_, body) in chunk.records().filter(|(opcode, _)| *opcode == op::MESSAGE) {
        if let Err(why) = topics.take(&mut part, body) {
            unusable += 1;
            first.get_or_insert(why);
        }
        if part.held_bytes > most_held {
            break;
        }
    }
    chunk.part = part;
    chunk.unusable = first.map(|why| (unusable, why));
}
