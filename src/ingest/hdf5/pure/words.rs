//! The errors of the library in Rust alone to the words by which a fault is told.

use super::super::answer::Bytes;
use super::super::fault::BEYOND;
use hdf5_reader::error::Error;

/// Words for what the library does not read, or might read wrong.
pub(super) fn beyond(what: &str) -> Vec<Bytes> {
    vec![format!("{BEYOND}{what}").into_bytes()]
}

/// The library's words why something failed.
pub(super) fn words(error: Error) -> Vec<Bytes> {
    match error {
        Error::Context { source, .. } => words(*source),
        Error::UnsupportedLayoutClass(3) => beyond("a dataset whose values lie in other datasets"),
        Error::DecompressionError(_) | Error::FilterError(_) => {
            vec![b"filter returned failure".to_vec(), error.to_string().into_bytes()]
        }
        Error::InvalidData(what) if what.contains("UTF-8") => beyond("names that are not in UTF-8"),
        error => match error.to_string().strip_prefix("unsupported ") {
            Some(what) => beyond(what),
            None => vec![error.to_string().into_bytes()],
        },
    }
}
