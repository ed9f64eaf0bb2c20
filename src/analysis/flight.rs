//! A first impact to the flight after it: separation, slap-down, and the motion between them.

use super::flight_search;
use super::impact::Impact;
use super::impacts::{self, Tabulated};
use super::rotation;
use super::second_impact::{Mirror, SecondImpact};
use super::setup::{by_law, sticking};
use crate::data::{
    AssumedFriction, At, AxialSource, Axis, CaskFile, Contact, Contribution, DropFinding, End, Estimate,
    Events, Finding, FlightFit, MethodChoice, Motion, OpenedInput, Quantities, Setup, Signal, Untested,
    transverse,
};
use crate::motion::{self, CornerRinging, Integrated};
use crate::{fit, judge};

/// What the length of a pulse is uncertain by, as a share, where its samples are clipped or missing, or only
/// the other end shows it.
const UNCERTAIN_PULSE: f64 = 0.1;

/// The flight, and what it says of the motion.
pub(super) struct FlightResult {
    pub flight: FlightFit,
    pub setup: Setup,
    pub motion: Motion,
    pub quantities: Quantities,
    pub budget: Vec<Contribution>,
    pub reconstruction: MethodChoice,
    pub untested: Vec<Untested>,
    /// Where a closure is missed, the inputs of which another number would explain it.
    pub opened_inputs: Vec<OpenedInput>,
    pub tabulated: Option<Tabulated>,
    /// The speed of R's corner, ringing and swinging included.
    pub local_speed: Option<Estimate>,
    /// Standard uncertainties of the times of L and R by the way from the corner to the sensor, s   (50)
    pub u_late_s: [f64; 2],
}

/// The events as far as they are found, and the flight where the motion could be had; what prevents it goes
/// to the findings.
pub(super) fn flight_result(
    impact: &Impact,
    file: &CaskFile,
    findings: &mut Vec<Finding>,
) -> (Events, Option<FlightResult>) {
    let mut events = impact.events();
    let is_missing = |end: &End| transverse(&impact.signals, *end).is_none();
    let missing = [End::First, End::Second].into_iter().find(is_missing);
    if let Some(end) = impact.stand_in.as_ref().map(|s| s.end).or(missing) {
        findings.push(DropFinding::MissingEnd { end, is_stood_in_for: impact.stand_in.is_some() }.into());
        if impact.stand_in.is_none() {
            return (events, None);
        }
    }
    let integrated = Integrated::new(&impact.signals, impact.contact.time_s);
    let Some(flight) = fitted(impact, file, &integrated, &mut events, findings) else {
        return (events, None);
    };
    if let Some(slap_down) = &mut events.slap_down {
        slap_down.u_s = slap_down.u_s.hypot(impact.u_skew_s);
    }
    let flown = moved(impact, file, &integrated, flight, &events);
    findings.extend(flown.as_ref().and_then(|flown| judge_open_contact(file, &integrated, flown, &events)));
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
    let found = flight_search::find(file, integrated, impact.effort)?;
    let signals: &[Signal] = &integrated.signals;
    let is_made = |end| impact.stand_in.as_ref().is_some_and(|s| s.end == end);
    let shows_slap_down = !is_made(End::Second);
    let contact_s = impact.contact.time_s;
    let At { time_s: left_s, u_s } = found.separation;
    let is_cut = |s: &Signal| [&s.clipped, &s.gaps].iter().any(|spans| s.overlaps(spans, contact_s, left_s));
    // A pulse without its peak or a part of its flanks ends where it fades out of less: a tenth of its
    // length.
    let is_uncertain = is_made(End::First) || transverse(signals, End::First).is_some_and(is_cut);
    let u_pulse_s = if is_uncertain { UNCERTAIN_PULSE * (left_s - contact_s) } else { 0.0 };
    if let Some(overlap) = judge::judge_overlap(left_s - contact_s, &file.cask, &file.drop, &file.tolerances)
    {
        findings.push(overlap);
        return None;
    }
    let is_in_order = left_s > contact_s && found.slap_down.is_none_or(|struck| struck.time_s > left_s);
    if !is_in_order {
        findings.push(DropFinding::ShortFlight.into());
        return None;
    }
    // A seat that rings answers late as the contact begins and as it ends.
    events.first_contact = Some(At { u_s: impact.contact.u_s.hypot(found.seat_s), ..impact.contact });
    events.separation = Some(At { time_s: left_s, u_s: u_s.hypot(u_pulse_s).hypot(found.seat_s) });
    events.slap_down = found.slap_down.filter(|_| shows_slap_down);
    if events.slap_down.is_none() && shows_slap_down {
        let after_s = impact.sought_to_s - left_s;
        findings.push(judge::judge_no_slap_down(&file.cask, &file.drop, after_s, impact.is_record_end));
    }
    let flight = found.flight.filter(|flight| impact.stand_in.is_none() || flight.can_rank_fits());
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
) -> Option<FlightResult> {
    let signals = &impact.signals;
    let (setup, friction) = contact(file, integrated, &flight, events);
    let contact_s = impact.contact.time_s;
    let events_s = [contact_s, events.separation_s().unwrap_or(contact_s)];
    let turning_rad_s = motion::spin_rad_s(signals, &flight, file.drop.angular_velocity_rad_s, events_s);
    let cask = &file.cask;
    let measured = fit::FitData {
        signals,
        flight: &flight,
        events,
        setup: &setup,
        friction,
        specs: &file.channels,
        tolerances: file.tolerances,
        // An end that the mass properties stand in for cannot test them.
        inertia_m2: (cask.is_body && impact.stand_in.is_none()).then_some(cask.inertia_kg_m2 / cask.mass_kg),
        rests: &impact.rests,
        rotations: &rotation::measured(impact, file, &flight, events),
        stood_in: impact.stand_in.as_ref().and_then(|s| s.stood_in(signals)),
        fall_s: impact.fall_s.as_ref().map(|fall_s| fall_s.end - fall_s.start),
        second: None,
    };
    // Where R strikes and leaves hangs on the inputs by so little that it need not wait for their fit.
    let stated = motion::outcome(integrated, &flight, events, &setup)?;
    // What rings behind a touch is not what rang before it: neither the second impact nor the corner is told.
    let is_whole = flight.landing.is_none();
    let mirror = is_whole.then(|| Mirror::of(&integrated.signals, &stated, &measured)).flatten();
    let find = |is_open| SecondImpact::find(mirror.as_ref()?, file, &measured, is_open);
    let second = find(false);
    let taken = taken(integrated, &measured, second.as_ref())?;
    let fit::Inputs { flight: moved, events: times, setup: as_taken, .. } = &taken.taken;
    let motion = motion::reconstruct(integrated, moved, times, as_taken)?;
    let up_to_crush = if second.is_none() { find(true) } else { None };
    let u_late_s = [End::First, End::Second].map(|end| {
        let most_s = |s| motion::largest_delay_s(&flight, s, cask.length_m, taken.quantities.duration.value);
        transverse(signals, end).map_or(0.0, most_s) / 3.0_f64.sqrt()
    });
    let tabulated = |second| impacts::tabulated(file, integrated, &taken, second, u_late_s);
    let tabulated = tabulated(second.as_ref().or(up_to_crush.as_ref()))
        .or_else(|| tabulated(None))
        .map(|t| if impact.stand_in.is_some() { t.without_course() } else { t });
    let untested = taken.find_untested(&|flight| {
        let places = judge::places(&impact.signals);
        judge::judge_rigid(places, flight, &file.tolerances, &file.drop, events).is_some()
    });
    let ringing = events
        .slap_down
        .filter(|_| is_whole)
        .map(|at| At { u_s: at.u_s.hypot(u_late_s[1]), ..at })
        .and_then(|at| motion::second_end_ringing(integrated, moved, turning_rad_s, at, as_taken, cask));
    let local_speed = ringing.and_then(|ringing| of_corner(&motion, taken.quantities.speed?, ringing));
    let fit::SelectedMethod { quantities, budget, choice: reconstruction, opened_inputs, .. } = taken;
    Some(FlightResult {
        flight,
        setup,
        motion,
        quantities,
        budget,
        reconstruction,
        untested,
        opened_inputs,
        tabulated,
        local_speed,
        u_late_s,
    })
}

/// The rung that is taken, with the rotation of the second impact among its closures where the fit finds an
/// answer so.
fn taken(
    integrated: &Integrated,
    measured: &fit::FitData,
    second: Option<&SecondImpact>,
) -> Option<fit::SelectedMethod> {
    let moved = |flight: &_, events: &_, setup: &_| motion::outcome(integrated, flight, events, setup);
    let without = || fit::run_methods(measured, &moved);
    let Some(second) = second else { return without() };
    let contact = fit::SecondImpactData {
        inputs: &second.inputs(),
        excess_rotation_rad_s: &|inputs: &_, first: &_| second.turned_beyond_rad_s(inputs, first),
        rotation_rad_s: second.turned_rad_s(),
    };
    fit::run_methods(&fit::FitData { second: Some(contact), ..*measured }, &moved).or_else(without)
}

/// The speed of R's corner where ringing adds to that of the rigid body   (44)
fn of_corner(motion: &Motion, rigid: Estimate, ringing: CornerRinging) -> Option<Estimate> {
    let ((x_m_s, z_m_s), at) = motion.second_end_m_s.zip(motion.slap_down)?;
    let (sin, cos) = at.angle_rad.sin_cos();
    let local_m_s = (x_m_s - ringing.velocity_m_s * sin).hypot(z_m_s + ringing.velocity_m_s * cos);
    let u95_m_s = rigid.u95.hypot(fit::COVERAGE * ringing.u_m_s);
    Some(Estimate::new(local_m_s, u95_m_s, "m/s"))
}

/// How the axial velocity is had: measured, or by a friction that the cask file states or leaves open.
pub(super) fn contact(
    file: &CaskFile,
    integrated: &Integrated,
    flight: &FlightFit,
    events: &Events,
) -> (Setup, Option<AssumedFriction>) {
    let sticking = sticking(file);
    if integrated.signals.iter().any(|s| s.axis == Axis::Axial) {
        return (Setup { axial: AxialSource::Measured, ..sticking }, None);
    }
    // What sticking needs; more friction than that does nothing.
    let needed =
        motion::outcome(integrated, flight, events, &sticking).map_or(0.0, |motion| motion.impulse_ratio);
    let (axial, friction) = by_law(file, file.contact, needed);
    (Setup { axial, ..sticking }, Some(friction))
}

/// What the slap-down speed would be with L stuck and without friction, where nothing tells which.
fn judge_open_contact(
    file: &CaskFile,
    integrated: &Integrated,
    flown: &FlightResult,
    events: &Events,
) -> Option<Finding> {
    if file.contact != Contact::Unknown || flown.setup.axial == AxialSource::Measured {
        return None;
    }
    let speed_m_s = |axial| {
        let setup = Setup { axial, ..flown.setup };
        let (x, z) = motion::outcome(integrated, &flown.flight, events, &setup)?.second_end_m_s?;
        Some(f64::hypot(x, z))
    };
    let sticking_m_s = speed_m_s(AxialSource::Sticking)?;
    let sliding_m_s = speed_m_s(AxialSource::Sliding { friction: 0.0 })?;
    let taken = flown.quantities.friction;
    Some(DropFinding::OpenContact { sticking_m_s, sliding_m_s, taken }.into())
}
