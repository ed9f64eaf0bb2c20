//! What a recording holds, before any cask file is known: the answer of `inspect`.

use super::cask::{RowsOf, Source};
use super::channel::{Extreme, is_number};
use super::finding::Finding;
use super::recording::RecordingFormat;
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

/// One source of samples in a recording: a message path, a dataset (or its column), a CSV column.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ListedChannel {
    /// What to write as `source` in a cask file.
    pub source: String,
    /// Where its samples are, where `source` is a table of topic and field.
    #[serde(skip)]
    pub place: Option<Source>,
    /// Which rows of it these are, where it holds those of several sensors: what to write as `where`.
    #[serde(rename = "where", skip_serializing_if = "Option::is_none")]
    pub rows: Option<RowsOf>,
    /// What to write as `time`, where channels have times of their own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// What it is: "number", "array", "dataset", "column", "topic" (nothing numeric could be decoded).
    pub kind: String,
    /// Number of samples (numbers), where it is known.
    pub samples: Option<u64>,
    /// Number of messages, for MCAP.
    pub messages: Option<u64>,
    /// Sample rate, Hz, where the recording tells it or its times do.
    pub sample_rate_hz: Option<f64>,
    /// Unit, where the recording tells it.
    pub unit: Option<String>,
    /// Time of the first sample, s after the recording's first.
    pub start_s: Option<f64>,
    /// From first to last sample, s.
    pub duration_s: Option<f64>,
    /// Number of gaps longer than 1.5 sample intervals.
    pub gaps: Option<u64>,
    /// Smallest and largest sample, in `unit`.
    pub range: Option<(f64, f64)>,
    /// How it is stored: message encoding and schema, or data type, shape and filters.
    pub encoding: String,
    /// Why nothing can be read from it, where nothing can.
    pub unreadable: Option<String>,
}

impl ListedChannel {
    /// A source of which only its name and kind are known.
    pub(crate) fn named(source: &str, kind: &str) -> Self {
        Self { source: source.to_owned(), kind: kind.to_owned(), ..Self::default() }
    }

    /// The smallest and the largest of samples, where there is a number among them.
    pub(crate) fn range_of(samples: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
        let wider = |range: Option<(f64, f64)>, x: f64| {
            Some(range.map_or((x, x), |(least, most)| (least.min(x), most.max(x))))
        };
        samples.filter(|sample| is_number(*sample)).fold(None, wider)
    }

    /// Where its samples are, for a reader.
    pub(crate) fn origin(&self) -> Source {
        self.place.clone().unwrap_or_else(|| Source::Path(self.source.clone()))
    }
}

/// What a recording holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Listing {
    /// "dropcheck.inspect/1".
    pub schema: &'static str,
    /// The file, as given.
    pub recording: String,
    /// Its size, bytes.
    pub bytes: u64,
    /// Its format.
    pub format: RecordingFormat,
    /// Counts of what the container holds: for MCAP "messages", "schemas", "channels", "chunks",
    /// "attachments", "metadata"; for HDF5 "groups", "datasets"; for CSV "rows", "columns", "preamble_lines".
    pub counts: BTreeMap<String, u64>,
    /// Facts that the container states: library and profile, delimiter, decimal mark, encoding, compression …
    pub facts: BTreeMap<String, String>,
    /// Every source of samples.
    pub channels: Vec<ListedChannel>,
    /// What is wrong with the file.
    pub issues: Vec<Finding>,
}

impl Listing {
    /// A recording of which no more is known so far.
    pub(crate) fn of(recording: &Path, bytes: u64, format: RecordingFormat) -> Self {
        Self {
            schema: "dropcheck.inspect/1",
            recording: recording.display().to_string(),
            bytes,
            format,
            counts: BTreeMap::new(),
            facts: BTreeMap::new(),
            channels: Vec::new(),
            issues: Vec::new(),
        }
    }
}

/// What a first look at a channel shows, in the recording's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelLook {
    /// The smallest sample.
    pub smallest: Extreme,
    /// The largest sample.
    pub largest: Extreme,
    /// Median of the first samples; not a number where none of them is one.
    pub level: f64,
    /// Their spread about it as a standard deviation.
    pub noise: f64,
    /// What looks like a fall, s: from the release to what ends it.
    pub fall_s: Option<Range<f64>>,
    /// When what looks like an impact begins, s.
    pub impact_s: Option<f64>,
}
