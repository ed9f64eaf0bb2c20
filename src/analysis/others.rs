//! Summarises the channels that take no part in the motion; the result depends on none of them.

use super::rotation;
use crate::data::{Analysis, CaskFile, Channel, Finding, OtherSummary, Recording};
use crate::{condition, judge, motion};
use rayon::prelude::*;

/// Adds the summaries of the other channels, and the findings on them, to the result.
pub(super) fn add(recording: &Recording, file: &CaskFile, analysis: &mut Analysis) {
    let result = &analysis.result;
    let (events, issues) = (result.events, &recording.others.issues);
    let summarise = |channel: &Channel| {
        let mut summary = condition::read_other(channel, &events);
        summary.strongest_line =
            motion::other_curve(channel, &events).as_ref().and_then(motion::strongest_line);
        let spec = file.others.iter().find(|spec| spec.read.name == channel.name);
        summary.sensor = spec.map(|spec| spec.read.sensor.clone()).unwrap_or_default();
        let mut findings = judge::judge_other(channel, issues, &summary, &events);
        findings.extend(rotation::judge_sensor(channel, recording, file, result));
        summary.findings = findings.iter().map(|finding| finding.code).collect();
        summary.findings.sort_unstable();
        summary.findings.dedup();
        (summary, findings)
    };
    let (summaries, findings): (Vec<OtherSummary>, Vec<Vec<Finding>>) =
        recording.others.channels.par_iter().map(summarise).unzip();
    analysis.result.other_channels = summaries;
    analysis.result.quality.extend(findings.into_iter().flatten());
}
