//! Why a channel of the cask file cannot be had from an MCAP file, with what to do about it.

use super::path;
use super::scanned::Scanned;
use super::topic::{Gathered, Topic, TopicChannel};
use crate::data::{ChannelSpec, Finding, McapFinding, RowsOf, Source, two_units};
use crate::ingest::error;
use crate::ingest::refusal::Refusal;
use std::collections::BTreeSet;
use std::path::Path;

/// No topic of the file fits the source.
pub(super) fn no_topic(path: &Path, spec: &ChannelSpec, topics: &[String], scanned: &Scanned) -> Refusal {
    let (wanted, meant) = match &spec.source {
        // The part before the first dot is most likely the topic that was meant.
        Source::Path(text) => (text, text.split('.').next().unwrap_or(text)),
        Source::TopicField { topic, .. } => (topic, topic.as_str()),
    };
    if topics.is_empty() {
        let problem = format!("the recording holds no topics, so none for {}", spec.source);
        return Refusal::new(problem, with_loss(scanned, "name the recording that holds the samples"));
    }
    if topics.iter().any(|topic| topic.trim_start_matches('/') == wanted.trim_start_matches('/')) {
        return Refusal::new(
            format!("the source {wanted} names a topic but no field of its messages"),
            format!(
                "write `source = \"{wanted}.FIELD\"`; `dropcheck inspect {}` lists the fields",
                path.display()
            ),
        );
    }
    let mend = with_loss(scanned, &error::near_names(path, meant, "topic", topics));
    Refusal::new(format!("the recording has no topic for the source {}", spec.source), mend)
}

/// Several channels or sensors gave what the source names, by their numbers and rows, or none the ones that
/// are asked for.
pub(super) fn several(spec: &ChannelSpec, topic: &str, numbers: &BTreeSet<u16>, rows: &[&RowsOf]) -> Refusal {
    let source = &spec.source;
    let field = path::field_in(source, topic).unwrap_or_default();
    let asked = match (source, &spec.rows) {
        (_, Some(rows)) => format!("{source} has no messages {rows} alone"),
        (Source::TopicField { channel: Some(_), .. }, _) => format!("there are no samples of {source} alone"),
        _ => format!("{source} holds the samples of several sensors, which are never one signal"),
    };
    let channels: Vec<String> = numbers.iter().map(|number| format!("channel = {number}")).collect();
    let channels = error::handful(&channels);
    if numbers.len() > 1 {
        return Refusal::new(
            format!("{asked}: {} MCAP channels write on the topic {topic}", numbers.len()),
            format!(
                "name one: source = {{ topic = {topic:?}, field = \"{field}\", channel = … }} with one of \
                 {channels}"
            ),
        );
    }
    let rows: Vec<String> = rows.iter().map(ToString::to_string).collect();
    let mend = match rows[..] {
        [] => format!("its messages name no sensor: take `where` out, or name one of {channels}"),
        _ => format!("name one in this [[channel]]: {}", error::handful(&rows)),
    };
    Refusal::new(asked, mend)
}

/// The field that is named as the time is in no message.
pub(super) fn no_named_time(spec: &ChannelSpec, time: &str) -> Refusal {
    Refusal::new(
        format!("no message of {} holds a time that rises in the field {time:?}", spec.source),
        "name the field of its messages that holds their time, `time = \"log_time\"` for the time of \
         logging, or take `time` out",
    )
}

/// The topic is there, and gave no samples.
pub(super) fn no_samples(
    path: &Path,
    spec: &ChannelSpec,
    TopicChannel { topic, gathered, .. }: &TopicChannel,
    scanned: &Scanned,
) -> Refusal {
    let Topic { name, leaves, unreadable, .. } = &**topic;
    let Gathered { messages, malformed, first_problem, leaves: seen, .. } = gathered;
    let field = path::field_in(&spec.source, name).unwrap_or_default().to_string();
    if let Some(reason) = unreadable {
        return Refusal::new(
            format!("the topic {name} cannot be read: {reason}"),
            "convert the recording, or record it again, in a form that is read",
        );
    }
    if *messages == 0 {
        let mend = with_loss(scanned, "check that the sensor was recorded");
        return Refusal::new(format!("the topic {name} has no messages"), &mend);
    }
    if let (true, Some(problem)) = (malformed == messages, first_problem) {
        return Refusal::new(
            format!("none of the {messages} messages of {name} decodes; the first: {problem}"),
            "check that the source names the samples, and that the topic's schema is the one its messages \
             were written with",
        );
    }
    let mut there: Vec<String> = Vec::new();
    for leaf in leaves.iter().chain(seen).filter(|leaf| leaf.is_signal) {
        there.extend((!there.contains(&leaf.path)).then(|| leaf.path.clone()));
    }
    if there.contains(&field) {
        return Refusal::new(
            format!("the field {field} holds no samples in any of the {messages} messages of {name}"),
            "check that the sensor was recorded",
        );
    }
    let mend = error::near_names(path, &field, "numeric field in this topic", &there);
    Refusal::new(format!("the messages of {name} have no numeric field {field}"), &mend)
}

/// The unit changes between messages: a warning where the cask file states one.
pub(super) fn unit_change(spec: &ChannelSpec, [first, other]: [&str; 2]) -> Result<Finding, Refusal> {
    if spec.unit.is_some() {
        let (first, other) = (first.to_owned(), other.to_owned());
        return Ok(Finding::from(McapFinding::TwoUnits { first, other, source: None }).tag(&spec.name));
    }
    Err(Refusal::new(
        format!("{}: {}", spec.source, two_units(first, other)),
        "cut the recording where it changes, or where only the word is wrong write `unit` in this channel of \
         the cask file",
    ))
}

/// `mend`, and what the file has lost: the topic may have begun behind it.
fn with_loss(scanned: &Scanned, mend: &str) -> String {
    match scanned.findings(None).first() {
        Some(loss) => format!(
            "{mend}; mind that {}: take the original from the logger again, or try `mcap recover`",
            loss.message
        ),
        None => mend.to_owned(),
    }
}
