//! Velocity that ringing and rigid movement on mounts add to R's corner when it strikes, from the second
//! end's channel.

use super::Integrated;
use super::flight::{centrifugal_m_s2, oscillation};
use crate::data::{At, Axis, Cask, FlightFit, Setup, Signal};
use crate::numerics::damped_modes::uniform_ringing;
use crate::numerics::free_beam;

/// Relative uncertainty of a mode's shape between sensor and corner: the first shape of a uniform beam
/// against a straight line, a quarter of their difference.
const SHAPE_SHARE: f64 = 0.25;

/// A velocity that departs from the fitted modes by more than this many times their residual no longer
/// belongs to the flight.
const CONTACT_FACTOR: f64 = 3.0;

/// A velocity across the axis with its standard uncertainty, m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerRinging {
    /// Positive away from the target.
    pub velocity_m_s: f64,
    /// Standard uncertainty of that velocity.
    pub u_m_s: f64,
}

/// Velocity that bending and rigid movement on mounts add to R's corner at the slap-down   (44)
///
/// It is the velocity of the channel nearest to the corner beyond its plateau, each mode carried to the
/// corner by its shape. `None` without a transverse channel on the second end.
pub fn second_end_ringing(
    integrated: &Integrated,
    flight: &FlightFit,
    turning_rad_s: f64,
    slap_down: At,
    setup: &Setup,
    cask: &Cask,
) -> Option<CornerRinging> {
    let across = |s: &&Signal| s.axis == Axis::Transverse;
    let by_place = |a: &&Signal, b: &&Signal| a.position_m.total_cmp(&b.position_m);
    let signals = || integrated.signals.iter().filter(across);
    let (first, last) = (signals().min_by(by_place)?, signals().max_by(by_place)?);
    let channel = integrated.signals.iter().position(|s| s.name == last.name)?;
    let plateau = flight.plateau(&last.name)?;
    let before_s = slap_down.time_s - slap_down.u_s.max(1.0 / last.sample_rate_hz);
    let since_s = before_s - flight.from_s;
    let shift_m_s2 = plateau.zero_shift_m_s2 + centrifugal_m_s2(last, turning_rad_s, setup.cog_m);
    let gained_m_s = integrated.velocities[channel].velocity_at(before_s);
    let own_m_s = gained_m_s - plateau.velocity_step_m_s - shift_m_s2 * since_s;
    let (mut fitted_m_s, mut carried_m_s, mut u_shape_m_s, mut rate_m_s2) = (0.0, 0.0, 0.0, 0.0_f64);
    let orders = flight.bending_orders(&integrated.signals, cask);
    for (i, (mode, order)) in flight.modes.iter().zip(orders).enumerate() {
        let Some(size) = plateau.ringing_m_s.get(i) else { continue };
        let Some(z) = uniform_ringing(oscillation(mode), since_s, 1.0).next() else { continue };
        let own_m_s = size.0 * z.re + size.1 * z.im;
        fitted_m_s += own_m_s;
        let (square, ratio) = (size.0 * size.0 + size.1 * size.1, flight.end_ratio(i, &integrated.signals));
        let shares = [first, last].map(|s| s.position_m / setup.length_m);
        let straight = 1.0 + (1.0 - ratio) * (1.0 - shares[1]) / (shares[1] - shares[0]).max(0.1);
        let bent = corner_ratio(if ratio > 0.0 { order.max(1) } else { 2 }, shares[1]);
        carried_m_s += own_m_s * (if order == 0 { straight } else { bent } - 1.0);
        u_shape_m_s += (SHAPE_SHARE * own_m_s * (bent - straight)).abs();
        // R may strike a little earlier or later: second-order terms count, since ringing may be at its
        // maximum.
        let omega = std::f64::consts::TAU * mode.frequency_hz;
        let bent_m_s2 = 0.5 * omega * omega * slap_down.u_s * square.sqrt() * z.norm();
        rate_m_s2 += (omega * (size.1 * z.re - size.0 * z.im)).hypot(bent_m_s2);
    }
    // A velocity beyond the modes comes from the contact that has begun.
    let beyond_m_s = own_m_s - fitted_m_s;
    let has_begun = beyond_m_s.abs() > CONTACT_FACTOR * plateau.residual_m_s;
    let (own_m_s, u_begun_m_s) = if has_begun { (fitted_m_s, beyond_m_s / 2.0) } else { (own_m_s, 0.0) };
    let u_m_s = plateau.u_m_s.hypot(plateau.residual_m_s).hypot(u_shape_m_s).hypot(u_begun_m_s);
    Some(CornerRinging {
        velocity_m_s: own_m_s + carried_m_s,
        u_m_s: u_m_s.hypot(rate_m_s2 * slap_down.u_s).hypot(last.u_offset_m_s2 * since_s),
    })
}

/// Ratio of the movement of R's corner to that of the sensor at `share` of the length in the bending mode of
/// this order.
fn corner_ratio(order: u8, share: f64) -> f64 {
    let at_sensor = free_beam::shape(order, share);
    let at_corner = free_beam::shape(order, 1.0);
    // Near a node of the shape the sensor does not show the movement of the corner.
    if at_sensor * at_corner > 0.25 * at_corner * at_corner { at_corner / at_sensor } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{AxialSource, CONTACT_STEPS, End, Mode, Plateau, example};

    /// 2 m/s at the corner of a 5 m cask, 0.05 of the length beyond the sensor, as R strikes at 0.1 s; the
    /// other end goes along by `opposite`.
    fn ringing(frequency_hz: f64, corner_m_s: f64, sensor_m_s: f64, opposite: f64) -> CornerRinging {
        let omega = std::f64::consts::TAU * frequency_hz;
        let force = |i: u32| -sensor_m_s * omega * (omega * (f64::from(i) / 1e5 - 0.1)).sin();
        let signal = |name: &str, end, position_m| Signal {
            name: name.into(),
            end,
            position_m,
            ..example::signal(1e5, (0..12_000).map(force).collect())
        };
        let signals = [signal("A1", End::First, 0.25), signal("A2", End::Second, 4.75)];
        let (sin, cos) = (-omega * 0.1).sin_cos();
        // Velocities count from the contact, where it rings already.
        let before_m_s = sensor_m_s * (omega * (0.02 - 0.002 - 0.1)).cos();
        let plateau = |name, share: f64| Plateau {
            ringing_m_s: vec![(share * sensor_m_s * cos, -share * sensor_m_s * sin)],
            ..example::plateau(name, -before_m_s)
        };
        let mode = Mode { frequency_hz, damping: 0.0, amplitude_m_s: corner_m_s };
        let plateaus = vec![plateau("A1", opposite), plateau("A2", 1.0)];
        let flight = FlightFit { modes: vec![mode], ..example::flight(0.0, 0.1, plateaus) };
        let setup = Setup {
            length_m: 5.0,
            height_m: 0.5,
            cog_m: 2.5,
            angle_rad: 0.2,
            impact_velocity_m_s: 13.0,
            is_of_fall: true,
            angular_velocity_rad_s: 0.0,
            horizontal_velocity_m_s: 0.0,
            gravity_m_s2: 9.81,
            axial: AxialSource::Sticking,
            second_s: 1.0,
            inward: 0.0,
            contact_steps: CONTACT_STEPS,
        };
        let integrated = Integrated::new(&signals, 0.02);
        let cask = example::cask(1.0, setup.length_m, setup.height_m);
        second_end_ringing(&integrated, &flight, 0.0, At::exact(0.1), &setup, &cask).expect("two ends")
    }

    #[test]
    fn a_bending_mode_is_carried_to_the_corner_by_its_shape() {
        for (order, frequency_hz) in [(1, 60.0), (2, 160.0)] {
            let [corner, sensor, opposite] =
                [1.0, 0.95, 0.05].map(|share| free_beam::shape(order, share) / free_beam::shape(order, 1.0));
            let found = ringing(frequency_hz, 2.0, 2.0 * sensor, opposite / sensor);
            assert!((found.velocity_m_s - 2.0 * corner).abs() < 0.01, "{order}: {found:?}");
            assert!(found.u_m_s > 0.0 && found.u_m_s < 0.25, "{order}: {found:?}");
        }
    }

    #[test]
    fn a_cask_that_swings_moves_as_a_whole() {
        let up_and_down = ringing(15.0, 1.2, 1.2, 1.0);
        assert!((up_and_down.velocity_m_s - 1.2).abs() < 0.01, "{up_and_down:?}");
        // About its middle the corner goes 2.5 / 2.25 as far as the sensor.
        let turning = ringing(15.0, 1.2, 1.2, -1.0);
        assert!((turning.velocity_m_s - 1.2 * 2.5 / 2.25).abs() < 0.01, "{turning:?}");
    }
}
