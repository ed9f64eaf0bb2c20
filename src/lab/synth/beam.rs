//! Forces on a free beam to the motion of its bending modes.

use crate::lab::data::BendingMode;
pub use crate::numerics::free_beam::MOST_MODES;
pub(super) use crate::numerics::free_beam::shape;

/// q̈ = F/m − 2 ζ ω q̇ − ω² q: acceleration of the mode's coordinate, m/s², `drive_m_s2` being F/m.
///
/// The modes ride on the rigid motion and do not act back on the contact, so that k stays a property of the
/// ends.
pub fn bending_m_s2(mode: &BendingMode, drive_m_s2: f64, q_m: f64, velocity_m_s: f64) -> f64 {
    let omega = std::f64::consts::TAU * mode.frequency_hz;
    drive_m_s2 - 2.0 * mode.damping * omega * velocity_m_s - omega * omega * q_m
}
