//! Motion of the cask from the signals: velocity curves, flight plateaus without ringing, the planar rigid
//! body.

mod answer;
mod contact;
mod curves;
mod decimate;
mod flight;
mod histories;
mod landing;
mod late_blow;
mod local;
mod others;
mod reconstruct;
mod refit;
mod ringing;
mod window;

pub use answer::largest_delay_s;
pub use contact::{ContactCourse, FirstTouch, ForceCourse, largest, pulses, vector_pulses};
pub use curves::{channel_curves, cut_shown, cutoff_hz, filter, filter_name, usual_filters, visible};
pub use flight::{compare_early, compare_late, fit_flights};
pub use histories::contact_drive;
pub use landing::landing;
pub use late_blow::{find_shock, step_m_s};
pub use local::{CornerRinging, second_end_ringing};
pub use others::{other_curve, strongest_line};
pub use reconstruct::{outcome, reconstruct, with_states};
pub use refit::{flight_at, with_modes};
pub use ringing::{RingingRemoved, mirror, rotation_from_names, rotation_rad_s, spin_rad_s};
pub use window::{BEFORE_SLAP_DOWN_S, Window, clear_of_contact_s};

use crate::data::Signal;
use crate::numerics::quadrature::running_integral;
use crate::numerics::{as_count, as_f64, reduce};
use rayon::prelude::*;
use std::borrow::Cow;

/// Velocities count from this long before first contact, s, since its time may be shifted within its
/// uncertainty.
const MARGIN_S: f64 = 2e-3;
/// Signals are integrated from this long before contact, s: the longest flight window and its clearance on
/// both sides.
const BEFORE_S: f64 = flight::LONGEST_S + 2.0 * flight::CLEAR_S;

/// Signals with their running integrals, which every flight fit and every reconstruction of the same drop
/// uses again.
pub struct Integrated<'a> {
    /// Signals as given, or means of their samples at the rate that the motion needs.
    pub(crate) signals: Cow<'a, [Signal]>,
    pub(crate) contact_s: f64,
    velocities: Vec<Velocity>,
    peaks_m_s2: Vec<f64>,
}

impl<'a> Integrated<'a> {
    /// Integrates whole signals, 0 shortly before first contact; if all are complete, means at 100 kHz or
    /// more.
    pub fn new(signals: &'a [Signal], contact_s: f64) -> Self {
        let signals = decimate::decimate(signals, 0.0);
        let velocity_and_peak = |s: &Signal| {
            let mut velocity = Velocity::integrate(s, contact_s - BEFORE_S, f64::INFINITY);
            velocity.count_from(contact_s - MARGIN_S);
            (velocity, reduce::peak(&s.force_m_s2))
        };
        let (velocities, peaks_m_s2) = signals.par_iter().map(velocity_and_peak).unzip();
        Self { signals, contact_s, velocities, peaks_m_s2 }
    }

    /// Copies the signals, so that the integrals own them.
    pub fn into_owned(self) -> Integrated<'static> {
        Integrated { signals: Cow::Owned(self.signals.into_owned()), ..self }
    }

    /// Iterates over each signal with its velocity.
    fn with_velocities(&self) -> impl IndexedParallelIterator<Item = (&Signal, &Velocity)> {
        self.signals.par_iter().zip(&self.velocities)
    }
}

/// Running integral of a signal over a stretch of its record.
struct Velocity {
    start_s: f64,
    sample_rate_hz: f64,
    values_m_s: Vec<f64>,
}

impl Velocity {
    /// Integrates a signal from just before `from_s`, where it is 0, to just after `to_s`.
    fn integrate(signal: &Signal, from_s: f64, to_s: f64) -> Self {
        let from = signal.index_from(from_s).saturating_sub(1);
        let to = (signal.index_from(to_s) + 2).min(signal.force_m_s2.len()).max(from);
        Self {
            start_s: signal.time_s(from),
            sample_rate_hz: signal.sample_rate_hz,
            values_m_s: running_integral(&signal.force_m_s2[from..to], 1.0 / signal.sample_rate_hz),
        }
    }

    /// Sets the velocity at the last sample before `zero_s` to 0.
    fn count_from(&mut self, zero_s: f64) {
        let zero_m_s = self.values_m_s.get(self.index_from(zero_s).saturating_sub(1)).copied().unwrap_or(0.0);
        for value in &mut self.values_m_s {
            *value -= zero_m_s;
        }
    }

    /// Index of the first sample at or after a time, limited to the available samples.
    fn index_from(&self, time_s: f64) -> usize {
        let position = (time_s - self.start_s) * self.sample_rate_hz;
        as_count(position.ceil()).min(self.values_m_s.len())
    }

    /// Velocity at a time, m/s, linear between samples and constant beyond the ends.
    fn velocity_at(&self, time_s: f64) -> f64 {
        let Some(last) = self.values_m_s.len().checked_sub(1) else { return 0.0 };
        let position = (time_s - self.start_s) * self.sample_rate_hz;
        let index = if position > 0.0 { as_count(position).min(last) } else { return self.values_m_s[0] };
        let next = (index + 1).min(last);
        let share = (position - as_f64(index)).min(1.0);
        self.values_m_s[index] + share * (self.values_m_s[next] - self.values_m_s[index])
    }

    /// Mean velocity between two times, m/s: of the samples there, or the value in the middle if there are
    /// none.
    fn mean(&self, from_s: f64, to_s: f64) -> f64 {
        let from = self.index_from(from_s);
        let inside = &self.values_m_s[from..self.index_from(to_s).max(from)];
        if inside.is_empty() {
            return self.velocity_at(f64::midpoint(from_s, to_s));
        }
        reduce::sum(inside) / as_f64(inside.len())
    }
}
