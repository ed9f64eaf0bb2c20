//! The HDF5 library's error stacks to one sentence each that a person can act on.

use super::super::error::{self, IngestError};
use super::answer::{Bytes, decoded};
use crate::ingest::refusal::Refusal;
use std::path::Path;

/// What makes a file that needs more than is built in one that does not.
pub(super) const REPACK: &str = "repack it with gzip: `h5repack -f GZIP=1 IN OUT`";

/// What mends a damaged copy.
pub(super) const AGAIN: &str = "copy the file from the logger again";
/// What begins the words for what the C library alone reads, or may.
pub(super) const BEYOND: &str = "only the HDF5 library reads ";

/// Parts of the library's words, what they mean, and what to do, with tabs between them.
const MEANINGS: &str = include_str!("meanings.tsv");

/// A fault of the whole file, which has so many bytes.
pub(super) fn of_file(path: &Path, bytes: u64, fault: Refusal) -> IngestError {
    error::of_file(path, fault.at(&format!("HDF5 file of {bytes} bytes")))
}

/// What the library's words mean, outermost first.
pub(super) fn of_words(words: &[Bytes]) -> Refusal {
    meaning(words).unwrap_or_else(|| {
        let last = texts(words).pop().unwrap_or_else(|| "the library gives no reason".into());
        Refusal::new(
            format!("it cannot be read: {last}"),
            "the file may be damaged: try `h5dump -H FILE`, or copy it from the logger again",
        )
    })
}

/// The same where it is known.
pub(super) fn meaning(words: &[Bytes]) -> Option<Refusal> {
    let words = texts(words);
    if let Some(beyond) = words.iter().find(|word| word.starts_with(BEYOND)) {
        let mend = "analyse it by the dropcheck command, or convert it: export it anew, in MCAP or CSV";
        return Some(Refusal::new(format!("{beyond}, which this page has not"), mend));
    }
    let all = words.join(": ").to_lowercase();
    let mut meanings = MEANINGS.lines().filter_map(|line| line.split_once('\t'));
    let (part, meaning) = meanings.find(|(part, _)| all.contains(part))?;
    let (problem, remedy) = meaning.split_once('\t')?;
    // The library gives the sizes for a file that is cut off.
    let detail = words.iter().find(|word| word.to_lowercase().contains(part));
    let sizes = detail.and_then(|detail| detail.split_once("file: "));
    let sizes = sizes.map_or(String::new(), |(_, sizes)| format!(" ({sizes})"));
    Some(Refusal::new(format!("{problem}{sizes}"), remedy))
}

fn texts(words: &[Bytes]) -> Vec<String> {
    /// A sentence of the library is shorter; names in a damaged file are not.
    const LONGEST: usize = 200;
    words.iter().map(|word| decoded(&word[..word.len().min(LONGEST)])).collect()
}
