//! An MCAP file and a cask file to raw channels: only the topics that are named are decoded.

use super::column::{CLOCK_IS_SET_NS, Column, message_time, seconds_from};
use super::message_type::{MessageTypes, implied_unit};
use super::path::{self, FieldPath};
use super::plan::{Decode, Leaf, Plan, Slots};
use super::scan::scan;
use super::scanned::{ChannelInfo, Scanned, Sink};
use super::{complaint, json};
use crate::data::{CaskFile, ChannelSpec, Issue, IssueCode, Severity};
use crate::ingest::error::{self, IngestError};
use crate::ingest::{Limits, Progress, RawChannel, RawRecording};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Reads the channels that `cask_file` names.
///
/// # Errors
/// A topic or field that is not there, or gives no samples on a time base.
pub(in crate::ingest) fn read(
    path: &Path,
    cask_file: &CaskFile,
    limits: Limits,
    progress: Progress,
) -> Result<RawRecording, IngestError> {
    let bytes = std::fs::metadata(path).map_err(|source| error::io(path, source))?.len();
    let mut reading = Reading::new(&cask_file.channels, limits, bytes);
    let scanned = scan(path, limits, &mut reading, progress)?;
    reading.finish(path, &scanned)
}

/// One field of one topic, and what its messages gave.
pub(super) struct Wanted {
    pub(super) topic: String,
    pub(super) field: FieldPath,
    pub(super) column: Column,
    /// The numeric fields of its messages, for whoever misspelt one.
    pub(super) leaves: Vec<Leaf>,
    /// Why its messages cannot be read.
    pub(super) unreadable: Option<String>,
}

/// How to decode the messages of one MCAP channel.
struct Decoding {
    plan: Plan,
    decoder: Box<dyn Decode>,
    /// Indices into `Reading::wanted`, one for each target of the plan.
    wanted: Vec<usize>,
    is_json: bool,
}

/// What a walk through the file collects.
pub(super) struct Reading<'a> {
    specs: &'a [ChannelSpec],
    /// All topics of the file.
    pub(super) topics: Vec<String>,
    known_topics: HashSet<String>,
    pub(super) wanted: Vec<Wanted>,
    types: MessageTypes,
    decodings: HashMap<u16, Arc<Decoding>>,
    /// By topic, schema and encoding: a file may announce one of them under every number.
    same: HashMap<(String, u16, String), Arc<Decoding>>,
    slots: Slots,
    /// Emptied parts, for their memory.
    spare: Mutex<Vec<(Vec<Wanted>, Slots)>>,
}

impl Sink for Reading<'_> {
    fn channel(&mut self, id: u16, info: &ChannelInfo) {
        if self.known_topics.insert(info.topic.to_owned()) {
            self.topics.push(info.topic.to_owned());
        }
        let mut fields: Vec<FieldPath> =
            self.specs.iter().filter_map(|spec| path::field_in(&spec.source, info.topic)).collect();
        fields.dedup();
        let mut wanted: Vec<usize> = Vec::new();
        for field in &fields {
            let index = self.wanted_index(info.topic, field);
            if !wanted.contains(&index) {
                wanted.push(index);
            }
        }
        if wanted.is_empty() {
            return;
        }
        let same = (info.topic.to_owned(), info.schema_id, info.message_encoding.to_owned());
        if let Some(known) = self.same.get(&same) {
            self.decodings.insert(id, known.clone());
            return;
        }
        match self.types.of(info) {
            Ok(message_type) => {
                let leaves = message_type.leaves();
                let mut paths = Vec::new();
                for &index in &wanted {
                    let Some(entry) = self.wanted.get_mut(index) else { continue };
                    if let Some(leaves) = &leaves {
                        entry.leaves.clone_from(leaves);
                    }
                    let implied =
                        info.schema.and_then(|schema| implied_unit(&schema.name, &entry.field.to_string()));
                    entry.column.unit = entry.column.unit.take().or_else(|| implied.map(str::to_owned));
                    paths.push(entry.field.clone());
                }
                let plan = Plan::new(&paths);
                let decoder = message_type.decoder(&plan);
                let is_json = leaves.is_none();
                let decoding = Arc::new(Decoding { plan, decoder, wanted, is_json });
                self.decodings.insert(id, decoding.clone());
                self.same.insert(same, decoding);
            }
            Err(reason) => {
                for &index in &wanted {
                    if let Some(entry) = self.wanted.get_mut(index) {
                        entry.unreadable = Some(reason.clone());
                    }
                }
            }
        }
    }

    fn message(&mut self, id: u16, log_time_ns: i64, data: &[u8]) {
        if let Some(decoding) = self.decodings.get(&id) {
            decoding.message((&mut self.wanted, &mut self.slots), log_time_ns, data);
        }
    }

    fn chunk_begins(&mut self) {
        self.wanted.iter_mut().for_each(|wanted| wanted.column.mark());
    }

    fn chunk_rejected(&mut self) {
        self.wanted.iter_mut().for_each(|wanted| wanted.column.roll_back());
    }

    fn held_bytes(&self) -> u64 {
        self.wanted.iter().map(|wanted| wanted.column.held_bytes).sum()
    }

    type Part = (Vec<Wanted>, Slots);

    fn part(&self) -> Option<Self::Part> {
        if let Some(part) = self.spare.lock().unwrap_or_else(PoisonError::into_inner).pop() {
            return Some(part);
        }
        let begun = |own: &Wanted| Wanted {
            topic: own.topic.clone(),
            field: own.field.clone(),
            column: Column::default(),
            leaves: own.leaves.clone(),
            unreadable: None,
        };
        Some((self.wanted.iter().map(begun).collect(), Slots::default()))
    }

    fn message_into(&self, part: &mut Self::Part, id: u16, log_time_ns: i64, data: &[u8]) {
        if let Some(decoding) = self.decodings.get(&id) {
            decoding.message((&mut part.0, &mut part.1), log_time_ns, data);
        }
    }

    fn join(&mut self, (mut part, slots): Self::Part) -> bool {
        let fits = |(own, others): (&Wanted, &Wanted)| own.column.continues_with(&others.column);
        if part.len() != self.wanted.len() || !self.wanted.iter().zip(&part).all(fits) {
            return false;
        }
        // Most of the time the system hands out the memory, a page after the other.
        self.wanted.par_iter_mut().zip(&mut part).for_each(|(own, others)| {
            own.column.append(&mut others.column);
            if own.leaves.is_empty() {
                own.leaves.clone_from(&others.leaves);
            }
        });
        self.spare.get_mut().unwrap_or_else(PoisonError::into_inner).push((part, slots));
        true
    }
}

impl Decoding {
    /// What one message gives each of the wanted fields.
    fn message(&self, (wanted, slots): (&mut [Wanted], &mut Slots), log_time_ns: i64, data: &[u8]) {
        slots.clear(self.plan.wants.len());
        let outcome = self.decoder.decode(data, slots);
        for (target, &index) in self.plan.targets.iter().zip(&self.wanted) {
            let Some(entry) = wanted.get_mut(index) else { continue };
            if let Err(problem) = &outcome {
                entry.column.malformed(problem);
                continue;
            }
            let time = message_time(&slots.stamp(target), log_time_ns);
            if let Some(unit) = slots.unit(target) {
                entry.column.units.take(unit);
                if entry.column.unit.as_deref() != Some(unit) {
                    entry.column.unit = Some(unit.to_owned());
                }
            }
            let rate_hz = slots.rate_hz(target);
            if entry.column.two_rates.is_none() && rate_hz.is_some() {
                entry.column.two_rates = slots.two_rates(target);
            }
            let value = slots.samples(target);
            if self.is_json && entry.leaves.is_empty() && value == super::plan::Value::Missing {
                entry.leaves = json::leaves(data);
            }
            entry.column.take(value, time, rate_hz);
        }
    }
}

impl<'a> Reading<'a> {
    pub(super) fn new(specs: &'a [ChannelSpec], limits: Limits, file_bytes: u64) -> Self {
        Self {
            specs,
            topics: Vec::new(),
            known_topics: HashSet::new(),
            wanted: Vec::new(),
            types: MessageTypes::new(limits, file_bytes),
            decodings: HashMap::new(),
            same: HashMap::new(),
            slots: Slots::default(),
            spare: Mutex::default(),
        }
    }

    fn wanted_index(&mut self, topic: &str, field: &FieldPath) -> usize {
        let known = self.wanted.iter().position(|entry| entry.topic == topic && entry.field == *field);
        known.unwrap_or_else(|| {
            self.wanted.push(Wanted {
                topic: topic.to_owned(),
                field: field.clone(),
                column: Column::default(),
                leaves: Vec::new(),
                unreadable: None,
            });
            self.wanted.len() - 1
        })
    }

    /// The entry that `spec` means: of the longest topic that gave samples, else of the longest.
    fn entry_of(&self, spec: &ChannelSpec) -> Option<usize> {
        (0..self.wanted.len())
            .filter(|&index| {
                self.wanted.get(index).is_some_and(|entry| {
                    path::field_in(&spec.source, &entry.topic).as_ref() == Some(&entry.field)
                })
            })
            .max_by_key(|&index| {
                self.wanted.get(index).map(|entry| (!entry.column.is_empty(), entry.topic.len()))
            })
    }

    pub(super) fn finish(mut self, path: &Path, scanned: &Scanned) -> Result<RawRecording, IngestError> {
        self.wanted.iter_mut().for_each(|wanted| wanted.column.settle_clock());
        let mut chosen = Vec::with_capacity(self.specs.len());
        for spec in self.specs {
            let Some(index) = self.entry_of(spec) else {
                return Err(complaint::no_topic(path, spec, &self.topics, scanned));
            };
            match self.wanted.get(index) {
                Some(entry) if !entry.column.is_empty() => chosen.push(index),
                Some(entry) => return Err(complaint::no_samples(path, spec, entry, scanned)),
                None => {}
            }
        }
        let spans = chosen.iter().filter_map(|&index| self.wanted.get(index)?.column.span_ns());
        let (zero_ns, last_ns) =
            spans.fold((i64::MAX, i64::MIN), |(low, high), (from, to)| (low.min(from), high.max(to)));
        let mut issues = scanned.issues();
        for issue in issues.iter_mut().filter(|issue| issue.code == IssueCode::Truncated) {
            let kept_s = seconds_from(last_ns, zero_ns);
            issue.message = format!("{}; the last message kept begins at {kept_s:.6} s", issue.message);
            issue.from_s = Some(kept_s);
        }
        let mut channels = Vec::with_capacity(chosen.len());
        for (position, (spec, &index)) in self.specs.iter().zip(&chosen).enumerate() {
            // A second channel on the same field gets its own copy.
            let is_needed_later = chosen.get(position + 1..).is_some_and(|later| later.contains(&index));
            let Some(entry) = self.wanted.get_mut(index) else { continue };
            let column =
                if is_needed_later { entry.column.clone() } else { std::mem::take(&mut entry.column) };
            issues.extend(message_issues(spec, &column));
            let unit = column.unit.clone();
            let uniform = column
                .uniform(zero_ns, spec.sample_rate_hz)
                .map_err(|problem| complaint::no_base(path, spec, &problem))?;
            channels.push(RawChannel { spec: position, uniform, unit });
        }
        Ok(RawRecording { channels, zero_unix_ns: (zero_ns >= CLOCK_IS_SET_NS).then_some(zero_ns), issues })
    }
}

/// What was wrong with single messages of a channel.
fn message_issues(spec: &ChannelSpec, column: &Column) -> Vec<Issue> {
    let mut issues: Vec<Issue> = column.units.issue().map(|issue| issue.on(&spec.name)).into_iter().collect();
    let tally = column.tally;
    if tally.bad_stamps > 0 {
        let (severity, mixed) = if tally.stamps > 0 {
            (Severity::Warning, "; the others carry a stamp, and the two clocks may differ")
        } else {
            (Severity::Note, "")
        };
        let message = format!(
            "{} of {} messages carry a stamp of zero or none that can be understood: their log time was taken{mixed}",
            tally.bad_stamps, tally.messages
        );
        issues.push(Issue::new(IssueCode::LogTimeUsed, severity, message).on(&spec.name));
    }
    if tally.malformed > 0 {
        let message = format!(
            "{} of {} messages do not decode and were skipped; the first: {}",
            tally.malformed,
            tally.messages,
            column.first_problem.as_deref().unwrap_or("unknown")
        );
        issues.push(Issue::new(IssueCode::Damaged, Severity::Warning, message).on(&spec.name));
    }
    issues
}

#[cfg(test)]
#[path = "read_tests.rs"]
mod tests;
