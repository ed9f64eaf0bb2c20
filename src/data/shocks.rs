//! What single channels read in the impacts, whether the motion is determined or not.

use super::cask::End;
use super::estimate::Estimate;
use serde::Serialize;

/// One channel's pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelPulse {
    /// The largest of either sign, in the unit of the samples.
    pub raw: f64,
    /// The same through the low-pass.
    pub filtered: f64,
    /// When that is reached, s.
    pub time_s: f64,
    /// From one time of that reading to the next, s.
    pub sample_s: f64,
    /// How long the filtered reading stays above a tenth of it.
    pub length: Option<PulseLength>,
    /// Integral and double integral of the unfiltered reading over the pulse, s times the unit and s² times
    /// it   (51)
    pub integrals: Option<[f64; 2]>,
}

/// How long a reading stays above a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulseLength {
    /// s.
    pub length_s: f64,
    /// By how much that changes with the level, both ends apart, s per unit of the samples.
    pub by_level: f64,
}

/// What one channel reads in one impact; `None` where it does not show the pulse whole.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Shock {
    /// The channel, or which channels it is the resultant of.
    pub channel: String,
    /// The channels of a mounting block whose vector it is; none of a single channel.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub components: Vec<String>,
    /// The impact: that of the first end or of the second.
    pub event: End,
    /// The largest of either sign at the report's cut-off, in `unit`: of an acceleration counted from the
    /// free fall, of another quantity from its level before the release.
    pub peak: Option<f64>,
    /// The same, unfiltered.
    pub peak_unfiltered: Option<f64>,
    /// When `peak` is reached, s from the recording's first sample.
    pub time_s: Option<f64>,
    /// How long the filtered reading stays above a tenth of `peak`, s.
    pub duration_s: Option<f64>,
    /// Change of velocity over the pulse, of an acceleration, m/s   (51)
    pub velocity_change_m_s: Option<f64>,
    /// Displacement over the pulse against an undisturbed motion, of an acceleration, m   (51)
    pub displacement_m: Option<f64>,
    /// "g", "m/s^2" or the unit of the other quantity.
    pub unit: String,
    /// Both peaks with their intervals, m/s², where the table of the impact has them.
    #[serde(skip)]
    pub known: [Option<Estimate>; 2],
    /// m/s² per `unit`; `None` of another quantity.
    #[serde(skip)]
    pub unit_m_s2: Option<f64>,
}

/// What the choice of the low-pass makes of the first end's first impact; `None` where it is not determined.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FilteredPeak {
    /// The low-pass, by its name.
    pub name: String,
    /// Its −3 dB frequency, Hz; `None` of "unfiltered".
    pub cutoff_hz: Option<f64>,
    /// The peak that the first end's transverse channel reads, g.
    pub peak_g: Option<f64>,
    /// Largest deceleration of the rigid body at the centre of gravity, g.
    pub deceleration_g: Option<f64>,
    /// How long that channel stays above a tenth of its peak, s.
    pub duration_s: Option<f64>,
}
