//! Points of the velocity of both ends, as many as a picture of two drops needs.

use crate::data::{Analysis, Axis, End};
use crate::numerics::as_f64;
use serde::{Deserialize, Serialize};

/// Points of a curve.
const POINTS: usize = 240;
/// Time shown before first contact and after the slap-down, s; without a slap-down, the length of the flight.
const BEFORE_S: f64 = 5e-3;
const AFTER_S: f64 = 15e-3;
const LONGEST_S: f64 = 0.1;

/// Velocity over time of the first transverse sensor on each end, at equal steps from first contact on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DropCurves {
    from_ms: f64,
    step_ms: f64,
    /// Null where samples are missing.
    first_end_m_s: Vec<Option<f64>>,
    second_end_m_s: Vec<Option<f64>>,
}

/// The curves of an analysis; `None` if no first contact was found.
pub fn drop_curves(analysis: &Analysis) -> Option<DropCurves> {
    let (events, curves) = (&analysis.result.events, &analysis.curves.channels);
    let contact_s = events.first_contact_s()?;
    let to_s = events.slap_down_s().unwrap_or(contact_s + LONGEST_S) + AFTER_S;
    let step_s = (to_s - contact_s + BEFORE_S) / as_f64(POINTS - 1);
    let of_end = |end: End| {
        let mut channels = analysis.result.channels.iter();
        let own = channels.find(|c| c.end == end && c.axis == Axis::Transverse);
        let curve = own.and_then(|own| curves.iter().find(|curve| curve.channel == own.name));
        let value = |i: usize| {
            let curve = curve?;
            let at = curve.time_s.partition_point(|s| *s < contact_s - BEFORE_S + as_f64(i) * step_s);
            // A hundredth of a metre per second is less than the width of a line.
            curve.velocity_m_s.get(at).filter(|v| v.is_finite()).map(|v| (v * 100.0).round() / 100.0)
        };
        (0..POINTS).map(value).collect()
    };
    let step_ms = (step_s * 1e7).round() / 1e4;
    let [first_end_m_s, second_end_m_s] = [End::First, End::Second].map(of_end);
    Some(DropCurves { from_ms: -BEFORE_S * 1e3, step_ms, first_end_m_s, second_end_m_s })
}
