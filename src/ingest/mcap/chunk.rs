//! One chunk to the records in it: decompressed as it is read, its check sum tested, cut ones as far as they go.

use mcap::McapError;
use mcap::records::op;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::io::Read;

/// A record begins with its opcode (1 byte) and its length (8 bytes).
pub(super) const RECORD_HEADER_BYTES: u64 = 9;
/// The same, as the length of a buffer.
pub(super) const RECORD_HEADER_LENGTH: usize = 9;
/// Chunk header without its compression's name: times, uncompressed size, check sum, name length, compressed size.
const FIXED_HEADER_BYTES: u64 = 8 + 8 + 8 + 4 + 4 + 8;
/// The same, as the length of a buffer.
const FIXED_HEADER_LENGTH: usize = 40;
/// Longer than any name of a compression ("zstd", "lz4"); a longer one is damage.
const LONGEST_COMPRESSION_NAME_BYTES: u64 = 64;
/// zstd needs three bytes for a block, which unpacks to 128 KiB at most (RFC 8878): more is damage, not a claim.
const LARGEST_EXPANSION: u64 = (128 << 10) / 3 + 1;
/// So much is asked of the file at a time, whatever the record claims.
const STEP_BYTES: u64 = 1 << 20;

/// What a chunk was.
#[derive(Debug)]
pub(super) struct Ended {
    /// The compression that it names, where its header was read.
    pub(super) compression: Option<String>,
    pub(super) how: ChunkEnd,
}

/// How a chunk ended.
#[derive(Debug)]
pub(super) enum ChunkEnd {
    /// All of it was read and its check sum holds, or it has none.
    Whole,
    /// The file ends in it, after so many of its bytes.
    Cut { bytes: u64 },
    /// Whoever takes the records wants no more.
    Stopped,
    /// One of its records is larger than any may be.
    TooLarge,
    /// It does not decompress, or its check sum does not hold.
    Bad { reason: String, span_ns: (u64, u64) },
}

/// Reads chunks one after the other, with the decompressors' memory kept.
pub(super) struct Chunks {
    reader: LinearReader,
    record_limit: usize,
}

/// A chunk's header, as far as it is needed.
pub(super) struct Header {
    bytes: Vec<u8>,
    compression: String,
    span_ns: (u64, u64),
    /// What it claims to unpack to, bytes.
    pub(super) uncompressed: u64,
    compressed: u64,
}

impl Chunks {
    /// For records of at most `largest_record_bytes`.
    pub(super) fn new(largest_record_bytes: u64) -> Self {
        let record_limit = usize::try_from(largest_record_bytes).unwrap_or(usize::MAX);
        Self { reader: fresh(record_limit), record_limit }
    }

    /// Reads the chunk whose body begins at `file`, claims `claimed` bytes and has `available`; `take` gets each
    /// record and says whether it wants more.
    pub(super) fn read(
        &mut self,
        file: &mut impl Read,
        claimed: u64,
        available: u64,
        take: &mut dyn FnMut(u8, &[u8]) -> bool,
    ) -> std::io::Result<Ended> {
        let body = claimed.min(available);
        let is_cut = claimed > available;
        let Some(header) = header(file, body)? else {
            let how = if is_cut {
                ChunkEnd::Cut { bytes: body }
            } else {
                skip(file, body.saturating_sub(FIXED_HEADER_BYTES))?;
                ChunkEnd::Bad { reason: "its header makes no sense".into(), span_ns: (0, 0) }
            };
            return Ok(Ended { compression: None, how });
        };
        let bad = |reason| ChunkEnd::Bad { reason, span_ns: header.span_ns };
        let data = body - header.bytes.len() as u64;
        let how = if is_cut || header.is_possible(body) {
            // Bytes behind the compressed ones are padding: the reader never sees them, so no record can reach into them.
            let fed_bytes = data.min(header.compressed);
            let fed = self.feed(file, &header, fed_bytes, is_cut, take)?;
            skip(file, fed.left + (data - fed_bytes))?;
            if !fed.is_clean {
                self.reader = fresh(self.record_limit);
            }
            match fed.problem {
                None => ChunkEnd::Whole,
                Some(Problem::Stopped) => ChunkEnd::Stopped,
                Some(Problem::TooLarge) => ChunkEnd::TooLarge,
                Some(_) if is_cut => ChunkEnd::Cut { bytes: fed_bytes },
                Some(Problem::Damage(reason)) => bad(reason),
            }
        } else {
            skip(file, data)?;
            bad("its sizes contradict each other".into())
        };
        Ok(Ended { compression: Some(header.compression), how })
    }

    /// Feeds the chunk's `bytes`, its lengths set to what is there, to the reader.
    fn feed(
        &mut self,
        file: &mut impl Read,
        header: &Header,
        bytes: u64,
        is_cut: bool,
        take: &mut dyn FnMut(u8, &[u8]) -> bool,
    ) -> std::io::Result<Fed> {
        let mut prefix: &[u8] = &header.with_lengths(bytes, is_cut);
        let (mut left, mut yielded) = (bytes, 0_u64);
        let problem = loop {
            let wanted = match self.reader.next_event() {
                None => break None,
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => wanted as u64,
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    yielded += RECORD_HEADER_BYTES + data.len() as u64;
                    if !take(opcode, data) {
                        break Some(Problem::Stopped);
                    }
                    continue;
                }
                Some(Err(error)) => break Some(header.problem(&error)),
            };
            if prefix.is_empty() && left == 0 {
                let is_complete = !is_cut && yielded == header.uncompressed;
                if is_complete {
                    return Ok(Fed { left, is_clean: true, problem: None });
                }
                self.reader.notify_read(0);
                continue;
            }
            let step = if prefix.is_empty() {
                wanted.min(left).min(STEP_BYTES)
            } else {
                wanted.min(prefix.len() as u64)
            };
            let buffer = self.reader.insert(usize::try_from(step).unwrap_or(0));
            if prefix.is_empty() {
                file.read_exact(buffer)?;
                left -= step;
            } else {
                let (now, later) = prefix.split_at(buffer.len());
                buffer.copy_from_slice(now);
                prefix = later;
            }
            self.reader.notify_read(usize::try_from(step).unwrap_or(0));
        };
        let problem = problem.or_else(|| is_cut.then(|| Problem::Damage("it is cut".to_owned())));
        Ok(Fed { left, is_clean: false, problem })
    }
}

/// What became of a chunk's bytes.
struct Fed {
    /// Bytes of the chunk that the reader did not ask for.
    left: u64,
    /// Whether the reader stands at a record's boundary again.
    is_clean: bool,
    problem: Option<Problem>,
}

/// Why a chunk's records end before it does.
enum Problem {
    Stopped,
    TooLarge,
    Damage(String),
}

impl Header {
    /// Whether a chunk of `body` bytes can hold what it claims.
    pub(super) fn is_possible(&self, body: u64) -> bool {
        self.compressed <= body - self.bytes.len() as u64
            && self.uncompressed <= self.compressed.saturating_mul(LARGEST_EXPANSION)
    }

    /// A length that the chunk could hold is too large, any other is damage.
    fn problem(&self, error: &McapError) -> Problem {
        match error {
            McapError::RecordTooLarge { len, .. } if *len <= self.uncompressed => Problem::TooLarge,
            other => Problem::Damage(in_words(other)),
        }
    }

    /// A chunk record's beginning with its lengths set to the `data` bytes that are there.
    fn with_lengths(&self, data: u64, is_cut: bool) -> Vec<u8> {
        let mut bytes = vec![op::CHUNK];
        bytes.extend_from_slice(&(self.bytes.len() as u64 + data).to_le_bytes());
        bytes.extend_from_slice(&self.bytes);
        if is_cut {
            let at = bytes.len() - 8;
            bytes.splice(at.., data.to_le_bytes());
            // No check sum holds for a part; the uncompressed size is unknown.
            let sizes = RECORD_HEADER_LENGTH + 16;
            bytes.splice(sizes..sizes + 8, u64::MAX.to_le_bytes());
            bytes.splice(sizes + 8..sizes + 12, [0; 4]);
        }
        bytes
    }
}

/// The header at `file`, `None` where `body` bytes cannot hold it.
pub(super) fn header(file: &mut impl Read, body: u64) -> std::io::Result<Option<Header>> {
    if body < FIXED_HEADER_BYTES {
        skip(file, body)?;
        return Ok(None);
    }
    let mut bytes = vec![0; FIXED_HEADER_LENGTH];
    file.read_exact(&mut bytes)?;
    let name_bytes = u64::from(u32::from_le_bytes(bytes[28..32].try_into().unwrap_or_default()));
    if name_bytes > LONGEST_COMPRESSION_NAME_BYTES || FIXED_HEADER_BYTES + name_bytes > body {
        return Ok(None);
    }
    file.take(name_bytes).read_to_end(&mut bytes)?;
    let word =
        |at: usize| bytes.get(at..at + 8).and_then(|word| word.try_into().ok()).map_or(0, u64::from_le_bytes);
    let name_end = bytes.len() - 8;
    let compression = String::from_utf8_lossy(bytes.get(32..name_end).unwrap_or_default()).into_owned();
    let (span_ns, uncompressed, compressed) = ((word(0), word(8)), word(16), word(name_end));
    Ok(Some(Header { bytes, compression, span_ns, uncompressed, compressed }))
}

fn fresh(record_limit: usize) -> LinearReader {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(record_limit);
    LinearReader::new_with_options(options)
}

fn skip(file: &mut impl Read, bytes: u64) -> std::io::Result<()> {
    std::io::copy(&mut file.take(bytes), &mut std::io::sink()).map(|_| ())
}

fn in_words(error: &McapError) -> String {
    match error {
        McapError::BadChunkCrc { .. } => "its check sum does not hold".into(),
        McapError::UnsupportedCompression(name) => {
            format!("it is compressed with {name:?}, and only zstd, lz4 and none are read")
        }
        McapError::UnexpectedEof | McapError::UnexpectedEoc => "a record in it is longer than it".into(),
        other => other.to_string(),
    }
}
