//! The chunk headers of an MCAP file to what its chunks claim to unpack to, before any of them is unpacked.

use super::chunk::{self, RECORD_HEADER_BYTES, RECORD_HEADER_LENGTH};
use mcap::records::op;
use std::io::{BufReader, Read, Seek};

/// So many records are looked at: a file of single messages has millions and hardly a chunk, and what its chunks unpack to is
/// counted as they are read, too.
const MOST_RECORDS: usize = 100_000;
/// Holds the headers of a record and a chunk; what lies between two chunks is passed over.
const BUFFER_BYTES: usize = 1 << 12;

/// What the chunks of a file claim to unpack to.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(super) struct Claims {
    /// The largest claim of one.
    pub largest_bytes: u64,
    /// The sum of all.
    pub all_bytes: u64,
}

/// The claims of the chunks of `file`, which is left anywhere.
pub(super) fn read(file: &mut (impl Read + Seek), length: u64) -> std::io::Result<Claims> {
    file.rewind()?;
    let mut file = BufReader::with_capacity(BUFFER_BYTES, file);
    let mut claims = Claims::default();
    let mut at = mcap::MAGIC.len() as u64;
    file.seek_relative(at.cast_signed())?;
    for _ in 0..MOST_RECORDS {
        let mut header = [0; RECORD_HEADER_LENGTH];
        if length.saturating_sub(at) < RECORD_HEADER_BYTES {
            break;
        }
        file.read_exact(&mut header)?;
        let [opcode, body @ ..] = header;
        let body = u64::from_le_bytes(body);
        // What follows the last data, is no record or is cut, is the walk's to tell.
        if !(op::HEADER..op::DATA_END).contains(&opcode) || body > length - at - RECORD_HEADER_BYTES {
            break;
        }
        let start = file.stream_position()?;
        if opcode == op::CHUNK
            && let Some(header) = chunk::header(&mut file, body)?
            && header.is_possible(body)
        {
            claims.largest_bytes = claims.largest_bytes.max(header.uncompressed);
            claims.all_bytes = claims.all_bytes.saturating_add(header.uncompressed);
        }
        at += RECORD_HEADER_BYTES + body;
        let used = file.stream_position()? - start;
        file.seek_relative(body.cast_signed() - used.cast_signed())?;
    }
    Ok(claims)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ingest::mcap::written::{ZERO_NS, channel, closed, message};
    use mcap::{Compression, WriteOptions};
    use std::io::Cursor;

    #[test]
    fn chunks_are_believed_as_far_as_their_bytes_can_hold_it() {
        let options = WriteOptions::new().compression(Some(Compression::Zstd)).chunk_size(Some(1000));
        let mut bytes = closed(options, |writer| {
            let id = channel(writer, "/daq/a1", "json", ("", "", b""));
            (0..5).for_each(|i| message(writer, id, ZERO_NS + i, &[b' '; 5000]));
        });
        let of = |bytes: &[u8]| read(&mut Cursor::new(bytes), bytes.len() as u64).unwrap();
        let sound = of(&bytes);
        assert!((5000..5200).contains(&sound.largest_bytes), "{sound:?}");
        assert!((25_000..26_000).contains(&sound.all_bytes), "{sound:?}");
        // The size stands behind the two times of the first chunk.
        let first = bytes.windows(4).position(|four| four == b"zstd").unwrap() - 16;
        bytes[first + 2] = 0x10;
        assert!(of(&bytes).largest_bytes > 1 << 20);
        bytes[first + 7] = 0x10;
        assert!((5000..=sound.largest_bytes).contains(&of(&bytes).largest_bytes));
        for end in 0..bytes.len() {
            assert!(of(&bytes[..end]).all_bytes <= sound.all_bytes, "{end}");
        }
    }
}
