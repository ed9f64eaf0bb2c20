//! An MCAP file and a cask file to raw channels: only the topics that are named are decoded.

use super::column::{CLOCK_IS_SET_NS, Column, Stamps, seconds_from};
use super::complaint;
use super::path;
use super::scan::scan;
use super::scanned::Scanned;
use super::topic::{Gathered, Topic};
use super::topics::Asked;
use crate::data::{CaskFile, ChannelSpec, Issue, IssueCode, Severity};
use crate::ingest::error::IngestError;
use crate::ingest::{Limits, Progress, RawChannel, RawRecording};
use std::path::Path;

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
    let specs = &cask_file.channels;
    let (scanned, topics) = scan(path, limits, Asked::Sources(specs), progress)?;
    let mut topics = topics.finish();
    let chosen = chosen(path, specs, &topics, &scanned)?;
    let columns = || chosen.iter().map(|&(topic, field)| &topics[topic].1.columns[field]);
    let zero_ns = columns().filter_map(Column::span_ns).map(|(from, _)| from).min().unwrap_or(0);
    let last_ns = columns().filter_map(Column::span_ns).map(|(_, to)| to).max().unwrap_or(0);
    let mut issues = scanned.issues();
    for issue in issues.iter_mut().filter(|issue| issue.code == IssueCode::Truncated) {
        let kept_s = seconds_from(last_ns, zero_ns);
        issue.message = format!("{}; the last message kept begins at {kept_s:.6} s", issue.message);
        issue.from_s = Some(kept_s);
    }
    let mut channels = Vec::with_capacity(chosen.len());
    for (position, (spec, &(topic, field))) in specs.iter().zip(&chosen).enumerate() {
        let (Topic { fields, .. }, gathered) = &mut topics[topic];
        issues.extend(message_issues(spec, gathered, &gathered.columns[field]));
        if let Some(change) = gathered.columns[field].unit_change() {
            issues.push(complaint::two_units(path, spec, &change)?);
        }
        // A second channel on the same field gets its own copy.
        let column = if chosen[position + 1..].contains(&(topic, field)) {
            gathered.columns[field].clone()
        } else {
            std::mem::replace(&mut gathered.columns[field], Column::new(false))
        };
        let unit = column.unit().or(fields[field].unit).map(str::to_owned);
        let uniform = column
            .uniform(zero_ns, spec.sample_rate_hz)
            .map_err(|problem| complaint::no_base(path, spec, problem))?;
        channels.push(RawChannel { spec: position, uniform, unit });
    }
    Ok(RawRecording { channels, zero_unix_ns: (zero_ns >= CLOCK_IS_SET_NS).then_some(zero_ns), issues })
}

/// Which topic and which of its fields each channel means: of the longest topic that gave samples, else of the longest.
fn chosen(
    path: &Path,
    specs: &[ChannelSpec],
    topics: &[(Topic, Gathered)],
    scanned: &Scanned,
) -> Result<Vec<(usize, usize)>, IngestError> {
    let has_samples = |topic: usize, field: usize| {
        topics[topic].1.columns.get(field).is_some_and(|column| !column.is_empty())
    };
    let meant = |spec: &ChannelSpec| {
        let place = |(at, (topic, _)): (usize, &(Topic, Gathered))| {
            let path = path::field_in(&spec.source, &topic.name)?;
            Some((at, topic.fields.iter().position(|field| field.path == path)?))
        };
        let rank = |&(topic, field): &(usize, usize)| (has_samples(topic, field), topics[topic].0.name.len());
        let places = topics.iter().enumerate().filter_map(place);
        match places.max_by_key(rank) {
            Some((topic, field)) if has_samples(topic, field) => Ok((topic, field)),
            Some((topic, _)) => Err(complaint::no_samples(path, spec, &topics[topic], scanned)),
            None => {
                let names: Vec<String> = topics.iter().map(|(topic, _)| topic.name.clone()).collect();
                Err(complaint::no_topic(path, spec, &names, scanned))
            }
        }
    };
    specs.iter().map(meant).collect()
}

/// What was wrong with single messages of a channel.
fn message_issues(spec: &ChannelSpec, gathered: &Gathered, column: &Column) -> Vec<Issue> {
    let Gathered { messages, malformed, first_problem, .. } = gathered;
    let mut issues = Vec::new();
    let Stamps { good, bad } = column.stamps;
    if bad > 0 {
        let (severity, mixed) = if good > 0 {
            (Severity::Warning, "; the others carry a stamp, and the two clocks may differ")
        } else {
            (Severity::Note, "")
        };
        let message = format!(
            "{bad} of {messages} messages carry a stamp of zero or none that can be understood: their log time was taken{mixed}"
        );
        issues.push(Issue::new(IssueCode::LogTimeUsed, severity, message).on(&spec.name));
    }
    if *malformed > 0 {
        let message = format!(
            "{malformed} of {messages} messages do not decode and were skipped; the first: {}",
            first_problem.as_deref().unwrap_or("unknown")
        );
        issues.push(Issue::new(IssueCode::Damaged, Severity::Warning, message).on(&spec.name));
    }
    issues
}

#[cfg(test)]
#[path = "read_tests.rs"]
mod tests;
