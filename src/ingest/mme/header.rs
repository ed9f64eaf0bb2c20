//! A text of ISO-MME to what its lines `name :value` state, and to what stands below them.

use super::files::MmeFiles;
use crate::ingest::Limits;
use crate::ingest::error::{self, IngestError};
use crate::ingest::lines;
use crate::ingest::refusal::Refusal;
use std::io::Read;

/// Lines of a header: an index has one for each channel.
const MOST_LINES: usize = 20_000;

/// What a line states.
#[derive(Debug)]
pub(super) struct HeaderLine {
    /// Its number, from 1.
    pub number: u64,
    pub name: String,
    pub value: String,
}

/// A text, its header apart.
pub(super) struct HeadedText<'a> {
    files: &'a MmeFiles<'a>,
    /// The file.
    pub name: &'a str,
    /// The lines before the first without a colon; those that state `NOVALUE` are left out.
    pub header: Vec<HeaderLine>,
    /// What follows, each line ended by \n.
    pub rest: Vec<u8>,
    /// Lines before that.
    pub above: u64,
    /// How it is encoded, for people.
    pub encoding: &'static str,
    /// Whether zero bytes ended it.
    pub has_zeros: bool,
}

impl<'a> HeadedText<'a> {
    /// The text of a file.
    ///
    /// # Errors
    /// It cannot be read, or has too long a header.
    pub(super) fn of(files: &'a MmeFiles<'a>, name: &'a str, limits: Limits) -> Result<Self, IngestError> {
        let mut text = files.text(name, limits)?;
        let mut rest = std::mem::take(&mut text.head);
        let read = text.rest.read_to_end(&mut rest);
        read.map_err(|source| error::io(&files.recording.path.join(name), &source))?;
        let (mut header, mut at, mut above) = (Vec::new(), 0, 0);
        for line in rest.split_inclusive(|&byte| byte == b'\n') {
            let words = lines::text(line.trim_ascii());
            let stated = words.split_once(':').map(|(name, value)| (name.trim(), value.trim()));
            if stated.is_none() && !words.is_empty() || header.len() >= MOST_LINES {
                break;
            }
            (at, above) = (at + line.len(), above + 1);
            if let Some((name, value)) = stated.filter(|(_, value)| !is_none(value)) {
                header.push(HeaderLine { number: above, name: name.to_owned(), value: value.to_owned() });
            }
        }
        rest.drain(..at);
        let (encoding, has_zeros) = (text.encoding, text.rest.has_zeros);
        Ok(Self { files, name, header, rest, above, encoding, has_zeros })
    }

    /// The line of that name.
    pub(super) fn line(&self, name: &str) -> Option<&HeaderLine> {
        self.header.iter().find(|line| line.name.eq_ignore_ascii_case(name))
    }

    /// A line of that name that states another value than the first of it.
    pub(super) fn contradiction(&self, name: &str) -> Option<&HeaderLine> {
        let first = self.line(name)?;
        let mut own = self.header.iter().filter(|line| line.name.eq_ignore_ascii_case(name));
        own.find(|line| line.value != first.value)
    }

    /// What is wrong in a line.
    pub(super) fn fault(&self, line: u64, problem: String) -> IngestError {
        let refusal = Refusal::new(problem, "correct the line in a copy, or export the test again");
        error::of_file(self.files.recording.path, refusal.at(&format!("{}, line {line}", self.name)))
    }
}

fn is_none(value: &str) -> bool {
    value.is_empty() || value.eq_ignore_ascii_case("novalue")
}
