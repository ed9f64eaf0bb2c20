//! Recordings with expected values, the program's own and a site's, to what it makes of each.

use crate::analysis::analyze;
use crate::data::{DropResult, Estimate};
use crate::ingest;
use crate::lab::campaign::written;
use crate::lab::data::TrialLimit;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What a folder of reference recordings holds besides them.
const NAME: &str = "reference.toml";

/// Each file of `fixtures` by its name.
macro_rules! fixtures {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_bytes!(concat!("../../../fixtures/", $name)).as_slice())),*]
    };
}

/// Small recordings that another program simulated.
const OWN: [(&str, &[u8]); 23] = fixtures![
    "reference.toml",
    "anf10-plain.csv",
    "anf10-plain.toml",
    "anf10-protobuf.mcap",
    "anf10-protobuf.toml",
    "anf18-german.csv",
    "anf18-german.toml",
    "anf18-json.mcap",
    "anf18-json.toml",
    "damaged-clipped.h5",
    "damaged-clipped.toml",
    "damaged-ends-early.csv",
    "damaged-ends-early.toml",
    "damaged-gap.mcap",
    "damaged-gap.toml",
    "damaged-truncated.mcap",
    "damaged-truncated.toml",
    "damaged-zero-shift.h5",
    "damaged-zero-shift.toml",
    "esbb-imu.mcap",
    "esbb-imu.toml",
    "vhlw-rest.h5",
    "vhlw-rest.toml",
];

/// What is expected of a recording, as `reference.toml` says it.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Expected {
    cask: Option<PathBuf>,
    verdict: Option<String>,
    /// Codes that must be named.
    #[serde(default)]
    findings: Vec<String>,
    impact_velocity_m_s: Option<ExpectedValue>,
    k: Option<ExpectedValue>,
    angular_velocity_rad_s: Option<ExpectedValue>,
    flight_time_s: Option<ExpectedValue>,
    slap_down_speed_m_s: Option<ExpectedValue>,
    predicted_speed_m_s: Option<ExpectedValue>,
}

/// A value that the stated interval must hold, or one with a distance of its own.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
enum ExpectedValue {
    Held(f64),
    Near { value: f64, within: f64 },
}

/// Recordings of a folder, with what is expected of each.
#[derive(Debug, Clone)]
pub struct References {
    folder: PathBuf,
    expected: BTreeMap<PathBuf, Expected>,
}

/// Why a folder of reference recordings cannot be used.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ReferenceError {
    /// `reference.toml` is not to be read.
    #[error("{path} cannot be read: {problem}")]
    #[diagnostic(help("name with --reference a folder that holds {NAME} and the recordings that it names"))]
    Unreadable { path: String, problem: String },
    /// It says what nobody knows.
    #[error("{path}: {problem}")]
    #[diagnostic(help(
        "a table a recording: [\"drop7.mcap\"], in it cask = \"drop7.toml\", verdict = \"pass\", findings = [\"clipped\"], \
         k = 0.51 or k = {{ value = 0.51, within = 0.02 }}, slap_down_speed_m_s, angular_velocity_rad_s, flight_time_s, \
         impact_velocity_m_s, predicted_speed_m_s"
    ))]
    Wrong { path: String, problem: String },
}

impl References {
    /// Those of a folder.
    ///
    /// # Errors
    /// No `reference.toml`, one that says what nobody knows, a recording or cask file that is not there.
    pub fn of(folder: &Path) -> Result<Self, ReferenceError> {
        let path = folder.join(NAME);
        let shown = path.display().to_string();
        let unreadable = |error: std::io::Error| ReferenceError::Unreadable {
            path: shown.clone(),
            problem: error.to_string(),
        };
        let wrong = |problem: String| ReferenceError::Wrong { path: shown.clone(), problem };
        let text = std::fs::read_to_string(&path).map_err(unreadable)?;
        let expected: BTreeMap<PathBuf, Expected> =
            toml::from_str(&text).map_err(|error| wrong(error.to_string().trim_end().to_owned()))?;
        if expected.is_empty() {
            return Err(wrong("no recording is named".to_owned()));
        }
        let references = Self { folder: folder.to_owned(), expected };
        for (name, expected) in &references.expected {
            let missing =
                [name.clone(), cask_of(name, expected)].into_iter().find(|file| !folder.join(file).is_file());
            if let Some(file) = missing {
                return Err(wrong(format!("[{:?}]: there is no file {}", name.display(), file.display())));
            }
        }
        Ok(references)
    }

    /// Every expected value beside what was found, in the order of the recordings.
    pub(super) fn limits(&self) -> Vec<TrialLimit> {
        self.expected.iter().flat_map(|(name, expected)| self.of_recording(name, expected)).collect()
    }

    fn of_recording(&self, name: &Path, expected: &Expected) -> Vec<TrialLimit> {
        let file =
            ingest::cask_file(&self.folder.join(cask_of(name, expected))).map_err(|error| error.to_string());
        let analyzed = file.and_then(|file| {
            let recording = ingest::read(&self.folder.join(name), &file, &|_| ());
            Ok(analyze(&recording.map_err(|error| error.to_string())?, &file).result)
        });
        let mut limits = vec![words(name, expected, analyzed.as_ref())];
        for (quantity, expected, stated, unit) in quantities(expected) {
            let Some(expected) = expected else { continue };
            let found = analyzed.as_ref().ok().and_then(stated);
            let (value, within) = match expected {
                ExpectedValue::Held(value) => (value, found.map_or(f64::NAN, |found| found.u95)),
                ExpectedValue::Near { value, within } => (value, within),
            };
            limits.push(TrialLimit {
                name: format!("{}: {quantity}", name.display()),
                unit: unit.to_owned(),
                value: found.map(|found| found.value),
                least: Some(value - within),
                most: Some(value + within),
                reason: format!("expected: {value}"),
                which: String::new(),
            });
        }
        limits
    }
}

/// What the cask file of a recording is called.
fn cask_of(name: &Path, expected: &Expected) -> PathBuf {
    expected.cask.clone().unwrap_or_else(|| name.with_extension("toml"))
}

type Stated = fn(&DropResult) -> Option<Estimate>;

/// A quantity by its name, as it is expected and as it is stated.
fn quantities(of: &Expected) -> [(&'static str, Option<ExpectedValue>, Stated, &'static str); 6] {
    let predicted: Stated = |r| {
        let comparison = r.comparison.as_ref()?;
        Some(Estimate::new(comparison.predicted, comparison.predicted_u95, "m/s"))
    };
    [
        ("impact_velocity_m_s", of.impact_velocity_m_s, |r| r.first_impact.impact_velocity, "m/s"),
        ("k", of.k, |r| r.k, "1"),
        ("angular_velocity_rad_s", of.angular_velocity_rad_s, |r| r.first_impact.angular_velocity, "rad/s"),
        ("flight_time_s", of.flight_time_s, |r| r.slap_down.flight_time, "s"),
        ("slap_down_speed_m_s", of.slap_down_speed_m_s, |r| r.slap_down.speed, "m/s"),
        ("predicted_speed_m_s", of.predicted_speed_m_s, predicted, "m/s"),
    ]
}

/// Verdict and findings, or why the recording is refused.
fn words(name: &Path, expected: &Expected, analyzed: Result<&DropResult, &String>) -> TrialLimit {
    let mut differs = Vec::new();
    match analyzed {
        Err(problem) => differs.push(problem.clone()),
        Ok(result) => {
            let verdict = written(result.verdict);
            if expected.verdict.as_ref().is_some_and(|expected| *expected != verdict) {
                differs.push(format!("the verdict is {verdict}"));
            }
            let is_named =
                |code: &String| result.quality.iter().any(|finding| written(finding.code) == *code);
            let unnamed = expected.findings.iter().filter(|code| !is_named(code));
            differs.extend(unnamed.map(|code| format!("{code} is not named")));
        }
    }
    let verdict = expected.verdict.iter().map(|verdict| format!("verdict {verdict}"));
    let wanted: Vec<String> = verdict.chain(expected.findings.iter().cloned()).collect();
    TrialLimit {
        name: format!("{}: words", name.display()),
        unit: "that differ".to_owned(),
        value: u32::try_from(differs.len()).ok().map(f64::from),
        least: None,
        most: Some(0.0),
        reason: if wanted.is_empty() {
            "to be analysed".to_owned()
        } else {
            format!("expected: {}", wanted.join(", "))
        },
        which: differs.join("; "),
    }
}

/// How many expected values of the program's own recordings are not given.
pub(super) fn own() -> Option<Vec<TrialLimit>> {
    let folder = tempfile::tempdir().ok()?;
    for (name, bytes) in OWN {
        std::fs::write(folder.path().join(name), bytes).ok()?;
    }
    Some(References::of(folder.path()).ok()?.limits())
}
