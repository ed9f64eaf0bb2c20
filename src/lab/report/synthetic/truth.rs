//! The truth of a synthetic recording to `….truth.json`.

use crate::lab::data::{SyntheticRecording, Truth};
use crate::report::{ReportError, json};
use serde::Serialize;

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

/// The JSON; `t_impact` counts from the recording's first sample.
///
/// # Errors
/// [`ReportError::Json`] where the writer fails.
pub(super) fn bytes(recording: &SyntheticRecording, recording_name: &str) -> Result<Vec<u8>, ReportError> {
    json::pretty(&TruthFile {
        schema: "dropcheck.truth/1",
        version: env!("CARGO_PKG_VERSION"),
        recording: recording_name,
        seed: recording.seed,
        t_impact: recording.first_contact_s,
        truth: &recording.truth,
    })
}
