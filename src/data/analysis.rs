//! The result of `analyze`, as the contract's JSON has it, and what the report needs beside it.

use super::cask_file::CaskFile;
use super::cause::{Opening, StatedCause};
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
use super::reconstruction::ReconstructionChoice;
use super::recording::RecordingFormat;
use super::shocks::{FilteredPeak, Shock};
use super::simulation::{CalculatedNumber, SimulationRow};
use super::test_record::{Limit, LimitState, ObservedBeside, SensorRecord, TestRecord};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The overall word on a result, in the order of their gravity.
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

/// Which files went in.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Input {
    /// The recording, as given.
    pub recording: String,
    /// Its SHA-256.
    pub recording_sha256: String,
    /// Its format.
    pub format: RecordingFormat,
    /// What read it and handed it on in that format, with its version; `None` where dropcheck itself did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reader: Option<String>,
    /// The cask file, as given.
    pub cask: String,
    /// Its SHA-256.
    pub cask_sha256: String,
    /// The file with the rest before the drop, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest: Option<String>,
    /// Its SHA-256.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest_sha256: Option<String>,
    /// The file of the calculation, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation: Option<String>,
    /// Its SHA-256.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation_sha256: Option<String>,
}

/// How one analytical model stands against the measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelCandidate {
    /// Which rung of the ladder of models.
    pub rung: Rung,
    /// Which body.
    pub model: BodyModel,
    /// Predicted slap-down speed with the measured k, m/s.
    pub predicted: Option<f64>,
    /// 95 % half-width of the prediction, from k, angle and pulse length, m/s.
    pub u95: Option<f64>,
    /// (measured − predicted) / predicted, percent.
    pub difference_percent: Option<f64>,
    /// Whether it lies within both intervals.
    pub consistent: bool,
}

/// Which analytical model explains the measurement with the least.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelChoice {
    /// The body of the model taken.
    pub name: BodyModel,
    /// Its rung of the ladder of models.
    pub rung: Rung,
    /// One sentence: why, and what the next one would have changed.
    pub reason: String,
    /// The rungs that say something of their own at this k and angle, simplest first.
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
    /// Whether the difference lies within both intervals.
    pub agrees: bool,
}

/// A number that JSON has as null where it is none.
pub(crate) fn number_or_null<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

/// The times that the report marks, s from the recording's first sample.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Events {
    /// Release, where the record has the rest before it.
    pub release_s: Option<f64>,
    /// First touch that ends the free fall, where its release was seen; first contact, or before it.
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

/// What one channel is worth.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ChannelSummary {
    /// The channel's name.
    pub name: String,
    /// "first" or "second".
    pub end: super::cask::End,
    /// "transverse" or "axial".
    pub axis: super::cask::Axis,
    /// Where the samples were found.
    pub source: String,
    /// Samples read.
    pub samples: usize,
    /// Rate, Hz.
    pub sample_rate_hz: f64,
    /// The unit they are in and who says so, such as "g (cask file)".
    pub unit: String,
    /// Offset removed, m/s².
    pub offset_m_s2: Option<f64>,
    /// RMS of the noise about it, m/s².
    pub noise_m_s2: Option<f64>,
    /// Largest magnitude, filtered, m/s².
    pub peak_filtered_m_s2: Option<f64>,
    /// Largest magnitude, unfiltered, m/s².
    pub peak_raw_m_s2: Option<f64>,
    /// Which sensor it is, as the cask file states it.
    #[serde(flatten)]
    pub sensor: SensorRecord,
    /// Samples at a limit, as index spans.
    #[serde(skip)]
    pub clipped: Vec<Span>,
}

/// One setting, its value and where it came from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Setting {
    /// What it is, as a person says it: "low-pass for the curves".
    pub name: String,
    /// Its value with its unit: "CFC 180 (−3 dB at 298 Hz)".
    pub value: String,
    /// "cask file", "recording", "default", "from the data: …".
    pub origin: String,
}

/// The program that made a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Program {
    /// "dropcheck".
    pub name: &'static str,
    /// Its version.
    pub version: &'static str,
    /// The commit that it was built of, where the build was told.
    pub commit: Option<&'static str>,
    /// What it was built for, such as "x86_64-linux".
    pub target: String,
    /// SHA-256 of its file, where a release ran as a program of its own.
    pub sha256: Option<String>,
}

impl Program {
    /// This one.
    pub fn this() -> Self {
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
    /// Which program made it, with which words on its command line, and when (RFC 3339); where a command line
    /// did.
    pub program: Option<Program>,
    /// See `program`.
    pub command: Vec<String>,
    /// See `program`.
    pub analysed: Option<String>,
    /// Which files went in.
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
    /// What every channel reads in each of them, also where the motion is not determined.
    pub shocks: Vec<Shock>,
    /// What the choice of the low-pass makes of the first end's first impact.
    pub filters: Vec<FilteredPeak>,
    /// All that as of the prototype, where the cask is a scale model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prototype: Option<Prototype>,
    /// How the motion was had.
    pub reconstruction: Option<ReconstructionChoice>,
    /// Which analytical model explains the measurement.
    pub model: Option<ModelChoice>,
    /// What the analytical models say.
    pub predictions: Vec<Prediction>,
    /// Measured beside predicted.
    pub comparison: Option<Comparison>,
    /// Who tested what, where and when.
    pub test: TestRecord,
    /// What was seen otherwise, beside the result.
    pub observed: Vec<ObservedBeside>,
    /// The limits of the cask file, beside the result.
    pub limits: Vec<Limit>,
    /// How the calculated curves agree with the measured ones.
    pub simulation: Vec<SimulationRow>,
    /// Numbers of the calculation beside the measured ones.
    #[serde(skip)]
    pub calculated: Vec<CalculatedNumber>,
    /// Every finding, errors first.
    pub quality: Vec<Finding>,
    /// Every quantity that is null, with the finding that took it.
    pub missing: Vec<MissingQuantity>,
    /// What would explain an analysis that contradicts itself, best first; empty where several would.
    pub causes: Vec<StatedCause>,
    /// The overall word.
    pub verdict: Verdict,
    /// Times of the events.
    pub events: Events,
    /// What each channel is worth.
    pub channels: Vec<ChannelSummary>,
    /// What the channels read that take no part in the motion; left out where there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_channels: Vec<OtherSummary>,
    /// The fit of the free-flight window.
    pub flight: Option<FlightFit>,
    /// What each input contributes to the uncertainty, largest first.
    pub budget: Vec<Contribution>,
    /// What nothing in the recording tests, largest effect first; empty where no number is stated.
    pub untested: Vec<Untested>,
    /// What was done with the samples and how, in words.
    #[serde(rename = "processing")]
    pub settings: Vec<Setting>,
    /// Every key of the cask file with its value and where that is from; null where nobody asked.
    #[serde(rename = "settings")]
    pub keys: serde_json::Value,
    /// The cask file's text.
    pub cask_text: String,
}

impl DropResult {
    /// Names every quantity that is null, with the finding that took it.
    pub fn find_missing(&mut self) {
        let result = serde_json::to_value(&*self).unwrap_or_default();
        self.missing = missing_in(&result, &self.quality);
    }

    /// Whether a limit of the cask file is exceeded.
    pub fn exceeds_a_limit(&self) -> bool {
        self.limits.iter().any(|limit| limit.state == LimitState::Exceeded)
    }

    /// What holds of the prototype, where the cask is a model of this scale   (46)
    pub fn of_prototype(&self, scale: f64) -> Prototype {
        Prototype {
            scale,
            first_impact: self.first_impact.of_prototype(scale),
            slap_down: self.slap_down.of_prototype(scale),
            k: self.k,
            amplification: self.amplification,
            impacts: self.impacts.each_ref().map(|impact| impact.of_prototype(scale)),
        }
    }
}

/// Everything one analysis found: the result, the cask file it was made with and the curves.
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
    /// Where the motion misses what it must meet, the numbers of which another one would meet it.
    pub openings: Vec<Opening>,
}
