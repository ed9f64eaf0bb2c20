//! Analyses a drop from a recording and a cask file: the order of all stages.
//!
//! A sound recording is analysed once. Some are analysed again:
//!
//! - a channel answers later or earlier than on any cask, and the flight shows a slow mode: once more, with
//!   the wave of that mode (`find_impact_and_flight`);
//! - there is no slap-down, and the record continues: with a longer search (`analyse_once`);
//! - a drop onto an end has no slap-down: the first impact alone, along the axis (`end_drop`);
//! - there is an angular-rate sensor, and no rotation is stated: once before, for the rotation
//!   (`add_measured_rotation`);
//! - the result contradicts itself, with at least three transverse channels: without each of them
//!   (`second_look`);
//! - a contradiction remains, or only ringing removes the motion: with each usual mistake corrected; for
//!   another contradiction also with each number that would explain it, up to twice (`causes`).

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
use comparison::JudgedFlight;
use end_drop::EndImpact;
use flight::FlightResult;
use flight_search::SearchEffort;
use impact::{Impact, ImpactKind, ImpactSearch};
use rayon::prelude::*;
use std::borrow::Cow;

/// Analyses a recording with its cask file: everything that can be stated of the drop.
///
/// A quantity that cannot be determined is null in the result, with an issue that gives the reason; the
/// verdict says whether the others are reliable.
#[must_use]
pub fn analyze(recording: &Recording, cask_file: &CaskFile) -> Analysis {
    let recording = &*cut_stuck_ends(recording);
    // This runs on a thread of the pool: another thread would be put to sleep and woken for each piece of
    // work that two threads share.
    let mut analysis = measure(recording, cask_file);
    let cask_file = &analysis.cask_file.clone();
    rayon::scope(|_| causes::name_causes(recording, cask_file, &mut analysis));
    let result = &mut analysis.result;
    result.keys = ingest::cask_file::settings(cask_file, recording);
    result.prototype = cask_file.scale.map(|scale| result.to_prototype(scale));
    result.observed = cask_file.observed.iter().map(|seen| judge::compare_observed(seen, result)).collect();
    result.limits = cask_file.limits.iter().map(|limit| judge::compare_limit(limit, result)).collect();
    result.quality.extend(judge::judge_observed(&result.observed));
    rayon::scope(|_| {
        others::add(recording, cask_file, &mut analysis);
        shocks::add(recording, cask_file, &mut analysis);
        simulation::add(recording, cask_file, &mut analysis);
    });
    let result = &mut analysis.result;
    result.verdict = judge::verdict(&mut result.quality);
    judge::sort_other_channels_last(&mut result.quality, &result.other_channels);
    result.find_missing();
    analysis
}

/// Runs [`analyze`] without the search for a usual mistake, which names one and changes no number.
pub fn measure(recording: &Recording, cask_file: &CaskFile) -> Analysis {
    let recording = &*cut_stuck_ends(recording);
    rayon::scope(|_| {
        let cask_file = &add_measured_rotation(recording, cask_file);
        let analysis = analyse_once(recording, cask_file, SearchEffort::EveryStart);
        second_look::leave_one_out(recording, cask_file, analysis)
    })
}

/// Cuts off the samples of channels that stand at their stop to the end: they show no force, and exceed the
/// impact. A channel beside others of its kind is left out; of any other the samples before remain.
fn cut_stuck_ends(recording: &Recording) -> Cow<'_, Recording> {
    let all = &recording.channels;
    let stuck: Vec<_> = all.par_iter().map(|channel| judge::judge_at_stop(channel, all)).collect();
    if stuck.iter().all(Option::is_none) {
        return Cow::Borrowed(recording);
    }
    let mut cut = recording.clone();
    let cut_channel = |(mut channel, stuck): (Channel, Option<(usize, Finding)>)| {
        let Some((kept, finding)) = stuck else { return Some(channel) };
        cut.issues.push(finding);
        channel.samples.truncate(kept);
        (kept > 0).then_some(channel)
    };
    cut.channels = std::mem::take(&mut cut.channels).into_iter().zip(stuck).filter_map(cut_channel).collect();
    Cow::Owned(cut)
}

/// Keys of the rotation of the cask before the contact.
const ROTATION_KEYS: [&str; 2] = ["drop.angular_velocity_deg_s", "tolerance.angular_velocity_deg_s"];

/// Longest delay of the far end's answer to an impact, in periods of the cask's first bending mode: 0.12 to
/// 0.28 in a hundred answers of free beams of two to eight heights.
const WAVE_PERIODS: f64 = 0.3;

/// Findings, and the first impact if there is one.
type ImpactAndFlight = (Vec<Finding>, Option<AfterImpact>);

/// First impact with the events and the flight after it, or with the result of an end drop.
struct AfterImpact {
    impact: Impact,
    events: Events,
    solution: Option<FlightResult>,
    on_end: Option<EndImpact>,
}

/// Finds the first impact and the flight after it; again with slower waves if those explain an early or late
/// answer.
fn find_impact_and_flight(
    recording: &Recording,
    file: &CaskFile,
    kind: ImpactKind,
    effort: SearchEffort,
) -> ImpactAndFlight {
    let search = ImpactSearch { kind, effort, waves_s: [0.0, file.cask.length_m / BENDING_WAVE_M_S] };
    let found = find_once(recording, file, search);
    match slower_waves_s(&found, file.cask.length_m) {
        Some(waves_s) => find_once(recording, file, ImpactSearch { waves_s, ..search }),
        None => found,
    }
}

fn find_once(recording: &Recording, file: &CaskFile, search: ImpactSearch) -> ImpactAndFlight {
    let mut findings = recording.issues.clone();
    let after = Impact::find(recording, file, search, &mut findings).map(|impact| {
        let (events, solution, on_end) = if search.kind == ImpactKind::OnEnd {
            let (events, on_end) = end_drop::end_impact(&impact, file, &mut findings);
            (events, None, on_end)
        } else {
            let (events, solution) = flight::find_flight(&impact, file, &mut findings);
            (events, solution, None)
        };
        AfterImpact { impact, events, solution, on_end }
    });
    (findings, after)
}

/// Longest delay of the struck end's sensor, and of a bending wave along the cask, s, if it bends as slowly
/// as the flight shows and that explains an early or late answer.
fn slower_waves_s((findings, found): &ImpactAndFlight, length_m: f64) -> Option<[f64; 2]> {
    let AfterImpact { impact, events, solution, .. } = found.as_ref()?;
    let contact_s = events.separation_s()? - events.first_contact_s()?;
    let flight = &solution.as_ref()?.flight;
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

/// Adds the rotation before the contact that a sensor measured, unless the cask file states it.
fn add_measured_rotation<'a>(recording: &Recording, file: &'a CaskFile) -> Cow<'a, CaskFile> {
    let is_open = ROTATION_KEYS.iter().all(|key| file.defaults.iter().any(|default| default == key));
    let has_sensor = file.others.iter().any(|spec| spec.rate.is_some());
    let measured = (is_open && has_sensor).then(|| {
        let (_, found) = find_impact_and_flight(recording, file, ImpactKind::Usual, SearchEffort::EveryStart);
        let AfterImpact { impact, events, solution, .. } = found?;
        let read = rotation::measure_rotations(&impact, file, &solution?.flight, &events);
        let known = read.iter().filter_map(|rotation| rotation.before);
        known.min_by(|a, b| a.u_rad_s.total_cmp(&b.u_rad_s))
    });
    let Some(before) = measured.flatten() else { return Cow::Borrowed(file) };
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
    let (mut findings, mut found) = find_impact_and_flight(recording, file, ImpactKind::Usual, effort);
    // At steep angles a cask may strike later than its angle predicts.
    if found.as_ref().is_some_and(|f| f.events.slap_down.is_none() && f.impact.has_later_event) {
        let late = find_impact_and_flight(recording, file, ImpactKind::Late, effort);
        if late.1.as_ref().is_some_and(|f| f.events.slap_down.is_some()) {
            (findings, found) = late;
        }
    }
    // If the corner lies beyond the centre of gravity the cask turns back, and a later impact is no
    // slap-down.
    let has_slap_down = found.as_ref().is_some_and(|f| f.events.slap_down.is_some());
    let arm_m = planar::first_arm_m(file.cask.cog_m, file.cask.height_m, file.drop.angle_rad);
    if file.drop.is_on_end() && !(has_slap_down && arm_m > 0.0) {
        let on_end = find_impact_and_flight(recording, file, ImpactKind::OnEnd, effort);
        if on_end.1.is_some() {
            (findings, found) = on_end;
        }
    }
    let Some(found) = found else {
        return result::without_impact(recording, file, findings);
    };
    let AfterImpact { impact, events, solution, .. } = &found;
    judge::weigh_by_distance(&mut findings, events);
    let flight = solution.as_ref().map(|solution| &solution.flight);
    let (channel_findings, shown) = rayon::join(
        || judge::judge_channels(impact.recorded(), events, flight, file, &findings),
        || result::ShownSignals::new(&impact.signals, events, file),
    );
    findings.extend(channel_findings);
    let (cutoff_hz, _) = motion::cutoff_hz(file.filter, file.cask.mass_kg);
    findings.extend(judge::judge_jumps(impact.recorded(), events));
    findings.extend(judge::judge_quiet(impact.recorded(), events));
    let narrow = judge::judge_bandwidth(impact.recorded(), events, cutoff_hz, &findings);
    findings.extend(narrow);
    let across = [&impact.across, impact.recorded()];
    findings.extend(skin::judge_across(across, &impact.others.channels, events, file));
    let judged = |solution: &FlightResult| JudgedFlight::judge(solution, impact, events, file, &mut findings);
    let measured = solution.as_ref().and_then(judged);
    if measured.is_none() {
        findings.extend(judge::judge_fall_time(&findings, &file.drop, events, &file.tolerances));
    }
    result::after_impact(recording, file, findings, found, shown, measured)
}
