//! A channel that takes no part in the motion, such as strain or temperature: statement, samples and summary.

use super::cask::ChannelSpec;
use super::channel::{Channel, Extreme, Span};
use super::finding::{Finding, IssueCode};
use super::test_record::SensorRecord;
use serde::Serialize;

/// A `[[channel]]` table with `end = "none"` or `axis = "rate"`.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherSpec {
    /// Specification for a reader of recordings, which treats all channels alike; end, axis and position are
    /// meaningless.
    pub read: ChannelSpec,
    /// Declared unit, any text; `None` uses that of the recording.
    pub unit: Option<String>,
    /// Specification of an angular-rate sensor, `axis = "rate"`: its rotation is compared with the motion.
    pub rate: Option<RateSpec>,
}

/// Specification of an angular-rate sensor in the cask file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateSpec {
    /// 1.0, or −1.0 if a positive reading brings R up.
    pub polarity: f64,
    /// 95 % half-width of its scale, as a share, if the file states one for the sensor.
    pub calibration: Option<f64>,
}

/// Rotation of the cask by an angular-rate sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredRotation {
    /// The sensor's name.
    pub channel: String,
    /// 95 % half-width of its scale, as a share, if the file states one for the sensor.
    pub calibration: Option<f64>,
    /// ω in the fall, if its zero is known from the rest before.
    pub before: Option<RotationRate>,
    /// Rotation gained from the fall to the flight.
    pub gained: RotationRate,
}

/// A rate of turn, positive brings R down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationRate {
    /// rad/s.
    pub rad_s: f64,
    /// Standard uncertainty of the rate, without that of the sensor's scale, rad/s.
    pub u_rad_s: f64,
}

/// Such channels as read, separate from those of the motion.
#[derive(Debug, Default)]
pub struct OtherChannels {
    /// Channels in the cask file's order; samples are in `unit`, `scale_m_s2` is 1, and end, axis and
    /// position are meaningless.
    pub channels: Vec<Channel>,
    /// Problems found when reading them.
    pub issues: Vec<Finding>,
}

/// A maximum of an amplitude spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SpectralLine {
    /// Hz.
    pub frequency_hz: f64,
    /// |∫ x e^(−iωt) dt|, in the channel's unit times s.
    pub magnitude: f64,
}

/// A row of `other_channels` in the result; values are in `unit`.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct OtherSummary {
    /// Name.
    pub name: String,
    /// Unit, as the cask file or the recording writes it.
    pub unit: String,
    /// Path at which the samples were found.
    pub source: String,
    /// Number of samples.
    pub samples: usize,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Median before the release, or before the first contact if no release is seen.
    pub rest: Option<f64>,
    /// RMS of the noise about the median.
    pub noise: Option<f64>,
    /// Smallest value of the whole recording.
    pub smallest: Option<Extreme>,
    /// Largest value of the whole recording.
    pub largest: Option<Extreme>,
    /// The strongest maximum of the spectrum of the curve with at least three periods in it.
    pub strongest_line: Option<SpectralLine>,
    /// Codes of the findings on it.
    pub findings: Vec<IssueCode>,
    /// Sensor.
    #[serde(flatten)]
    pub sensor: SensorRecord,
    /// Samples at a limit, as index spans.
    #[serde(skip)]
    pub clipped: Vec<Span>,
}

/// Curve of such a channel over the event, as recorded, and its spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherCurve {
    /// The channel's name.
    pub channel: String,
    /// Unit of the channel.
    pub unit: String,
    /// Times, s from the first sample of the accelerometers; uniform.
    pub time_s: Vec<f64>,
    /// Values, in `unit`.
    pub values: Vec<f64>,
    /// Frequencies of the spectrum, Hz.
    pub frequency_hz: Vec<f64>,
    /// |∫ x e^(−iωt) dt| without the mean, in `unit` times s.
    pub magnitude: Vec<f64>,
}
