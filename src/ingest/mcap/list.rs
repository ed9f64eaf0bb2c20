//! An MCAP file to its listing: every numeric field of every topic, as reading would take it.

use super::column::{CLOCK_IS_SET_NS, Column, seconds_from};
use super::extent::Extent;
use super::plan::AskedField;
use super::scanned::Scanned;
use super::topic::{Channels, Gathered, Sensor, Topic};
use super::walk::walk;
use crate::data::{Finding, ListedChannel, Listing, McapFinding, RecordingFormat};
use crate::ingest::ReadRequest;
use crate::ingest::error::{self, IngestError};
use crate::ingest::time_base::TimeBaseError;
use std::collections::{BTreeMap, HashMap};

/// Lists what a file holds.
///
/// # Errors
/// Only where the file cannot be read at all.
pub(in crate::ingest) fn list(request: ReadRequest) -> Result<Listing, IngestError> {
    let path = request.file.path;
    let bytes = request.file.length().map_err(|source| error::io(path, &source))?;
    let walked = walk(request, None)?;
    let unlisted = walked.topics.unlisted();
    let counts = walked.scanned.counts.named(walked.topics.schemas.len(), walked.topics.by_channel.len());
    let (scanned, mut topics) = walked.finish();
    let mut issues = scanned.findings(None);
    for (topic, gathered) in each(&mut topics) {
        issues.extend(gathered.undecoded(Some(&topic.name)).map(Finding::from));
        for sensor in &mut gathered.sensors {
            for (field, column) in topic.plan.fields.iter().zip(&mut sensor.columns) {
                let source = format!("{}.{}", topic.name, field.asked.path);
                if let Err(refusal) = column.settle_ticks(&source, None) {
                    column.refuse(refusal);
                }
            }
        }
    }
    let columns = each(&mut topics).flat_map(|(_, gathered)| gathered.columns());
    let zero_ns = columns.filter_map(Column::span_ns).map(|(from, _)| from).min();
    issues.extend(unlisted);
    let mut channels = Vec::new();
    let mut writers: HashMap<String, usize> = HashMap::new();
    for (topic, gathered) in &topics {
        *writers.entry(topic.name.clone()).or_default() += gathered.len();
    }
    for (topic, gathered) in topics {
        let is_one = writers[&topic.name] == 1;
        for (number, gathered) in gathered {
            let number = Some(number).filter(|_| !is_one);
            listed((&topic, number), gathered, zero_ns, &mut channels, &mut issues);
        }
    }
    Ok(Listing {
        schema: "dropcheck.inspect/1",
        recording: path.display().to_string(),
        bytes,
        format: RecordingFormat::Mcap,
        counts,
        facts: facts(&scanned, zero_ns),
        channels,
        issues,
    })
}

fn facts(scanned: &Scanned, zero_ns: Option<i64>) -> BTreeMap<String, String> {
    let is_set = |ns: &i64| *ns >= CLOCK_IS_SET_NS;
    let start = zero_ns.filter(is_set).and_then(|ns| jiff::Timestamp::from_nanosecond(ns.into()).ok());
    let compressions: Vec<&str> = scanned
        .compressions
        .iter()
        .map(|name| if name.is_empty() { "none" } else { name.as_str() })
        .collect();
    [
        ("profile", scanned.profile.clone()),
        ("library", scanned.library.clone()),
        ("compression", compressions.join(", ")),
        ("start", start.map(|start| start.to_string()).unwrap_or_default()),
    ]
    .into_iter()
    .filter(|(_, value)| !value.is_empty())
    .map(|(name, value)| (name.to_owned(), value))
    .collect()
}

/// Each channel with its topic.
fn each(topics: &mut [Channels]) -> impl Iterator<Item = (&Topic, &mut Gathered)> {
    topics.iter_mut().flat_map(|(topic, channels)| {
        let topic = &*topic;
        channels.iter_mut().map(move |(_, gathered)| (topic, gathered))
    })
}

/// Adds a line for each field of a topic and each sensor, or one that says why there is none, and what
/// reading would refuse; `number` is that of the channel, where several write on the topic.
fn listed(
    (topic, number): (&Topic, Option<u16>),
    gathered: Gathered,
    zero_ns: Option<i64>,
    channels: &mut Vec<ListedChannel>,
    issues: &mut Vec<Finding>,
) {
    let Gathered { messages, mut sensors, .. } = gathered;
    if topic.plan.fields.is_empty() {
        let none = || (messages > 0).then(|| "its messages hold no numbers".to_owned());
        channels.push(ListedChannel {
            messages: Some(messages),
            encoding: topic.encoding.clone(),
            unreadable: topic.unreadable.clone().or_else(none),
            ..ListedChannel::named(&topic.name, "topic")
        });
        return;
    }
    if sensors.is_empty() {
        sensors.push(Sensor { rows: None, columns: Vec::new() });
    }
    let has_several = sensors.len() > 1;
    let (mut said_units, mut said) = (false, Vec::new());
    let columns = sensors.into_iter().flat_map(|Sensor { rows, mut columns }| {
        columns.resize_with(topic.plan.fields.len(), || Column::new(true));
        let fields = topic.plan.fields.iter().zip(columns);
        fields.map(move |(field, column)| (rows.clone().filter(|_| has_several), field, column))
    });
    for (rows, field, column) in columns {
        let AskedField { path, is_array, .. } = &field.asked;
        let Extent { samples, range, is_without_times, .. } = column.extent.clone().unwrap_or_default();
        let source = match number {
            Some(number) => {
                format!("{{ topic = {:?}, field = \"{path}\", channel = {number} }}", topic.name)
            }
            None => format!("{}.{path}", topic.name),
        };
        if let Some(units) = column.unit_change()
            && !said_units
        {
            let [first, other] = units.map(str::to_owned);
            issues.push(McapFinding::TwoUnits { first, other, source: Some(source.clone()) }.into());
            said_units = true;
        }
        if let Some(drift) = column.log_drift().filter(|drift| !said.contains(&drift.message)) {
            said.push(drift.message.clone());
            issues.push(drift.on(&source));
        }
        let mut channel = ListedChannel {
            rows,
            samples: Some(samples as u64),
            messages: Some(messages),
            unit: topic.unit(field, &column),
            range,
            encoding: topic.encoding.clone(),
            ..ListedChannel::named(&source, if *is_array { "array" } else { "number" })
        };
        let untimed = if is_without_times {
            Some(
                "its times take more memory than is allowed, and tell no rate here: allow more with \
                  --max-memory"
                    .into(),
            )
        } else {
            timed(&mut channel, column, zero_ns).err().map(|problem| problem.to_string())
        };
        channels.push(channel);
        // What holds for one field of a topic mostly holds for all.
        if let Some(problem) = untimed.filter(|problem| !said.contains(problem)) {
            said.push(problem.clone());
            issues.push(McapFinding::NoTimes { source, problem }.into());
        }
    }
}

/// Adds the times that reading would take.
///
/// # Errors
/// Why it would refuse them; too few samples are no fault of a recording.
fn timed(channel: &mut ListedChannel, column: Column, zero_ns: Option<i64>) -> Result<(), TimeBaseError> {
    column.heeded()?;
    let (Some((first_ns, _)), Some(zero_ns)) = (column.span_ns(), zero_ns) else { return Ok(()) };
    channel.start_s = Some(seconds_from(first_ns, zero_ns));
    match column.list_times(zero_ns, channel) {
        Err(TimeBaseError::TooFew { .. }) => Ok(()),
        listed => listed,
    }
}

#[cfg(test)]
#[path = "list_tests.rs"]
mod tests;
