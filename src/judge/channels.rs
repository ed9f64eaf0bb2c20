//! Signals and events to what speaks against single channels.

use super::{sampling, worth};
use crate::data::{
    CaskFile, Events, Issue, IssueCode, MOST_LOST_M_S, STANDARD_GRAVITY_M_S2, Severity, Signal,
};

/// What is left to know a velocity step by that a channel lost.
const AS_FAR_AS_TOLD: &str = "k and the slap-down velocity are had only as far as the other channels and the way of the second end to the target tell them";

/// Checks each channel over the event: clipped, lost, sampled too slowly, noisy, in the wrong place. `found` is what is known of them already.
#[must_use]
pub fn judge_channels(
    signals: &[Signal],
    events: &Events,
    cask_file: &CaskFile,
    found: &[Issue],
) -> Vec<Issue> {
    let mut issues = Vec::new();
    let contact_s = events.first_contact_s();
    let separation_s = events.separation_s();
    for signal in signals {
        issues.extend(clipped(signal, events));
        if let (Some(from), Some(to)) = (contact_s, separation_s) {
            issues.extend(lost(signal, from, to, events.slap_down_s()));
        }
    }
    let is_disturbance = |code| matches!(code, IssueCode::Spikes | IssueCode::Dropout);
    let disturbed: Vec<&str> =
        found.iter().filter(|i| is_disturbance(i.code)).filter_map(|i| i.channel.as_deref()).collect();
    issues.extend(sampling::judge_sampling(signals, events, &disturbed));
    issues.extend(worth::judge_worth(signals, events, cask_file));
    issues
}

/// Whether clipping between two times takes more of the velocity than may be missing.
#[must_use]
pub fn is_cut_off(signal: &Signal, from_s: f64, to_s: f64) -> bool {
    signal.lost_to_clipping_m_s(from_s, to_s) > MOST_LOST_M_S
}

/// One issue a channel and phase: what stands at a limit before, between and after the impacts.
fn clipped(signal: &Signal, events: &Events) -> Vec<Issue> {
    let separation_s = events.separation_s().unwrap_or(f64::INFINITY);
    let slap_down_s = events.slap_down_s().unwrap_or(f64::INFINITY);
    let phases = [
        (f64::NEG_INFINITY, separation_s, "in the first impact"),
        (separation_s, slap_down_s, "in the flight"),
        (
            slap_down_s,
            f64::INFINITY,
            "from the slap-down on, which leaves the speed before it as it is but not the peak",
        ),
    ];
    let mut issues = Vec::new();
    for (from_s, to_s, when) in phases {
        let spans: Vec<_> =
            signal.clipped.iter().filter(|s| (from_s..to_s).contains(&signal.time_s(s.from))).collect();
        let (Some(first), Some(last)) = (spans.first(), spans.last()) else { continue };
        let lost_m_s = signal.lost_to_clipping_m_s(from_s, to_s);
        let counts = from_s < slap_down_s && lost_m_s > MOST_LOST_M_S;
        let effect = if from_s < slap_down_s {
            let had = if counts { format!(", and {AS_FAR_AS_TOLD}") } else { String::new() };
            format!("; about {lost_m_s:.2} m/s of velocity is cut off{had}")
        } else {
            String::new()
        };
        let number: usize = spans.iter().map(|s| s.to - s.from).sum();
        issues.push(
            Issue::new(
                IssueCode::Clipped,
                if counts { Severity::Error } else { Severity::Warning },
                format!(
                    "{} stands at its limit of {:.0} g for {number} samples {when}{effect}. Use a sensor or range with more head-room",
                    signal.name,
                    (signal.force_m_s2[first.from] + signal.removed_offset_m_s2).abs() / STANDARD_GRAVITY_M_S2,
                ),
            )
            .on(&signal.name)
            .between(signal.time_s(first.from), signal.time_s(last.to)),
        );
    }
    issues
}

fn lost(signal: &Signal, contact_s: f64, separation_s: f64, slap_down_s: Option<f64>) -> Option<Issue> {
    let inside = signal.touches(&signal.gaps, contact_s, separation_s);
    inside.then(|| {
        Issue::new(
            IssueCode::Gap,
            Severity::Error,
            format!(
                "{} lost samples during the first impact, and with them its velocity step: {}",
                signal.name,
                if slap_down_s.is_some() { AS_FAR_AS_TOLD } else { "no slap-down tells what it was" }
            ),
        )
        .on(&signal.name)
        .between(contact_s, separation_s)
    })
}
