//! An MCAP file to its listing: every numeric field of every topic, as reading would take it.

use super::column::{CLOCK_IS_SET_NS, Column, seconds_from};
use super::numbers::Extent;
use super::plan::AskedField;
use super::scanned::Scanned;
use super::topic::{TopicChannel, TopicSeries};
use super::walk::Walk;
use crate::data::{Finding, ListedChannel, Listing, McapFinding, RecordingFormat, Source};
use crate::ingest::ReadRequest;
use crate::ingest::error::{self, IngestError};
use crate::ingest::refusal::Refusal;
use crate::ingest::time_base::Uniform;
use std::collections::{BTreeMap, HashMap};

/// Lists what a file holds.
///
/// # Errors
/// Only where the file cannot be read at all.
pub(crate) fn list(request: ReadRequest) -> Result<Listing, IngestError> {
    let path = request.file.path;
    let bytes = request.file.length().map_err(|source| error::io(path, &source))?;
    let walked = Walk::of(request, None)?;
    let unlisted = walked.topics.unlisted();
    let counts = walked.scanned.counts.named(walked.topics.schemas.len(), walked.topics.by_channel.len());
    let (scanned, mut series) = walked.finish();
    let mut issues = scanned.findings(None);
    let mut writers: HashMap<String, usize> = HashMap::new();
    for of_channel in series.chunk_by(TopicSeries::is_beside) {
        let name = &of_channel[0].topic().name;
        issues.extend(of_channel[0].channel.gathered.undecoded(Some(name)).map(Finding::from));
        *writers.entry(name.clone()).or_default() += 1;
    }
    for one in &mut series {
        let field = one.field.as_ref().map(|field| field.asked.path.to_string());
        let source = format!("{}.{}", one.topic().name, field.unwrap_or_default());
        if let Err(refusal) = one.column.settle_ticks(&source, None) {
            one.column.refuse(refusal);
        }
    }
    let zero_ns = series.iter().filter_map(|one| one.column.span_ns()).map(|(from, _)| from).min();
    issues.extend(unlisted);
    let (facts, empty) = (facts(&scanned, zero_ns), Listing::new(path, bytes, RecordingFormat::Mcap));
    let mut listing = Listing { counts, facts, issues, ..empty };
    for of_channel in series.chunk_by_mut(TopicSeries::is_beside) {
        let is_alone = writers[&of_channel[0].topic().name] == 1;
        add(&mut listing, of_channel, is_alone, zero_ns);
    }
    Ok(listing)
}

fn facts(scanned: &Scanned, zero_ns: Option<i64>) -> BTreeMap<String, String> {
    let is_set = |ns: &i64| *ns >= CLOCK_IS_SET_NS;
    let start = zero_ns.filter(is_set).and_then(|ns| jiff::Timestamp::from_nanosecond(ns.into()).ok());
    let compressions: Vec<&str> = scanned.compressions.iter().map(String::as_str).collect();
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

/// Adds a line for each field of a channel and each sensor, or one that says why there is none, and what
/// reading would refuse; `is_alone` where no other writes on its topic.
fn add(listing: &mut Listing, of_channel: &mut [TopicSeries], is_alone: bool, zero_ns: Option<i64>) {
    let channel = of_channel[0].channel.clone();
    let TopicChannel { topic, number, gathered } = &*channel;
    let (messages, issues) = (gathered.messages, &mut listing.issues);
    let has_sensors = of_channel.iter().any(|one| one.rows != of_channel[0].rows);
    let (mut said_units, mut said) = (false, Vec::new());
    for one in of_channel {
        let unit = one.unit();
        let (column, encoding) = (std::mem::take(&mut one.column), topic.encoding.clone());
        let Some(AskedField { path, is_array, .. }) = one.field.as_ref().map(|field| &field.asked) else {
            let none = || (messages > 0).then(|| "its messages hold no numbers".to_owned());
            listing.channels.push(ListedChannel {
                messages: Some(messages),
                encoding,
                unreadable: topic.unreadable.clone().or_else(none),
                ..ListedChannel::new(&topic.name, "topic")
            });
            continue;
        };
        let Extent { samples, range } = column.extent();
        let (name, field) = (topic.name.clone(), path.to_string());
        let (source, place) = if is_alone {
            (format!("{name}.{field}"), None)
        } else {
            let source = format!("{{ topic = {name:?}, field = \"{field}\", channel = {number} }}");
            (source, Some(Source::TopicField { topic: name, field, channel: Some(*number) }))
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
            issues.push(drift.tag(&source));
        }
        let mut channel = ListedChannel {
            place,
            rows: one.rows.clone().filter(|_| has_sensors),
            samples: Some(samples as u64),
            messages: Some(messages),
            unit,
            range,
            encoding,
            ..ListedChannel::new(&source, if *is_array { "array" } else { "number" })
        };
        let untimed = timed(&mut channel, column, zero_ns).err().map(|refusal| refusal.beside(&source));
        listing.channels.push(channel);
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
fn timed(channel: &mut ListedChannel, column: Column, zero_ns: Option<i64>) -> Result<(), Refusal> {
    if column.forgotten.is_some() {
        let problem = "its times take more memory than is allowed, and tell no rate here";
        return Err(Refusal::new(problem, "allow more with --max-memory"));
    }
    column.heeded()?;
    let (Some((first_ns, _)), Some(zero_ns)) = (column.span_ns(), zero_ns) else { return Ok(()) };
    channel.start_s = Some(seconds_from(first_ns, zero_ns));
    if channel.samples >= Some(2) {
        // The first sample stands where its base begins, whenever its message was stamped.
        let uniform = Uniform { span_s: None, ..column.uniform(zero_ns, None)? };
        uniform.list(channel);
        channel.gaps = Some(uniform.gaps.len() as u64);
    }
    Ok(())
}

#[cfg(test)]
#[path = "list_tests.rs"]
mod tests;
