//! An MCAP file and a cask file to raw channels: only the topics that are named are decoded.

use super::column::{CLOCK_IS_SET_NS, Column, StampCounts, seconds_from};
use super::complaint;
use super::path;
use super::scanned::Scanned;
use super::topic::{Gathered, Topic};
use super::topics::Asked;
use super::walk::walk;
use crate::data::{CaskFile, ChannelSpec, Finding, McapFinding};
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
    let (scanned, mut topics) = walk(path, limits, Asked::Sources(specs), progress)?.finish();
    let chosen = chosen(path, specs, &topics, &scanned)?;
    let columns = || chosen.iter().map(|&(topic, field)| &topics[topic].1.columns[field]);
    let zero_ns = columns().filter_map(Column::span_ns).map(|(from, _)| from).min().unwrap_or(0);
    let last_ns = columns().filter_map(Column::span_ns).map(|(_, to)| to).max().unwrap_or(0);
    let mut issues = scanned.findings(Some(seconds_from(last_ns, zero_ns)));
    let mut channels = Vec::with_capacity(chosen.len());
    for (position, (spec, &(topic, field))) in specs.iter().zip(&chosen).enumerate() {
        let (Topic { fields, .. }, gathered) = &mut topics[topic];
        issues.extend(message_issues(spec, gathered, &gathered.columns[field]));
        if let Some(change) = gathered.columns[field].unit_change() {
            issues.push(complaint::unit_change(path, spec, change)?);
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
fn message_issues(spec: &ChannelSpec, gathered: &Gathered, column: &Column) -> Vec<Finding> {
    let (messages, StampCounts { good, bad }) = (gathered.messages, column.stamps);
    let log_time = (bad > 0).then_some(McapFinding::LogTime { count: bad, messages, beside_good: good > 0 });
    let found = log_time.into_iter().chain(gathered.undecoded(None));
    found.map(|finding| Finding::from(finding).on(&spec.name)).collect()
}

#[cfg(test)]
#[path = "read_tests.rs"]
mod tests;
