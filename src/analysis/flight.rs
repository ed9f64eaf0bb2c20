//! Finds the flight after a first impact: separation, slap-down, and the motion between them.

use super::flight_search;
use super::impact::Impact;
use super::impacts::{self, ImpactTables};
use super::rotation;
use super::second_impact::{Mirror, SecondImpact};
use super::setup::{apply_law, sticking};
use crate::data::{
    AssumedFriction, At, AxialSource, Axis, CaskFile, Contact, DropFinding, End, Estimate, Events, Finding,
    FlightFit, Motion, Setup, Signal, Untested, transverse,
};
use crate::motion::{self, CornerRinging, Integrated};
use crate::{fit, judge};

/// Standard uncertainty of the length of a pulse, as a share, if its samples are clipped or missing, or if
/// only the other end shows it.
const U_PULSE_SHARE: f64 = 0.1;

/// The flight and the motion that it shows.
pub(super) struct FlightResult {
    pub flight: FlightFit,
    pub setup: Setup,
    pub motion: Motion,
    /// The selected method, with its quantities.
    pub method: fit::SelectedMethod,
    pub untested: Vec<Untested>,
    pub tables: Option<ImpactTables>,
    /// Speed of R's corner, with ringing and swinging.
    pub local_speed: Option<Estimate>,
    /// Standard uncertainties of the times of L and R from the distance between corner and sensor, s   (50)
    pub u_late_s: [f64; 2],
}

/// Finds the events, and the flight if the motion can be determined; adds findings on anything that prevents
/// it.
pub(super) fn find_flight(
    impact: &Impact,
    file: &CaskFile,
    findings: &mut Vec<Finding>,
) -> (Events, Option<FlightResult>) {
    let mut events = impact.events();
    let is_missing = |end: &End| transverse(&impact.signals, *end).is_none();
    let missing = [End::First, End::Second].into_iter().find(is_missing);
    if let Some(end) = impact.reconstructed_end.as_ref().map(|s| s.end).or(missing) {
        findings.push(DropFinding::MissingEnd { end, is_stood_in_for: impact.is_one_ended() }.into());
        if !impact.is_one_ended() {
            return (events, None);
        }
    }
    let integrated = Integrated::new(&impact.signals, impact.contact.time_s);
    let Some(flight) = fit_flight(impact, file, &integrated, &mut events, findings) else {
        return (events, None);
    };
    if let Some(slap_down) = &mut events.slap_down {
        slap_down.u_s = slap_down.u_s.hypot(impact.u_skew_s);
    }
    let solution = reconstruct(impact, file, &integrated, flight, &events);
    findings.extend(solution.as_ref().and_then(|s| judge_open_contact(file, &integrated, s, &events)));
    (events, solution)
}

/// Finds separation, slap-down and the flight between them.
fn fit_flight(
    impact: &Impact,
    file: &CaskFile,
    integrated: &Integrated,
    events: &mut Events,
    findings: &mut Vec<Finding>,
) -> Option<FlightFit> {
    let found = flight_search::find(file, integrated, impact.effort)?;
    let signals: &[Signal] = &integrated.signals;
    let is_reconstructed = |end| impact.reconstructed_end.as_ref().is_some_and(|s| s.end == end);
    let shows_slap_down = !is_reconstructed(End::Second);
    let contact_s = impact.contact.time_s;
    let At { time_s: left_s, u_s } = found.separation;
    let is_lost = |s: &Signal| [&s.clipped, &s.gaps].iter().any(|spans| s.overlaps(spans, contact_s, left_s));
    // The end of a pulse whose peak or flanks are incomplete is uncertain by a tenth of its length.
    let is_uncertain = is_reconstructed(End::First) || transverse(signals, End::First).is_some_and(is_lost);
    let u_pulse_s = if is_uncertain { U_PULSE_SHARE * (left_s - contact_s) } else { 0.0 };
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
    // A ringing seat delays the start and the end of the contact.
    events.first_contact = Some(At { u_s: impact.contact.u_s.hypot(found.seat_s), ..impact.contact });
    events.separation = Some(At { time_s: left_s, u_s: u_s.hypot(u_pulse_s).hypot(found.seat_s) });
    events.slap_down = found.slap_down.filter(|_| shows_slap_down);
    if events.slap_down.is_none() && shows_slap_down {
        let after_s = impact.search_end_s - left_s;
        findings.push(judge::judge_no_slap_down(&file.cask, &file.drop, after_s, impact.is_record_end));
    }
    let flight = found.flight.filter(|flight| !impact.is_one_ended() || flight.can_rank_fits());
    let Some(mut flight) = flight else {
        findings.push(DropFinding::ShortFlight.into());
        return None;
    };
    if let Some(reconstructed_end) = &impact.reconstructed_end {
        reconstructed_end.widen_uncertainty(&mut flight);
    }
    Some(flight)
}

/// Reconstructs the motion over the flight, with its quantities.
fn reconstruct(
    impact: &Impact,
    file: &CaskFile,
    integrated: &Integrated,
    flight: FlightFit,
    events: &Events,
) -> Option<FlightResult> {
    let signals = &impact.signals;
    let (setup, friction) = resolve_contact(file, integrated, &flight, events);
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
        // An end that was reconstructed from the mass properties cannot check them.
        inertia_m2: (cask.is_body && !impact.is_one_ended()).then_some(cask.inertia_kg_m2 / cask.mass_kg),
        rests: &impact.rests,
        rotations: &rotation::measure_rotations(impact, file, &flight, events),
        stood_in: impact.reconstructed_end.as_ref().and_then(|s| s.scaled_copy(signals)),
        fall_s: impact.fall_s.as_ref().map(|fall_s| fall_s.end - fall_s.start),
        second: None,
    };
    // The times at which R strikes and leaves depend so little on the inputs that they are determined before
    // the fit.
    let stated = motion::outcome(integrated, &flight, events, &setup)?;
    // A touch changes the ringing: then neither the second impact nor the corner is determined.
    let is_whole = flight.landing.is_none();
    let mirror = is_whole.then(|| Mirror::new(&integrated.signals, &stated, &measured)).flatten();
    let find = |is_open| SecondImpact::find(mirror.as_ref()?, file, &measured, is_open);
    let second = find(false);
    let method = select_method(integrated, &measured, second.as_ref())?;
    let fit::Inputs { flight: corrected, events: times, setup: corrected_setup, .. } = &method.taken;
    let motion = motion::reconstruct(integrated, corrected, times, corrected_setup)?;
    let u_late_s = [End::First, End::Second].map(|end| {
        let most_s = |s| motion::largest_delay_s(&flight, s, cask.length_m, method.quantities.duration.value);
        transverse(signals, end).map_or(0.0, most_s) / 3.0_f64.sqrt()
    });
    let tabulate =
        |second: Option<&SecondImpact>| impacts::tabulate(file, integrated, &method, second, u_late_s);
    let tables = tabulate(second.as_ref())
        .filter(|tables| tables.tables[1].is_some())
        .or_else(|| tabulate(find(true).as_ref()))
        .or_else(|| tabulate(None))
        .map(|t| if impact.is_one_ended() { t.without_course() } else { t });
    let untested = method.find_untested(&|flight| {
        let places = judge::transverse_places(&impact.signals);
        judge::judge_rigid(places, flight, &file.tolerances, &file.drop, events).is_some()
    });
    let ringing =
        events.slap_down.filter(|_| is_whole).map(|at| At { u_s: at.u_s.hypot(u_late_s[1]), ..at }).and_then(
            |at| motion::second_end_ringing(integrated, corrected, turning_rad_s, at, corrected_setup, cask),
        );
    let local_speed = ringing.and_then(|ringing| corner_speed(&motion, method.quantities.speed?, ringing));
    Some(FlightResult { flight, setup, motion, method, untested, tables, local_speed, u_late_s })
}

/// Selects the method, with the rotation of the second impact among the checks if the fit then has a
/// solution.
fn select_method(
    integrated: &Integrated,
    measured: &fit::FitData,
    second: Option<&SecondImpact>,
) -> Option<fit::SelectedMethod> {
    let reconstruct = |flight: &_, events: &_, setup: &_| motion::outcome(integrated, flight, events, setup);
    let without = || fit::run_methods(measured, &reconstruct);
    let Some(second) = second else { return without() };
    let contact = fit::SecondImpactData {
        inputs: &second.inputs(),
        excess_rotation_rad_s: &|inputs: &_, first: &_| second.excess_rotation_rad_s(inputs, first),
        rotation_rad_s: second.rotation_rad_s(),
    };
    fit::run_methods(&fit::FitData { second: Some(contact), ..*measured }, &reconstruct).or_else(without)
}

/// Speed of R's corner if ringing adds to the speed of the rigid body   (44)
fn corner_speed(motion: &Motion, rigid: Estimate, ringing: CornerRinging) -> Option<Estimate> {
    let ((x_m_s, z_m_s), at) = motion.second_end_m_s.zip(motion.slap_down)?;
    let (sin, cos) = at.angle_rad.sin_cos();
    let local_m_s = (x_m_s - ringing.velocity_m_s * sin).hypot(z_m_s + ringing.velocity_m_s * cos);
    let u95_m_s = rigid.u95.hypot(fit::COVERAGE * ringing.u_m_s);
    Some(Estimate::new(local_m_s, u95_m_s, "m/s"))
}

/// Decides how the axial velocity is determined: by measurement, or by a friction that the cask file states
/// or leaves open.
pub(super) fn resolve_contact(
    file: &CaskFile,
    integrated: &Integrated,
    flight: &FlightFit,
    events: &Events,
) -> (Setup, Option<AssumedFriction>) {
    let sticking = sticking(file);
    if integrated.signals.iter().any(|s| s.axis == Axis::Axial) {
        return (Setup { axial: AxialSource::Measured, ..sticking }, None);
    }
    // More friction than sticking needs has no effect.
    let needed =
        motion::outcome(integrated, flight, events, &sticking).map_or(0.0, |motion| motion.impulse_ratio);
    let (axial, friction) = apply_law(file, file.contact, needed);
    (Setup { axial, ..sticking }, Some(friction))
}

/// Reports the slap-down speeds with L sticking and without friction, if nothing shows which applies.
fn judge_open_contact(
    file: &CaskFile,
    integrated: &Integrated,
    solution: &FlightResult,
    events: &Events,
) -> Option<Finding> {
    if file.contact != Contact::Unknown || solution.setup.axial == AxialSource::Measured {
        return None;
    }
    let speed_m_s = |axial| {
        let setup = Setup { axial, ..solution.setup };
        let (x, z) = motion::outcome(integrated, &solution.flight, events, &setup)?.second_end_m_s?;
        Some(f64::hypot(x, z))
    };
    let sticking_m_s = speed_m_s(AxialSource::Sticking)?;
    let sliding_m_s = speed_m_s(AxialSource::Sliding { friction: 0.0 })?;
    let taken = solution.method.quantities.friction;
    Some(DropFinding::OpenContact { sticking_m_s, sliding_m_s, taken }.into())
}
