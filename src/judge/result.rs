//! Judges the reconstructed motion.

use super::missing::{LONGEST_PULSE_S, too_steep};
use super::tilt::tilt_m_s2;
use crate::data::{
    Axis, Cask, CaskFile, ChannelFinding, Comparison, Contact, DropFinding, DropResult, End, Estimate,
    Finding, FlightFit, GRAZE_SHARE, IssueCode, Motion, Observed, ObservedBeside, Plateau, Quantities,
    SLOWEST_BENDING_HZ, Severity, Signal, Tolerances, planar,
};
use crate::numerics::noise::integral_uncertainty_by;

/// A k this far outside 0 to 1 is an error whatever its interval.
const MOST_OUTSIDE: f64 = 0.25;
/// Largest distance from the axis of a sensor on the skin with its block, in half sections.
const ON_SKIN: f64 = 1.2;
/// Zero shifts are a note if their effect on the velocity over the contact is below this, m/s, 0.5 % of a
/// slap-down, or below these shares of the speed's half-width and of v0.
const SMALL_SHIFT_M_S: f64 = 0.1;
const SMALL_SHIFT_SHARES: [f64; 2] = [0.5, 0.03];
/// This limit in a flight that does not show a period of each mode, m/s: there a drift is partly a mode and
/// partly the sensor.
const SMALL_BEND_M_S: f64 = 0.5;
/// Standard uncertainty of an axial channel's reading from bending, as a share: the slope of a uniform beam's
/// shape.
const U_TILT_SHARE: f64 = 0.2;
/// Velocity gained late in a flight, as a share of v0, from which it is another contact.
const LATE_SHARE: f64 = 0.03;
/// Sliding below this counts as sticking, m/s: 5 % cross-axis sensitivity of a 13 m/s step.
const SMALL_SLIP_M_S: f64 = 0.65;
/// Largest number of periods of a mode slower than bending that indicates a contact through the apparent
/// flight. Of 16 simulated drops with such contacts 10 are below it.
const PRESSED_PERIODS: f64 = 1.3;
/// Depth of L below the place it left, as a share of the cask's length, from which it is on the target again:
/// 5 mm of 5 m, the flatness of corner and target.
const TOUCHED_SHARE: f64 = 0.001;
/// Residual RMS of a flight fit above which the channel is not explained, m/s: 1.5 % of a slap-down.
const LARGE_RESIDUAL_M_S: f64 = 0.3;
/// This limit as a share of v0 for a flight too short to separate its modes: three modes may fit a flight
/// that still contains a part of the contact.
const LARGE_RESIDUAL_SHORT: f64 = 0.015;
/// Deviation of the velocity from its flight before R strikes from which it is another contact, m/s: 1 % of a
/// slap-down.
const LARGE_MISMATCH_M_S: f64 = 0.2;
/// E_n that chance exceeds in one comparison of 400; it exceeds 1 in one of twenty.
const CHANCE_E_N: f64 = 1.5;
/// Standard uncertainty of a velocity step, as a share of v0, above which it says little: 4 ± 2.7 m/s of 13.3
/// m/s.
const LARGE_U_SHARE: f64 = 0.1;
/// Bend of one channel's plateau, as a share of v0, below which it changes the speed by less than its
/// interval.
const LARGE_BEND: f64 = 0.01;
/// Number of periods below which a swing must be larger in proportion: a fit adapts to any small part of a
/// period. Of 118 simulated sound drops of elastic bodies two had 0.7 and 0.9 periods of a mode of 1.1 and
/// 1.5 % of v0; an amplifier that recovers left 0.6 periods of 1.8 %, with k 2.4 half-widths off.
const SWING_PERIODS: f64 = 1.0;

/// Compares the motion with what a dropped cask can do.
pub fn judge_motion(
    cask_file: &CaskFile,
    signals: &[Signal],
    flight: &FlightFit,
    motion: &Motion,
    quantities: &Quantities,
) -> Vec<Finding> {
    let mut findings = judge_signs(signals, flight);
    let Tolerances { position_m, cog_m, .. } = cask_file.tolerances;
    // Half of a 95 % half-width is a standard uncertainty.
    let u_place_m = position_m.hypot(cog_m) / 2.0;
    let rotation_rad2_s2 = motion.separation.angular_velocity_rad_s.powi(2);
    let pull = Pull { rotation_rad2_s2, u_place_m };
    findings.extend(judge_flight(signals, flight, quantities, &cask_file.cask, &pull));
    let mut add = |found: DropFinding| findings.push(found.into());
    let k = quantities.k;
    let lasts_s =
        motion.curve.time_s.last().zip(motion.curve.time_s.first()).map_or(0.0, |(to, from)| to - from);
    if !is_restitution(k) {
        let is_together = quantities.speed.is_some() && k.value < 0.0 && lasts_s < LONGEST_PULSE_S;
        let together = DropFinding::StrikeTogether { apart_s: lasts_s };
        add(if is_together { together } else { DropFinding::Restitution { k } });
    } else if k.value < 0.0 {
        add(DropFinding::RestitutionDoubted { k, strained: None });
    }
    if quantities.angular_velocity.value <= 0.0 {
        match too_steep(&cask_file.cask, &cask_file.drop) {
            // This is reported with the slap-down that was not found.
            Some(_) if quantities.speed.is_none() => {}
            steep => add(steep.unwrap_or(DropFinding::TurnsTheWrongWay)),
        }
    }
    let slip = quantities.slip_velocity;
    let is_measured = signals.iter().any(|s| s.axis == Axis::Axial);
    if is_measured
        && cask_file.contact == Contact::Rough
        && slip.value.abs() > 2.0 * slip.u95 + SMALL_SLIP_M_S
    {
        add(DropFinding::Slides { slip });
    }
    let open_m = open_height_m(quantities, cask_file.cask.cog_m);
    if motion.lowest_first_end_m < -GRAZE_SHARE * cask_file.cask.length_m - open_m {
        add(DropFinding::Sinks { depth_m: -motion.lowest_first_end_m });
    }
    findings
}

/// True if the interval of k overlaps 0 to 1 and is useful.
pub fn is_restitution(k: Estimate) -> bool {
    let is_beyond = k.value + k.u95 < 0.0 || k.value - k.u95 > 1.0;
    !is_beyond && (-MOST_OUTSIDE..=1.0 + MOST_OUTSIDE).contains(&k.value) && k.u95 <= 1.0
}

/// Reports a first end that is still pressed on the target when the second one strikes: the apparent flight
/// then bends more slowly than a cask, and its motion is contradicted.
pub fn judge_pressed(flight: &FlightFit, motion_findings: &[Finding]) -> Option<Finding> {
    let periods = flight.periods();
    let frequency_hz = periods / (flight.to_s - flight.from_s);
    let is_contradicted =
        motion_findings.iter().any(|f| f.severity > Severity::Note && f.code != IssueCode::Swings);
    let finding = DropFinding::Pressed { frequency_hz, periods };
    (is_contradicted && frequency_hz < SLOWEST_BENDING_HZ && periods < PRESSED_PERIODS)
        .then(|| Finding::from(finding).span(flight.from_s, flight.to_s))
}

/// Reports touches of L that the flight omits: `effect_m_s` is their effect on the slap-down speed in the
/// prediction with the measured k.
///
/// A touch too slow for any channel still carries the cask: L rests on the target. One shortly before R
/// strikes is hidden by the ringing: there the height of L in the motion has to exclude it.
pub fn judge_touch(
    motion: &Motion,
    quantities: &Quantities,
    effect_m_s: f64,
    cask: &Cask,
) -> Option<Finding> {
    let interval_m_s = quantities.speed?.u95;
    let depth_m = -motion.lowest_first_end_m;
    let down_m_s = -motion.curve.first_end_vertical_m_s.last().copied().unwrap_or(0.0);
    let by_landing_m_s = share_of_landing(motion, cask) * (1.0 + quantities.k.value) * down_m_s.max(0.0);
    // R is then at the target, and the height of L relative to it follows from the angle, whatever the
    // uncertainty of the rebound.
    let above_m = motion.last_first_end_m - motion.second_end_height_m.unwrap_or(0.0);
    let u_m = quantities.angle.map_or(0.0, |angle| angle.u95.to_radians()) * cask.length_m / 2.0;
    if depth_m > TOUCHED_SHARE * cask.length_m && effect_m_s > interval_m_s {
        Some(DropFinding::Settles { depth_m, effect_m_s }.into())
    } else if above_m > u_m || by_landing_m_s < interval_m_s {
        None
    } else if above_m > -2.0 * u_m {
        Some(DropFinding::MayLand { above_m, u_m, effect_m_s: by_landing_m_s }.into())
    } else {
        Some(DropFinding::Settles { depth_m: -above_m, effect_m_s: by_landing_m_s }.into())
    }
}

/// Change of the vertical velocity of R's corner per change of that of L's when R strikes   (2), (5)
fn share_of_landing(motion: &Motion, cask: &Cask) -> f64 {
    let angle = motion.slap_down.map_or(0.0, |at| at.angle_rad).sin_cos();
    let [a_m, behind_m] =
        [cask.cog_m, cask.cog_m - cask.length_m].map(|x| planar::arms_m(angle, x, cask.height_m).0);
    let square_m2 = cask.inertia_kg_m2 / cask.mass_kg;
    ((square_m2 + a_m * behind_m) / (square_m2 + a_m * a_m)).abs()
}

/// Additional depth of L that the uncertainty of rebound and angle allows, m: a 95 % half-width.
fn open_height_m(quantities: &Quantities, cog_m: f64) -> f64 {
    let flight_s = quantities.flight_time.map_or(0.0, |t| t.value);
    let turned_rad = quantities.angle.map_or(0.0, |a| a.u95.to_radians());
    quantities.rebound_velocity.u95 * flight_s + turned_rad * cog_m
}

/// Reports a first end whose impact seems to pull it towards the target.
fn judge_signs(signals: &[Signal], flight: &FlightFit) -> Vec<Finding> {
    signals
        .iter()
        .filter(|s| s.end == End::First && s.axis == Axis::Transverse)
        .filter(|s| flight.plateau(&s.name).is_some_and(|p| p.velocity_step_m_s < 0.0))
        .map(|s| ChannelFinding::Polarity.tag(&s.name))
        .collect()
}

/// Centrifugal pull of the flight's rotation at a sensor.
struct Pull {
    /// Square of the angular velocity.
    rotation_rad2_s2: f64,
    /// Standard uncertainty of a sensor's place.
    u_place_m: f64,
}

impl Pull {
    /// Returns the stated offset of a transverse channel, and the one that a shift of its level would show:
    /// −ω² η, (14); `None` if that lies off the cask.
    fn offsets_m(&self, signal: &Signal, shift_m_s2: f64, section_m: f64) -> Option<[f64; 2]> {
        let explains_m = signal.offset_m - shift_m_s2 / self.rotation_rad2_s2;
        let is_on_cask = signal.axis == Axis::Transverse && explains_m.abs() < ON_SKIN * section_m / 2.0;
        is_on_cask.then_some([signal.offset_m, explains_m])
    }
}

fn judge_flight(
    signals: &[Signal],
    flight: &FlightFit,
    quantities: &Quantities,
    cask: &Cask,
    pull: &Pull,
) -> Vec<Finding> {
    let v0_m_s = quantities.impact_velocity.value;
    let mut findings = judge_bends(flight, signals, v0_m_s);
    findings.extend(judge_swings(flight, signals, v0_m_s, cask));
    let shorter = quantities.flight_time.filter(|flown| flown.value < flown.u95);
    findings.extend(shorter.map(|flight_time| DropFinding::NoFlight { flight_time }.into()));
    for plateau in &flight.plateaus {
        if let Some(signal) = signals.iter().find(|s| s.name == plateau.channel) {
            let tilt_m_s2 = tilt_m_s2(signal, signals, flight, cask);
            let offsets_m = pull.offsets_m(signal, plateau.zero_shift_m_s2, cask.height_m);
            let u_pulled_m_s2 = pull.rotation_rad2_s2 * pull.u_place_m;
            let shift = judge_shift(flight, plateau, [tilt_m_s2, u_pulled_m_s2], quantities, offsets_m);
            findings.extend(shift);
        }
        let late_m_s = LARGE_MISMATCH_M_S.min(LATE_SHARE * v0_m_s);
        let mismatch_m_s = plateau.late_mismatch_m_s.filter(|m| m.abs() > late_m_s);
        let late = |mismatch_m_s| ChannelFinding::LateMismatch { mismatch_m_s }.tag(&plateau.channel);
        findings.extend(mismatch_m_s.map(late));
        let short_m_s = if flight.can_rank_fits() { f64::INFINITY } else { LARGE_RESIDUAL_SHORT * v0_m_s };
        let &Plateau { slow_residual_m_s: residual_m_s, u_m_s, .. } = plateau;
        if residual_m_s > LARGE_RESIDUAL_M_S.min(short_m_s) || u_m_s > LARGE_U_SHARE * v0_m_s {
            let finding = ChannelFinding::Unexplained { modes: flight.modes.len(), residual_m_s, u_m_s };
            findings.push(finding.tag(&plateau.channel).span(flight.from_s, flight.to_s));
        }
    }
    findings
}

/// Reports a zero shift that was removed, beyond the effects of bending and of the rotation at an uncertain
/// place, with its effect on the velocity over the contact.
fn judge_shift(
    flight: &FlightFit,
    plateau: &Plateau,
    [tilt_m_s2, u_pulled_m_s2]: [f64; 2],
    quantities: &Quantities,
    offsets_m: Option<[f64; 2]>,
) -> Option<Finding> {
    let &Plateau { zero_shift_m_s2: shift_m_s2, u_zero_shift_m_s2: u_m_s2, .. } = plateau;
    // A sensor on a stiff block tilts less than its place.
    let by_bending_m_s2 = shift_m_s2.clamp(tilt_m_s2.min(0.0), tilt_m_s2.max(0.0));
    let beyond_m_s2 = (shift_m_s2 - by_bending_m_s2).abs();
    let effect_m_s = beyond_m_s2 * quantities.duration.value;
    let least_m_s = if flight.periods() > 1.0 { SMALL_SHIFT_M_S } else { SMALL_BEND_M_S };
    let [speed_share, v0_share] = SMALL_SHIFT_SHARES;
    let most_m_s = v0_share * quantities.impact_velocity.value;
    let held_m_s = quantities.speed.map_or(0.0, |speed| (speed_share * speed.u95).min(most_m_s));
    let small_m_s = held_m_s.max(least_m_s);
    let severity = if effect_m_s > small_m_s { Severity::Warning } else { Severity::Note };
    let finding = ChannelFinding::ZeroShift { shift_m_s2, u_m_s2, effect_m_s, offsets_m, severity };
    let u_all_m_s2 = u_m_s2.hypot(U_TILT_SHARE * by_bending_m_s2).hypot(u_pulled_m_s2);
    (flight.drift && beyond_m_s2 > 3.0 * u_all_m_s2)
        .then(|| finding.tag(&plateau.channel).span(flight.from_s, flight.to_s))
}

/// Reports modes that are fit artefacts, each on the channel that shows it most.
fn judge_bends(flight: &FlightFit, signals: &[Signal], v0_m_s: f64) -> Vec<Finding> {
    let judge_mode = |i: usize| {
        let size_m_s = |p: &Plateau| p.ringing_m_s.get(i).map_or(0.0, |(a, b)| a.hypot(*b));
        let on = flight.plateaus.iter().max_by(|a, b| size_m_s(a).total_cmp(&size_m_s(b)))?;
        let found =
            ChannelFinding::Bend { frequency_hz: flight.modes[i].frequency_hz, size_m_s: size_m_s(on) };
        (size_m_s(on) > LARGE_BEND * v0_m_s && flight.is_fit_artefact(i, signals))
            .then(|| found.tag(&on.channel).span(flight.from_s, flight.to_s))
    };
    (0..flight.modes.len()).filter_map(judge_mode).collect()
}

/// Reports the slowest mode if it is slower than bending and moves both ends together.
fn judge_swings(flight: &FlightFit, signals: &[Signal], v0_m_s: f64, cask: &Cask) -> Option<Finding> {
    let size_m_s = |mode| flight.size_m_s(mode, signals);
    let swinging = flight.rigid_modes(signals, cask);
    let mut modes = (0..swinging).filter(|mode| !flight.is_fit_artefact(*mode, signals));
    let length_s = flight.to_s - flight.from_s;
    // Integrated noise resembles an oscillation as slow as the flight is long.
    let walk_m_s = |s: &Signal| integral_uncertainty_by(&s.noise_spectrum, s.free_fall_s, length_s);
    let walks_m_s = signals.iter().map(walk_m_s).fold(0.0, f64::max);
    let is_large = |mode: &usize| {
        let few = (SWING_PERIODS / (flight.modes[*mode].frequency_hz * length_s)).max(1.0);
        size_m_s(*mode) > (LARGE_BEND * v0_m_s * few).max(2.0 * walks_m_s)
    };
    let mode = modes.find(is_large)?;
    let found =
        DropFinding::Swings { frequency_hz: flight.modes[mode].frequency_hz, size_m_s: size_m_s(mode) };
    Some(Finding::from(found).span(flight.from_s, flight.to_s))
}

/// Compares an independent observation with the result.
pub fn compare_observed(seen: &Observed, result: &DropResult) -> ObservedBeside {
    let (first, second) = (&result.first_impact, &result.slap_down);
    let (quantity, unit) = match seen.name {
        "slap_down_speed_m_s" => (second.speed, "m/s"),
        "local_speed_m_s" => (second.local_speed, "m/s"),
        "angular_velocity_rad_s" => (first.angular_velocity, "rad/s"),
        "angle_deg" => (second.angle, "deg"),
        "flight_time_s" => (second.flight_time, "s"),
        "impact_velocity_m_s" => (first.impact_velocity, "m/s"),
        _ => (result.k, "1"),
    };
    ObservedBeside {
        name: seen.name,
        observed: Estimate::new(seen.value, seen.u95, unit),
        by: seen.by.clone(),
        result: quantity,
        e_n: quantity.map(|q| (q.value - seen.value) / q.u95.hypot(seen.u95)),
    }
}

/// Reports independent observations that differ from the result; chance alone makes a warning once in three
/// hundred.
pub fn judge_observed(observed: &[ObservedBeside]) -> impl Iterator<Item = Finding> {
    let apart = |beside: &ObservedBeside| {
        let e_n = beside.e_n.map(f64::abs).filter(|e_n| *e_n > 1.0)?;
        let severity = if e_n > CHANCE_E_N { Severity::Warning } else { Severity::Note };
        Some(DropFinding::ObservedApart { beside: beside.clone(), e_n, severity }.into())
    };
    observed.iter().filter_map(apart)
}

/// Reports a comparison that does not agree.
pub fn judge_comparison(comparison: &Comparison) -> Option<Finding> {
    let &Comparison { predicted, predicted_u95, measured, measured_u95, .. } = comparison;
    let e_n = (measured - predicted).abs() / measured_u95.hypot(predicted_u95);
    let severity = if e_n > CHANCE_E_N { Severity::Warning } else { Severity::Note };
    (!comparison.agrees).then(|| DropFinding::Disagreement { comparison: *comparison, e_n, severity }.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Mode, example};

    /// A flight of 50 ms whose slowest mode both ends show with 1.2 m/s.
    fn flight(frequency_hz: f64) -> (FlightFit, Vec<Signal>) {
        let plateau = |name: &str| Plateau { ringing_m_s: vec![(1.2, 0.0)], ..example::plateau(name, 10.0) };
        let signal = |name: &str, end| Signal { name: name.into(), end, ..example::signal(1e4, vec![]) };
        let modes = vec![Mode { frequency_hz, damping: 0.02, amplitude_m_s: 1.2 }];
        let fit = example::flight(0.1, 0.15, vec![plateau("A1"), plateau("A2")]);
        (FlightFit { modes, ..fit }, vec![signal("A1", End::First), signal("A2", End::Second)])
    }

    #[test]
    fn what_moves_more_slowly_than_a_cask_bends_swings() {
        let found = |frequency_hz, v0_m_s| {
            let (flight, signals) = flight(frequency_hz);
            judge_swings(&flight, &signals, v0_m_s, &example::cask(1.0, 5.0, 0.0)).map(|f| f.code)
        };
        assert_eq!(found(15.0, 13.3), Some(IssueCode::Swings));
        assert_eq!(found(30.0, 13.3), None);
        // A hundredth of the speed of the fall lies within the interval.
        assert_eq!(found(15.0, 130.0), None);
    }

    #[test]
    fn a_slow_bend_that_the_motion_contradicts_is_a_first_end_still_pressed() {
        let contradicted = [Finding::from(DropFinding::TurnsTheWrongWay)];
        assert!(judge_pressed(&flight(15.0).0, &contradicted).is_some());
        assert!(judge_pressed(&flight(15.0).0, &[]).is_none());
        assert!(judge_pressed(&flight(60.0).0, &contradicted).is_none());
        let swings = [DropFinding::Swings { frequency_hz: 15.0, size_m_s: 1.2 }.into()];
        assert!(judge_pressed(&flight(15.0).0, &swings).is_none(), "swinging contradicts nothing");
    }
}
