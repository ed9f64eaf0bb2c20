//! A chunk as it stands in the file to its records: unpacked whole, its check sum tested, a cut one as far as
//! it goes.

use super::records::{Counts, Records};
use super::topic::Part;
use crate::ingest::unpack;

/// Longer than any name of a compression ("zstd", "lz4"); a longer one is damage.
const LONGEST_COMPRESSION_NAME_BYTES: usize = 64;
/// zstd needs three bytes for a block, which unpacks to 128 KiB at most (RFC 8878): more is damage, not a
/// claim.
const LARGEST_EXPANSION: u64 = (128 << 10) / 3 + 1;

/// What a chunk says of itself.
#[derive(Default)]
struct ChunkHeader {
    lasts_ns: u64,
    uncompressed: u64,
    /// 0 where it has none.
    check_sum: u32,
    compression: String,
    /// Where its records lie in its body, packed; what is behind them is padding.
    from: usize,
    to: usize,
}

/// What is wrong with a chunk.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ChunkFault {
    /// The file ends within it.
    Cut,
    /// It is damaged, and none of its messages can be trusted.
    Bad(String),
}

/// A chunk on its way from the file to what its messages give; used again for the memory of its parts.
#[derive(Default)]
pub(super) struct Chunk {
    /// Where its record begins in the file.
    pub(super) start: u64,
    /// How long it claims to be.
    pub(super) claimed: u64,
    /// As it stands in the file.
    pub(super) body: Vec<u8>,
    header: Option<ChunkHeader>,
    unpacked: Vec<u8>,
    pub(super) fault: Option<ChunkFault>,
    /// Of its records.
    pub(super) counts: Counts,
    /// What its messages gave.
    pub(super) part: Part,
    /// How many messages cannot be used, and why the first of them cannot.
    pub(super) unusable: Option<(u64, &'static str)>,
}

impl Chunk {
    /// With an empty part.
    pub(super) fn new(part: Part) -> Self {
        Self { part, ..Self::default() }
    }

    /// Settles what the chunk says of itself, once its body is there.
    pub(super) fn begin(&mut self) {
        let is_cut = self.claimed > self.body.len() as u64;
        self.header = ChunkHeader::of(&self.body, is_cut);
        (self.counts, self.unusable) = (Counts::default(), None);
        self.fault = match &self.header {
            _ if is_cut => Some(ChunkFault::Cut),
            None => Some(ChunkFault::Bad("its header makes no sense".into())),
            Some(header) if !header.is_possible(self.body.len()) => {
                Some(ChunkFault::Bad("its sizes contradict each other".into()))
            }
            Some(_) => None,
        };
    }

    /// What it claims to unpack to and can, bytes.
    pub(super) fn claim(&self) -> u64 {
        self.header.as_ref().filter(|_| self.fault.is_none()).map_or(0, |header| header.uncompressed)
    }

    /// Whether it states a sum of its own.
    pub(super) fn has_sum(&self) -> bool {
        self.header.as_ref().is_none_or(|header| header.check_sum != 0)
    }

    /// The name of its compression, where its header can be read.
    pub(super) fn compression(&self) -> Option<&str> {
        self.header.as_ref().map(|header| header.compression.as_str())
    }

    /// The time that its messages span, as it says, s.
    #[allow(clippy::cast_precision_loss, reason = "a duration for a sentence")]
    pub(super) fn lasts_s(&self) -> f64 {
        self.header.as_ref().map_or(0.0, |header| header.lasts_ns as f64 * 1e-9)
    }

    /// Bytes of its packed records that are there.
    pub(super) fn packed_bytes(&self) -> usize {
        self.packed().map_or(self.body.len(), <[u8]>::len)
    }

    fn packed(&self) -> Option<&[u8]> {
        self.header.as_ref().and_then(|header| self.body.get(header.from..header.to))
    }

    pub(super) fn is_bad(&self) -> bool {
        matches!(self.fault, Some(ChunkFault::Bad(_)))
    }

    /// Its records, once it is unpacked, those of a damaged one as far as they came.
    pub(super) fn records(&self) -> Records<'_> {
        match self.compression() {
            None => Records(&[]),
            Some("") => Records(self.packed().unwrap_or_default()),
            Some(_) => Records(&self.unpacked),
        }
    }

    /// Unpacks and counts its records; a cut chunk unpacks to `most_of_cut` bytes at most.
    pub(super) fn unpack(&mut self, most_of_cut: u64) {
        self.unpacked.clear();
        let Self { header: Some(header), body, unpacked, fault, .. } = self else { return };
        if matches!(fault, Some(ChunkFault::Bad(_))) {
            return;
        }
        let is_cut = fault.is_some();
        let most = if is_cut { most_of_cut } else { header.uncompressed };
        let packed = body.get(header.from..header.to).unwrap_or_default();
        let outcome = header.unpack(packed, most, unpacked);
        let mut counts = Counts::default();
        let mut records = self.records();
        let bytes = records.0;
        records.by_ref().for_each(|(opcode, body)| counts.add_unpacked(opcode, body));
        let sound = outcome.and_then(|()| match &self.header {
            Some(header) if !is_cut => header.check(bytes, records.0.is_empty()),
            _ => Ok(()),
        });
        self.counts = counts;
        if let (false, Err(reason)) = (is_cut, sound) {
            self.fault = Some(ChunkFault::Bad(reason));
        }
    }
}

impl ChunkHeader {
    /// The header that `body` begins with, `None` where it cannot hold it.
    fn of(body: &[u8], is_cut: bool) -> Option<Self> {
        let word = |at: usize| body.get(at..)?.first_chunk().map(|bytes| u64::from_le_bytes(*bytes));
        let half = |at: usize| body.get(at..)?.first_chunk().map(|bytes| u32::from_le_bytes(*bytes));
        let name_bytes = usize::try_from(half(28)?).ok().filter(|&n| n <= LONGEST_COMPRESSION_NAME_BYTES)?;
        let from = 32 + name_bytes + 8;
        let compressed = usize::try_from(word(32 + name_bytes)?).unwrap_or(usize::MAX);
        let to = from.saturating_add(compressed);
        Some(Self {
            lasts_ns: word(8)?.saturating_sub(word(0)?),
            uncompressed: word(16)?,
            check_sum: half(24)?,
            compression: String::from_utf8_lossy(&body[32..32 + name_bytes]).into_owned(),
            from,
            to: if is_cut { to.min(body.len()) } else { to },
        })
    }

    /// Whether a body of so many bytes can hold what the chunk claims.
    fn is_possible(&self, bytes: usize) -> bool {
        let compressed = (self.to - self.from) as u64;
        self.to <= bytes && self.uncompressed <= compressed.saturating_mul(LARGEST_EXPANSION)
    }

    /// Unpacks `most` bytes at most, into what is empty; what is not compressed stays where it is.
    fn unpack(&self, packed: &[u8], most: u64, into: &mut Vec<u8>) -> Result<(), String> {
        let unpacked = match self.compression.as_str() {
            "" => Ok(0),
            "zstd" => unpack::zstd(packed, most, most == self.uncompressed, into),
            "lz4" => unpack::lz4(packed, most, into),
            name => {
                return Err(format!("it is compressed with {name:?}, and only zstd, lz4 and none are read"));
            }
        };
        unpacked.map(|_| ()).map_err(|error| format!("it does not unpack: {error}"))
    }

    /// Whether the unpacked bytes are those that were packed.
    fn check(&self, bytes: &[u8], ends_with_record: bool) -> Result<(), String> {
        if bytes.len() as u64 != self.uncompressed {
            return Err("it unpacks to more or less than it claims".into());
        }
        if self.check_sum != 0 && crc32fast::hash(bytes) != self.check_sum {
            return Err("its check sum does not hold".into());
        }
        if ends_with_record { Ok(()) } else { Err("a record in it is longer than it".into()) }
    }
}
