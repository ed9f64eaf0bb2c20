//! Readings of single channels in the impacts, even if the motion is not determined.

use super::cask::End;
use super::estimate::Estimate;
use serde::Serialize;

/// Pulse of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelPulse {
    /// Largest value of either sign, in the unit of the samples.
    pub raw: f64,
    /// Peak after the low-pass.
    pub filtered: f64,
    /// Time of that peak, s.
    pub time_s: f64,
    /// Time from one sample of that reading to the next, s.
    pub sample_s: f64,
    /// Time for which the filtered reading stays above a tenth of its peak.
    pub length: Option<PulseLength>,
    /// Integral and double integral of the unfiltered reading over the pulse, in s and s² times the unit
    /// (51)
    pub integrals: Option<[f64; 2]>,
}

/// Time for which a reading stays above a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulseLength {
    /// s.
    pub length_s: f64,
    /// Change of that time with the level, both ends independent, s per unit of the samples.
    pub by_level: f64,
}

/// Reading of one channel in one impact; `None` if the channel does not show the whole pulse.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Shock {
    /// The channel, or the channels of the resultant.
    pub channel: String,
    /// Channels of a mounting block for a vector; empty for a single channel.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub components: Vec<String>,
    /// The impact: that of the first end or of the second.
    pub event: End,
    /// Largest value of either sign at the report's cut-off, in `unit`: for an acceleration relative to the
    /// free fall, for another quantity to its level before the release.
    pub peak: Option<f64>,
    /// Peak without the low-pass.
    pub peak_unfiltered: Option<f64>,
    /// Time of `peak`, s from the recording's first sample.
    pub time_s: Option<f64>,
    /// Time for which the filtered reading stays above a tenth of `peak`, s.
    pub duration_s: Option<f64>,
    /// Change of velocity over the pulse, for an acceleration, m/s   (51)
    pub velocity_change_m_s: Option<f64>,
    /// Displacement over the pulse against an undisturbed motion, for an acceleration, m   (51)
    pub displacement_m: Option<f64>,
    /// Unit: "g", "m/s^2" or the unit of the other quantity.
    pub unit: String,
    /// Both peaks with their intervals, m/s², if the table of the impact has them.
    #[serde(skip)]
    pub known: [Option<Estimate>; 2],
    /// m/s² per `unit`; `None` for another quantity.
    #[serde(skip)]
    pub unit_m_s2: Option<f64>,
}

/// Peak of the first end's first impact with one low-pass; `None` if it is not determined.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FilteredPeak {
    /// The low-pass, by its name.
    pub name: String,
    /// −3 dB frequency, Hz; `None` for "unfiltered".
    pub cutoff_hz: Option<f64>,
    /// The peak that the first end's transverse channel reads, g.
    pub peak_g: Option<f64>,
    /// Largest deceleration of the rigid body at the centre of gravity, g.
    pub deceleration_g: Option<f64>,
    /// Time for which that channel stays above a tenth of its peak, s.
    pub duration_s: Option<f64>,
}
