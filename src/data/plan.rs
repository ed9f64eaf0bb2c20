//! What a drop needs of what records it, and what more would narrow its intervals.

use serde::Serialize;

/// The plan of a measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuringPlan {
    /// What records it.
    #[serde(flatten)]
    pub needs: RecordingNeeds,
    /// The k that the intervals are expected for.
    pub k: f64,
    /// The intervals with the channels of the cask file, then with one thing more each.
    pub intervals: Vec<ExpectedIntervals>,
    /// Why there are none.
    pub why_no_intervals: Option<&'static str>,
}

/// Ranges, rate and record that a drop needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingNeeds {
    /// The peaks that each channel must take.
    pub channels: Vec<ChannelNeeds>,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// The low-pass before the sampling leaves nothing from here on, Hz.
    pub nothing_from_hz: f64,
    /// Least record before the first contact, s.
    pub before_s: f64,
    /// The free fall: a longer record before the contact holds the rest, s.
    pub fall_s: f64,
    /// From the first contact to the slap-down, with k = 1, s; 0 where none is predicted.
    pub flight_s: f64,
    /// Record behind the first contact, s.
    pub after_s: f64,
}

/// What the range of a channel must take.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelNeeds {
    /// The channel; where the cask file has none, an end.
    pub name: String,
    /// The peak of a first impact of each length, the longest first.
    pub peaks: Vec<ExpectedPeak>,
}

/// The peak that a first impact of some length makes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExpectedPeak {
    /// How long the impact lasts, s.
    pub lasts_s: f64,
    /// Its peak without ringing, g of 9.80665 m/s².
    pub peak_g: f64,
}

/// How well a drop will be known.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExpectedIntervals {
    /// What is added to the channels of the cask file; empty for these alone.
    pub with: &'static str,
    /// 95 % half-width of the slap-down speed, m/s.
    pub slap_down_speed_u95_m_s: f64,
    /// 95 % half-width of k.
    pub k_u95: f64,
}
