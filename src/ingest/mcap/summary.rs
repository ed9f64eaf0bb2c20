//! A closed MCAP file's summary section to its schemas, channels and chunk positions, before the walk begins.

use super::chunk::{RECORD_HEADER_BYTES, RECORD_HEADER_LENGTH};
use mcap::records::{Record, op};
use std::io::{Read, Seek, SeekFrom};

/// Footer: opcode and length, two offsets and a check sum, then the magic.
const FOOTER_BYTES: u64 = RECORD_HEADER_BYTES + 8 + 8 + 4 + 8;

/// What the summary section tells.
#[derive(Debug, Default)]
pub(super) struct Summary {
    /// Schema and channel records: opcode and body.
    pub(super) records: Vec<(u8, Vec<u8>)>,
    /// Where chunks begin, ascending.
    chunk_starts: Vec<u64>,
}

impl Summary {
    /// The first chunk that begins after byte `at`.
    pub(super) fn next_chunk(&self, at: u64) -> Option<u64> {
        self.chunk_starts.get(self.chunk_starts.partition_point(|&start| start <= at)).copied()
    }
}

/// The summary of `file`, empty where it is closed without one, `None` where it is not closed; the file is left at its start.
/// Schemas and channels beyond `most_bytes` are left to the walk.
pub(super) fn read(
    file: &mut (impl Read + Seek),
    length: u64,
    most_bytes: u64,
) -> std::io::Result<Option<Summary>> {
    let magic_bytes = mcap::MAGIC.len() as u64;
    let mut summary = None;
    if length >= magic_bytes + FOOTER_BYTES {
        file.seek(SeekFrom::Start(length - FOOTER_BYTES))?;
        let mut footer = Vec::new();
        file.read_to_end(&mut footer)?;
        summary = summary_start(&footer)
            .map(|start| (start, length - FOOTER_BYTES))
            .map(|(start, end)| if start < magic_bytes || start >= end { None } else { Some((start, end)) });
    }
    let found = match summary {
        None => None,
        Some(None) => Some(Summary::default()),
        Some(Some((start, end))) => Some(section(file, start, end, most_bytes)?),
    };
    file.seek(SeekFrom::Start(0))?;
    Ok(found)
}

/// Where the summary section starts (0: there is none), `None` where `footer` is no footer.
fn summary_start(footer: &[u8]) -> Option<u64> {
    let body = footer.strip_prefix(&[op::FOOTER, 20, 0, 0, 0, 0, 0, 0, 0])?.strip_suffix(mcap::MAGIC)?;
    body.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
}

/// The records of the section `start..end`; what does not parse ends it.
fn section(file: &mut (impl Read + Seek), start: u64, end: u64, most_bytes: u64) -> std::io::Result<Summary> {
    file.seek(SeekFrom::Start(start))?;
    let mut reader = std::io::BufReader::new(&mut *file).take(end - start);
    let mut summary = Summary::default();
    let mut held_bytes = 0;
    loop {
        let mut header = [0; RECORD_HEADER_LENGTH];
        if reader.limit() < RECORD_HEADER_BYTES || reader.read_exact(&mut header).is_err() {
            break;
        }
        let [opcode, length @ ..] = header;
        let length = u64::from_le_bytes(length);
        // A length that the file holds cannot make the sum overflow.
        if length > reader.limit() || held_bytes + length > most_bytes {
            break;
        }
        held_bytes += length;
        let mut body = Vec::new();
        (&mut reader).take(length).read_to_end(&mut body)?;
        match opcode {
            op::SCHEMA | op::CHANNEL => summary.records.push((opcode, body)),
            op::CHUNK_INDEX => {
                if let Ok(Record::ChunkIndex(index)) = mcap::parse_record(opcode, &body) {
                    summary.chunk_starts.push(index.chunk_start_offset);
                }
            }
            _ => {}
        }
    }
    summary.chunk_starts.sort_unstable();
    Ok(summary)
}
