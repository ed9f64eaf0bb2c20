//! The channels that take no part in the motion to what each reads, beside a result that rests on none of
//! them.

use super::rotation;
use crate::data::{Analysis, CaskFile, Channel, Finding, OtherSummary, Recording};
use crate::{condition, judge, motion};
use rayon::prelude::*;

/// Adds to the result what the other channels read, and what was found on them.
pub(super) fn add(recording: &Recording, file: &CaskFile, found: &mut Analysis) {
    let result = &found.result;
    let (events, issues) = (result.events, &recording.others.issues);
    let told = |channel: &Channel| {
        let mut told = condition::read_other(channel, &events);
        told.strongest_line = motion::other_curve(channel, &events).as_ref().and_then(motion::strongest_line);
        let spec = file.others.iter().find(|spec| spec.read.name == channel.name);
        told.sensor = spec.map(|spec| spec.read.sensor.clone()).unwrap_or_default();
        let mut findings = judge::judge_other(channel, issues, &told, &events);
        findings.extend(rotation::judged(channel, recording, file, result));
        told.findings = findings.iter().map(|finding| finding.code).collect();
        told.findings.sort_unstable();
        told.findings.dedup();
        (told, findings)
    };
    let (told, findings): (Vec<OtherSummary>, Vec<Vec<Finding>>) =
        recording.others.channels.par_iter().map(told).unzip();
    found.result.other_channels = told;
    found.result.quality.extend(findings.into_iter().flatten());
}
