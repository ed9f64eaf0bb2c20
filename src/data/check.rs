//! Judgement of a set-up before the drop, which `check` makes from a recording at rest.

use super::finding::{Finding, RestCause};
use serde::Serialize;

/// Result of checking a set-up at rest before its drop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// "dropcheck.check/1".
    pub schema: &'static str,
    /// True if neither a channel nor anything else has a finding against it.
    pub ready: bool,
    /// The channels, in the order of the cask file.
    pub channels: Vec<CheckedChannel>,
    /// Findings that belong to no single channel.
    pub findings: Vec<Finding>,
}

/// Result of checking one channel at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckedChannel {
    /// Name of the channel.
    pub name: String,
    /// True if the channel has no finding against it.
    pub ready: bool,
    /// Reading with its offset, g of 9.80665 m/s².
    pub reads_g: f64,
    /// Reading expected without offset, g; an AC-coupled channel must read zero.
    pub expected_g: Option<f64>,
    /// Standard deviation of its noise, g.
    pub noise_g: f64,
    /// Findings on this channel, the most severe first.
    pub findings: Vec<Finding>,
    /// Mistakes that an offset could hide: with any of them the channel could read this level.
    #[serde(skip)]
    pub open: Vec<RestCause>,
}

/// One channel in a recording at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtRest {
    /// Mean of the levels close to the median level, with the offset, m/s².
    pub level_m_s2: f64,
    /// Standard uncertainty of that mean, from the scatter of the levels, m/s².
    pub u_m_s2: f64,
    /// True if most of the levels lie close to the median level.
    pub is_still: bool,
    /// Smallest difference of neighbouring samples, m/s²; 0 if all are equal.
    pub least_step_m_s2: f64,
}

/// Response of a channel to a tap on the cask.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TapAnswer {
    /// Time from the recording's first sample, s.
    pub at_s: f64,
    /// True if the first swing is positive.
    pub goes_up: bool,
}
