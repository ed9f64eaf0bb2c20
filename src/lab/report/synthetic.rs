//! A synthetic recording to the bytes of its three files: the recording, the cask file, the truth.

mod cask;
mod csv;
mod hdf5;
mod mcap;
mod place;

use crate::lab::data::{SceneFile, SyntheticRecording, Truth};
use crate::report::{ReportError, json};
use serde::Serialize;

/// How a synthetic recording is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SyntheticFormat {
    /// MCAP with blocks in JSON.
    McapJson,
    /// MCAP with blocks in protobuf.
    McapProtobuf,
    /// HDF5, a dataset a channel.
    Hdf5,
    /// CSV, a column a channel.
    Csv,
}

/// Why a synthetic recording could not be written.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum SyntheticError {
    /// One table has one rate.
    #[error("CSV holds channels of one sample rate, and this scene has {first_hz} and {other_hz} Hz")]
    #[diagnostic(help("write .mcap or .h5, or give every [[channel]] the same sample_rate_hz"))]
    OneRate {
        /// The first channel's rate, Hz.
        first_hz: f64,
        /// Another channel's rate, Hz.
        other_hz: f64,
    },
    /// A writer failed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Writer(#[from] ReportError),
}

/// The files by name: `recording_name`, then the cask file and the truth beside it.
///
/// # Errors
/// [`SyntheticError`] where the format cannot hold the channels or a writer fails.
pub fn synthetic_files(
    scene_file: &SceneFile,
    recording: &SyntheticRecording,
    recording_name: &str,
    format: SyntheticFormat,
) -> Result<Vec<(String, Vec<u8>)>, SyntheticError> {
    let recording = &recording.mounted(&scene_file.stated);
    let places = place::places(recording, format);
    let bytes = match format {
        SyntheticFormat::McapJson => mcap::bytes(recording, &places, true)?,
        SyntheticFormat::McapProtobuf => mcap::bytes(recording, &places, false)?,
        SyntheticFormat::Hdf5 => hdf5::bytes(recording, &places)?,
        SyntheticFormat::Csv => csv::bytes(recording, &places, one_rate_hz(recording)?)?,
    };
    let [_, cask_name, truth_name] = synthetic_names(recording_name);
    let cask_file = cask::text(&scene_file.stated, &places, recording_name).into_bytes();
    let truth = json::pretty(&TruthFile {
        schema: "dropcheck.truth/1",
        version: env!("CARGO_PKG_VERSION"),
        recording: recording_name,
        seed: recording.seed,
        t_impact: recording.first_contact_s,
        truth: &recording.truth,
    })?;
    Ok(vec![(recording_name.to_owned(), bytes), (cask_name, cask_file), (truth_name, truth)])
}

/// `….truth.json`; `t_impact` counts from the recording's first sample.
#[derive(Serialize)]
struct TruthFile<'a> {
    schema: &'static str,
    version: &'static str,
    recording: &'a str,
    seed: u64,
    t_impact: f64,
    #[serde(flatten)]
    truth: &'a Truth,
}

/// The sample rate of all channels, Hz.
fn one_rate_hz(recording: &SyntheticRecording) -> Result<f64, SyntheticError> {
    let mut rates_hz = recording.channels.iter().map(|c| c.sample_rate_hz);
    let first_hz = rates_hz.next().unwrap_or(1.0);
    match rates_hz.find(|hz| (hz - first_hz).abs() > 0.0) {
        Some(other_hz) => Err(SyntheticError::OneRate { first_hz, other_hz }),
        None => Ok(first_hz),
    }
}

/// The names of the files of a recording: its own, the cask file's, the truth's.
pub fn synthetic_names(recording_name: &str) -> [String; 3] {
    let stem = recording_name.rsplit_once('.').map_or(recording_name, |(stem, _)| stem);
    [recording_name.to_owned(), format!("{stem}.toml"), format!("{stem}.truth.json")]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_files_share_a_stem() {
        assert_eq!(synthetic_names("a.b.mcap"), ["a.b.mcap", "a.b.toml", "a.b.truth.json"]);
    }
}
