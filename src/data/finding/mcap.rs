//! What was found of an MCAP file, its chunks and its messages, with its numbers, to code, severity and sentence.

use super::{IssueCode as Code, Severity};

/// A finding about an MCAP file.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "a field's name says what it is and its unit, the variant's words the rest")]
pub enum McapFinding {
    /// The file ends before its time; the last message kept begins at `kept_s`.
    Truncated { end: FileEnd, kept_s: Option<f64> },
    /// A chunk fails its check sum or does not unpack.
    BadChunk { at: u64, reason: String, messages: u64, lasts_s: f64 },
    /// Bytes that are no record.
    Garbage { at: u64, bytes: u64, resumed: bool },
    /// Damage that is not told place by place.
    MoreDamage { places: u64 },
    /// Records whose body does not parse, or messages that belong to no channel; kind and place of the first.
    BadRecords { count: u64, kind: &'static str, at: u64, why: &'static str },
    /// The file's statistics count other messages than there are.
    OtherCount { claimed: u64, found: u64 },
    /// Messages that do not decode; in a listing with their topic.
    Undecoded { count: u64, messages: u64, topic: Option<String>, first: String },
    /// Messages whose stamp is of no use, beside others whose stamp is or not.
    LogTime { count: u64, messages: u64, beside_good: bool },
    /// A unit that changes between messages, where the cask file states one; in a listing with its source.
    TwoUnits { first: String, other: String, source: Option<String> },
    /// What reading would say of a source's times.
    NoTimes { source: String, problem: String },
    /// What a listing has no room for.
    Unlisted { most: usize, most_of_topic: usize, topics: usize, fields: usize },
}

/// Where a file ends that was cut or never closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "a field's name says what it is and its unit, the variant's words the rest")]
pub enum FileEnd {
    /// At a record's boundary or within a record, before the footer.
    Early { at: u64, bytes: u64, inside: &'static str },
    /// Within a chunk.
    InChunk { at: u64, never_closed: bool, bytes: u64, messages: u64 },
    /// Behind the footer, within the closing magic.
    InMagic { at: u64 },
}

impl McapFinding {
    /// The check that speaks, and how much it weighs.
    pub(super) fn code(&self) -> (Code, Severity) {
        use Severity::{Note, Warning};
        match self {
            Self::Truncated { .. } => (Code::Truncated, Warning),
            Self::BadChunk { .. }
            | Self::Garbage { .. }
            | Self::MoreDamage { .. }
            | Self::BadRecords { .. }
            | Self::OtherCount { .. }
            | Self::Undecoded { .. } => (Code::Damaged, Warning),
            Self::LogTime { beside_good: true, .. } => (Code::LogTimeUsed, Warning),
            Self::LogTime { .. } => (Code::LogTimeUsed, Note),
            Self::TwoUnits { .. } => (Code::Scale, Warning),
            Self::NoTimes { .. } => (Code::Clock, Warning),
            Self::Unlisted { .. } => (Code::Unlisted, Note),
        }
    }

    /// What was found, its size, and what to do.
    pub(super) fn sentence(&self) -> String {
        match self {
            Self::Truncated { end, kept_s: None } => end.sentence(),
            Self::Truncated { end, kept_s: Some(kept_s) } => {
                format!("{}; the last message kept begins at {kept_s:.6} s", end.sentence())
            }
            Self::BadChunk { at, reason, messages, lasts_s } => format!(
                "the chunk at byte {at} is damaged ({reason}) and was left out: at least {messages} messages over {lasts_s:.6} s"
            ),
            Self::Garbage { at, bytes, resumed } => {
                let next = if *resumed {
                    "reading went on at the next chunk of the file's index"
                } else {
                    "up to the end of the file"
                };
                format!("at byte {at} stands no MCAP record: {bytes} bytes were skipped, {next}")
            }
            Self::MoreDamage { places } => {
                format!("{places} more places of the file are damaged and were left out")
            }
            Self::BadRecords { count, kind, at, why } => {
                format!("{count} records were skipped, the first a {kind} at byte {at} {why}")
            }
            Self::OtherCount { claimed, found } => {
                format!("the file's statistics count {claimed} messages, {found} were found")
            }
            Self::Undecoded { count, messages, topic: Some(topic), first } => {
                format!("{count} of {messages} messages of {topic} do not decode; the first: {first}")
            }
            Self::Undecoded { count, messages, topic: None, first } => {
                format!("{count} of {messages} messages do not decode and were skipped; the first: {first}")
            }
            Self::LogTime { count, messages, beside_good } => {
                let mixed = if *beside_good {
                    "; the others carry a stamp, and the two clocks may differ"
                } else {
                    ""
                };
                format!(
                    "{count} of {messages} messages carry a stamp of zero or none that can be understood: their log time was taken{mixed}"
                )
            }
            Self::TwoUnits { first, other, source: Some(source) } => {
                format!("{source}: {}", two_units(first, other))
            }
            Self::TwoUnits { first, other, source: None } => {
                format!("{}; all samples were taken in that of the cask file", two_units(first, other))
            }
            Self::NoTimes { source, problem } => format!("{source}: {problem}"),
            Self::Unlisted { most, most_of_topic, topics, fields } => format!(
                "it holds more than is listed, {most} in all and {most_of_topic} of a topic: {topics} more topics and {fields} more fields of the listed ones; a source that is not listed is read all the same"
            ),
        }
    }
}

/// That a unit changes, for a finding and a refusal.
pub(crate) fn two_units(first: &str, other: &str) -> String {
    format!("the unit changes between its messages, from {first:?} to {other:?}")
}

impl FileEnd {
    fn sentence(self) -> String {
        match self {
            Self::Early { at, bytes: 0, .. } => format!(
                "the file was never closed: it ends at byte {at} without its footer; every whole message before was read, what was not yet written is lost"
            ),
            Self::Early { at, bytes, inside } => format!(
                "the file ends in the middle of a {inside} at byte {at}: its last {bytes} bytes could not be used, and what followed is lost"
            ),
            Self::InChunk { at, never_closed, bytes, messages } => {
                let how = if never_closed {
                    "the file's writer was stopped before it closed"
                } else {
                    "the file ends in the middle of"
                };
                let kept = if messages == 0 {
                    "no whole message is in it".to_owned()
                } else {
                    format!(
                        "{messages} whole messages in it were kept without a check sum, the rest of its {bytes} bytes could not be used"
                    )
                };
                format!("{how} the chunk at byte {at}: {kept}, and what followed is lost")
            }
            Self::InMagic { at } => {
                format!("the file ends at byte {at} within its closing mark; all records before it were read")
            }
        }
    }
}
