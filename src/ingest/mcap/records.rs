//! Bytes to the records of an MCAP file, and how many of each kind there are.

use mcap::records::op;
use std::collections::BTreeMap;

/// A record begins with its opcode (1 byte) and its length (8 bytes).
pub(super) const RECORD_HEADER_BYTES: u64 = 9;
/// Records one behind another, each its opcode and its body; ends before one that is not whole.
pub(super) struct Records<'a>(pub(super) &'a [u8]);

impl<'a> Iterator for Records<'a> {
    type Item = (u8, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let ([opcode, length @ ..], rest) = self.0.split_first_chunk::<9>()?;
        let (body, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
        self.0 = rest;
        Some((*opcode, body))
    }
}

/// How many records of each kind, by opcode.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(super) struct Counts {
    of: [u64; 16],
    /// What the records of the chunks take, unpacked.
    pub(super) unpacked_bytes: u64,
}

impl Counts {
    /// Adds those of other records.
    pub(super) fn append(&mut self, other: &Self) {
        self.of.iter_mut().zip(other.of).for_each(|(own, more)| *own += more);
        self.unpacked_bytes += other.unpacked_bytes;
    }

    /// Counts one record of a chunk.
    pub(super) fn add_unpacked(&mut self, opcode: u8, body: &[u8]) {
        self.unpacked_bytes += RECORD_HEADER_BYTES + body.len() as u64;
        self.add(opcode);
    }

    /// Counts one record.
    pub(super) fn add(&mut self, opcode: u8) {
        if let Some(count) = self.of.get_mut(usize::from(opcode)) {
            *count += 1;
        }
    }

    pub(super) fn messages(&self) -> u64 {
        self.of(op::MESSAGE)
    }

    /// How many records of a kind.
    pub(super) fn of(&self, opcode: u8) -> u64 {
        self.of[usize::from(opcode)]
    }

    /// Whether schemas or channels are among them.
    pub(super) fn has_channels(&self) -> bool {
        self.of(op::SCHEMA) + self.of(op::CHANNEL) > 0
    }

    /// By name, as a listing shows them.
    pub(super) fn named(&self, schemas: usize, channels: usize) -> BTreeMap<String, u64> {
        [
            ("messages", self.messages()),
            ("schemas", schemas as u64),
            ("channels", channels as u64),
            ("chunks", self.of(op::CHUNK)),
            ("attachments", self.of(op::ATTACHMENT)),
            ("metadata", self.of(op::METADATA)),
        ]
        .map(|(name, count)| (name.to_owned(), count))
        .into()
    }
}
