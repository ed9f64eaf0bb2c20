//! Recording files and cask files to channels and settings: SI units, one time base a channel, what was
//! missing.

mod arrays;
pub(crate) mod assemble;
pub mod cask_file;
pub(crate) mod clock;
mod counting;
mod csv;
mod detect;
pub(crate) mod error;
mod factors;
pub(crate) mod foreign;
#[cfg(any(test, fuzzing))]
pub mod fuzz_tests;
mod hdf5;
mod limits;
mod lines;
mod listed;
mod mcap;
mod mme;
mod number;
mod number_type;
mod recording_file;
pub(crate) mod refusal;
mod repeats;
mod statement;
pub mod time_base;
mod times;
mod unchanged;
mod unpack;
mod unsupported;
mod vocabulary;

pub use arrays::read_arrays;
pub use detect::format;
pub use error::IngestError;
pub use foreign::{ForeignReader, foreign_format, read_foreign_by};
#[cfg(feature = "native")]
pub use hdf5::{Hdf5Program, is_conversion, take_apart as take_hdf5_apart, use_program as read_hdf5_by};
pub use limits::{LEAST_MEMORY_BYTES, Limits};
pub(crate) use lines::in_utf8;
pub use listed::read_listed;
pub use recording_file::{RecordingFile, bytes_of, opened};
pub use unchanged::hexadecimal;

use crate::data::shown;
use crate::data::{CaskFile, Finding, Listing, Recording, RecordingFormat};
use std::path::Path;

/// Called with the fraction done, 0 to 1, now and then.
pub type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// A recording that is to be read or listed.
#[derive(Clone, Copy)]
pub(crate) struct ReadRequest<'a> {
    pub(crate) file: RecordingFile<'a>,
    pub(crate) limits: Limits,
    pub(crate) progress: Progress<'a>,
}

#[cfg(any(test, fuzzing))]
impl<'a> ReadRequest<'a> {
    /// Of which nobody is told how far it is.
    pub(crate) fn silent(file: impl Into<RecordingFile<'a>>, limits: Limits) -> Self {
        Self { file: file.into(), limits, progress: &|_| () }
    }
}

/// What a format's reader hands over for one `[[channel]]`: uniform samples, still in the recording's unit
/// and clock.
#[derive(Debug)]
pub(crate) struct RawChannel {
    /// The samples; its times and those of its issues count from [`RawRecording::zero_unix_ns`].
    pub(crate) uniform: time_base::Uniform,
    /// The unit that the recording states or that its message type fixes, as written there.
    pub(crate) unit: Option<String>,
    /// Numbers beside the samples by which they may be meant to be multiplied, and are not.
    pub(crate) factors: Vec<String>,
}

impl RawChannel {
    /// The unit that the recording states, where it is not empty.
    fn recorded_unit(&self) -> Option<&str> {
        self.unit.as_deref().map(str::trim).filter(|text| !text.is_empty())
    }
}

/// What a format's reader hands over for a whole file.
#[derive(Debug)]
pub(crate) struct RawRecording {
    /// One for each of [`CaskFile::to_be_read`], in their order.
    pub(crate) channels: Vec<RawChannel>,
    /// Time zero of the channels' clock, ns since 1970, where the recording knows it.
    pub(crate) zero_unix_ns: Option<i64>,
    /// What is wrong with the file; times as in `channels`.
    pub(crate) issues: Vec<Finding>,
}

/// Reads and checks a cask file, its photographs with it.
///
/// # Errors
/// One diagnostic that shows the line.
pub fn cask_file(path: &Path) -> Result<CaskFile, IngestError> {
    cask_file::with_photos(cask_file::parse(path)?)
}

/// Reads the channels that `cask_file` names from a recording, its format told by its content; the rest
/// before the drop in a file of its own is not read.
///
/// # Errors
/// [`IngestError`] where a file, a source or its content is at fault, or the file would pass a limit.
pub fn read_within<'a>(
    recording: impl Into<RecordingFile<'a>>,
    cask_file: &CaskFile,
    limits: Limits,
    progress: Progress,
) -> Result<Recording, IngestError> {
    let recording = recording.into();
    let path = recording.path;
    let cask_file = &*cask_file.for_recorder(None);
    cask_file::require_channels(cask_file, path)?;
    let (stated, cask_file) = (cask_file, &*cask_file.with_all_channels());
    // The hash takes as long as the reading: it runs beside it.
    let (((raw, format), reader), sha256) = unchanged::hashed(recording, || {
        let converted = foreign::converted(recording)?;
        let file = converted.as_ref().map_or(recording, |converted| (&converted.file).into());
        let format = detect::format(file)?;
        let raw = read_raw(ReadRequest { file, limits, progress }, format, cask_file);
        let raw = raw.map_err(|fault| fault.in_file(file.path, path))?;
        let reader = converted.map(|converted| converted.reader);
        #[cfg(not(feature = "native"))]
        let reader = reader.or_else(|| (format == RecordingFormat::Hdf5).then(|| hdf5::READER.to_owned()));
        Ok(((raw, format), reader))
    })?;
    let recording = assemble::recording(path, format, sha256, raw, stated)?;
    Ok(Recording { reader, ..recording })
}

/// What reads a format, and what lists it.
struct FormatReader {
    read: fn(ReadRequest, &CaskFile) -> Result<RawRecording, IngestError>,
    list: fn(ReadRequest) -> Result<Listing, IngestError>,
}

/// The one list of readers.
fn reader(format: RecordingFormat) -> FormatReader {
    match format {
        RecordingFormat::Mcap => FormatReader { read: mcap::read, list: mcap::list },
        RecordingFormat::Hdf5 => FormatReader { read: hdf5::read, list: hdf5::list },
        RecordingFormat::Mme => FormatReader { read: mme::read, list: mme::list },
        // No file is told as `Samples`.
        RecordingFormat::Csv | RecordingFormat::Samples => FormatReader { read: csv::read, list: csv::list },
    }
}

/// What the reader of the format makes of the channels that `cask_file` names: on a thread of the pool, which
/// need not be put to sleep for each piece that two threads share.
fn read_raw(
    request: ReadRequest,
    format: RecordingFormat,
    cask_file: &CaskFile,
) -> Result<RawRecording, IngestError> {
    rayon::scope(|_| (reader(format).read)(request, cask_file))
}

/// Whether the folder at `path` is a recording, in ISO-MME, and not one of recordings.
#[must_use]
pub fn is_recording_folder(path: &Path) -> bool {
    path.is_dir() && !matches!(mme::MmeFiles::of(path.into()), Ok(None))
}

/// The SHA-256 of a recording, as results have it.
///
/// # Errors
/// [`IngestError`] where it cannot be read.
pub fn sha256<'a>(recording: impl Into<RecordingFile<'a>>) -> Result<String, IngestError> {
    unchanged::sha256(recording.into(), &std::sync::atomic::AtomicBool::new(false))
}

/// Lists what the recording at `path` holds.
///
/// # Errors
/// [`IngestError`] where the file is none that can be read.
pub fn list(path: &Path, progress: Progress) -> Result<Listing, IngestError> {
    list_within(path, Limits::default(), progress)
}

/// As [`list`], within other limits than the usual ones.
///
/// # Errors
/// As [`list`]; also where the file would pass a limit.
pub fn list_within<'a>(
    recording: impl Into<RecordingFile<'a>>,
    limits: Limits,
    progress: Progress,
) -> Result<Listing, IngestError> {
    let recording = recording.into();
    let path = recording.path;
    let converted = foreign::converted(recording)?;
    let file = converted.as_ref().map_or(recording, |converted| (&converted.file).into());
    let request = ReadRequest { file, limits, progress };
    let format = detect::format(file)?;
    let listing = rayon::scope(|_| (reader(format).list)(request));
    let mut listing = listing.map_err(|fault| fault.in_file(file.path, path))?;
    if let Some(converted) = converted {
        listing.recording = path.display().to_string();
        listing.bytes = std::fs::metadata(path).map_err(|refusal| error::io(path, &refusal))?.len();
        listing.facts.insert("converted_by".into(), converted.reader);
    }
    Ok(listing)
}

/// To be called first in `main` of a program that reads HDF5 by this library: where the program was started
/// again to take a file apart it does so, and `main` ends with what is returned; else the program is noted as
/// the one to be started.
///
/// The C library for HDF5 breaks off, loops or worse on files that are damaged or made to do harm, so it
/// works in a process of its own that can reach nothing but the recording. A program with another `main`
/// names one that calls this: [`read_hdf5_with`]. Where variables `HDF5_…` are set, by which the library
/// would load code, the program is started anew without them (Unix).
#[cfg(feature = "native")]
#[must_use]
pub fn serve_hdf5() -> Option<std::process::ExitCode> {
    // On Linux the running program itself, also after a newer one took its place; elsewhere anybody may have
    // put a file there.
    let own = Path::new("/proc/self/exe");
    let is_own = cfg!(target_os = "linux") && own.exists();
    let program = if is_own { Ok(own.to_owned()) } else { std::env::current_exe() };
    hdf5::serve(&program.unwrap_or_default())
}

/// Names the program that is started to take HDF5 files apart: one that calls [`serve_hdf5`] first, as
/// `dropcheck` does. The first stays.
#[cfg(feature = "native")]
pub fn read_hdf5_with(program: &Path) {
    read_hdf5_by(Hdf5Program { path: program.to_owned(), ..Hdf5Program::default() });
}
