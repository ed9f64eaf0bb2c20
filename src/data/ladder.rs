//! Analytical models of increasing detail, their predictions, and the dependence of the speed on k and angle.

use super::cask::{Contact, Drop};
use super::prediction::Prediction;
use serde::Serialize;

/// The models, simplest first; each adds one effect to the previous one and agrees with it if that effect is
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
    /// The target only pushes: for k = 0 L lifts off if the contact would need a pull.
    Unilateral,
    /// L's further impacts before R strikes.
    FurtherImpacts,
    /// L's first impact has a duration: the body turns and falls while the target pushes.
    FinitePulse,
}

impl Rung {
    /// All models, simplest first.
    pub const ALL: [Self; 6] =
        [Self::Rod, Self::Body, Self::Friction, Self::Unilateral, Self::FurtherImpacts, Self::FinitePulse];

    /// Models that apply to a drop: the last one needs the duration of the contact.
    pub fn for_drop(drop: &Drop) -> impl Iterator<Item = Self> {
        let is_timed = drop.contact_duration_s > 0.0;
        Self::ALL.into_iter().filter(move |rung| is_timed || *rung != Self::FinitePulse)
    }

    /// True if the speeds of a model and of a richer one are equal within the tolerance.
    pub fn agree(speed: Option<f64>, richer: Option<f64>) -> bool {
        match (speed, richer) {
            (Some(own), Some(richer)) => (richer - own).abs() <= LADDER_TOLERANCE_PERCENT / 100.0 * own,
            (None, None) => true,
            _ => false,
        }
    }

    /// Name for a reader.
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

    /// Physics that this model adds to the next simpler one, for a reader.
    pub fn physics(self) -> &'static str {
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

/// Prediction of one model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LadderStep {
    /// Model.
    pub rung: Rung,
    /// Physics that it adds to the next simpler model.
    pub adds: &'static str,
    /// Predicted values.
    #[serde(flatten)]
    pub prediction: Prediction,
    /// Change of the slap-down speed against the next simpler model, percent; `None` for the first and if
    /// either has no slap-down.
    pub change_percent: Option<f64>,
}

/// All models for one contact law and one k, and the simplest that the richer ones do not change.
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
    /// The simplest model that no richer one changes by more than [`LADDER_TOLERANCE_PERCENT`].
    pub suffices: Rung,
}

/// A model suffices if no richer one changes the slap-down speed by more than this, percent: a tenth of the 1
/// % that a test resolves.
pub const LADDER_TOLERANCE_PERCENT: f64 = 0.1;
