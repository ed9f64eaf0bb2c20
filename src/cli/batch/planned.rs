//! Entry of a campaign: a recording and the values stated for it.

use std::path::{Path, PathBuf};

/// One recording to analyse.
#[derive(Debug, Default, PartialEq)]
pub struct PlannedTest {
    /// Unique name in the campaign.
    pub id: String,
    /// Name of the recording in the manifest or on the command line, and its path.
    pub shown: String,
    pub recording: PathBuf,
    /// Name and path of its cask file; `None` if there is none beside it and `--cask` names none.
    pub cask_shown: Option<String>,
    pub cask: Option<PathBuf>,
    /// Keys of the cask file with the values of this test.
    pub stated: Vec<(String, String)>,
    /// Columns that are only copied into the tables.
    pub carried: Vec<(String, String)>,
    /// Folder of the report.
    pub folder: String,
}

/// Returns the cask file beside a recording, else that of the command line.
pub fn find_cask_file(recording: &Path, cask: Option<&Path>) -> Option<PathBuf> {
    let beside = recording.with_extension("toml");
    if beside.is_file() { Some(beside) } else { cask.map(Path::to_path_buf) }
}
