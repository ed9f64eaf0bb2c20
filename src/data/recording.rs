//! A recording as read: its channels and the problems of its file; and samples in memory.

use super::channel::Channel;
use super::finding::Finding;
use super::other::OtherChannels;
use serde::Serialize;
use std::path::PathBuf;
use std::sync::Arc;

/// Container format, recognised by content.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub enum RecordingFormat {
    /// MCAP, version 0.
    #[serde(rename = "MCAP")]
    Mcap,
    /// HDF5.
    #[serde(rename = "HDF5")]
    Hdf5,
    /// Delimited text.
    #[serde(rename = "CSV")]
    Csv,
    /// ISO-MME (ISO/TS 13499): a folder of texts, or a zip of it.
    #[serde(rename = "ISO-MME")]
    Mme,
    /// None: samples in memory.
    #[default]
    #[serde(rename = "samples")]
    Samples,
}

/// The channels that a cask file names, read from a recording.
#[derive(Debug, Clone)]
pub struct Recording {
    /// The file.
    pub path: PathBuf,
    /// SHA-256 of the recording, lower-case hexadecimal.
    pub sha256: String,
    /// Format of the recording.
    pub format: RecordingFormat,
    /// Converter that read the recording and passed it on in that format, with its version; `None` if
    /// dropcheck read it itself.
    pub reader: Option<String>,
    /// The channels, in the order of the cask file.
    pub channels: Vec<Channel>,
    /// Channels that take no part in the motion: no number of the motion depends on them.
    pub others: Arc<OtherChannels>,
    /// Absolute time of the recording's first sample, ns since 1970, where the recording knows it.
    pub start_unix_ns: Option<i64>,
    /// Time of its first sample by its own times, s; since 1970 if they are absolute.
    pub first_s: f64,
    /// Time from the beginning of the recording to its trigger at zero, s, if its times count from a trigger.
    pub before_trigger_s: Option<f64>,
    /// Rest before the drop, if it is in a separate file.
    pub rest: Option<RestFile>,
    /// The calculation beside the test, if the cask file names one.
    pub calculation: Option<Box<Recording>>,
    /// The recordings of other recorders whose channels are among these.
    pub joined: Vec<JoinedRecording>,
    /// Problems found when reading: truncation, gaps, doubled blocks, jitter.
    pub issues: Vec<Finding>,
}

/// Recording of another recorder, with a separate clock.
#[derive(Debug, Clone)]
pub struct JoinedRecording {
    /// The file, as the cask file names it.
    pub file: String,
    /// SHA-256 of the file, lower-case hexadecimal.
    pub sha256: String,
    /// Shift added to its times so that both recordings show the first contact at one time, s.
    pub shift_s: f64,
    /// Standard uncertainty of the shift, s.
    pub u_s: f64,
    /// Accelerometers of the recording.
    pub channels: Vec<String>,
}

impl Recording {
    /// End of the channel that ends first, one sample after its last, s.
    pub fn end_s(&self) -> f64 {
        self.channels.iter().map(|c| c.time_s(c.samples.len())).fold(f64::INFINITY, f64::min)
    }
}

/// A file with the rest before the drop.
#[derive(Debug, Clone)]
pub struct RestFile {
    /// The file.
    pub path: PathBuf,
    /// SHA-256 of the file, lower-case hexadecimal.
    pub sha256: String,
}

/// One source of samples as the reader of another format supplies it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HeldSamples {
    /// Name that the cask file uses as `source`, or as the channel's `name`.
    pub name: String,
    /// The samples, in `unit`; a value that is not finite is missing.
    pub values: Vec<f64>,
    /// Sample rate, Hz; `None` if `times_s` or the cask file determines it.
    pub sample_rate_hz: Option<f64>,
    /// Unit; `None` if the cask file states it.
    pub unit: Option<String>,
    /// Time of each sample, s.
    pub times_s: Option<Vec<f64>>,
    /// Time of the first sample if there are no times, s.
    pub start_s: f64,
}
