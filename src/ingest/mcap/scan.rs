//! An MCAP file to its schemas, channels and messages, in the order of the file, whole or not.

use super::catalog::Catalog;
use super::chunk::{ChunkEnd, Chunks};
use super::claims;
use super::scanned::{Counts, Loss, Scanned, Sink};
use super::summary::{self, Summary};
use super::wave::{Packed, Unpacked, Wave};
use crate::ingest::error::{self, IngestError};
use crate::ingest::{Limits, Progress};
use mcap::records::{Record, op};
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

/// A record begins with its opcode (1 byte) and its length (8 bytes).
pub(super) const RECORD_HEADER_BYTES: u64 = 9;
/// The same, as the length of a buffer.
pub(super) const RECORD_HEADER_LENGTH: usize = 9;
/// Larger than most chunks' share between two looks at the progress; smaller than any cache.
const READ_BUFFER_BYTES: usize = 1 << 18;

/// Reads the file at `path` from start to end and hands over what stands in it; memory stays at one record or chunk.
///
/// # Errors
/// Only where the file cannot be read at all, or passes a limit; damage and truncation are in the answer.
pub(super) fn scan(
    path: &Path,
    limits: Limits,
    sink: &mut impl Sink,
    progress: Progress,
) -> Result<Scanned, IngestError> {
    let file = File::open(path).map_err(|source| error::io(path, source))?;
    let length = file.metadata().map_err(|source| error::io(path, source))?.len();
    let scanned = scan_in(file, length, limits, sink, progress).map_err(|source| error::io(path, source))?;
    match scanned.over {
        Some((what, limit_bytes)) => Err(limits.refusal(path, what, limit_bytes)),
        None => Ok(scanned),
    }
}

/// The same of a source of `length` bytes.
pub(super) fn scan_in(
    mut file: impl Read + Seek,
    length: u64,
    limits: Limits,
    sink: &mut impl Sink,
    progress: Progress,
) -> std::io::Result<Scanned> {
    let (part, unpacked) = (limits.part_bytes(), limits.unpacked_bytes(length));
    let claims = claims::read(&mut file, length)?;
    let over = [
        ("one of its chunks claims to unpack to", claims.largest_bytes, part),
        ("its chunks claim to unpack to", claims.all_bytes, unpacked),
    ];
    if let Some((what, _, limit)) = over.into_iter().find(|(_, claimed, limit)| claimed > limit) {
        return Ok(Scanned { over: Some((what, limit)), ..Scanned::default() });
    }
    let summary = summary::read(&mut file, length, part)?;
    let chunks = || Chunks::new(part.min(unpacked));
    let mut walk = Walk {
        file: BufReader::with_capacity(READ_BUFFER_BYTES, file),
        at: mcap::MAGIC.len() as u64,
        taken: Taken {
            length,
            limits,
            unpacked_bytes: 0,
            chunks: chunks(),
            catalog: Catalog::default(),
            scanned: Scanned::default(),
        },
        wave: Wave::new(chunks),
        summary,
        body: Vec::new(),
    };
    walk.register_summary(sink);
    walk.run(sink, progress)?;
    Ok(walk.finish())
}

/// Where the walk through the file stands.
struct Walk<File> {
    file: BufReader<File>,
    at: u64,
    taken: Taken,
    /// Chunks that were read and not yet taken.
    wave: Wave,
    summary: Option<Summary>,
    /// Re-used for the record at hand.
    body: Vec<u8>,
}

/// What was taken from the file, in its order.
struct Taken {
    length: u64,
    limits: Limits,
    /// Bytes that the chunks have unpacked to.
    unpacked_bytes: u64,
    chunks: Chunks,
    catalog: Catalog,
    scanned: Scanned,
}

/// Whether the walk goes on after a record.
#[derive(PartialEq)]
enum Next {
    Go,
    Stop,
}

impl<File: Read + Seek> Walk<File> {
    fn register_summary(&mut self, sink: &mut impl Sink) {
        let records =
            self.summary.as_mut().map(|summary| std::mem::take(&mut summary.records)).unwrap_or_default();
        for (opcode, body) in &records {
            self.taken.catalog.take_ahead(*opcode, body, sink, &mut self.taken.scanned);
        }
    }

    fn run(&mut self, sink: &mut impl Sink, progress: Progress) -> std::io::Result<()> {
        self.file.seek_relative(self.at.cast_signed())?;
        let mut said_at = 0;
        loop {
            if self.record(sink)? == Next::Stop {
                return self.settle(sink);
            }
            if self.taken.scanned.over.is_none() {
                self.taken.scanned.over = self.taken.passed_limit(sink);
            }
            if self.taken.scanned.over.is_some() {
                return Ok(());
            }
            if self.at - said_at >= READ_BUFFER_BYTES as u64 {
                said_at = self.at;
                #[allow(clippy::cast_precision_loss, reason = "a fraction for a progress bar")]
                progress(self.at as f64 / self.taken.length as f64);
            }
        }
    }

    /// One record at the file's level.
    fn record(&mut self, sink: &mut impl Sink) -> std::io::Result<Next> {
        let left = self.taken.length.saturating_sub(self.at);
        if left < RECORD_HEADER_BYTES {
            self.settle(sink)?;
            self.taken.scanned.losses.push(Loss::EndsEarly { at: self.at, bytes: left, inside: None });
            return Ok(Next::Stop);
        }
        let mut header = [0; RECORD_HEADER_LENGTH];
        self.file.read_exact(&mut header)?;
        let [opcode, length @ ..] = header;
        let claimed = u64::from_le_bytes(length);
        let available = left - RECORD_HEADER_BYTES;
        if opcode == op::CHUNK && claimed <= available && Wave::takes(claimed) {
            return self.waiting_chunk(claimed, sink);
        }
        let is_known = (op::HEADER..=op::DATA_END).contains(&opcode);
        let is_passed_over = is_known && opcode != op::CHUNK && !is_read(opcode) && claimed <= available;
        if !is_passed_over {
            self.settle(sink)?;
        }
        if opcode == 0 || (claimed > available && (!is_known || self.summary.is_some())) {
            return self.resume_after_garbage();
        }
        if opcode == op::CHUNK {
            return self.chunk(claimed, available, sink);
        }
        if claimed > available {
            self.taken.scanned.losses.push(Loss::EndsEarly {
                at: self.at,
                bytes: left,
                inside: Some(opcode),
            });
            return Ok(Next::Stop);
        }
        self.whole_record(opcode, claimed, sink)
    }

    /// A record other than a chunk that lies wholly in the file.
    fn whole_record(&mut self, opcode: u8, length: u64, sink: &mut impl Sink) -> std::io::Result<Next> {
        let start = self.at;
        self.at += RECORD_HEADER_BYTES + length;
        self.taken.scanned.counts.add(opcode);
        if !is_read(opcode) {
            self.file.seek_relative(length.cast_signed())?;
            return Ok(Next::Go);
        }
        if length > self.taken.limits.part_bytes() {
            self.taken.scanned.over = Some(("one of its messages takes", self.taken.limits.part_bytes()));
            return Ok(Next::Stop);
        }
        self.body.clear();
        (&mut self.file).take(length).read_to_end(&mut self.body)?;
        if opcode == op::FOOTER {
            return self.end_magic();
        }
        if !self.taken.catalog.take(opcode, &self.body, sink, &mut self.taken.scanned) {
            self.taken.scanned.losses.push(Loss::BadRecord { at: start, opcode });
        }
        Ok(Next::Go)
    }

    /// A chunk that waits until there are enough to be unpacked beside one another.
    fn waiting_chunk(&mut self, length: u64, sink: &mut impl Sink) -> std::io::Result<Next> {
        let mut body = self.wave.buffer();
        (&mut self.file).take(length).read_to_end(&mut body)?;
        self.wave.push(Packed { start: self.at, body });
        self.at += RECORD_HEADER_BYTES + length;
        if self.wave.is_full() {
            self.settle(sink)?;
        }
        Ok(Next::Go)
    }

    /// Takes the chunks that wait.
    fn settle(&mut self, sink: &mut impl Sink) -> std::io::Result<()> {
        for (packed, unpacked) in self.wave.unpack(&self.taken.catalog, sink) {
            if self.taken.scanned.over.is_none() {
                self.taken.waited(&packed, unpacked, sink)?;
            }
            self.wave.reuse(packed);
        }
        Ok(())
    }

    /// A chunk that is unpacked as it is read.
    fn chunk(&mut self, claimed: u64, available: u64, sink: &mut impl Sink) -> std::io::Result<Next> {
        let start = self.at;
        self.at = start + RECORD_HEADER_BYTES + claimed.min(available);
        self.taken.chunk(&mut self.file, start, (claimed, available), sink)
    }

    /// After bytes that are no record: the next chunk that the summary's index names, else the end.
    fn resume_after_garbage(&mut self) -> std::io::Result<Next> {
        let at = self.at;
        let next = self.summary.as_ref().and_then(|summary| summary.next_chunk(at));
        let to = next.unwrap_or(self.taken.length);
        self.taken.scanned.losses.push(Loss::Garbage { at, bytes: to - at, resumed: next.is_some() });
        if next.is_none() {
            return Ok(Next::Stop);
        }
        self.file.seek_relative((to - at).cast_signed() - RECORD_HEADER_BYTES.cast_signed())?;
        self.at = to;
        Ok(Next::Go)
    }

    fn end_magic(&mut self) -> std::io::Result<Next> {
        let mut magic = Vec::new();
        (&mut self.file).take(mcap::MAGIC.len() as u64).read_to_end(&mut magic)?;
        if magic != mcap::MAGIC {
            self.taken.scanned.losses.push(Loss::NoEndMagic { at: self.at });
        }
        self.taken.scanned.is_closed = true;
        Ok(Next::Stop)
    }

    fn finish(mut self) -> Scanned {
        self.taken.scanned.counts.schemas = self.taken.catalog.schema_count();
        self.taken.scanned.counts.channels = self.taken.catalog.channel_count();
        self.taken.scanned
    }
}

impl Taken {
    /// The limit that what was read so far has passed: words and bytes.
    fn passed_limit(&self, sink: &impl Sink) -> Option<(&'static str, u64)> {
        let limits = self.limits;
        let passed = [
            ("the samples of the channels read take", sink.held_bytes(), limits.samples_bytes()),
            ("its schemas and topics take", self.catalog.held_bytes(), limits.part_bytes()),
            ("its chunks unpack to", self.unpacked_bytes, limits.unpacked_bytes(self.length)),
        ];
        passed.into_iter().find(|(_, bytes, limit)| bytes > limit).map(|(what, _, limit)| (what, limit))
    }

    /// What a chunk gave by itself, or the chunk once more where it must be taken in turn.
    fn waited<S: Sink>(
        &mut self,
        packed: &Packed,
        unpacked: Option<Unpacked<S::Part>>,
        sink: &mut S,
    ) -> std::io::Result<()> {
        let joined = unpacked.and_then(|Unpacked { part, counts, bytes, compression }| {
            sink.join(part).then_some((counts, bytes, compression))
        });
        if let Some((counts, bytes, compression)) = joined {
            self.scanned.counts += counts;
            self.unpacked_bytes += bytes;
            self.scanned.compressions.insert(compression);
        } else {
            let length = packed.body.len() as u64;
            self.chunk(&mut packed.body.as_slice(), packed.start, (length, length), sink)?;
        }
        if self.scanned.over.is_none() {
            self.scanned.over = self.passed_limit(sink);
        }
        Ok(())
    }

    /// The chunk whose record begins at `start`, from a source that stands at its body.
    fn chunk(
        &mut self,
        source: &mut impl Read,
        start: u64,
        (claimed, available): (u64, u64),
        sink: &mut impl Sink,
    ) -> std::io::Result<Next> {
        let before = self.scanned.counts;
        sink.chunk_begins();
        let (mut messages, mut unpacked) = (0, self.unpacked_bytes);
        let (catalog, scanned, limits) = (&mut self.catalog, &mut self.scanned, self.limits);
        let most_unpacked = limits.unpacked_bytes(self.length);
        scanned.counts.add(op::CHUNK);
        let end = self.chunks.read(source, claimed, available, &mut |opcode, body| {
            unpacked += RECORD_HEADER_BYTES + body.len() as u64;
            scanned.counts.add(opcode);
            messages += u64::from(opcode == op::MESSAGE);
            if !catalog.take(opcode, body, sink, scanned) {
                scanned.losses.push(Loss::BadRecord { at: start, opcode });
            }
            unpacked <= most_unpacked && sink.held_bytes() <= limits.samples_bytes()
        })?;
        self.unpacked_bytes = unpacked;
        if let Some(compression) = end.compression() {
            scanned.compressions.insert(compression.to_owned());
        }
        match end {
            ChunkEnd::Whole { .. } | ChunkEnd::Stopped => Ok(Next::Go),
            ChunkEnd::TooLarge => {
                self.scanned.over = Some(("one of its messages takes", self.limits.part_bytes()));
                Ok(Next::Stop)
            }
            ChunkEnd::Cut { bytes, .. } => {
                self.scanned.losses.push(Loss::CutChunk {
                    at: start,
                    never_closed: claimed == u64::MAX,
                    bytes,
                    messages,
                });
                Ok(Next::Stop)
            }
            ChunkEnd::Bad { reason, span_ns, .. } => {
                sink.chunk_rejected();
                self.scanned.counts = Counts { chunks: before.chunks + 1, ..before };
                self.scanned.losses.push(Loss::BadChunk { at: start, reason, messages, span_ns });
                Ok(Next::Go)
            }
        }
    }
}

/// Whether the walk takes a record of this kind at the file's level.
fn is_read(opcode: u8) -> bool {
    matches!(opcode, op::HEADER | op::SCHEMA | op::CHANNEL | op::MESSAGE | op::STATISTICS | op::FOOTER)
}

/// A record's parsed form, `None` where its body does not parse.
pub(super) fn parse(opcode: u8, body: &[u8]) -> Option<Record<'_>> {
    mcap::parse_record(opcode, body).ok()
}
