//! Results of a trial: time and error of each method, and the failures of the program.

use serde::Serialize;

/// Request for a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct TrialRequest {
    /// Fewer scenes and repeats: within a minute.
    pub quick: bool,
    /// Seed of everything random.
    pub seed: u64,
}

impl TrialRequest {
    /// Chooses the value for a quick or for a full run.
    pub fn choose<T>(&self, quick: T, full: T) -> T {
        if self.quick { quick } else { full }
    }
}

/// One method on one class of scenes: its error against the truth and its time.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TrialPoint {
    /// Task of the method: "k, from file to answer".
    pub family: String,
    /// Public name of the method.
    pub method: String,
    /// The class of scenes.
    pub class: String,
    /// True if the program uses this method by default.
    pub is_default: bool,
    /// Median error against the truth, in `error_unit`.
    pub median_error: f64,
    /// 95th percentile of the error, in `error_unit`.
    pub p95_error: f64,
    /// Reference of a relative error, or its unit: "% of the slap-down speed".
    pub error_unit: String,
    /// Median time from file to answer, ns.
    pub time_ns: f64,
    /// Number of cases behind the error.
    pub cases: usize,
    /// Further cases in which the method gives no number.
    pub missing: usize,
    /// Smallest difference that matters, in `error_unit`.
    pub matters: f64,
    /// Median half-width that the method itself states, in `error_unit`.
    pub promised: Option<f64>,
    /// Share of its intervals that hold the truth.
    pub held: Option<f64>,
}

/// Fate of a drop with damage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum TrialFate {
    /// The intervals of speed and k hold the truth, or miss it by no more than chance does.
    Inside,
    /// One of the intervals misses the truth, and the verdict is not "pass".
    Warned,
    /// A number is not given.
    Refused,
    /// An interval misses the truth, further than by chance, and the verdict is "pass".
    Silent,
}

/// A drop with a damage of one size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrialDrop {
    /// Fate of the drop.
    pub fate: TrialFate,
    /// The larger error of speed and k, in half-widths of its interval; `None` if neither is stated.
    pub half_widths_off: Option<f64>,
    /// True if a finding names the damage by one of the expected codes.
    pub is_named: bool,
    /// True if the body is an elastic beam.
    pub is_elastic: bool,
}

/// Results of several drops with a damage of one size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrialSize {
    /// The size, in the map's unit.
    pub size: f64,
    /// Drops, the same at every size.
    pub drops: Vec<TrialDrop>,
}

/// Fate of drops as a damage grows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrialMap {
    /// Name of the damage, as in the table of damages.
    pub name: String,
    /// A sentence on the damage.
    pub what: String,
    /// Unit of the sizes.
    pub unit: String,
    /// Codes of which one must be named at the gross end.
    pub told_by: Vec<&'static str>,
    /// Measurement at the site, because the recording may not show the damage.
    pub instead: String,
    /// Sizes from harmless to gross.
    pub sizes: Vec<TrialSize>,
    /// Result of the recorded full run for a damage that it saw silent; none in a full run.
    pub known: Option<KnownSilence>,
}

/// A row of `silent.tsv`: a damage that was silent in the recorded full run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct KnownSilence {
    /// Heading for the sizes and fates of drops.
    pub becomes: &'static str,
    /// The largest error, in half-widths.
    pub off: &'static str,
}

impl TrialMap {
    /// True if a drop of this run was silent.
    pub fn has_silent_drop(&self) -> bool {
        self.first(TrialFate::Silent).is_some()
    }

    /// The first size at which a drop has this fate.
    pub fn first(&self, fate: TrialFate) -> Option<&TrialSize> {
        self.sizes.iter().find(|size| size.drops.iter().any(|drop| drop.fate == fate))
    }

    /// Counts the drops at the gross end whose findings do not name the damage.
    pub fn count_unnamed(&self) -> usize {
        self.sizes.last().map_or(0, |size| size.drops.iter().filter(|drop| !drop.is_named).count())
    }
}

/// One limit of the acceptance, and the value that this program reaches on this machine.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TrialLimit {
    /// Measured property.
    pub name: String,
    /// Unit: "95th percentile of the error, %".
    pub unit: String,
    /// Measured value; `None` if it could not be determined, which is not accepted.
    pub value: Option<f64>,
    /// The least that is accepted.
    pub least: Option<f64>,
    /// The most that is accepted.
    pub most: Option<f64>,
    /// Why this much.
    pub reason: String,
    /// Item that failed or was furthest off; empty if all hold.
    pub which: String,
}

impl TrialLimit {
    /// True if the value lies within the limits.
    pub fn is_met(&self) -> bool {
        let within =
            |v: f64| self.least.is_none_or(|least| v >= least) && self.most.is_none_or(|most| v <= most);
        self.value.is_some_and(within)
    }

    /// Distance of the value from the middle of the accepted range, in half-widths of the range; `None`
    /// without a value.
    pub fn half_widths_off(&self) -> Option<f64> {
        let (least, most) = (self.least?, self.most?);
        Some((2.0 * self.value? - least - most).abs() / (most - least))
    }
}

/// Machine and program of a trial.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TrialMachine {
    /// The processor, as it calls itself.
    pub processor: String,
    /// Threads that run at once.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
    /// SHA-256 of the program's file; empty if it cannot be read.
    pub program_sha256: String,
    /// Commit that the program was built from, if the build knew it.
    pub program_commit: Option<&'static str>,
    /// Beginning of the trial, in universal time.
    pub when: String,
    /// True if the program was built with optimisation; without it the times are meaningless.
    pub is_optimised: bool,
}

/// A whole trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    /// "dropcheck.validation/3".
    pub schema: &'static str,
    /// The program's version.
    pub version: &'static str,
    /// Request for the trial.
    pub request: TrialRequest,
    /// Machine and program.
    pub machine: TrialMachine,
    /// Methods on classes, family after family.
    pub points: Vec<TrialPoint>,
    /// Fate of drops as each damage grows.
    pub maps: Vec<TrialMap>,
    /// Limits of the acceptance with the measured values.
    pub limits: Vec<TrialLimit>,
}

impl Trial {
    /// True if every limit is met.
    pub fn is_accepted(&self) -> bool {
        self.limits.iter().all(TrialLimit::is_met)
    }
}
