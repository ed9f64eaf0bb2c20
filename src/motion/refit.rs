//! A flight fit to the same window again, with its modes in other signals.

use super::flight::{oscillation, plateaus, series};
use super::{Integrated, Window};
use crate::data::FlightFit;
use crate::numerics::damped_modes::{Form, describe};

/// The same window and the same modes, in the sizes that they have in these signals; the cask turns so fast.
pub fn with_modes(
    integrated: &Integrated,
    best: &FlightFit,
    turning_rad_s: f64,
    cog_m: f64,
) -> Option<FlightFit> {
    let &FlightFit { from_s, to_s, drift, .. } = best;
    let window = Window { from_s, to_s, drift, angular_velocity_rad_s: turning_rad_s, most_modes: 0 };
    let series = series(integrated, &window, cog_m);
    let again = describe(&series, best.modes.iter().map(oscillation).collect(), Form::free(drift))?;
    Some(FlightFit { plateaus: plateaus(&integrated.signals, &again, &[&again]), ..best.clone() })
}
