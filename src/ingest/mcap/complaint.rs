//! Why a channel of the cask file cannot be had from an MCAP file, with what to do about it.

use super::path;
use super::scanned::Scanned;
use super::topic::{Gathered, Topic};
use crate::data::{ChannelSpec, Finding, McapFinding, Source, two_units};
use crate::ingest::error::{self, IngestError};
use crate::ingest::time_base::TimeBaseError;
use std::path::Path;

/// No topic of the file fits the source.
pub(super) fn no_topic(path: &Path, spec: &ChannelSpec, topics: &[String], scanned: &Scanned) -> IngestError {
    let fault = |problem: String, mend: String| error::source(path, &spec.name, problem, mend);
    let wanted = match &spec.source {
        Source::Path(text) | Source::TopicField { topic: text, .. } => text,
    };
    if topics.is_empty() {
        let problem = format!("the recording holds no topics, so none for {}", spec.source);
        return fault(problem, lost(scanned, "take the original from the logger again"));
    }
    if topics.iter().any(|topic| topic.trim_start_matches('/') == wanted.trim_start_matches('/')) {
        return fault(
            format!("the source {wanted} names a topic but no field of its messages"),
            format!(
                "write `source = \"{wanted}.FIELD\"`; `dropcheck inspect {}` lists the fields",
                path.display()
            ),
        );
    }
    // The part before the first dot of a path is most likely the topic that was meant.
    let meant = match &spec.source {
        Source::Path(text) => text.split('.').next().unwrap_or(text),
        Source::TopicField { topic, .. } => topic,
    };
    let mend = with_loss(scanned, error::near_names(path, meant, "topic", topics));
    fault(format!("the recording has no topic for the source {}", spec.source), mend)
}

/// The topic is there, and gave no samples.
pub(super) fn no_samples(
    path: &Path,
    spec: &ChannelSpec,
    (topic, gathered): &(Topic, Gathered),
    scanned: &Scanned,
) -> IngestError {
    let fault = |problem: String, mend: &str| error::source(path, &spec.name, problem, mend);
    let Topic { name, leaves, unreadable, .. } = topic;
    let Gathered { messages, malformed, first_problem, leaves: seen, .. } = gathered;
    let field = path::field_in(&spec.source, name).unwrap_or_default().to_string();
    if let Some(reason) = unreadable {
        return fault(
            format!("the topic {name} cannot be read: {reason}"),
            "convert the recording, or record it again, with one of these encodings",
        );
    }
    if *messages == 0 {
        let mend = lost(scanned, "check that the sensor was recorded");
        return fault(format!("the topic {name} has no messages"), &mend);
    }
    if let (true, Some(problem)) = (malformed == messages, first_problem) {
        return fault(
            format!("none of the {messages} messages of {name} decodes; the first: {problem}"),
            "check that the source names the samples, and that the topic's schema is the one its messages were written with",
        );
    }
    let there: Vec<String> = leaves.iter().chain(seen).map(|leaf| leaf.path.clone()).collect();
    if there.contains(&field) {
        return fault(
            format!("the field {field} holds no samples in any of the {messages} messages of {name}"),
            "check that the sensor was recorded",
        );
    }
    let mend = error::near_names(path, &field, "numeric field in this topic", &there);
    fault(format!("the messages of {name} have no numeric field {field}"), &mend)
}

/// The samples are there, and find no time base.
pub(super) fn no_base(path: &Path, spec: &ChannelSpec, problem: TimeBaseError) -> IngestError {
    let refusal = problem.refusal(
        "check the stamps of this topic; `sample_rate_hz` in this channel of the cask file overrides the recording's rate",
    );
    error::source(path, &spec.name, format!("{}: {}", spec.source, refusal.problem), refusal.remedy)
}

/// The unit changes between messages: a warning where the cask file states one.
pub(super) fn unit_change(
    path: &Path,
    spec: &ChannelSpec,
    [first, other]: [&str; 2],
) -> Result<Finding, IngestError> {
    if spec.unit.is_some() {
        let (first, other) = (first.to_owned(), other.to_owned());
        return Ok(Finding::from(McapFinding::TwoUnits { first, other, source: None }).on(&spec.name));
    }
    Err(error::source(
        path,
        &spec.name,
        format!("{}: {}", spec.source, two_units(first, other)),
        "cut the recording where it changes, or where only the word is wrong write `unit` in this channel of the cask file",
    ))
}

/// What the file has lost, where that may be why, else `mend`.
fn lost(scanned: &Scanned, mend: &str) -> String {
    match scanned.findings(None).first() {
        Some(loss) => {
            format!("{}; take the original from the logger again, or try `mcap recover`", loss.message)
        }
        None => mend.to_owned(),
    }
}

/// `mend`, and what the file has lost: the topic may have begun behind it.
fn with_loss(scanned: &Scanned, mend: String) -> String {
    match scanned.findings(None).first() {
        Some(loss) => format!("{mend}; mind that {}", loss.message),
        None => mend,
    }
}
