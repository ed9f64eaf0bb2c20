//! Judges single channels from their signals and the events.

use super::sampling;
use crate::data::{
    Axis, CaskFile, ChannelFinding, DropPart, Effect, End, Estimate, Events, Finding, FindingKind, FlightFit,
    MOST_LOST_M_S, STANDARD_GRAVITY_M_S2, Severity, Signal,
};
use crate::numerics::noise::integral_uncertainty_by;
use crate::numerics::reduce;
use std::ops::Range;

/// Standard uncertainty of the velocity from noise alone that makes a result worthless, as a share of v0: ±
/// 10 %.
const MOST_NOISE: f64 = 0.05;
/// Uncertainty from noise that is a note, as a share of v0: as much as all other contributions.
const NOTABLE_NOISE: f64 = 0.005;
/// An error of a velocity step below this share of the half-widths changes no number.
const HARMLESS: f64 = 0.5;
/// Longest integration for which noise is judged, s: contact and the window of the flight's fit.
const LONGEST_S: f64 = 0.1;
/// A sensor sits on the cask within this tolerance, m: its bolt and the hook of the tape measure.
const SLACK_M: f64 = 0.05;
/// A recording whose first sample exceeds this share of the first peak began during the impact.
const LATE_START_SHARE: f64 = 0.1;
/// Factors between units that are often confused: g and m/s², V and mV.
const UNITS: [(f64, &str); 2] = [(STANDARD_GRAVITY_M_S2, "g and m/s²"), (1000.0, "V and mV, or g and mg")];
/// Two measuring chains of one kind and unit have equal noise within this share.
const NOISE_SHARE: f64 = 0.2;
/// Reading g as m/s² scales noise and peaks by 9.8. Two channels in the same unit are suspected only if their
/// peaks differ by the factor of units over this: peaks of 9.8 / 3 times another's, with 9.8 times its noise.
const PEAK_FACTOR: f64 = 3.0;

/// Judges each channel over the event: clipping, gaps, sample rate, noise, position. `found` holds the
/// findings so far.
pub fn judge_channels(
    signals: &[Signal],
    events: &Events,
    flight: Option<&FlightFit>,
    cask_file: &CaskFile,
    found: &[Finding],
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let contact_s = events.first_contact_s();
    let separation_s = events.separation_s();
    for signal in signals {
        findings.extend(judge_clipping(signal, events));
        if let (Some(from), Some(to)) = (contact_s, separation_s) {
            findings.extend(judge_gap(signal, from, to, events.slap_down.is_some()));
        }
    }
    let disturbances = found.iter().filter(|f| f.effect == Effect::Disturbance);
    let disturbed: Vec<&str> = disturbances.filter_map(|f| f.channel.as_deref()).collect();
    findings.extend(sampling::judge_sampling(signals, events, &disturbed));
    findings.extend(judge_singly(signals, events, flight, cask_file));
    findings
}

/// True if clipping between two times removes more velocity than may be missing.
pub fn is_cut_off(signal: &Signal, from_s: f64, to_s: f64) -> bool {
    signal.lost_to_clipping_m_s(from_s, to_s) > MOST_LOST_M_S
}

/// Reports samples at a limit before, between and after the impacts, one finding for each kind of limit.
fn judge_clipping(signal: &Signal, events: &Events) -> Vec<Finding> {
    let separation_s = events.separation_s().unwrap_or(f64::INFINITY);
    let slap_down_s = events.slap_down_s().unwrap_or(f64::INFINITY);
    let parts = [
        (f64::NEG_INFINITY..separation_s, DropPart::FirstImpact),
        (separation_s..slap_down_s, DropPart::Flight),
        (slap_down_s..f64::INFINITY, DropPart::SlapDown),
    ];
    let judge_part = |(part_s, during): (Range<f64>, DropPart), is_flank: bool| {
        let spans = signal.clipped.iter().filter(|s| part_s.contains(&signal.time_s(s.from)));
        let spans: Vec<_> = spans.filter(|s| signal.is_flank(s) == is_flank).collect();
        let (first, last) = (spans.first()?, spans.last()?);
        let lost_m_s = signal.lost_to_clipping_m_s(part_s.start, part_s.end);
        let (samples, takes_step) = (
            spans.iter().map(|s| s.to - s.from).sum(),
            during != DropPart::SlapDown && lost_m_s > MOST_LOST_M_S,
        );
        let level_m_s2 = signal.force_m_s2[first.from];
        let finding = if is_flank {
            let fall_m_s2 = level_m_s2 - signal.force_m_s2[first.to - 1];
            let length_s = signal.time_s(first.to - 1) - signal.time_s(first.from);
            ChannelFinding::Slewed {
                slope_m_s3: (fall_m_s2 / length_s).abs(),
                samples,
                during,
                lost_m_s,
                takes_step,
            }
        } else {
            let limit_m_s2 = (level_m_s2 + signal.removed_offset_m_s2).abs();
            ChannelFinding::Clipped { limit_m_s2, samples, during, lost_m_s, takes_step }
        };
        Some(finding.tag(&signal.name).span(signal.time_s(first.from), signal.time_s(last.to)))
    };
    let judge_kind = |is_flank| parts.clone().into_iter().filter_map(move |part| judge_part(part, is_flank));
    judge_kind(false).chain(judge_kind(true)).collect()
}

fn judge_gap(signal: &Signal, contact_s: f64, left_s: f64, shows_slap_down: bool) -> Option<Finding> {
    let inside = signal.overlaps(&signal.gaps, contact_s, left_s);
    let finding = ChannelFinding::LostStep { shows_slap_down };
    inside.then(|| finding.tag(&signal.name).span(contact_s, left_s))
}

/// Judges each channel by itself and against the others, apart from its samples in the impact.
fn judge_singly(
    signals: &[Signal],
    events: &Events,
    flight: Option<&FlightFit>,
    cask_file: &CaskFile,
) -> Vec<Finding> {
    let mut findings = judge_places(signals, cask_file);
    for signal in signals {
        findings.extend(judge_noise(signal, events, flight, cask_file.drop.impact_velocity_m_s));
        findings.extend(judge_late_start(signal, events));
    }
    findings.extend(judge_units(signals));
    findings
}

/// Downgrades noise to a note if the intervals are narrow all the same, and a coarsely sampled step if its
/// error is below its uncertainty.
pub fn downgrade_harmless(findings: &mut [Finding], k: Estimate, speed: Option<Estimate>) {
    let u95_share = speed.map_or(0.0, |speed| speed.u95 / speed.value);
    let is_harmless = |found: &Finding| match found.what {
        FindingKind::Channel(ChannelFinding::Noise { .. }) => k.u95.max(u95_share) < 2.0 * MOST_NOISE,
        FindingKind::Channel(ChannelFinding::LowRate { off_percent, .. }) => {
            let off = off_percent / 100.0;
            off * (1.0 + k.value) < HARMLESS * k.u95 && (speed.is_none() || off < HARMLESS * u95_share)
        }
        _ => false,
    };
    findings.iter_mut().filter(|found| is_harmless(found)).for_each(|found| found.severity = Severity::Note);
}

/// Reports the uncertainty of the velocity from the noise before first contact: at most that of the contact
/// and the flight's fit together, whose plateau averages the noise.
pub fn judge_noise(
    signal: &Signal,
    events: &Events,
    flight: Option<&FlightFit>,
    impact_velocity_m_s: f64,
) -> Option<Finding> {
    let contact_s = events.first_contact_s()?;
    let end_s = events.slap_down_s().unwrap_or_else(|| signal.end_s());
    let length_s = (end_s - contact_s).clamp(0.0, LONGEST_S);
    let walk_m_s = |length_s| integral_uncertainty_by(&signal.noise_spectrum, signal.free_fall_s, length_s);
    let plateau = flight.and_then(|flight| flight.plateau(&signal.name)).zip(events.separation_s());
    let fit_m_s = plateau.map(|(plateau, left_s)| plateau.u_m_s.hypot(walk_m_s(left_s - contact_s)));
    let u_m_s = walk_m_s(length_s).min(fit_m_s.unwrap_or(f64::INFINITY));
    let severity = if u_m_s > MOST_NOISE * impact_velocity_m_s { Severity::Warning } else { Severity::Note };
    let finding = ChannelFinding::Noise { noise_m_s2: signal.noise_m_s2, u_m_s, length_s, severity };
    (u_m_s > NOTABLE_NOISE * impact_velocity_m_s).then(|| finding.tag(&signal.name))
}

/// Reports a recording that began in the impact: the velocity before its first sample is missing from the
/// step.
fn judge_late_start(signal: &Signal, events: &Events) -> Option<Finding> {
    let contact_s = events.first_contact_s()?;
    let to_s = events.separation_s().unwrap_or(contact_s + 0.02);
    let is_struck = signal.end == End::First && signal.axis == Axis::Transverse;
    let force = signal.force_m_s2.get(..signal.index_from(to_s))?;
    let peak = reduce::extremes(force, 0.0).1;
    let first = *force.first()?;
    let begins = contact_s - signal.start_s < 2.0 / signal.sample_rate_hz;
    let finding = ChannelFinding::BeginsInImpact { share: first / peak };
    (is_struck && begins && peak > 0.0 && first > LATE_START_SHARE * peak)
        .then(|| finding.tag(&signal.name).span(signal.start_s, to_s))
}

/// Reports sensors beyond the ends of the cask, and ends in the wrong order.
pub fn judge_places(signals: &[Signal], cask_file: &CaskFile) -> Vec<Finding> {
    let length_m = cask_file.cask.length_m;
    let is_off = |s: &&Signal| !(-SLACK_M..=length_m + SLACK_M).contains(&s.position_m);
    let off_cask = |s: &Signal| ChannelFinding::OffCask { position_m: s.position_m, length_m }.tag(&s.name);
    let mut findings: Vec<Finding> = signals.iter().filter(is_off).map(off_cask).collect();
    let transverse = |end| signals.iter().filter(move |s| s.end == end && s.axis == Axis::Transverse);
    for first in transverse(End::First) {
        for second in transverse(End::Second).filter(|s| s.position_m <= first.position_m) {
            let (position_m, second_m) = (first.position_m, second.position_m);
            let finding = ChannelFinding::NotNearer { position_m, second: second.name.clone(), second_m };
            findings.push(finding.tag(&first.name));
        }
    }
    let middle_m = length_m / 2.0;
    let is_far =
        |s: &&Signal| if s.end == End::First { s.position_m > middle_m } else { s.position_m < middle_m };
    let nearer = |s: &Signal| {
        ChannelFinding::NearerOtherEnd { end: s.end, position_m: s.position_m, length_m }.tag(&s.name)
    };
    if findings.is_empty() {
        findings.extend(signals.iter().filter(|s| s.axis == Axis::Transverse).filter(is_far).map(nearer));
    }
    findings
}

/// Reports two transverse channels whose noise and peaks both differ by the factor between two units.
fn judge_units(signals: &[Signal]) -> Vec<Finding> {
    let transverse: Vec<&Signal> = signals.iter().filter(|s| s.axis == Axis::Transverse).collect();
    let peak = |s: &Signal| reduce::peak(&s.force_m_s2);
    let mut findings = Vec::new();
    for large in &transverse {
        for small in &transverse {
            if small.noise_m_s2 <= 0.0 {
                continue;
            }
            // Noise is compared first, since peaks need all samples.
            let noise = large.noise_m_s2 / small.noise_m_s2;
            let Some((factor, names)) = UNITS.iter().find(|u| (noise / u.0 - 1.0).abs() < NOISE_SHARE) else {
                continue;
            };
            let (highest, lowest) = (peak(large), peak(small));
            if lowest <= 0.0 || highest / lowest <= factor / PEAK_FACTOR {
                continue;
            }
            let finding = ChannelFinding::UnitFactor {
                noise,
                peak: highest / lowest,
                other: small.name.clone(),
                units: names,
            };
            findings.push(finding.tag(&large.name));
        }
    }
    findings
}

#[cfg(test)]
mod tests;
