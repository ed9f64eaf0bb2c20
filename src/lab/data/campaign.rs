//! A campaign of random scenes with known truth: what is asked for, and a row for each scene.

use super::scene::{Scene, Truth};
use crate::data::{
    CaskFile, Estimate, IssueCode, ReconstructionCandidate, ReconstructionRung, Severity, Verdict,
};

/// Which scene of a campaign: with its seed it names the same drop for ever.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SceneNumber {
    /// Nothing is wrong with it: U0, U1 …
    Undamaged(u32),
    /// One thing is wrong with it, or it is of a sound kind: D0, D1 …
    Damaged(u32),
}

impl std::fmt::Display for SceneNumber {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Undamaged(number) => write!(f, "U{number}"),
            Self::Damaged(number) => write!(f, "D{number}"),
        }
    }
}

/// What a campaign is asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CampaignRequest {
    /// How many undamaged scenes, and how many of kinds.
    pub scenes: u32,
    /// Seed of everything random.
    pub seed: u64,
    /// Whether undamaged scenes are among them.
    pub undamaged: bool,
    /// The kinds, by name; none: undamaged scenes alone.
    pub kinds: Vec<&'static str>,
    /// Whether what is stated is exactly true.
    pub exact: bool,
}

/// What is wrong with a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damage {
    /// The kind, by name.
    pub kind: &'static str,
    /// How large, in `unit`.
    pub size: f64,
    /// Unit of the size; empty where a kind has one size only.
    pub unit: &'static str,
}

/// A measured quantity beside its truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scored {
    /// What it is: "speed".
    pub name: &'static str,
    /// As the analysis states it.
    pub stated: Option<Estimate>,
    /// As it was, in the same unit.
    pub truth: Option<f64>,
}

/// One scene of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignRow {
    /// Which.
    pub number: SceneNumber,
    /// What is wrong with it.
    pub damage: Option<Damage>,
    /// The scene as it was.
    pub scene: Scene,
    /// The cask file as it was stated.
    pub stated: CaskFile,
    /// What a perfect measurement would say.
    pub truth: Truth,
    /// The word of the analysis; none where the recording is refused.
    pub verdict: Option<Verdict>,
    /// Every finding.
    pub findings: Vec<(IssueCode, Severity)>,
    /// The quantities, in the same order in every row.
    pub quantities: Vec<Scored>,
    /// The rung of the reconstruction taken.
    pub rung: Option<ReconstructionRung>,
    /// What each rung says.
    pub candidates: Vec<ReconstructionCandidate>,
    /// By how many standard uncertainties each closure is missed.
    pub misses_u: Vec<f64>,
    /// How long the analysis took, s.
    pub analysis_s: f64,
}

/// A campaign, done.
#[derive(Debug, Clone, PartialEq)]
pub struct Campaign {
    /// What was asked for.
    pub request: CampaignRequest,
    /// The scenes, undamaged first, each in the order of their numbers.
    pub rows: Vec<CampaignRow>,
}
