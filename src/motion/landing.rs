//! Analyses a flight in which L touches the target again: the change of each channel's velocity.

use super::flight::{centrifugal_m_s2, oscillation, series};
use super::histories::AlongAxis;
use super::refit::with_modes;
use super::{BEFORE_SLAP_DOWN_S, Integrated, Window};
use crate::data::{Axis, Cask, End, FlightFit, Landing, Plateau, Signal, transverse};
use crate::numerics::as_f64;
use crate::numerics::damped_modes::{
    Drive, Fit, Form, Oscillation, Series, SeriesFit, describe, uniform_ringing,
};
use crate::numerics::reduce::{block_means, block_size, peak};

/// The touch is sought this long before R strikes, s, and in means over this rate, Hz: a touch lasts from a
/// tenth of a millisecond to several.
const SOUGHT_S: [f64; 2] = [0.12, 0.25];
const RATE_HZ: f64 = 10_000.0;
/// A touch exceeds the largest mean before it by this factor.
const TOUCH_FACTOR: f64 = 3.0;
/// A touch begins with this share of its largest mean.
const BEGIN_SHARE: f64 = 0.25;
/// Possible durations of a touch, s, after which the modes ring freely. Further touches may follow, up to a
/// multiple of [`ENDS_S`], s.
const LASTS_S: [f64; 6] = [5e-4, 1e-3, 2e-3, 3e-3, 4e-3, 6e-3];
const ENDS_S: f64 = 2e-3;
/// Margin on either side of the touch, and before R strikes, s.
const CLEAR_S: f64 = 1e-3;
/// Times before R strikes, s, between which the channel nearest L is read once more.
const JUST_BEFORE_S: [f64; 2] = [4e-4, 1e-4];
/// Shortest stretch after the touch, s and in periods of the slowest mode: from then on newly excited modes
/// can be separated from a step.
const LEAST_S: f64 = 6e-3;
const LEAST_PERIODS: f64 = 0.4;
/// Shortest such stretch if the touch determines the phases of the modes, s.
const LEAST_STRUCK_S: f64 = 1.5e-3;
/// Length of the flight before the touch that is used, s.
const BEFORE_S: f64 = 0.12;
/// Largest residual of a stretch that plateau and modes explain, m/s.
const LEFT_M_S: f64 = 0.02;
/// Relative uncertainty of the rotation from a push at L: twice that of the inertia with unknown contents.
const U_TURN: f64 = 0.2;
/// Without an axial channel the axial change is derived from the turning moment; the force may lean at most
/// this far from the normal (tangent).
const MOST_LEAN: f64 = 1.5;
/// A step whose relative standard uncertainty exceeds this is not used.
const MOST_U: f64 = 0.1;
/// Relative standard uncertainty of a step beside that of its two plateaus, to cover modes that the flight no
/// longer shows. Of 17 simulated touches none moved the speed by 1 % of its step.
const SHARE: f64 = 0.03;

/// Combines the touches of L near the end of the flight; `None` if there is none, if the stretch after them
/// is too short, or if a push at L would turn the cask otherwise.
pub fn landing(flight: &FlightFit, integrated: &Integrated, window: &Window, cask: &Cask) -> Option<Landing> {
    let signals = &integrated.signals;
    let struck = transverse(signals, End::First).filter(|_| cask.is_body)?;
    let nearest = signals.iter().position(|s| s.name == struck.name)?;
    let to_s = window.to_s - CLEAR_S;
    let begin_s = |sought_s: f64| touch_s(struck, &((to_s - sought_s).max(flight.from_s)..to_s));
    let mut begins_s: Vec<f64> = SOUGHT_S.into_iter().filter_map(begin_s).collect();
    begins_s.dedup();
    let read = |from_s: f64| {
        let until_s = from_s - CLEAR_S;
        let since_s = (until_s - BEFORE_S).max(flight.from_s);
        let over = FlightFit { from_s: since_s, to_s: until_s, ..flight.clone() };
        let before = with_modes(integrated, &over, window.angular_velocity_rad_s, cask.cog_m)?;
        let left_m_s = before.plateaus.iter().map(|plateau| plateau.residual_m_s);
        let is_read = until_s - since_s > LEAST_S && is_explained(signals, left_m_s);
        is_read.then(|| Touched { integrated, cask, window, before, nearest, from_s, to_s }.read())?
    };
    begins_s.into_iter().find_map(read)
}

/// True if plateau and modes leave only small residuals of the transverse channels.
fn is_explained(signals: &[Signal], left_m_s: impl Iterator<Item = f64>) -> bool {
    signals.iter().zip(left_m_s).all(|(signal, left_m_s)| signal.axis == Axis::Axial || left_m_s < LEFT_M_S)
}

/// A flight with touches near its end.
struct Touched<'a> {
    integrated: &'a Integrated<'a>,
    cask: &'a Cask,
    window: &'a Window,
    /// The stretch before them.
    before: FlightFit,
    /// The channel nearest to L.
    nearest: usize,
    /// Beginning of the touches, s.
    from_s: f64,
    /// End of the usable flight, s.
    to_s: f64,
}

impl Touched<'_> {
    fn read(&self) -> Option<Landing> {
        let period_s = self.before.modes.iter().map(|m| 1.0 / m.frequency_hz).fold(0.0, f64::max);
        let ends_s = |latest_s: f64| {
            let several = (4..).map(|i| f64::from(i) * ENDS_S);
            let ends_s = LASTS_S.into_iter().chain(several).map(|lasts_s| self.from_s + lasts_s);
            ends_s.take_while(move |end_s| *end_s < latest_s)
        };
        // The modes ring freely; if R strikes too soon for that, with the phases that the touch gives them.
        let free = |end_s: f64| Some((end_s, None, self.fit_after(end_s, None, 0.0)?));
        let struck = |end_s: f64| {
            let drive = self.touch_drive(end_s)?;
            let fit = self.fit_after(end_s, Some(&drive), 0.0)?;
            Some((end_s, Some(drive), fit))
        };
        let free_s = self.to_s - LEAST_S.max(LEAST_PERIODS * period_s);
        let found = ends_s(free_s).find_map(free);
        let (behind_s, drive, fit) = found.or_else(|| ends_s(self.to_s - LEAST_STRUCK_S).find_map(struck))?;
        let line = AlongAxis::new(&self.integrated.signals, self.cask.cog_m)?;
        let steps_m_s = |fit: &Fit| fit.series.iter().map(|own| own.plateau).collect::<Vec<_>>();
        // After the touch the cask turns faster, and axial channels read more because of it.
        let gained_rad_s = -line.step_sums(&steps_m_s(&fit))[1];
        let fit = self.fit_after(behind_s, drive.as_ref(), gained_rad_s)?;
        let mut steps_m_s = steps_m_s(&fit);
        let of_nearest_m_s = steps_m_s[self.nearest];
        // One equivalent step has the time that gives the correct mean over the touch.
        let share = (self.mean_m_s([self.from_s, behind_s], 0.0)? / of_nearest_m_s).clamp(0.0, 1.0);
        let once_s = behind_s - share * (behind_s - self.from_s);
        let strike_s = self.window.to_s + BEFORE_SLAP_DOWN_S;
        let late_s = JUST_BEFORE_S.map(|before_s| strike_s - before_s);
        let rings = |(mode, (a, b)): (&Oscillation, &(f64, f64))| {
            let z = uniform_ringing(*mode, f64::midpoint(late_s[0], late_s[1]) - behind_s, 0.0).next();
            z.map_or(0.0, |z| a * z.re + b * z.im)
        };
        let ringing_m_s: f64 = fit.modes.iter().zip(&fit.series[self.nearest].amplitudes).map(rings).sum();
        let last_m_s = self.mean_m_s(late_s, gained_rad_s)? - of_nearest_m_s - ringing_m_s;
        // A push that continues into the strike adds another one of the same kind, known to half of it.
        let more = (last_m_s / of_nearest_m_s).max(0.0);
        for step_m_s in &mut steps_m_s {
            *step_m_s *= 1.0 + more;
        }
        let time_s = (once_s + more * strike_s) / (1.0 + more);
        let since_s = behind_s - self.before.from_s;
        let u_m_s = |(own, before): (&SeriesFit, &Plateau)| {
            let u_before_m_s = before.u_m_s.hypot(before.u_zero_shift_m_s2 * since_s);
            own.u_plateau.hypot(u_before_m_s).hypot(SHARE.hypot(more / 2.0) * own.plateau)
        };
        let u_m_s: Vec<f64> = fit.series.iter().zip(&self.before.plateaus).map(u_m_s).collect();
        let changed = line.step_sums(&steps_m_s);
        let is_known = u_m_s[self.nearest] < MOST_U * of_nearest_m_s.abs();
        let touch = Landing { begin_s: self.from_s, time_s, steps_m_s, u_m_s, along_m_s: None };
        is_known.then(|| self.check_push(touch, changed))?
    }

    /// The touch, if its changes across the axis, of the rotation and along the axis are those of a push at L
    /// (32)
    fn check_push(&self, touch: Landing, [across_m_s, turned_rad_s, along_m_s]: [f64; 3]) -> Option<Landing> {
        let cask = self.cask;
        // Θ ΔΩ = m (h/2 Δv_ξ − a Δv_η)
        let (square_m2, half_m) = (cask.inertia_kg_m2 / cask.mass_kg, cask.height_m / 2.0);
        if self.integrated.signals.iter().any(|s| s.axis == Axis::Axial) {
            let by_push_rad_s = (half_m * along_m_s - cask.cog_m * across_m_s) / square_m2;
            return ((turned_rad_s - by_push_rad_s).abs() < U_TURN * turned_rad_s.abs()).then_some(touch);
        }
        let along_m_s = (square_m2 * turned_rad_s + cask.cog_m * across_m_s) / half_m;
        let u_m_s = U_TURN / 2.0 * (square_m2 * turned_rad_s / half_m).abs();
        // R strikes with the axis along the target.
        let to_turn_rad = self.window.angular_velocity_rad_s * (self.window.to_s - touch.time_s);
        let (sin, cos) = to_turn_rad.sin_cos();
        let (normal_m_s, friction_m_s) =
            (across_m_s * cos + along_m_s * sin, along_m_s * cos - across_m_s * sin);
        let is_push = friction_m_s.abs() < MOST_LEAN * normal_m_s;
        is_push.then_some(Landing { along_m_s: Some([along_m_s, u_m_s]), ..touch })
    }

    /// Fits plateau and modes to the changes from a time on; `None` if they do not explain them.
    fn fit_after(&self, from_s: f64, drive: Option<&Drive>, gained_rad_s: f64) -> Option<Fit> {
        let changes = self.changes([from_s, self.to_s], gained_rad_s)?;
        let modes = self.before.modes.iter().map(oscillation).collect();
        let fit = describe(&changes, modes, Form { drift: false, drive })?;
        is_explained(&self.integrated.signals, fit.series.iter().map(|own| own.residual)).then_some(fit)
    }

    /// The touches on the channel nearest to L, as the force on modes that ring from a time on.
    fn touch_drive(&self, end_s: f64) -> Option<Drive> {
        let changes = self.changes([self.from_s, end_s], 0.0)?;
        let own = &changes[self.nearest];
        let impulses: Vec<f64> = own.value.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let step_s = (end_s - self.from_s) / as_f64(impulses.len().max(1));
        Some(Drive { age_s: end_s - self.from_s, step_s, impulses })
    }

    /// Mean change of the velocity of the channel nearest to L, m/s.
    fn mean_m_s(&self, between_s: [f64; 2], gained_rad_s: f64) -> Option<f64> {
        let own = &self.changes(between_s, gained_rad_s)?[self.nearest].value;
        (!own.is_empty()).then(|| own.iter().sum::<f64>() / as_f64(own.len()))
    }

    /// Each velocity between two times, s, less the extrapolation of the stretch before the touches; `None`
    /// if samples are lost.
    fn changes(&self, [from_s, to_s]: [f64; 2], gained_rad_s: f64) -> Option<Vec<Series>> {
        let Self { integrated, window, before, .. } = self;
        let cog_m = self.cask.cog_m;
        let angular_velocity_rad_s = window.angular_velocity_rad_s + gained_rad_s;
        let over = Window { from_s, to_s, drift: false, angular_velocity_rad_s };
        let mut all = series(integrated, &over, cog_m);
        let since_s = from_s - before.from_s;
        for ((own, signal), plateau) in all.iter_mut().zip(&*integrated.signals).zip(&before.plateaus) {
            // The centrifugal force after `from_s` is already subtracted.
            let centrifugal_m_s = centrifugal_m_s2(signal, window.angular_velocity_rad_s, cog_m) * since_s;
            let first_s = *own.time_s.first()?;
            for (value, time_s) in own.value.iter_mut().zip(&own.time_s) {
                let shifted_m_s = plateau.zero_shift_m_s2 * (since_s + time_s);
                *value -= plateau.velocity_step_m_s + centrifugal_m_s + shifted_m_s;
            }
            for (mode, (a, b)) in before.modes.iter().zip(&plateau.ringing_m_s) {
                let ringing = uniform_ringing(oscillation(mode), since_s + first_s, 2.0 * first_s);
                own.value.iter_mut().zip(ringing).for_each(|(value, z)| *value -= a * z.re + b * z.im);
            }
        }
        all.iter().all(|own| own.steps_s.is_empty()).then_some(all)
    }
}

/// Beginning of the pulse that stands out of a stretch, s.
fn touch_s(signal: &Signal, sought_s: &std::ops::Range<f64>) -> Option<f64> {
    let block = block_size(RATE_HZ, signal.sample_rate_hz);
    let from = signal.index_from(sought_s.start);
    let samples = signal.force_m_s2.get(from..signal.index_from(sought_s.end))?;
    let means: Vec<f64> = block_means(samples, block).iter().map(|mean| mean.abs()).collect();
    let largest = peak(&means);
    let first = means.iter().position(|mean| *mean > BEGIN_SHARE * largest)?;
    (first > 0 && largest > TOUCH_FACTOR * peak(&means[..first])).then(|| signal.time_s(from + first * block))
}

#[cfg(test)]
mod tests {
    use super::super::flight::fit_flights;
    use super::*;
    use crate::data::example;
    use std::f64::consts::{PI, TAU};

    const RATE_HZ: f64 = 2e4;

    /// A contact of 5 ms from 20 ms on, touches of 2 ms at these times, and a mode of 80 Hz that all strike.
    fn signal(
        name: &str,
        (end, axis): (End, Axis),
        steps_m_s: [f64; 2],
        rings_m_s: [f64; 2],
        touches_s: &[f64],
    ) -> Signal {
        let pulse = |t: f64, from_s: f64, length_s: f64, area_m_s: f64| {
            let x = (t - from_s) / length_s;
            if (0.0..1.0).contains(&x) { area_m_s * PI / (2.0 * length_s) * (PI * x).sin() } else { 0.0 }
        };
        let ring = |since_s: f64, size_m_s: f64| {
            let w = TAU * 80.0;
            // The force of v = size e^(−ζωt) sin ωt, which leaves no step.
            let turning = |wt: f64| (-0.03 * wt).exp() * (wt.cos() - 0.03 * wt.sin());
            if since_s > 0.0 { size_m_s * w * turning(w * since_s) } else { 0.0 }
        };
        let noise = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
        let force = |i: u32| {
            let t = f64::from(i) / RATE_HZ;
            let struck = pulse(t, 0.02, 5e-3, steps_m_s[0]) + ring(t - 0.02, rings_m_s[0]);
            let touch =
                |at_s: &f64| pulse(t, *at_s, 2e-3, steps_m_s[1]) + ring(t - at_s - 1e-3, rings_m_s[1]);
            struck + touches_s.iter().map(touch).sum::<f64>() + noise(i)
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

    fn found([first, second, along]: [f64; 3], touches_s: &[f64], is_axial: bool) -> Option<Landing> {
        let across = [(End::First, Axis::Transverse), (End::Second, Axis::Transverse)];
        let mut signals = vec![
            signal("A1", across[0], [16.0, first], [4.0, 0.4 * first], touches_s),
            signal("A2", across[1], [-5.0, second], [3.5, 0.4 * first], touches_s),
        ];
        if is_axial {
            signals.push(signal("A3", (End::First, Axis::Axial), [4.0, along], [0.1, 0.0], touches_s));
        }
        let window = Window { from_s: 0.026, to_s: 0.2995, drift: true, angular_velocity_rad_s: 0.0 };
        let integrated = Integrated::new(&signals, 0.02);
        let flight = fit_flights(&integrated, &window, None, 2.5, 3).swap_remove(0);
        landing(&flight, &integrated, &window, &Cask::block("a", 4000.0, 5.0, 1.0))
    }

    /// The steps of A1, A2 and A3 by a push across the axis and one along it, m/s, at the corner of L.
    const fn by_push([across_m_s, along_m_s]: [f64; 2]) -> [f64; 3] {
        let turned_rad_s = (0.5 * along_m_s - 2.5 * across_m_s) * 12.0 / 26.0;
        [across_m_s - 2.4 * turned_rad_s, across_m_s + 2.4 * turned_rad_s, along_m_s]
    }

    /// The steps of transverse channels as found are those of `touches` such pushes.
    #[track_caller]
    fn is_followed(landing: &Landing, push: [f64; 3], touches: f64) {
        for ((step, u), truth) in landing.steps_m_s.iter().zip(&landing.u_m_s).zip(push).take(2) {
            assert!((step - touches * truth).abs() < u.min(0.04), "{landing:?}");
        }
    }

    #[test]
    fn a_touch_is_what_lies_between_two_plateaus() {
        let push = by_push([0.2, -1.2]);
        let landing = found(push, &[0.25], true).expect("a touch");
        assert!(
            (landing.time_s - 0.251).abs() < 2e-3 && (landing.begin_s - 0.25).abs() < 1e-3,
            "{landing:?}"
        );
        is_followed(&landing, push, 1.0);
        assert!((landing.steps_m_s[2] - push[2]).abs() < landing.u_m_s[2].min(0.02), "{landing:?}");
    }

    #[test]
    fn touches_that_follow_one_another_are_one_step() {
        let push = by_push([0.5, -0.2]);
        let landing = found(push, &[0.2, 0.23, 0.26], true).expect("touches");
        is_followed(&landing, push, 3.0);
        assert!((landing.time_s - 0.231).abs() < 3e-3 && (landing.begin_s - 0.2).abs() < 1e-3, "{landing:?}");
    }

    #[test]
    fn a_touch_shortly_before_the_strike_gives_the_modes_their_phases() {
        let push = by_push([0.5, -0.2]);
        is_followed(&found(push, &[0.29], false).expect("a touch"), push, 1.0);
    }

    #[test]
    fn a_push_at_the_corner_tells_what_no_channel_shows() {
        let push = by_push([0.5, -0.2]);
        let landing = found(push, &[0.25], false).expect("a touch");
        is_followed(&landing, push, 1.0);
        let [along_m_s, u_m_s] = landing.along_m_s.expect("a velocity along the axis");
        assert!((along_m_s - push[2]).abs() < u_m_s, "{landing:?}");
    }

    #[test]
    fn a_flight_without_a_touch_has_none() {
        assert_eq!(found([0.0; 3], &[0.25], true), None);
    }

    #[test]
    fn what_one_channel_shows_alone_is_no_touch() {
        for is_axial in [true, false] {
            assert_eq!(found([1.3, 0.0, 0.0], &[0.25], is_axial), None);
            assert_eq!(found([0.0, 1.3, 0.0], &[0.25], is_axial), None);
        }
    }
}
