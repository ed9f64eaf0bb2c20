//! Position and velocity of the corners of a moving body.

use crate::data::{Body, Drop, planar};

/// Plane motion of a body: position and velocity of the centre of gravity, inclination, ω = −φ̇.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct State {
    pub height_m: f64,
    pub angle_rad: f64,
    pub horizontal_velocity_m_s: f64,
    pub vertical_velocity_m_s: f64,
    pub angular_velocity_rad_s: f64,
}

/// A corner of the lower side: its height and its velocity.
pub(super) struct Corner {
    pub height_m: f64,
    pub horizontal_velocity_m_s: f64,
    pub vertical_velocity_m_s: f64,
}

/// Horizontal and vertical distance a, b from a corner at axial distance `along_m` behind S to S, m   (1)
pub(super) fn arms_m(body: &Body, angle_rad: f64, along_m: f64) -> (f64, f64) {
    let (sin, cos) = angle_rad.sin_cos();
    // The cosine of a right angle is 6e-17 in doubles: enough to topple a rod that stands.
    let cos = if cos.abs() < f64::EPSILON { 0.0 } else { cos };
    planar::arms_m((sin, cos), along_m, body.height_m)
}

/// Distance of R behind S along the axis, m: negative, R lies ahead.
pub(super) fn second_end_m(body: &Body) -> f64 {
    body.cog_m - body.length_m
}

/// State of an integration, which its slopes, of the same type, advance.
pub(super) trait Advance {
    /// Advances by `step_s` with these slopes.
    fn step(&self, slope: &Self, step_s: f64) -> Self;
}

/// A step of the fourth-order Runge-Kutta method, `(from_s, step_s)`.
pub(super) fn runge_kutta<S: Advance>(
    at: &S,
    (from_s, step_s): (f64, f64),
    slope: impl Fn(&S, f64) -> S,
) -> S {
    let half_s = step_s * 0.5;
    let one = slope(at, from_s);
    let two = slope(&at.step(&one, half_s), from_s + half_s);
    let three = slope(&at.step(&two, half_s), from_s + half_s);
    let four = slope(&at.step(&three, step_s), from_s + step_s);
    at.step(&one, step_s / 6.0).step(&two, step_s / 3.0).step(&three, step_s / 3.0).step(&four, step_s / 6.0)
}

impl Advance for State {
    fn step(&self, slope: &Self, step_s: f64) -> Self {
        Self {
            height_m: self.height_m + slope.height_m * step_s,
            angle_rad: self.angle_rad + slope.angle_rad * step_s,
            horizontal_velocity_m_s: self.horizontal_velocity_m_s + slope.horizontal_velocity_m_s * step_s,
            vertical_velocity_m_s: self.vertical_velocity_m_s + slope.vertical_velocity_m_s * step_s,
            angular_velocity_rad_s: self.angular_velocity_rad_s + slope.angular_velocity_rad_s * step_s,
        }
    }
}

impl State {
    /// Motion just before L strikes at v0, with L on the target: ż_S = −v0 − ω a   (3)
    pub fn falling(body: &Body, angle_rad: f64, drop: &Drop) -> Self {
        let (a, b) = arms_m(body, angle_rad, body.cog_m);
        Self {
            height_m: b,
            angle_rad,
            horizontal_velocity_m_s: drop.horizontal_velocity_m_s,
            vertical_velocity_m_s: planar::falling_m_s(
                drop.impact_velocity_m_s,
                drop.angular_velocity_rad_s,
                a,
            ),
            angular_velocity_rad_s: drop.angular_velocity_rad_s,
        }
    }

    /// Turns the body about S by `angle_rad`.
    pub fn turn(&self, angle_rad: f64) -> Self {
        Self { angle_rad: self.angle_rad + angle_rad, ..*self }
    }

    /// Horizontal and vertical distance from L's lower corner to S, m   (1)
    pub fn arms_m(&self, body: &Body) -> (f64, f64) {
        arms_m(body, self.angle_rad, body.cog_m)
    }

    /// Ballistic flight for `time_s`: ẋ, ω constant, ż = ż − g τ   (8)
    pub fn after(&self, time_s: f64, gravity_m_s2: f64) -> Self {
        Self {
            height_m: self.height_m + self.vertical_velocity_m_s * time_s
                - time_s * time_s * (gravity_m_s2 / 2.0),
            angle_rad: self.angle_rad - self.angular_velocity_rad_s * time_s,
            vertical_velocity_m_s: self.vertical_velocity_m_s - time_s * gravity_m_s2,
            ..*self
        }
    }

    /// The lower corner at axial distance `along_m` behind S (L: c; R: c − l)   (3)
    pub fn corner(&self, body: &Body, along_m: f64) -> Corner {
        let arms = arms_m(body, self.angle_rad, along_m);
        let cog_m_s = (self.horizontal_velocity_m_s, self.vertical_velocity_m_s);
        let (horizontal_velocity_m_s, vertical_velocity_m_s) =
            planar::corner_m_s(cog_m_s, self.angular_velocity_rad_s, arms);
        Corner { height_m: self.height_m - arms.1, horizontal_velocity_m_s, vertical_velocity_m_s }
    }

    /// Moves L's corner to the depth `sunk_m` to the last digit: a nanometre below it would strike again at
    /// once.
    pub fn with_first_end_at(&self, body: &Body, sunk_m: f64) -> Self {
        Self { height_m: arms_m(body, self.angle_rad, body.cog_m).1 - sunk_m, ..*self }
    }

    /// Kinetic energy, J: m (ẋ² + ż²)/2 + Θ ω²/2   (13)
    pub fn kinetic_energy_j(&self, body: &Body) -> f64 {
        let v2 = self.horizontal_velocity_m_s.powi(2) + self.vertical_velocity_m_s.powi(2);
        (v2 * body.mass_kg + self.angular_velocity_rad_s.powi(2) * body.inertia_kg_m2) * 0.5
    }
}
