//! Finds the first impact of a recording: the conditioned signals, the time at which L touches, and the rest
//! and fall before it.

use super::flight_search::{self, SearchEffort};
use super::{missing_end, rest, skin};
use crate::data::{
    At, Axis, BENDING_WAVE_M_S, Cask, CaskFile, Channel, ChannelFinding, CoarseEvent, Coupling, Drop,
    DropFinding, Effect, End, Events, Finding, FindingKind, JoinedRecording, OtherChannels, Recording,
    RestLevel, Severity, Signal, transverse,
};
use crate::events::HidingNoise;
use crate::{condition, events, judge};
use missing_end::ReconstructedEnd;
use std::ops::Range;
use std::sync::Arc;

/// Search for a first impact and the flight after it.
#[derive(Clone, Copy)]
pub(super) struct ImpactSearch {
    /// Kind of impact.
    pub kind: ImpactKind,
    /// Effort of the search for the flight.
    pub effort: SearchEffort,
    /// Longest delay of the struck end's sensor behind the corner, and of a bending wave along the cask, s.
    pub waves_s: [f64; 2],
}

/// Kind of impact: on the edge of an end with a slap-down no later than the angle allows, or with a later
/// one, or on an end face, which the axial channels show.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum ImpactKind {
    Usual,
    Late,
    OnEnd,
}

/// The first impact, with everything that its analysis needs.
pub(super) struct Impact {
    /// Conditioned signals; the last one is reconstructed if there is a `reconstructed_end`.
    pub signals: Vec<Signal>,
    /// First contact of L.
    pub contact: At,
    /// Standard uncertainty of R's times from an unexplained delay between channels, s.
    pub u_skew_s: f64,
    /// The end that has no transverse channel of its own.
    pub reconstructed_end: Option<ReconstructedEnd>,
    /// Levels of the channels at rest.
    pub rests: Vec<RestLevel>,
    /// Interval from the release to the first touch, s, if it was recorded.
    pub fall_s: Option<Range<f64>>,
    /// End of the search for the slap-down, s; true if the record ends there; true if a later event remains
    /// that a longer flight explains.
    pub search_end_s: f64,
    pub is_record_end: bool,
    pub has_later_event: bool,
    /// Effort of the search for the flight.
    pub effort: SearchEffort,
    /// Signals of pairs on the skin across the plane of the drop.
    pub across: Vec<Signal>,
    /// Channels beside the accelerometers.
    pub others: Arc<OtherChannels>,
}

impl Impact {
    /// Finds the first impact and cuts the recording after the latest slap-down of this search. `None` if no
    /// channel shows an impact; the reason is then the only finding.
    pub fn find(
        recording: &Recording,
        file: &CaskFile,
        search: ImpactSearch,
        findings: &mut Vec<Finding>,
    ) -> Option<Self> {
        let drop = &file.drop;
        let is_on_end =
            search.kind == ImpactKind::OnEnd && recording.channels.iter().any(|c| c.axis == Axis::Axial);
        let struck = if is_on_end { Axis::Axial } else { Axis::Transverse };
        let is_relevant = |channel: &&Channel| !is_on_end || channel.axis == struck;
        let (silent, changes) = rayon::join(
            || judge::judge_silent(&recording.channels.iter().filter(is_relevant).collect::<Vec<_>>()),
            || events::Changes::along_axis(&recording.channels, struck),
        );
        findings.extend(silent.clone());
        let copied = judge::judge_copies(&recording.channels);
        let slap_down_m_s = missing_end::least_step_m_s(file, recording);
        let least_step_m_s = if is_on_end { drop.impact_velocity_m_s } else { slap_down_m_s };
        if let Some(HidingNoise { channel, noise_m_s }) = changes.find_hiding_noise(least_step_m_s) {
            let least_m_s = least_step_m_s;
            findings.push(DropFinding::Hidden { channel, noise_m_s, least_m_s }.into());
            return None;
        }
        let event =
            changes.locate(least_step_m_s).filter(|e| e.velocity_step_m_s.abs() > drop.least_impact_m_s());
        let Some(event) = event else {
            findings.push(judge::judge_no_impact(findings, drop, changes.rate_hz(), None));
            return None;
        };
        if let Some(ahead) = changes.find_leading_clock(&event, drop.impact_velocity_m_s) {
            findings.push(ChannelFinding::Ahead { ahead_s: -ahead.delay_s }.tag(&ahead.channel));
            return None;
        }
        let usual = condition::Reach::for_drop(&file.cask, drop);
        let farthest = if search.kind == ImpactKind::Late { usual.with_longest_flight() } else { usual };
        let last_within_s =
            |reach: condition::Reach| changes.last_s(&event, drop.impact_velocity_m_s, reach.after_s);
        let last_s = last_within_s(farthest);
        let has_later_event = last_within_s(farthest.with_longest_flight()) > last_s;
        let reach = last_s.map_or(farthest, |last_s| farthest.cut_at(last_s - event.near_s - event.spread_s));
        let (mut signals, found) = condition_event(recording, file, &event, &reach);
        let removed = silent.iter().filter(|f| f.effect == Effect::Channel).chain(&copied);
        signals.retain(|signal| removed.clone().all(|f| f.channel.as_ref() != Some(&signal.name)));
        findings.extend(copied);
        let across = skin::turn_into_plane(&mut signals, &file.channels);
        exchange_axes(&mut signals, is_on_end);
        let Some(contact) = first_contact(&file.cask, &signals, &event) else {
            findings.push(judge::judge_no_impact(findings, drop, changes.rate_hz(), Some(&event)));
            return None;
        };
        findings.extend(found);
        let another = changes.find_another_drop(&event, drop.impact_velocity_m_s / drop.gravity_m_s2);
        findings.extend(another.map(|another| judge::judge_several_drops(&event, &another)));
        // Without a later event the record is searched for the longest flight.
        let reach = if has_later_event { farthest } else { farthest.with_longest_flight() };
        let search_end_s = event.near_s + event.spread_s + reach.after_s;
        let u_joined_s = u_joined_s(recording, &signals);
        let u_skew_s = align(file, &mut signals, contact.time_s, search.waves_s, findings).hypot(u_joined_s);
        exchange_axes(&mut signals, is_on_end);
        let reconstructed_end = (!is_on_end).then(|| add_end(file, &mut signals, contact.time_s)).flatten();
        let (own_rests, fall_s) = find_rest_and_fall(recording, drop, contact.time_s, struck);
        let file_rests = || rest::levels(recording, &signals, file, contact.time_s);
        let mut rests = if own_rests.is_empty() { file_rests() } else { own_rests };
        skin::turn_rests(&mut rests, &across, &file.channels);
        let impact = Self {
            signals,
            contact,
            u_skew_s,
            reconstructed_end,
            rests,
            fall_s,
            search_end_s: search_end_s.min(recording.end_s()),
            is_record_end: recording.end_s() <= search_end_s,
            has_later_event,
            effort: search.effort,
            across,
            others: Arc::clone(&recording.others),
        };
        findings.extend(judge::judge_fall(drop, &impact.events()));
        Some(impact)
    }

    /// Returns the events up to the first contact.
    pub fn events(&self) -> Events {
        Events {
            release_s: self.fall_s.as_ref().map(|fall_s| fall_s.start),
            fall_end_s: self.fall_s.as_ref().map(|fall_s| fall_s.end),
            first_contact: Some(self.contact),
            ..Events::default()
        }
    }

    /// True if one end has no transverse channel, and a signal was reconstructed for it.
    pub fn is_one_ended(&self) -> bool {
        self.reconstructed_end.is_some()
    }

    /// Returns the signals that were recorded.
    pub fn recorded(&self) -> &[Signal] {
        &self.signals[..self.signals.len() - usize::from(self.is_one_ended())]
    }
}

/// Signals of one recorder around its first contact, and the time of that on its clock.
pub(super) struct RecorderContact {
    pub signals: Vec<Signal>,
    pub at: At,
}

/// Finds the first contact in the channels of one recorder alone.
pub(super) fn recorder_contact(recording: &Recording, file: &CaskFile) -> Option<RecorderContact> {
    let least_m_s = file.drop.least_impact_m_s();
    let event =
        events::Changes::new(&recording.channels).locate(missing_end::least_step_m_s(file, recording));
    let event = event.filter(|event| event.velocity_step_m_s.abs() > least_m_s)?;
    let reach = condition::Reach::for_drop(&file.cask, &file.drop);
    let (mut signals, _) = condition_event(recording, file, &event, &reach);
    skin::turn_into_plane(&mut signals, &file.channels);
    let at = first_contact(&file.cask, &signals, &event)?;
    Some(RecorderContact { signals, at })
}

/// Standard uncertainty of R's times from the joined clocks of two recorders that show one end each, s.
fn u_joined_s(recording: &Recording, signals: &[Signal]) -> f64 {
    let ends = [End::First, End::Second].map(|end| transverse(signals, end));
    let separates_ends = |joined: &JoinedRecording| {
        let own = |signal: &Signal| joined.channels.contains(&signal.name);
        ends[0].is_some_and(own) != ends[1].is_some_and(own)
    };
    recording.joined.iter().filter(|joined| separates_ends(joined)).map(|j| j.u_s).fold(0.0, f64::hypot)
}

/// Conditions the signals around the event, with their findings.
fn condition_event(
    recording: &Recording,
    file: &CaskFile,
    event: &CoarseEvent,
    reach: &condition::Reach,
) -> (Vec<Signal>, Vec<Finding>) {
    let (signals, found) = condition::condition(recording, event, reach, file.corrections);
    match shorten_event(event, &signals, &found) {
        Some(nearer) => condition::condition(recording, &nearer, reach, file.corrections),
        None => (signals, found),
    }
}

/// Exchanges the axes of an impact onto an end face: the axial channels then show it like the transverse ones
/// a slap-down.
fn exchange_axes(signals: &mut [Signal], is_on_end: bool) {
    for signal in signals.iter_mut().filter(|_| is_on_end) {
        signal.axis = if signal.axis == Axis::Axial { Axis::Transverse } else { Axis::Axial };
    }
}

/// Finds when L first touches, even if only R shows it: a bending wave takes its time from L to R.
fn first_contact(cask: &Cask, signals: &[Signal], event: &CoarseEvent) -> Option<At> {
    let contact = events::first_contact(signals, event)?;
    let is_seen_at_once = transverse(signals, End::First).is_some();
    let u_way_s = cask.length_m / BENDING_WAVE_M_S / 12.0_f64.sqrt();
    Some(if is_seen_at_once { contact } else { At { u_s: contact.u_s.hypot(u_way_s), ..contact } })
}

/// Shortens the coarse event to begin where a channel first answers, if the free fall before it is too short
/// for an offset: the event may begin earlier by its own width, most of which is free fall.
fn shorten_event(event: &CoarseEvent, signals: &[Signal], found: &[Finding]) -> Option<CoarseEvent> {
    let is_short = |f: &Finding| matches!(f.what, FindingKind::Channel(ChannelFinding::ShortFreeFall { .. }));
    let contact = found.iter().any(is_short).then(|| events::first_contact(signals, event))??;
    let answers = events::answers(signals, contact.time_s);
    let early_s = answers.iter().map(|answer| answer.delay_s).fold(0.0, f64::min);
    let near_s = (contact.time_s + early_s - contact.u_s).max(event.near_s);
    Some(CoarseEvent { near_s, spread_s: (event.near_s + event.spread_s - near_s).max(0.0), ..*event })
}

/// Adds the signal of an end without one, for the angle of the cask in the middle of the contact.
fn add_end(file: &CaskFile, signals: &mut Vec<Signal>, contact_s: f64) -> Option<ReconstructedEnd> {
    let mut reconstructed_end = missing_end::add_signal(file, signals, contact_s)?;
    let turned_rad = flight_search::rotation_in_contact_rad(file, signals, contact_s).unwrap_or(0.0);
    reconstructed_end.apply_rotation(file, signals, turned_rad);
    Some(reconstructed_end)
}

/// Shifts channels back whose clock is apart, if that correction may be made; returns the standard
/// uncertainty of R's times from delays that a bending wave of up to `waves_s` explains as well, s.
fn align(
    file: &CaskFile,
    signals: &mut [Signal],
    contact_s: f64,
    waves_s: [f64; 2],
    findings: &mut Vec<Finding>,
) -> f64 {
    let onsets = events::answers(signals, contact_s);
    let mut u_skew_s = 0.0_f64;
    for onset in &onsets {
        let Some(finding) = judge::judge_skew(onset, signals, waves_s, file.corrections.skew) else {
            continue;
        };
        let is_shifted = finding.severity == Severity::Warning && file.corrections.skew;
        findings.push(finding);
        let Some(signal) = signals.iter_mut().find(|s| s.name == onset.channel) else { continue };
        if is_shifted {
            signal.start_s -= onset.delay_s;
        }
        if signal.end == End::Second {
            let open_s = if is_shifted { onset.u_s } else { onset.delay_s / 3.0_f64.sqrt() };
            u_skew_s = u_skew_s.max(open_s.abs());
        }
    }
    u_skew_s
}

/// Finds the levels of the channels at rest, and the free fall from the channel whose level is known best.
fn find_rest_and_fall(
    recording: &Recording,
    drop: &Drop,
    contact_s: f64,
    struck: Axis,
) -> (Vec<RestLevel>, Option<Range<f64>>) {
    // An AC-coupled channel shows neither rest nor fall.
    let steady = recording.channels.iter().filter(|c| c.coupling == Coupling::Dc);
    let fall = |c| events::free_fall(c, drop, contact_s).map(|fall| (c, fall));
    let falls: Vec<(&Channel, events::FreeFall)> = steady.filter_map(fall).collect();
    let rest = |(channel, fall): &(&Channel, events::FreeFall)| RestLevel {
        channel: channel.name.clone(),
        axis: channel.axis,
        rest_m_s2: fall.rest_m_s2,
        u_m_s2: fall.u_rest_m_s2,
    };
    let across = falls.iter().filter(|(channel, _)| channel.axis == struck);
    let best = across.min_by(|a, b| a.1.u_rest_m_s2.total_cmp(&b.1.u_rest_m_s2));
    (falls.iter().map(rest).collect(), best.map(|(_, fall)| fall.release_s..fall.end_s))
}
