//! An MCAP file and a cask file to raw channels: only the topics that are named are decoded.

use super::column::{CLOCK_IS_SET_NS, seconds_from};
use super::complaint;
use super::path;
use super::scanned::Scanned;
use super::topic::TopicSeries;
use super::topics::LOG_TIME;
use super::walk::Walk;
use crate::data::{CaskFile, ChannelSpec, Finding, McapFinding, RowsOf, Source};
use crate::ingest::error::{self, IngestError};
use crate::ingest::refusal::Refusal;
use crate::ingest::{RawChannel, RawRecording, ReadRequest};
use crate::numerics::as_f64;
use std::path::Path;

/// Reads the channels that `cask_file` names.
///
/// # Errors
/// A topic or field that is not there, or gives no samples on a time base.
pub(crate) fn read(request: ReadRequest, cask_file: &CaskFile) -> Result<RawRecording, IngestError> {
    let path = request.file.path;
    let specs = &cask_file.channels;
    let (scanned, mut series) = Walk::of(request, Some(cask_file))?.finish();
    let refused = |spec: &ChannelSpec, refusal| error::of_channel(path, &spec.name, refusal);
    let one =
        |spec: &ChannelSpec| chosen(path, spec, &series, &scanned).map_err(|refusal| refused(spec, refusal));
    let chosen: Vec<usize> = specs.iter().map(one).collect::<Result<_, _>>()?;
    for (spec, &at) in specs.iter().zip(&chosen) {
        let column = &mut series[at].column;
        let settled = column.settle_ticks(&spec.source.to_string(), spec.sample_rate_hz);
        settled.map_err(|refusal| refused(spec, refusal))?;
        if let Some(time) =
            cask_file.time_source(spec).filter(|time| *time != LOG_TIME && column.good_stamps == 0)
        {
            return Err(refused(spec, complaint::no_named_time(spec, time)));
        }
    }
    let others_messages = |one: &TopicSeries| {
        let others = scanned.counts.messages().saturating_sub(one.channel.gathered.messages);
        as_f64(usize::try_from(others).unwrap_or(usize::MAX))
    };
    let spans = || chosen.iter().filter_map(|&at| series[at].column.span_ns());
    let zero_ns = spans().map(|(from, _)| from).min().unwrap_or(0);
    let last_ns = spans().map(|(_, to)| to).max().unwrap_or(0);
    let mut issues = scanned.findings(Some(seconds_from(last_ns, zero_ns)));
    let mut channels = Vec::with_capacity(chosen.len());
    for (position, (spec, &at)) in specs.iter().zip(&chosen).enumerate() {
        let of_channel = &mut series[at];
        issues.extend(message_issues(spec, of_channel));
        if let Some(change) = of_channel.column.unit_change() {
            issues.push(complaint::unit_change(spec, change).map_err(|refusal| refused(spec, refusal))?);
        }
        let is_named = cask_file.time_source(spec).is_some();
        let counted = of_channel.column.held_against_counter(is_named, others_messages(of_channel));
        issues.extend(counted.map_err(|refusal| refused(spec, refusal))?.map(|found| found.tag(&spec.name)));
        let mut factors = of_channel.column.factors();
        factors.extend(of_channel.channel.gathered.factors.iter().chain(&scanned.factors).cloned());
        let unit = of_channel.unit();
        // A second channel on the same field gets its own copy.
        let column = if chosen[position + 1..].contains(&at) {
            of_channel.column.clone()
        } else {
            std::mem::take(&mut of_channel.column)
        };
        let uniform = column.uniform(zero_ns, spec.sample_rate_hz);
        let uniform = uniform.map_err(|refusal| refused(spec, refusal.at(&spec.source.to_string())))?;
        channels.push(RawChannel { uniform, unit, factors });
    }
    Ok(RawRecording { channels, zero_unix_ns: (zero_ns >= CLOCK_IS_SET_NS).then_some(zero_ns), issues })
}

/// The place of the samples that a channel means: of the longest topic that gave some.
fn chosen(
    path: &Path,
    spec: &ChannelSpec,
    series: &[TopicSeries],
    scanned: &Scanned,
) -> Result<usize, Refusal> {
    let name_bytes = |at: &usize| series[*at].topic().name.len();
    // A topic that cannot be read has no field to differ.
    let fits = |one: &TopicSeries| {
        let path = path::field_in(&spec.source, &one.topic().name);
        path.is_some_and(|path| one.field.as_ref().is_none_or(|field| field.asked.path == path))
    };
    let mut all: Vec<usize> = (0..series.len()).filter(|&at| fits(&series[at])).collect();
    let Some(longest) = all.iter().rev().copied().max_by_key(name_bytes) else {
        let mut names: Vec<String> = series.iter().map(|one| one.topic().name.clone()).collect();
        names.dedup();
        return Err(complaint::no_topic(path, spec, &names, scanned));
    };
    all.retain(|&at| series[at].column.is_there());
    let most = all.iter().map(name_bytes).max();
    all.retain(|at| Some(name_bytes(at)) == most);
    let picked: Vec<usize> = all.iter().copied().filter(|&at| is_picked(spec, &series[at])).collect();
    let open = match (&picked[..], &all[..]) {
        ([one], _) => return Ok(*one),
        (_, []) => return Err(complaint::no_samples(path, spec, &series[longest].channel, scanned)),
        ([], all) => all,
        (several, _) => several,
    };
    // None to pick of those that are all refused.
    if open.iter().all(|&at| series[at].column.heeded().is_err()) {
        series[open[0]].column.heeded()?;
    }
    let numbers = open.iter().map(|&at| series[at].channel.number).collect();
    let rows: Vec<_> = open.iter().filter_map(|&at| series[at].rows.as_ref()).collect();
    Err(complaint::several(spec, &series[longest].topic().name, &numbers, &rows))
}

/// Whether a channel may mean these samples by the number of an MCAP channel and the sensor that it states.
fn is_picked(spec: &ChannelSpec, series: &TopicSeries) -> bool {
    let is_channel = match &spec.source {
        Source::TopicField { channel: Some(channel), .. } => *channel == series.channel.number,
        _ => true,
    };
    let is_row = |wanted: &RowsOf| series.rows.as_ref().is_some_and(|rows| rows.is == wanted.is);
    is_channel && spec.rows.as_ref().is_none_or(is_row)
}

/// What was wrong with single messages of a channel.
fn message_issues(spec: &ChannelSpec, TopicSeries { channel, column, .. }: &TopicSeries) -> Vec<Finding> {
    let (messages, good, bad) = (channel.gathered.messages, column.good_stamps, column.bad_stamps);
    let log_time = (bad > 0).then_some(McapFinding::LogTime { count: bad, messages, beside_good: good > 0 });
    let found = log_time.into_iter().chain(channel.gathered.undecoded(None)).map(Finding::from);
    let drift = column.log_drift().filter(|_| spec.sample_rate_hz.is_none());
    found.chain(drift).map(|finding| finding.tag(&spec.name)).collect()
}

#[cfg(test)]
#[path = "read_tests.rs"]
mod tests;
