//! Requirements of a drop on its recorder, and the measures that would narrow its intervals.

use serde::Serialize;

/// The plan of a measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuringPlan {
    /// Requirements on the recorder.
    #[serde(flatten)]
    pub needs: RecordingNeeds,
    /// The k that the intervals are expected for.
    pub k: f64,
    /// Intervals with the channels of the cask file, then with each additional sensor.
    pub intervals: Vec<ExpectedIntervals>,
    /// Reason why there are none.
    pub why_no_intervals: Option<&'static str>,
}

/// Ranges, rate and record that a drop needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingNeeds {
    /// The peaks that each channel must take.
    pub channels: Vec<ChannelNeeds>,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Frequency from which the low-pass before the sampling must leave nothing, Hz.
    pub nothing_from_hz: f64,
    /// Least record before the first contact, s.
    pub before_s: f64,
    /// Duration of the free fall, s: a longer record before the contact shows the rest.
    pub fall_s: f64,
    /// Time from the first contact to the slap-down with k = 1, s; 0 if no slap-down is predicted.
    pub flight_s: f64,
    /// Record behind the first contact, s.
    pub after_s: f64,
}

/// Requirement on the range of a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelNeeds {
    /// Name of the channel; the end, if the cask file has no channel there.
    pub name: String,
    /// The peak of a first impact of each length, the longest first.
    pub peaks: Vec<ExpectedPeak>,
}

/// Peak of a first impact with a given duration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExpectedPeak {
    /// Duration of the impact, s.
    pub lasts_s: f64,
    /// Peak without ringing, g of 9.80665 m/s².
    pub peak_g: f64,
}

/// Expected uncertainty of a drop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExpectedIntervals {
    /// Sensors added to the channels of the cask file; empty for these alone.
    pub with: &'static str,
    /// 95 % half-width of the slap-down speed, m/s.
    pub slap_down_speed_u95_m_s: f64,
    /// 95 % half-width of k.
    pub k_u95: f64,
}
