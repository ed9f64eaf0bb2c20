//! What the channels beside the accelerometers read to what speaks against each of them.

use super::silent::SILENT;
use super::weigh_by_distance;
use crate::data::{
    AtRest, Channel, ChannelFinding, Effect, Events, Finding, MeasuredRotation, OtherSummary, RestFinding,
    RotationCause, Severity,
};
use std::cmp::Reverse;

/// Noise that deserves a note, over the largest deviation from rest: ± 10 % of that.
const NOTABLE_NOISE: f64 = 0.05;

/// Rotation by the first impact below which a sensor is not judged by it, rad/s: a tenth of a slap-down's.
const LEAST_RAD_S: f64 = 0.3;
/// A share of the rotation within this of a cause's is explained by it, a smaller one than the smallest
/// cause's by none.
const WITHIN: f64 = 0.2;
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// The findings on one channel, of which `issues` are those of reading all: notes, and warnings where it
/// clips or lacks samples about the impacts.
///
/// They change no number of the motion.
pub fn judge_other(
    channel: &Channel,
    issues: &[Finding],
    told: &OtherSummary,
    events: &Events,
) -> Vec<Finding> {
    let is_own = |found: &&Finding| found.channel.as_ref() == Some(&channel.name);
    let mut findings: Vec<Finding> = issues.iter().filter(is_own).cloned().collect();
    weigh_by_distance(&mut findings, events);
    for finding in &mut findings {
        let is_loss = finding.effect == Effect::LostSamples;
        finding.severity = finding.severity.min(if is_loss { Severity::Warning } else { Severity::Note });
        // What it takes is no part of the motion.
        finding.effect = if finding.effect == Effect::Motion { Effect::Nothing } else { finding.effect };
    }
    findings.extend(clipped(channel, told));
    findings.extend(events.first_contact.and_then(|_| faint(told)).map(|found| found.tag(&channel.name)));
    findings
}

fn clipped(channel: &Channel, told: &OtherSummary) -> Option<Finding> {
    let (first, last) = (told.clipped.first()?, told.clipped.last()?);
    let samples = told.clipped.iter().map(|span| span.to - span.from).sum();
    let limit = channel.samples.get(first.from);
    let found = ChannelFinding::OtherClipped { limit, samples, unit: channel.unit.clone() };
    Some(found.tag(&channel.name).span(channel.time_s(first.from), channel.time_s(last.to)))
}

/// Nothing but noise, or much of it.
fn faint(told: &OtherSummary) -> Option<ChannelFinding> {
    let unit = told.unit.clone();
    let Some((smallest, largest)) = told.smallest.zip(told.largest) else {
        return Some(ChannelFinding::OtherStill { farthest: None, unit });
    };
    let (rest, noise) = told.rest.zip(told.noise)?;
    let farthest = (largest.value - rest).max(rest - smallest.value);
    if farthest <= SILENT * noise {
        return Some(ChannelFinding::OtherStill { farthest: Some(farthest), unit });
    }
    let is_noisy = noise > NOTABLE_NOISE * farthest;
    is_noisy.then_some(ChannelFinding::OtherNoise { noise, farthest, unit })
}

/// Puts the findings on these channels behind the others of their severity: what concerns the numbers first.
pub fn behind_the_motion(findings: &mut [Finding], others: &[OtherSummary]) {
    let is_other = |found: &Finding| others.iter().any(|other| found.channel.as_ref() == Some(&other.name));
    findings.sort_by_key(|found| (Reverse(found.severity), is_other(found)));
}

/// What is wrong with a sensor by the share of the rotation that it has the first impact give; it takes no
/// part in the motion then.
pub fn judge_rotation(read: &MeasuredRotation, gained_rad_s: f64) -> Option<ChannelFinding> {
    if gained_rad_s.abs() < LEAST_RAD_S {
        return None;
    }
    let share = read.gained.rad_s / gained_rad_s;
    let is_near = |of: f64| (share.abs() / of - 1.0).abs() < WITHIN;
    let cause = match () {
        () if is_near(DEGREES) || is_near(1.0 / DEGREES) => RotationCause::Unit,
        () if share.abs() < 1.0 / DEGREES => RotationCause::Nothing,
        () if is_near(1.0) && share < 0.0 => RotationCause::Sign,
        () => return None,
    };
    Some(ChannelFinding::OtherRotation { share, cause })
}

/// What an angular-rate sensor reads at rest, where it must read 0; `unit_rad_s` is that of its level.
pub fn judge_rate_level(channel: &Channel, rest: AtRest, unit_rad_s: f64) -> Finding {
    let found = match () {
        () if rest.least_step_m_s2 == 0.0 => RestFinding::OneValue,
        () if !rest.is_still => RestFinding::Turning,
        () => RestFinding::Rate { reads_deg_s: DEGREES * unit_rad_s * rest.level_m_s2 },
    };
    found.tag(&channel.name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{At, Extreme, IssueCode, Span, TimesFinding, example};

    fn told(noise: f64, farthest: f64) -> OtherSummary {
        let extreme = |value| Some(Extreme { value, time_s: 0.0 });
        OtherSummary {
            unit: "µm/m".into(),
            rest: Some(20.0),
            noise: Some(noise),
            smallest: extreme(20.0),
            largest: extreme(20.0 + farthest),
            ..OtherSummary::default()
        }
    }

    /// Codes and severities of what is found.
    fn judged(issues: &[Finding], told: &OtherSummary) -> Vec<(IssueCode, Severity)> {
        let events = Events { first_contact: Some(At::exact(1.0)), ..Events::default() };
        judge_other(&example::other(vec![20.0; 8]), issues, told, &events)
            .iter()
            .map(|found| (found.code, found.severity))
            .collect()
    }

    #[test]
    fn still_noisy_and_sound_channels_are_told_apart() {
        let note = |code| [(code, Severity::Note)];
        assert_eq!(judged(&[], &told(1.0, 8.0)), note(IssueCode::DeadChannel));
        assert_eq!(judged(&[], &told(0.0, 0.0)), note(IssueCode::DeadChannel));
        assert_eq!(judged(&[], &OtherSummary::default()), note(IssueCode::DeadChannel));
        assert_eq!(judged(&[], &told(1.0, 19.0)), note(IssueCode::Noise));
        assert_eq!(judged(&[], &told(1.0, 21.0)), []);
        let without_impact = Events::default();
        assert!(judge_other(&example::other(vec![]), &[], &told(0.0, 0.0), &without_impact).is_empty());
    }

    #[test]
    fn clipping_and_a_gap_at_the_impacts_are_warnings_and_all_else_notes() {
        let gap = |from_s: f64| {
            let gap = Finding::from(TimesFinding::Gap { lost: 3, over_s: 0.1 });
            gap.tag("S1").span(from_s, from_s)
        };
        let clock = Finding::from(TimesFinding::FewBlocks { stamps_hz: 1.0, taken_hz: 2.0 });
        let issues = [gap(1.0), gap(0.1), clock.clone().tag("S1"), clock.tag("T1")];
        let clipped = OtherSummary { clipped: vec![Span { from: 2, to: 5 }], ..told(1.0, 100.0) };
        assert_eq!(
            judged(&issues, &clipped),
            [
                (IssueCode::Gap, Severity::Warning),
                (IssueCode::Gap, Severity::Note),
                (IssueCode::Clock, Severity::Note),
                (IssueCode::Clipped, Severity::Warning)
            ]
        );
    }

    #[test]
    fn what_concerns_the_numbers_comes_first() {
        let other = OtherSummary { name: "S1".into(), ..OtherSummary::default() };
        let on = |name: &str| ChannelFinding::Polarity.tag(name);
        let mut findings = [on(&other.name), on("A1")];
        behind_the_motion(&mut findings, &[other]);
        assert_eq!(findings[0].channel.as_deref(), Some("A1"));
    }
}
