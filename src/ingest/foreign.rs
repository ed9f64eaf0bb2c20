//! A recording of a format that dropcheck does not read to an HDF5 file that another reader makes of it; the
//! Python module brings one.

use super::RecordingFile;
use super::detect::HEAD_BYTES;
use super::error::{self, IngestError};
use super::recording_file::bytes_at;
use super::refusal::Refusal;
use super::unsupported::{self, Remedy};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
#[cfg(feature = "native")]
use tempfile::TempDir;

/// Writes what the first file holds, of the format that the word names, to the second as HDF5. Its answer is
/// the reader with its version; or what is wrong: where, what, and how to mend it.
pub type ForeignReader = fn(&Path, &str, &Path) -> Result<String, [String; 3]>;

static READER: OnceLock<ForeignReader> = OnceLock::new();

/// Names the reader of formats that dropcheck does not read. The first stays.
pub fn read_foreign_by(reader: ForeignReader) {
    // A second one is the same module, loaded again.
    let _ = READER.set(reader);
}

/// Whether there is such a reader.
pub(crate) fn has_reader() -> bool {
    READER.get().is_some()
}

/// The word for the format of the file at `path`, where a library of its field reads it.
#[must_use]
pub fn foreign_format(path: &Path) -> Option<&'static str> {
    let head = bytes_at(&mut RecordingFile::from(path).opened().ok()?, 0, HEAD_BYTES).ok()?;
    match unsupported::named(&head)?.1 {
        Remedy::Library(word, _) => Some(word),
        _ => None,
    }
}

/// The HDF5 file that stands for a recording as long as this value.
pub(super) struct Converted {
    #[cfg(feature = "native")]
    _folder: TempDir,
    /// The file.
    pub(super) file: PathBuf,
    /// What made it, with its version.
    pub(super) reader: String,
}

/// What stands for a file on disk, where it is of a format that the reader takes.
///
/// # Errors
/// What the reader says.
#[cfg(feature = "native")]
pub(super) fn converted(recording: RecordingFile) -> Result<Option<Converted>, IngestError> {
    let path = recording.path;
    let Some(read) = READER.get().filter(|_| recording.in_memory.is_none()) else { return Ok(None) };
    let Some(format) = foreign_format(path) else { return Ok(None) };
    let folder = tempfile::Builder::new().prefix("dropcheck-").tempdir();
    let folder = folder.map_err(|refusal| error::io(&std::env::temp_dir(), &refusal))?;
    // Named as the scratch files of reports: a later run clears away what a killed one left.
    let file = folder.path().join("curves.h5");
    match read(path, format, &file) {
        Ok(reader) => Ok(Some(Converted { _folder: folder, file, reader })),
        Err([place, problem, mend]) => Err(error::of_file(path, Refusal::new(problem, mend).at(&place))),
    }
}

/// A page reads by nothing but what is in it.
#[cfg(not(feature = "native"))]
#[allow(clippy::unnecessary_wraps, reason = "as where there is a reader")]
pub(super) fn converted(_: RecordingFile) -> Result<Option<Converted>, IngestError> {
    Ok(None)
}
