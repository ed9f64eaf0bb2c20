//! Finds a shock within the flight, if it explains the flight better than ringing does.

use super::flight::{oscillation, series};
use super::{Integrated, Window};
use crate::data::{Axis, FlightFit, FlightShock};
use crate::numerics::damped_modes::{CommonStep, Form, Oscillation, Series, fit};

/// Times tried over the flight, and about the best of them.
const PLACES: u32 = 24;
const REFINED: u32 = 8;
/// Parts of the flight at its beginning and end in which a step is an unfinished contact, or the slap-down.
const FIRST_PART: f64 = 0.1;
const LAST_PART: f64 = 0.06;
/// Stretch on either side of a step that determines its size in a long flight, s.
const ABOUT_S: f64 = 0.05;
/// Fewest points of a flight in which a step can be separated from a mode.
const FEWEST: usize = 30;

/// Finds one step of all velocities within the flight, with fewer modes beside it: the contents of the cask,
/// or a cable, strike it. Three modes may bend around such a step and move the plateaus by a part of it.
///
/// The criterion is the Bayesian information criterion (21) of the flight with the step and the same modes,
/// less that of the fitted flight.
pub fn find_shock(flight: &FlightFit, data: &Integrated, window: &Window, cog_m: f64) -> Option<FlightShock> {
    let window = Window { from_s: flight.from_s, to_s: flight.to_s, ..*window };
    let series = series(data, &window, cog_m);
    if !has_enough_points(&series) {
        return None;
    }
    let mut strongest: Vec<_> = flight.modes.iter().collect();
    strongest.sort_by(|a, b| b.amplitude_m_s.total_cmp(&a.amplitude_m_s));
    let modes: Vec<Oscillation> = strongest.into_iter().map(oscillation).collect();
    let taken = fit(&series, &modes, None, Form::free(flight.drift))?;
    let length_s = window.to_s - window.from_s;
    let share = |i: u32| FIRST_PART + (1.0 - FIRST_PART - LAST_PART) * f64::from(i) / f64::from(PLACES);
    let drifts = if flight.drift { &[false, true][..] } else { &[false] };
    let forms = (0..=modes.len()).flat_map(|kept| drifts.iter().map(move |&drift| (kept, drift)));
    let beside = |(kept, drift): (usize, bool)| CommonStep::new(&series, &modes[..kept], Form::free(drift));
    let steps: Vec<CommonStep> = forms.filter_map(beside).collect();
    let least = |a: &(f64, f64, usize), b: &(f64, f64, usize)| a.0.total_cmp(&b.0);
    let with_step =
        |form: usize, after_s: f64| Some((steps[form].bic(after_s, taken.correlation)?, after_s, form));
    let coarse = (0..steps.len()).flat_map(|form| (0..=PLACES).map(move |i| (form, share(i) * length_s)));
    let (_, about_s, form) = coarse.filter_map(|(form, after_s)| with_step(form, after_s)).min_by(least)?;
    let step_s = length_s / f64::from(PLACES);
    let fine = (0..=REFINED).map(|i| about_s + step_s * (2.0 * f64::from(i) / f64::from(REFINED) - 1.0));
    let (bic, after_s, _) = fine.filter_map(|after_s| with_step(form, after_s)).min_by(least)?;
    if !(share(0)..=share(PLACES)).contains(&(after_s / length_s)) {
        return None;
    }
    Some(FlightShock {
        time_s: window.from_s + after_s,
        step_m_s: largest_m_s(data, steps[form].step(after_s)?)?,
        gain: taken.bic(&series, taken.correlation) - bic,
    })
}

/// The largest step of a transverse channel's velocity at a time within the window, with the flight's modes
/// beside it, m/s; `None` if too little of the window lies on either side, or samples are missing.
pub fn step_m_s(
    flight: &FlightFit,
    integrated: &Integrated,
    window: &Window,
    cog_m: f64,
    at_s: f64,
) -> Option<f64> {
    let (from_s, to_s) = (window.from_s.max(at_s - ABOUT_S), window.to_s.min(at_s + ABOUT_S));
    let series = series(integrated, &Window { from_s, to_s, ..*window }, cog_m);
    if !has_enough_points(&series) {
        return None;
    }
    let modes: Vec<Oscillation> = flight.modes.iter().map(oscillation).collect();
    let steps = CommonStep::new(&series, &modes, Form::free(flight.drift))?;
    largest_m_s(integrated, steps.step(at_s - from_s)?)
}

/// True if the series have points enough for a step, and no gaps.
fn has_enough_points(series: &[Series]) -> bool {
    series.iter().all(|s| s.steps_s.is_empty() && s.value.len() >= FEWEST)
}

/// The largest jump on a transverse channel, m/s.
fn largest_m_s(integrated: &Integrated, jumps: Vec<(f64, f64)>) -> Option<f64> {
    let of_transverse = integrated.signals.iter().zip(jumps).filter(|(s, _)| s.axis == Axis::Transverse);
    of_transverse.map(|(_, (jump_m_s, _))| jump_m_s).max_by(|a, b| a.abs().total_cmp(&b.abs()))
}

#[cfg(test)]
mod tests {
    use super::super::flight::fit_flights;
    use super::*;
    use crate::data::{End, Signal, example};
    use std::f64::consts::{PI, TAU};

    const RATE_HZ: f64 = 2e4;

    /// Force of 5 ms from 20 ms on, a mode of 80 Hz that rings from then on, and a shock of 1 ms at 60 ms.
    fn signal(name: &str, end: End, step_m_s: f64, ring_m_s: f64, blow_m_s: f64) -> Signal {
        let pulse = |t: f64, from_s: f64, length_s: f64, area_m_s: f64| {
            let x = (t - from_s) / length_s;
            if (0.0..1.0).contains(&x) { area_m_s * PI / (2.0 * length_s) * (PI * x).sin() } else { 0.0 }
        };
        let ring = |t: f64| {
            let since_s = t - 0.02;
            let w = TAU * 80.0;
            if since_s > 0.0 { ring_m_s * w * (-0.02 * w * since_s).exp() * (w * since_s).cos() } else { 0.0 }
        };
        let noise = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
        let force = |i: u32| {
            let t = f64::from(i) / RATE_HZ;
            pulse(t, 0.02, 5e-3, step_m_s) + ring(t) + pulse(t, 0.06, 1e-3, blow_m_s) + noise(i)
        };
        Signal {
            name: name.into(),
            end,
            position_m: if end == End::First { 0.1 } else { 4.9 },
            noise_m_s2: 0.3,
            free_fall_s: 0.02,
            ..example::signal(RATE_HZ, (0..1800).map(force).collect())
        }
    }

    /// The shock that explains the flight best, and the step if there is one.
    fn found(blow_m_s: f64) -> (FlightShock, f64) {
        let signals = [
            signal("A1", End::First, 19.0, 2.0, -0.4 * blow_m_s),
            signal("A2", End::Second, -7.0, 1.8, blow_m_s),
        ];
        let window = Window { from_s: 0.026, to_s: 0.085, drift: true, angular_velocity_rad_s: 0.0 };
        let integrated = Integrated::new(&signals, 0.02);
        let flight = fit_flights(&integrated, &window, None, 2.5, 3).swap_remove(0);
        let shock = find_shock(&flight, &integrated, &window, 2.5).expect("a flight without gaps");
        let step_m_s = step_m_s(&flight, &integrated, &window, 2.5, 0.0605).expect("points enough");
        assert!(super::step_m_s(&flight, &integrated, &window, 2.5, 0.0262).is_some());
        (shock, step_m_s)
    }

    #[test]
    fn a_blow_is_told_from_ringing() {
        let (blow, step_m_s) = found(0.5);
        // Modes fitted across the shock bend around a part of it.
        assert!((step_m_s - 0.5).abs() < 0.15, "{step_m_s}");
        assert!(found(0.0).1.abs() < 0.005);
        // A point of the series is a quarter of a millisecond, and the shock lasts one.
        assert!(blow.gain > 30.0 && (blow.time_s - 0.0605).abs() < 1e-3, "{blow:?}");
        assert!((blow.step_m_s - 0.5).abs() < 0.05, "{blow:?}");
        assert!(found(0.0).0.gain < 10.0, "{:?}", found(0.0));
    }
}
