//! A moving body to the position and velocity of its corners.

use crate::data::{Body, Drop};
use num_dual::DualNum;

/// A number, or one with its derivative: the same code gives the prediction and its gradient.
pub(super) trait Differentiable: DualNum<Primitive = f64> + Copy {}

impl<T: DualNum<Primitive = f64> + Copy> Differentiable for T {}

/// Plane motion of a body: position and velocity of the centre of gravity, inclination, ω = −φ̇.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct State<T> {
    pub height_m: T,
    pub angle_rad: T,
    pub horizontal_velocity_m_s: T,
    pub vertical_velocity_m_s: T,
    pub angular_velocity_rad_s: T,
}

/// A corner of the lower side: its height and its velocity.
pub(super) struct Corner<T> {
    pub height_m: T,
    pub horizontal_velocity_m_s: T,
    pub vertical_velocity_m_s: T,
}

/// Horizontal and vertical distance a, b from a corner at axial distance `along_m` behind S to S, m.
///
/// a = c cos φ − (h/2) sin φ, b = c sin φ + (h/2) cos φ   (1)
pub(super) fn arms_m<T: Differentiable>(body: &Body, angle_rad: T, along_m: f64) -> (T, T) {
    let (sin, cos) = angle_rad.sin_cos();
    // The cosine of a right angle is 6e-17 in doubles: enough to topple a rod that stands.
    let cos = if cos.re().abs() < f64::EPSILON { cos - cos.re() } else { cos };
    let half_m = body.height_m / 2.0;
    (cos * along_m - sin * half_m, sin * along_m + cos * half_m)
}

/// Distance of R behind S along the axis, m: negative, R lies ahead.
pub(super) fn second_end_m(body: &Body) -> f64 {
    body.cog_m - body.length_m
}

/// What an integration moves by its slopes, themselves of the same shape.
pub(super) trait Advance<T> {
    /// It after `step_s` with these slopes.
    fn plus(&self, slope: &Self, step_s: T) -> Self;
}

/// A step of Runge's and Kutta's fourth order, `(from_s, step_s)`.
pub(super) fn runge_kutta<S: Advance<T>, T: Differentiable>(
    at: &S,
    (from_s, step_s): (T, T),
    slope: impl Fn(&S, T) -> S,
) -> S {
    let half_s = step_s * 0.5;
    let one = slope(at, from_s);
    let two = slope(&at.plus(&one, half_s), from_s + half_s);
    let three = slope(&at.plus(&two, half_s), from_s + half_s);
    let four = slope(&at.plus(&three, step_s), from_s + step_s);
    at.plus(&one, step_s / 6.0).plus(&two, step_s / 3.0).plus(&three, step_s / 3.0).plus(&four, step_s / 6.0)
}

impl<T: Differentiable> Advance<T> for State<T> {
    fn plus(&self, slope: &Self, step_s: T) -> Self {
        Self {
            height_m: self.height_m + slope.height_m * step_s,
            angle_rad: self.angle_rad + slope.angle_rad * step_s,
            horizontal_velocity_m_s: self.horizontal_velocity_m_s + slope.horizontal_velocity_m_s * step_s,
            vertical_velocity_m_s: self.vertical_velocity_m_s + slope.vertical_velocity_m_s * step_s,
            angular_velocity_rad_s: self.angular_velocity_rad_s + slope.angular_velocity_rad_s * step_s,
        }
    }
}

impl<T: Differentiable> State<T> {
    /// Just before L strikes at v0, L on the target: ż_S = −v0 − ω a   (3)
    pub fn falling(body: &Body, angle_rad: T, drop: &Drop) -> Self {
        let (a, b) = arms_m(body, angle_rad, body.cog_m);
        Self {
            height_m: b,
            angle_rad,
            horizontal_velocity_m_s: T::from(drop.horizontal_velocity_m_s),
            vertical_velocity_m_s: a * -drop.angular_velocity_rad_s - drop.impact_velocity_m_s,
            angular_velocity_rad_s: T::from(drop.angular_velocity_rad_s),
        }
    }

    /// The same motion after a turn about S by `angle_rad`.
    pub fn turned(&self, angle_rad: f64) -> Self {
        Self { angle_rad: self.angle_rad + angle_rad, ..*self }
    }

    /// Horizontal and vertical distance from L's lower corner to S, m   (1)
    pub fn arms_m(&self, body: &Body) -> (T, T) {
        arms_m(body, self.angle_rad, body.cog_m)
    }

    /// The motion without its derivatives.
    pub fn real(&self) -> State<f64> {
        State {
            height_m: self.height_m.re(),
            angle_rad: self.angle_rad.re(),
            horizontal_velocity_m_s: self.horizontal_velocity_m_s.re(),
            vertical_velocity_m_s: self.vertical_velocity_m_s.re(),
            angular_velocity_rad_s: self.angular_velocity_rad_s.re(),
        }
    }

    /// Ballistic flight for `time_s`: ẋ, ω constant, ż = ż − g τ   (8)
    pub fn after(&self, time_s: T, gravity_m_s2: f64) -> Self {
        Self {
            height_m: self.height_m + self.vertical_velocity_m_s * time_s
                - time_s * time_s * (gravity_m_s2 / 2.0),
            angle_rad: self.angle_rad - self.angular_velocity_rad_s * time_s,
            vertical_velocity_m_s: self.vertical_velocity_m_s - time_s * gravity_m_s2,
            ..*self
        }
    }

    /// The lower corner at axial distance `along_m` behind S (L: c; R: c − l).
    ///
    /// z_C = z_S − b, ẋ_C = ẋ_S − b ω, ż_C = ż_S + a ω   (3)
    pub fn corner(&self, body: &Body, along_m: f64) -> Corner<T> {
        let (a, b) = arms_m(body, self.angle_rad, along_m);
        Corner {
            height_m: self.height_m - b,
            horizontal_velocity_m_s: self.horizontal_velocity_m_s - b * self.angular_velocity_rad_s,
            vertical_velocity_m_s: self.vertical_velocity_m_s + a * self.angular_velocity_rad_s,
        }
    }

    /// The same motion with L's corner at the depth `sunk_m` to the last digit: a nanometre below it would strike again at once.
    pub fn with_first_end_at(&self, body: &Body, sunk_m: f64) -> Self {
        Self { height_m: arms_m(body, self.angle_rad, body.cog_m).1 - sunk_m, ..*self }
    }

    /// Kinetic energy, J: m (ẋ² + ż²)/2 + Θ ω²/2   (13)
    pub fn kinetic_energy_j(&self, body: &Body) -> T {
        let v2 = self.horizontal_velocity_m_s.powi(2) + self.vertical_velocity_m_s.powi(2);
        (v2 * body.mass_kg + self.angular_velocity_rad_s.powi(2) * body.inertia_kg_m2) * 0.5
    }
}
