//! A line of a cask file that cannot be used: which file, which line, what is wrong there, how to mend it.

use miette::{Diagnostic, NamedSource, SourceSpan};

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
    /// The file's text.
    #[source_code]
    pub text: NamedSource<String>,
    /// Where in it.
    #[label]
    pub span: SourceSpan,
    /// How to mend it.
    #[help]
    pub mend: String,
}
