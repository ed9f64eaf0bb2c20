//! Judges the channels beside the accelerometers.

use super::silent::SILENT_SPREADS;
use super::weigh_by_distance;
use crate::data::{
    AtRest, Channel, ChannelFinding, Effect, Events, Finding, MeasuredRotation, OtherSummary, RestFinding,
    RotationCause, Severity,
};
use std::cmp::Reverse;

/// Noise that is a note, over the largest deviation from rest: ± 10 % of that.
const NOTABLE_NOISE: f64 = 0.05;

/// Smallest rotation by the first impact that is used to judge a sensor, rad/s: a tenth of that of a
/// slap-down.
const LEAST_RAD_S: f64 = 0.3;
/// Relative tolerance within which a measured share of the rotation is explained by a cause; a share below
/// that of the smallest cause means that the sensor reads nothing.
const CAUSE_SHARE: f64 = 0.2;
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// Lists the findings on one channel, with those of `issues` from reading it: notes, and warnings if it clips
/// or lacks samples near the impacts.
///
/// These findings change no number of the motion.
pub fn judge_other(
    channel: &Channel,
    issues: &[Finding],
    summary: &OtherSummary,
    events: &Events,
) -> Vec<Finding> {
    let is_own = |found: &&Finding| found.channel.as_ref() == Some(&channel.name);
    let mut findings: Vec<Finding> = issues.iter().filter(is_own).cloned().collect();
    weigh_by_distance(&mut findings, events);
    for finding in &mut findings {
        let is_loss = finding.effect == Effect::LostSamples;
        finding.severity = finding.severity.min(if is_loss { Severity::Warning } else { Severity::Note });
        // This effect would concern the motion, in which the channel takes no part.
        finding.effect = if finding.effect == Effect::Motion { Effect::Nothing } else { finding.effect };
    }
    findings.extend(judge_clipping(channel, summary));
    findings.extend(events.first_contact.and_then(|_| judge_noise(summary)).map(|f| f.tag(&channel.name)));
    findings
}

fn judge_clipping(channel: &Channel, summary: &OtherSummary) -> Option<Finding> {
    let (first, last) = (summary.clipped.first()?, summary.clipped.last()?);
    let samples = summary.clipped.iter().map(|span| span.to - span.from).sum();
    let limit = channel.samples.get(first.from);
    let finding = ChannelFinding::OtherClipped { limit, samples, unit: channel.unit.clone() };
    Some(finding.tag(&channel.name).span(channel.time_s(first.from), channel.time_s(last.to)))
}

/// Reports a channel with nothing but noise, or with much of it.
fn judge_noise(summary: &OtherSummary) -> Option<ChannelFinding> {
    let unit = summary.unit.clone();
    let Some((smallest, largest)) = summary.smallest.zip(summary.largest) else {
        return Some(ChannelFinding::OtherStill { farthest: None, unit });
    };
    let (rest, noise) = summary.rest.zip(summary.noise)?;
    let farthest = (largest.value - rest).max(rest - smallest.value);
    if farthest <= SILENT_SPREADS * noise {
        return Some(ChannelFinding::OtherStill { farthest: Some(farthest), unit });
    }
    let is_noisy = noise > NOTABLE_NOISE * farthest;
    is_noisy.then_some(ChannelFinding::OtherNoise { noise, farthest, unit })
}

/// Sorts the findings on these channels after the others of their severity: findings on the numbers come
/// first.
pub fn sort_other_channels_last(findings: &mut [Finding], others: &[OtherSummary]) {
    let is_other = |found: &Finding| others.iter().any(|other| found.channel.as_ref() == Some(&other.name));
    findings.sort_by_key(|found| (Reverse(found.severity), is_other(found)));
}

/// Reports the fault of a sensor, from its share of the rotation by the first impact; it then takes no part
/// in the motion.
pub fn judge_rotation(read: &MeasuredRotation, gained_rad_s: f64) -> Option<ChannelFinding> {
    if gained_rad_s.abs() < LEAST_RAD_S {
        return None;
    }
    let share = read.gained.rad_s / gained_rad_s;
    let is_near = |factor: f64| (share.abs() / factor - 1.0).abs() < CAUSE_SHARE;
    let cause = match () {
        () if is_near(DEGREES) || is_near(1.0 / DEGREES) => RotationCause::Unit,
        () if share.abs() < 1.0 / DEGREES => RotationCause::Nothing,
        () if is_near(1.0) && share < 0.0 => RotationCause::Sign,
        () => return None,
    };
    Some(ChannelFinding::OtherRotation { share, cause })
}

/// Reports the level of an angular-rate sensor at rest, which must be 0; `unit_rad_s` is the unit of its
/// level.
pub fn judge_rate_level(channel: &Channel, rest: AtRest, unit_rad_s: f64) -> Finding {
    let finding = match () {
        () if rest.least_step_m_s2 == 0.0 => RestFinding::OneValue,
        () if !rest.is_still => RestFinding::Turning,
        () => RestFinding::Rate { reads_deg_s: DEGREES * unit_rad_s * rest.level_m_s2 },
    };
    finding.tag(&channel.name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{At, Extreme, IssueCode, Span, TimesFinding, example};

    fn summary(noise: f64, farthest: f64) -> OtherSummary {
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

    /// Returns codes and severities of the findings.
    fn judged(issues: &[Finding], summary: &OtherSummary) -> Vec<(IssueCode, Severity)> {
        let events = Events { first_contact: Some(At::exact(1.0)), ..Events::default() };
        judge_other(&example::other(vec![20.0; 8]), issues, summary, &events)
            .iter()
            .map(|found| (found.code, found.severity))
            .collect()
    }

    #[test]
    fn still_noisy_and_sound_channels_are_told_apart() {
        let note = |code| [(code, Severity::Note)];
        assert_eq!(judged(&[], &summary(1.0, 8.0)), note(IssueCode::DeadChannel));
        assert_eq!(judged(&[], &summary(0.0, 0.0)), note(IssueCode::DeadChannel));
        assert_eq!(judged(&[], &OtherSummary::default()), note(IssueCode::DeadChannel));
        assert_eq!(judged(&[], &summary(1.0, 19.0)), note(IssueCode::Noise));
        assert_eq!(judged(&[], &summary(1.0, 21.0)), []);
        let without_impact = Events::default();
        assert!(judge_other(&example::other(vec![]), &[], &summary(0.0, 0.0), &without_impact).is_empty());
    }

    #[test]
    fn clipping_and_a_gap_at_the_impacts_are_warnings_and_all_else_notes() {
        let gap = |from_s: f64| {
            let gap = Finding::from(TimesFinding::Gap { lost: 3, over_s: 0.1 });
            gap.tag("S1").span(from_s, from_s)
        };
        let clock = Finding::from(TimesFinding::FewBlocks { stamps_hz: 1.0, taken_hz: 2.0 });
        let issues = [gap(1.0), gap(0.1), clock.clone().tag("S1"), clock.tag("T1")];
        let clipped = OtherSummary { clipped: vec![Span { from: 2, to: 5 }], ..summary(1.0, 100.0) };
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
        sort_other_channels_last(&mut findings, &[other]);
        assert_eq!(findings[0].channel.as_deref(), Some("A1"));
    }
}
