//! Integrals to a flight fit without a flight: the same window again with other signals, or one time alone.

use super::flight::{oscillation, plateaus, series};
use super::{Integrated, Velocity, Window};
use crate::data::{FlightFit, Plateau, Signal};
use crate::numerics::damped_modes::{Form, describe};
use rayon::iter::ParallelIterator;

/// The same window and the same modes, in the sizes that they have in these signals; the cask turns so fast.
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

/// What the integrals give at one time, as if the flight began there.
pub fn at_once(integrated: &Integrated, time_s: f64) -> FlightFit {
    let plateau = |(signal, velocity): (&Signal, &Velocity)| Plateau {
        channel: signal.name.clone(),
        velocity_step_m_s: velocity.at(time_s),
        ..Plateau::default()
    };
    FlightFit {
        from_s: time_s,
        to_s: time_s,
        plateaus: integrated.each().map(plateau).collect(),
        ..FlightFit::default()
    }
}
