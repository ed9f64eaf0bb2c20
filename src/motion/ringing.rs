//! Signals and their flight fit to the same signals without ringing and zero shift.

use crate::data::{Axis, FlightFit, Plateau, Signal};
use crate::numerics::damped_modes::{Oscillation, uniform_ringing};
use std::ops::Range;

/// A mode that would have been this much larger at the time asked for (e^1.6, fivefold) is not followed back to it: the fit knows
/// nothing of it there, and an error of its damping would be blown up likewise.
const MOST_GROWTH: f64 = 1.6;

/// Sets `calm`, copies of `signals`, to the signals with the fitted modes and zero shifts taken off between two times, s.
///
/// The copies are made by the caller so that rounds of a search share their memory.
pub fn take_off_ringing(calm: &mut [Signal], signals: &[Signal], fit: &FlightFit, between_s: Range<f64>) {
    for (calm, signal) in calm.iter_mut().zip(signals) {
        calm.force_m_s2.clone_from(&signal.force_m_s2);
        let Some(plateau) = fit.plateau(&signal.name) else { continue };
        let (from, to) = (signal.index_from(between_s.start), signal.index_from(between_s.end));
        for force in calm.force_m_s2.iter_mut().take(to).skip(from) {
            *force -= plateau.zero_shift_m_s2;
        }
        take_off_modes(calm, (from, to), fit, plateau);
    }
}

/// Takes off f = v̇ of v = Σ e^(−ζωτ) (A cos ωτ + B sin ωτ), τ from the flight window's start   (20)
fn take_off_modes(calm: &mut Signal, (from, to): (usize, usize), fit: &FlightFit, plateau: &Plateau) {
    for (mode, &(a, b)) in fit.modes.iter().zip(&plateau.ringing_m_s) {
        let omega = std::f64::consts::TAU * mode.frequency_hz;
        let decay = mode.damping * omega;
        let known_from = calm.index_from(fit.from_s - MOST_GROWTH / decay.max(f64::MIN_POSITIVE)).max(from);
        let tau_s = calm.time_s(known_from) - fit.from_s;
        let (cosine, sine) = (omega * b - decay * a, -omega * a - decay * b);
        let mode = Oscillation { frequency_hz: mode.frequency_hz, damping: mode.damping };
        let ringing = uniform_ringing(mode, tau_s, 1.0 / calm.sample_rate_hz);
        for (force, z) in calm.force_m_s2.iter_mut().take(to).skip(known_from).zip(ringing) {
            *force -= cosine * z.re + sine * z.im;
        }
    }
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
