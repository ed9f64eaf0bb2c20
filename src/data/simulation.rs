//! A calculated curve beside the measured one: its source, and the comparison.

use super::cask::ChannelSpec;
use serde::Serialize;
use std::path::PathBuf;

/// `[simulation]`: the file of a calculation and its columns.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulationSpec {
    /// The file, from where the program runs.
    pub path: PathBuf,
    /// Column of times.
    pub time: Option<String>,
    /// Channels of the cask file that have a column, with that column as source.
    pub channels: Vec<ChannelSpec>,
}

/// Quantity of a channel that is rated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RatedQuantity {
    /// Specific force of the channel.
    Acceleration,
    /// The integral of the force from first contact on.
    Velocity,
}

/// Agreement of a calculated curve with the measured one by ISO/TS 18571: 1 is equal, 0 is beyond every
/// limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SimulationRow {
    /// The channel.
    pub channel: String,
    /// Rated quantity.
    pub quantity: RatedQuantity,
    /// Rating by the corridors around the measured curve.
    pub corridor: f64,
    /// Rating by the shift with which both curves correlate best.
    pub phase: f64,
    /// Rating by the difference that remains after shifting and warping time.
    pub magnitude: f64,
    /// Rating by the slopes.
    pub slope: f64,
    /// The weighted sum of the four.
    pub rating: f64,
    /// Shift added to the times of the calculation so that its first contact is the measured one, s.
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
    /// Measured value.
    pub measured: f64,
    /// Half-width of its 95 % interval, where it is known.
    pub u95: Option<f64>,
    /// Calculated value.
    pub calculated: f64,
}
