//! A recording, read: its channels and what was wrong with the file; and samples held in memory.

use super::channel::Channel;
use super::finding::Finding;
use super::other::OtherChannels;
use serde::Serialize;
use std::path::PathBuf;
use std::sync::Arc;

/// A container format, told by content.
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
    /// Its SHA-256, lower-case hexadecimal.
    pub sha256: String,
    /// Its format.
    pub format: RecordingFormat,
    /// What read it and handed it on in that format, with its version; `None` where dropcheck itself did.
    pub reader: Option<String>,
    /// The channels, in the order of the cask file.
    pub channels: Vec<Channel>,
    /// The channels that take no part in the motion: no number of it rests on them.
    pub others: Arc<OtherChannels>,
    /// Absolute time of the recording's first sample, ns since 1970, where the recording knows it.
    pub start_unix_ns: Option<i64>,
    /// Time of its first sample by its own times, s; of the one since 1970 where it knows that.
    pub first_s: f64,
    /// How long before zero the recording's own times begin, s, where they count from a trigger.
    pub before_trigger_s: Option<f64>,
    /// The rest before the drop, where it is a file of its own.
    pub rest: Option<RestFile>,
    /// The calculation beside the test, where the cask file names one.
    pub calculation: Option<Box<Recording>>,
    /// The recordings of other recorders whose channels are among these.
    pub joined: Vec<JoinedRecording>,
    /// What reading it found wrong: truncation, gaps, doubled blocks, jitter.
    pub issues: Vec<Finding>,
}

/// A recording of another recorder, with a clock of its own.
#[derive(Debug, Clone)]
pub struct JoinedRecording {
    /// The file, as the cask file names it.
    pub file: String,
    /// Its SHA-256, lower-case hexadecimal.
    pub sha256: String,
    /// What was added to its times so that both show the first contact at one time, s.
    pub shift_s: f64,
    /// Standard uncertainty of that, s.
    pub u_s: f64,
    /// Its accelerometers.
    pub channels: Vec<String>,
}

impl Recording {
    /// When the first of its channels ends, one sample behind its last, s.
    pub fn end_s(&self) -> f64 {
        self.channels.iter().map(|c| c.time_s(c.samples.len())).fold(f64::INFINITY, f64::min)
    }
}

/// A file with the rest before the drop.
#[derive(Debug, Clone)]
pub struct RestFile {
    /// The file.
    pub path: PathBuf,
    /// Its SHA-256, lower-case hexadecimal.
    pub sha256: String,
}

/// One source of samples, as a reader of another format hands it over.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HeldSamples {
    /// What the cask file names as `source`, or as the channel's `name`.
    pub name: String,
    /// The samples, in `unit`; what is not finite is missing.
    pub values: Vec<f64>,
    /// Sample rate, Hz; `None` where `times_s` tells it, or the cask file.
    pub sample_rate_hz: Option<f64>,
    /// Unit; `None` where the cask file tells it.
    pub unit: Option<String>,
    /// A time a sample, s.
    pub times_s: Option<Vec<f64>>,
    /// Time of the first sample where there are no times, s.
    pub start_s: f64,
}
