//! Motion when L leaves the target after a contact of finite duration: a half-sine of force instead of an
//! impulse.

use super::impact::{Struck, coefficient, strike_first_end};
use super::state::{State, arms_m, runge_kutta, second_end_m};
use crate::data::{Body, Contact, Drop};
use std::f64::consts::PI;

/// Steps of the integration: sixteen times as many move the vertical speed of R by less than 1e-4, near
/// sticking by some of that more.
const STEPS: u32 = 16;
/// Number of parts of a step in which a corner at rest begins to slide: near the friction that sticking needs
/// it slides at both ends of the pulse.
const PARTS: f64 = 32.0;
/// Rounds of the search for the force, and the rebound error at which it ends, m/s: one more secant step
/// follows.
const ROUNDS: usize = 30;
const CLOSE_M_S: f64 = 1e-5;
/// Upper limit on the energy after a contact, relative to that before: half sines that swing a short rod
/// through the target in a long contact would exceed it.
const MOST_ENERGY: f64 = 1.05;
/// If R is lower than this above the target when L strikes, it strikes too, m.
const FLAT_M: f64 = 1e-9;
/// A corner slower than this does not slide, m/s.
const STOPPED_M_S: f64 = 1e-9;

/// A half-sine of force on L's corner.
struct Pulse<'a> {
    body: &'a Body,
    gravity_m_s2: f64,
    friction: f64,
    duration_s: f64,
    steps: u32,
}

/// Motion after L is pushed for `drop.contact_duration_s` by F sin(π t/T), with F such that its corner leaves
/// as fast as after the impulse   (41)
///
/// The arms a, b turn with the body, gravity acts, and friction holds the corner or lets it slide, moment by
/// moment. If no such force is found, or one that adds energy, the impulse is used. If R strikes while L is
/// still pressed on, the motion is that at the strike, with the time since first contact, s.
pub(super) fn push_first_end(
    body: &Body,
    before: &State,
    drop: &Drop,
    contact: Contact,
    k: f64,
) -> (Struck, Option<f64>) {
    let struck = strike_first_end(body, before, contact, k);
    let duration_s = drop.contact_duration_s;
    if duration_s <= 0.0 || struck.vertical_impulse_n_s <= 0.0 {
        return (struck, None);
    }
    let friction = coefficient(contact);
    Pulse { body, gravity_m_s2: drop.gravity_m_s2, friction, duration_s, steps: STEPS }.find(before, struck)
}

impl Pulse<'_> {
    /// The pulse after which L's corner leaves as fast as in `struck`.
    fn find(&self, before: &State, struck: Struck) -> (Struck, Option<f64>) {
        let Self { body, gravity_m_s2, duration_s, .. } = *self;
        let leaves_m_s = struck.after.corner(body, body.cog_m).vertical_velocity_m_s;
        let start = self.stop_corner(before);
        let missed = |force_n: f64| {
            let left = self.follow_pulse(&start, force_n, false).0;
            left.corner(body, body.cog_m).vertical_velocity_m_s - leaves_m_s
        };
        // ∫ F sin(π t/T) dt = 2 F T/π
        let first_n = struck.vertical_impulse_n_s * PI / (2.0 * duration_s);
        let Some(force_n) = secant(missed, first_n) else { return (struck, None) };
        let (left, time_s) = self.follow_pulse(&start, force_n, true);
        let energy_j = |at: &State| at.kinetic_energy_j(body) + body.mass_kg * gravity_m_s2 * at.height_m;
        if energy_j(&left) > MOST_ENERGY * energy_j(before) {
            return (struck, None);
        }
        let momentum = |after: f64, before: f64| (after - before) * body.mass_kg;
        let fallen_m_s = time_s * gravity_m_s2;
        let pushed = Struck {
            horizontal_impulse_n_s: momentum(left.horizontal_velocity_m_s, before.horizontal_velocity_m_s),
            vertical_impulse_n_s: momentum(
                left.vertical_velocity_m_s + fallen_m_s,
                before.vertical_velocity_m_s,
            ),
            after: left,
            ..struck
        };
        (pushed, Some(time_s).filter(|time_s| *time_s < duration_s))
    }

    /// Friction without limit stops the corner before the normal force has had any effect.
    fn stop_corner(&self, before: &State) -> State {
        if self.friction.is_finite() {
            return *before;
        }
        strike_first_end(self.body, before, Contact::Rough, -1.0).after
    }

    /// Motion at the end of the pulse, or when R comes down before it, if that is possible, and its time: for
    /// a flat body at once.
    fn follow_pulse(&self, start: &State, force_n: f64, has_second_end: bool) -> (State, f64) {
        let (step_s, along_m) = (self.duration_s / f64::from(self.steps), second_end_m(self.body));
        let (mut at, mut time_s) = (*start, 0.0);
        if has_second_end && start.corner(self.body, along_m).height_m <= FLAT_M {
            return (at, time_s);
        }
        for i in 1..=self.steps {
            let until_s = f64::from(i) * step_s;
            while time_s < until_s {
                let (next, taken_s) = self.stretch(&at, time_s, until_s - time_s, force_n);
                let reached = |state: &State| state.corner(self.body, along_m).height_m;
                let heights = has_second_end.then(|| (reached(&at), reached(&next)));
                if let Some((above, below)) = heights.filter(|(above, below)| *below <= 0.0 && *above > 0.0) {
                    let taken_s = taken_s * above / (above - below);
                    let near = self.stretch(&at, time_s, taken_s, force_n).0.corner(self.body, along_m);
                    let taken_s = taken_s - near.height_m / near.vertical_velocity_m_s;
                    let (at, taken_s) = self.stretch(&at, time_s, taken_s, force_n);
                    return (at, time_s + taken_s);
                }
                (at, time_s) = (next, time_s + taken_s);
            }
        }
        (at, self.duration_s)
    }

    /// Advances by a step of at most `longest_s` in one contact state: it ends when the sliding stops, and
    /// near its beginning. Returns the time of the step too.
    fn stretch(&self, at: &State, time_s: f64, longest_s: f64, force_n: f64) -> (State, f64) {
        let sticks = |time_s: f64| self.friction_ratio(at, self.force_n(time_s, force_n)).is_none();
        let is_long = longest_s * PARTS * f64::from(self.steps) > self.duration_s;
        if is_long && sticks(time_s) != sticks(time_s + longest_s) {
            return self.stretch(at, time_s, longest_s * 0.5, force_n);
        }
        let ratio = self.friction_ratio(at, self.force_n(time_s + longest_s * 0.5, force_n));
        let (mut next, mut taken_s) = (self.step(at, ratio, (time_s, longest_s), force_n), longest_s);
        if ratio.is_some() {
            let (slip_m_s, later_m_s) = (self.slip_m_s(at), self.slip_m_s(&next));
            let was_sliding = slip_m_s.abs() >= STOPPED_M_S;
            if !(was_sliding && later_m_s * slip_m_s < 0.0) {
                return (next, longest_s);
            }
            taken_s = longest_s * slip_m_s / (slip_m_s - later_m_s);
            next = self.step(at, ratio, (time_s, taken_s), force_n);
        }
        let left_m_s = self.slip_m_s(&next);
        (State { horizontal_velocity_m_s: next.horizontal_velocity_m_s - left_m_s, ..next }, taken_s)
    }

    fn slip_m_s(&self, at: &State) -> f64 {
        at.corner(self.body, self.body.cog_m).horizontal_velocity_m_s
    }

    fn force_n(&self, time_s: f64, largest_n: f64) -> f64 {
        (time_s * (PI / self.duration_s)).sin() * largest_n
    }

    /// F_x/F of a corner that slides, with `normal_n` on it; `None` if it sticks.
    fn friction_ratio(&self, at: &State, normal_n: f64) -> Option<f64> {
        let slip_m_s = self.slip_m_s(at);
        if slip_m_s.abs() >= STOPPED_M_S {
            return Some(-self.friction * slip_m_s.signum());
        }
        let needed_n = self.holding_force_n(at, normal_n);
        (needed_n.abs() > self.friction * normal_n).then(|| self.friction * needed_n.signum())
    }

    /// F_x that keeps the corner in place, ẍ_C = F_x n_xx + a ω² − a b F/Θ = 0, n_xx = 1/m + b²/Θ.
    fn holding_force_n(&self, at: &State, normal_n: f64) -> f64 {
        let (a, b) = arms_m(self.body, at.angle_rad, self.body.cog_m);
        let theta = self.body.inertia_kg_m2;
        let w = at.angular_velocity_rad_s;
        (a * b * normal_n / theta - a * w * w) / (b * b / theta + 1.0 / self.body.mass_kg)
    }

    /// A step over `span_s` (start and length), with a given F_x/F or with the F_x that holds the corner.
    fn step(&self, at: &State, ratio: Option<f64>, span_s: (f64, f64), largest_n: f64) -> State {
        runge_kutta(at, span_s, |at, time_s| {
            let normal_n = self.force_n(time_s, largest_n);
            let along_n = ratio.map_or_else(|| self.holding_force_n(at, normal_n), |ratio| normal_n * ratio);
            let (a, b) = arms_m(self.body, at.angle_rad, self.body.cog_m);
            State {
                height_m: at.vertical_velocity_m_s,
                angle_rad: -at.angular_velocity_rad_s,
                horizontal_velocity_m_s: along_n / self.body.mass_kg,
                vertical_velocity_m_s: normal_n / self.body.mass_kg - self.gravity_m_s2,
                angular_velocity_rad_s: (a * normal_n - b * along_n) / self.body.inertia_kg_m2,
            }
        })
    }
}

/// The root of `missed` near `first`; `None` if the secant method does not converge.
fn secant(missed: impl Fn(f64) -> f64, first: f64) -> Option<f64> {
    let (mut low, mut high) = ((first, missed(first)), (1.02 * first, missed(1.02 * first)));
    for _ in 0..ROUNDS {
        let slope = (high.1 - low.1) / (high.0 - low.0);
        let next = high.0 - high.1 / slope;
        if high.1.abs() <= CLOSE_M_S {
            return (slope > 0.0).then_some(next);
        }
        if !(0.0..100.0 * first).contains(&next) {
            return None;
        }
        (low, high) = (high, (next, missed(next)));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::{predict, thin_rod};
    use super::*;
    use crate::data::BodyModel;

    fn cask() -> Body {
        Body { model: BodyModel::Body, height_m: 0.8, ..thin_rod(4466.0, 5.5) }
    }

    fn lasting(angle_deg: f64, contact_duration_s: f64) -> Drop {
        Drop { contact_duration_s, ..Drop::from_height(9.0, angle_deg.to_radians()) }
    }

    /// At 21° the corner sticks from about 0.6 on.
    const CONTACTS: [Contact; 5] = [
        Contact::Rough,
        Contact::Coulomb(0.6),
        Contact::Coulomb(0.4),
        Contact::Coulomb(0.15),
        Contact::Smooth,
    ];

    #[test]
    fn a_short_pulse_is_the_impulse() {
        for contact in CONTACTS {
            let speed = |duration_s| {
                predict(&cask(), &lasting(15.0, duration_s), contact, 0.5).slap_down_speed_m_s.expect("R")
            };
            // The remainder is of first order in the length: 2 % of the speed at 10 ms.
            let [whole, tenth] = [1e-5, 1e-6].map(|duration_s| (speed(duration_s) / speed(0.0) - 1.0).abs());
            assert!(whole < 2e-5 && tenth < 0.2 * whole + 1e-9, "{contact}: {whole} {tenth}");
        }
    }

    #[test]
    fn there_is_a_force_for_every_length_and_sixteen_steps_suffice() {
        let (mut none, body) = (0, cask());
        for contact in CONTACTS {
            for (angle_deg, k) in [3.0, 8.0, 15.0, 21.0, 30.0, 45.0]
                .into_iter()
                .flat_map(|a| [0.0, 0.3, 0.6, 1.0].map(|k| (a, k)))
            {
                for duration_s in [1e-3, 1e-2, 3e-2, 6e-2, 0.2] {
                    let drop = lasting(angle_deg, duration_s);
                    let start = State::falling(&body, drop.angle_rad, &drop);
                    let struck = || strike_first_end(&body, &start, contact, k);
                    let friction = coefficient(contact);
                    let end = |steps| {
                        let pulse = Pulse { body: &body, gravity_m_s2: 9.81, friction, duration_s, steps };
                        pulse.find(&start, struck()).0.after
                    };
                    let (few, many) = (end(STEPS), end(16 * STEPS));
                    none += u32::from(few == struck().after);
                    let r = |state: &State| state.corner(&body, second_end_m(&body)).vertical_velocity_m_s;
                    let off = (r(&few) / r(&many) - 1.0).abs();
                    // Near sticking; without a search for the begin of the sliding it is 2e-3.
                    let most = if contact == Contact::Coulomb(0.6) { 3e-4 } else { 1e-4 };
                    assert!(duration_s > 0.1 || off < most, "{contact} {angle_deg}° {k} {duration_s}: {off}");
                }
            }
        }
        // A smooth corner that is thrown back at full speed for 0.2 s, four times what R needs to come down.
        assert!(none <= 1, "{none}");
    }

    #[test]
    fn no_pulse_gives_energy() {
        let rod = Body { height_m: 0.019, ..thin_rod(20.0, 0.55) };
        for contact in CONTACTS {
            for (tenth_deg, k) in (1..450).flat_map(|tenth| [0.3, 1.0].map(|k| (tenth, k))) {
                let drop = lasting(f64::from(tenth_deg) / 10.0, 0.027);
                // The rod falls by its length at most while it turns: 0.55 m of 9.
                let ratio = predict(&rod, &drop, contact, k).energy_ratio.unwrap_or(0.0);
                assert!(ratio < MOST_ENERGY * (1.0 + 0.55 / 9.0), "{contact} {tenth_deg} {k}: {ratio}");
            }
        }
    }

    /// Draws between 0 and 1, a low-discrepancy sequence for each dimension.
    fn evenly(i: u32, irrational: f64) -> f64 {
        (f64::from(i) * irrational).fract()
    }

    #[test]
    fn an_impulse_is_slower_where_l_leaves_before_r_strikes() {
        let body = cask();
        let (mut left, mut smooth_left, mut pressed) = (0, 0, 0);
        for i in 1..=1200 {
            let (angle_deg, k) = (1.0 + 24.0 * evenly(i, 2_f64.sqrt()), evenly(i, 3_f64.sqrt()));
            let drop = lasting(angle_deg, 0.005 + 0.025 * evenly(i, 5_f64.sqrt()));
            let contact = [Contact::Rough, Contact::Coulomb(0.3), Contact::Smooth][(i % 3) as usize];
            let at = |lasts_s| predict(&body, &Drop { contact_duration_s: lasts_s, ..drop }, contact, k);
            let (impulse, pulse) = (at(0.0), at(drop.contact_duration_s));
            if !impulse.is_single_slap_down() || !pulse.is_single_slap_down() {
                continue;
            }
            let rises_m = body.length_m * drop.angle_rad.sin();
            let share = drop.contact_duration_s * drop.impact_velocity_m_s / rises_m;
            let has_left = pulse.flight_time_s >= Some(drop.contact_duration_s);
            let gain = pulse.slap_down_speed_m_s.expect("R") / impulse.slap_down_speed_m_s.expect("R") - 1.0;
            // The numbers of docs/physics.md, (41).
            assert!(share > 0.6 || has_left, "{angle_deg} {share}");
            assert!(share < 0.9 || !has_left, "{angle_deg} {share}");
            if has_left && contact != Contact::Smooth {
                left += 1;
                assert!(gain > -1e-6, "{contact} {angle_deg}° {k}: {gain}");
            } else if has_left {
                smooth_left += 1;
                assert!(gain > -0.008, "{angle_deg}° {k}: {gain}");
            } else if share > 1.2 {
                pressed += 1;
                assert!(gain < -0.03, "{contact} {angle_deg}° {k}: {gain}");
            }
        }
        assert!(left > 500 && smooth_left > 200 && pressed > 30, "{left} {smooth_left} {pressed}");
    }

    #[test]
    fn a_flat_body_strikes_with_both_ends_at_once() {
        let flat = predict(&cask(), &lasting(0.0, 0.02), Contact::Rough, 0.5);
        assert_eq!(flat.flight_time_s, Some(0.0));
        // As it falls, without rotation.
        let fallen_m_s = lasting(0.0, 0.02).impact_velocity_m_s;
        assert!((flat.slap_down_speed_m_s.expect("R") - fallen_m_s).abs() < 1e-9, "{flat:?}");
    }
}
