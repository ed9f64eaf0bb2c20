//! The times between which the flight is fitted.

/// Time between the end of the fitted flight and the slap-down, s: its onset.
pub const BEFORE_SLAP_DOWN_S: f64 = 5e-4;
/// The window begins this share of the contact, and this time, s, after the contact's end: the margin covers
/// the tail of the force.
const BEHIND_CONTACT: f64 = 0.1;
const BEHIND_CONTACT_S: f64 = 3e-4;

/// Earliest beginning of a fit to the flight, s.
pub fn clear_of_contact_s(contact_s: f64, left_s: f64) -> f64 {
    left_s + BEHIND_CONTACT * (left_s - contact_s) + BEHIND_CONTACT_S
}

/// Times for a flight fit, s from the recording's first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Start of free flight.
    pub from_s: f64,
    /// End of free flight.
    pub to_s: f64,
    /// True if a change of the offset may be fitted.
    pub drift: bool,
    /// ω of the flight if it is already known, rad/s: its centrifugal force is subtracted, or added if ω is
    /// negative; else 0.
    pub angular_velocity_rad_s: f64,
}
