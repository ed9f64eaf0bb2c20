//! The ladder of analytical models: its rungs, what each says, and how the speed answers to k and angle.

use super::cask::{Contact, Drop};
use super::prediction::Prediction;
use serde::Serialize;

/// The models, simplest first; each adds one thing to the one below and agrees with it where that thing is
/// absent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Rung {
    /// The thin uniform rod of the paper: Table 1, one flight for k > 0, the closed form of Table 2 for k =
    /// 0.
    Rod,
    /// Section, centre of gravity and inertia of the body.
    Body,
    /// Coulomb friction between smooth and rough: L sticks or slides.
    Friction,
    /// The target only pushes: for k = 0 L lifts off where the contact would need a pull.
    Unilateral,
    /// L's further impacts before R strikes.
    FurtherImpacts,
    /// L's first impact takes its time: the body turns and falls while the target pushes.
    FinitePulse,
}

impl Rung {
    /// All, simplest first.
    pub const ALL: [Self; 6] =
        [Self::Rod, Self::Body, Self::Friction, Self::Unilateral, Self::FurtherImpacts, Self::FinitePulse];

    /// Those that have something to say of a drop: the last one needs the length of the contact.
    pub fn of(drop: &Drop) -> impl Iterator<Item = Self> {
        let is_timed = drop.contact_duration_s > 0.0;
        Self::ALL.into_iter().filter(move |rung| is_timed || *rung != Self::FinitePulse)
    }

    /// Whether the speeds by a rung and by a richer one are the same, within the tolerance of the ladder.
    pub fn say_the_same(speed: Option<f64>, richer: Option<f64>) -> bool {
        match (speed, richer) {
            (Some(own), Some(richer)) => (richer - own).abs() <= LADDER_TOLERANCE_PERCENT / 100.0 * own,
            (None, None) => true,
            _ => false,
        }
    }

    /// Its name for a person.
    pub fn words(self) -> &'static str {
        match self {
            Self::Rod => "rod",
            Self::Body => "body",
            Self::Friction => "body with friction",
            Self::Unilateral => "body, unilateral contact",
            Self::FurtherImpacts => "body, further impacts",
            Self::FinitePulse => "body, finite pulse",
        }
    }

    /// What it adds to the rung below, for a person.
    pub fn adds(self) -> &'static str {
        match self {
            Self::Rod => "thin uniform rod, rough or smooth",
            Self::Body => "section, centre of gravity, inertia",
            Self::Friction => "Coulomb friction: L sticks or slides",
            Self::Unilateral => "the target only pushes: L may lift off",
            Self::FurtherImpacts => "L may strike again before R",
            Self::FinitePulse => "L's first impact takes its time",
        }
    }
}

/// One rung's prediction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LadderStep {
    /// Which rung.
    pub rung: Rung,
    /// What it adds to the one below.
    pub adds: &'static str,
    /// What it predicts.
    #[serde(flatten)]
    pub prediction: Prediction,
    /// Change of the slap-down speed against the rung below, percent; `None` for the first and where either
    /// has no slap-down.
    pub change_percent: Option<f64>,
}

/// All rungs for one contact law and one k, and the simplest that the richer ones do not change.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ladder {
    /// Inclination at first contact, degrees.
    pub angle_deg: f64,
    /// The contact law asked for.
    pub contact: Contact,
    /// Coefficient of restitution.
    pub k: f64,
    /// Simplest first.
    pub steps: Vec<LadderStep>,
    /// The simplest rung that no richer one moves by more than [`LADDER_TOLERANCE_PERCENT`].
    pub suffices: Rung,
}

/// A rung suffices where no richer one moves the slap-down speed by more than this, percent: a tenth of the 1
/// % that a test resolves.
pub const LADDER_TOLERANCE_PERCENT: f64 = 0.1;
