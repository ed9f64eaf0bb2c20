//! What a channel shows before there is a cask file.

use super::channel::Extreme;
use std::ops::Range;

/// What a first look at a channel shows, in the recording's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelLook {
    /// The smallest sample.
    pub smallest: Extreme,
    /// The largest sample.
    pub largest: Extreme,
    /// Median of the first samples; not a number where none of them is one.
    pub level: f64,
    /// Their spread about it as a standard deviation.
    pub noise: f64,
    /// What looks like a fall, s: from the release to what ends it.
    pub fall_s: Option<Range<f64>>,
    /// When what looks like an impact begins, s.
    pub impact_s: Option<f64>,
}
