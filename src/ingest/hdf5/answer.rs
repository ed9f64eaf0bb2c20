//! What goes between this program and the process that takes an HDF5 file apart: requests, descriptions, numbers, each in a frame.
//!
//! A frame is its kind (one byte), its length (four, lowest first) and so many bytes. What a file says comes over as bytes: the other
//! process may have been taken over by the file, so nothing in an answer is believed before [`Dataset::is_sane`] and the reader held it
//! against the file.

use encoding_rs::WINDOWS_1252;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io::{self, Error, ErrorKind, Read, Write};

/// Longest description in bytes: 4096 values of every attribute that is read, and a million chunks, are less.
const LONGEST_FRAME: u32 = 32 << 20;
/// Values are sent in frames of at most so many bytes.
pub(super) const VALUES_BYTES: usize = 1 << 20;

/// Text as it stands in the file, in no encoding that is known.
pub(super) type Bytes = Vec<u8>;

/// Text of a file in UTF-8, else in Windows-1252, which loggers on Windows write whatever the file says.
pub(super) fn decoded(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes)
        .map_or_else(|_| WINDOWS_1252.decode_without_bom_handling(bytes).0.into_owned(), ToOwned::to_owned)
}

/// What is asked.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Request {
    /// What stands at a path; of a dataset also the groups above it and what is named as times beside it.
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
pub(super) enum Answer {
    /// The file is open; it begins behind a user block of so many bytes.
    Opened { user_block: u64, library: (u8, u8, u8) },
    /// What stands at a path.
    Found(String, Object),
    /// The library's words why something cannot be read, outermost first.
    Refused(Vec<Bytes>),
    /// All of a request is answered.
    Done,
}

/// What stands at a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum Object {
    Nothing,
    Group {
        attributes: Vec<(String, Value)>,
        /// Members that are named as times.
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
pub(super) enum Value {
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
    pub number: Option<Number>,
    /// Whether the values are stored as `number` is, the lowest byte first.
    pub is_plain: bool,
    /// The fields of numbers in its records.
    pub fields: Vec<Field>,
    /// Whether its values are records, of numbers or not.
    pub is_records: bool,
    /// `None` where it holds nothing.
    pub shape: Option<Vec<usize>>,
    pub storage: Storage,
    pub filters: Vec<Filter>,
    /// Of its values as they are packed in the file.
    pub stored_bytes: u64,
    pub attributes: Vec<(String, Value)>,
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
        chunks: Option<Vec<Chunk>>,
    },
    /// In other files.
    External,
    /// In other datasets.
    Virtual,
}

/// A chunk of a dataset of one or two dimensions, as it is packed in the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Chunk {
    /// Of its first value.
    pub row: usize,
    /// Of its first value.
    pub column: usize,
    pub at: u64,
    pub bytes: usize,
}

/// What the bytes of a chunk went through.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Filter {
    Shuffle,
    Deflate(u8),
    Fletcher32,
    Lzf,
    /// None that is read, by its name or number.
    Other(String),
}

impl std::fmt::Display for Filter {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::Shuffle => f.write_str("shuffle"),
            Self::Deflate(level) => write!(f, "deflate({level})"),
            Self::Fletcher32 => f.write_str("fletcher32"),
            Self::Lzf => f.write_str("lzf"),
            Self::Other(what) => f.write_str(what),
        }
    }
}

/// A field of numbers in records.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Field {
    /// Its name, with those of the fields it lies in before it: `imu.z`.
    pub name: Bytes,
    pub number: Number,
    /// Numbers in it, one record: above 1 for a list.
    pub count: usize,
    /// Where it begins in a record, bytes.
    pub from: usize,
    /// Whether the highest byte stands first.
    pub is_big_endian: bool,
}

/// A number as Rust has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Number {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
}

impl Number {
    /// Whether it is an integer.
    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// Bytes of one.
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// A number as HDF5 stores it, to the sample that it is held as.
pub(super) trait Stored {
    /// What it is called in an answer.
    const NUMBER: Number;
    /// f32 for f32 and short integers, f64 for all others.
    type Sample: Copy + Default + Send + Sync;
    /// From its bytes, least first, given one by one.
    fn sample(byte: impl Fn(usize) -> u8) -> Self::Sample;
}

macro_rules! stored {
    ($($number:ty = $name:ident as $sample:ty),*) => {$(
        impl Stored for $number {
            const NUMBER: Number = Number::$name;
            type Sample = $sample;
            #[allow(clippy::cast_lossless, clippy::cast_precision_loss, reason = "counts beyond 2^53 lose what no sensor resolves")]
            fn sample(byte: impl Fn(usize) -> u8) -> $sample {
                Self::from_le_bytes(std::array::from_fn(byte)) as $sample
            }
        }
    )*};
}
stored!(
    f32 = F32 as f32,
    f64 = F64 as f64,
    i8 = I8 as f32,
    i16 = I16 as f32,
    i32 = I32 as f64,
    i64 = I64 as f64,
    u8 = U8 as f32,
    u16 = U16 as f32,
    u32 = U32 as f64,
    u64 = U64 as f64
);

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

    /// Whether its parts fit together and into a file of `file_bytes`.
    pub(super) fn is_sane(&self, file_bytes: u64) -> bool {
        let record_bytes = usize::try_from(self.value_bytes).unwrap_or(0);
        let fits = |field: &Field| {
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

/// Sends a request or an answer.
pub(super) fn send(to: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    let bytes = postcard::to_stdvec(message).map_err(Error::other)?;
    frame(to, b'a', &bytes)
}

/// Sends numbers.
pub(super) fn send_values(to: &mut impl Write, values: &[u8]) -> io::Result<()> {
    values.chunks(VALUES_BYTES).try_for_each(|part| frame(to, b'v', part))
}

fn frame(to: &mut impl Write, kind: u8, bytes: &[u8]) -> io::Result<()> {
    let length = u32::try_from(bytes.len()).ok().filter(|length| *length <= LONGEST_FRAME);
    let length = length.ok_or_else(|| Error::from(ErrorKind::FileTooLarge))?;
    to.write_all(&[kind])?;
    to.write_all(&length.to_le_bytes())?;
    to.write_all(bytes)
}

/// A frame's content.
pub(super) enum Received<T> {
    Message(T),
    /// Bytes of numbers.
    Values(Vec<u8>),
}

/// The next frame, and its length in bytes.
///
/// # Errors
/// The other side ended, or sent what is no frame.
pub(super) fn receive<T: DeserializeOwned>(from: &mut impl Read) -> io::Result<(Received<T>, usize)> {
    let mut head = [0; 5];
    from.read_exact(&mut head)?;
    let [kind, length @ ..] = head;
    let length = u32::from_le_bytes(length);
    let is_values = kind == b'v';
    let most = if is_values { VALUES_BYTES } else { LONGEST_FRAME as usize };
    if !matches!(kind, b'a' | b'v') || length as usize > most {
        return Err(ErrorKind::InvalidData.into());
    }
    // What is claimed takes memory only as it comes.
    let mut bytes = Vec::new();
    from.take(length.into()).read_to_end(&mut bytes)?;
    if bytes.len() != length as usize {
        return Err(ErrorKind::UnexpectedEof.into());
    }
    if is_values {
        return Ok((Received::Values(bytes), length as usize));
    }
    let message = postcard::from_bytes(&bytes).map_err(|_| ErrorKind::InvalidData)?;
    Ok((Received::Message(message), length as usize))
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
        send(&mut sound, &Answer::Found("/a".into(), Object::NamedType)).unwrap();
        let answer = |bytes: &[u8]| match receive::<Answer>(&mut &*bytes) {
            Ok((Received::Message(answer), _)) => Some(answer),
            _ => None,
        };
        assert_eq!(answer(&sound), Some(Answer::Found("/a".into(), Object::NamedType)));
        for length in 0..sound.len() {
            assert_eq!(answer(&sound[..length]), None, "{length}");
        }
        assert_eq!(answer(b"a\xff\xff\xff\xff"), None);
        assert_eq!(answer(b"x\x01\x00\x00\x00a"), None);
    }
}
