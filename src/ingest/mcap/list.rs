//! An MCAP file to its listing: every numeric field of every topic, as reading would take it.

use super::column::{CLOCK_IS_SET_NS, Column, Extent, seconds_from};
use super::path::source_text;
use super::scan::scan;
use super::scanned::Scanned;
use super::topic::{Field, Gathered, Topic};
use super::topics::Asked;
use crate::data::{Issue, IssueCode, ListedChannel, Listing, RecordingFormat, Severity};
use crate::ingest::error::{self, IngestError};
use crate::ingest::{Limits, Progress};
use std::collections::BTreeMap;
use std::path::Path;

/// Lists what the file at `path` holds.
///
/// # Errors
/// Only where the file cannot be read at all.
pub(in crate::ingest) fn list(
    path: &Path,
    limits: Limits,
    progress: Progress,
) -> Result<Listing, IngestError> {
    let bytes = std::fs::metadata(path).map_err(|source| error::io(path, source))?.len();
    let (scanned, topics) = scan(path, limits, Asked::Everything, progress)?;
    let unlisted = topics.unlisted();
    let mut topics = topics.finish();
    topics.iter_mut().for_each(|(_, gathered)| gathered.settle_clocks());
    let columns = topics.iter().flat_map(|(_, gathered)| &gathered.columns);
    let zero_ns = columns.filter_map(Column::span_ns).map(|(from, _)| from).min();
    let mut issues = scanned.issues();
    issues.extend(topics.iter().filter_map(|(topic, gathered)| undecoded(topic, gathered)));
    issues.extend(unlisted);
    let channels = topics.into_iter().flat_map(|(topic, gathered)| listed(&topic, gathered, zero_ns));
    Ok(Listing {
        schema: "dropcheck.inspect/1",
        recording: path.display().to_string(),
        bytes,
        format: RecordingFormat::Mcap,
        counts: scanned.counts.named(),
        facts: facts(&scanned, zero_ns),
        channels: channels.collect(),
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

fn undecoded(topic: &Topic, gathered: &Gathered) -> Option<Issue> {
    let Gathered { messages, malformed, first_problem, .. } = gathered;
    first_problem.as_ref().map(|problem| {
        let name = &topic.name;
        let message =
            format!("{malformed} of {messages} messages of {name} do not decode; the first: {problem}");
        Issue::new(IssueCode::Damaged, Severity::Warning, message)
    })
}

/// A line for each field of a topic, or one that says why there is none.
fn listed(topic: &Topic, gathered: Gathered, zero_ns: Option<i64>) -> Vec<ListedChannel> {
    let Gathered { messages, mut columns, .. } = gathered;
    if topic.fields.is_empty() {
        let none = || (messages > 0).then(|| "its messages hold no numbers".to_owned());
        return vec![ListedChannel {
            messages: Some(messages),
            encoding: topic.encoding.clone(),
            unreadable: topic.unreadable.clone().or_else(none),
            ..ListedChannel::named(&topic.name, "topic")
        }];
    }
    columns.resize_with(topic.fields.len(), || Column::new(true));
    let one = |(field, column): (&Field, Column)| {
        let Extent { samples, range } = column.extent.unwrap_or_default();
        let listed = ListedChannel {
            samples: Some(samples),
            messages: Some(messages),
            unit: column.units.first().or(field.unit).map(str::to_owned),
            range,
            encoding: topic.encoding.clone(),
            ..ListedChannel::named(
                &source_text(&topic.name, &field.path.to_string()),
                if field.is_array { "array" } else { "number" },
            )
        };
        timed(listed, column, zero_ns)
    };
    topic.fields.iter().zip(columns).map(one).collect()
}

/// With the times that reading would take.
fn timed(listed: ListedChannel, column: Column, zero_ns: Option<i64>) -> ListedChannel {
    let (Some((first_ns, _)), Some(zero_ns)) = (column.span_ns(), zero_ns) else { return listed };
    let Ok(timing) = column.timing(zero_ns) else {
        return ListedChannel { start_s: Some(seconds_from(first_ns, zero_ns)), ..listed };
    };
    ListedChannel {
        sample_rate_hz: Some(timing.sample_rate_hz),
        start_s: Some(timing.start_s),
        duration_s: Some(as_f64(timing.count - 1) / timing.sample_rate_hz),
        gaps: Some(timing.gaps as u64),
        ..listed
    }
}

#[allow(clippy::cast_precision_loss, reason = "counts of samples stay below 2^53")]
fn as_f64(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
#[path = "list_tests.rs"]
mod tests;
