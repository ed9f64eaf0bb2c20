//! A calculated curve beside the measured one: where it lies, and how both compare.

use super::cask::ChannelSpec;
use serde::Serialize;
use std::path::PathBuf;

/// `[simulation]`: the file of a calculation and its columns.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulationSpec {
    /// The file, from where the program runs.
    pub path: PathBuf,
    /// Its column of times.
    pub time: Option<String>,
    /// The channels of the cask file that it has a column for, each with that column as its source.
    pub channels: Vec<ChannelSpec>,
}

/// What of a channel is rated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RatedQuantity {
    /// Its specific force.
    Acceleration,
    /// The integral of that from first contact on.
    Velocity,
}

/// How a calculated curve agrees with the measured one, by ISO/TS 18571: 1 equal, 0 beyond every limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SimulationRow {
    /// The channel.
    pub channel: String,
    /// What is rated.
    pub quantity: RatedQuantity,
    /// By the corridors around the measured curve.
    pub corridor: f64,
    /// By the shift with which both curves correlate best.
    pub phase: f64,
    /// By the difference that a shift and a warping of time leave.
    pub magnitude: f64,
    /// By the slopes.
    pub slope: f64,
    /// The weighted sum of the four.
    pub rating: f64,
    /// What is added to the times of the calculation so that its first contact is the measured one, s.
    pub shift_s: f64,
    /// Largest magnitude of the calculated curve less that of the measured one, over the latter.
    pub peak_difference: f64,
}

/// A number of the calculation beside the measured one.
#[derive(Debug, Clone, PartialEq)]
pub struct CalculatedNumber {
    /// Channel, impact and quantity, in words.
    pub what: String,
    /// Unit of all three.
    pub unit: &'static str,
    /// As measured.
    pub measured: f64,
    /// Half-width of its 95 % interval, where it is known.
    pub u95: Option<f64>,
    /// As calculated.
    pub calculated: f64,
}
