//! Follows the motion after an impact to the time at which a corner comes down to the target.

use super::state::{State, second_end_m};
use super::support::Support;
use crate::data::Body;
use crate::numerics::root::first_root;

/// Heights below this at the start of a flight are the contact itself, m.
const TOUCH_M: f64 = 1e-9;

/// First time after now at which the lower corner `along_m` behind S comes down to `depth_m` below the
/// target, at most `last_s`.
///
/// z(τ) = z_S + ż_S τ − g τ²/2 − b(φ − ω τ), |z̈| ≤ g + ω² ρ   (8)
fn next_touch(
    body: &Body,
    gravity_m_s2: f64,
    state: &State,
    (along_m, depth_m): (f64, f64),
    last_s: f64,
) -> Option<f64> {
    let reach_m = along_m.hypot(body.height_m / 2.0);
    let bound_m_s2 = gravity_m_s2 + state.angular_velocity_rad_s.powi(2) * reach_m;
    let time_s = first_root(
        |t| {
            let corner = state.after(t, gravity_m_s2).corner(body, along_m);
            (corner.height_m + depth_m, corner.vertical_velocity_m_s)
        },
        bound_m_s2,
        last_s,
        TOUCH_M,
    )?;
    // One step of Newton's method from there gives the last digits.
    let corner = state.after(time_s, gravity_m_s2).corner(body, along_m);
    let steep = corner.vertical_velocity_m_s < -(2.0 * bound_m_s2 * TOUCH_M).sqrt();
    Some(if steep { time_s - (corner.height_m + depth_m) / corner.vertical_velocity_m_s } else { time_s })
}

/// Time at which R's corner first comes down.
pub(super) fn second_end_touches(body: &Body, gravity_m_s2: f64, state: &State) -> Option<f64> {
    let along_m = second_end_m(body);
    next_touch(body, gravity_m_s2, state, (along_m, 0.0), longest_s(body, gravity_m_s2, state, along_m))
}

/// Time at which L's corner returns to the height at which it left the target, at most that of R's impact.
pub(super) fn first_end_touches(support: &Support, state: &State, second_end_s: Option<f64>) -> Option<f64> {
    let Support { body, gravity_m_s2, sunk_m, .. } = *support;
    let last_s = second_end_s.unwrap_or_else(|| longest_s(body, gravity_m_s2, state, body.cog_m));
    next_touch(body, gravity_m_s2, state, (body.cog_m, sunk_m), last_s)
}

/// Time from which S itself lies deeper than the corner can reach up, s.
fn longest_s(body: &Body, gravity_m_s2: f64, state: &State, along_m: f64) -> f64 {
    let reach_m = along_m.hypot(body.height_m / 2.0);
    let rise_m_s = state.vertical_velocity_m_s;
    let height_m = state.height_m.abs() + reach_m;
    (rise_m_s + (rise_m_s * rise_m_s + 2.0 * gravity_m_s2 * height_m).sqrt()) / gravity_m_s2
}

/// True if L, back at the height at which it left the target at the start of `span_s`, sinks deeper than
/// `graze_m` before its end.
pub(super) fn sinks(support: &Support, state: &State, span_s: std::ops::Range<f64>, graze_m: f64) -> bool {
    const POINTS: u32 = 32;
    let Support { body, gravity_m_s2, sunk_m, .. } = *support;
    graze_m <= 0.0
        || (1..=POINTS).any(|i| {
            let t = span_s.start + (span_s.end - span_s.start) * f64::from(i) / f64::from(POINTS);
            state.after(t, gravity_m_s2).corner(body, body.cog_m).height_m < -sunk_m - graze_m
        })
}
