//! Whole chunks in memory, several at once, to what each of them gives a sink by itself.

use super::catalog::Catalog;
use super::chunk::{ChunkEnd, Chunks};
use super::scan::RECORD_HEADER_BYTES;
use super::scanned::{Counts, Sink};
use mcap::records::op;
use rayon::prelude::*;

/// A larger chunk is unpacked as it is read, by itself.
const LARGEST_BYTES: u64 = 16 << 20;
/// What one chunk of a wave may unpack to: beyond it is unpacked again in turn, where the file's own limits hold.
const MOST_UNPACKED_BYTES: u64 = 64 << 20;

/// A chunk as it stands in the file.
pub(super) struct Packed {
    /// Where its record begins.
    pub start: u64,
    /// Its body.
    pub body: Vec<u8>,
}

/// What a chunk gave that holds nothing but messages of known channels, and is sound.
pub(super) struct Unpacked<Part> {
    pub part: Part,
    pub counts: Counts,
    pub bytes: u64,
    pub compression: String,
}

/// Chunks that wait for one another, and the decompressors.
pub(super) struct Wave {
    waiting: Vec<Packed>,
    held_bytes: u64,
    readers: Vec<Chunks>,
    spare: Vec<Vec<u8>>,
}

impl Wave {
    /// With a decompressor by `reader` for each thread: what more of them would even out costs less than the memory that they take.
    pub(super) fn new(reader: impl Fn() -> Chunks) -> Self {
        let readers = (0..rayon::current_num_threads()).map(|_| reader()).collect();
        Self { waiting: Vec::new(), held_bytes: 0, readers, spare: Vec::new() }
    }

    /// Whether a chunk of so many bytes may wait for others.
    pub(super) fn takes(bytes: u64) -> bool {
        bytes <= LARGEST_BYTES
    }

    /// Memory for a chunk's body, used before where that can be.
    pub(super) fn buffer(&mut self) -> Vec<u8> {
        self.spare.pop().unwrap_or_default()
    }

    /// Adds a chunk.
    pub(super) fn push(&mut self, chunk: Packed) {
        self.held_bytes += chunk.body.len() as u64;
        self.waiting.push(chunk);
    }

    /// Whether as many wait as are worth to be unpacked together.
    pub(super) fn is_full(&self) -> bool {
        self.waiting.len() >= self.readers.len() || self.held_bytes >= LARGEST_BYTES
    }

    /// Unpacks what waits, and hands it over in order; a chunk that must be taken in turn comes without a part.
    pub(super) fn unpack<S: Sink>(
        &mut self,
        catalog: &Catalog,
        sink: &S,
    ) -> Vec<(Packed, Option<Unpacked<S::Part>>)> {
        self.held_bytes = 0;
        let waiting = std::mem::take(&mut self.waiting);
        let pairs = waiting.into_par_iter().zip(&mut self.readers);
        pairs
            .map(|(packed, reader)| {
                let unpacked = unpacked(&packed.body, reader, catalog, sink);
                (packed, unpacked)
            })
            .collect()
    }

    /// Takes a body's memory back.
    pub(super) fn reuse(&mut self, packed: Packed) {
        let mut body = packed.body;
        body.clear();
        self.spare.push(body);
    }
}

fn unpacked<S: Sink>(
    body: &[u8],
    reader: &mut Chunks,
    catalog: &Catalog,
    sink: &S,
) -> Option<Unpacked<S::Part>> {
    let mut part = sink.part()?;
    let (mut counts, mut bytes) = (Counts::default(), 0);
    counts.add(op::CHUNK);
    let length = body.len() as u64;
    let mut rest = body;
    let end = reader.read(&mut rest, length, length, &mut |opcode, record| {
        bytes += RECORD_HEADER_BYTES + record.len() as u64;
        counts.add(opcode);
        bytes <= MOST_UNPACKED_BYTES && catalog.take_into(opcode, record, sink, &mut part)
    });
    match end {
        Ok(ChunkEnd::Whole { compression }) => Some(Unpacked { part, counts, bytes, compression }),
        _ => None,
    }
}
