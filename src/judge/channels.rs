//! Signals and events to what speaks against single channels.

use super::{channel_checks, sampling};
use crate::data::{CaskFile, ChannelFinding, During, Events, Finding, IssueCode, MOST_LOST_M_S, Signal};
use std::ops::Range;

/// Checks each channel over the event: clipped, lost, sampled too slowly, noisy, in the wrong place. `found`
/// is what is known of them already.
pub fn judge_channels(
    signals: &[Signal],
    events: &Events,
    cask_file: &CaskFile,
    found: &[Finding],
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let contact_s = events.first_contact_s();
    let separation_s = events.separation_s();
    for signal in signals {
        findings.extend(clipped(signal, events));
        if let (Some(from), Some(to)) = (contact_s, separation_s) {
            findings.extend(lost(signal, from, to, events.slap_down_s()));
        }
    }
    let is_disturbance = |code| matches!(code, IssueCode::Spikes | IssueCode::Dropout);
    let disturbed: Vec<&str> =
        found.iter().filter(|i| is_disturbance(i.code)).filter_map(|i| i.channel.as_deref()).collect();
    findings.extend(sampling::judge_sampling(signals, events, &disturbed));
    findings.extend(channel_checks::judge_by_themselves(signals, events, cask_file));
    findings
}

/// Whether clipping between two times takes more of the velocity than may be missing.
pub fn is_cut_off(signal: &Signal, from_s: f64, to_s: f64) -> bool {
    signal.lost_to_clipping_m_s(from_s, to_s) > MOST_LOST_M_S
}

/// One finding a channel and part of the drop: what stands at a limit before, between and after the impacts.
fn clipped(signal: &Signal, events: &Events) -> Vec<Finding> {
    let separation_s = events.separation_s().unwrap_or(f64::INFINITY);
    let slap_down_s = events.slap_down_s().unwrap_or(f64::INFINITY);
    let parts = [
        (f64::NEG_INFINITY..separation_s, During::FirstImpact),
        (separation_s..slap_down_s, During::Flight),
        (slap_down_s..f64::INFINITY, During::SlapDown),
    ];
    let of_part = |(part_s, during): (Range<f64>, During)| {
        let spans: Vec<_> =
            signal.clipped.iter().filter(|s| part_s.contains(&signal.time_s(s.from))).collect();
        let (first, last) = (spans.first()?, spans.last()?);
        let lost_m_s = signal.lost_to_clipping_m_s(part_s.start, part_s.end);
        let found = ChannelFinding::Clipped {
            limit_m_s2: (signal.force_m_s2[first.from] + signal.removed_offset_m_s2).abs(),
            samples: spans.iter().map(|s| s.to - s.from).sum(),
            during,
            lost_m_s,
            takes_step: during != During::SlapDown && lost_m_s > MOST_LOST_M_S,
        };
        Some(found.on(&signal.name).between(signal.time_s(first.from), signal.time_s(last.to)))
    };
    parts.into_iter().filter_map(of_part).collect()
}

fn lost(signal: &Signal, contact_s: f64, separation_s: f64, slap_down_s: Option<f64>) -> Option<Finding> {
    let inside = signal.touches(&signal.gaps, contact_s, separation_s);
    let found = ChannelFinding::LostStep { shows_slap_down: slap_down_s.is_some() };
    inside.then(|| found.on(&signal.name).between(contact_s, separation_s))
}
