//! A channel that takes no part in the motion, such as strain or temperature: as stated, as read, as told.

use super::cask::ChannelSpec;
use super::channel::{Channel, Extreme, Span};
use super::finding::{Finding, IssueCode};
use super::test_record::SensorRecord;
use serde::Serialize;

/// A `[[channel]]` table with `end = "none"` or `axis = "rate"`.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherSpec {
    /// What a reader of recordings takes, which reads all channels alike; end, axis and place say nothing.
    pub read: ChannelSpec,
    /// Declared unit, any text; `None`: what the recording says.
    pub unit: Option<String>,
    /// What makes it an angular-rate sensor, `axis = "rate"`: its rotation is held against the motion.
    pub rate: Option<RateSpec>,
}

/// What a cask file says of an angular-rate sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateSpec {
    /// 1.0, or −1.0 where a positive reading brings R up.
    pub polarity: f64,
    /// 95 % half-width of its scale, as a share, where the file gives it its own.
    pub calibration: Option<f64>,
}

/// The rotation of the cask by an angular-rate sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredRotation {
    /// The sensor's name.
    pub channel: String,
    /// 95 % half-width of its scale, as a share, where the file gives it its own.
    pub calibration: Option<f64>,
    /// ω in the fall, where its zero is known from the rest before.
    pub before: Option<RotationRate>,
    /// How much faster the cask turns in the flight than in the fall.
    pub gained: RotationRate,
}

/// A rate of turn, positive brings R down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationRate {
    /// rad/s.
    pub rad_s: f64,
    /// Standard uncertainty of it, without that of the sensor's scale, rad/s.
    pub u_rad_s: f64,
}

/// Such channels as read, apart from those of the motion.
#[derive(Debug, Default)]
pub struct OtherChannels {
    /// In the cask file's order; samples are in `unit`, `scale_m_s2` is 1, end, axis and place say nothing.
    pub channels: Vec<Channel>,
    /// What reading them found wrong.
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
    /// Where the samples were found.
    pub source: String,
    /// Number of samples.
    pub samples: usize,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Median before the release, or before the first contact where no release is seen.
    pub rest: Option<f64>,
    /// RMS of the noise about it.
    pub noise: Option<f64>,
    /// Smallest value of the whole recording.
    pub smallest: Option<Extreme>,
    /// Largest value of the whole recording.
    pub largest: Option<Extreme>,
    /// The strongest maximum of the spectrum of the curve, from three periods in it on.
    pub strongest_line: Option<SpectralLine>,
    /// Codes of the findings on it.
    pub findings: Vec<IssueCode>,
    /// Which sensor it is.
    #[serde(flatten)]
    pub sensor: SensorRecord,
    /// Samples at a limit, as index spans.
    #[serde(skip)]
    pub clipped: Vec<Span>,
}

/// The curve of such a channel over the event, as recorded, and its spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherCurve {
    /// The channel's name.
    pub channel: String,
    /// Its unit.
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
