//! A set-up before the drop as `check` judges it by a recording at rest.

use super::finding::{Finding, RestCause};
use serde::Serialize;

/// Whether a set-up is ready for its drop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// "dropcheck.check/1".
    pub schema: &'static str,
    /// Whether no channel and nothing else speaks against it.
    pub ready: bool,
    /// The channels, in the order of the cask file.
    pub channels: Vec<CheckedChannel>,
    /// What is of no single channel.
    pub findings: Vec<Finding>,
}

/// One channel at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckedChannel {
    /// Its name.
    pub name: String,
    /// Whether nothing speaks against it.
    pub ready: bool,
    /// What it reads, its offset in it, g of 9.80665 m/s².
    pub reads_g: f64,
    /// What it must read without offset, g; an AC-coupled one must read nothing.
    pub expected_g: Option<f64>,
    /// Standard deviation of its noise, g.
    pub noise_g: f64,
    /// What was found, the most severe first.
    pub findings: Vec<Finding>,
    /// What would read the same, but for an offset.
    #[serde(skip)]
    pub open: Vec<RestCause>,
}

/// A recording of rest alone, as one channel shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtRest {
    /// Mean of the levels about the median one, its offset in it, m/s².
    pub level_m_s2: f64,
    /// Standard uncertainty of it, from the scatter of the levels, m/s².
    pub u_m_s2: f64,
    /// Whether most of the levels lie about the median one.
    pub is_still: bool,
    /// Smallest difference of neighbouring samples, m/s²; 0 where all are equal.
    pub least_step_m_s2: f64,
}

/// How a channel answers a blow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlowAnswer {
    /// When, s from the recording's first sample.
    pub at_s: f64,
    /// Whether its first swing goes up.
    pub goes_up: bool,
}
