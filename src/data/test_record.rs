//! Test record in a cask file: persons, specimen, place, date, and independent observations.

use super::estimate::Estimate;
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// `[test]`: the head of a test report, which changes no number.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct TestRecord {
    /// The test's number.
    pub id: Option<String>,
    /// Title of the test.
    pub title: Option<String>,
    /// Place of the test.
    pub place: Option<String>,
    /// Operator.
    pub operator: Option<String>,
    /// Customer.
    pub customer: Option<String>,
    /// Specimen.
    pub specimen: Option<String>,
    /// Target of the drop.
    pub target: Option<String>,
    /// Anything else.
    pub remarks: Option<String>,
    /// A date, or date and time, as RFC 3339 writes it.
    pub date: Option<String>,
    /// Temperature of the specimen, °C.
    pub temperature_c: Option<f64>,
    /// Photographs, by the names of their files.
    pub photos: Vec<Photo>,
    /// Who signs.
    pub signatures: Vec<String>,
    /// Revisions of the report: date, version of the program and change, separated by commas.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub revisions: Vec<String>,
    /// `[test.more]`: additional names and words.
    #[serde(serialize_with = "as_object")]
    pub more: Vec<(String, String)>,
}

fn as_object<S: Serializer>(pairs: &[(String, String)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().map(|(key, words)| (key, words)))
}

/// A sensor, as its papers name it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct SensorRecord {
    /// Serial number.
    pub serial: Option<String>,
    /// The certificate of its calibration.
    pub certificate: Option<String>,
    /// Date of calibration.
    pub calibrated: Option<String>,
}

/// A photograph of the test, or a logo; a JSON holds the name of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Photo {
    /// The file, as the cask file names it.
    pub name: String,
    /// "image/png", "image/jpeg" or, of a logo, "image/svg+xml".
    pub media_type: &'static str,
    /// The file's bytes; empty where only the name is known.
    pub bytes: Arc<[u8]>,
}

impl Serialize for Photo {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.name)
    }
}

/// A quantity of `[observed]`, for example from a video.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// Key of the observation.
    pub name: &'static str,
    /// Observed value.
    pub value: f64,
    /// Half-width of its 95 % interval.
    pub u95: f64,
    /// Instrument or person that made the observation.
    pub by: Option<String>,
}

/// A limit of `[limits]`, in the unit of its key, and the measured value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    /// Key of the limit.
    pub name: &'static str,
    /// The least that is allowed.
    pub least: Option<f64>,
    /// The most.
    pub most: Option<f64>,
    /// Measured value; `None` in a cask file.
    pub measured: Option<Estimate>,
    /// State of the limit.
    pub state: LimitState,
}

/// Comparison of a measured value with a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LimitState {
    /// The whole interval lies within.
    Kept,
    /// The whole interval lies beyond.
    Exceeded,
    /// The interval includes the limit, or the quantity is not determined.
    Undecided,
}

/// `[report]`: letterhead of a site.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Letterhead {
    /// Above the title.
    pub header: Option<String>,
    /// Below each page.
    pub footer: Option<String>,
    /// A picture beside the header.
    pub logo: Option<Photo>,
}

/// An observed quantity and the corresponding result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObservedBeside {
    /// The key in `[observed]`.
    pub name: &'static str,
    /// Observed value.
    pub observed: Estimate,
    /// Instrument or person that made the observation.
    pub by: Option<String>,
    /// The result; `None` if it has none.
    pub result: Option<Estimate>,
    /// E_n = (result − observed) / √(U² + U²) of both half-widths (ISO 13528); within ±1 they agree.
    pub e_n: Option<f64>,
}
