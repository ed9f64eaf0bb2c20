//! Why a cask file cannot be used: which file, which line, what was expected there.

use crate::ingest::refusal::Refusal;
use miette::{Diagnostic, NamedSource, SourceSpan};

/// What a cask file is called in a message.
pub(crate) const THE_CASK_FILE: &str = "the cask file";

/// Why a cask file cannot be used.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum CaskFileError {
    /// The operating system refuses it, or it is no text file that a cask file could be.
    #[error("{path}: {refusal}")]
    #[diagnostic(help("{}", .refusal.remedy))]
    Refused {
        /// The file.
        path: String,
        /// What is wrong, and what to do.
        refusal: Refusal,
    },
    /// A line of it is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Line(#[from] Box<WrongLine>),
}

/// A line of a cask file that is wrong, with its place.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{path}, line {line}: {message}")]
pub struct WrongLine {
    /// The file.
    pub path: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
    /// What was expected there.
    pub expected: String,
    /// The file's text.
    #[source_code]
    pub text: NamedSource<String>,
    /// Where in it.
    #[label("{expected}")]
    pub span: SourceSpan,
    /// How to mend it.
    #[help]
    pub mend: String,
}
