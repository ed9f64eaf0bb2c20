//! Methods under trial: what each costs and how far off it is, and where the program fails.

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
    #[must_use]
    pub fn either<T>(&self, quick: T, full: T) -> T {
        if self.quick { quick } else { full }
    }
}

/// One method on one class of scenes: its error against the truth beside its time.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TrialPoint {
    /// What the method is for: "filter", "integration".
    pub family: String,
    /// The method, by its public name.
    pub method: String,
    /// The class of scenes.
    pub class: String,
    /// Whether it is what the program takes where nothing is said.
    pub is_default: bool,
    /// Whether no other of its class beats it.
    pub is_on_front: bool,
    /// Median error against the truth, in `error_unit`.
    pub median_error: f64,
    /// 95th percentile of the error, in `error_unit`.
    pub p95_error: f64,
    /// Of what the error is a share, or its unit: "of the peak", "%".
    pub error_unit: String,
    /// Median time of a `time_per`, ns.
    pub time_ns: f64,
    /// Quartiles of that time over the repeats, ns.
    pub time_quartiles_ns: [f64; 2],
    /// What the time is of: "sample", "call".
    pub time_per: String,
    /// Cases the error is taken over.
    pub cases: u32,
}

/// What several drops show that a damage of one size is done to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrialSize {
    /// The size, in the map's unit.
    pub size: f64,
    /// Median error of the drops; none where fewer than half of them give a number.
    pub median_error: Option<f64>,
    /// The largest error of a drop; none where no drop gives a number.
    pub worst_error: Option<f64>,
    /// Whether the program says of every drop beyond the limit that something is wrong, or widened its interval to hold the truth; where none
    /// is, of every drop.
    pub is_noticed: bool,
}

/// How an error of the program grows with a damage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrialMap {
    /// The damage and, but for the speed, the quantity: "skew-k".
    pub name: String,
    /// A sentence: what is done.
    pub what: String,
    /// Unit of the sizes.
    pub unit: String,
    /// What the error is, with its unit.
    pub error: String,
    /// Error above which the program has failed, in the error's unit.
    pub limit: f64,
    /// From harmless to gross.
    pub sizes: Vec<TrialSize>,
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
    /// Whether the program was built with optimisation; without it times say nothing.
    pub is_optimised: bool,
}

/// A whole trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    /// "dropcheck.validation/2".
    pub schema: &'static str,
    /// The program's version.
    pub version: &'static str,
    /// What was asked for.
    pub request: TrialRequest,
    /// What it ran on.
    pub machine: TrialMachine,
    /// Methods on classes, family after family.
    pub points: Vec<TrialPoint>,
    /// Where the program fails.
    pub maps: Vec<TrialMap>,
}
