//! Ways of working under trial: what each costs and how far off it is, and where the program fails.

use serde::Serialize;

/// What a trial is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct TrialRequest {
    /// Fewer scenes and repeats: within a minute.
    pub quick: bool,
    /// Seed of everything random.
    pub seed: u64,
}

impl TrialRequest {
    /// What the quick run takes, or the full one.
    pub fn either<T>(&self, quick: T, full: T) -> T {
        if self.quick { quick } else { full }
    }
}

/// One method on one class of scenes: its error against the truth beside its time.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TrialPoint {
    /// What the method is for: "k, from file to answer".
    pub family: String,
    /// The method, by its public name.
    pub method: String,
    /// The class of scenes.
    pub class: String,
    /// Whether it is what the program takes where nothing is said.
    pub is_default: bool,
    /// Median error against the truth, in `error_unit`.
    pub median_error: f64,
    /// 95th percentile of the error, in `error_unit`.
    pub p95_error: f64,
    /// Of what the error is a share, or its unit: "% of the slap-down speed".
    pub error_unit: String,
    /// Median time from file to answer, ns.
    pub time_ns: f64,
    /// Cases the error is taken over.
    pub cases: usize,
    /// Cases besides in which the method gives no number.
    pub missing: usize,
    /// From where on a difference matters, in `error_unit`.
    pub matters: f64,
    /// The median half-width that the method states of itself, in `error_unit`.
    pub promised: Option<f64>,
    /// The share of its intervals that hold the truth.
    pub held: Option<f64>,
}

/// What becomes of a drop that a damage is done to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum TrialFate {
    /// The intervals of speed and k hold the truth, or miss it by no more than chance does.
    Inside,
    /// One of them does not, and the verdict is not "pass".
    Warned,
    /// A number is not given.
    Refused,
    /// An interval does not hold the truth, further than chance puts it, and the verdict is "pass".
    Silent,
}

/// A drop that a damage of one size is done to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrialDrop {
    /// What becomes of it.
    pub fate: TrialFate,
    /// The larger error of speed and k, in half-widths of its interval; none where neither is given.
    pub half_widths_off: Option<f64>,
    /// Whether a finding names what is wrong by one of the codes that should.
    pub is_named: bool,
    /// Whether the body is an elastic beam.
    pub is_elastic: bool,
}

/// What several drops show that a damage of one size is done to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrialSize {
    /// The size, in the map's unit.
    pub size: f64,
    /// The same drops at every size.
    pub drops: Vec<TrialDrop>,
}

/// What becomes of drops as a damage grows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrialMap {
    /// The damage, as in the table of damages.
    pub name: String,
    /// A sentence: what is done.
    pub what: String,
    /// Unit of the sizes.
    pub unit: String,
    /// Codes of which one must be named at the gross end.
    pub told_by: Vec<&'static str>,
    /// What to measure at the site, because the recording may not tell.
    pub instead: String,
    /// From harmless to gross.
    pub sizes: Vec<TrialSize>,
    /// What the recorded full run found of a damage that it saw silent; none in a full run.
    pub known: Option<KnownSilence>,
}

/// A row of `silent.tsv`: a damage that was silent in the recorded full run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct KnownSilence {
    /// From which size on what becomes of a drop.
    pub becomes: &'static str,
    /// The largest error, in half-widths.
    pub off: &'static str,
}

impl TrialMap {
    /// Whether some drop of this run was silent.
    pub fn is_seen_silent(&self) -> bool {
        self.first(TrialFate::Silent).is_some()
    }

    /// The first size at which this becomes of a drop.
    pub fn first(&self, fate: TrialFate) -> Option<&TrialSize> {
        self.sizes.iter().find(|size| size.drops.iter().any(|drop| drop.fate == fate))
    }

    /// The drops at the gross end of which no finding names what is wrong.
    pub fn unnamed(&self) -> usize {
        self.sizes.last().map_or(0, |size| size.drops.iter().filter(|drop| !drop.is_named).count())
    }
}

/// One limit of the acceptance, and what this program on this machine makes of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TrialLimit {
    /// What is measured.
    pub name: String,
    /// What it is: "95th percentile of the error, %".
    pub unit: String,
    /// What was found; none where it could not be had, which is not accepted.
    pub value: Option<f64>,
    /// The least that is accepted.
    pub least: Option<f64>,
    /// The most that is accepted.
    pub most: Option<f64>,
    /// Why this much.
    pub reason: String,
    /// Which of several did not hold, or was the furthest off; empty where they did.
    pub which: String,
}

impl TrialLimit {
    /// Whether what was found lies within.
    pub fn is_kept(&self) -> bool {
        let within =
            |v: f64| self.least.is_none_or(|least| v >= least) && self.most.is_none_or(|most| v <= most);
        self.value.is_some_and(within)
    }

    /// How far what was found lies from the middle, in halves of what is accepted; none where it was not
    /// found.
    pub fn half_widths_off(&self) -> Option<f64> {
        let (least, most) = (self.least?, self.most?);
        Some((2.0 * self.value? - least - most).abs() / (most - least))
    }
}

/// What a trial ran on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TrialMachine {
    /// The processor, as it calls itself.
    pub processor: String,
    /// Threads that run at once.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
    /// SHA-256 of the program's file; empty where it cannot be read.
    pub program_sha256: String,
    /// The commit that it was built of, where the build was told.
    pub program_commit: Option<&'static str>,
    /// When the trial began, in universal time.
    pub when: String,
    /// Whether the program was built with optimisation; without it times say nothing.
    pub is_optimised: bool,
}

/// A whole trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    /// "dropcheck.validation/3".
    pub schema: &'static str,
    /// The program's version.
    pub version: &'static str,
    /// What was asked for.
    pub request: TrialRequest,
    /// What it ran on.
    pub machine: TrialMachine,
    /// Methods on classes, family after family.
    pub points: Vec<TrialPoint>,
    /// What becomes of drops as each damage grows.
    pub maps: Vec<TrialMap>,
    /// What is accepted, and what was found.
    pub limits: Vec<TrialLimit>,
}

impl Trial {
    /// Whether every limit is kept.
    pub fn is_accepted(&self) -> bool {
        self.limits.iter().all(TrialLimit::is_kept)
    }
}
