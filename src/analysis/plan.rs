//! Plans the measurement of a drop from its cask file: range, rate and record that it needs, and sensors that
//! would narrow its intervals.

use super::flight;
use crate::data::{
    At, Axis, CaskFile, ChannelNeeds, ChannelSpec, Drop, End, Events, ExpectedIntervals, FlightFit,
    FlightRegime, MeasuringPlan, Plateau, Prediction, Quantities, RecordingNeeds, Signal, Study,
    StudyRequest, planar,
};
use crate::motion::{self, Integrated};
use crate::{fit, judge, predict};
use std::f64::consts::PI;

/// Largest coefficient of restitution for which range and record suffice.
const LARGEST_K: f64 = 1.0;
/// Time of first contact in the expected recording, s, and number of samples in the contact.
const CONTACT_S: f64 = 0.1;
const SAMPLES: f64 = 200.0;
/// Rounds of the search for the slap-down: each leaves at most a hundredth of the height.
const ROUNDS: usize = 4;

/// Studies the drop angle, and plans the measurement at the request's angle.
#[must_use]
pub fn study(file: &CaskFile, request: &StudyRequest) -> Study {
    let angle_rad = request.angle_deg.to_radians();
    let at_angle = CaskFile { drop: Drop { angle_rad, ..file.drop }, ..file.clone() };
    let ks = request.ks.iter().copied();
    let k = f64::midpoint(ks.clone().fold(f64::INFINITY, f64::min), ks.fold(0.0, f64::max));
    Study { plan: Some(make_plan(&at_angle, k)), ..predict::study(file, request) }
}

fn make_plan(file: &CaskFile, k: f64) -> MeasuringPlan {
    let mut plan = MeasuringPlan { needs: needs(file), k, intervals: Vec::new(), why_no_intervals: None };
    let shows = |end| file.channels.iter().any(|spec| spec.end == end && spec.axis == Axis::Transverse);
    if !shows(End::First) || !shows(End::Second) {
        plan.why_no_intervals = Some("the cask file has no transverse channel on each end");
        return plan;
    }
    // The intervals follow from the budget of the fit to the predicted impact, a half sine in each channel,
    // without noise and ringing   (48)
    let expected = |(with, specs): (&'static str, Vec<ChannelSpec>)| {
        let quantities = ExpectedDrop::new(file, &specs, k)?.quantities(file, &specs)?;
        let slap_down_speed_u95_m_s = quantities.speed?.u95;
        Some(ExpectedIntervals { with, slap_down_speed_u95_m_s, k_u95: quantities.k.u95 })
    };
    match candidates(file).into_iter().map(expected).collect() {
        Some(intervals) => plan.intervals = intervals,
        None => plan.why_no_intervals = Some("no single flight to a slap-down is predicted"),
    }
    plan
}

/// Ranges, rate and record that the predicted drop needs; without channels in the cask file for sensors at
/// both ends.
pub(super) fn needs(file: &CaskFile) -> RecordingNeeds {
    let predicted = predict::predict(&predict::richest_body(file), &file.drop, file.contact, LARGEST_K);
    let ends = [("first end", End::First, 0.0), ("second end", End::Second, file.cask.length_m)];
    let ends = ends.map(|(name, end, position_m)| ChannelSpec::new(name, end, "", position_m));
    let specs = if file.channels.is_empty() { &ends[..] } else { &file.channels };
    let channel = |spec: &ChannelSpec| {
        let peaks = judge::expected_peaks(largest_step_m_s(spec, file, &predicted), &file.drop);
        ChannelNeeds { name: spec.name.clone(), peaks }
    };
    let flight_s = predicted.flight_time_s.unwrap_or(0.0);
    let (longest_s, shortest_s) = judge::pulse_lengths_s(&file.drop);
    let sample_rate_hz = judge::fit_rate_hz(shortest_s);
    RecordingNeeds {
        channels: specs.iter().map(channel).collect(),
        sample_rate_hz,
        nothing_from_hz: judge::nothing_from_hz(sample_rate_hz),
        before_s: judge::LEAST_BEFORE_S,
        fall_s: file.drop.impact_velocity_m_s / file.drop.gravity_m_s2,
        flight_s,
        after_s: flight_s + 2.0 * longest_s,
    }
}

/// Largest change of velocity that a channel reads in the first impact, m/s: the reversed vertical velocity
/// of the first end, less the effect of the rotation   (47)
fn largest_step_m_s(spec: &ChannelSpec, file: &CaskFile, predicted: &Prediction) -> f64 {
    let (sin, cos) = file.drop.angle_rad.sin_cos();
    let turned_m_s = (1.0 + LARGEST_K) * file.drop.impact_velocity_m_s;
    match spec.axis {
        Axis::Transverse => (turned_m_s * cos - predicted.angular_velocity_rad_s * spec.position_m).abs(),
        Axis::Axial => turned_m_s * sin,
    }
}

/// Lists the channels as they are, and with one addition each.
fn candidates(file: &CaskFile) -> [(&'static str, Vec<ChannelSpec>); 3] {
    let copy_spec = |end: End, axis: Axis| {
        let is_at_end = |spec: &&ChannelSpec| spec.end == end && spec.axis == Axis::Transverse;
        let name = format!("another at the {end:?} end, {axis:?}");
        file.channels.iter().find(is_at_end).map(|spec| ChannelSpec {
            axis,
            name,
            calibration: None,
            reference: None,
            ..spec.clone()
        })
    };
    let with_added = |axis| {
        let added = [End::First, End::Second].into_iter().filter_map(|end| copy_spec(end, axis));
        file.channels.iter().cloned().chain(added).collect()
    };
    [
        ("", file.channels.clone()),
        ("an axial channel on each end", with_added(Axis::Axial)),
        ("another transverse channel on each end", with_added(Axis::Transverse)),
    ]
}

/// Predicted impact in the form of a measured one.
struct ExpectedDrop {
    integrated: Integrated<'static>,
    flight: FlightFit,
    events: Events,
}

impl ExpectedDrop {
    fn new(file: &CaskFile, specs: &[ChannelSpec], k: f64) -> Option<Self> {
        let at_once = Drop { contact_duration_s: 0.0, ..file.drop };
        let predicted = predict::predict(&predict::richest_body(file), &at_once, file.contact, k);
        let flies = predicted.first_end_impacts == 1 && predicted.regime == FlightRegime::Free;
        let flight_s = predicted.flight_time_s.filter(|_| flies && !predicted.turns_over())?;
        let lasts_s = judge::pulse_lengths_s(&file.drop).0;
        let u_s = 1.0 / (judge::fit_rate_hz(lasts_s) * 12.0_f64.sqrt());
        let at = |time_s| Some(At { time_s, u_s });
        let (left_s, struck_s) = (CONTACT_S + lasts_s, CONTACT_S + lasts_s / 2.0 + flight_s);
        if struck_s <= left_s {
            return None;
        }
        let events = Events {
            first_contact: at(CONTACT_S),
            separation: at(left_s),
            slap_down: at(struck_s),
            ..Events::default()
        };
        let mut specs: Vec<&ChannelSpec> = specs.iter().collect();
        specs.sort_by_key(|spec| spec.axis == Axis::Axial);
        let make = |spec: &&ChannelSpec| half_sine(spec, step_m_s(spec, file, &predicted), lasts_s, flight_s);
        let (signals, plateaus): (Vec<_>, Vec<_>) = specs.iter().map(make).unzip();
        let flight = FlightFit { from_s: left_s, to_s: struck_s, plateaus, ..FlightFit::default() };
        let integrated = Integrated::new(&signals, CONTACT_S).into_owned();
        Some(Self { integrated, flight, events })
    }

    fn quantities(mut self, file: &CaskFile, specs: &[ChannelSpec]) -> Option<Quantities> {
        let (setup, friction) = flight::resolve_contact(file, &self.integrated, &self.flight, &self.events);
        let reconstruct = |flight: &FlightFit, events: &Events, setup: &_| {
            motion::outcome(&self.integrated, flight, events, setup)
        };
        let mut motion = reconstruct(&self.flight, &self.events, &setup)?;
        for _ in 0..ROUNDS {
            let by_s = motion.second_end_height_m? / motion.second_end_m_s?.1;
            self.events.slap_down.as_mut()?.time_s -= by_s;
            motion = reconstruct(&self.flight, &self.events, &setup)?;
        }
        let rotation_rad_s = motion.separation.angular_velocity_rad_s - motion.contact.angular_velocity_rad_s;
        let measured = fit::FitData {
            signals: &self.integrated.signals,
            flight: &self.flight,
            events: &self.events,
            setup: &setup,
            friction,
            specs,
            tolerances: file.tolerances,
            // Inertia with which the half sine is consistent: the stated one but for the effect of the
            // rotation.
            inertia_m2: file.cask.is_body.then_some(motion.angular_impulse_m2_s / rotation_rad_s),
            rests: &[],
            fall_s: None,
            rotations: &[],
            stood_in: None,
            second: None,
        };
        Some(fit::run_methods(&measured, &reconstruct)?.quantities)
    }
}

/// Change of a channel's velocity in the predicted impact, m/s, from the impulse that gives the rotation, I
/// (a − b r) = Θ ω with r = I_x / I_z, on the body axes   (48)
fn step_m_s(spec: &ChannelSpec, file: &CaskFile, predicted: &Prediction) -> f64 {
    let (cask, drop) = (&file.cask, &file.drop);
    let (sin, cos) = drop.angle_rad.sin_cos();
    let (a_m, b_m) = planar::arms_m((sin, cos), cask.cog_m, cask.height_m);
    let rotation_rad_s = predicted.angular_velocity_rad_s - drop.angular_velocity_rad_s;
    let ratio = predicted.impulse_ratio;
    let up_m_s = cask.inertia_kg_m2 / cask.mass_kg * rotation_rad_s / (a_m - b_m * ratio);
    match spec.axis {
        Axis::Transverse => up_m_s * (cos - ratio * sin) - rotation_rad_s * (spec.position_m - cask.cog_m),
        Axis::Axial => up_m_s * (sin + ratio * cos),
    }
}

/// Simulates a channel that reads a half sine of this area, and its plateau.
fn half_sine(spec: &ChannelSpec, step_m_s: f64, lasts_s: f64, flight_s: f64) -> (Signal, Plateau) {
    let sample_rate_hz = SAMPLES / lasts_s;
    let force = |since_s: f64| {
        let share = (since_s - CONTACT_S) / lasts_s;
        if (0.0..1.0).contains(&share) { PI / 2.0 * step_m_s / lasts_s * (PI * share).sin() } else { 0.0 }
    };
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a second at the most")]
    let count = ((CONTACT_S + 2.0 * lasts_s + flight_s) * sample_rate_hz) as u32;
    let signal = Signal {
        name: spec.name.clone(),
        end: spec.end,
        axis: spec.axis,
        position_m: spec.position_m,
        offset_m: spec.offset_m,
        sample_rate_hz,
        force_m_s2: (0..count).map(|i| force(f64::from(i) / sample_rate_hz)).collect(),
        free_fall_s: CONTACT_S,
        ..Signal::default()
    };
    let channel = spec.name.clone();
    (signal, Plateau { channel, velocity_step_m_s: step_m_s, ..Plateau::default() })
}
