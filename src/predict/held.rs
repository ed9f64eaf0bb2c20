//! L held on the target whatever the force to the motion just before R strikes: the closed forms of \[P\] Table 2 for k = 0.

use super::state::{State, arms_m};
use crate::data::Body;
use crate::numerics::quadrature::simpson;

/// Where the time integral begins, share of the way: at rest its integrand is 0/0. Also the ω, rad/s, below which it never ends.
const STILL: f64 = 1e-9;

/// Motion just before R strikes and the time it takes, s; `None` where the axis never lies flat.
///
/// Pivoting: (Θ + m (a² + b²)) ω² grows by 2 m g Δz_S (11); sliding without friction: (Θ + m a²) ω² does (12); time ∫ dφ / ω.
pub(super) fn to_second_end(
    body: &Body,
    gravity_m_s2: f64,
    slides: bool,
    state: &State<f64>,
) -> Option<(State<f64>, f64)> {
    let (m, theta) = (body.mass_kg, body.inertia_kg_m2);
    let moment = |angle_rad: f64| {
        let (a, b) = arms_m(body, angle_rad, body.cog_m);
        theta + m * (a * a + if slides { 0.0 } else { b * b })
    };
    let height_m = |angle_rad: f64| arms_m(body, angle_rad, body.cog_m).1;
    let start = moment(state.angle_rad) * state.angular_velocity_rad_s.powi(2);
    let spin_rad_s = |angle_rad: f64| {
        let gained = 2.0 * m * gravity_m_s2 * (height_m(state.angle_rad) - height_m(angle_rad));
        ((start + gained) / moment(angle_rad)).max(0.0).sqrt()
    };
    let stands = state.angular_velocity_rad_s < STILL && state.angle_rad > 0.0;
    if state.angular_velocity_rad_s < 0.0 || stands {
        return None;
    }
    let w = spin_rad_s(0.0);
    let (a, b) = arms_m(body, 0.0, body.cog_m);
    let flat = State {
        height_m: height_m(0.0),
        angle_rad: 0.0,
        horizontal_velocity_m_s: if slides { state.horizontal_velocity_m_s } else { b * w },
        vertical_velocity_m_s: -a * w,
        angular_velocity_rad_s: w,
    };
    // ∫ dφ/ω with φ = φ0 (1 − u²), so that a start from rest is no pole.
    let rate_s = |u: f64| 2.0 * state.angle_rad * u / spin_rad_s(state.angle_rad * (1.0 - u * u));
    let time_s = simpson(rate_s, STILL, 1.0, 64);
    time_s.is_finite().then_some((flat, time_s))
}
