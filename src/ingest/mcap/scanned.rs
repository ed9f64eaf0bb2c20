//! What a walk through an MCAP file found: schemas and channels, counts, and what was lost, in words.

use super::chunk::RECORD_HEADER_BYTES;
use crate::data::{Issue, IssueCode, Severity};
use mcap::records::op;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// A schema record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SchemaInfo {
    pub(super) name: String,
    pub(super) encoding: String,
    pub(super) data: Vec<u8>,
}

/// A channel record with its schema.
#[derive(Debug)]
pub(super) struct ChannelInfo<'a> {
    pub(super) topic: &'a str,
    pub(super) message_encoding: &'a str,
    /// 0 where it has none.
    pub(super) schema_id: u16,
    pub(super) schema: Option<&'a SchemaInfo>,
}

/// A message of a known channel.
pub(super) struct Message<'a> {
    pub(super) channel: u16,
    pub(super) log_time_ns: i64,
    pub(super) data: Cow<'a, [u8]>,
}

/// How many of what the container holds.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) messages: u64,
    pub(super) schemas: u64,
    pub(super) channels: u64,
    pub(super) chunks: u64,
    pub(super) attachments: u64,
    pub(super) metadata: u64,
    /// What the records of the chunks take, unpacked.
    pub(super) unpacked_bytes: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.messages += other.messages;
        self.schemas += other.schemas;
        self.channels += other.channels;
        self.chunks += other.chunks;
        self.attachments += other.attachments;
        self.metadata += other.metadata;
        self.unpacked_bytes += other.unpacked_bytes;
    }
}

impl Counts {
    /// Counts one record of a chunk.
    pub(super) fn add_unpacked(&mut self, opcode: u8, body: &[u8]) {
        self.unpacked_bytes += RECORD_HEADER_BYTES + body.len() as u64;
        self.add(opcode);
    }

    /// Counts one record.
    pub(super) fn add(&mut self, opcode: u8) {
        match opcode {
            op::MESSAGE => self.messages += 1,
            op::CHUNK => self.chunks += 1,
            op::ATTACHMENT => self.attachments += 1,
            op::METADATA => self.metadata += 1,
            _ => {}
        }
    }

    /// By name, as a listing shows them.
    pub(super) fn named(&self) -> BTreeMap<String, u64> {
        let Self { messages, schemas, channels, chunks, attachments, metadata, .. } = *self;
        let names = ["messages", "schemas", "channels", "chunks", "attachments", "metadata"];
        let counts = [messages, schemas, channels, chunks, attachments, metadata];
        names.map(str::to_owned).into_iter().zip(counts).collect()
    }
}

/// What a walk found besides messages.
#[derive(Debug, Default)]
pub(super) struct Scanned {
    pub(super) counts: Counts,
    pub(super) profile: String,
    pub(super) library: String,
    pub(super) compressions: BTreeSet<String>,
    /// Whether the footer was reached.
    pub(super) is_closed: bool,
    /// Number of messages that the file's own statistics claim.
    pub(super) claimed_messages: Option<u64>,
    pub(super) losses: Losses,
    /// The limit that the file passes: words and bytes.
    pub(super) over: Option<(&'static str, u64)>,
}

/// So many places of damage are told one by one, the rest as a count: a damaged gigabyte may hold millions.
const MOST_LOSSES: usize = 20;

/// What could not be read, in the order of the file.
#[derive(Debug, Default)]
pub(super) struct Losses {
    first: Vec<Loss>,
    /// Those that no longer fit in `first`.
    more: u64,
    bad_records: u64,
    /// The first of them, in words.
    first_bad_record: Option<String>,
}

impl Losses {
    /// Takes one more.
    pub(super) fn push(&mut self, loss: Loss) {
        match loss {
            Loss::BadRecord { .. } => {
                self.bad_records += 1;
                self.first_bad_record.get_or_insert_with(|| loss.to_string());
            }
            // How the file ends is told in any case.
            Loss::BadChunk { .. } | Loss::Garbage { .. } if self.first.len() >= MOST_LOSSES => self.more += 1,
            other => self.first.push(other),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.first.is_empty() && self.bad_records == 0
    }
}

/// Something that could not be read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Loss {
    /// The file ends at a record's boundary or within a record, before its footer.
    EndsEarly { at: u64, bytes: u64, inside: Option<u8> },
    /// The file ends within a chunk.
    CutChunk { at: u64, never_closed: bool, bytes: u64, messages: u64 },
    /// A chunk fails its check sum or does not decompress.
    BadChunk { at: u64, reason: String, messages: u64, span_ns: (u64, u64) },
    /// A record's body does not parse, or a message belongs to no channel.
    BadRecord { at: u64, opcode: u8, why: &'static str },
    /// Bytes that are no record.
    Garbage { at: u64, bytes: u64, resumed: bool },
    /// The footer is there, the closing magic is not.
    NoEndMagic { at: u64 },
}

impl Scanned {
    /// The losses as issues, the bad records and bad chunks summed up; without times.
    pub(super) fn issues(&self) -> Vec<Issue> {
        let damaged = |message| Issue::new(IssueCode::Damaged, Severity::Warning, message);
        let Losses { first, more, bad_records, first_bad_record } = &self.losses;
        let mut issues: Vec<Issue> = first.iter().map(Loss::issue).collect();
        if *more > 0 {
            issues.push(damaged(format!("{more} more places of the file are damaged and were left out")));
        }
        if let Some(first) = first_bad_record {
            issues.push(damaged(format!("{bad_records} records were skipped, the first {first}")));
        }
        let found = self.counts.messages;
        if let Some(claimed) = self.claimed_messages.filter(|&n| n != found && self.losses.is_empty()) {
            issues
                .push(damaged(format!("the file's statistics count {claimed} messages, {found} were found")));
        }
        issues
    }
}

impl Loss {
    fn issue(&self) -> Issue {
        let code = match self {
            Self::EndsEarly { .. } | Self::CutChunk { .. } | Self::NoEndMagic { .. } => IssueCode::Truncated,
            Self::BadChunk { .. } | Self::BadRecord { .. } | Self::Garbage { .. } => IssueCode::Damaged,
        };
        Issue::new(code, Severity::Warning, self.to_string())
    }
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EndsEarly { at, bytes: 0, .. } => write!(
                f,
                "the file was never closed: it ends at byte {at} without its footer; every whole message before was read, what was not yet written is lost"
            ),
            Self::EndsEarly { at, bytes, inside } => write!(
                f,
                "the file ends in the middle of a {} at byte {at}: its last {bytes} bytes could not be used, and what followed is lost",
                inside.map_or("record", record_name)
            ),
            Self::CutChunk { at, never_closed, bytes, messages } => {
                f.write_str(if *never_closed {
                    "the file's writer was stopped before it closed"
                } else {
                    "the file ends in the middle of"
                })?;
                write!(f, " the chunk at byte {at}: ")?;
                if *messages == 0 {
                    f.write_str("no whole message is in it")?;
                } else {
                    write!(
                        f,
                        "{messages} whole messages in it were kept without a check sum, the rest of its {bytes} bytes could not be used"
                    )?;
                }
                f.write_str(", and what followed is lost")
            }
            Self::BadChunk { at, reason, messages, span_ns: (from, to) } => write!(
                f,
                "the chunk at byte {at} is damaged ({reason}) and was left out: at least {messages} messages over {:.6} s",
                seconds(to.saturating_sub(*from))
            ),
            Self::Garbage { at, bytes, resumed } => write!(
                f,
                "at byte {at} stands no MCAP record: {bytes} bytes were skipped, {}",
                if *resumed {
                    "reading went on at the next chunk of the file's index"
                } else {
                    "up to the end of the file"
                }
            ),
            Self::NoEndMagic { at } => write!(
                f,
                "the file ends at byte {at} within its closing mark; all records before it were read"
            ),
            Self::BadRecord { at, opcode, why } => write!(f, "a {} at byte {at} {why}", record_name(*opcode)),
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "a duration for a sentence")]
fn seconds(ns: u64) -> f64 {
    ns as f64 * 1e-9
}

fn record_name(opcode: u8) -> &'static str {
    match opcode {
        op::HEADER => "header",
        op::FOOTER => "footer",
        op::SCHEMA => "schema",
        op::CHANNEL => "channel record",
        op::MESSAGE => "message",
        op::CHUNK => "chunk",
        op::ATTACHMENT => "attachment",
        op::METADATA => "metadata record",
        op::DATA_END => "data-end record",
        _ => "record",
    }
}
