//! When a channel first answers the first impact, beside the end that is struck.

use serde::Serialize;

/// The delay of a channel's first answer to the first impact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Onset {
    /// The channel's name.
    pub channel: String,
    /// Its answer less first contact on the first end, s: 0 for a rigid body and one clock, negative if
    /// stamped early.
    pub delay_s: f64,
    /// Standard uncertainty of it, s.
    pub u_s: f64,
}
