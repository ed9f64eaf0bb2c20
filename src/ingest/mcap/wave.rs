//! Whole chunks in memory, several at once, to what each of them gives by itself.

use super::catalog::{Catalog, Sorted};
use super::chunk::{ChunkEnd, Chunks};
use super::scanned::Counts;
use super::topic::Part;
use super::topics::Topics;
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
pub(super) struct Unpacked {
    pub part: Part,
    pub counts: Counts,
    pub compression: Option<String>,
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
    pub(super) fn unpack(&mut self, catalog: &Catalog, topics: &Topics) -> Vec<(Packed, Option<Unpacked>)> {
        self.held_bytes = 0;
        let waiting = std::mem::take(&mut self.waiting);
        let pairs = waiting.into_par_iter().zip(&mut self.readers);
        pairs
            .map(|(packed, reader)| {
                let unpacked = unpacked(&packed.body, reader, catalog, topics);
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

fn unpacked(mut body: &[u8], reader: &mut Chunks, catalog: &Catalog, topics: &Topics) -> Option<Unpacked> {
    let (mut part, mut counts) = (topics.part(), Counts { chunks: 1, ..Counts::default() });
    let length = body.len() as u64;
    let end = reader.read(&mut body, length, length, &mut |opcode, record| {
        counts.add_unpacked(opcode, record);
        counts.unpacked_bytes <= MOST_UNPACKED_BYTES
            && match catalog.sorted(opcode, record) {
                Sorted::Message(message) => topics.take(&mut part, &message),
                Sorted::Nothing => true,
                Sorted::New(_) | Sorted::Bad(_) => false,
            }
    });
    let end = end.ok().filter(|end| matches!(end.how, ChunkEnd::Whole))?;
    Some(Unpacked { part, counts, compression: end.compression })
}
