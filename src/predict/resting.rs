//! Follows L on the target until R strikes or L lifts off: pivoting, or sliding against friction.

use super::impact::strike_first_end;
use super::state::State;
use super::support::{Grip, Hold, Support, Turning};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Rotation within one step of the integration, rad, and its longest time in √(l/g), for a body that starts
/// from rest: 15 ms for 5.5 m on Earth, where its first degrees take a tenth of a second. The fourth-order
/// Runge-Kutta method leaves 3e-9 of the speed.
const STEP: f64 = 0.02;
/// Shortest step, s: on the border between sticking and sliding round-off would otherwise stop the clock; a
/// µm/s of sliding.
const LEAST_STEP_S: f64 = 1e-6;
/// A body that has not come down in this time stands, in √(l/g), 30 s for 5.5 m: tens of times the time to
/// topple from 1° beside the balance.
const LONGEST: f64 = 40.0;

/// Rotation slower than this, rad/s and rad/s², is round-off: the body stands.
const STILL: f64 = 1e-9;

/// End of a rest of L on the target.
#[derive(Clone, Copy)]
pub(super) struct RestEnd {
    pub at: State,
    /// Since the start, s.
    pub time_s: f64,
    /// True if R strikes; else L lifts off.
    pub strikes: bool,
}

/// Condition that ends a stretch in one contact state.
enum Margin {
    /// The inclination: R strikes.
    Angle,
    /// The push of the target.
    Lift,
    /// The sliding, or the friction that holds.
    Hold,
}

impl Support<'_> {
    /// Follows L's rest on the target to its end; `None` if the body stands, or turns over the other way.
    /// Whole turns that the body made in flight do not count.
    pub fn follow(&self, from: &State) -> Option<RestEnd> {
        let turns_rad = TAU * (from.angle_rad / TAU).round();
        let end = self.follow_within_turn(&from.turn(-turns_rad))?;
        Some(RestEnd { at: end.at.turn(turns_rad), ..end })
    }

    /// Past the vertical L does not bring R down on this side.
    fn follow_within_turn(&self, from: &State) -> Option<RestEnd> {
        let mut elapsed_s = 0.0;
        if from.angle_rad.cos() <= 0.0 {
            return None;
        }
        if from.angle_rad <= self.down_rad() {
            return Some(RestEnd { at: *from, time_s: elapsed_s, strikes: true });
        }
        let mut at = Turning::from_state(self.body, from);
        let unit_s = (self.body.length_m / self.gravity_m_s2).sqrt();
        while elapsed_s < LONGEST * unit_s && at.angle_rad < FRAC_PI_2 {
            let (grip, forces) = self.find_grip(&at);
            if grip == Grip::Jams {
                let struck = strike_first_end(self.body, &self.state(&at), self.contact, 0.0);
                at = Turning::from_state(self.body, &struck.after);
                continue;
            }
            if self.hold != Hold::Pulls && forces.normal_m_s2 <= 0.0 {
                // A body that lifts off at once moves as the impact left it.
                let lifted = if elapsed_s == 0.0 { *from } else { self.state(&at) };
                return Some(RestEnd { at: lifted, time_s: elapsed_s, strikes: false });
            }
            let turning_rad_s = at.angular_velocity_rad_s.abs();
            if turning_rad_s < STILL && forces.angular_acceleration_rad_s2.abs() < STILL {
                return None;
            }
            let step_s = (STEP / turning_rad_s).min(STEP * unit_s);
            let next = self.step(&at, grip, step_s);
            if self.margins(&next, grip).iter().all(|margin| *margin > 0.0) {
                at = next;
                elapsed_s += step_s;
                continue;
            }
            let (taken_s, ended) = self.first_margin_used(&at, grip, step_s);
            at = self.step(&at, grip, taken_s);
            elapsed_s += taken_s;
            if !matches!(ended, Margin::Hold) {
                let strikes = matches!(ended, Margin::Angle);
                return Some(RestEnd { at: self.state(&at), time_s: elapsed_s, strikes });
            }
            if grip != Grip::Sticks {
                at.slip_m_s = 0.0;
            }
        }
        None
    }

    /// The time within a step of `step_s` at which the first margin reaches zero, and that margin.
    fn first_margin_used(&self, at: &Turning, grip: Grip, step_s: f64) -> (f64, Margin) {
        let (mut low_s, mut high_s) = (0.0, step_s);
        // 2^-24 of a step is a nanosecond. A step of Newton's method takes the angle and the sliding from
        // there to their end; when the lift or the hold of friction ends no force jumps, and the error is
        // quadratic.
        for _ in 0..24 {
            let mid_s = f64::midpoint(low_s, high_s);
            let margins = self.margins(&self.step(at, grip, mid_s), grip);
            if margins.iter().all(|margin| *margin > 0.0) { low_s = mid_s } else { high_s = mid_s }
        }
        let there = self.step(at, grip, high_s);
        let margins = self.margins(&there, grip);
        if margins[0] <= 0.0 {
            ((there.angle_rad - self.down_rad()) / there.angular_velocity_rad_s + high_s, Margin::Angle)
        } else if margins[1] <= 0.0 && (self.hold == Hold::Pushes || grip != Grip::Sticks) {
            (high_s, Margin::Lift)
        } else if grip == Grip::Sticks || high_s < LEAST_STEP_S {
            (high_s.max(LEAST_STEP_S), Margin::Hold)
        } else {
            let rate_m_s2 = self.forces(&there, grip).slip_rate_m_s2;
            (-there.slip_m_s / rate_m_s2 + high_s, Margin::Hold)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::held::HeldBody;
    use super::super::thin_rod;
    use super::*;
    use crate::data::{Body, BodyModel, Contact};

    fn support(body: &Body, contact: Contact, hold: Hold) -> Support<'_> {
        Support { body, gravity_m_s2: 9.81, contact, hold, sunk_m: 0.0 }
    }

    fn turning(body: &Body, angle_rad: f64, angular_velocity_rad_s: f64) -> State {
        support(body, Contact::Rough, Hold::Pushes).state(&Turning {
            angle_rad,
            angular_velocity_rad_s,
            slip_m_s: 0.0,
        })
    }

    fn second_end(end: Option<RestEnd>) -> (State, f64) {
        let RestEnd { at, time_s, strikes } = end.expect("R strikes some time");
        assert!(strikes, "L lifts off");
        (at, time_s)
    }

    #[test]
    fn held_on_both_sides_it_is_the_closed_form() {
        let body = Body { model: BodyModel::Body, height_m: 0.8, cog_m: 2.4, ..thin_rod(4466.0, 5.5) };
        for (contact, slides) in [(Contact::Coulomb(0.0), true), (Contact::Rough, false)] {
            for (angle_rad, w) in [(0.1, 4.0), (0.5, 2.0), (1.0, 0.3)] {
                let start = turning(&body, angle_rad, w);
                let support = support(&body, contact, Hold::Pulls);
                let (state, time_s) = second_end(support.follow(&start));
                let held = HeldBody { body: &body, gravity_m_s2: 9.81, slides, start };
                let (closed, closed_s) = (held.at_second_end().expect("R strikes"), held.time_s());
                // Fourth order with 0.02 rad a step: 3e-9; Simpson with 64 steps: 1e-7 of the time.
                let ratio = state.angular_velocity_rad_s / closed.angular_velocity_rad_s;
                assert!((ratio - 1.0).abs() < 3e-9, "{contact} {angle_rad}: {ratio}");
                assert!((time_s / closed_s - 1.0).abs() < 1e-6, "{contact} {angle_rad}: {time_s} {closed_s}");
            }
        }
    }

    #[test]
    fn a_pivot_lifts_off_where_the_rods_force_changes_sign() {
        let rod = thin_rod(1000.0, 5.0);
        let end = support(&rod, Contact::Rough, Hold::Pushes).follow(&turning(&rod, 1.3, 1.0));
        let RestEnd { at, time_s, strikes } = end.expect("it does not stay");
        assert!(!strikes && time_s > 0.0);
        // physics: N/m = g (1 − ¾ cos² φ) − (l/2) ω² sin φ for the rough rod.
        let (sin, cos) = at.angle_rad.sin_cos();
        let normal_m_s2 = 9.81 * (1.0 - 0.75 * cos * cos) - 2.5 * at.angular_velocity_rad_s.powi(2) * sin;
        assert!(normal_m_s2.abs() < 1e-8, "{normal_m_s2}");
    }

    #[test]
    fn friction_takes_what_the_sliding_costs() {
        let body = Body { height_m: 0.6, ..thin_rod(1000.0, 5.0) };
        let start = turning(&body, 0.9, 0.5);
        let energy_j = |state: &State| state.kinetic_energy_j(&body) + body.mass_kg * 9.81 * state.height_m;
        let with = |contact| second_end(support(&body, contact, Hold::Pulls).follow(&start)).0;
        let before_j = energy_j(&start);
        for contact in [Contact::Rough, Contact::Smooth] {
            assert!((energy_j(&with(contact)) / before_j - 1.0).abs() < 3e-9);
        }
        let lost_j = before_j - energy_j(&with(Contact::Coulomb(0.2)));
        // Less than μ times the greatest force, twice the weight here, over the way of the corner, at most 2
        // m.
        assert!(lost_j > 1.0 && lost_j < 0.2 * 2.0 * body.mass_kg * 9.81 * 2.0, "{lost_j}");
    }

    #[test]
    fn what_balances_stands_and_what_leans_back_turns_over() {
        let body = Body { height_m: 0.8, ..thin_rod(1000.0, 5.0) };
        let rest =
            |angle_rad| support(&body, Contact::Rough, Hold::Pushes).follow(&turning(&body, angle_rad, 0.0));
        assert!(rest(std::f64::consts::FRAC_PI_2 - 0.05).is_none());
        assert!(rest((5.0_f64 / 0.8).atan()).is_none());
        assert!(rest(1.3).is_some_and(|end| !end.strikes));
    }
}
