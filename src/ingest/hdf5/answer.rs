//! What goes between this program and the process that takes an HDF5 file apart: requests and answers, each
//! in a frame.
//!
//! A frame is its length (four bytes, lowest first) and so many bytes of `postcard`. What a file says comes
//! over as bytes: the other process may have been taken over by the file, so nothing in an answer is believed
//! before [`Dataset::is_sane`] and the reader held it against the file.

use crate::ingest::lines;
use crate::ingest::number_type::NumberType;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io::{self, Error, ErrorKind, Read, Write};

/// Longest description in bytes: 4096 values of every attribute that is read, and a million chunks, are less.
const LONGEST_FRAME: u32 = 32 << 20;
/// So many numbers are sent in a frame at most: 2 MB of f64.
pub(super) const FRAME_NUMBERS: usize = 1 << 18;

/// Text as it stands in the file, in no encoding that is known.
pub(super) type Bytes = Vec<u8>;

/// Text of a file in UTF-8, else in Windows-1252, which loggers on Windows write whatever the file says.
pub(super) fn decoded(bytes: &[u8]) -> String {
    lines::text(bytes).into_owned()
}

/// What is asked.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Query {
    /// What stands at a path.
    Look(String),
    /// Everything in the file.
    Walk,
    /// The numbers of a dataset, as f64 where they are wide, else as f32.
    Read { path: String, is_wide: bool, slab: Slab },
}

/// Which numbers of a dataset, along its longer dimension where it is one channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Slab {
    Whole,
    Row(usize),
    Column(usize),
}

/// What is answered.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Reply {
    /// The file is open; it begins behind a user block of so many bytes.
    Opened {
        user_block: u64,
        library: (u8, u8, u8),
        /// Whether the system keeps the process from every other file.
        is_walled: bool,
    },
    /// What stands at a path.
    Found(String, Object),
    /// The library's words why something cannot be read, outermost first.
    Refused(Vec<Bytes>),
    /// All of a request is answered.
    Done,
    /// Numbers of a dataset that follow those before, as f32 or as f64.
    Narrow(Vec<f32>),
    Wide(Vec<f64>),
}

/// What stands at a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum Object {
    Nothing,
    Group {
        attributes: Vec<(String, AttributeValue)>,
        /// Members that are named as times, or as what tells sensors apart.
        times: Vec<String>,
    },
    Dataset(Dataset),
    /// A type that has a name.
    NamedType,
    /// Something that is never opened, in words: a link into another file.
    NotFollowed(String),
    /// Something that the library cannot open, in its words.
    Broken(Vec<Bytes>),
}

/// What an attribute holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum AttributeValue {
    Numbers(Vec<f64>),
    Texts(Vec<Bytes>),
    /// Something else.
    Other,
}

/// A dataset without its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Dataset {
    /// Its type for people.
    pub type_name: Bytes,
    /// Of one value or record, bytes.
    pub value_bytes: u64,
    /// How its values are read; `None` where they are no numbers.
    pub number: Option<NumberType>,
    /// Whether the values are stored as `number` is, the lowest byte first.
    pub is_plain: bool,
    /// The fields of numbers in its records.
    pub fields: Vec<RecordField>,
    /// Whether its values are records, of numbers or not.
    pub is_records: bool,
    /// `None` where it holds nothing.
    pub shape: Option<Vec<usize>>,
    pub storage: Storage,
    pub filters: Vec<Filter>,
    /// Of its values as they are packed in the file.
    pub stored_bytes: u64,
    pub attributes: Vec<(String, AttributeValue)>,
}

/// Where the values of a dataset lie.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum Storage {
    /// In its header.
    Compact,
    /// In one piece; `None` where nothing was written.
    Contiguous(Option<u64>),
    Chunked {
        shape: Vec<usize>,
        /// Those that were written; `None` where only the library can read them.
        chunks: Option<Vec<StoredChunk>>,
    },
    /// In other files.
    External,
    /// In other datasets.
    Virtual,
}

/// A chunk of a dataset of one or two dimensions, as it is packed in the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct StoredChunk {
    /// Of its first value.
    pub row: usize,
    /// Of its first value.
    pub column: usize,
    pub at: u64,
    pub bytes: usize,
}

impl StoredChunk {
    /// With the place of its first value; `None` where filters were left out of it.
    pub(super) fn of(place: &[u64], at: u64, bytes: u64, filter_mask: u32) -> Option<Self> {
        let along = |i: usize| usize::try_from(place.get(i).copied().unwrap_or(0)).ok();
        let bytes = usize::try_from(bytes).ok().filter(|_| filter_mask == 0)?;
        Some(Self { row: along(0)?, column: along(1)?, at, bytes })
    }
}

/// Numbers of filters in the file.
pub(super) const DEFLATE: i32 = 1;
pub(super) const SHUFFLE: i32 = 2;
const FLETCHER_32: i32 = 3;
const LZF: i32 = 32_000;

/// What the bytes of a chunk went through.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Filter {
    pub number: i32,
    /// Of one that deflates, else 0.
    pub level: u8,
}

impl Filter {
    /// Whether it is undone here or by the library.
    pub(super) fn is_read(&self) -> bool {
        [DEFLATE, SHUFFLE, FLETCHER_32, LZF].contains(&self.number)
    }
}

impl std::fmt::Display for Filter {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self.number {
            DEFLATE => write!(f, "deflate({})", self.level),
            SHUFFLE => f.write_str("shuffle"),
            FLETCHER_32 => f.write_str("fletcher32"),
            4 => f.write_str("SZIP"),
            5 => f.write_str("N-bit"),
            6 => f.write_str("scale-offset"),
            LZF => f.write_str("lzf"),
            number => write!(f, "number {number}"),
        }
    }
}

/// How chunks are packed that this program unpacks itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    Plain,
    Deflated,
    /// The bytes of each place in a value together, then deflated.
    ShuffledDeflated,
    /// As some writers have it by mistake, who name the filters in this order.
    DeflatedShuffled,
}

impl Packing {
    /// `None` where only the library can unpack them.
    pub(super) fn of(filters: &[Filter]) -> Option<Self> {
        let numbers: Vec<i32> = filters.iter().map(|filter| filter.number).collect();
        Some(match numbers[..] {
            [] => Self::Plain,
            [DEFLATE] => Self::Deflated,
            [SHUFFLE, DEFLATE] => Self::ShuffledDeflated,
            [DEFLATE, SHUFFLE] => Self::DeflatedShuffled,
            _ => return None,
        })
    }
}

/// A field of numbers in records.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct RecordField {
    /// Its name, with those of the fields it lies in before it: `imu.z`.
    pub name: Bytes,
    pub number: NumberType,
    /// Numbers in it, one record: above 1 for a list.
    pub count: usize,
    /// Where it begins in a record, bytes.
    pub from: usize,
    /// Whether the highest byte stands first.
    pub is_big_endian: bool,
}

impl Dataset {
    /// How it is stored, for people: type, shape, filters.
    pub(super) fn described(&self) -> String {
        let kind = decoded(&self.type_name);
        let Some(shape) = &self.shape else { return format!("{kind}, no data") };
        let shape: Vec<String> = shape.iter().map(ToString::to_string).collect();
        let shape = if shape.is_empty() { "scalar".into() } else { shape.join(" × ") };
        let filters = self.filters.iter().map(ToString::to_string).collect::<Vec<_>>().join(" + ");
        [kind, shape, filters].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
    }

    /// All that its chunks unpack to, bytes.
    pub(super) fn unpacked_bytes(&self) -> u64 {
        self.bytes(|whole, chunk| whole.div_ceil(chunk).saturating_mul(chunk))
    }

    /// What lies beyond its edges in one chunk, bytes: nobody needs it, and an extensible dataset may have
    /// any amount of it.
    pub(super) fn idle_bytes(&self) -> u64 {
        self.bytes(|_, chunk| chunk).saturating_sub(self.bytes(usize::min))
    }

    /// The product of what a size and that of a chunk make along every dimension, in bytes; 0 where there are
    /// no chunks.
    fn bytes(&self, along: fn(usize, usize) -> usize) -> u64 {
        let (Storage::Chunked { shape: chunk, .. }, Some(whole)) = (&self.storage, &self.shape) else {
            return 0;
        };
        let sizes = whole.iter().zip(chunk).map(|(&whole, &chunk)| along(whole, chunk) as u64);
        sizes.fold(self.value_bytes, u64::saturating_mul)
    }

    /// Whether its parts fit together and into a file of `file_bytes`.
    pub(super) fn is_sane(&self, file_bytes: u64) -> bool {
        let record_bytes = usize::try_from(self.value_bytes).unwrap_or(0);
        let fits = |field: &RecordField| {
            let bytes = field.count.checked_mul(field.number.bytes());
            field.count > 0
                && bytes.and_then(|b| b.checked_add(field.from)).is_some_and(|b| b <= record_bytes)
        };
        let is_number = self.number.is_none_or(|number| !self.is_plain || number.bytes() == record_bytes);
        let chunks_fit = match &self.storage {
            Storage::Chunked { shape, .. } => {
                !shape.contains(&0) && self.shape.as_ref().is_none_or(|whole| whole.len() == shape.len())
            }
            _ => true,
        };
        self.stored_bytes <= file_bytes && is_number && chunks_fit && self.fields.iter().all(fits)
    }
}

/// How long an answer is in a frame.
#[cfg(any(not(feature = "native"), test, fuzzing))]
pub(super) fn frame_bytes(answer: &Reply) -> io::Result<usize> {
    postcard::to_stdvec(answer).map(|bytes| bytes.len()).map_err(Error::other)
}

/// Sends a request or an answer.
pub(super) fn send(to: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    let bytes = postcard::to_stdvec(message).map_err(Error::other)?;
    let length = u32::try_from(bytes.len()).ok().filter(|length| *length <= LONGEST_FRAME);
    to.write_all(&length.ok_or(ErrorKind::FileTooLarge)?.to_le_bytes())?;
    to.write_all(&bytes)
}

/// The next message, and its length in bytes.
///
/// # Errors
/// The other side ended, or sent what is no message.
pub(super) fn receive<T: DeserializeOwned>(from: &mut impl Read) -> io::Result<(T, usize)> {
    let mut length = [0; 4];
    from.read_exact(&mut length)?;
    let length = Some(u32::from_le_bytes(length)).filter(|length| *length <= LONGEST_FRAME);
    // What is claimed takes memory only as it comes.
    let mut bytes = Vec::new();
    from.take(length.ok_or(ErrorKind::InvalidData)?.into()).read_to_end(&mut bytes)?;
    let message = postcard::from_bytes(&bytes).map_err(|_| ErrorKind::InvalidData)?;
    Ok((message, bytes.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_utf_8_or_else_windows_1252() {
        for (bytes, text) in
            [(&b"m/s\xc2\xb2"[..], "m/s²"), (b"m/s\xb2", "m/s²"), (b"\x80/\xb5m", "€/µm"), (b"", "")]
        {
            assert_eq!(decoded(bytes), text);
        }
    }

    #[test]
    fn frames_that_claim_or_lack_bytes_are_no_answers() {
        let mut sound = Vec::new();
        send(&mut sound, &Reply::Found("/a".into(), Object::NamedType)).unwrap();
        let answer = |bytes: &[u8]| Some(receive::<Reply>(&mut &*bytes).ok()?.0);
        assert_eq!(answer(&sound), Some(Reply::Found("/a".into(), Object::NamedType)));
        for length in 0..sound.len() {
            assert_eq!(answer(&sound[..length]), None, "{length}");
        }
        assert_eq!(answer(b"\xff\xff\xff\xff"), None);
        assert_eq!(answer(b"\x01\x00\x00\x00a"), None);
    }
}
