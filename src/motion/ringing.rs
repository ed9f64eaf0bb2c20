//! Signals and their flight fit to the same signals without ringing and zero shift.

use crate::data::{Axis, FlightFit, Signal};

/// The signals with the fitted modes and zero shifts taken off between two times, s; outside they are as they were.
#[must_use]
pub fn without_ringing(signals: &[Signal], fit: &FlightFit, from_s: f64, to_s: f64) -> Vec<Signal> {
    signals
        .iter()
        .map(|signal| {
            let mut calm = signal.clone();
            let Some(plateau) = fit.plateau(&signal.name) else { return calm };
            for i in signal.index_from(from_s)..signal.index_from(to_s) {
                let (_, force) = fit.ringing(plateau, signal.time_s(i));
                calm.force_m_s2[i] -= force + plateau.zero_shift_m_s2;
            }
            calm
        })
        .collect()
}

/// ω from the plateaus of the transverse channels, rad/s: minus the slope of the velocity steps over position (16); 0 where there is none.
#[must_use]
pub fn rotation_rad_s(signals: &[Signal], fit: &FlightFit) -> f64 {
    let points: Vec<(f64, f64)> = signals
        .iter()
        .filter(|s| s.axis == Axis::Transverse)
        .filter_map(|s| fit.plateau(&s.name).map(|p| (s.position_m, p.velocity_step_m_s)))
        .collect();
    #[allow(clippy::cast_precision_loss, reason = "a handful of channels")]
    let n = points.len().max(1) as f64;
    let mean = points.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let (square, product) = points
        .iter()
        .fold((0.0, 0.0), |(s, q), p| (s + (p.0 - mean.0).powi(2), q + (p.0 - mean.0) * (p.1 - mean.1)));
    if square > 0.0 { -product / square } else { 0.0 }
}
