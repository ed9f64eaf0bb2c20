//! Computes the reading of a channel that bending tilts.

use crate::data::{Axis, Cask, FlightFit, Mode, Signal};
use crate::numerics::free_beam::shape;
use std::f64::consts::TAU;

/// Share of the length over which the slope of a shape is determined.
const STEP: f64 = 1e-4;

/// Mean reading of a channel in the flight because bending by w tilts its place, m/s²: along the axis by w′
/// towards a force of ẅ across it, across the axis at η the centrifugal force of ẇ′   (49)
pub(super) fn tilt_m_s2(signal: &Signal, signals: &[Signal], flight: &FlightFit, cask: &Cask) -> f64 {
    let length_m = cask.length_m;
    let across = signals.iter().filter(|s| s.axis == Axis::Transverse);
    let far_m = |s: &Signal| (s.position_m - signal.position_m).abs();
    let nearest = across.min_by(|a, b| far_m(a).total_cmp(&far_m(b)));
    let Some((near, plateau)) = nearest.and_then(|s| Some((s, flight.plateau(&s.name)?))) else { return 0.0 };
    let share = signal.position_m / length_m;
    let mode_m_s2 = |((mode, order), (a, b)): ((&Mode, u8), &(f64, f64))| {
        let (here, there) = (shape(order, share), shape(order, near.position_m / length_m));
        let slope = (shape(order, share + STEP) - shape(order, share - STEP)) / (2.0 * STEP * length_m);
        let faded = 2.0 * mode.damping * TAU * mode.frequency_hz * (flight.to_s - flight.from_s);
        let mean = if faded > 0.0 { -(-faded).exp_m1() / faded } else { 1.0 };
        // Near a node of the shape the neighbouring channel does not show this place.
        let is_shown = order > 0 && there.abs() > 0.5;
        let towards = if signal.axis == Axis::Axial { here } else { signal.offset_m * slope };
        if is_shown { -0.5 * slope * towards / (there * there) * (a * a + b * b) * mean } else { 0.0 }
    };
    let orders = flight.bending_orders(signals, cask);
    flight.modes.iter().zip(orders).zip(&plateau.ringing_m_s).map(mode_m_s2).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{End, Plateau, example};

    #[test]
    fn a_channel_reads_the_square_of_the_bending_with_a_sign_for_each_end_or_side() {
        let signal = |name: &str, end, axis, position_m| Signal {
            name: name.into(),
            end,
            axis,
            position_m,
            ..example::signal(1e4, vec![])
        };
        let mut signals = [
            signal("A1", End::First, Axis::Transverse, 0.25),
            signal("A2", End::Second, Axis::Transverse, 4.75),
            signal("X1", End::First, Axis::Axial, 0.25),
            signal("X2", End::Second, Axis::Axial, 4.75),
        ];
        let plateau = |name: &str| Plateau { ringing_m_s: vec![(3.0, 4.0)], ..example::plateau(name, 0.0) };
        let mode = Mode { frequency_hz: 80.0, damping: 0.0, amplitude_m_s: 5.0 };
        let plateaus = vec![plateau("A1"), plateau("A2"), plateau("X1"), plateau("X2")];
        let flight = FlightFit { modes: vec![mode], ..example::flight(0.0, 0.1, plateaus) };
        let reads = |i: usize| tilt_m_s2(&signals[i], &signals, &flight, &example::cask(1.0, 5.0, 0.0));
        // w′ ẅ of w = φ q: −φ′ φ (ω q)²/2 in the mean; φ = 1.536, φ′ = −9.25/5 m at 0.05 of the length.
        let wanted = 0.5 * 9.25 / 5.0 / 1.536 * 25.0;
        assert!((reads(2) / wanted - 1.0).abs() < 0.01, "{} {wanted}", reads(2));
        assert!((reads(2) + reads(3)).abs() < 1e-9 && reads(0).abs() < f64::EPSILON);
        // −η (φ′ ω q)²/2.
        signals[0].offset_m = 0.5;
        let read = tilt_m_s2(&signals[0], &signals, &flight, &example::cask(1.0, 5.0, 0.0));
        assert!((read / (-0.5 * 9.25 / 5.0 / 1.536 * wanted) - 1.0).abs() < 0.01, "{read}");
    }
}
