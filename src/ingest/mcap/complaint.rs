//! Why a channel of the cask file cannot be had from an MCAP file, with what to do about it.

use super::column::ColumnError;
use super::path;
use super::scanned::Scanned;
use super::topic::{Gathered, Topic};
use crate::data::{ChannelSpec, Source};
use crate::ingest::error::{self, IngestError};
use crate::ingest::stated_rate::shown_hz;
use std::path::Path;

/// No topic of the file fits the source.
pub(super) fn no_topic(path: &Path, spec: &ChannelSpec, topics: &[String], scanned: &Scanned) -> IngestError {
    let wanted = match &spec.source {
        Source::Path(text) => text.clone(),
        Source::TopicField { topic, .. } => topic.clone(),
    };
    if topics.is_empty() {
        let problem = format!("the recording holds no topics, so none for {}", spec.source);
        return error::source(
            path,
            &spec.name,
            problem,
            lost(scanned, "take the original from the logger again"),
        );
    }
    if topics.iter().any(|topic| topic.trim_start_matches('/') == wanted.trim_start_matches('/')) {
        return error::source(
            path,
            &spec.name,
            format!("the source {wanted} names a topic but no field of its messages"),
            format!(
                "write `source = \"{wanted}.FIELD\"`; `dropcheck inspect {}` lists the fields",
                path.display()
            ),
        );
    }
    // The part before the first dot of a path is most likely the topic that was meant.
    let meant = match &spec.source {
        Source::Path(text) => text.split('.').next().unwrap_or(text).to_owned(),
        Source::TopicField { topic, .. } => topic.clone(),
    };
    error::source(
        path,
        &spec.name,
        format!("the recording has no topic for the source {}", spec.source),
        with_loss(scanned, error::near_names(path, &meant, "topic", topics)),
    )
}

/// The topic is there, and gave no samples.
pub(super) fn no_samples(
    path: &Path,
    spec: &ChannelSpec,
    (topic, gathered): &(Topic, Gathered),
    scanned: &Scanned,
) -> IngestError {
    let Topic { name, leaves, unreadable, .. } = topic;
    let Gathered { messages, malformed, first_problem, leaves: seen, .. } = gathered;
    let field = path::field_in(&spec.source, name).unwrap_or_default().to_string();
    if let Some(reason) = unreadable {
        return error::source(
            path,
            &spec.name,
            format!("the topic {name} cannot be read: {reason}"),
            "convert the recording, or record it again, with one of these encodings",
        );
    }
    if *messages == 0 {
        let problem = format!("the topic {name} has no messages");
        return error::source(path, &spec.name, problem, lost(scanned, "check that the sensor was recorded"));
    }
    if let (true, Some(problem)) = (malformed == messages, first_problem) {
        return error::source(
            path,
            &spec.name,
            format!("none of the {messages} messages of {name} decodes; the first: {problem}"),
            "check that the source names the samples, and that the topic's schema is the one its messages were written with",
        );
    }
    let there: Vec<String> = leaves.iter().chain(seen).map(|leaf| leaf.path.clone()).collect();
    if there.contains(&field) {
        return error::source(
            path,
            &spec.name,
            format!("the field {field} holds no samples in any of the {messages} messages of {name}"),
            "check that the sensor was recorded",
        );
    }
    error::source(
        path,
        &spec.name,
        format!("the messages of {name} have no numeric field {field}"),
        error::near_names(path, &field, "numeric field in this topic", &there),
    )
}

/// The samples are there, and find no time base.
pub(super) fn no_base(path: &Path, spec: &ChannelSpec, problem: &ColumnError) -> IngestError {
    let mend = match problem {
        ColumnError::Contradiction { stated_hz, own_hz, shared: None } => {
            let hz = [stated_hz, own_hz].map(|hz| shown_hz(*hz));
            let mend = format!(
                "write the right one into this channel of the cask file: sample_rate_hz = {} or sample_rate_hz = {}",
                hz[0], hz[1]
            );
            return error::source(path, &spec.name, format!("{}: {problem}", spec.source), mend);
        }
        ColumnError::StatedRate(_) => {
            "write the true `sample_rate_hz` in this channel of the cask file: it overrides the recording"
        }
        ColumnError::Contradiction { .. } | ColumnError::SharedStamps(_) => {
            "write `sample_rate_hz` in this channel of the cask file, and have the recorder stamp finer"
        }
        ColumnError::NoRate => "write `sample_rate_hz` in this channel of the cask file",
        ColumnError::TimeBase(_) => {
            "check the stamps of this topic; `sample_rate_hz` in this channel of the cask file overrides the recording's rate"
        }
    };
    error::source(path, &spec.name, format!("{}: {problem}", spec.source), mend)
}

/// What the file has lost, where that may be why, else `mend`.
fn lost(scanned: &Scanned, mend: &str) -> String {
    match scanned.issues().first() {
        Some(issue) => {
            format!("{}; take the original from the logger again, or try `mcap recover`", issue.message)
        }
        None => mend.to_owned(),
    }
}

/// `mend`, and what the file has lost: the topic may have begun behind it.
fn with_loss(scanned: &Scanned, mend: String) -> String {
    match scanned.issues().first() {
        Some(issue) => format!("{mend}; mind that {}", issue.message),
        None => mend,
    }
}
