//! Findings on an MCAP file, its chunks and its messages: code, severity and sentence of each.

use super::{IssueCode as Code, Severity};
use crate::data::shown::digits;

findings! {
/// A finding about an MCAP file.
pub enum McapFinding of Mcap {
    /// The file ends prematurely; the last message begins at `kept_s`.
    Truncated { end: FileEnd, kept_s: Option<f64> } => (Code::Truncated, Warning, Nothing),
        ("{end}{}",
         kept_s.map(|s| format!("; the last message kept begins at {s:.6} s")).unwrap_or_default());
    /// A chunk fails its check sum or cannot be decompressed.
    BadChunk { at: u64, reason: String, messages: u64, lasts_s: f64 } => (Code::Damaged, Warning, Nothing),
        ("the chunk at byte {at} is damaged ({reason}) and was left out: at least {messages} messages over \
         {lasts_s:.6} s");
    /// Bytes that are no record.
    Garbage { at: u64, bytes: u64, resumed: bool } => (Code::Damaged, Warning, Nothing),
        ("at byte {at} stands no MCAP record: {bytes} bytes were skipped, {}",
         if *resumed { "reading went on at the next chunk of the file's index" }
         else { "up to the end of the file" });
    /// Further damage, which is not listed place by place.
    MoreDamage { places: u64 } => (Code::Damaged, Warning, Nothing),
        ("{places} more places of the file are damaged and were left out");
    /// Records cannot be parsed, or messages belong to no channel; kind and place of the first.
    BadRecords { count: u64, kind: &'static str, at: u64, why: &'static str }
        => (Code::Damaged, Warning, Nothing),
        ("{count} records were skipped, the first a {kind} at byte {at} {why}");
    /// The file's statistics state another number of messages than the file holds.
    OtherCount { claimed: u64, found: u64 } => (Code::Damaged, Warning, Nothing),
        ("the file's statistics count {claimed} messages, {found} were found");
    /// Messages cannot be decoded; in a listing with their topic.
    Undecoded { count: u64, messages: u64, topic: Option<String>, first: String }
        => (Code::Damaged, Warning, Nothing),
        ("{count} of {messages} messages {}; the first: {first}",
         topic.as_ref().map_or("do not decode and were skipped".into(), |t| format!("of {t} do not decode")));
    /// Messages have unusable stamps, beside others with usable stamps or not.
    LogTime { count: u64, messages: u64, beside_good: bool }
        => (Code::LogTimeUsed, if *beside_good { Warning } else { Note }, Nothing),
        ("{count} of {messages} messages carry a stamp of zero or none that can be understood: their log \
         time was taken{}",
         if *beside_good { "; the others carry a stamp, and the two clocks may differ" } else { "" });
    /// Log times run faster or slower than the stamps by this share.
    LogDrift { percent: f64 } => (Code::Clock, Warning, Nothing),
        ("the stamps of its messages and their log times disagree: the log times run at a pace that differs \
         by {} %; the stamps were taken, and every velocity goes with them: `time = \"log_time\"` in the \
         cask file takes the other", digits(*percent, 2));
    /// The data differ from those for which the writer computed the check sum.
    DataChanged => (Code::Damaged, Error, ChannelAndMotion),
        ("the check sum of its data does not hold: bytes were changed after it was written, and nothing \
         tells which samples are as they were: take the original from the logger again");
    /// The summary changed in the same way.
    SummaryChanged => (Code::Damaged, Warning, Nothing),
        ("the check sum of its summary does not hold: bytes were changed after it was written; the summary \
         was left out, the data were read");
    /// The unit changes between messages, and the cask file states one; in a listing with its source.
    TwoUnits { first: String, other: String, source: Option<String> }
        => (Code::Scale, Warning, Contradiction),
        ("{}{}{}",
         source.as_ref().map(|source| format!("{source}: ")).unwrap_or_default(), two_units(first, other),
         if source.is_none() { "; all samples were taken in that of the cask file" } else { "" });
    /// The reader would refuse this source's times.
    NoTimes { source: String, problem: String } => (Code::Clock, Warning, Nothing),
        ("{source}: {problem}");
    /// The listing is too short for all sources.
    Unlisted { most: usize, most_of_topic: usize, topics: usize, fields: usize }
        => (Code::Unlisted, Note, Nothing),
        ("it holds more than is listed, {most} in all and {most_of_topic} of a topic: {topics} more topics \
         and {fields} more fields of the listed ones; a source that is not listed is read all the same");
}
}

/// Position at which a file ends that was cut off or never closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "a field's name says what it is and its unit, the variant's words the rest")]
pub enum FileEnd {
    /// At the boundary of a record or within one, before the footer.
    #[error("{}", ends_early(*.at, *.bytes, .inside))]
    Early { at: u64, bytes: u64, inside: &'static str },
    /// Within a chunk.
    #[error("{} the chunk at byte {at}: {}, and what followed is \
             lost", chunk_end(*.never_closed), chunk_words(*.messages, *.bytes))]
    InChunk { at: u64, never_closed: bool, bytes: u64, messages: u64 },
    /// After the footer, within the closing magic.
    #[error("the file ends at byte {at} within its closing mark; all records before it were read")]
    InMagic { at: u64 },
}

/// Says, for a finding and for a refusal, that the unit changes within a channel.
pub(crate) fn two_units(first: &str, other: &str) -> String {
    format!("the unit changes between its messages, from {first:?} to {other:?}")
}

fn ends_early(at: u64, bytes: u64, inside: &str) -> String {
    match bytes {
        0 => format!(
            "the file was never closed: it ends at byte {at} without its footer; every whole message before \
             was read, what was not yet written is lost"
        ),
        _ => format!(
            "the file ends in the middle of a {inside} at byte {at}: its last {bytes} bytes could not be \
             used, and what followed is lost"
        ),
    }
}

fn chunk_end(never_closed: bool) -> &'static str {
    if never_closed {
        "the file's writer was stopped before it closed"
    } else {
        "the file ends in the middle of"
    }
}

fn chunk_words(messages: u64, bytes: u64) -> String {
    match messages {
        0 => "no whole message is left of it".into(),
        _ => format!(
            "{messages} whole messages in it were kept without a check sum, the rest of its {bytes} bytes \
             could not be used"
        ),
    }
}
