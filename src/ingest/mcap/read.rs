//! An MCAP file and a cask file to raw channels: only the topics that are named are decoded.

use super::column::{CLOCK_IS_SET_NS, Column, seconds_from};
use super::complaint;
use super::path;
use super::scanned::Scanned;
use super::topic::{Channels, Gathered, Sensor};
use super::topics::LOG_TIME;
use super::walk::walk;
use crate::data::{CaskFile, ChannelSpec, Finding, McapFinding, RowsOf, Source};
use crate::ingest::error::{self, IngestError};
use crate::ingest::refusal::Refusal;
use crate::ingest::{RawChannel, RawRecording, ReadRequest};
use std::path::Path;

/// Reads the channels that `cask_file` names.
///
/// # Errors
/// A topic or field that is not there, or gives no samples on a time base.
pub(in crate::ingest) fn read(
    request: ReadRequest,
    cask_file: &CaskFile,
) -> Result<RawRecording, IngestError> {
    let path = request.file.path;
    let specs = &cask_file.channels;
    let (scanned, mut topics) = walk(request, Some(cask_file))?.finish();
    let refused = |spec: &ChannelSpec, refusal| error::of_channel(path, &spec.name, refusal);
    let one =
        |spec: &ChannelSpec| chosen(path, spec, &topics, &scanned).map_err(|refusal| refused(spec, refusal));
    let chosen: Vec<ChosenColumn> = specs.iter().map(one).collect::<Result<_, _>>()?;
    for (spec, place) in specs.iter().zip(&chosen) {
        let column = place.column_mut(&mut topics);
        let settled = column.settle_ticks(&spec.source.to_string(), spec.sample_rate_hz);
        settled.map_err(|refusal| refused(spec, refusal))?;
        if let Some(time) =
            cask_file.time_of(spec).filter(|time| *time != LOG_TIME && column.good_stamps == 0)
        {
            return Err(refused(spec, complaint::no_named_time(spec, time)));
        }
    }
    let columns = || chosen.iter().map(|place| place.column(&topics));
    let zero_ns = columns().filter_map(Column::span_ns).map(|(from, _)| from).min().unwrap_or(0);
    let last_ns = columns().filter_map(Column::span_ns).map(|(_, to)| to).max().unwrap_or(0);
    let mut issues = scanned.findings(Some(seconds_from(last_ns, zero_ns)));
    let mut channels = Vec::with_capacity(chosen.len());
    for (position, (spec, place)) in specs.iter().zip(&chosen).enumerate() {
        let (topic, told) = &topics[place.topic];
        let column = place.column(&topics);
        issues.extend(message_issues(spec, &told[place.channel].1, column));
        if let Some(change) = column.unit_change() {
            issues.push(complaint::unit_change(spec, change).map_err(|refusal| refused(spec, refusal))?);
        }
        let unit = topic.unit(&topic.plan.fields[place.field], column);
        // A second channel on the same field gets its own copy.
        let column = if chosen[position + 1..].contains(place) {
            column.clone()
        } else {
            std::mem::replace(place.column_mut(&mut topics), Column::new(false))
        };
        let uniform = column
            .uniform(zero_ns, spec.sample_rate_hz)
            .map_err(|problem| refused(spec, complaint::no_base(spec, problem)))?;
        channels.push(RawChannel { spec: position, uniform, unit });
    }
    Ok(RawRecording { channels, zero_unix_ns: (zero_ns >= CLOCK_IS_SET_NS).then_some(zero_ns), issues })
}

/// Which samples a channel of the cask file means, by the places of their topic, channel, sensor and field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ChosenColumn {
    topic: usize,
    channel: usize,
    sensor: usize,
    field: usize,
}

impl ChosenColumn {
    fn column<'a>(&self, topics: &'a [Channels]) -> &'a Column {
        &topics[self.topic].1[self.channel].1.sensors[self.sensor].columns[self.field]
    }

    fn column_mut<'a>(&self, topics: &'a mut [Channels]) -> &'a mut Column {
        &mut topics[self.topic].1[self.channel].1.sensors[self.sensor].columns[self.field]
    }
}

/// The samples that a channel means: of the longest topic that gave some.
fn chosen(
    path: &Path,
    spec: &ChannelSpec,
    topics: &[Channels],
    scanned: &Scanned,
) -> Result<ChosenColumn, Refusal> {
    let field = |(at, (topic, _)): (usize, &Channels)| {
        let path = path::field_in(&spec.source, &topic.name)?;
        Some((at, topic.plan.fields.iter().position(|field| field.asked.path == path)?))
    };
    let fields: Vec<(usize, usize)> = topics.iter().enumerate().filter_map(field).collect();
    let Some(&(longest, _)) = fields.iter().max_by_key(|(topic, _)| topics[*topic].0.name.len()) else {
        let mut names: Vec<String> = topics.iter().map(|(topic, _)| topic.name.clone()).collect();
        names.dedup();
        return Err(complaint::no_topic(path, spec, &names, scanned));
    };
    let places = fields.iter().flat_map(|&(topic, field)| with_samples(topics, topic, field));
    let mut all: Vec<ChosenColumn> = places.collect();
    let most = all.iter().map(|place| topics[place.topic].0.name.len()).max();
    all.retain(|place| Some(topics[place.topic].0.name.len()) == most);
    let picked: Vec<ChosenColumn> =
        all.iter().copied().filter(|place| is_picked(spec, topics, place)).collect();
    let open = match (&picked[..], &all[..]) {
        ([one], _) => return Ok(*one),
        (_, []) => return Err(complaint::no_samples(path, spec, &topics[longest], scanned)),
        ([], all) => all,
        (several, _) => several,
    };
    // None to pick of those that are all refused.
    if open.iter().all(|place| place.column(topics).heeded().is_err()) {
        open[0].column(topics).heeded()?;
    }
    let numbers = open.iter().map(|place| topics[place.topic].1[place.channel].0);
    let rows = open.iter().filter_map(|place| rows_of(topics, place));
    Err(complaint::several(spec, &topics[longest].0.name, (numbers.collect(), rows.collect())))
}

/// Where a field of a topic has samples.
fn with_samples(topics: &[Channels], topic: usize, field: usize) -> impl Iterator<Item = ChosenColumn> {
    let channels = topics[topic].1.iter().enumerate();
    let sensors = channels.flat_map(|(channel, (_, gathered))| {
        gathered.sensors.iter().enumerate().map(move |(sensor, told)| (channel, sensor, told))
    });
    let has_samples = move |told: &Sensor| told.columns.get(field).is_some_and(Column::is_there);
    let found = sensors.filter(move |(.., told)| has_samples(told));
    found.map(move |(channel, sensor, _)| ChosenColumn { topic, channel, sensor, field })
}

fn rows_of<'a>(topics: &'a [Channels], place: &ChosenColumn) -> Option<&'a RowsOf> {
    topics[place.topic].1[place.channel].1.sensors[place.sensor].rows.as_ref()
}

/// Whether a channel may mean these samples by the number of an MCAP channel and the sensor that it states.
fn is_picked(spec: &ChannelSpec, topics: &[Channels], place: &ChosenColumn) -> bool {
    let number = topics[place.topic].1[place.channel].0;
    let is_channel = match &spec.source {
        Source::TopicField { channel: Some(channel), .. } => *channel == number,
        _ => true,
    };
    let is_row = |wanted: &RowsOf| rows_of(topics, place).is_some_and(|rows| rows.is == wanted.is);
    is_channel && spec.rows.as_ref().is_none_or(is_row)
}

/// What was wrong with single messages of a channel.
fn message_issues(spec: &ChannelSpec, gathered: &Gathered, column: &Column) -> Vec<Finding> {
    let (messages, good, bad) = (gathered.messages, column.good_stamps, column.bad_stamps);
    let log_time = (bad > 0).then_some(McapFinding::LogTime { count: bad, messages, beside_good: good > 0 });
    let found = log_time.into_iter().chain(gathered.undecoded(None)).map(Finding::from);
    let drift = column.log_drift().filter(|_| spec.sample_rate_hz.is_none());
    found.chain(drift).map(|finding| finding.on(&spec.name)).collect()
}

#[cfg(test)]
#[path = "read_tests.rs"]
mod tests;
