//! Recording files and cask files to channels and settings: SI units, one time base a channel, what was missing.

pub mod time_base;

use crate::data::{CaskFile, Listing, Recording};
use std::path::Path;

/// Why a file could not be read.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum IngestError {}

/// Called with the fraction done, 0 to 1, now and then.
pub type Progress<'a> = &'a dyn Fn(f64);

/// Reads and checks a cask file.
///
/// # Errors
/// One diagnostic that shows the line.
pub fn cask_file(path: &Path) -> Result<CaskFile, IngestError> {
    let _ = path;
    todo!()
}

/// Reads the channels that `cask_file` names from the recording at `path`, its format told by its content.
///
/// # Errors
/// [`IngestError`] where a file, a source or its content is at fault.
pub fn read(path: &Path, cask_file: &CaskFile, progress: Progress) -> Result<Recording, IngestError> {
    let _ = (path, cask_file, progress);
    todo!()
}

/// Lists what the recording at `path` holds.
///
/// # Errors
/// [`IngestError`] where the file is none that can be read.
pub fn list(path: &Path, progress: Progress) -> Result<Listing, IngestError> {
    let _ = (path, progress);
    todo!()
}
