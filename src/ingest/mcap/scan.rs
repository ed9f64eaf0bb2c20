//! An MCAP file to its schemas, channels and messages, in the order of the file, whole or not.

use super::catalog::{Catalog, Sorted};
use super::chunk::{ChunkEnd, Chunks, RECORD_HEADER_BYTES, RECORD_HEADER_LENGTH};
use super::claims;
use super::scanned::{Counts, Loss, Scanned};
use super::summary::{self, Summary};
use super::topics::{Asked, Topics};
use super::wave::{Packed, Unpacked, Wave};
use crate::ingest::error::{self, IngestError};
use crate::ingest::{Limits, Progress};
use mcap::records::op;
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

/// Larger than most chunks' share between two looks at the progress; smaller than any cache.
const READ_BUFFER_BYTES: usize = 1 << 18;

/// Reads the file at `path` from start to end: how it is made, and what its messages gave of what is asked for.
///
/// # Errors
/// Only where the file cannot be read at all, or passes a limit; damage and truncation are in the answer.
pub(super) fn scan<'a>(
    path: &Path,
    limits: Limits,
    asked: Asked<'a>,
    progress: Progress,
) -> Result<(Scanned, Topics<'a>), IngestError> {
    let file = File::open(path).map_err(|source| error::io(path, source))?;
    let length = file.metadata().map_err(|source| error::io(path, source))?.len();
    let topics = Topics::new(asked, limits, length);
    let (scanned, topics) =
        scan_in(file, length, topics, progress).map_err(|source| error::io(path, source))?;
    match scanned.over {
        Some((what, limit_bytes)) => Err(limits.refusal(path, what, limit_bytes)),
        None => Ok((scanned, topics)),
    }
}

/// The same of a source of `length` bytes.
fn scan_in<'a>(
    mut file: impl Read + Seek,
    length: u64,
    topics: Topics<'a>,
    progress: Progress,
) -> std::io::Result<(Scanned, Topics<'a>)> {
    let limits = topics.limits;
    let (part, unpacked) = (limits.part_bytes(), limits.unpacked_bytes(length));
    let claims = claims::read(&mut file, length)?;
    let over = [
        ("one of its chunks claims to unpack to", claims.largest_bytes, part),
        ("its chunks claim to unpack to", claims.all_bytes, unpacked),
    ];
    if let Some((what, _, limit)) = over.into_iter().find(|(_, claimed, limit)| claimed > limit) {
        return Ok((Scanned { over: Some((what, limit)), ..Scanned::default() }, topics));
    }
    let summary = summary::read(&mut file, length, part)?;
    let chunks = || Chunks::new(part.min(unpacked));
    let mut walk = Walk {
        file: BufReader::with_capacity(READ_BUFFER_BYTES, file),
        at: mcap::MAGIC.len() as u64,
        taken: Taken {
            length,
            limits,
            chunks: chunks(),
            catalog: Catalog::default(),
            scanned: Scanned::default(),
            topics,
        },
        wave: Wave::new(chunks),
        summary,
        body: Vec::new(),
    };
    walk.register_summary();
    walk.run(progress)?;
    Ok(walk.finish())
}

/// Where the walk through the file stands.
struct Walk<'a, File> {
    file: BufReader<File>,
    at: u64,
    taken: Taken<'a>,
    /// Chunks that were read and not yet taken.
    wave: Wave,
    summary: Option<Summary>,
    /// Re-used for the record at hand.
    body: Vec<u8>,
}

/// What was taken from the file, in its order.
struct Taken<'a> {
    length: u64,
    limits: Limits,
    chunks: Chunks,
    catalog: Catalog,
    scanned: Scanned,
    topics: Topics<'a>,
}

/// Whether the walk goes on after a record.
#[derive(PartialEq)]
enum Next {
    Go,
    Stop,
}

impl<'a, File: Read + Seek> Walk<'a, File> {
    fn register_summary(&mut self) {
        let Taken { catalog, scanned, topics, .. } = &mut self.taken;
        for (opcode, body) in self.summary.as_ref().map_or(&[][..], |summary| &summary.records) {
            if let Sorted::New(record) = catalog.sorted(*opcode, body) {
                catalog.add_ahead(record, topics, scanned);
            }
        }
    }

    fn run(&mut self, progress: Progress) -> std::io::Result<()> {
        self.file.seek_relative(self.at.cast_signed())?;
        let mut said_at = 0;
        loop {
            if self.record()? == Next::Stop {
                return self.settle();
            }
            if self.taken.scanned.over.is_none() {
                self.taken.scanned.over = self.taken.passed_limit();
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
    fn record(&mut self) -> std::io::Result<Next> {
        let left = self.taken.length.saturating_sub(self.at);
        if left < RECORD_HEADER_BYTES {
            self.settle()?;
            self.taken.scanned.losses.push(Loss::EndsEarly { at: self.at, bytes: left, inside: None });
            return Ok(Next::Stop);
        }
        let mut header = [0; RECORD_HEADER_LENGTH];
        self.file.read_exact(&mut header)?;
        let [opcode, length @ ..] = header;
        let claimed = u64::from_le_bytes(length);
        let available = left - RECORD_HEADER_BYTES;
        if opcode == op::CHUNK && claimed <= available && Wave::takes(claimed) {
            return self.waiting_chunk(claimed);
        }
        let is_known = (op::HEADER..=op::DATA_END).contains(&opcode);
        let is_passed_over = is_known && opcode != op::CHUNK && !is_read(opcode) && claimed <= available;
        if !is_passed_over {
            self.settle()?;
        }
        if opcode == 0 || (claimed > available && (!is_known || self.summary.is_some())) {
            return self.resume_after_garbage();
        }
        if opcode == op::CHUNK {
            return self.chunk(claimed, available);
        }
        if claimed > available {
            self.taken.scanned.losses.push(Loss::EndsEarly {
                at: self.at,
                bytes: left,
                inside: Some(opcode),
            });
            return Ok(Next::Stop);
        }
        self.whole_record(opcode, claimed)
    }

    /// A record other than a chunk that lies wholly in the file.
    fn whole_record(&mut self, opcode: u8, length: u64) -> std::io::Result<Next> {
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
        let Taken { catalog, scanned, topics, .. } = &mut self.taken;
        match catalog.sorted(opcode, &self.body) {
            Sorted::Message(message) => topics.take_alone(&message),
            Sorted::New(record) => catalog.add(record, topics, scanned),
            Sorted::Nothing => {}
            Sorted::Bad(why) => scanned.losses.push(Loss::BadRecord { at: start, opcode, why }),
        }
        Ok(Next::Go)
    }

    /// A chunk that waits until there are enough to be unpacked beside one another.
    fn waiting_chunk(&mut self, length: u64) -> std::io::Result<Next> {
        let mut body = self.wave.buffer();
        (&mut self.file).take(length).read_to_end(&mut body)?;
        self.wave.push(Packed { start: self.at, body });
        self.at += RECORD_HEADER_BYTES + length;
        if self.wave.is_full() {
            self.settle()?;
        }
        Ok(Next::Go)
    }

    /// Takes the chunks that wait.
    fn settle(&mut self) -> std::io::Result<()> {
        for (packed, unpacked) in self.wave.unpack(&self.taken.catalog, &self.taken.topics) {
            if self.taken.scanned.over.is_none() {
                self.taken.waited(&packed, unpacked)?;
            }
            self.wave.reuse(packed);
        }
        Ok(())
    }

    /// A chunk that is unpacked as it is read.
    fn chunk(&mut self, claimed: u64, available: u64) -> std::io::Result<Next> {
        let start = self.at;
        self.at = start + RECORD_HEADER_BYTES + claimed.min(available);
        self.taken.chunk(&mut self.file, start, claimed, available)
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

    fn finish(self) -> (Scanned, Topics<'a>) {
        let Taken { catalog, mut scanned, topics, .. } = self.taken;
        scanned.counts.schemas = catalog.schema_count();
        scanned.counts.channels = catalog.channel_count();
        (scanned, topics)
    }
}

impl Taken<'_> {
    /// The limit that what was read so far has passed: words and bytes.
    fn passed_limit(&self) -> Option<(&'static str, u64)> {
        let limits = self.limits;
        let unpacked = self.scanned.counts.unpacked_bytes;
        let passed = [
            ("the samples of the channels read take", self.topics.held_bytes(), limits.samples_bytes()),
            ("its schemas and topics take", self.catalog.held_bytes(), limits.part_bytes()),
            ("its chunks unpack to", unpacked, limits.unpacked_bytes(self.length)),
        ];
        passed.into_iter().find(|(_, bytes, limit)| bytes > limit).map(|(what, _, limit)| (what, limit))
    }

    /// What a chunk gave by itself, or the chunk once more where it must be taken in turn.
    fn waited(&mut self, packed: &Packed, unpacked: Option<Unpacked>) -> std::io::Result<()> {
        if let Some(Unpacked { part, counts, compression }) = unpacked {
            self.topics.join(part);
            self.scanned.counts += counts;
            self.scanned.compressions.extend(compression);
        } else {
            let length = packed.body.len() as u64;
            self.chunk(&mut packed.body.as_slice(), packed.start, length, length)?;
        }
        if self.scanned.over.is_none() {
            self.scanned.over = self.passed_limit();
        }
        Ok(())
    }

    /// The chunk whose record begins at `start`, from a source that stands at its body.
    fn chunk(
        &mut self,
        source: &mut impl Read,
        start: u64,
        claimed: u64,
        available: u64,
    ) -> std::io::Result<Next> {
        let mut counts = Counts { chunks: 1, ..Counts::default() };
        let Self { catalog, scanned, topics, limits, .. } = self;
        let most_unpacked = limits.unpacked_bytes(self.length).saturating_sub(scanned.counts.unpacked_bytes);
        let most_held = limits.samples_bytes().saturating_sub(topics.held_bytes());
        let mut part = topics.part();
        let end = self.chunks.read(source, claimed, available, &mut |opcode, body| {
            counts.add_unpacked(opcode, body);
            match catalog.sorted(opcode, body) {
                Sorted::Message(message) => topics.take_in_turn(&mut part, &message),
                Sorted::New(record) => catalog.add(record, topics, scanned),
                Sorted::Nothing => {}
                Sorted::Bad(why) => scanned.losses.push(Loss::BadRecord { at: start, opcode, why }),
            }
            counts.unpacked_bytes <= most_unpacked && part.held_bytes <= most_held
        })?;
        scanned.compressions.extend(end.compression);
        let messages = counts.messages;
        if let ChunkEnd::Bad { reason, span_ns } = end.how {
            let Counts { chunks, unpacked_bytes, .. } = counts;
            scanned.counts += Counts { chunks, unpacked_bytes, ..Counts::default() };
            scanned.losses.push(Loss::BadChunk { at: start, reason, messages, span_ns });
            return Ok(Next::Go);
        }
        topics.join(part);
        scanned.counts += counts;
        match end.how {
            ChunkEnd::TooLarge => {
                scanned.over = Some(("one of its messages takes", limits.part_bytes()));
                Ok(Next::Stop)
            }
            ChunkEnd::Cut { bytes } => {
                let never_closed = claimed == u64::MAX;
                scanned.losses.push(Loss::CutChunk { at: start, never_closed, bytes, messages });
                Ok(Next::Stop)
            }
            _ => Ok(Next::Go),
        }
    }
}

/// Whether the walk takes a record of this kind at the file's level.
fn is_read(opcode: u8) -> bool {
    matches!(opcode, op::HEADER | op::SCHEMA | op::CHANNEL | op::MESSAGE | op::STATISTICS | op::FOOTER)
}
