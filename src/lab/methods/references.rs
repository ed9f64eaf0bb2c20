//! Recordings with expected values, the program's own and a site's, and the results of the program for each.

use crate::analysis::{self, analyze};
use crate::data::{DropResult, Estimate};
use crate::ingest;
use crate::ingest::cask_file::section::Kind;
use crate::ingest::cask_file::{self, CaskFileError, no_cask_file};
use crate::lab::data::TrialLimit;
use crate::report::text::json_word;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of the file that describes a folder of reference recordings.
const NAME: &str = "reference.toml";

/// Recordings of a folder of the fixtures and their cask files by their names, and its `reference.toml`.
macro_rules! fixtures {
    ($folder:literal, $($stem:literal $ending:literal),*) => {
        &[
            $((concat!($stem, $ending), include_bytes!(concat!("../../../fixtures/", $folder, "/", $stem,
                $ending)).as_slice()),
            (concat!($stem, ".toml"), include_bytes!(concat!("../../../fixtures/", $folder, "/", $stem,
                ".toml")).as_slice()),)*
            (NAME, include_bytes!(concat!("../../../fixtures/", $folder, "/reference.toml")).as_slice()),
        ]
    };
}

/// Small files by their names.
type Files = &'static [(&'static str, &'static [u8])];

/// Small recordings that another program simulated, with expected values.
pub(super) const OWN: Files = fixtures![
    "examples", "anf10-plain" ".csv", "anf10-protobuf" ".mcap", "anf18-german" ".csv", "anf18-json" ".mcap",
    "damaged-clipped" ".h5", "damaged-ends-early" ".csv", "damaged-gap" ".mcap", "damaged-truncated" ".mcap",
    "damaged-zero-shift" ".h5", "esbb-imu" ".mcap", "vhlw-rest" ".h5"
];

/// Drops of elastic bars by finite elements, and their truth.
pub(super) const FINITE_ELEMENTS: Files = fixtures![
    "reference/fe", "bare-5" ".h5", "pads-8" ".h5", "pads-12" ".h5", "bare-15" ".h5", "friction-20" ".h5",
    "friction-30" ".h5", "landing-44" ".h5"
];

/// Declares the quantities that a reference may state, with their place in the result.
macro_rules! expected {
    ($($quantity:ident => $found:expr,)*) => {
        /// Expected values of a recording in `reference.toml`.
        #[derive(Debug, Clone, Default, Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Expected {
            cask: Option<PathBuf>,
            verdict: Option<String>,
            /// Codes that must be named.
            #[serde(default)]
            findings: Vec<String>,
            $($quantity: Option<ExpectedValue>,)*
        }

        /// Form of `reference.toml`.
        const FORM: &str = concat!("a table a recording: [\"drop7.mcap\"], in it cask = \"drop7.toml\", \
            verdict = \"pass\", findings = [\"clipped\"], k = 0.51 or k = { value = 0.51, within = 0.02 }",
            $(", ", stringify!($quantity),)*);

        impl Expected {
            /// Lists each expected value, by its quantity, with the measured one.
            fn limits(&self, result: Option<&DropResult>) -> Vec<TrialLimit> {
                fn value(of: fn(&DropResult) -> Option<Estimate>, result: &DropResult) -> Option<Estimate> {
                    of(result)
                }
                [$((stringify!($quantity), self.$quantity, result.and_then(|r| value($found, r)))),*]
                    .into_iter()
                    .filter_map(|(quantity, expected, found)| Some(expected?.limit(quantity, found)))
                    .collect()
            }
        }
    };
}

expected! {
    impact_velocity_m_s => |r| r.first_impact.impact_velocity,
    k => |r| r.k,
    angular_velocity_rad_s => |r| r.first_impact.angular_velocity,
    flight_time_s => |r| r.slap_down.flight_time,
    slap_down_speed_m_s => |r| r.slap_down.speed,
    predicted_speed_m_s => |r| {
        r.comparison.as_ref().map(|c| Estimate::new(c.predicted, c.predicted_u95, "m/s"))
    },
    horizontal_velocity_m_s => |r| r.slap_down.horizontal_velocity,
    local_speed_m_s => |r| r.slap_down.local_speed,
    first_impulse_x_n_s => |r| r.impacts[0].numbers.impulse_x,
    first_impulse_z_n_s => |r| r.impacts[0].numbers.impulse_z,
    second_impulse_x_n_s => |r| r.impacts[1].numbers.impulse_x,
    second_impulse_z_n_s => |r| r.impacts[1].numbers.impulse_z,
    second_restitution => |r| r.impacts[1].numbers.restitution,
}

/// A value that the stated interval must hold, or one with its own tolerance.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
enum ExpectedValue {
    Held(f64),
    Near { value: f64, within: f64 },
}

impl ExpectedValue {
    fn limit(self, quantity: &str, found: Option<Estimate>) -> TrialLimit {
        let (value, within) = match self {
            Self::Held(value) => (value, found.map_or(f64::NAN, |found| found.u95)),
            Self::Near { value, within } => (value, within),
        };
        TrialLimit {
            name: quantity.to_owned(),
            unit: found.map_or_else(String::new, |found| found.unit.to_owned()),
            value: found.map(|found| found.value),
            least: Some(value - within),
            most: Some(value + within),
            reason: format!("expected: {value}"),
            ..TrialLimit::default()
        }
    }
}

/// Recordings of a folder, with the expected values of each.
#[derive(Debug, Clone)]
pub struct References {
    folder: PathBuf,
    expected: BTreeMap<PathBuf, Expected>,
}

impl References {
    /// Reads the reference recordings of a folder.
    ///
    /// # Errors
    ///
    /// Returned without a `reference.toml`, for one with an unknown key, and if a recording or cask file is
    /// missing.
    pub fn read(folder: &Path) -> Result<Self, CaskFileError> {
        let path = folder.join(NAME);
        let wrong = |problem: String| no_cask_file(&path, &problem, FORM);
        let bytes = cask_file::read(&path, &Kind { name: "a reference file", root: &[], tables: &[] })?;
        let text = String::from_utf8(bytes).map_err(|_| wrong("this is not UTF-8 text".to_owned()))?;
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

    /// Compares every expected value with the result, in the order of the recordings.
    pub(super) fn limits(&self) -> Vec<TrialLimit> {
        self.expected.iter().flat_map(|(name, expected)| self.check_recording(name, expected)).collect()
    }

    fn check_recording(&self, name: &Path, expected: &Expected) -> Vec<TrialLimit> {
        let file =
            ingest::cask_file(&self.folder.join(cask_of(name, expected))).map_err(|error| error.to_string());
        let analyzed = file.and_then(|file| {
            let recording = analysis::read(&self.folder.join(name), &file, &|_| ());
            Ok(analyze(&recording.map_err(|error| error.to_string())?, &file).result)
        });
        let mut limits = vec![words(expected, analyzed.as_ref())];
        limits.extend(expected.limits(analyzed.as_ref().ok()));
        for limit in &mut limits {
            limit.name = format!("{}: {}", name.display(), limit.name);
        }
        limits
    }
}

/// Path of the cask file of a recording.
fn cask_of(name: &Path, expected: &Expected) -> PathBuf {
    expected.cask.clone().unwrap_or_else(|| name.with_extension("toml"))
}

/// Verdict and findings, or the reason why the recording is refused.
fn words(expected: &Expected, analyzed: Result<&DropResult, &String>) -> TrialLimit {
    let mut differs = Vec::new();
    match analyzed {
        Err(problem) => differs.push(problem.clone()),
        Ok(result) => {
            let verdict = json_word(result.verdict);
            if expected.verdict.as_ref().is_some_and(|expected| *expected != verdict) {
                differs.push(format!("the verdict is {verdict}"));
            }
            let is_named =
                |code: &String| result.quality.iter().any(|finding| json_word(finding.code) == *code);
            let unnamed = expected.findings.iter().filter(|code| !is_named(code));
            differs.extend(unnamed.map(|code| format!("{code} is not named")));
        }
    }
    let verdict = expected.verdict.iter().map(|verdict| format!("verdict {verdict}"));
    let wanted: Vec<String> = verdict.chain(expected.findings.iter().cloned()).collect();
    TrialLimit {
        name: "words".to_owned(),
        unit: "that differ".to_owned(),
        value: u32::try_from(differs.len()).ok().map(f64::from),
        most: Some(0.0),
        reason: if wanted.is_empty() {
            "to be analysed".to_owned()
        } else {
            format!("expected: {}", wanted.join(", "))
        },
        which: differs.join("; "),
        ..TrialLimit::default()
    }
}

/// Every expected value of recordings that the program has built in.
pub(super) fn built_in(files: Files) -> Option<Vec<TrialLimit>> {
    let folder = tempfile::tempdir().ok()?;
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).ok()?;
    }
    Some(References::read(folder.path()).ok()?.limits())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes a folder with one recording of the fixtures and this `reference.toml`, and reads it.
    fn folder(reference: &str) -> Result<Vec<TrialLimit>, String> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in ["anf10-plain.csv", "anf10-plain.toml"] {
            let bytes = OWN.iter().find(|file| file.0 == name).expect("of our own").1;
            std::fs::write(folder.path().join(name), bytes).expect("written");
        }
        std::fs::write(folder.path().join(NAME), reference).expect("written");
        References::read(folder.path()).map(|found| found.limits()).map_err(|error| error.to_string())
    }

    #[test]
    fn expected_values_are_held_against_the_interval_or_their_own_distance() {
        let kept = |text: &str| {
            let limits = folder(&format!("[\"anf10-plain.csv\"]\n{text}")).expect("a folder");
            limits.iter().map(TrialLimit::is_met).collect::<Vec<_>>()
        };
        // The truth of simulate.py is 13.991 m/s and 0.5073.
        assert_eq!(kept("verdict = \"pass\"\nslap_down_speed_m_s = 13.99\nk = 0.507"), [true; 3]);
        assert_eq!(kept("k = 0.6"), [true, false]);
        assert_eq!(kept("k = { value = 0.6, within = 0.2 }"), [true, true]);
        assert_eq!(kept("verdict = \"fail\""), [false]);
        assert_eq!(kept("findings = [\"clipped\"]"), [false]);
    }

    #[test]
    fn what_nobody_knows_is_refused_with_its_place() {
        for (text, word) in [
            ("", "no recording"),
            ("[\"anf10-plain.csv\"]\nspeed = 3", "line 2"),
            ("[\"anf10-plain.csv\"]\nk = \"half\"", "line 2"),
            ("[\"drop.csv\"]", "no file drop.csv"),
            ("[\"anf10-plain.csv\"]\ncask = \"x.toml\"", "no file x.toml"),
        ] {
            let message = folder(text).expect_err(text);
            assert!(message.contains(word) && message.contains(NAME), "{message}");
        }
        assert!(References::read(Path::new("nowhere")).is_err());
    }

    #[test]
    fn our_own_are_whole() {
        for files in [OWN, FINITE_ELEMENTS] {
            let text = files.last().map(|(_, bytes)| String::from_utf8_lossy(bytes)).expect("reference.toml");
            let expected: BTreeMap<PathBuf, Expected> = toml::from_str(&text).expect("whole");
            assert_eq!(2 * expected.len() + 1, files.len());
        }
    }
}
