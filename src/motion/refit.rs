//! A flight fit to the same window again: without its modes, or with them in other signals.

use super::flight::{oscillation, plateaus, series};
use super::{Integrated, Window};
use crate::data::FlightFit;
use crate::numerics::damped_modes::{Form, describe};

/// The same window with each velocity step the mean over it: no mode, no drift. The candidates stay those of
/// the best fit.
pub fn mean_of_flight(
    integrated: &Integrated,
    best: &FlightFit,
    window: &Window,
    cog_m: f64,
) -> Option<FlightFit> {
    with_modes(integrated, &FlightFit { modes: Vec::new(), drift: false, ..best.clone() }, window, cog_m)
}

/// The same window and the same modes, in the sizes that they have in these signals.
pub fn with_modes(
    integrated: &Integrated,
    best: &FlightFit,
    window: &Window,
    cog_m: f64,
) -> Option<FlightFit> {
    let window = Window { from_s: best.from_s, to_s: best.to_s, ..*window };
    let series = series(integrated, &window, cog_m);
    let again = describe(&series, best.modes.iter().map(oscillation).collect(), Form::free(best.drift))?;
    Some(FlightFit { plateaus: plateaus(&integrated.signals, &again, &[&again]), ..best.clone() })
}
