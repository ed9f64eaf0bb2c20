//! Standard uncertainty of a channel's velocity step.

use super::FitData;
use crate::data::{Events, MOST_LOST_M_S, Signal, Tolerances};
use crate::numerics::noise::integral_uncertainty_by;
use std::f64::consts::FRAC_2_PI;

/// Standard uncertainty of the velocity that a gap in the contact removed, over v0 times the gap's share of
/// the contact. A pulse that throws L back with its impact speed changes its velocity by 2 v0: a gap of a
/// tenth in the middle of such a half sine removes 0.1 π v0, one at its end next to none.
const GAP_SHARE: f64 = 3.0;

/// Standard uncertainty of a channel's velocity step, m/s, from six parts: the plateau's fit, the shape of
/// the modes, the time in the contact at which a zero shift began, the drift of the offset since the free
/// fall, clipping, gaps.
pub fn u_step_m_s(measured: &FitData, channel: usize) -> f64 {
    let (signal, plateau) = (&measured.signals[channel], &measured.flight.plateaus[channel]);
    let contact_s = measured.events.first_contact_s().unwrap_or(0.0);
    let pulse_s = measured.events.separation_s().map_or(0.0, |t| t - contact_s);
    let flight_s = measured.flight.to_s - measured.flight.from_s;
    let shift_m_s = plateau.zero_shift_m_s2.abs() * pulse_s / 12.0_f64.sqrt();
    // If a drift was fitted only the noise of the contact remains.
    let length_s = pulse_s + if measured.flight.drift { 0.0 } else { flight_s / 2.0 };
    let noise_m_s = integral_uncertainty_by(&signal.noise_spectrum, signal.free_fall_s, length_s);
    // Without a spectrum only the uncertainty of the offset itself is known.
    let drift_m_s = noise_m_s.max(signal.u_offset_m_s2 * length_s);
    let ringing_m_s: f64 = measured
        .flight
        .modes
        .iter()
        .zip(&plateau.ringing_m_s)
        .enumerate()
        .map(|(i, (mode, (a, b)))| {
            // A fitted mode that is an artefact bends the plateau, which may lie anywhere along it.
            if measured.flight.is_fit_artefact(i, measured.signals) {
                return a.hypot(*b);
            }
            mode.u_plateau(a.hypot(*b), flight_s)
        })
        .sum();
    plateau.u_m_s.hypot(ringing_m_s).hypot(shift_m_s).hypot(drift_m_s).hypot(lost_m_s(measured, signal))
}

/// Standard uncertainty of a channel's velocity step from base strain, m/s: half a sine over the contact, of
/// the stated share of the channel's peak there.
pub fn u_base_strain_m_s(signal: &Signal, events: &Events, tolerances: &Tolerances) -> f64 {
    let Some((contact_s, left_s)) = events.first_contact_s().zip(events.separation_s()) else { return 0.0 };
    let pulse = signal.force_m_s2.get(signal.index_from(contact_s)..signal.index_from(left_s));
    let peak_m_s2 = pulse.into_iter().flatten().fold(0.0_f64, |peak, force| peak.max(force.abs()));
    tolerances.base_strain / 2.0 * peak_m_s2 * (left_s - contact_s) * FRAC_2_PI
}

/// Velocity that clipping, or a gap in the contact, may have removed from a channel's step, m/s.
fn lost_m_s(measured: &FitData, signal: &Signal) -> f64 {
    let contact_s = measured.events.first_contact_s().unwrap_or(0.0);
    let left_s = measured.events.separation_s().unwrap_or(contact_s);
    let clipped_m_s = signal.lost_to_clipping_m_s(contact_s, measured.flight.to_s);
    let missing = signal.missing_s(contact_s, left_s) / (left_s - contact_s).max(f64::MIN_POSITIVE);
    let gap_m_s = (GAP_SHARE * missing).min(1.0) * measured.setup.impact_velocity_m_s;
    clipped_m_s.hypot(gap_m_s)
}

/// True if a channel has lost its velocity step to clipping or a gap: a check then determines the step, and
/// confirms nothing.
pub(super) fn has_lost_step(measured: &FitData) -> bool {
    measured.signals.iter().any(|signal| lost_m_s(measured, signal) > MOST_LOST_M_S)
}
