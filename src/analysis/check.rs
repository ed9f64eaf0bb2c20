//! Checks with a recording at rest before the drop, and the cask file, if the set-up is ready.

use super::plan;
use super::rest::rate_weight;
use crate::data::{
    At, AtRest, Axis, CaskFile, Channel, ChannelFinding, Check, CheckedChannel, CoarseEvent, Corrections,
    Coupling, Drop, Events, Finding, FindingKind, Recording, STANDARD_GRAVITY_M_S2 as G, Severity, Signal,
    rate_unit_rad_s,
};
use crate::ingest::refusal::Refusal;
use crate::ingest::{IngestError, error};
use crate::{condition, events, judge};
use std::cmp::Reverse;

/// Shortest recording that shows the cask at rest, s.
const LEAST_S: f64 = 0.99;
/// The quiet part ends this long before the first blow, s.
const BEFORE_BLOW_S: f64 = 0.02;

/// Compares a recording at rest with the cask file; if `has_blows`, also one blow on each end, the first end
/// first.
///
/// # Errors
/// [`IngestError`] if a channel is too short.
pub fn check(rest: &Recording, file: &CaskFile, has_blows: bool) -> Result<Check, IngestError> {
    for channel in &rest.channels {
        let length_s = channel.time_s(channel.samples.len()) - channel.start_s;
        if length_s < LEAST_S {
            let problem = format!("it lasts {length_s:.2} s, too short to tell the rest");
            let mend = "record the cask at rest in the rig for a second or more";
            return Err(error::of_channel(&rest.path, &channel.name, Refusal::new(problem, mend)));
        }
    }
    let across = rest.channels.iter().filter(|channel| has_blows && channel.axis == Axis::Transverse);
    let blows: Vec<_> = across.map(|channel| (channel, events::tap_answers(channel))).collect();
    let first_blow_s = blows.iter().flat_map(|(_, answers)| answers).map(|blow| blow.at_s - BEFORE_BLOW_S);
    let quiet_to_s = first_blow_s.fold(rest.end_s(), f64::min);
    let (signals, mut findings) = condition_quiet(rest, file, quiet_to_s);
    // A copy does not show its own sensor.
    findings.extend(judge::judge_copies(&rest.channels));
    let level = |channel| Some((channel, events::at_rest(channel, file.drop.gravity_m_s2)?));
    let levels: Vec<(&Channel, AtRest)> = rest.channels.iter().filter_map(level).collect();
    findings.extend(judge::judge_levels(&levels, &file.drop));
    findings.extend(rest.others.channels.iter().filter_map(|channel| {
        let level = events::at_rest(channel, rate_weight(channel, file)?)?;
        Some(judge::judge_rate_level(channel, level, rate_unit_rad_s(&channel.unit)?))
    }));
    findings.extend(judge_against_drop(rest, file, &signals));
    findings.extend(judge::judge_places(&signals, file));
    findings.extend(rest.issues.iter().cloned());
    if has_blows {
        // A blow from below need not reach an axial channel.
        let across = blows.iter().map(|(channel, _)| *channel);
        findings.extend(judge::judge_silent(&across.collect::<Vec<_>>()));
        findings.extend(judge::judge_taps(&blows));
    }
    Ok(gather_findings(&file.drop, &signals, &levels, findings))
}

/// Conditions the quiet part before a time as an analysis would condition the free fall; hum is judged as if
/// it remained.
fn condition_quiet(rest: &Recording, file: &CaskFile, to_s: f64) -> (Vec<Signal>, Vec<Finding>) {
    let mut as_dc = rest.clone();
    // A restored droop would grow through a recording whose beginning is unknown.
    for channel in &mut as_dc.channels {
        channel.coupling = Coupling::Dc;
    }
    let reach = condition::Reach { after_s: 0.0, ..condition::Reach::for_drop(&file.cask, &file.drop) };
    let event = CoarseEvent { near_s: to_s, spread_s: 0.0, velocity_step_m_s: file.drop.impact_velocity_m_s };
    let corrections = Corrections { offset: true, hum: false, ..file.corrections };
    let (signals, mut found) = condition::condition(&as_dc, &event, &reach, corrections);
    let is_level =
        |f: &Finding| matches!(f.what, FindingKind::Channel(ChannelFinding::OffsetTakenOff { .. }));
    found.retain(|finding| !is_level(finding));
    (signals, found)
}

/// Compares noise, range, rate and length of the record with the predicted drop.
fn judge_against_drop(rest: &Recording, file: &CaskFile, signals: &[Signal]) -> Vec<Finding> {
    let needs = plan::needs(file);
    let mut found = Vec::new();
    for (channel, signal) in rest.channels.iter().zip(signals) {
        let end_s = signal.end_s();
        let (first_contact, slap_down) = (Some(At::exact(end_s)), Some(At::exact(end_s + needs.flight_s)));
        let events = Events { first_contact, slap_down, ..Events::default() };
        found.extend(judge::judge_noise(signal, &events, None, file.drop.impact_velocity_m_s));
        let channel_needs = needs.channels.iter().find(|needs| needs.name == channel.name);
        found.extend(channel_needs.into_iter().flat_map(|n| judge::judge_chain(channel, signal, &n.peaks)));
    }
    found.extend(judge::judge_record(rest.before_trigger_s, rest.end_s(), needs.after_s));
    found
}

/// Sorts the findings by channel, and decides if any of them contradicts the drop.
fn gather_findings(
    drop: &Drop,
    signals: &[Signal],
    levels: &[(&Channel, AtRest)],
    mut found: Vec<Finding>,
) -> Check {
    found.sort_by_key(|finding| Reverse(finding.severity));
    let is_ready = |found: &[Finding]| found.iter().all(|finding| finding.severity == Severity::Note);
    let ready = is_ready(&found);
    let channel = |((channel, level), signal): (&(&Channel, AtRest), &Signal)| {
        let is_own = |finding: &mut Finding| finding.channel.as_deref() == Some(&channel.name[..]);
        let findings: Vec<Finding> = found.extract_if(.., is_own).collect();
        let is_dc = channel.coupling == Coupling::Dc;
        CheckedChannel {
            name: channel.name.clone(),
            ready: is_ready(&findings),
            reads_g: level.level_m_s2 / G,
            expected_g: is_dc.then(|| drop.weight_m_s2(channel.axis) / G),
            noise_g: signal.noise_m_s2 / G,
            findings,
            open: judge::hidden_causes(channel, *level, drop),
        }
    };
    let channels = levels.iter().zip(signals).map(channel).collect();
    Check { schema: "dropcheck.check/1", ready, channels, findings: found }
}
