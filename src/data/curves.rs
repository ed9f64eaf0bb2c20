//! Curves for a reader: accelerations, velocities, the motion of the cask.

use super::other::OtherCurve;
use std::sync::LazyLock;

/// Curves that are computed when first needed: a campaign of thousands of drops does not need them.
pub type LazyCurves = LazyLock<Curves, Box<dyn FnOnce() -> Curves + Send>>;

/// Curves of one channel over the event window.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelCurve {
    /// The channel's name.
    pub channel: String,
    /// Times, s from the recording's first sample; uniform.
    pub time_s: Vec<f64>,
    /// Specific force, offset removed, unfiltered, m/s².
    pub raw_m_s2: Vec<f64>,
    /// Specific force, filtered without phase shift, m/s².
    pub filtered_m_s2: Vec<f64>,
    /// Velocity along the sensor's axis, integrated from the unfiltered force with gravity left out between
    /// contacts (Fig. 13), m/s.
    pub velocity_m_s: Vec<f64>,
}

/// The planar rigid-body motion over the event window; all vectors are of one length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MotionCurve {
    /// Times, s from the recording's first sample; uniform.
    pub time_s: Vec<f64>,
    /// Inclination of the axis, rad.
    pub angle_rad: Vec<f64>,
    /// ω = −dφ/dt, rad/s.
    pub angular_velocity_rad_s: Vec<f64>,
    /// Vertical velocity of L's contact corner, positive up, m/s.
    pub first_end_vertical_m_s: Vec<f64>,
    /// Vertical velocity of R's contact corner, positive up, m/s.
    pub second_end_vertical_m_s: Vec<f64>,
    /// Horizontal velocity of R's contact corner, m/s.
    pub second_end_horizontal_m_s: Vec<f64>,
    /// Height of L's contact corner above the target, m.
    pub first_end_height_m: Vec<f64>,
    /// Height of R's contact corner above the target, m.
    pub second_end_height_m: Vec<f64>,
}

/// All curves of one analysis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curves {
    /// Curves of the channels, in the cask file's order.
    pub channels: Vec<ChannelCurve>,
    /// Rigid-body motion from just before first contact to the slap-down, if it is determined.
    pub motion: Option<MotionCurve>,
    /// Curves of the channels that take no part in the motion, if the first contact is known.
    pub others: Vec<OtherCurve>,
    /// Calculated curves, aligned with the measured ones of the same channels; unfiltered, without the level
    /// before first contact.
    pub calculated: Vec<ChannelCurve>,
}
