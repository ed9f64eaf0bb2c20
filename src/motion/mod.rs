//! Signals to the motion of the cask: velocity curves, flight plateaus free of ringing, the planar rigid
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

pub use answer::most_late_s;
pub use contact::{ContactCourse, FirstTouch, ForceCourse, largest, pulses, vector_pulses};
pub use curves::{around, channel_curves, cutoff_hz, filter_name, filtered, shown, usual_filters};
pub use flight::{compare_early, compare_late, fit_flights};
pub use histories::drive;
pub use landing::landing;
pub use late_blow::{step_m_s, strike};
pub use local::{CornerRinging, ringing_of_second_end};
pub use others::{other_curve, strongest_line};
pub use reconstruct::{outcome, reconstruct, with_states};
pub use refit::{at_once, with_modes};
pub use ringing::{RingingRemoved, mirrored, rotation_by, rotation_rad_s, turned_rad_s};
pub use window::{BEFORE_SLAP_DOWN_S, Window, clear_of_contact_s};

use crate::data::Signal;
use crate::numerics::quadrature::running_integral;
use crate::numerics::{as_count, as_f64, reduce};
use rayon::prelude::*;
use std::borrow::Cow;

/// Velocities count from so long before first contact, s: it may be moved within its uncertainty.
const MARGIN_S: f64 = 2e-3;
/// Signals are integrated from this long before contact, s: the longest flight window and its clearance on
/// both sides.
const BEFORE_S: f64 = flight::LONGEST_S + 2.0 * flight::CLEAR_S;

/// Signals with their running integrals, which every flight fit and every reconstruction of the same drop
/// asks for again.
pub struct Integrated<'a> {
    /// As given, or means of their samples at a rate that the motion needs.
    pub(crate) signals: Cow<'a, [Signal]>,
    pub(crate) contact_s: f64,
    velocities: Vec<Velocity>,
    peaks_m_s2: Vec<f64>,
}

impl<'a> Integrated<'a> {
    /// Integrals of whole signals, 0 shortly before first contact; where all are whole, of means at 100 kHz
    /// at the least.
    pub fn over(signals: &'a [Signal], contact_s: f64) -> Self {
        let signals = decimate::decimated(signals, 0.0);
        let velocity_and_peak = |s: &Signal| {
            let mut velocity = Velocity::of(s, contact_s - BEFORE_S, f64::INFINITY);
            velocity.count_from(contact_s - MARGIN_S);
            (velocity, reduce::peak(&s.force_m_s2))
        };
        let (velocities, peaks_m_s2) = signals.par_iter().map(velocity_and_peak).unzip();
        Self { signals, contact_s, velocities, peaks_m_s2 }
    }

    /// The same with signals of its own.
    pub fn into_owned(self) -> Integrated<'static> {
        Integrated { signals: Cow::Owned(self.signals.into_owned()), ..self }
    }

    /// Each signal with its velocity.
    fn each(&self) -> impl IndexedParallelIterator<Item = (&Signal, &Velocity)> {
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
    /// From just before `from_s`, where it is 0, to just after `to_s`.
    fn of(signal: &Signal, from_s: f64, to_s: f64) -> Self {
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

    /// Index of the first sample at or after a time, cut to what there is.
    fn index_from(&self, time_s: f64) -> usize {
        let position = (time_s - self.start_s) * self.sample_rate_hz;
        as_count(position.ceil()).min(self.values_m_s.len())
    }

    /// Velocity at a time, m/s, linear between samples and constant beyond the ends.
    fn at(&self, time_s: f64) -> f64 {
        let Some(last) = self.values_m_s.len().checked_sub(1) else { return 0.0 };
        let position = (time_s - self.start_s) * self.sample_rate_hz;
        let index = if position > 0.0 { as_count(position).min(last) } else { return self.values_m_s[0] };
        let next = (index + 1).min(last);
        let share = (position - as_f64(index)).min(1.0);
        self.values_m_s[index] + share * (self.values_m_s[next] - self.values_m_s[index])
    }

    /// Mean velocity between two times, m/s: of the samples there, or the value in the middle where there are
    /// none.
    fn mean(&self, from_s: f64, to_s: f64) -> f64 {
        let from = self.index_from(from_s);
        let inside = &self.values_m_s[from..self.index_from(to_s).max(from)];
        if inside.is_empty() {
            return self.at(f64::midpoint(from_s, to_s));
        }
        reduce::sum(inside) / as_f64(inside.len())
    }
}
