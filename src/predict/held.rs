//! Motion just before R strikes if L is held on the target whatever the force: the closed forms of \[P\]
//! Table 2 for k = 0.

use super::state::{State, arms_m};
use crate::data::Body;
use crate::numerics::quadrature::simpson;

/// Beginning of the time integral as a share of the path: at rest its integrand is 0/0. Also the ω, rad/s,
/// below which it never ends.
const STILL: f64 = 1e-9;

/// A body that turns about L's corner, stuck or sliding without friction, from the motion just after L's
/// impact.
pub(super) struct HeldBody<'a> {
    pub body: &'a Body,
    pub gravity_m_s2: f64,
    pub slides: bool,
    pub start: State,
}

impl HeldBody<'_> {
    /// Pivoting: (Θ + m (a² + b²)) ω² grows by 2 m g Δz_S   (11); sliding without friction: (Θ + m a²) ω²
    /// does   (12)
    fn spin_rad_s(&self, angle_rad: f64) -> f64 {
        let (m, theta) = (self.body.mass_kg, self.body.inertia_kg_m2);
        let arms = |angle_rad: f64| arms_m(self.body, angle_rad, self.body.cog_m);
        let moment = |(a, b): (f64, f64)| theta + m * (a * a + if self.slides { 0.0 } else { b * b });
        let (before, now) = (arms(self.start.angle_rad), arms(angle_rad));
        let gained = 2.0 * m * self.gravity_m_s2 * (before.1 - now.1);
        let energy = moment(before) * self.start.angular_velocity_rad_s.powi(2) + gained;
        (energy / moment(now)).max(0.0).sqrt()
    }

    /// Motion just before R strikes, with the axis flat; `None` if the cask stands or turns the other way.
    pub fn at_second_end(&self) -> Option<State> {
        let start = &self.start;
        let stands = start.angular_velocity_rad_s < STILL && start.angle_rad > 0.0;
        if start.angular_velocity_rad_s < 0.0 || stands {
            return None;
        }
        let w = self.spin_rad_s(0.0);
        let (a, b) = arms_m(self.body, 0.0, self.body.cog_m);
        Some(State {
            height_m: b,
            angle_rad: 0.0,
            horizontal_velocity_m_s: if self.slides { start.horizontal_velocity_m_s } else { b * w },
            vertical_velocity_m_s: -a * w,
            angular_velocity_rad_s: w,
        })
    }

    /// Time that the motion takes, s. Not finite if R never strikes.
    pub fn time_s(&self) -> f64 {
        self.state_at_share(1.0).1
    }

    /// The inclination φ = φ0 (1 − u²), rad, and its time, s: ∫ dφ/ω, over u so that a start from rest has no
    /// pole.
    pub fn state_at_share(&self, u: f64) -> (f64, f64) {
        let angle_rad = self.start.angle_rad;
        let rate_s = |u: f64| 2.0 * angle_rad * u / self.spin_rad_s(angle_rad * (1.0 - u * u));
        (angle_rad * (1.0 - u * u), if u > STILL { simpson(rate_s, STILL, u, 64) } else { 0.0 })
    }
}
