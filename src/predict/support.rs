//! Forces on L at rest on the target, and its rotation and sliding: one step of its motion.

use super::impact::coefficient;
use super::state::{Advance, State, arms_m, runge_kutta};
use crate::data::{Body, Contact, Drop};

/// A corner that slides slower than this, m/s, was stopped by the impact, except for round-off.
const STOPPED_M_S: f64 = 1e-9;

/// Friction of a rough contact while L rests: with more friction the normal force of a sliding corner falls
/// below a millionth of the weight.
const ROUGH: f64 = 1e6;

/// The target under L, and the condition under which it holds L.
#[derive(Clone, Copy)]
pub(super) struct Support<'a> {
    pub body: &'a Body,
    pub gravity_m_s2: f64,
    pub contact: Contact,
    pub hold: Hold,
    /// Depth of L's corner below the target plane after the first impact has crushed it, m.
    pub sunk_m: f64,
}

/// Condition under which the target releases L.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Hold {
    /// Never: the target pulls as well as it pushes, as in \[P\] Table 2.
    Pulls,
    /// The target cannot pull: L leaves if holding it, stuck or sliding, would need a pull   (10)
    Pushes,
    /// L leaves if it would rise by itself, g < b ω². A stuck corner that only a pull would hold slides
    /// before that.
    Yields,
}

/// Inclination, ω and the sliding velocity of L's corner.
#[derive(Clone, Copy)]
pub(super) struct Turning {
    pub angle_rad: f64,
    pub angular_velocity_rad_s: f64,
    pub slip_m_s: f64,
}

/// Contact state of the corner on the target.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Grip {
    Sticks,
    /// Slides one way, ±1, with this T/N.
    Slides {
        way: f64,
        ratio: f64,
    },
    /// Friction presses the corner on without bound (Painlevé): it stops at once.
    Jams,
}

/// Forces of the target and the resulting accelerations.
#[allow(clippy::struct_field_names, reason = "the fields end in their units")]
pub(super) struct Forces {
    /// N/m, m/s².
    pub normal_m_s2: f64,
    /// ω̇, rad/s².
    pub angular_acceleration_rad_s2: f64,
    /// ẍ_C, m/s².
    pub slip_rate_m_s2: f64,
    /// Friction that keeps the corner from sliding, T/m = b ω̇ − a ω², m/s².
    held_m_s2: f64,
}

impl<'a> Support<'a> {
    pub fn new(body: &'a Body, drop: &Drop, contact: Contact, hold: Hold) -> Self {
        Self { body, gravity_m_s2: drop.gravity_m_s2, contact, hold, sunk_m: 0.0 }
    }

    /// Forces for z̈_C = 0: N/m = g − a ω̇ − b ω²   (10); stuck, ẍ_C = 0: ω̇ = a g/(r² + a² + b²); sliding, T
    /// = r_T N: ω̇ = (a − r_T b)(g − b ω²)/(r² + a (a − r_T b)), ẍ_C = r_T N/m − b ω̇ + a ω².
    pub fn forces(&self, at: &Turning, grip: Grip) -> Forces {
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
            Grip::Sticks | Grip::Jams => 0.0,
        };
        Forces {
            normal_m_s2,
            angular_acceleration_rad_s2: spin,
            slip_rate_m_s2,
            held_m_s2: b * spin - a * w2,
        }
    }

    fn friction(&self) -> f64 {
        coefficient(self.contact).min(ROUGH)
    }

    /// Friction that remains available beside that which holds a stuck corner, m/s².
    fn spare_friction_m_s2(&self, stuck: &Forces) -> f64 {
        let normal = match self.hold {
            Hold::Pulls => stuck.normal_m_s2.abs(),
            Hold::Pushes | Hold::Yields => stuck.normal_m_s2,
        };
        // A rough corner sticks as long as it is held at all.
        match (self.contact, self.hold) {
            (Contact::Rough, Hold::Pulls | Hold::Pushes) => f64::INFINITY,
            (Contact::Rough, Hold::Yields) => normal,
            _ => self.friction() * normal - stuck.held_m_s2.abs(),
        }
    }

    /// Contact state, with the direction of sliding if it slides, and the forces that then act.
    pub fn find_grip(&self, at: &Turning) -> (Grip, Forces) {
        let slides = |grip| (grip, self.forces(at, grip));
        let arms_m = || arms_m(self.body, at.angle_rad, self.body.cog_m);
        if at.slip_m_s == 0.0 {
            let stuck = self.forces(at, Grip::Sticks);
            let lets_go = self.hold == Hold::Pushes && stuck.normal_m_s2 <= 0.0;
            if self.spare_friction_m_s2(&stuck) >= 0.0 || lets_go {
                return (Grip::Sticks, stuck);
            }
            let way = -stuck.held_m_s2.signum();
            return slides(Grip::Slides { way, ratio: self.ratio(at, arms_m().1, way) });
        }
        let (way, (a, b)) = (at.slip_m_s.signum(), arms_m());
        let ratio = self.ratio(at, b, way);
        let r2 = self.body.inertia_kg_m2 / self.body.mass_kg;
        slides(if r2 + a * (a - ratio * b) <= 1e-9 * r2 { Grip::Jams } else { Grip::Slides { way, ratio } })
    }

    /// T/N of a corner `b` below S that slides in direction `way`; a target that pulls changes its sign. N
    /// has the sign of g − b ω².
    fn ratio(&self, at: &Turning, b: f64, way: f64) -> f64 {
        let pushes = self.gravity_m_s2 - b * at.angular_velocity_rad_s.powi(2);
        -self.friction() * way * if self.hold == Hold::Pulls { pushes.signum() } else { 1.0 }
    }

    /// The motion of the body with L's corner on the target   (3)
    pub fn state(&self, at: &Turning) -> State {
        let (a, b) = arms_m(self.body, at.angle_rad, self.body.cog_m);
        State {
            height_m: b - self.sunk_m,
            angle_rad: at.angle_rad,
            horizontal_velocity_m_s: at.slip_m_s + b * at.angular_velocity_rad_s,
            vertical_velocity_m_s: -a * at.angular_velocity_rad_s,
            angular_velocity_rad_s: at.angular_velocity_rad_s,
        }
    }

    /// The motion a step later.
    pub fn step(&self, at: &Turning, grip: Grip, step_s: f64) -> Turning {
        runge_kutta(at, (0.0, step_s), |at, _| {
            let forces = self.forces(at, grip);
            Turning {
                angle_rad: -at.angular_velocity_rad_s,
                angular_velocity_rad_s: forces.angular_acceleration_rad_s2,
                slip_m_s: forces.slip_rate_m_s2,
            }
        })
    }

    /// The inclination at which R strikes while L rests, rad: L's corner is l sin φ deep.
    pub fn down_rad(&self) -> f64 {
        (self.sunk_m / self.body.length_m).clamp(-1.0, 1.0).asin()
    }

    /// Margins of a stretch in one contact state: each is positive until the stretch ends.
    pub fn margins(&self, at: &Turning, grip: Grip) -> [f64; 3] {
        let forces = self.forces(at, grip);
        let lift = if self.hold == Hold::Pulls { 1.0 } else { forces.normal_m_s2 };
        let hold = match grip {
            // A corner that starts to slide from rest has not used any margin yet.
            Grip::Slides { way, ratio } if ratio != 0.0 => way * at.slip_m_s,
            Grip::Slides { .. } => 1.0,
            Grip::Sticks | Grip::Jams => self.spare_friction_m_s2(&forces),
        };
        [at.angle_rad - self.down_rad(), lift, hold]
    }
}

impl Advance for Turning {
    fn step(&self, slope: &Self, step_s: f64) -> Self {
        Self {
            angle_rad: self.angle_rad + slope.angle_rad * step_s,
            angular_velocity_rad_s: self.angular_velocity_rad_s + slope.angular_velocity_rad_s * step_s,
            slip_m_s: self.slip_m_s + slope.slip_m_s * step_s,
        }
    }
}

impl Turning {
    pub fn from_state(body: &Body, state: &State) -> Self {
        let slip_m_s = state.corner(body, body.cog_m).horizontal_velocity_m_s;
        Self {
            angle_rad: state.angle_rad,
            angular_velocity_rad_s: state.angular_velocity_rad_s,
            slip_m_s: if slip_m_s.abs() < STOPPED_M_S { 0.0 } else { slip_m_s },
        }
    }
}
