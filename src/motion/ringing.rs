//! Subtracts ringing and zero shift from signals by their flight fit.

use super::flight::{centrifugal_m_s2, oscillation};
use crate::data::{Axis, End, FlightFit, Mode, Plateau, Signal};
use crate::numerics::damped_modes::uniform_ringing;
use crate::numerics::{as_f64, reduce};
use std::ops::Range;

/// A mode that would have been this much larger at an earlier time (e^1.6, fivefold) is not extrapolated back
/// to it: the fit has no information there, and an error of its damping would grow likewise.
const MOST_GROWTH: f64 = 1.6;

/// Mean of ω² in a contact over ω² of the flight: 3/8 if the force is a half sine.
const TURNING_SHARE: f64 = 0.375;
/// ω² η is at most a quarter of a step: each round leaves a quarter of the error.
const ROUNDS: usize = 4;

/// A sum of signals from which ringing and zero shift can be subtracted, and again with another fit.
pub struct RingingRemoved {
    signal: Signal,
    parts: Vec<(String, f64)>,
    /// Original samples from an index on.
    before: (usize, Vec<f64>),
}

impl RingingRemoved {
    /// Makes the sum with its composition: signals by name, each with its weight.
    pub fn new((signal, parts): (Signal, Vec<(String, f64)>)) -> Self {
        Self { signal, parts, before: (0, Vec::new()) }
    }

    /// The sum as it now is.
    pub fn signal(&self) -> &Signal {
        &self.signal
    }

    /// The largest force between two times, m/s².
    pub fn largest_m_s2(&self, between_s: &Range<f64>) -> f64 {
        let [from, to] = [between_s.start, between_s.end].map(|time_s| self.signal.index_from(time_s));
        reduce::peak(self.signal.force_m_s2.get(from..to).unwrap_or_default())
    }

    /// Restores the subtracted ringing.
    pub fn restore(&mut self) {
        let (from, before) = &mut self.before;
        self.signal.force_m_s2[*from..*from + before.len()].copy_from_slice(before);
        before.clear();
    }

    /// Centrifugal acceleration of a rotation, rad/s, at the sensors of `signals`, m/s²   (14), (15)
    pub fn pull_m_s2(&self, signals: &[Signal], turning_rad_s: f64, cog_m: f64) -> f64 {
        let of_part = |(name, weight): &(String, f64)| {
            let signal = signals.iter().find(|signal| signal.name == *name)?;
            Some(weight * centrifugal_m_s2(signal, turning_rad_s, cog_m))
        };
        self.parts.iter().filter_map(of_part).sum()
    }

    /// Subtracts the fitted modes and zero shifts, and this centrifugal acceleration, between two times, s,
    /// in place of those subtracted before.
    pub fn take_off(&mut self, fit: &FlightFit, between_s: Range<f64>, pull_m_s2: f64) {
        self.restore();
        let (from, to) = (self.signal.index_from(between_s.start), self.signal.index_from(between_s.end));
        let to = to.max(from);
        self.before.0 = from;
        self.before.1.extend_from_slice(&self.signal.force_m_s2[from..to]);
        let plateaus: Vec<(&Plateau, f64)> =
            self.parts.iter().filter_map(|(name, weight)| Some((fit.plateau(name)?, *weight))).collect();
        let shifts_m_s2 = plateaus.iter().map(|(p, weight)| weight * p.zero_shift_m_s2);
        let shift_m_s2 = pull_m_s2 + shifts_m_s2.sum::<f64>();
        for force in &mut self.signal.force_m_s2[from..to] {
            *force -= shift_m_s2;
        }
        for (i, mode) in fit.modes.iter().enumerate() {
            let sizes = plateaus.iter().filter_map(|(p, weight)| Some((p.ringing_m_s.get(i)?, weight)));
            let size_m_s = sizes.fold((0.0, 0.0), |sum, ((a, b), w)| (sum.0 + w * a, sum.1 + w * b));
            self.take_off_mode((from, to), mode, size_m_s, fit.from_s);
        }
    }

    /// Subtracts f = v̇ of v = e^(−ζωτ) (A cos ωτ + B sin ωτ), τ from `begin_s` on   (20)
    fn take_off_mode(&mut self, (from, to): (usize, usize), mode: &Mode, (a, b): (f64, f64), begin_s: f64) {
        let calm = &mut self.signal;
        let omega = std::f64::consts::TAU * mode.frequency_hz;
        let decay = mode.damping * omega;
        let known_from = calm.index_from(begin_s - MOST_GROWTH / decay.max(f64::MIN_POSITIVE)).max(from);
        let tau_s = calm.time_s(known_from) - begin_s;
        let (cosine, sine) = (omega * b - decay * a, -omega * a - decay * b);
        let ringing = uniform_ringing(oscillation(mode), tau_s, 1.0 / calm.sample_rate_hz);
        for (force, z) in calm.force_m_s2.iter_mut().take(to).skip(known_from).zip(ringing) {
            *force -= cosine * z.re + sine * z.im;
        }
    }
}

/// ω of a flight from the centrifugal force that its channels show in addition to that of the rotation before
/// it, which belongs to their offset, rad/s: the root of the difference of both squares, negative if the cask
/// turns more slowly than before.
///
/// `events_s` are first contact and separation: from there on the steps of channels off the axis hold −ω² η
/// (14).
pub fn spin_rad_s(signals: &[Signal], fit: &FlightFit, before_rad_s: f64, events_s: [f64; 2]) -> f64 {
    let [contact_s, left_s] = events_s;
    let turned_s = (fit.from_s - left_s + TURNING_SHARE * (left_s - contact_s)).max(0.0);
    let across = signals.iter().filter(|s| s.axis == Axis::Transverse);
    let offsets: Vec<(f64, f64)> = across.map(|s| (s.position_m, s.offset_m)).collect();
    let read_rad_s = rotation_rad_s(signals, fit);
    let by_square_s = turned_s * slope(&offsets);
    let gained_rad_s = (0..ROUNDS).fold(read_rad_s, |w, _| read_rad_s - w * w.abs() * by_square_s);
    if before_rad_s == 0.0 {
        return gained_rad_s.abs();
    }
    let beyond = (before_rad_s + gained_rad_s).powi(2) - before_rad_s.powi(2);
    beyond.abs().sqrt().copysign(beyond)
}

/// Mirrors the signals of a drop from its flight on, as if the drop began with the slap-down: R becomes the
/// first end, and its fall has no ringing, no shift and no centrifugal force, while the cask turns by ω,
/// rad/s.
pub fn mirror(
    signals: &[Signal],
    fit: &FlightFit,
    turning_rad_s: f64,
    length_m: f64,
    cog_m: f64,
) -> Vec<Signal> {
    let mirror = |signal: &Signal| {
        let flown = signal.cut(signal.index_from(fit.from_s), usize::MAX);
        let pull_m_s2 = centrifugal_m_s2(signal, turning_rad_s, cog_m);
        let mut calmed = RingingRemoved::new((flown, vec![(signal.name.clone(), 1.0)]));
        calmed.take_off(fit, fit.from_s..f64::INFINITY, pull_m_s2);
        let mut calm = calmed.signal;
        let along = if signal.axis == Axis::Axial { -1.0 } else { 1.0 };
        for force in &mut calm.force_m_s2 {
            *force *= along;
        }
        let end = if signal.end == End::First { End::Second } else { End::First };
        Signal { end, position_m: length_m - signal.position_m, ..calm }
    };
    signals.iter().map(mirror).collect()
}

/// ω from the plateaus of the transverse channels, rad/s: minus the slope of the velocity steps over position
/// (16); 0 without a slope.
pub fn rotation_rad_s(signals: &[Signal], fit: &FlightFit) -> f64 {
    let across = signals.iter().filter(|s| s.axis == Axis::Transverse);
    rotation_from_names(across.map(|s| (&s.name[..], s.position_m)), fit)
}

/// ω from the names of the transverse channels and their positions, m.
pub fn rotation_from_names<'a>(across: impl Iterator<Item = (&'a str, f64)>, fit: &FlightFit) -> f64 {
    let points: Vec<(f64, f64)> = across
        .filter_map(|(name, position_m)| Some((position_m, fit.plateau(name)?.velocity_step_m_s)))
        .collect();
    -slope(&points)
}

/// Slope of the least-squares line through points (x, y); 0 if they determine none.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = as_f64(points.len().max(1));
    let mean = points.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let (square, product) = points
        .iter()
        .fold((0.0, 0.0), |(s, q), p| (s + (p.0 - mean.0).powi(2), q + (p.0 - mean.0) * (p.1 - mean.1)));
    if square > 0.0 { product / square } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;

    #[test]
    fn a_sensor_on_the_skin_flies_without_a_pull() {
        // 5 rad/s at 0.4 m below the axis: 10 m/s² from 10 ms on.
        let off = Signal { name: "A1".into(), offset_m: -0.4, ..example::signal(1e4, vec![10.0; 300]) };
        let mut end = RingingRemoved::new((off.clone(), vec![("A1".into(), 1.0), ("A2".into(), -1.0)]));
        let pull_m_s2 = end.pull_m_s2(&[off], 5.0, 2.5);
        end.take_off(&FlightFit::default(), 0.01..0.02, pull_m_s2);
        let force_m_s2 = &end.signal().force_m_s2;
        let mean = |range: Range<usize>| reduce::sum(&force_m_s2[range]) / 100.0;
        assert!(mean(100..200).abs() < 1e-9 && (mean(0..100) - 10.0).abs() < 1e-9, "{pull_m_s2}");
    }

    #[test]
    fn channels_off_the_axis_read_the_rotation_less_its_pull() {
        let omega_rad_s = 5.0;
        let channel = |name: &str, position_m: f64, offset_m: f64| Signal {
            name: name.into(),
            position_m,
            offset_m,
            ..example::signal(1e4, vec![])
        };
        let signals = [channel("A1", 0.5, 0.4), channel("A2", 4.5, -0.4)];
        // A contact from 10 to 18 ms, and 2 ms more to the flight's fit.
        let turned_s = 0.002 + 0.375 * 0.008;
        let plateau = |s: &Signal| Plateau {
            channel: s.name.clone(),
            velocity_step_m_s: 20.0 - omega_rad_s * (s.position_m + omega_rad_s * s.offset_m * turned_s),
            ..Plateau::default()
        };
        let fit = FlightFit {
            from_s: 0.020,
            plateaus: signals.iter().map(plateau).collect(),
            ..FlightFit::default()
        };
        let found_rad_s = spin_rad_s(&signals, &fit, 0.0, [0.010, 0.018]);
        assert!((found_rad_s - omega_rad_s).abs() < 1e-6, "{found_rad_s}");
    }
}
