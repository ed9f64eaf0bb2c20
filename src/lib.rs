//! dropcheck: what accelerometers on both ends of a dropped cask say about its slap-down, and whether to believe it.
//!
//! A recording and a cask file pass through the stages in the order of [`analyze`]; every stage imports only [`data`] and
//! [`numerics`], so that this file alone knows the order.

mod assemble;
pub mod compare;
pub mod condition;
pub mod data;
pub mod events;
pub mod fit;
pub mod ingest;
pub mod judge;
#[cfg(feature = "lab")]
pub mod lab;
pub mod motion;
pub mod numerics;
mod one_end;
pub mod predict;
pub mod report;
mod settle;

use assemble::Draft;
use data::{
    Analysis, AxialClosure, Axis, CaskFile, Channel, Contact, Coupling, Events, FlightFit, Motion,
    Quantities, ReconstructionChoice, Recording, RestLevel, RivalLaw, Setup, Severity, Signal,
};
use one_end::StandIn;

/// What the length of a pulse is uncertain by, as a share, where its samples are clipped or missing, or only the other end shows it.
const UNCERTAIN_PULSE: f64 = 0.1;

/// Part of the way between two contact laws on which the change of the result is taken: a hundred times what friction is rounded to.
const RIVAL_WAY: f64 = 0.1;

/// From a recording and a cask file to everything that can be said of the drop.
///
/// What cannot be had is null in the result, with an issue that says why; the verdict says whether to believe the rest.
#[must_use]
pub fn analyze(recording: &Recording, cask_file: &CaskFile) -> Analysis {
    // On a thread of the pool: any other would be put to sleep and woken again for each piece of work that two threads share.
    rayon::scope(|_| analyzed(recording, cask_file))
}

fn analyzed(recording: &Recording, cask_file: &CaskFile) -> Analysis {
    let mut draft = Draft::new(recording, cask_file);
    let (silent, changes) =
        rayon::join(|| judge::judge_silent(&recording.channels), || events::Changes::of(recording));
    draft.issues.extend(silent);
    let Some(event) = changes
        .locate(one_end::least_step_m_s(cask_file, recording))
        .filter(|e| e.velocity_step_m_s.abs() > cask_file.drop.least_impact_m_s())
    else {
        return draft.without_impact();
    };
    let drop = &cask_file.drop;
    let another = changes.another_drop(&event, drop.impact_velocity_m_s / drop.gravity_m_s2);
    draft.issues.extend(another.map(|another| judge::judge_several_drops(&event, &another)));
    let farthest = condition::Reach::of(&cask_file.cask, drop);
    let last_s = changes.last_s(&event, (cask_file.drop.impact_velocity_m_s, farthest.after_s));
    let reach = last_s.map_or(farthest, |last_s| farthest.until(last_s - event.near_s - event.spread_s));
    let (mut signals, mut found) = condition::condition(recording, &event, &reach, cask_file.corrections);
    draft.issues.append(&mut found);
    let Some(mut contact) = events::first_contact(&signals, &event) else {
        return draft.without_impact();
    };
    if events::transverse(&signals, data::End::First).is_none() {
        // R shows it a bending wave's way later.
        contact.1 = contact.1.hypot(cask_file.cask.length_m / data::BENDING_WAVE_M_S / 12.0_f64.sqrt());
    }
    draft.events.first_contact_s = Some(contact.0);
    draft.u_events_s[0] = contact.1;
    let u_skew_s = align(&mut draft, &mut signals, contact.0);
    let recorded = signals.len();
    let mut stand_in = one_end::stand_in(cask_file, &mut signals, contact.0);
    if let Some(stand_in) = &mut stand_in {
        let turned_rad = settle::turned_rad(cask_file, &signals, contact.0).unwrap_or(0.0);
        stand_in.turn(cask_file, &mut signals, turned_rad);
    }
    let falls: Vec<_> = free_falls(recording, cask_file, contact.0).collect();
    for (channel, fall) in &falls {
        draft.rests.push(RestLevel {
            channel: channel.name.clone(),
            rest_m_s2: fall.rest_m_s2,
            u_m_s2: fall.u_rest_m_s2,
        });
    }
    // The channel that knows its levels best knows the release best.
    if let Some((_, fall)) = falls.iter().min_by(|a, b| a.1.u_rest_m_s2.total_cmp(&b.1.u_rest_m_s2)) {
        draft.events.release_s = Some(fall.release_s);
        draft.events.fall_end_s = Some(fall.end_s);
    }
    draft.issues.extend(judge::judge_fall(&cask_file.drop, &draft.events));
    let reconstructed = flight_and_motion(&mut draft, &signals, contact, (u_skew_s, stand_in.as_ref()));
    let (of_recorded, _) = signals.split_at(recorded);
    judge::weigh_by_distance(&mut draft.issues, &draft.events);
    let (on_channels, smooth) = rayon::join(
        || judge::judge_channels(of_recorded, &draft.events, cask_file, &draft.issues),
        || draft.smooth(&signals),
    );
    draft.issues.extend(on_channels);
    let mut motion_setup = None;
    if let Some(Reconstructed { flight, setup, motion, quantities, choice: reconstruction }) = reconstructed {
        draft.issues.extend(judge::judge_coupling(&signals, &flight, cask_file));
        draft.issues.extend(judge::judge_rigid(&signals, &flight, &cask_file.tolerances, &cask_file.drop));
        let known = (quantities.k, quantities.speed);
        let mut is_told = judge::tells_lost_steps(&reconstruction, known, of_recorded, contact.0);
        if !draft.issues.iter().any(|issue| judge::invalidates(issue, is_told)) {
            draft.issues.extend(judge::judge_motion(cask_file, &signals, &flight, &motion, &quantities));
            draft.issues.extend(judge::judge_strike(&flight, cask_file.drop.impact_velocity_m_s));
            draft.issues.extend(judge::judge_rest(of_recorded, &draft.events));
            draft.issues.extend(judge::judge_closures(&reconstruction, &cask_file.drop, &draft.events));
            let touched_m_s = touch_effect_m_s(cask_file, quantities.k.value);
            let length_m = cask_file.cask.length_m;
            draft.issues.extend(judge::judge_touch(&motion, &quantities, touched_m_s, length_m));
        }
        draft.flight = Some(flight);
        is_told &= !draft.issues.iter().any(judge::contradicts_motion);
        if draft.issues.iter().any(|issue| judge::invalidates(issue, is_told)) {
            // What an error speaks against is not stated at all: the times and curves remain.
            draft.draw(of_recorded, &smooth, None);
            return draft.finish();
        }
        let compared =
            compare::compare(&predict::bodies(&cask_file.cask), cask_file, &quantities, &predict::predict_by);
        if let Some(comparison) = compared.as_ref().and_then(|c| c.1) {
            draft.issues.extend(judge::judge_comparison(&comparison));
        }
        draft.measured(quantities, reconstruction, compared);
        draft.curves.motion = Some(motion.curve);
        motion_setup = Some(setup);
    }
    draft.draw(of_recorded, &smooth, motion_setup.as_ref());
    draft.finish()
}

/// What touches of L that are too shallow to count as impacts change of the predicted slap-down speed, m/s.
fn touch_effect_m_s(cask_file: &CaskFile, k: f64) -> f64 {
    let body = predict::body(&cask_file.cask, data::BodyModel::Body);
    let speed_m_s = |graze_share: f64| {
        let k = k.clamp(0.0, 1.0);
        predict::predict_grazing(&body, &cask_file.drop, cask_file.contact, k, graze_share)
            .slap_down_speed_m_s
    };
    speed_m_s(data::GRAZE_SHARE).zip(speed_m_s(0.0)).map_or(0.0, |(grazed, struck)| (grazed - struck).abs())
}

/// Shifts channels whose clock is apart back, if that correction may be made; returns what a delay that a bending wave explains as well
/// leaves open of R's times, as a standard uncertainty, s.
fn align(draft: &mut Draft, signals: &mut [Signal], contact_s: f64) -> f64 {
    let file = draft.cask_file;
    let onsets = events::answers(signals, contact_s);
    let issues = judge::judge_skew(&onsets, signals, &file.cask, file.corrections.skew);
    let mut u_skew_s = 0.0_f64;
    for issue in &issues {
        let Some(onset) = onsets.iter().find(|o| issue.channel.as_ref() == Some(&o.channel)) else {
            continue;
        };
        let Some(signal) = signals.iter_mut().find(|s| s.name == onset.channel) else { continue };
        let is_apart = issue.severity == Severity::Warning;
        if is_apart && file.corrections.skew {
            signal.start_s -= onset.delay_s;
        }
        if signal.end == data::End::Second {
            let open_s =
                if is_apart && file.corrections.skew { onset.u_s } else { onset.delay_s / 3.0_f64.sqrt() };
            u_skew_s = u_skew_s.max(open_s.abs());
        }
    }
    draft.issues.extend(issues);
    u_skew_s
}

/// The free fall as each transverse channel shows it; an AC-coupled one knows neither rest nor fall.
fn free_falls<'a>(
    recording: &'a Recording,
    cask_file: &CaskFile,
    contact_s: f64,
) -> impl Iterator<Item = (&'a Channel, events::FreeFall)> {
    let drop = cask_file.drop;
    let steady =
        recording.channels.iter().filter(|c| c.axis == Axis::Transverse && c.coupling == Coupling::Dc);
    steady.filter_map(move |c| events::free_fall(c, &drop, contact_s).map(|fall| (c, fall)))
}

/// What the motion was had from and what it says.
struct Reconstructed {
    flight: FlightFit,
    setup: Setup,
    motion: Motion,
    quantities: Quantities,
    choice: ReconstructionChoice,
}

/// The flight fit, the motion and what is read off it; what prevents them goes to the draft's issues.
fn flight_and_motion(
    draft: &mut Draft,
    signals: &[Signal],
    contact: (f64, f64),
    (u_skew_s, stand_in): (f64, Option<&StandIn>),
) -> Option<Reconstructed> {
    let cask_file = draft.cask_file;
    let is_missing = |end: &data::End| events::transverse(signals, *end).is_none();
    let missing = [data::End::First, data::End::Second].into_iter().find(is_missing);
    if let Some(end) = stand_in.map(|s| s.end).or(missing) {
        draft.issues.push(judge::judge_missing_end(end, stand_in.is_some()));
        stand_in?;
    }
    let integrated = motion::Integrated::over(signals, contact.0);
    let mut flight = find_flight(draft, &integrated, contact, stand_in)?;
    if let Some(stand_in) = stand_in {
        if !flight.is_told_apart() {
            draft.flight_is_too_short();
            return None;
        }
        stand_in.doubt(&mut flight);
    }
    draft.u_events_s[2] = draft.u_events_s[2].hypot(u_skew_s);
    let setup = setup(cask_file, &integrated, &draft.events, &flight);
    let motion = motion::reconstruct(&integrated, &flight, &draft.events, &setup)?;
    let window = motion::Window {
        from_s: flight.from_s,
        to_s: flight.to_s,
        drift: flight.drift,
        angular_velocity_rad_s: motion::rotation_rad_s(signals, &flight),
    };
    let plain = motion::mean_of_flight(&integrated, &flight, &window, setup.cog_m);
    let cask = &cask_file.cask;
    let measured = fit::Measured {
        signals,
        flight: &flight,
        events: &draft.events,
        u_events_s: draft.u_events_s,
        setup: &setup,
        rival_law: rival_law(cask_file, &integrated, &flight, &draft.events, setup.axial),
        tolerances: cask_file.tolerances,
        // An end that the mass properties stand in for cannot test them.
        inertia_m2: (cask.is_body && stand_in.is_none()).then_some(cask.inertia_kg_m2 / cask.mass_kg),
        rests: &draft.rests,
        stood_in: stand_in.and_then(|s| s.stood_in(signals)),
        fall_s: draft
            .events
            .release_s
            .zip(draft.events.fall_end_s)
            .map(|(release_s, end_s)| end_s - release_s),
    };
    let reading = motion::read_channels(&integrated, &draft.events, &setup);
    let moved = |flight: &_, events: &_, setup: &_| motion::outcome(&integrated, flight, events, setup);
    let (quantities, choice) = fit::ladder(&measured, plain.as_ref(), reading, &moved)?;
    Some(Reconstructed { flight, setup, motion, quantities, choice })
}

/// Separation, slap-down and the flight between them; what prevents them goes to the draft's issues.
fn find_flight(
    draft: &mut Draft,
    integrated: &motion::Integrated,
    contact: (f64, f64),
    stand_in: Option<&StandIn>,
) -> Option<FlightFit> {
    let settled = settle::settle(draft.cask_file, integrated)?;
    let signals: &[Signal] = &integrated.signals;
    let is_made = |end| stand_in.is_some_and(|s| s.end == end);
    let shows_slap_down = !is_made(data::End::Second);
    let struck = settled.struck.filter(|_| shows_slap_down);
    let left_s = settled.left.0;
    let is_cut = |s: &Signal| [&s.clipped, &s.gaps].iter().any(|spans| s.touches(spans, contact.0, left_s));
    let struck_end = events::transverse(signals, data::End::First);
    // A pulse without its peak or a part of its flanks ends where it fades out of less: a tenth of its length.
    let is_uncertain = is_made(data::End::First) || struck_end.is_some_and(is_cut);
    let u_pulse_s = if is_uncertain { UNCERTAIN_PULSE * (left_s - contact.0) } else { 0.0 };
    let left = (left_s, settled.left.1.hypot(u_pulse_s));
    draft.take_times(contact, left, struck);
    if struck.is_none() && shows_slap_down {
        draft.no_slap_down(settle::record_end_s(signals) - left_s);
    }
    if settled.flight.is_none() {
        draft.flight_is_too_short();
    }
    settled.flight
}

/// How the axial velocity is had: measured, or by the contact law of the cask file.
fn setup(
    cask_file: &CaskFile,
    integrated: &motion::Integrated,
    events: &Events,
    flight: &FlightFit,
) -> Setup {
    let base = assemble::sticking(cask_file);
    if integrated.signals.iter().any(|s| s.axis == Axis::Axial) {
        return Setup { axial: AxialClosure::Measured, ..base };
    }
    let axial = match cask_file.contact {
        Contact::Rough => AxialClosure::Sticking,
        Contact::Smooth => sliding(0.0),
        Contact::Coulomb(mu) => {
            let needed = motion::outcome(integrated, flight, events, &base).map_or(0.0, |m| m.impulse_ratio);
            if needed.abs() <= mu { AxialClosure::Sticking } else { sliding(mu) }
        }
    };
    Setup { axial, ..base }
}

/// A law near the stated one on the way to the other; what that way changes bends, and only its beginning is within the tolerance.
fn rival_law(
    cask_file: &CaskFile,
    integrated: &motion::Integrated,
    flight: &FlightFit,
    events: &Events,
    stated: AxialClosure,
) -> Option<RivalLaw> {
    let held = motion::outcome(integrated, flight, events, &assemble::sticking(cask_file))?;
    let holds = held.impulse_ratio.max(0.0);
    let mu = match stated {
        AxialClosure::Measured => return None,
        AxialClosure::Sticking => holds * (1.0 - RIVAL_WAY),
        AxialClosure::Sliding { friction_ppm } => {
            let mu = f64::from(friction_ppm) * 1e-6;
            mu + RIVAL_WAY * (holds - mu)
        }
    };
    Some(RivalLaw { axial: sliding(mu), way: RIVAL_WAY })
}

/// Sliding with this friction.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to 0..=1000 before the cast")]
fn sliding(mu: f64) -> AxialClosure {
    AxialClosure::Sliding { friction_ppm: (mu.clamp(0.0, 1e3) * 1e6) as u32 }
}
