//! Choice of the reconstruction method: all methods, the selected one, and their results.

use super::cask::Axis;
use super::estimate::Estimate;
use serde::{Deserialize, Serialize};

/// A method of the reconstruction, simplest first   (29)
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Planar motion, with the flight fitted by the bending modes and drift that it shows, if any.
    Flight,
    /// Planar motion, with all inputs fitted to all observables within their tolerances.
    Joint,
}

impl Method {
    /// All methods, simplest first.
    pub const ALL: [Self; 2] = [Self::Flight, Self::Joint];
}

/// Result of one method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodCandidate {
    /// Method.
    pub rung: Method,
    /// Slap-down speed by this method.
    pub speed: Option<Estimate>,
    /// k by this method.
    pub k: Option<Estimate>,
    /// True if noise and tolerances explain its residuals.
    pub consistent: bool,
    /// Residual, in one phrase.
    pub residual: String,
}

/// Observable of a consistency check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CheckKind {
    /// Height of R's corner at the slap-down, which is zero: checks angle, velocities and times.
    Height,
    /// Height of L's corner when it touches again, which is zero.
    Touch,
    /// Rotation from the impulse of the first impact: checks the channels against each other and against the
    /// mass properties.
    Turning,
    /// Rotation from the impulse of the second impact.
    SecondTurning,
    /// A channel at rest reads gravity: its scale.
    Rest,
    /// Duration of the fall against the impact velocity: checks height and clock.
    Fall,
    /// Rotation before the first contact by an angular-rate sensor.
    RateBefore,
    /// The angular-rate sensor confirms the rotation that the first impact gives: the check depends on that
    /// sensor's scale and those of the others.
    RateGained,
}

/// Rest before the release, as one DC-coupled channel shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct RestLevel {
    /// The channel.
    pub channel: String,
    /// Along which body axis it reads.
    pub axis: Axis,
    /// Rest level less free-fall level, m/s²: g cos φ for a sound transverse channel, g sin φ for an axial
    /// one.
    pub rest_m_s2: f64,
    /// Standard uncertainty of that level, from the scatter of the levels, m/s².
    pub u_m_s2: f64,
}

/// A check that fails by this many standard uncertainties does not fail by chance: one sound drop in 2000 per
/// check. At 3.7 one sound drop in 2000 more passed, and four of 2000 damaged ones more with a wrong number.
pub const MISSED_U: f64 = 3.5;

/// Standard uncertainty of the time of a release: a hook opens within some milliseconds, s.
pub const U_RELEASE_S: f64 = 0.005;

/// Above this many standard uncertainties noise and tolerances alone do not explain the miss of a check (95
/// %).
pub const CONSISTENT_U: f64 = 2.0;

/// One observable that the motion must reproduce beside the velocity steps, and its miss.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Consistency {
    /// Name for a reader: "height of the second end at slap-down".
    pub name: String,
    /// Kind of the check.
    pub kind: CheckKind,
    /// The channel, where it is one channel's.
    pub channel: Option<String>,
    /// Miss of the stated inputs, with its unit.
    pub miss: String,
    /// That miss over its standard uncertainty from all inputs.
    pub miss_in_u: f64,
    /// The miss with all other checks satisfied: two of them may contradict each other although an uncertain
    /// input hides it from each.
    pub beside_others_in_u: f64,
}

impl Consistency {
    /// The larger of both misses.
    pub fn largest_residual(&self) -> f64 {
        self.miss_in_u.abs().max(self.beside_others_in_u.abs())
    }
}

/// Correction of one input by the joint fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Adjustment {
    /// The input, as the budget calls it.
    pub input: String,
    /// Tolerance as a standard uncertainty, with its unit.
    pub standard_uncertainty: String,
    /// Correction, in standard uncertainties.
    pub moved_in_u: f64,
    /// Standard uncertainty after the fit, as a share of that before.
    pub left_share: f64,
}

/// The selected method and the others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodChoice {
    /// The selected method.
    pub rung: Method,
    /// The reason, and what the next method would change.
    pub reason: String,
    /// All methods that gave a result, simplest first.
    pub candidates: Vec<MethodCandidate>,
    /// Consistency checks beside the velocity steps.
    pub closures: Vec<Consistency>,
    /// χ² of the joint fit and its degrees of freedom.
    pub chi_square: Option<(f64, usize)>,
    /// Corrections by the joint fit, largest first.
    pub adjustments: Vec<Adjustment>,
}

impl MethodChoice {
    /// The choice without speed and k of the methods, if they must not be stated.
    pub fn without_numbers(mut self) -> Self {
        for candidate in &mut self.candidates {
            (candidate.speed, candidate.k) = (None, None);
        }
        self
    }
}
