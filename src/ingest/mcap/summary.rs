//! A closed MCAP file's summary section to its schemas, channels and chunk positions, before the walk begins;
//! and its bytes to whether they are those that its writer summed up.

use super::records::{RECORD_HEADER_BYTES, Records};
use crate::ingest::recording_file::{OpenFile, bytes_at};
use mcap::records::{Record, op};
use std::io::{Read, Seek, SeekFrom};

/// Footer: opcode and length, two offsets and a check sum, then the magic.
const FOOTER_BYTES: u64 = RECORD_HEADER_BYTES + 8 + 8 + 4 + 8;

/// What the summary section tells: it lets messages be taken whose channel stands in a damaged chunk, and
/// goes on after damage.
#[derive(Debug, Default)]
pub(super) struct Summary {
    bytes: Vec<u8>,
    /// Where chunks begin, ascending.
    chunk_starts: Vec<u64>,
    /// The record that ends the data, where it stands right before the summary or the footer.
    pub(super) data_end: Option<DataEnd>,
    /// Whether its check sum fails; then nothing of it is believed.
    pub(super) is_changed: bool,
}

/// The record that ends the data.
#[derive(Debug, Clone, Copy)]
pub(super) struct DataEnd {
    /// Where it begins.
    pub(super) at: u64,
    /// The check sum of all before it; 0 where it states none.
    pub(super) check_sum: u32,
}

/// Its opcode and length, and a check sum.
const DATA_END_BYTES: u64 = RECORD_HEADER_BYTES + 4;

impl Summary {
    /// The first chunk that begins after byte `at`.
    pub(super) fn next_chunk(&self, at: u64) -> Option<u64> {
        self.chunk_starts.get(self.chunk_starts.partition_point(|&start| start <= at)).copied()
    }

    /// Its records.
    pub(super) fn records(&self) -> Records<'_> {
        Records(&self.bytes)
    }
}

/// The summary of `file`, empty where it is closed without one, `None` where it is not closed; the file is
/// left at its start. What lies beyond `most_bytes` is left to the walk.
pub(super) fn read(file: &mut OpenFile, length: u64, most_bytes: u64) -> std::io::Result<Option<Summary>> {
    let magic_bytes = mcap::MAGIC.len() as u64;
    let Some(end) = length.checked_sub(FOOTER_BYTES).filter(|&end| end >= magic_bytes) else {
        return Ok(None);
    };
    let footer = bytes_at(file, end, FOOTER_BYTES)?;
    let mut summary = None;
    if let Some(start) = summary_start(&footer) {
        let Summary { bytes, chunk_starts, data_end, is_changed } = summary.insert(Summary::default());
        let has_summary = (magic_bytes..end).contains(&start);
        *data_end = data_end_before(file, if has_summary { start } else { end })?;
        if has_summary {
            *bytes = bytes_at(file, start, (end - start).min(most_bytes))?;
            // The sum is of the summary and of the footer up to itself.
            let stated = footer[25..].first_chunk().map_or(0, |sum| u32::from_le_bytes(*sum));
            let mut sum = crc32fast::Hasher::new();
            sum.update(bytes);
            sum.update(&footer[..25]);
            *is_changed = stated != 0 && bytes.len() as u64 == end - start && sum.finalize() != stated;
            if *is_changed {
                bytes.clear();
            }
        }
        chunk_starts.extend(Records(bytes).filter_map(|(opcode, body)| {
            match (opcode == op::CHUNK_INDEX).then(|| mcap::parse_record(opcode, body))? {
                Ok(Record::ChunkIndex(index)) => Some(index.chunk_start_offset),
                _ => None,
            }
        }));
        chunk_starts.sort_unstable();
    }
    file.rewind()?;
    Ok(summary)
}

/// The record that ends the data, if it ends at `end`.
fn data_end_before(file: &mut OpenFile, end: u64) -> std::io::Result<Option<DataEnd>> {
    let Some(at) = end.checked_sub(DATA_END_BYTES) else { return Ok(None) };
    let record = bytes_at(file, at, DATA_END_BYTES)?;
    let sum = record.strip_prefix(&[op::DATA_END, 4, 0, 0, 0, 0, 0, 0, 0]).and_then(<[u8]>::first_chunk);
    Ok(sum.map(|sum| DataEnd { at, check_sum: u32::from_le_bytes(*sum) }))
}

/// Where the summary section starts (0: there is none), `None` where `footer` is no footer.
fn summary_start(footer: &[u8]) -> Option<u64> {
    let body = footer.strip_prefix(&[op::FOOTER, 20, 0, 0, 0, 0, 0, 0, 0])?.strip_suffix(mcap::MAGIC)?;
    body.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
}

/// A file that is summed up as it is read, from its beginning to the end of its data.
pub(super) struct Summed {
    file: OpenFile,
    /// The sum so far and how many bytes it lacks, where the file states one.
    pub(super) sum: Option<(crc32fast::Hasher, u64)>,
    stated: u32,
}

impl Summed {
    pub(super) fn of(file: OpenFile, summary: Option<&Summary>) -> Self {
        let end = summary.and_then(|summary| summary.data_end).filter(|end| end.check_sum != 0);
        let sum = end.map(|end| (crc32fast::Hasher::new(), end.at));
        Self { file, sum, stated: end.map_or(0, |end| end.check_sum) }
    }

    /// Whether all of it was read, and is not what was summed up when it was written.
    pub(super) fn is_changed(&self) -> bool {
        self.sum.as_ref().is_some_and(|(sum, lacking)| *lacking == 0 && sum.clone().finalize() != self.stated)
    }
}

impl Read for Summed {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.file.read(buffer)?;
        if let Some((sum, lacking)) = &mut self.sum {
            let summed = read.min(usize::try_from(*lacking).unwrap_or(usize::MAX));
            sum.update(&buffer[..summed]);
            *lacking -= summed as u64;
        }
        Ok(read)
    }
}

impl Seek for Summed {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        // Bytes that are left out are in no sum.
        self.sum = None;
        self.file.seek(to)
    }
}
