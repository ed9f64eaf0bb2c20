//! Fits of a flight without a flight: the same window again with other signals, or one time alone.

use super::flight::{oscillation, plateaus, series};
use super::{Integrated, Velocity, Window};
use crate::data::{FlightFit, Plateau, Signal};
use crate::numerics::damped_modes::{Form, describe};
use rayon::iter::ParallelIterator;

/// Fits the same window with the same modes, whose amplitudes follow from these signals; the cask turns at
/// the given rate.
pub fn with_modes(
    integrated: &Integrated,
    best: &FlightFit,
    turning_rad_s: f64,
    cog_m: f64,
) -> Option<FlightFit> {
    let &FlightFit { from_s, to_s, drift, .. } = best;
    let window = Window { from_s, to_s, drift, angular_velocity_rad_s: turning_rad_s };
    let series = series(integrated, &window, cog_m);
    let again = describe(&series, best.modes.iter().map(oscillation).collect(), Form::free(drift))?;
    Some(FlightFit { plateaus: plateaus(&integrated.signals, &again, &[&again]), ..best.clone() })
}

/// Values of the integrals at one time, as if the flight began there.
pub fn flight_at(integrated: &Integrated, time_s: f64) -> FlightFit {
    let plateau = |(signal, velocity): (&Signal, &Velocity)| Plateau {
        channel: signal.name.clone(),
        velocity_step_m_s: velocity.velocity_at(time_s),
        ..Plateau::default()
    };
    FlightFit {
        from_s: time_s,
        to_s: time_s,
        plateaus: integrated.with_velocities().map(plateau).collect(),
        ..FlightFit::default()
    }
}
