//! The plan of a drop to the plan of one that is harder to tell.

use super::super::data::BendingMode;
use super::super::plan::DropPlan;

/// A flight shows so many periods of a mode that has to be told by itself.
const CLEAR_PERIODS: f64 = 3.0;

/// Hardens a sound plan; a kind of damage does nothing to it.
pub(super) fn harden(kind: &str, plan: &mut DropPlan, size: f64) {
    let flight_s = if kind.contains("mode") { plan.flight_s() } else { 1.0 };
    let clear = DropPlan::mode(1, CLEAR_PERIODS / flight_s);
    match kind {
        "mode_frequency" => plan.modes = vec![DropPlan::mode(1, size / flight_s)],
        "mode_damping" => plan.modes = vec![BendingMode { damping: size, ..clear }],
        "close_modes" => {
            plan.modes = vec![clear, DropPlan::mode(2, clear.frequency_hz * (1.0 + size / 100.0))];
        }
        "mode_strength" => plan.modes = vec![BendingMode { strength: size, ..clear }],
        "k_small" => plan.k = size,
        "k_large" => plan.k = 1.0 - size,
        "pulse" => plan.pulse_s = 1e-3 * size,
        "angle_small" | "angle_large" => plan.angle_deg = size,
        "recontact" => (plan.k, plan.angle_deg) = (0.1, size),
        _ => {}
    }
}
