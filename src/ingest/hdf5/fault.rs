//! The HDF5 library's error stacks to one sentence each that a person can act on.

use super::super::error::{self, IngestError};
use super::answer::{Bytes, decoded};
use crate::ingest::clock::Refusal;
use std::path::Path;

/// What is wrong with a dataset, and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}{problem}")]
pub(super) struct Fault {
    /// What it is about with what parts it from the problem, "/a " or "/a: "; empty where that is said
    /// elsewhere.
    place: String,
    pub problem: String,
    pub remedy: String,
}

/// What makes a file that needs more than is built in one that does not.
pub(super) const REPACK: &str = "repack it with gzip: `h5repack -f GZIP=1 IN OUT`";

const AGAIN: &str = "copy the file from the logger again";
const BAD_SUM: &str = "a check sum does not fit: the data are damaged";

/// Part of the library's words, what they mean, and what to do.
#[rustfmt::skip]
const MEANINGS: [(&str, &str, &str); 8] = [
    ("truncated file", "the file was not closed or is cut off",
     "copy it from the logger again; what is missing cannot be had back"),
    ("already open for write", "the program that wrote the file never closed it",
     "in a copy of the file, run `h5clear -s FILE` and try again; what was written last may be missing"),
    ("file signature not found", "the file is not HDF5, or its beginning is damaged", AGAIN),
    ("unable to lock file", "another program has the file open for writing",
     "close that program, or read a copy"),
    ("required filter", "the data are compressed by a filter that is not built in", REPACK),
    ("checksum", BAD_SUM, AGAIN),
    ("data error detected by fletcher32", BAD_SUM, AGAIN),
    ("filter returned failure", "a block of it cannot be unpacked: the data are damaged or their filter is \
                                 not built in",
     "copy the file from the logger again, or repack it with gzip: `h5repack -f GZIP=1 IN OUT`"),
];

impl Fault {
    pub(super) fn new(problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { place: String::new(), problem: problem.into(), remedy: remedy.into() }
    }

    /// What `name` is or has: "/a" and "is empty".
    pub(super) fn of(name: &str, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { place: format!("{name} "), ..Self::new(problem, remedy) }
    }

    /// The same, said of `name`, unless it says itself what it is about.
    pub(super) fn at(self, name: &str) -> Self {
        if self.place.is_empty() { Self { place: format!("{name}: "), ..self } } else { self }
    }

    /// What a listing says of what it is about: the problem, and the command that cures it where there is
    /// one.
    pub(super) fn listed(self) -> String {
        if self.remedy.contains("h5repack") {
            format!("{}: {}", self.problem, self.remedy)
        } else {
            self.problem
        }
    }

    /// The problem alone where it is one of `name`, else with what it is one of.
    pub(super) fn beside(&self, name: &str) -> String {
        let is_own = self.place.trim_end_matches([':', ' ']) == name;
        if is_own { self.problem.clone() } else { self.to_string() }
    }
}

impl From<Refusal> for Fault {
    fn from(Refusal { problem, remedy }: Refusal) -> Self {
        Self::new(problem, remedy)
    }
}

/// A fault of the whole file.
pub(super) fn of_file(path: &Path, fault: Fault) -> IngestError {
    let size = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    error::content(path, format!("HDF5 file of {size} bytes"), fault.problem, fault.remedy)
}

/// What the library's words mean, outermost first.
pub(super) fn of_words(words: &[Bytes]) -> Fault {
    meaning(words).unwrap_or_else(|| {
        let last = texts(words).pop().unwrap_or_else(|| "the library gives no reason".into());
        Fault::new(
            format!("it cannot be read: {last}"),
            "the file may be damaged: try `h5dump -H FILE`, or copy it from the logger again",
        )
    })
}

/// The same where it is known.
pub(super) fn meaning(words: &[Bytes]) -> Option<Fault> {
    let words = texts(words);
    let all = words.join(": ").to_lowercase();
    let (part, problem, remedy) = MEANINGS.iter().find(|(part, ..)| all.contains(part))?;
    // The library gives the sizes for a file that is cut off.
    let detail = words.iter().find(|word| word.to_lowercase().contains(part));
    let sizes = detail.and_then(|detail| detail.split_once("file: "));
    let sizes = sizes.map_or(String::new(), |(_, sizes)| format!(" ({sizes})"));
    Some(Fault::new(format!("{problem}{sizes}"), *remedy))
}

fn texts(words: &[Bytes]) -> Vec<String> {
    /// A sentence of the library is shorter; names in a damaged file are not.
    const LONGEST: usize = 200;
    words.iter().map(|word| decoded(&word[..word.len().min(LONGEST)])).collect()
}
