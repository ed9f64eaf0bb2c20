//! Methods under trial: what each costs and how far off it is, and where it fails.

use serde::{Deserialize, Serialize};

/// What a trial is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialRequest {
    /// Fewer scenes and repeats: within a minute.
    pub quick: bool,
    /// Seed of everything random.
    pub seed: u64,
}

/// One method on one class of scenes: its error against the truth beside its time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrialPoint {
    /// What the method is for: "filter", "integration".
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

impl TrialPoint {
    /// Whether the method is a program of others.
    #[must_use]
    pub fn is_peer(&self) -> bool {
        self.method.starts_with("scipy ")
    }
}

/// One method along a rising stress.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrialLine {
    /// The method, or the class of scenes where the method is the whole analysis.
    pub method: String,
    /// Error at each stress, in the map's unit; none where no number was given.
    pub errors: Vec<Option<f64>>,
    /// Whether the program said that something is wrong, or widened its interval to hold the truth; none where it has no way to.
    pub noticed: Vec<Option<bool>>,
}

/// How a method's error grows with what makes it fail.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrialMap {
    /// A name for files: "cutoff-over-rate".
    pub name: String,
    /// A sentence: what is shown.
    pub title: String,
    /// The stress with its unit: "cut-off over sample rate".
    pub stress: String,
    /// Whether the stress axis is logarithmic.
    pub is_log: bool,
    /// The stresses.
    pub stresses: Vec<f64>,
    /// What the error is, with its unit.
    pub error: String,
    /// Error above which a method has failed: 1 % mostly, in the error's unit.
    pub limit: f64,
    /// A line for each method.
    pub lines: Vec<TrialLine>,
}

/// What one part of the trial found.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TrialPart {
    /// Points of the speed-accuracy charts.
    pub points: Vec<TrialPoint>,
    /// Failure maps.
    pub maps: Vec<TrialMap>,
}

/// Work that programs of others are given too: the same samples, held against the same truth.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialPeerWork {
    /// What the method is for: "filter", "integration".
    pub family: &'static str,
    /// The class of scenes.
    pub class: String,
    /// Order of one pass and design frequency over sample rate of a low-pass; none for an integral over unit length.
    pub low_pass: Option<(u32, f64)>,
    /// Sample rate, Hz, and impact velocity, m/s, of a drop: its second end's transverse force, m/s², is worked on, to its slap-down speed.
    pub drop: Option<(f64, f64)>,
    /// What is worked on.
    pub samples: Vec<f64>,
    /// What should come of it: as many samples, or the slap-down speed of a drop, m/s.
    pub truth: Vec<f64>,
    /// Of what the error is a share.
    pub error_unit: &'static str,
}

/// What a trial ran on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// "dropcheck.validation/1".
    pub schema: String,
    /// The program's version.
    pub version: String,
    /// What was asked for.
    pub request: TrialRequest,
    /// What it ran on.
    pub machine: TrialMachine,
    /// A sentence on programs of others that were tried beside.
    pub peers: String,
    /// Points of the speed-accuracy charts.
    pub points: Vec<TrialPoint>,
    /// For each point whether no other of its class beats it.
    pub is_on_front: Vec<bool>,
    /// Failure maps.
    pub maps: Vec<TrialMap>,
}

/// A part of the trial that runs, and is kept, by itself.
#[derive(Clone, Copy)]
pub struct TrialJob {
    /// A name for files and progress: "filters".
    pub name: &'static str,
    /// About how long it takes against the others.
    pub weight: f64,
    /// Does it; the second argument is told the share that is done.
    pub run: fn(&TrialRequest, &dyn Fn(f64)) -> TrialPart,
}
