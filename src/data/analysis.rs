//! The result of `analyze`, as the JSON document has it, and further data for the report.

use super::cask_file::CaskFile;
use super::cause::{OpenedInput, StatedCause};
use super::channel::Span;
use super::curves::LazyCurves;
use super::estimate::{At, Estimate};
use super::finding::Finding;
use super::flight::FlightFit;
use super::impacts::ImpactTable;
use super::ladder::Rung;
use super::missing::{MissingQuantity, missing_in};
use super::other::OtherSummary;
use super::prediction::{BodyModel, Prediction};
use super::prototype::Prototype;
use super::quantities::{Contribution, FirstImpact, SlapDown, Untested};
use super::reconstruction::MethodChoice;
use super::recording::RecordingFormat;
use super::shocks::{FilteredPeak, Shock};
use super::simulation::{CalculatedNumber, SimulationRow};
use super::test_record::{Limit, LimitState, ObservedBeside, SensorRecord, TestRecord};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The verdict on a result, in the order of severity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// No check found a problem.
    Pass,
    /// A warning is to be read before the numbers are used.
    Review,
    /// An error: a quantity is not determined.
    #[default]
    Fail,
}

/// Files that the analysis read.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Input {
    /// The recording, as given.
    pub recording: String,
    /// SHA-256 of the recording.
    pub recording_sha256: String,
    /// Format of the recording.
    pub format: RecordingFormat,
    /// Converter that read the recording and passed it on in that format, with its version; `None` if
    /// dropcheck read it itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reader: Option<String>,
    /// The cask file, as given.
    pub cask: String,
    /// SHA-256 of the cask file.
    pub cask_sha256: String,
    /// The file with the rest before the drop, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest: Option<String>,
    /// SHA-256 of that file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest_sha256: Option<String>,
    /// The file of the calculation, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation: Option<String>,
    /// SHA-256 of that file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation_sha256: Option<String>,
}

/// Comparison of one analytical model with the measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelCandidate {
    /// Model, by its level of detail.
    pub rung: Rung,
    /// Body that the model describes.
    pub model: BodyModel,
    /// Predicted slap-down speed with the measured k, m/s.
    pub predicted: Option<f64>,
    /// 95 % half-width of the prediction, from k, angle and pulse length, m/s.
    pub u95: Option<f64>,
    /// (measured − predicted) / predicted, percent.
    pub difference_percent: Option<f64>,
    /// True if the prediction lies within both intervals.
    pub consistent: bool,
}

/// The simplest analytical model that explains the measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelChoice {
    /// Body of the selected model.
    pub name: BodyModel,
    /// Level of detail of the selected model.
    pub rung: Rung,
    /// One sentence: the reason, and what the next model would change.
    pub reason: String,
    /// Models that differ from the simpler ones at this k and angle, simplest first.
    pub candidates: Vec<ModelCandidate>,
}

/// Measured beside predicted slap-down speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Predicted by the chosen model with the measured k, m/s.
    pub predicted: f64,
    /// 95 % half-width of it, m/s.
    #[serde(deserialize_with = "number_or_null")]
    pub predicted_u95: f64,
    /// Measured, m/s.
    pub measured: f64,
    /// 95 % half-width of it, m/s.
    #[serde(deserialize_with = "number_or_null")]
    pub measured_u95: f64,
    /// (measured − predicted) / predicted, percent.
    pub difference_percent: f64,
    /// True if the difference lies within both intervals.
    pub agrees: bool,
}

/// Reads a number that JSON writes as null if it is not finite.
pub(crate) fn number_or_null<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

/// The times that the report marks, s from the recording's first sample.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Events {
    /// Release, if the record has the rest before it.
    pub release_s: Option<f64>,
    /// First touch that ends the free fall, if its release was seen: first contact, or a time before it.
    pub fall_end_s: Option<f64>,
    /// First contact of L.
    #[serde(rename = "first_contact_s", serialize_with = "time_s")]
    pub first_contact: Option<At>,
    /// L leaves the target.
    #[serde(rename = "separation_s", serialize_with = "time_s")]
    pub separation: Option<At>,
    /// First contact of R.
    #[serde(rename = "slap_down_s", serialize_with = "time_s")]
    pub slap_down: Option<At>,
}

impl Events {
    /// First contact of L, s.
    pub fn first_contact_s(&self) -> Option<f64> {
        self.first_contact.map(|at| at.time_s)
    }

    /// L leaves the target, s.
    pub fn separation_s(&self) -> Option<f64> {
        self.separation.map(|at| at.time_s)
    }

    /// First contact of R, s.
    pub fn slap_down_s(&self) -> Option<f64> {
        self.slap_down.map(|at| at.time_s)
    }
}

#[allow(clippy::ref_option, reason = "serde calls it so")]
fn time_s<S: Serializer>(at: &Option<At>, to: S) -> Result<S::Ok, S::Error> {
    at.map(|at| at.time_s).serialize(to)
}

/// Summary of one channel: its place, its levels and its quality.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ChannelSummary {
    /// The channel's name.
    pub name: String,
    /// "first" or "second".
    pub end: super::cask::End,
    /// "transverse" or "axial".
    pub axis: super::cask::Axis,
    /// Path at which the samples were found.
    pub source: String,
    /// Samples read.
    pub samples: usize,
    /// Rate, Hz.
    pub sample_rate_hz: f64,
    /// Unit and its origin, such as "g (cask file)".
    pub unit: String,
    /// Offset removed, m/s².
    pub offset_m_s2: Option<f64>,
    /// RMS of the noise about it, m/s².
    pub noise_m_s2: Option<f64>,
    /// Largest magnitude, filtered, m/s².
    pub peak_filtered_m_s2: Option<f64>,
    /// Largest magnitude, unfiltered, m/s².
    pub peak_raw_m_s2: Option<f64>,
    /// Sensor, as the cask file states it.
    #[serde(flatten)]
    pub sensor: SensorRecord,
    /// Samples at a limit, as index spans.
    #[serde(skip)]
    pub clipped: Vec<Span>,
}

/// One setting with its value and its origin.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Setting {
    /// Name as a report prints it: "low-pass for the curves".
    pub name: String,
    /// Value with its unit: "CFC 180 (−3 dB at 298 Hz)".
    pub value: String,
    /// Origin: "cask file", "recording", "default", "from the data: …".
    pub origin: String,
}

/// The program that made a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Program {
    /// "dropcheck".
    pub name: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// Commit that the program was built from, if the build knew it.
    pub commit: Option<&'static str>,
    /// Platform that the program was built for, such as "x86_64-linux".
    pub target: String,
    /// SHA-256 of the program file, if a released program ran.
    pub sha256: Option<String>,
}

impl Program {
    /// Describes the running program.
    pub fn current() -> Self {
        Self {
            name: env!("CARGO_PKG_NAME"),
            version: env!("CARGO_PKG_VERSION"),
            commit: option_env!("DROPCHECK_COMMIT"),
            target: format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
            sha256: None,
        }
    }

    /// "dropcheck 0.1.0 (0123abc)".
    pub fn words(&self) -> String {
        let commit = self.commit.map_or_else(String::new, |commit| format!(" ({commit})"));
        format!("{} {}{commit}", self.name, self.version)
    }
}

/// The result as `result.json` has it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct DropResult {
    /// "dropcheck.result/1".
    pub schema: &'static str,
    /// The program's version.
    pub version: &'static str,
    /// Program, command line and time (RFC 3339), if a command line made the result.
    pub program: Option<Program>,
    /// See `program`.
    pub command: Vec<String>,
    /// See `program`.
    pub analysed: Option<String>,
    /// Files that the analysis read.
    pub input: Input,
    /// The first impact.
    pub first_impact: FirstImpact,
    /// The slap-down.
    pub slap_down: SlapDown,
    /// Effective coefficient of restitution.
    pub k: Option<Estimate>,
    /// Slap-down speed over impact velocity.
    pub amplification: Option<Estimate>,
    /// The first impact and the second, as test reports tabulate them.
    pub impacts: [ImpactTable; 2],
    /// Readings of every channel in each impact, even if the motion is not determined.
    pub shocks: Vec<Shock>,
    /// Peak of the first end's first impact with each of several low-pass filters.
    pub filters: Vec<FilteredPeak>,
    /// Results scaled to the prototype, if the cask is a scale model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prototype: Option<Prototype>,
    /// Method that determined the motion.
    pub reconstruction: Option<MethodChoice>,
    /// The simplest analytical model that explains the measurement.
    pub model: Option<ModelChoice>,
    /// Predictions of the analytical models.
    pub predictions: Vec<Prediction>,
    /// Measured beside predicted.
    pub comparison: Option<Comparison>,
    /// Test record: persons, specimen, place and date.
    pub test: TestRecord,
    /// Independent observations beside the result.
    pub observed: Vec<ObservedBeside>,
    /// Limits of the cask file, with the result.
    pub limits: Vec<Limit>,
    /// Agreement of calculated curves with the measured ones.
    pub simulation: Vec<SimulationRow>,
    /// Numbers of the calculation and the measured ones.
    #[serde(skip)]
    pub calculated: Vec<CalculatedNumber>,
    /// Every finding, errors first.
    pub quality: Vec<Finding>,
    /// Every null quantity, with the finding that removed it.
    pub missing: Vec<MissingQuantity>,
    /// Mistakes in the cask file that would explain a contradiction, best first; empty if several explain it
    /// equally well.
    pub causes: Vec<StatedCause>,
    /// The overall word.
    pub verdict: Verdict,
    /// Times of the events.
    pub events: Events,
    /// Summary of each channel.
    pub channels: Vec<ChannelSummary>,
    /// Readings of the channels that take no part in the motion; omitted if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_channels: Vec<OtherSummary>,
    /// The fit of the free-flight window.
    pub flight: Option<FlightFit>,
    /// Contribution of each input to the uncertainty, largest first.
    pub budget: Vec<Contribution>,
    /// Inputs that this recording cannot check, largest effect first; empty if no number is stated.
    pub untested: Vec<Untested>,
    /// Processing of the samples, in words.
    #[serde(rename = "processing")]
    pub settings: Vec<Setting>,
    /// Every key of the cask file with its value and the origin of the value; null if nobody asked for it.
    #[serde(rename = "settings")]
    pub keys: serde_json::Value,
    /// The cask file's text.
    pub cask_text: String,
}

impl DropResult {
    /// Lists every null quantity, with the finding that removed it.
    pub fn find_missing(&mut self) {
        let result = serde_json::to_value(&*self).unwrap_or_default();
        self.missing = missing_in(&result, &self.quality);
    }

    /// True if a limit of the cask file is exceeded.
    pub fn exceeds_a_limit(&self) -> bool {
        self.limits.iter().any(|limit| limit.state == LimitState::Exceeded)
    }

    /// Scales the result to the prototype, if the cask is a model of this scale   (46)
    pub fn to_prototype(&self, scale: f64) -> Prototype {
        Prototype {
            scale,
            first_impact: self.first_impact.to_prototype(scale),
            slap_down: self.slap_down.to_prototype(scale),
            k: self.k,
            amplification: self.amplification,
            impacts: self.impacts.each_ref().map(|impact| impact.to_prototype(scale)),
        }
    }
}

/// Everything that one analysis found: the result, the cask file behind it and the curves.
#[derive(Debug)]
pub struct Analysis {
    /// The result.
    pub result: DropResult,
    /// The cask file.
    pub cask_file: CaskFile,
    /// The curves.
    pub curves: LazyCurves,
    /// Absolute time of the recording's first sample, ns since 1970, where the recording knows it.
    pub start_unix_ns: Option<i64>,
    /// Numbers of the cask file that would make an inconsistent motion consistent.
    pub opened_inputs: Vec<OpenedInput>,
}
