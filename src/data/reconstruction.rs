//! How the motion was had: the rungs of the reconstruction, the one taken, and what the others say.

use super::cask::Axis;
use super::estimate::Estimate;
use serde::{Deserialize, Serialize};

/// A rung of the reconstruction, simplest first   (29)
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ReconstructionRung {
    /// Planar motion, the flight fitted with the bending modes and drift that it shows, none included.
    Flight,
    /// Planar motion, all inputs fitted to all observables within their tolerances.
    Joint,
}

impl ReconstructionRung {
    /// All, simplest first.
    pub const ALL: [Self; 2] = [Self::Flight, Self::Joint];
}

/// What one rung says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReconstructionCandidate {
    /// Which.
    pub rung: ReconstructionRung,
    /// Slap-down speed by it.
    pub speed: Option<Estimate>,
    /// k by it.
    pub k: Option<Estimate>,
    /// Whether its residuals are within what noise and tolerances explain.
    pub consistent: bool,
    /// What is left, in one phrase.
    pub residual: String,
}

/// What a closure tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ClosureKind {
    /// R's corner is on the target when it strikes: angle, velocities, times.
    Height,
    /// L's corner is on the target as it touches again.
    Touch,
    /// The impulse of the first impact turns the cask: the channels against each other and against the mass
    /// properties.
    Turning,
    /// The impulse of the second impact turns the cask.
    SecondTurning,
    /// A channel at rest reads gravity: its scale.
    Rest,
    /// The fall lasts as long as the impact velocity needs: height and clock.
    Fall,
    /// The cask turns before the first contact as an angular-rate sensor says.
    RateBefore,
    /// The first impact turns the cask as an angular-rate sensor says: that sensor's scale, and the others'.
    RateGained,
}

/// Rest before the release, as one DC-coupled channel shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct RestLevel {
    /// The channel.
    pub channel: String,
    /// Along which body axis it reads.
    pub axis: Axis,
    /// Rest level less free-fall level, m/s²: g cos φ of a sound transverse channel, g sin φ of an axial one.
    pub rest_m_s2: f64,
    /// Standard uncertainty of it, from the levels' own scatter, m/s².
    pub u_m_s2: f64,
}

/// A closure missed by this many standard uncertainties is not chance: one sound drop in 2000 a closure. At
/// 3.7 one sound drop in 2000 more passed, and of 2000 damaged ones four more with a wrong number.
pub const MISSED_U: f64 = 3.5;

/// Standard uncertainty of the time of a release: a hook lets go within some milliseconds, s.
pub const U_RELEASE_S: f64 = 0.005;

/// A closure missed by more standard uncertainties than this is not explained by noise and tolerances alone
/// (95 %).
pub const MET_U: f64 = 2.0;

/// One observable that the motion must meet beside the velocity steps, and how far it is off.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Closure {
    /// What it is, as a person says it: "height of the second end at slap-down".
    pub name: String,
    /// Which one.
    pub kind: ClosureKind,
    /// The channel, where it is one channel's.
    pub channel: Option<String>,
    /// By how much the stated inputs miss it, with unit.
    pub miss: String,
    /// That, over its standard uncertainty from all inputs.
    pub miss_in_u: f64,
    /// The same with all other closures met: what two of them contradict each other by, though an uncertain
    /// input hides it from each.
    pub beside_others_in_u: f64,
}

impl Closure {
    /// The larger of both misses.
    pub fn most_in_u(&self) -> f64 {
        self.miss_in_u.abs().max(self.beside_others_in_u.abs())
    }
}

/// One input as the joint fit moved it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Adjustment {
    /// The input, as the budget calls it.
    pub input: String,
    /// Its tolerance as a standard uncertainty, with unit.
    pub standard_uncertainty: String,
    /// By how many of those it was moved.
    pub moved_in_u: f64,
    /// Its standard uncertainty after the fit, as a share of the one before.
    pub left_share: f64,
}

/// The rung taken and the others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReconstructionChoice {
    /// The rung taken.
    pub rung: ReconstructionRung,
    /// Why, and what the next rung would have changed.
    pub reason: String,
    /// Every rung that could be had, simplest first.
    pub candidates: Vec<ReconstructionCandidate>,
    /// What the motion must meet beside the velocity steps.
    pub closures: Vec<Closure>,
    /// χ² of the joint fit and its degrees of freedom.
    pub chi_square: Option<(f64, usize)>,
    /// What the joint fit moved, largest first.
    pub adjustments: Vec<Adjustment>,
}

impl ReconstructionChoice {
    /// The choice without the speed and the k of its rungs, where they are not to be stated.
    pub fn without_numbers(mut self) -> Self {
        for candidate in &mut self.candidates {
            (candidate.speed, candidate.k) = (None, None);
        }
        self
    }
}
