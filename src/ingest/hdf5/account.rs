//! The columns of a file that are read to what they take of the memory, and to the clocks that they have.

use super::clocks::Clocks;
use super::column::DatasetColumn;
use super::room::File;
use super::starts::{self, Start};
use crate::ingest::IngestError;
use crate::ingest::refusal::Refusal;
use std::collections::HashMap;

/// What the channels of a file have taken so far.
#[derive(Default)]
pub(super) struct Account {
    held_bytes: u64,
    /// Of all chunks of each dataset.
    unpacked_bytes: HashMap<String, u64>,
    /// So many values a listing may still read, in all: names may stand for one large dataset many times
    /// over.
    most_values: Option<u64>,
    pub clocks: Clocks,
    /// What is said of the start of each source.
    starts: Vec<(String, Start)>,
}

impl Account {
    /// For a listing, which may read so many values.
    pub(super) fn for_listing(most_values: u64) -> Self {
        Self { most_values: Some(most_values), ..Self::default() }
    }

    /// Takes room for a column before it is read.
    ///
    /// # Errors
    /// There is less.
    pub(super) fn take(&mut self, column: &DatasetColumn) -> Result<(), IngestError> {
        let File { limits, path, bytes, .. } = &*column.file;
        self.held_bytes = self.held_bytes.saturating_add(column.held_bytes());
        let (source, unpacked) = (&column.source, limits.unpacked_bytes(*bytes));
        if self.most_values.is_none() {
            self.unpacked_bytes.insert(column.path.clone(), column.dataset.unpacked_bytes());
        }
        let unpacked_bytes = self.unpacked_bytes.values().fold(0, |all: u64, own| all.saturating_add(*own));
        let idle_bytes = column.dataset.idle_bytes();
        let bounds = [
            (column.part_bytes(), limits.part_bytes(), format!("a block of {source} takes")),
            (idle_bytes, limits.idle_bytes(), format!("a chunk of {source} is wider than its dataset by")),
            (self.held_bytes, unpacked, "the samples of the channels read unpack to".into()),
            (unpacked_bytes, unpacked, format!("the chunks of {source} and of those before unpack to")),
            (self.held_bytes, limits.samples_bytes(), "the samples of the channels read take".into()),
        ];
        bounds.iter().try_for_each(|(bytes, most, what)| limits.hold(path, what, *bytes, *most))
    }

    /// Whether there is room for a column that is not kept.
    pub(super) fn has_for_a_while(&mut self, column: &DatasetColumn) -> bool {
        let (held_bytes, values) = (self.held_bytes, column.values());
        let is_within = self.most_values.is_none_or(|most| values <= most) && self.take(column).is_ok();
        self.held_bytes = held_bytes;
        self.most_values = self.most_values.map(|most| if is_within { most - values } else { most });
        is_within
    }

    /// Takes down what is said of the start of a source.
    pub(super) fn begin(&mut self, source: &str, start: Start) {
        self.starts.push((source.to_owned(), start));
    }

    /// Refuses sources that have no common clock.
    ///
    /// # Errors
    /// There are such.
    pub(super) fn require_common_start(&self) -> Result<(), Refusal> {
        starts::require_common(&self.starts)
    }
}
