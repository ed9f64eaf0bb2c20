//! What a walk through an MCAP file found besides messages: counts, how it is made, and what was lost.

use super::records::Counts;
use crate::data::{FileEnd, Finding, McapFinding};
use mcap::records::op;
use std::collections::BTreeSet;

/// What a walk found besides messages.
#[derive(Debug, Default)]
pub(super) struct Scanned {
    pub(super) counts: Counts,
    pub(super) profile: String,
    pub(super) library: String,
    pub(super) compressions: BTreeSet<String>,
    /// What metadata records state that may be factors of samples.
    pub(super) factors: Vec<String>,
    /// Number of messages that the file's own statistics claim.
    pub(super) claimed_messages: Option<u64>,
    /// What could not be read, in the order of the file.
    losses: Vec<McapFinding>,
    /// Those that no longer fit there.
    more_losses: u64,
    bad_records: u64,
    /// The first of them; its count is not yet that of all.
    first_bad_record: Option<McapFinding>,
}

/// So many places of damage are told one by one, the rest as a count: a damaged gigabyte may hold millions.
const MOST_LOSSES: usize = 20;

impl Scanned {
    /// Takes one more loss.
    pub(super) fn lose(&mut self, loss: McapFinding) {
        // How the file ends is told in any case.
        if matches!(loss, McapFinding::Truncated { .. }) || self.losses.len() < MOST_LOSSES {
            self.losses.push(loss);
        } else {
            self.more_losses += 1;
        }
    }

    /// Whether nothing was lost so far.
    pub(super) fn is_whole(&self) -> bool {
        self.losses.is_empty() && self.bad_records == 0
    }

    /// Takes `count` records whose body does not parse, or messages that belong to no channel.
    pub(super) fn lose_records(&mut self, opcode: u8, at: u64, count: u64, why: &'static str) {
        self.bad_records += count;
        let kind = record_name(opcode);
        self.first_bad_record.get_or_insert(McapFinding::BadRecords { count, kind, at, why });
    }

    /// Takes that the file ends before its time.
    pub(super) fn end(&mut self, end: FileEnd) {
        self.lose(McapFinding::Truncated { end, kept_s: None });
    }

    /// What was lost, bad records and what is too much to tell summed up; the last message kept begins at
    /// `last_kept_s`.
    pub(super) fn findings(&self, last_kept_s: Option<f64>) -> Vec<Finding> {
        let mut found = self.losses.clone();
        let places = self.more_losses;
        found.extend((places > 0).then_some(McapFinding::MoreDamage { places }));
        if let Some(McapFinding::BadRecords { kind, at, why, .. }) = self.first_bad_record {
            found.push(McapFinding::BadRecords { count: self.bad_records, kind, at, why });
        }
        let messages = self.counts.messages();
        if let (true, Some(claimed)) = (found.is_empty(), self.claimed_messages.filter(|&n| n != messages)) {
            found.push(McapFinding::OtherCount { claimed, found: messages });
        }
        let told = |finding| match finding {
            McapFinding::Truncated { end, .. } => {
                let kept = McapFinding::Truncated { end, kept_s: last_kept_s };
                Finding { from_s: last_kept_s, ..kept.into() }
            }
            other => other.into(),
        };
        found.into_iter().map(told).collect()
    }
}

/// What a sentence calls a record.
pub(super) fn record_name(opcode: u8) -> &'static str {
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
