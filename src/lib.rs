//! dropcheck: what accelerometers on both ends of a dropped cask say about its slap-down, and whether to believe it.

pub mod condition;
pub mod data;
pub mod events;
pub mod ingest;
pub mod numerics;
pub mod predict;
pub mod report;

use data::{Analysis, CaskFile, Recording};

/// Why a recording could not be analysed at all.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum AnalyzeError {
    /// The recording holds no channel that the analysis can use.
    #[error("{recording}: {reason}")]
    Unusable {
        /// The file.
        recording: String,
        /// What is wrong and how to mend it.
        reason: String,
    },
}

/// From a recording and a cask file to everything that can be said of the drop.
///
/// # Errors
/// [`AnalyzeError`] where no channel can be used; what merely weakens the result is an issue in it.
pub fn analyze(recording: &Recording, cask_file: &CaskFile) -> Result<Analysis, AnalyzeError> {
    let _ = cask_file;
    Err(AnalyzeError::Unusable {
        recording: recording.path.display().to_string(),
        reason: "not built yet".into(),
    })
}
