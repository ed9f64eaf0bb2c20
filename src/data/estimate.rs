//! A measured quantity with its 95 % interval.

use serde::Serialize;

/// A measured value with the half-width of its 95 % interval and its unit, as the result states it.
///
/// `unit` is "s", "m/s", "rad/s", "deg" or "1"; `value` and `u95` are in that unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The value, in `unit`.
    pub value: f64,
    /// Half-width of the 95 % interval, in `unit`.
    pub u95: f64,
    /// The unit, as written in the result.
    pub unit: &'static str,
}

impl Estimate {
    /// A value, its 95 % half-width and their unit.
    #[must_use]
    pub fn new(value: f64, u95: f64, unit: &'static str) -> Self {
        Self { value, u95, unit }
    }
}
