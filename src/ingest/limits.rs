//! The memory that reading may take to the largest size of each part of a file.

use super::error::{self, IngestError};
use super::refusal::Refusal;
use std::path::Path;

/// What reading may take where nobody says otherwise: sixteen channels of ten million samples fit.
const USUAL_MEMORY_BYTES: u64 = 4 << 30;
/// Less leaves no room for the reader itself.
pub const LEAST_MEMORY_BYTES: u64 = 64 << 20;

/// Different names or numbers of sensors in one table, dataset or channel: more values count something.
pub(super) const MOST_SENSORS: usize = 64;

/// Largest sizes that are believed of a file; all grow with the memory that is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    memory_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { memory_bytes: USUAL_MEMORY_BYTES }
    }
}

impl Limits {
    /// Limits for so much memory, at least 64 MiB.
    #[must_use]
    pub fn of_memory(memory_bytes: u64) -> Self {
        Self { memory_bytes: memory_bytes.max(LEAST_MEMORY_BYTES) }
    }

    /// Samples with their times, as read, of all channels: a half, for what follows needs as much again.
    pub(super) fn samples_bytes(self) -> u64 {
        self.memory_bytes / 2
    }

    /// One record, message, chunk or converted text: a quarter, for it is held beside what it is turned into.
    pub(super) fn part_bytes(self) -> u64 {
        self.memory_bytes / 4
    }

    /// What a chunk of HDF5 may be larger than its dataset: 64 MiB as usual. Recorders reserve a mebibyte or
    /// a few.
    pub(super) fn idle_bytes(self) -> u64 {
        self.memory_bytes / 64
    }

    /// All that a file of `file_bytes` unpacks to: recordings pack a hundredfold at most, those of sensors
    /// that all stand still somewhat more, a bomb a thousandfold and more. Bytes made of nothing but records
    /// cost 5 ns each, and become eight bytes of samples at most: a file of a few kilobytes, 32 MiB as usual,
    /// costs less than a second and 300 MB.
    pub(super) fn unpacked_bytes(self, file_bytes: u64) -> u64 {
        const TIGHTEST_RECORDING: u64 = 256;
        file_bytes.saturating_mul(TIGHTEST_RECORDING).saturating_add(self.memory_bytes / 128)
    }

    /// Schemas that are taken apart in a file of `file_bytes`, 4 MiB more than it: a taken-apart one takes
    /// forty times its text.
    pub(super) fn schemas_bytes(self, file_bytes: u64) -> u64 {
        file_bytes.saturating_add(self.memory_bytes / 1024)
    }

    /// One line of a text: 1 MiB as usual, where a row of a hundred thousand channels still fits.
    pub(super) fn line_bytes(self) -> u64 {
        self.memory_bytes / 4096
    }

    /// Holds `what` to so many bytes.
    ///
    /// # Errors
    /// It takes more.
    pub(super) fn hold(
        self,
        path: &Path,
        what: &str,
        bytes: u64,
        most_bytes: u64,
    ) -> Result<(), IngestError> {
        if bytes > most_bytes { Err(self.refusal(path, what, most_bytes)) } else { Ok(()) }
    }

    /// The refusal of `what`, which would pass `limit_bytes`.
    pub(super) fn refusal(self, path: &Path, what: &str, limit_bytes: u64) -> IngestError {
        let [limit, memory, more] =
            [limit_bytes, self.memory_bytes, self.memory_bytes.saturating_mul(4)].map(in_words);
        let problem =
            format!("{what} more than {limit}, the limit where reading may take {memory} of memory");
        let remedy = format!(
            "a file that claims so much is damaged or made to do harm; if it is sound, allow more: \
             --max-memory {}",
            more.replace(' ', "")
        );
        error::of_file(path, Refusal::new(problem, remedy))
    }
}

/// A size in the largest unit that it fills, binary.
fn in_words(bytes: u64) -> String {
    let (unit_bytes, unit) = match bytes {
        0x4000_0000.. => (1_u64 << 30, "GiB"),
        0x10_0000.. => (1 << 20, "MiB"),
        _ => (1 << 10, "KiB"),
    };
    let tenths = u128::from(bytes) * 10 / u128::from(unit_bytes);
    if tenths % 10 == 0 {
        format!("{} {unit}", tenths / 10)
    } else {
        format!("{}.{} {unit}", tenths / 10, tenths % 10)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_told_in_the_largest_unit_they_fill() {
        for (bytes, words) in
            [(1 << 20, "1 MiB"), (4 << 30, "4 GiB"), (3 << 29, "1.5 GiB"), (1500, "1.4 KiB")]
        {
            assert_eq!(in_words(bytes), words);
        }
        assert_eq!(Limits::default().part_bytes(), 1 << 30);
        assert_eq!(Limits::of_memory(0).line_bytes(), LEAST_MEMORY_BYTES / 4096);
    }
}
