//! A recording and a cask file to everything that can be said of the drop: the order of the whole.
//!
//! A sound recording is gone through once. What else is gone through again, and why:
//!
//! - an answer later or earlier than any cask gives, and a flight with a slower mode: as before, with the
//!   wave of that mode (`flight_result`);
//! - no slap-down where the record goes on: with a longer search (`analyse_once`);
//! - an end drop without one: the first impact alone, along the axis (`end_drop`);
//! - an angular-rate sensor, and no rotation stated: once before, for the rotation (`with_rotation`);
//! - a contradiction and three transverse channels: without each of them (`second_look`);
//! - a contradiction that stays, and a motion that only its ringing takes: with each usual slip put right; a
//!   contradiction else with each number that would explain it, up to twice (`causes`).

mod causes;
mod check;
mod comparison;
mod end_drop;
mod first_look;
mod flight;
pub mod flight_search;
mod impact;
mod impacts;
pub mod missing_end;
mod others;
mod plan;
mod recorders;
mod rest;
mod result;
mod rotation;
mod second_impact;
mod second_look;
mod setup;
mod shocks;
mod simulation;
mod skin;

pub use check::check;
pub use first_look::look_at_each;
pub use plan::study;
pub use recorders::{complete, read, read_within};
pub use setup::sticking;

use crate::data::{
    Analysis, BENDING_WAVE_M_S, CaskFile, Channel, ChannelFinding, Drop, End, Events, Finding, FindingKind,
    Recording, planar, transverse,
};
use crate::{ingest, judge, motion};
use comparison::Measured;
use end_drop::EndImpact;
use flight::FlightResult;
use flight_search::SearchEffort;
use impact::{Impact, Seek, Sought};
use rayon::prelude::*;
use std::borrow::Cow;

/// From a recording and a cask file to everything that can be said of the drop.
///
/// What cannot be had is null in the result, with an issue that says why; the verdict says whether to believe
/// the rest.
#[must_use]
pub fn analyze(recording: &Recording, cask_file: &CaskFile) -> Analysis {
    let recording = &*without_torn_ends(recording);
    // On a thread of the pool: any other would be put to sleep and woken again for each piece of work that
    // two threads share.
    let mut found = measure(recording, cask_file);
    let cask_file = &found.cask_file.clone();
    rayon::scope(|_| causes::name_causes(recording, cask_file, &mut found));
    let result = &mut found.result;
    result.keys = ingest::cask_file::settings(cask_file, recording);
    result.prototype = cask_file.scale.map(|scale| result.to_prototype(scale));
    result.observed = cask_file.observed.iter().map(|seen| judge::beside(seen, result)).collect();
    result.limits = cask_file.limits.iter().map(|limit| judge::beside_limit(limit, result)).collect();
    result.quality.extend(judge::judge_observed(&result.observed));
    rayon::scope(|_| {
        others::add(recording, cask_file, &mut found);
        shocks::add(recording, cask_file, &mut found);
        simulation::add(recording, cask_file, &mut found);
    });
    let result = &mut found.result;
    result.verdict = judge::verdict(&mut result.quality);
    judge::behind_the_motion(&mut result.quality, &result.other_channels);
    result.find_missing();
    found
}

/// [`analyze`] without the search for a usual slip, which names one and changes no number.
pub fn measure(recording: &Recording, cask_file: &CaskFile) -> Analysis {
    let recording = &*without_torn_ends(recording);
    rayon::scope(|_| {
        let cask_file = &with_rotation(recording, cask_file);
        let whole = analyse_once(recording, cask_file, SearchEffort::EveryStart);
        second_look::leave_one_out(recording, cask_file, whole)
    })
}

/// The recording without what channels show that stand at their stop to the end: that is no force, and larger
/// than the impact. A channel beside others of its kind is left out, of any other what comes before remains.
fn without_torn_ends(recording: &Recording) -> Cow<'_, Recording> {
    let all = &recording.channels;
    let torn: Vec<_> = all.par_iter().map(|channel| judge::judge_torn(channel, all)).collect();
    if torn.iter().all(Option::is_none) {
        return Cow::Borrowed(recording);
    }
    let mut cut = recording.clone();
    let before = |(mut channel, torn): (Channel, Option<(usize, Finding)>)| {
        let Some((from, finding)) = torn else { return Some(channel) };
        let is_left_out = matches!(
            finding.what,
            FindingKind::Channel(ChannelFinding::AtStop { is_beside_others: true, .. })
        );
        cut.issues.push(finding);
        channel.samples.truncate(from);
        (!is_left_out).then_some(channel)
    };
    cut.channels = std::mem::take(&mut cut.channels).into_iter().zip(torn).filter_map(before).collect();
    Cow::Owned(cut)
}

/// The keys that say how the cask turns before the contact.
const OF_ROTATION: [&str; 2] = ["drop.angular_velocity_deg_s", "tolerance.angular_velocity_deg_s"];

/// The far end of a cask answers a blow on the other within this share of a period of its first bending mode:
/// 0.12 to 0.28 in a hundred answers of free beams of two to eight heights.
const WAVE_PERIODS: f64 = 0.3;

/// The findings, and the first impact if there is one.
type ImpactAndFlight = (Vec<Finding>, Option<AfterImpact>);

/// A first impact with the events and the flight that follow it, or what an end drop shows.
struct AfterImpact {
    impact: Impact,
    events: Events,
    flown: Option<FlightResult>,
    on_end: Option<EndImpact>,
}

/// The findings, and the first impact with the flight after it.
fn flight_result(
    recording: &Recording,
    file: &CaskFile,
    sought: Sought,
    effort: SearchEffort,
) -> ImpactAndFlight {
    let seek = Seek { sought, effort, waves_s: [0.0, file.cask.length_m / BENDING_WAVE_M_S] };
    let found = impact_and_flight(recording, file, seek);
    match slower_waves_s(&found, file.cask.length_m) {
        Some(waves_s) => impact_and_flight(recording, file, Seek { waves_s, ..seek }),
        None => found,
    }
}

fn impact_and_flight(recording: &Recording, file: &CaskFile, seek: Seek) -> ImpactAndFlight {
    let mut findings = recording.issues.clone();
    let struck = Impact::find(recording, file, seek, &mut findings).map(|impact| {
        let (events, flown, on_end) = if seek.sought == Sought::OnEnd {
            let (events, on_end) = end_drop::end_impact(&impact, file, &mut findings);
            (events, None, on_end)
        } else {
            let (events, flown) = flight::flight_result(&impact, file, &mut findings);
            (events, flown, None)
        };
        AfterImpact { impact, events, flown, on_end }
    });
    (findings, struck)
}

/// How late the struck end's sensor may answer, and what a bending wave takes along a cask that bends as the
/// flight shows, s, where that explains an answer which was early or late for any cask.
fn slower_waves_s((findings, found): &ImpactAndFlight, length_m: f64) -> Option<[f64; 2]> {
    let AfterImpact { impact, events, flown, .. } = found.as_ref()?;
    let contact_s = events.separation_s()? - events.first_contact_s()?;
    let flight = &flown.as_ref()?.flight;
    let struck = transverse(&impact.signals, End::First)?;
    let lag_s = motion::largest_delay_s(flight, struck, length_m, contact_s);
    let wave_s = WAVE_PERIODS / flight.first_bending_hz(contact_s);
    let is_explained = |f: &Finding| match f.what {
        FindingKind::Channel(ChannelFinding::AnswersLate { delay_s, u_s, .. }) => {
            delay_s - 2.0 * u_s < wave_s
        }
        FindingKind::Channel(ChannelFinding::AnswersEarly { delay_s, u_s, .. }) => {
            -delay_s - 2.0 * u_s < lag_s
        }
        _ => false,
    };
    findings.iter().any(is_explained).then_some([lag_s, wave_s])
}

/// The file with the rotation before the contact that a sensor measured, where it says nothing of it.
fn with_rotation<'a>(recording: &Recording, file: &'a CaskFile) -> Cow<'a, CaskFile> {
    let is_left_out = OF_ROTATION.iter().all(|key| file.defaults.iter().any(|default| default == key));
    let has_sensor = file.others.iter().any(|spec| spec.rate.is_some());
    let before = (is_left_out && has_sensor).then(|| {
        let (_, found) = flight_result(recording, file, Sought::Usual, SearchEffort::EveryStart);
        let AfterImpact { impact, events, flown, .. } = found?;
        let read = rotation::measured(&impact, file, &flown?.flight, &events);
        let known = read.iter().filter_map(|rotation| rotation.before);
        known.min_by(|a, b| a.u_rad_s.total_cmp(&b.u_rad_s))
    });
    let Some(before) = before.flatten() else { return Cow::Borrowed(file) };
    let mut file = file.clone();
    file.drop = if file.drop.impact_velocity_given {
        Drop { angular_velocity_rad_s: before.rad_s, ..file.drop }
    } else {
        file.drop.add_rotation(&file.cask, before.rad_s)
    };
    file.is_rotation_measured = true;
    Cow::Owned(file)
}

fn analyse_once(recording: &Recording, file: &CaskFile, effort: SearchEffort) -> Analysis {
    let (mut findings, mut found) = flight_result(recording, file, Sought::Usual, effort);
    // From steep angles a cask may strike later than its angle has it.
    if found.as_ref().is_some_and(|f| f.events.slap_down.is_none() && f.impact.goes_on) {
        let farther = flight_result(recording, file, Sought::Late, effort);
        if farther.1.as_ref().is_some_and(|f| f.events.slap_down.is_some()) {
            (findings, found) = farther;
        }
    }
    // Beyond its centre of gravity the cask turns back, and what strikes later is no slap-down.
    let has_slap_down = found.as_ref().is_some_and(|f| f.events.slap_down.is_some());
    let arm_m = planar::first_arm_m(file.cask.cog_m, file.cask.height_m, file.drop.angle_rad);
    if file.drop.is_on_end() && !(has_slap_down && arm_m > 0.0) {
        let along = flight_result(recording, file, Sought::OnEnd, effort);
        if along.1.is_some() {
            (findings, found) = along;
        }
    }
    let Some(found) = found else {
        return result::without_impact(recording, file, findings);
    };
    let AfterImpact { impact, events, flown, .. } = &found;
    judge::weigh_by_distance(&mut findings, events);
    let flight = flown.as_ref().map(|flown| &flown.flight);
    let (on_channels, shown) = rayon::join(
        || judge::judge_channels(impact.recorded(), events, flight, file, &findings),
        || result::ShownSignals::of(&impact.signals, events, file),
    );
    findings.extend(on_channels);
    let (cutoff_hz, _) = motion::cutoff_hz(file.filter, file.cask.mass_kg);
    findings.extend(judge::judge_jumps(impact.recorded(), events));
    let filtered = judge::judge_bandwidth(impact.recorded(), events, cutoff_hz, &findings);
    findings.extend(filtered);
    let across = [&impact.across, impact.recorded()];
    findings.extend(skin::judge_across(across, &impact.others.channels, events, file));
    let judged = |flown: &FlightResult| Measured::of(flown, impact, events, file, &mut findings);
    let measured = flown.as_ref().and_then(judged);
    if measured.is_none() {
        findings.extend(judge::judge_fall_time(&findings, &file.drop, events, &file.tolerances));
    }
    result::of(recording, file, findings, found, shown, measured)
}
