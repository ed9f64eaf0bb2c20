//! A recording and what is stated of it to an entry of the campaign.

use std::path::{Path, PathBuf};

/// One recording to analyse.
#[derive(Debug, Default, PartialEq)]
pub struct PlannedTest {
    /// Its name in the campaign, alone of its kind.
    pub id: String,
    /// The recording as the manifest or the command line names it, and where it is.
    pub shown: String,
    pub recording: PathBuf,
    /// Its cask file likewise; none where there is none beside it and `--cask` names none.
    pub cask_shown: Option<String>,
    pub cask: Option<PathBuf>,
    /// Keys of the cask file with other values.
    pub stated: Vec<(String, String)>,
    /// Columns that are only carried into the tables.
    pub carried: Vec<(String, String)>,
    /// The folder of its report.
    pub folder: String,
}

/// The cask file beside a recording, else that of the command line.
pub fn cask_of(recording: &Path, cask: Option<&Path>) -> Option<PathBuf> {
    let beside = recording.with_extension("toml");
    if beside.is_file() { Some(beside) } else { cask.map(Path::to_path_buf) }
}
