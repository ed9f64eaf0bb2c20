//! A first impact to the flight after it: separation, slap-down, and the motion between them.

use super::impact::Impact;
use super::settle;
use super::setup::sticking;
use crate::data::{
    At, AxialClosure, Axis, CaskFile, Contact, DropFinding, End, Events, Finding, FlightFit, Motion,
    Quantities, ReconstructionChoice, RivalLaw, Setup, Signal,
};
use crate::motion::{self, Integrated};
use crate::{events, fit, judge};

/// What the length of a pulse is uncertain by, as a share, where its samples are clipped or missing, or only the other end shows it.
const UNCERTAIN_PULSE: f64 = 0.1;

/// Part of the way between two contact laws on which the change of the result is taken: a hundred times what friction is rounded to.
const RIVAL_WAY: f64 = 0.1;

/// The flight, and what it says of the motion.
pub(super) struct Flown {
    pub flight: FlightFit,
    pub setup: Setup,
    pub motion: Motion,
    pub quantities: Quantities,
    pub reconstruction: ReconstructionChoice,
}

/// The events as far as they are found, and the flight where the motion could be had; what prevents it goes to the findings.
pub(super) fn flown(
    impact: &Impact,
    file: &CaskFile,
    findings: &mut Vec<Finding>,
) -> (Events, Option<Flown>) {
    let mut events = impact.events();
    let is_missing = |end: &End| events::transverse(&impact.signals, *end).is_none();
    let missing = [End::First, End::Second].into_iter().find(is_missing);
    if let Some(end) = impact.stand_in.as_ref().map(|s| s.end).or(missing) {
        findings.push(DropFinding::MissingEnd { end, is_stood_in_for: impact.stand_in.is_some() }.into());
        if impact.stand_in.is_none() {
            return (events, None);
        }
    }
    let integrated = Integrated::over(&impact.signals, impact.contact.time_s);
    let Some(flight) = fitted(impact, file, &integrated, &mut events, findings) else {
        return (events, None);
    };
    if let Some(slap_down) = &mut events.slap_down {
        slap_down.u_s = slap_down.u_s.hypot(impact.u_skew_s);
    }
    let flown = moved(impact, file, &integrated, flight, &events);
    (events, flown)
}

/// Separation, slap-down and the flight between them.
fn fitted(
    impact: &Impact,
    file: &CaskFile,
    integrated: &Integrated,
    events: &mut Events,
    findings: &mut Vec<Finding>,
) -> Option<FlightFit> {
    let settled = settle::settle(file, integrated)?;
    let signals: &[Signal] = &integrated.signals;
    let is_made = |end| impact.stand_in.as_ref().is_some_and(|s| s.end == end);
    let shows_slap_down = !is_made(End::Second);
    let contact_s = impact.contact.time_s;
    let At { time_s: left_s, u_s } = settled.left;
    let is_cut = |s: &Signal| [&s.clipped, &s.gaps].iter().any(|spans| s.touches(spans, contact_s, left_s));
    // A pulse without its peak or a part of its flanks ends where it fades out of less: a tenth of its length.
    let is_uncertain = is_made(End::First) || events::transverse(signals, End::First).is_some_and(is_cut);
    let u_pulse_s = if is_uncertain { UNCERTAIN_PULSE * (left_s - contact_s) } else { 0.0 };
    events.separation = Some(At { time_s: left_s, u_s: u_s.hypot(u_pulse_s) });
    events.slap_down = settled.struck.filter(|_| shows_slap_down);
    if events.slap_down.is_none() && shows_slap_down {
        findings.push(judge::judge_no_slap_down(impact.sought_to_s - left_s, impact.is_record_end));
    }
    let flight = settled.flight.filter(|flight| impact.stand_in.is_none() || flight.is_told_apart());
    let Some(mut flight) = flight else {
        findings.push(DropFinding::ShortFlight.into());
        return None;
    };
    if let Some(stand_in) = &impact.stand_in {
        stand_in.doubt(&mut flight);
    }
    Some(flight)
}

/// The motion over the flight, and what it says in numbers.
fn moved(
    impact: &Impact,
    file: &CaskFile,
    integrated: &Integrated,
    flight: FlightFit,
    events: &Events,
) -> Option<Flown> {
    let signals = &impact.signals;
    let setup = setup(file, integrated, events, &flight);
    let motion = motion::reconstruct(integrated, &flight, events, &setup)?;
    let window = motion::Window {
        from_s: flight.from_s,
        to_s: flight.to_s,
        drift: flight.drift,
        angular_velocity_rad_s: motion::rotation_rad_s(signals, &flight),
    };
    let plain = motion::mean_of_flight(integrated, &flight, &window, setup.cog_m);
    let cask = &file.cask;
    let measured = fit::Basis {
        signals,
        flight: &flight,
        events,
        setup: &setup,
        rival_law: rival_law(file, integrated, &flight, events, setup.axial),
        tolerances: file.tolerances,
        // An end that the mass properties stand in for cannot test them.
        inertia_m2: (cask.is_body && impact.stand_in.is_none()).then_some(cask.inertia_kg_m2 / cask.mass_kg),
        rests: &impact.rests,
        stood_in: impact.stand_in.as_ref().and_then(|s| s.stood_in(signals)),
        fall_s: impact.fall_s.as_ref().map(|fall_s| fall_s.end - fall_s.start),
    };
    let reading = motion::read_channels(integrated, events, &setup);
    let moved = |flight: &_, events: &_, setup: &_| motion::outcome(integrated, flight, events, setup);
    let (quantities, reconstruction) = fit::ladder(&measured, plain.as_ref(), reading, &moved)?;
    Some(Flown { flight, setup, motion, quantities, reconstruction })
}

/// How the axial velocity is had: measured, or by the contact law of the cask file.
fn setup(file: &CaskFile, integrated: &Integrated, events: &Events, flight: &FlightFit) -> Setup {
    let base = sticking(file);
    if integrated.signals.iter().any(|s| s.axis == Axis::Axial) {
        return Setup { axial: AxialClosure::Measured, ..base };
    }
    let axial = match file.contact {
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
    file: &CaskFile,
    integrated: &Integrated,
    flight: &FlightFit,
    events: &Events,
    stated: AxialClosure,
) -> Option<RivalLaw> {
    let held = motion::outcome(integrated, flight, events, &sticking(file))?;
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
