//! The changes of contact of a simulated drop to what a perfect measurement would say of it.

use super::body::{CASK_STATE, CornerMotion};
use super::contact::CornerPassage;
use crate::lab::data::{Scene, Truth};

/// A change of a contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactChange {
    /// Touch or leave; `None` within a contact.
    pub(super) passage: Option<CornerPassage>,
    /// 0 is L, 1 is R.
    pub(super) end: usize,
    /// After first contact, s.
    pub(super) time_s: f64,
    /// The state there.
    pub(super) state: [f64; CASK_STATE],
    /// The motion of that end's corner.
    pub(super) corner: CornerMotion,
}

/// Reads the truth off the events, which are in order; without any, only what the scene itself says.
pub(super) fn truth(scene: &Scene, events: &[ContactChange]) -> Truth {
    let is =
        |e: &&ContactChange, end: usize, passage: CornerPassage| e.end == end && e.passage == Some(passage);
    let leave = events.iter().find(|e| is(e, 0, CornerPassage::Leave));
    let strike = events.iter().find(|e| is(e, 1, CornerPassage::Touch));
    let before = |e: &&ContactChange| strike.is_some_and(|s| e.time_s < s.time_s);
    let left_before = leave.filter(before).zip(strike);
    let touches = events.iter().filter(|e| before(e) && is(e, 0, CornerPassage::Touch)).count();
    let leaves = events.iter().filter(|e| before(e) && is(e, 0, CornerPassage::Leave)).count();
    let (v0, cask) = (scene.drop.impact_velocity_m_s, &scene.cask);
    let kinetic_j = |y: &[f64; CASK_STATE]| {
        0.5 * (cask.mass_kg * (y[3] * y[3] + y[4] * y[4]) + cask.inertia_kg_m2 * y[5] * y[5])
    };
    Truth {
        v0,
        // Free of the last digits of the conversion.
        angle_deg: (scene.drop.angle_rad.to_degrees() * 1e9).round() / 1e9,
        k: leave.map(|e| e.corner.rising_m_s / v0),
        rebound_velocity: leave.map(|e| e.corner.rising_m_s),
        contact_s: leave.map(|e| e.time_s),
        omega_rebound: leave.map(|e| -e.state[5]),
        angle_sep_deg: leave.map(|e| e.state[2].to_degrees()),
        vx_corner_after: leave.map(|e| e.corner.sliding_m_s),
        slap_t: strike.map(|e| e.time_s),
        flight_s: left_before.map(|(left, struck)| struck.time_s - left.time_s),
        vx: strike.map(|e| e.corner.sliding_m_s),
        vz: strike.map(|e| e.corner.rising_m_s),
        speed: strike.map(|e| e.corner.sliding_m_s.hypot(e.corner.rising_m_s)),
        omega: strike.map(|e| -e.state[5]),
        angle_hit_deg: strike.map(|e| e.state[2].to_degrees()),
        energy_ratio: strike.map(|e| kinetic_j(&e.state) / (0.5 * cask.mass_kg * v0 * v0)),
        relands: u32::try_from(touches).unwrap_or(u32::MAX),
        // L begins on the target and leaves once more than it has come back, or not.
        first_down_at_slap: strike.is_some() && touches == leaves,
    }
}
