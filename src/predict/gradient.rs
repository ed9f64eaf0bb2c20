//! A prediction to how its slap-down speed answers to k and to the drop angle.

use super::impact::strike_first_end;
use super::path::Way;
use super::resting::Support;
use super::state::{Number, State, second_end_m};
use crate::data::{Body, Contact, Drop, GRAZE_SHARE, SpeedGradient};
use num_dual::Dual64;

/// Slap-down speed of [`super::predict`] with its derivatives by k and φ0, by forward differentiation of the same code.
///
/// `None` without a slap-down. Where the way changes its kind (L begins to strike again, R stops striking) the speed
/// jumps; the gradient is that of the way taken.
#[must_use]
pub fn speed_gradient(body: &Body, drop: &Drop, contact: Contact, k: f64) -> Option<SpeedGradient> {
    let (angle, restitution) = (Dual64::from_re(drop.angle_rad), Dual64::from_re(k));
    let by_k = speed_m_s(body, drop, contact, angle, restitution.derivative())?;
    let by_angle = speed_m_s(body, drop, contact, angle.derivative(), restitution)?;
    Some(SpeedGradient { speed_m_s: by_k.re, by_k_m_s: by_k.eps, by_angle_m_s_rad: by_angle.eps })
}

fn speed_m_s<T: Number>(body: &Body, drop: &Drop, contact: Contact, angle_rad: T, k: T) -> Option<T> {
    let start = State::falling(body, angle_rad, drop.impact_velocity_m_s);
    let support = Support { body, gravity_m_s2: drop.gravity_m_s2, contact, two_sided: false };
    let way = Way { support, graze_m: Some(GRAZE_SHARE * body.length_m) };
    let (at, _) = way.follow(strike_first_end(body, &start, contact, k).after, k).second_end?;
    let corner = at.corner(body, second_end_m(body));
    Some((corner.horizontal_velocity_m_s.powi(2) + corner.vertical_velocity_m_s.powi(2)).sqrt())
}
