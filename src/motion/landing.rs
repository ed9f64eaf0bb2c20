//! A flight in which L touches the target once more, to what that changes the velocity of each channel by.

use super::flight::centrifugal_m_s2;
use super::histories::AlongAxis;
use super::refit::with_modes;
use super::{Integrated, Window};
use crate::data::{Axis, Cask, End, FlightFit, Landing, Plateau, Signal};
use crate::numerics::reduce::{block_means, block_of, peak};

/// The touch is sought this long before R strikes, s, and in means over this rate, Hz: a touch lasts from a
/// tenth of a millisecond to some.
const SOUGHT_S: f64 = 0.12;
const RATE_HZ: f64 = 10_000.0;
/// A touch has this many times the largest mean before it …
const STANDS_OUT: f64 = 3.0;
/// … begins with this share of it …
const BEGINS: f64 = 0.25;
/// … and lasts one of these times, s: the first behind which modes ring on alone.
const LASTS_S: [f64; 7] = [5e-4, 1e-3, 2e-3, 3e-3, 4e-3, 6e-3, 8e-3];
/// What is left out beside it, and before R strikes, s.
const CLEAR_S: f64 = 1e-3;
/// Least stretch behind it, s and in periods of the slowest mode: what the touch has struck anew is told from
/// a step then.
const LEAST_S: f64 = 6e-3;
const LEAST_PERIODS: f64 = 0.4;
/// A stretch that plateau and modes explain leaves less, m/s.
const LEFT_M_S: f64 = 0.02;
/// What a push at L turns the cask by is known to this share: twice what contents leave open of the inertia.
const TURNED: f64 = 0.2;
/// Standard uncertainty of a step beside that of its two plateaus, as a share of it: room for what modes do
/// that the flight no longer shows. Of 17 simulated touches none moved the speed by 1 % of its step.
const SHARE: f64 = 0.03;

/// The one touch that `flight` holds near its end; `None` where there is none, or more than one, where the
/// stretch behind it is too short, where no axial channel tells what it changes along the axis, or where a
/// push at L would turn the cask otherwise.
#[must_use]
pub fn landing(flight: &FlightFit, integrated: &Integrated, window: &Window, cask: &Cask) -> Option<Landing> {
    let (signals, cog_m) = (&integrated.signals, cask.cog_m);
    if signals.iter().all(|s| s.axis == Axis::Transverse) || !cask.is_body {
        return None;
    }
    let sought_s = (window.to_s - SOUGHT_S).max(flight.from_s)..window.to_s - CLEAR_S;
    let from_s = touch_s(struck_first(signals)?, &sought_s)?;
    let period_s = flight.modes.iter().map(|m| 1.0 / m.frequency_hz).fold(0.0, f64::max);
    let stretch = |from_s: f64, to_s: f64, drift: bool, angular_velocity_rad_s: f64| {
        let window = Window { from_s, to_s, drift, angular_velocity_rad_s };
        let fit =
            with_modes(integrated, &FlightFit { from_s, to_s, drift, ..flight.clone() }, &window, cog_m)?;
        let is_explained = |(s, p): (&Signal, &Plateau)| s.axis == Axis::Axial || p.residual_m_s < LEFT_M_S;
        signals.iter().zip(&fit.plateaus).all(is_explained).then_some(fit.plateaus)
    };
    let turning_rad_s = window.angular_velocity_rad_s;
    let before_s = (from_s - CLEAR_S - SOUGHT_S).max(flight.from_s);
    if from_s - before_s < LEAST_S {
        return None;
    }
    let before = stretch(before_s, from_s - CLEAR_S, true, turning_rad_s)?;
    let latest_s = sought_s.end - LEAST_S.max(LEAST_PERIODS * period_s);
    let is_over = |behind_s: &f64| stretch(*behind_s, sought_s.end, false, turning_rad_s).is_some();
    let behind_s =
        LASTS_S.map(|lasts_s| from_s + lasts_s).into_iter().filter(|s| *s < latest_s).find(is_over)?;
    let line = AlongAxis::through(signals, cog_m)?;
    let mut landing =
        Landing { time_s: f64::midpoint(from_s, behind_s), steps_m_s: Vec::new(), u_m_s: Vec::new() };
    // Behind it the cask turns faster, and axial channels read more for it.
    let mut gained_rad_s = 0.0;
    for _ in 0..2 {
        let after = stretch(behind_s, sought_s.end, false, turning_rad_s + gained_rad_s)?;
        let since_s = behind_s - before_s;
        let step_m_s = |((signal, before), after): ((&Signal, &Plateau), &Plateau)| {
            let gains_m_s2 = before.zero_shift_m_s2 + centrifugal_m_s2(signal, window, cog_m);
            after.velocity_step_m_s - before.velocity_step_m_s - gains_m_s2 * since_s
        };
        landing.steps_m_s = signals.iter().zip(&before).zip(&after).map(step_m_s).collect();
        let u_m_s = |((after, before), step): ((&Plateau, &Plateau), &f64)| {
            let u_before_m_s = before.u_m_s.hypot(before.u_zero_shift_m_s2 * since_s);
            after.u_m_s.hypot(u_before_m_s).hypot(SHARE * step)
        };
        landing.u_m_s = after.iter().zip(&before).zip(&landing.steps_m_s).map(u_m_s).collect();
        gained_rad_s = -line.changed(&landing.steps_m_s)[1];
    }
    let [across_m_s, turned_rad_s, along_m_s] = line.changed(&landing.steps_m_s);
    // Θ ΔΩ = m (h/2 Δv_ξ − a Δv_η)   (32)
    let turning_m2_s = cask.height_m / 2.0 * along_m_s - cog_m * across_m_s;
    let by_push_rad_s = turning_m2_s * cask.mass_kg / cask.inertia_kg_m2;
    ((turned_rad_s - by_push_rad_s).abs() < TURNED * turned_rad_s.abs()).then_some(landing)
}

/// The transverse channel nearest to L.
fn struck_first(signals: &[Signal]) -> Option<&Signal> {
    let of_first = signals.iter().filter(|s| s.axis == Axis::Transverse && s.end == End::First);
    of_first.min_by(|a, b| a.position_m.total_cmp(&b.position_m))
}

/// When the pulse begins that stands out of a stretch, s.
fn touch_s(signal: &Signal, sought_s: &std::ops::Range<f64>) -> Option<f64> {
    let block = block_of(RATE_HZ, signal.sample_rate_hz);
    let from = signal.index_from(sought_s.start);
    let samples = signal.force_m_s2.get(from..signal.index_from(sought_s.end))?;
    let means: Vec<f64> = block_means(samples, block).iter().map(|mean| mean.abs()).collect();
    let largest = peak(&means);
    let first = means.iter().position(|mean| *mean > BEGINS * largest)?;
    (first > 0 && largest > STANDS_OUT * peak(&means[..first])).then(|| signal.time_s(from + first * block))
}

#[cfg(test)]
mod tests {
    use super::super::flight::fit_flight;
    use super::*;
    use crate::data::example;
    use std::f64::consts::{PI, TAU};

    const RATE_HZ: f64 = 2e4;

    /// A contact of 5 ms from 20 ms on, a touch of 2 ms at 0.25 s, and a mode of 80 Hz that both strike.
    fn signal(name: &str, (end, axis): (End, Axis), steps_m_s: [f64; 2], rings_m_s: [f64; 2]) -> Signal {
        let pulse = |t: f64, from_s: f64, length_s: f64, area_m_s: f64| {
            let x = (t - from_s) / length_s;
            if (0.0..1.0).contains(&x) { area_m_s * PI / (2.0 * length_s) * (PI * x).sin() } else { 0.0 }
        };
        let ring = |since_s: f64, size_m_s: f64| {
            let w = TAU * 80.0;
            if since_s > 0.0 { size_m_s * w * (-0.03 * w * since_s).exp() * (w * since_s).cos() } else { 0.0 }
        };
        let noise = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
        let force = |i: u32| {
            let t = f64::from(i) / RATE_HZ;
            let struck = pulse(t, 0.02, 5e-3, steps_m_s[0]) + ring(t - 0.02, rings_m_s[0]);
            struck + pulse(t, 0.25, 2e-3, steps_m_s[1]) + ring(t - 0.251, rings_m_s[1]) + noise(i)
        };
        Signal {
            name: name.into(),
            end,
            axis,
            position_m: if end == End::First { 0.1 } else { 4.9 },
            noise_m_s2: 0.3,
            free_fall_s: 0.02,
            ..example::signal(RATE_HZ, (0..6000).map(force).collect())
        }
    }

    fn found(steps_m_s: [f64; 3]) -> Option<Landing> {
        let across = [(End::First, Axis::Transverse), (End::Second, Axis::Transverse)];
        let signals = [
            signal("A1", across[0], [16.0, steps_m_s[0]], [4.0, 0.4 * steps_m_s[0]]),
            signal("A2", across[1], [-5.0, steps_m_s[1]], [3.5, 0.4 * steps_m_s[0]]),
            signal("A3", (End::First, Axis::Axial), [4.0, steps_m_s[2]], [0.1, 0.0]),
        ];
        let window = Window { from_s: 0.026, to_s: 0.2995, drift: true, angular_velocity_rad_s: 0.0 };
        let integrated = Integrated::over(&signals, 0.02);
        let flight = fit_flight(&integrated, &window, None, 2.5).expect("a flight");
        landing(&flight, &integrated, &window, &Cask::block("a", 4000.0, 5.0, 1.0))
    }

    /// A push of 0.2 m/s across the axis and of −1.2 m/s along it, at the corner of L.
    const PUSH_M_S: [f64; 3] = {
        let turned_rad_s = (0.5 * -1.2 - 2.5 * 0.2) * 12.0 / 26.0;
        [0.2 - 2.4 * turned_rad_s, 0.2 + 2.4 * turned_rad_s, -1.2]
    };

    #[test]
    fn a_touch_is_what_lies_between_two_plateaus() {
        let landing = found(PUSH_M_S).expect("a touch");
        assert!((landing.time_s - 0.251).abs() < 2e-3, "{landing:?}");
        for ((step, u), truth) in landing.steps_m_s.iter().zip(&landing.u_m_s).zip(PUSH_M_S) {
            assert!((step - truth).abs() < u.min(0.02), "{landing:?}");
        }
    }

    #[test]
    fn a_flight_without_a_touch_has_none() {
        assert_eq!(found([0.0; 3]), None);
    }

    #[test]
    fn what_one_channel_shows_alone_is_no_touch() {
        assert_eq!(found([1.3, 0.0, 0.0]), None);
    }
}
