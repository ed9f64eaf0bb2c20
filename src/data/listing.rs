//! Content of a recording before any cask file is known: the answer of `inspect`.

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
    /// Text to write as `source` in a cask file.
    pub source: String,
    /// Location of its samples, if `source` is a table of topic and field.
    #[serde(skip)]
    pub place: Option<Source>,
    /// Rows of the source that belong to this sensor, if it holds several sensors: the text to write as
    /// `where`.
    #[serde(rename = "where", skip_serializing_if = "Option::is_none")]
    pub rows: Option<RowsOf>,
    /// Text to write as `time`, if channels have separate times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// Kind: "number", "array", "dataset", "column", "topic" (nothing numeric could be decoded).
    pub kind: String,
    /// Number of samples (numbers), where it is known.
    pub samples: Option<u64>,
    /// Number of messages, for MCAP.
    pub messages: Option<u64>,
    /// Sample rate, Hz, if the recording or its times state it.
    pub sample_rate_hz: Option<f64>,
    /// Unit, if the recording states it.
    pub unit: Option<String>,
    /// Time of the first sample, s after the recording's first.
    pub start_s: Option<f64>,
    /// Time from the first to the last sample, s.
    pub duration_s: Option<f64>,
    /// Number of gaps longer than 1.5 sample intervals.
    pub gaps: Option<u64>,
    /// Smallest and largest sample, in `unit`.
    pub range: Option<(f64, f64)>,
    /// Storage: message encoding and schema, or data type, shape and filters.
    pub encoding: String,
    /// Reason why the source cannot be read, if it cannot.
    pub unreadable: Option<String>,
}

impl ListedChannel {
    /// A source with a known name and kind and nothing else.
    pub(crate) fn new(source: &str, kind: &str) -> Self {
        Self { source: source.to_owned(), kind: kind.to_owned(), ..Self::default() }
    }

    /// The smallest and the largest of the samples, if any is a number.
    pub(crate) fn value_range(samples: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
        let wider = |range: Option<(f64, f64)>, x: f64| {
            Some(range.map_or((x, x), |(least, most)| (least.min(x), most.max(x))))
        };
        samples.filter(|sample| is_number(*sample)).fold(None, wider)
    }

    /// Location of the samples, for a reader of recordings.
    pub(crate) fn origin(&self) -> Source {
        self.place.clone().unwrap_or_else(|| Source::Path(self.source.clone()))
    }
}

/// Content of a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Listing {
    /// "dropcheck.inspect/1".
    pub schema: &'static str,
    /// The file, as given.
    pub recording: String,
    /// Size, bytes.
    pub bytes: u64,
    /// Format.
    pub format: RecordingFormat,
    /// Counts of the container's items: for MCAP "messages", "schemas", "channels", "chunks", "attachments",
    /// "metadata"; for HDF5 "groups", "datasets"; for CSV "rows", "columns", "preamble_lines".
    pub counts: BTreeMap<String, u64>,
    /// Facts that the container states: library and profile, delimiter, decimal mark, encoding, compression
    /// and others.
    pub facts: BTreeMap<String, String>,
    /// Every source of samples.
    pub channels: Vec<ListedChannel>,
    /// Damage found in the file.
    pub issues: Vec<Finding>,
}

impl Listing {
    /// A recording with a known name, size and format and nothing else.
    pub(crate) fn new(recording: &Path, bytes: u64, format: RecordingFormat) -> Self {
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

/// Data for a first look at a channel, in the recording's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelLook {
    /// The smallest sample.
    pub smallest: Extreme,
    /// The largest sample.
    pub largest: Extreme,
    /// Median of the first samples; NaN if none of them is a number.
    pub level: f64,
    /// Their spread about it as a standard deviation.
    pub noise: f64,
    /// Interval that looks like a fall, s: from the release to its end.
    pub fall_s: Option<Range<f64>>,
    /// Time at which something like an impact begins, s.
    pub impact_s: Option<f64>,
}
