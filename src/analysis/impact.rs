//! A recording to its first impact: the conditioned signals, when L touches, and what the time before it
//! shows.

use super::flight_search::{self, SearchEffort};
use super::{missing_end, rest, skin};
use crate::data::{
    At, Axis, BENDING_WAVE_M_S, Cask, CaskFile, Channel, ChannelFinding, CoarseEvent, Coupling, Drop,
    DropFinding, Effect, End, Events, Finding, FindingKind, JoinedRecording, OtherChannels, Recording,
    RestLevel, Severity, Signal, transverse,
};
use crate::events::HidingNoise;
use crate::{condition, events, judge};
use missing_end::StandIn;
use std::ops::Range;
use std::sync::Arc;

/// How a first impact and the flight after it are sought.
#[derive(Clone, Copy)]
pub(super) struct Seek {
    /// Which impacts.
    pub sought: Sought,
    /// How long the flight is sought.
    pub effort: SearchEffort,
    /// How much later than the corner the struck end's sensor may answer, and the longest that a bending wave
    /// takes along the cask, s.
    pub waves_s: [f64; 2],
}

/// Which impacts are sought: one on the edge of an end and a slap-down as late as the angle allows, or later,
/// or one on an end face, which the axial channels show.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Sought {
    Usual,
    Late,
    OnEnd,
}

/// The first impact, and what the analysis of it goes by.
pub(super) struct Impact {
    /// The conditioned signals; the last one stands in for an end that has none, where `stand_in` is.
    pub signals: Vec<Signal>,
    /// First contact of L.
    pub contact: At,
    /// Standard uncertainty of R's times that an unexplained delay between channels causes, s.
    pub u_skew_s: f64,
    /// The end without a transverse channel of its own.
    pub stand_in: Option<StandIn>,
    /// What the channels read at rest.
    pub rests: Vec<RestLevel>,
    /// From the release to the first touch, s, where the record shows them.
    pub fall_s: Option<Range<f64>>,
    /// How far the slap-down is sought, s; whether the record ends there, and whether something happens
    /// beyond that a longer flight explains.
    pub sought_to_s: f64,
    pub is_record_end: bool,
    pub goes_on: bool,
    /// How long the flight after it is sought.
    pub effort: SearchEffort,
    /// What pairs of sensors on the skin read across the plane of the drop.
    pub across: Vec<Signal>,
    /// The channels beside the accelerometers.
    pub others: Arc<OtherChannels>,
}

impl Impact {
    /// Finds the first impact and cuts the recording after the latest slap-down that the angle allows, or
    /// farther. `None` if no channel shows an impact; that is then the only finding.
    pub fn find(
        recording: &Recording,
        file: &CaskFile,
        seek: Seek,
        findings: &mut Vec<Finding>,
    ) -> Option<Self> {
        let drop = &file.drop;
        let is_on_end =
            seek.sought == Sought::OnEnd && recording.channels.iter().any(|c| c.axis == Axis::Axial);
        let struck = if is_on_end { Axis::Axial } else { Axis::Transverse };
        let is_told = |channel: &&Channel| !is_on_end || channel.axis == struck;
        let (silent, changes) = rayon::join(
            || judge::judge_silent(&recording.channels.iter().filter(is_told).collect::<Vec<_>>()),
            || events::Changes::along_axis(&recording.channels, struck),
        );
        findings.extend(silent.clone());
        let copied = judge::judge_copies(&recording.channels);
        let across_m_s = missing_end::least_step_m_s(file, recording);
        let least_step_m_s = if is_on_end { drop.impact_velocity_m_s } else { across_m_s };
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
        let farthest = if seek.sought == Sought::Late { usual.with_longest_flight() } else { usual };
        let last_within_s =
            |reach: condition::Reach| changes.last_s(&event, drop.impact_velocity_m_s, reach.after_s);
        let last_s = last_within_s(farthest);
        let goes_on = last_within_s(farthest.with_longest_flight()) > last_s;
        let reach =
            last_s.map_or(farthest, |last_s| farthest.limit_to(last_s - event.near_s - event.spread_s));
        let (mut signals, found) = conditioned(recording, file, &event, &reach);
        let left_out = silent.iter().filter(|f| f.effect == Effect::Channel).chain(&copied);
        signals.retain(|signal| left_out.clone().all(|f| f.channel.as_ref() != Some(&signal.name)));
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
        // Where nothing happens any more the record was looked at as far as any flight lasts.
        let sought = if goes_on { farthest } else { farthest.with_longest_flight() };
        let sought_to_s = event.near_s + event.spread_s + sought.after_s;
        let u_joined_s = u_joined_s(recording, &signals);
        let u_skew_s = align(file, &mut signals, contact.time_s, seek.waves_s, findings).hypot(u_joined_s);
        exchange_axes(&mut signals, is_on_end);
        let stand_in = (!is_on_end).then(|| with_both_ends(file, &mut signals, contact.time_s)).flatten();
        let (own_rests, fall_s) = before(recording, drop, contact.time_s, struck);
        let of_file = || rest::levels(recording, &signals, file, contact.time_s);
        let mut rests = if own_rests.is_empty() { of_file() } else { own_rests };
        skin::turn_rests(&mut rests, &across, &file.channels);
        let impact = Self {
            signals,
            contact,
            u_skew_s,
            stand_in,
            rests,
            fall_s,
            sought_to_s: sought_to_s.min(recording.end_s()),
            is_record_end: recording.end_s() <= sought_to_s,
            goes_on,
            effort: seek.effort,
            across,
            others: Arc::clone(&recording.others),
        };
        findings.extend(judge::judge_fall(drop, &impact.events()));
        Some(impact)
    }

    /// The events up to the first contact.
    pub fn events(&self) -> Events {
        Events {
            release_s: self.fall_s.as_ref().map(|fall_s| fall_s.start),
            fall_end_s: self.fall_s.as_ref().map(|fall_s| fall_s.end),
            first_contact: Some(self.contact),
            ..Events::default()
        }
    }

    /// The signals that were recorded.
    pub fn recorded(&self) -> &[Signal] {
        &self.signals[..self.signals.len() - usize::from(self.stand_in.is_some())]
    }
}

/// The signals of one recorder about its first contact, and when that is on its clock.
pub(super) struct OwnContact {
    pub signals: Vec<Signal>,
    pub at: At,
}

/// The first contact as the channels of a recorder show it by themselves.
pub(super) fn own_contact(recording: &Recording, file: &CaskFile) -> Option<OwnContact> {
    let least_m_s = file.drop.least_impact_m_s();
    let event =
        events::Changes::new(&recording.channels).locate(missing_end::least_step_m_s(file, recording));
    let event = event.filter(|event| event.velocity_step_m_s.abs() > least_m_s)?;
    let reach = condition::Reach::for_drop(&file.cask, &file.drop);
    let (mut signals, _) = conditioned(recording, file, &event, &reach);
    skin::turn_into_plane(&mut signals, &file.channels);
    let at = first_contact(&file.cask, &signals, &event)?;
    Some(OwnContact { signals, at })
}

/// What the clocks of two recorders that show one end each leave open of R's times, as a standard
/// uncertainty, s.
fn u_joined_s(recording: &Recording, signals: &[Signal]) -> f64 {
    let ends = [End::First, End::Second].map(|end| transverse(signals, end));
    let is_of = |joined: &JoinedRecording| {
        let own = |signal: &Signal| joined.channels.contains(&signal.name);
        ends[0].is_some_and(own) != ends[1].is_some_and(own)
    };
    recording.joined.iter().filter(|joined| is_of(joined)).map(|joined| joined.u_s).fold(0.0, f64::hypot)
}

/// The signals about the event, and what is to be said of them.
fn conditioned(
    recording: &Recording,
    file: &CaskFile,
    event: &CoarseEvent,
    reach: &condition::Reach,
) -> (Vec<Signal>, Vec<Finding>) {
    let (signals, found) = condition::condition(recording, event, reach, file.corrections);
    match nearer(event, &signals, &found) {
        Some(nearer) => condition::condition(recording, &nearer, reach, file.corrections),
        None => (signals, found),
    }
}

/// Onto an end face the axial channels show what the transverse ones do of a slap-down.
fn exchange_axes(signals: &mut [Signal], is_on_end: bool) {
    for signal in signals.iter_mut().filter(|_| is_on_end) {
        signal.axis = if signal.axis == Axis::Axial { Axis::Transverse } else { Axis::Axial };
    }
}

/// When L first touches, also where R alone shows it: a bending wave takes its time from L to R.
fn first_contact(cask: &Cask, signals: &[Signal], event: &CoarseEvent) -> Option<At> {
    let contact = events::first_contact(signals, event)?;
    let is_seen_at_once = transverse(signals, End::First).is_some();
    let u_way_s = cask.length_m / BENDING_WAVE_M_S / 12.0_f64.sqrt();
    Some(if is_seen_at_once { contact } else { At { u_s: contact.u_s.hypot(u_way_s), ..contact } })
}

/// The coarse event from where a channel first answers on, where too little free fall for an offset lies
/// before it: it begins up to its width before the contact, and a short free fall lies between for the most
/// part.
fn nearer(event: &CoarseEvent, signals: &[Signal], found: &[Finding]) -> Option<CoarseEvent> {
    let is_short = |f: &Finding| matches!(f.what, FindingKind::Channel(ChannelFinding::ShortFreeFall { .. }));
    let contact = found.iter().any(is_short).then(|| events::first_contact(signals, event))??;
    let answers = events::answers(signals, contact.time_s);
    let early_s = answers.iter().map(|answer| answer.delay_s).fold(0.0, f64::min);
    let near_s = (contact.time_s + early_s - contact.u_s).max(event.near_s);
    Some(CoarseEvent { near_s, spread_s: (event.near_s + event.spread_s - near_s).max(0.0), ..*event })
}

/// Adds the signal that stands in for an end without one, made for the angle that the cask has in the middle
/// of the contact.
fn with_both_ends(file: &CaskFile, signals: &mut Vec<Signal>, contact_s: f64) -> Option<StandIn> {
    let mut stand_in = missing_end::stand_in(file, signals, contact_s)?;
    let turned_rad = flight_search::turned_rad(file, signals, contact_s).unwrap_or(0.0);
    stand_in.turn(file, signals, turned_rad);
    Some(stand_in)
}

/// Shifts channels whose clock is apart back, if that correction may be made; returns what a delay that a
/// bending wave of up to `waves_s` explains as well leaves open of R's times, as a standard uncertainty, s.
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

/// What the channels read at rest, and the free fall by the one that knows its levels best.
fn before(
    recording: &Recording,
    drop: &Drop,
    contact_s: f64,
    struck: Axis,
) -> (Vec<RestLevel>, Option<Range<f64>>) {
    // An AC-coupled channel knows neither rest nor fall.
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
