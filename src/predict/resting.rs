//! L on the target to where R strikes or L lifts off: pivoting, or sliding against friction.

use super::impact::{coefficient, strike_first_end};
use super::state::{Number, State, arms_m};
use crate::data::{Body, Contact};

/// Turn within one step of the integration, rad: Runge's and Kutta's fourth order leaves 1e-10 of the speed.
const STEP_RAD: f64 = 0.01;
/// Longest step, s: a body that begins to turn from rest needs a tenth of a second for its first degrees.
const STEP_S: f64 = 2e-3;
/// Shortest step, s: on the border between sticking and sliding round-off would otherwise stop the clock; a µm/s of sliding.
const LEAST_STEP_S: f64 = 1e-6;
/// A body that has not come down in this time stands, s: tens of times what it takes to topple from 1° beside the balance.
const LONGEST_S: f64 = 30.0;

/// Turning slower than this, rad/s and rad/s², is round-off: the body stands.
const STILL: f64 = 1e-9;
/// A corner that slides slower than this, m/s, was stopped by the impact but for round-off.
const STOPPED_M_S: f64 = 1e-9;

/// Rough contact while L rests: with more friction the normal force of a sliding corner falls below a millionth of the weight.
const ROUGH: f64 = 1e6;

/// The target L rests on, and what holds it there.
#[derive(Clone, Copy)]
pub(super) struct Support<'a> {
    pub body: &'a Body,
    pub gravity_m_s2: f64,
    pub contact: Contact,
    pub hold: Hold,
}

/// When the target lets go of L.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Hold {
    /// Never: it pulls as well as it pushes, as in [P] Table 2.
    Pulls,
    /// Where holding L as it moves, stuck or sliding, would need a pull   (10)
    Pushes,
    /// Where L would rise by itself, g < b ω². A stuck corner that only a pull would hold slides before that.
    Yields,
}

/// How a rest of L on the target ends.
pub(super) enum End<T> {
    /// R strikes: the motion then, and the time since the start, s.
    SecondEnd(State<T>, T),
    /// L lifts off.
    LiftsOff(State<T>, T),
    /// The body stands, or turns over the other way.
    Never,
}

/// Inclination, ω and the sliding velocity of L's corner.
#[derive(Clone, Copy)]
struct Turning<T> {
    angle_rad: T,
    angular_velocity_rad_s: T,
    slip_m_s: T,
}

/// How the corner meets the target.
#[derive(Clone, Copy, PartialEq)]
enum Grip {
    Sticks,
    /// Slides one way, ±1, with this T/N.
    Slides {
        way: f64,
        ratio: f64,
    },
    /// The friction presses the corner on without bound (Painlevé): it stops at once.
    Jams,
}

/// What is used up when a stretch with one grip ends.
enum Margin {
    /// The inclination: R strikes.
    Angle,
    /// The push of the target.
    Lift,
    /// The sliding, or the friction that holds.
    Hold,
}

/// What the target does and what follows.
struct Forces<T> {
    /// N/m, m/s².
    normal_m_s2: T,
    /// ω̇, rad/s².
    angular_acceleration_rad_s2: T,
    /// ẍ_C, m/s².
    slip_rate_m_s2: T,
}

impl Support<'_> {
    /// With z̈_C = 0: N/m = g − a ω̇ − b ω²   (10); stuck, ẍ_C = 0: ω̇ = a g/(r² + a² + b²); sliding, T = r_T N:
    /// ω̇ = (a − r_T b)(g − b ω²)/(r² + a (a − r_T b)), ẍ_C = r_T N/m − b ω̇ + a ω².
    fn forces<T: Number>(&self, at: &Turning<T>, grip: Grip) -> Forces<T> {
        let (a, b) = arms_m(self.body, at.angle_rad, self.body.cog_m);
        let r2 = self.body.inertia_kg_m2 / self.body.mass_kg;
        let w2 = at.angular_velocity_rad_s.powi(2);
        let spin = match grip {
            Grip::Slides { ratio, .. } => {
                let arm = a - b * ratio;
                -arm * (b * w2 - self.gravity_m_s2) / (a * arm + r2)
            }
            Grip::Sticks | Grip::Jams => a * self.gravity_m_s2 / (a * a + b * b + r2),
        };
        let normal_m_s2 = -(a * spin + b * w2) + self.gravity_m_s2;
        let slip_rate_m_s2 = match grip {
            Grip::Slides { ratio, .. } => normal_m_s2 * ratio - b * spin + a * w2,
            Grip::Sticks | Grip::Jams => T::from(0.0),
        };
        Forces { normal_m_s2, angular_acceleration_rad_s2: spin, slip_rate_m_s2 }
    }

    fn friction(&self) -> f64 {
        coefficient(self.contact).min(ROUGH)
    }

    /// The friction that holds a stuck corner, T/m = b ω̇ − a ω², and how much of it N leaves over, m/s².
    fn held_m_s2(&self, at: &Turning<f64>) -> (f64, f64) {
        let (a, b) = arms_m(self.body, at.angle_rad, self.body.cog_m);
        let stuck = self.forces(at, Grip::Sticks);
        let held = b * stuck.angular_acceleration_rad_s2 - a * at.angular_velocity_rad_s.powi(2);
        let normal = match self.hold {
            Hold::Pulls => stuck.normal_m_s2.abs(),
            Hold::Pushes | Hold::Yields => stuck.normal_m_s2,
        };
        // Rough sticks as long as it is held at all.
        let left = match (self.contact, self.hold) {
            (Contact::Rough, Hold::Pulls | Hold::Pushes) => f64::INFINITY,
            (Contact::Rough, Hold::Yields) => normal,
            _ => self.friction() * normal - held.abs(),
        };
        (held, left)
    }

    /// Whether the corner sticks, and against what it slides if not.
    fn grip<T: Number>(&self, at: &Turning<T>) -> Grip {
        let (a, b) = arms_m(self.body, at.angle_rad.re(), self.body.cog_m);
        let real = at.real();
        if real.slip_m_s == 0.0 {
            let (held_m_s2, left_m_s2) = self.held_m_s2(&real);
            let lets_go = self.hold == Hold::Pushes && self.forces(&real, Grip::Sticks).normal_m_s2 <= 0.0;
            if left_m_s2 >= 0.0 || lets_go {
                return Grip::Sticks;
            }
            let way = -held_m_s2.signum();
            return Grip::Slides { way, ratio: self.ratio(&real, way) };
        }
        let way = real.slip_m_s.signum();
        let ratio = self.ratio(&real, way);
        let r2 = self.body.inertia_kg_m2 / self.body.mass_kg;
        if r2 + a * (a - ratio * b) <= 1e-9 * r2 { Grip::Jams } else { Grip::Slides { way, ratio } }
    }

    /// T/N of a corner that slides `way`; a target that pulls turns its sign. N has the sign of g − b ω².
    fn ratio(&self, at: &Turning<f64>, way: f64) -> f64 {
        let (_, b) = arms_m(self.body, at.angle_rad, self.body.cog_m);
        let pushes = self.gravity_m_s2 - b * at.angular_velocity_rad_s.powi(2);
        -self.friction() * way * if self.hold == Hold::Pulls { pushes.signum() } else { 1.0 }
    }

    /// The motion of the body with L's corner on the target   (3)
    fn state<T: Number>(&self, at: &Turning<T>) -> State<T> {
        let (a, b) = arms_m(self.body, at.angle_rad, self.body.cog_m);
        State {
            height_m: b,
            angle_rad: at.angle_rad,
            horizontal_velocity_m_s: at.slip_m_s + b * at.angular_velocity_rad_s,
            vertical_velocity_m_s: -a * at.angular_velocity_rad_s,
            angular_velocity_rad_s: at.angular_velocity_rad_s,
        }
    }

    /// A step of Runge's and Kutta's fourth order.
    fn step<T: Number>(&self, at: &Turning<T>, grip: Grip, step_s: T) -> Turning<T> {
        let slope = |at: &Turning<T>| {
            let forces = self.forces(at, grip);
            Turning {
                angle_rad: -at.angular_velocity_rad_s,
                angular_velocity_rad_s: forces.angular_acceleration_rad_s2,
                slip_m_s: forces.slip_rate_m_s2,
            }
        };
        let one = slope(at);
        let two = slope(&at.plus(&one, step_s * 0.5));
        let three = slope(&at.plus(&two, step_s * 0.5));
        let four = slope(&at.plus(&three, step_s));
        at.plus(&one, step_s / 6.0)
            .plus(&two, step_s / 3.0)
            .plus(&three, step_s / 3.0)
            .plus(&four, step_s / 6.0)
    }

    /// What ends a stretch with one `grip`: each is positive until then.
    fn margins(&self, at: &Turning<f64>, grip: Grip) -> [f64; 3] {
        let forces = self.forces(at, grip);
        let lift = if self.hold == Hold::Pulls { 1.0 } else { forces.normal_m_s2 };
        let hold = match grip {
            // A corner that slides from rest has used up nothing yet.
            Grip::Slides { way, ratio } if ratio != 0.0 => way * at.slip_m_s,
            Grip::Slides { .. } => 1.0,
            Grip::Sticks | Grip::Jams => self.held_m_s2(at).1,
        };
        [at.angle_rad, lift, hold]
    }
}

impl<T: Number> Turning<T> {
    fn of(body: &Body, state: &State<T>) -> Self {
        let slip_m_s = state.corner(body, body.cog_m).horizontal_velocity_m_s;
        Self {
            angle_rad: state.angle_rad,
            angular_velocity_rad_s: state.angular_velocity_rad_s,
            slip_m_s: if slip_m_s.re().abs() < STOPPED_M_S { T::from(0.0) } else { slip_m_s },
        }
    }

    fn real(&self) -> Turning<f64> {
        Turning {
            angle_rad: self.angle_rad.re(),
            angular_velocity_rad_s: self.angular_velocity_rad_s.re(),
            slip_m_s: self.slip_m_s.re(),
        }
    }

    fn plus(&self, slope: &Self, step_s: T) -> Self {
        Self {
            angle_rad: self.angle_rad + slope.angle_rad * step_s,
            angular_velocity_rad_s: self.angular_velocity_rad_s + slope.angular_velocity_rad_s * step_s,
            slip_m_s: self.slip_m_s + slope.slip_m_s * step_s,
        }
    }
}

impl Support<'_> {
    /// Follows L's rest on the target to its end.
    pub fn rest<T: Number>(&self, from: &State<T>) -> End<T> {
        let mut elapsed_s = T::from(0.0);
        if from.angle_rad.re() <= 0.0 {
            return End::SecondEnd(*from, elapsed_s);
        }
        let mut at = Turning::of(self.body, from);
        while elapsed_s.re() < LONGEST_S && at.angle_rad.re() < std::f64::consts::FRAC_PI_2 {
            let grip = self.grip(&at);
            if grip == Grip::Jams {
                let struck = strike_first_end(self.body, &self.state(&at), self.contact, T::from(0.0));
                at = Turning::of(self.body, &struck.after);
                continue;
            }
            let forces = self.forces(&at.real(), grip);
            if self.hold != Hold::Pulls && forces.normal_m_s2 <= 0.0 {
                // What lifts off at once moves as the impact left it.
                let lifted = if elapsed_s.re() == 0.0 { *from } else { self.state(&at) };
                return End::LiftsOff(lifted, elapsed_s);
            }
            let turning_rad_s = at.angular_velocity_rad_s.re().abs();
            if turning_rad_s < STILL && forces.angular_acceleration_rad_s2.abs() < STILL {
                return End::Never;
            }
            let step_s = (STEP_RAD / turning_rad_s).min(STEP_S);
            let next = self.step(&at.real(), grip, step_s);
            if self.margins(&next, grip).iter().all(|margin| *margin > 0.0) {
                at = self.step(&at, grip, T::from(step_s));
                elapsed_s += step_s;
                continue;
            }
            let (taken_s, ended) = self.to_the_end_of(&at, grip, step_s);
            at = self.step(&at, grip, taken_s);
            elapsed_s += taken_s;
            match ended {
                Margin::Angle => return End::SecondEnd(self.state(&at), elapsed_s),
                Margin::Lift => return End::LiftsOff(self.state(&at), elapsed_s),
                Margin::Hold if grip != Grip::Sticks => at.slip_m_s = T::from(0.0),
                Margin::Hold => {}
            }
        }
        End::Never
    }

    /// The time within a step of `step_s` at which the first margin is used up, and which one.
    fn to_the_end_of<T: Number>(&self, at: &Turning<T>, grip: Grip, step_s: f64) -> (T, Margin) {
        let real = at.real();
        let (mut low_s, mut high_s) = (0.0, step_s);
        // 2^-50 of a step is below the spacing of doubles in the time since the start.
        for _ in 0..50 {
            let mid_s = f64::midpoint(low_s, high_s);
            let margins = self.margins(&self.step(&real, grip, mid_s), grip);
            if margins.iter().all(|margin| *margin > 0.0) { low_s = mid_s } else { high_s = mid_s }
        }
        let there = self.step(at, grip, T::from(high_s));
        let margins = self.margins(&there.real(), grip);
        // How the time answers to the start: only where the forces jump does that matter.
        if margins[0] <= 0.0 {
            (there.angle_rad / there.angular_velocity_rad_s + high_s, Margin::Angle)
        } else if margins[1] <= 0.0 && (self.hold == Hold::Pushes || grip != Grip::Sticks) {
            (T::from(high_s), Margin::Lift)
        } else if grip == Grip::Sticks || high_s < LEAST_STEP_S {
            (T::from(high_s.max(LEAST_STEP_S)), Margin::Hold)
        } else {
            let rate_m_s2 = self.forces(&there, grip).slip_rate_m_s2;
            (-there.slip_m_s / rate_m_s2 + high_s, Margin::Hold)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{held, thin_rod};
    use super::*;
    use crate::data::BodyModel;

    fn support(body: &Body, contact: Contact, hold: Hold) -> Support<'_> {
        Support { body, gravity_m_s2: 9.81, contact, hold }
    }

    fn turning(body: &Body, angle_rad: f64, angular_velocity_rad_s: f64) -> State<f64> {
        support(body, Contact::Rough, Hold::Pushes).state(&Turning {
            angle_rad,
            angular_velocity_rad_s,
            slip_m_s: 0.0,
        })
    }

    fn second_end(end: End<f64>) -> (State<f64>, f64) {
        match end {
            End::SecondEnd(state, time_s) => (state, time_s),
            End::LiftsOff(..) => panic!("L lifts off"),
            End::Never => panic!("R never strikes"),
        }
    }

    #[test]
    fn held_on_both_sides_it_is_the_closed_form() {
        let body = Body { model: BodyModel::Body, height_m: 0.8, cog_m: 2.4, ..thin_rod(4466.0, 5.5) };
        for (contact, slides) in [(Contact::Coulomb(0.0), true), (Contact::Rough, false)] {
            for (angle_rad, w) in [(0.1, 4.0), (0.5, 2.0), (1.0, 0.3)] {
                let start = turning(&body, angle_rad, w);
                let support = support(&body, contact, Hold::Pulls);
                let (state, time_s) = second_end(support.rest(&start));
                let (closed, closed_s) = held::to_second_end(&body, 9.81, slides, &start).expect("R strikes");
                // Fourth order with 0.01 rad a step: 1e-10; Simpson with 64 steps: 1e-7 of the time.
                let ratio = state.angular_velocity_rad_s / closed.angular_velocity_rad_s;
                assert!((ratio - 1.0).abs() < 1e-9, "{contact} {angle_rad}: {ratio}");
                assert!((time_s / closed_s - 1.0).abs() < 1e-6, "{contact} {angle_rad}: {time_s} {closed_s}");
            }
        }
    }

    #[test]
    fn a_pivot_lifts_off_where_the_rods_force_changes_sign() {
        let rod = thin_rod(1000.0, 5.0);
        let End::LiftsOff(at, time_s) =
            support(&rod, Contact::Rough, Hold::Pushes).rest(&turning(&rod, 1.3, 1.0))
        else {
            panic!("it stays");
        };
        assert!(time_s > 0.0);
        // physics: N/m = g (1 − ¾ cos² φ) − (l/2) ω² sin φ for the rough rod.
        let (sin, cos) = at.angle_rad.sin_cos();
        let normal_m_s2 = 9.81 * (1.0 - 0.75 * cos * cos) - 2.5 * at.angular_velocity_rad_s.powi(2) * sin;
        assert!(normal_m_s2.abs() < 1e-8, "{normal_m_s2}");
    }

    #[test]
    fn friction_takes_what_the_sliding_costs() {
        let body = Body { height_m: 0.6, ..thin_rod(1000.0, 5.0) };
        let start = turning(&body, 0.9, 0.5);
        let energy_j =
            |state: &State<f64>| state.kinetic_energy_j(&body) + body.mass_kg * 9.81 * state.height_m;
        let with = |contact| second_end(support(&body, contact, Hold::Pulls).rest(&start)).0;
        let before_j = energy_j(&start);
        for contact in [Contact::Rough, Contact::Smooth] {
            assert!((energy_j(&with(contact)) / before_j - 1.0).abs() < 1e-9);
        }
        let lost_j = before_j - energy_j(&with(Contact::Coulomb(0.2)));
        // Less than μ times the greatest force, twice the weight here, over the way of the corner, at most 2 m.
        assert!(lost_j > 1.0 && lost_j < 0.2 * 2.0 * body.mass_kg * 9.81 * 2.0, "{lost_j}");
    }

    #[test]
    fn what_balances_stands_and_what_leans_back_turns_over() {
        let body = Body { height_m: 0.8, ..thin_rod(1000.0, 5.0) };
        let rest =
            |angle_rad| support(&body, Contact::Rough, Hold::Pushes).rest(&turning(&body, angle_rad, 0.0));
        assert!(matches!(rest(std::f64::consts::FRAC_PI_2 - 0.05), End::Never));
        assert!(matches!(rest((5.0_f64 / 0.8).atan()), End::Never));
        assert!(matches!(rest(1.3), End::LiftsOff(..)));
    }
}
