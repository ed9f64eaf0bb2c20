//! Decides if one rigid body can have the velocity steps of three and more transverse channels.

use crate::data::{Axis, ChannelFinding, Drop, Events, Finding, FlightFit, Signal, Tolerances};

/// Smallest deviation of a step from the line through the others, in standard uncertainties, that contradicts
/// a rigid body: chance keeps even the farthest of three or four channels nearer.
const LEAST_DEVIATION_U: f64 = 4.0;
/// Smallest such deviation, m/s: 0.5 % of a slap-down, the effect of a mode that was not fitted.
const LEAST_M_S: f64 = 0.1;

/// Mean of Ω² in a contact over Ω² of the flight for a half sine of force, and its standard uncertainty.
const ROTATION_SHARE: f64 = 0.375;
const U_ROTATION_SHARE: f64 = 0.1;
/// Slope of a free beam's first bending shape at its end, times the length, over the deflection there.
const END_SLOPE: f64 = 4.65;

/// Place of a transverse channel.
pub struct SensorPlace<'a> {
    /// The channel's name.
    pub name: &'a str,
    /// Along the cask, from the first end, m.
    pub position_m: f64,
    /// Off the axis, away from the target, m.
    pub offset_m: f64,
}

/// Lists the places of the transverse signals.
pub fn transverse_places(signals: &[Signal]) -> impl Iterator<Item = SensorPlace<'_>> {
    signals.iter().filter(|s| s.axis == Axis::Transverse).map(|s| SensorPlace {
        name: &s.name,
        position_m: s.position_m,
        offset_m: s.offset_m,
    })
}

/// One channel's step: position, m, step and its standard uncertainty, m/s.
struct Reading<'a> {
    name: &'a str,
    position_m: f64,
    step_m_s: f64,
    u_m_s: f64,
}

/// Compares the velocity steps with the line over positions that a rigid body gives   (16)
///
/// Each channel is compared with the line through the others; the one with the largest deviation, in its
/// uncertainties, is named. A channel off the axis also reads −Ω² η from first contact on, with Ω of its
/// section   (14)
pub fn judge_rigid<'a>(
    transverse: impl Iterator<Item = SensorPlace<'a>>,
    flight: &FlightFit,
    tolerances: &Tolerances,
    drop: &Drop,
    events: &Events,
) -> Option<Finding> {
    let places: Vec<SensorPlace> = transverse.collect();
    let left_s = events.separation_s().unwrap_or(flight.from_s);
    let contact_s = (left_s - events.first_contact_s()?).max(0.0);
    let flight_s = (flight.from_s - left_s).max(0.0);
    let bending_m2_s2: f64 =
        flight.modes.iter().map(|mode| (END_SLOPE * mode.amplitude_m_s).powi(2) / 2.0).sum();
    // The axial velocity changes by about this much: if L sticks, its corner rebounds vertically.
    let first_m_s = flight.plateaus.iter().map(|p| p.velocity_step_m_s).fold(0.0, f64::max);
    let axial_m_s = first_m_s * drop.angle_rad.tan();
    let rotation_rad_s = rotation_rad_s(&places, flight);
    // Bending grows in the contact like the rotation.
    let bending_rad2_s2 = ROTATION_SHARE * bending_m2_s2 / span_m(&places).max(f64::MIN_POSITIVE).powi(2);
    let steps: Vec<Reading> = places
        .iter()
        .filter_map(|&SensorPlace { name, position_m, offset_m }| {
            let plateau = flight.plateau(name)?;
            let pulled_m_s2 = offset_m * rotation_rad_s.powi(2);
            let step_m_s = plateau.velocity_step_m_s + pulled_m_s2 * (ROTATION_SHARE * contact_s + flight_s);
            let u_bent_m_s = offset_m * bending_rad2_s2 * (contact_s + flight_s);
            let u_offset_m_s = (U_ROTATION_SHARE * pulled_m_s2 * contact_s).hypot(u_bent_m_s);
            // Half of a 95 % half-width is a standard uncertainty.
            let u_scale_m_s =
                (tolerances.calibration * step_m_s).hypot(tolerances.cross_axis * axial_m_s) / 2.0;
            let u_place_m_s = tolerances.position_m / 2.0 * rotation_rad_s;
            let u_m_s = plateau.u_m_s.hypot(u_scale_m_s).hypot(u_place_m_s).hypot(u_offset_m_s);
            Some(Reading { name, position_m, step_m_s, u_m_s })
        })
        .collect();
    let (worst, off_m_s, u_m_s) = steps
        .iter()
        .enumerate()
        .filter_map(|(i, step)| {
            let others: Vec<&Reading> =
                steps.iter().enumerate().filter(|(j, _)| *j != i).map(|s| s.1).collect();
            let (expected_m_s, u_m_s) = fit_line(&others, step.position_m)?;
            Some((step, step.step_m_s - expected_m_s, u_m_s.hypot(step.u_m_s)))
        })
        .max_by(|a, b| (a.1.abs() / a.2).total_cmp(&(b.1.abs() / b.2)))?;
    let finding = ChannelFinding::OffLine { off_m_s, u_m_s };
    (off_m_s.abs() > LEAST_DEVIATION_U * u_m_s && off_m_s.abs() > LEAST_M_S)
        .then(|| finding.tag(worst.name).span(flight.from_s, flight.to_s))
}

/// Change of the step along the cask between the outermost channels, rad/s: at 6 rad/s a sensor 10 mm off its
/// stated place reads 0.06 m/s more or less.
fn rotation_rad_s(places: &[SensorPlace], flight: &FlightFit) -> f64 {
    let step =
        |place: &SensorPlace| flight.plateau(place.name).map(|p| (place.position_m, p.velocity_step_m_s));
    let mut steps: Vec<(f64, f64)> = places.iter().filter_map(step).collect();
    steps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ends = steps.first().zip(steps.last()).filter(|(a, b)| b.0 - a.0 > 1e-3);
    ends.map_or(0.0, |(a, b)| ((b.1 - a.1) / (b.0 - a.0)).abs())
}

/// Distance of the outermost channels along the cask, m.
fn span_m(places: &[SensorPlace]) -> f64 {
    let at_m = |place: &SensorPlace| place.position_m;
    places.iter().map(at_m).fold(0.0, f64::max) - places.iter().map(at_m).fold(f64::INFINITY, f64::min)
}

/// Value of the least-squares line through steps at a position, and its standard uncertainty; `None` without
/// two places a millimetre apart.
fn fit_line(steps: &[&Reading], position_m: f64) -> Option<(f64, f64)> {
    let weight = |s: &Reading| 1.0 / (s.u_m_s * s.u_m_s).max(1e-12);
    let total: f64 = steps.iter().map(|s| weight(s)).sum();
    let middle_m = steps.iter().map(|s| weight(s) * s.position_m).sum::<f64>() / total;
    let mean_m_s = steps.iter().map(|s| weight(s) * s.step_m_s).sum::<f64>() / total;
    let square: f64 = steps.iter().map(|s| weight(s) * (s.position_m - middle_m).powi(2)).sum();
    let apart_m = (square / total).sqrt();
    let slope =
        steps.iter().map(|s| weight(s) * (s.position_m - middle_m) * s.step_m_s).sum::<f64>() / square;
    let ahead_m = position_m - middle_m;
    (apart_m > 5e-4).then(|| (mean_m_s + slope * ahead_m, (1.0 / total + ahead_m * ahead_m / square).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{At, Plateau, example};

    /// Steps of 20 − 6 x m/s at four places, each known to 0.02 m/s, the second one off.
    fn named(off_m_s: f64, places_m: &[f64]) -> Option<String> {
        named_at(0.26, off_m_s, places_m)
    }

    /// Judges the steps of a drop at this angle, rad.
    fn named_at(angle_rad: f64, off_m_s: f64, places_m: &[f64]) -> Option<String> {
        let names = ["A1", "A2", "A3", "A4"];
        let signals: Vec<Signal> = names
            .iter()
            .zip(places_m)
            .map(|(name, position_m)| Signal {
                name: (*name).into(),
                position_m: *position_m,
                free_fall_s: 0.2,
                ..example::signal(1e4, vec![])
            })
            .collect();
        let plateau = |s: &Signal| Plateau {
            u_m_s: 0.02,
            ..example::plateau(
                &s.name,
                20.0 - 6.0 * s.position_m + if s.name == "A2" { off_m_s } else { 0.0 },
            )
        };
        let flight = example::flight(0.0, 0.06, signals.iter().map(plateau).collect());
        let drop = Drop { impact_velocity_m_s: 13.3, ..Drop::from_height(9.0, angle_rad) };
        let events = example::events(0.0, 0.1);
        judge_rigid(transverse_places(&signals), &flight, &Tolerances::default(), &drop, &events)
            .and_then(|i| i.channel)
    }

    #[test]
    fn a_channel_off_the_line_is_named_and_one_on_it_is_not() {
        let places_m = [0.2, 1.0, 4.0, 4.8];
        assert_eq!(named(0.0, &places_m), None);
        assert_eq!(named(0.3, &places_m), None);
        assert_eq!(named(3.0, &places_m), Some("A2".into()));
        assert_eq!(named(-3.0, &places_m), Some("A2".into()));
    }

    #[test]
    fn a_steep_drop_lets_cross_axes_read_what_the_rebound_throws_along_the_axis() {
        let places_m = [0.2, 1.0, 4.0, 4.8];
        // 1 % of 20 tan 37° = 15 m/s is 0.15 m/s a channel, of 20 tan 15° = 5 m/s a third: 0.6 m/s is 2.5 u
        // at 37° and 4.6 u at 15°.
        assert_eq!(named_at(0.64, 0.6, &places_m), None);
        assert_eq!(named_at(0.26, 0.6, &places_m), Some("A2".into()));
        assert_eq!(named_at(0.64, 3.0, &places_m), Some("A2".into()));
    }

    #[test]
    fn sensors_on_both_skins_differ_by_the_square_of_the_rotation() {
        let named = |lower_m_s: f64| {
            let off_m = [-0.4, 0.4, -0.4, 0.4];
            let signal = |(i, offset_m): (usize, f64)| Signal {
                name: format!("A{i}"),
                position_m: if i < 2 { 0.2 } else { 4.8 },
                offset_m,
                ..example::signal(1e4, vec![])
            };
            let signals: Vec<Signal> = off_m.into_iter().enumerate().map(signal).collect();
            let plateau = |s: &Signal| Plateau {
                u_m_s: 0.02,
                ..example::plateau(&s.name, 20.0 - 6.0 * s.position_m - s.offset_m / 0.4 * lower_m_s)
            };
            let flight = example::flight(0.03, 0.09, signals.iter().map(plateau).collect());
            let drop = Drop { impact_velocity_m_s: 13.3, ..Drop::from_height(9.0, 0.26) };
            let left = Some(At::exact(0.024));
            let events = Events { separation: left, ..example::events(0.0, 0.1) };
            judge_rigid(transverse_places(&signals), &flight, &Tolerances::default(), &drop, &events)
        };
        // ∫Ω² of an Ω that rises to 6 rad/s in 24 of 30 ms is 36 (3/8 · 0.024 + 0.006) = 0.54 rad²/s.
        assert!(named(0.4 * 0.54).is_none(), "{:?}", named(0.4 * 0.54));
        assert!(named(-0.4 * 0.54).is_some(), "the lower skin reads less");
    }

    #[test]
    fn two_channels_are_always_a_line() {
        assert_eq!(named(3.0, &[0.2, 4.8]), None);
        // Three channels at one place do not define a line either.
        assert_eq!(named(0.0, &[0.2, 0.2, 0.2]), None);
    }
}
