//! The quantities of interest with their intervals, and what each input contributes to them.

use super::estimate::Estimate;
use serde::Serialize;

/// What one input contributes to the uncertainty of the two headline quantities.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contribution {
    /// The input, as a person says it: "calibration of A1".
    pub input: String,
    /// Its standard uncertainty, with its unit.
    pub standard_uncertainty: String,
    /// Change of the slap-down speed by it, m/s.
    pub speed_m_s: Option<f64>,
    /// Change of k by it.
    pub k: Option<f64>,
}

/// Everything that is read off the reconstructed motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantities {
    /// Speed at first contact, m/s.
    pub impact_velocity: Estimate,
    /// First contact to separation, s.
    pub duration: Estimate,
    /// Vertical velocity of L as it leaves, m/s.
    pub rebound_velocity: Estimate,
    /// ω after the impact, rad/s.
    pub angular_velocity: Estimate,
    /// −ż_L after over ż_L before.
    pub k: Estimate,
    /// Separation to slap-down, s.
    pub flight_time: Option<Estimate>,
    /// Speed of R just before it strikes, m/s.
    pub speed: Option<Estimate>,
    /// Its vertical part, m/s.
    pub vertical_velocity: Option<Estimate>,
    /// Its horizontal part, m/s.
    pub horizontal_velocity: Option<Estimate>,
    /// Inclination then, degrees.
    pub angle: Option<Estimate>,
    /// Height of R's corner then, m: should be 0 within its interval.
    pub second_end_height: Option<Estimate>,
    /// Horizontal velocity of L's corner as it leaves, m/s: should be 0 where it sticks.
    pub slip_velocity: Estimate,
    /// I_x / I_z of the first contact: the friction that acted.
    pub friction: Estimate,
    /// Largest contribution first.
    pub budget: Vec<Contribution>,
}
