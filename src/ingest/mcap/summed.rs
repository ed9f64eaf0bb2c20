//! An MCAP file to its bytes, and to whether they are those that its writer summed up.

use super::summary::Summary;
use crate::ingest::recording_file::OpenFile;
use std::io::{Read, Seek, SeekFrom};

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
