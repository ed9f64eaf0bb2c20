//! The times between which the flight is fitted.

/// A fit of the flight ends so long before the slap-down, s: its onset.
pub const BEFORE_SLAP_DOWN_S: f64 = 5e-4;
/// It begins this share of the contact behind its end, and so long, s: what the force's tail hides.
const BEHIND_CONTACT: f64 = 0.1;
const BEHIND_CONTACT_S: f64 = 3e-4;

/// When a fit of the flight may begin, s.
pub fn clear_of_contact_s(contact_s: f64, left_s: f64) -> f64 {
    left_s + BEHIND_CONTACT * (left_s - contact_s) + BEHIND_CONTACT_S
}

/// The times a flight fit needs, s from the recording's first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Start of free flight.
    pub from_s: f64,
    /// End of it.
    pub to_s: f64,
    /// Whether a change of the offset may be fitted.
    pub drift: bool,
    /// ω of the flight where it is known already, rad/s: its centrifugal force is taken off, put back where
    /// it is negative; else 0.
    pub angular_velocity_rad_s: f64,
}
