//! A cask file to geometry and initial motion.

use crate::data::{AxialClosure, CONTACT_STEPS, CaskFile, Setup};

/// A friction that nobody states lies between none and what sticking needs, and more than that does as much:
/// in the middle of what 0.1 and more give, as a share of what sticking needs, and with a standard
/// uncertainty that takes both ends in.
pub(super) const MIDDLE: f64 = 0.6;
pub(super) const U_UNKNOWN: f64 = 0.33;

/// Geometry and initial motion of a cask file, L sticking to the target.
#[must_use]
pub fn sticking(cask_file: &CaskFile) -> Setup {
    Setup {
        length_m: cask_file.cask.length_m,
        height_m: cask_file.cask.height_m,
        cog_m: cask_file.cask.cog_m,
        angle_rad: cask_file.drop.angle_rad,
        impact_velocity_m_s: cask_file.drop.impact_velocity_m_s,
        is_of_fall: !cask_file.drop.impact_velocity_given,
        angular_velocity_rad_s: cask_file.drop.angular_velocity_rad_s,
        horizontal_velocity_m_s: cask_file.drop.horizontal_velocity_m_s,
        gravity_m_s2: cask_file.drop.gravity_m_s2,
        axial: AxialClosure::Sticking,
        second_s: 1.0,
        contact_steps: CONTACT_STEPS,
    }
}
