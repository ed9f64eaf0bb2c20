//! Signals to the motion of the cask: velocity curves, flight plateaus free of ringing, the planar rigid body.

mod curves;
mod flight;
mod histories;
mod reconstruct;
mod ringing;
mod strike;

pub use curves::{channel_curves, cutoff_hz, filtered, read_channels};
pub use flight::{Window, compare_late, fit_flight, fit_flights, mean_of_flight};
pub use histories::drive;
pub use reconstruct::{outcome, reconstruct};
pub use ringing::{Calmed, rotation_rad_s};
pub use strike::strike;

use crate::data::{Events, Signal};
use crate::numerics::quadrature::running_integral;

/// Signals with their running integrals over the contact, which every reconstruction of the same drop asks for again.
pub struct Integrated<'a> {
    pub(crate) signals: &'a [Signal],
    velocities: Vec<Velocity>,
}

impl<'a> Integrated<'a> {
    /// Integrals from 2 ms before first contact, where the flight fits begin to count too, until half the contact's length after it: both
    /// times may be moved within their uncertainty.
    #[must_use]
    pub fn over_contact(signals: &'a [Signal], (contact_s, left_s): (f64, f64)) -> Self {
        let to_s = left_s + 0.5 * (left_s - contact_s).max(0.0);
        Self {
            signals,
            velocities: signals.iter().map(|s| Velocity::of(s, contact_s - 2e-3, to_s)).collect(),
        }
    }

    /// The same over what `events` name as the contact; over nothing where they name none.
    #[must_use]
    pub fn over(signals: &'a [Signal], events: &Events) -> Self {
        let contact_s = events.first_contact_s.unwrap_or(0.0);
        Self::over_contact(signals, (contact_s, events.separation_s.unwrap_or(contact_s)))
    }
}

/// Running integral of a signal over a stretch of its record.
pub(crate) struct Velocity {
    start_s: f64,
    sample_rate_hz: f64,
    values_m_s: Vec<f64>,
}

impl Velocity {
    /// From just before `from_s`, where it is 0, to just after `to_s`.
    pub fn of(signal: &Signal, from_s: f64, to_s: f64) -> Self {
        let from = signal.index_from(from_s).saturating_sub(1);
        let to = (signal.index_from(to_s) + 2).min(signal.force_m_s2.len()).max(from);
        Self {
            start_s: signal.time_s(from),
            sample_rate_hz: signal.sample_rate_hz,
            values_m_s: running_integral(&signal.force_m_s2[from..to], 1.0 / signal.sample_rate_hz),
        }
    }

    /// Velocity at a time, m/s, linear between samples and constant beyond the ends.
    pub fn at(&self, time_s: f64) -> f64 {
        let Some(last) = self.values_m_s.len().checked_sub(1) else { return 0.0 };
        let position = (time_s - self.start_s) * self.sample_rate_hz;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked against 0 first")]
        let index = if position > 0.0 { (position as usize).min(last) } else { return self.values_m_s[0] };
        let next = (index + 1).min(last);
        #[allow(clippy::cast_precision_loss, reason = "sample counts stay below 2^52")]
        let share = (position - index as f64).min(1.0);
        self.values_m_s[index] + share * (self.values_m_s[next] - self.values_m_s[index])
    }

    /// Mean velocity between two times, m/s: of the samples there, or the value in the middle where there are none.
    pub fn mean(&self, from_s: f64, to_s: f64) -> f64 {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut at 0 first")]
        let index = |t: f64| {
            (((t - self.start_s) * self.sample_rate_hz).ceil().max(0.0) as usize).min(self.values_m_s.len())
        };
        let inside = &self.values_m_s[index(from_s)..index(to_s).max(index(from_s))];
        if inside.is_empty() {
            return self.at(f64::midpoint(from_s, to_s));
        }
        #[allow(clippy::cast_precision_loss, reason = "sample counts stay below 2^52")]
        let n = inside.len() as f64;
        inside.iter().sum::<f64>() / n
    }
}
