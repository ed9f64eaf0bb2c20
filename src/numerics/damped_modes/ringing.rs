//! Values of e^((−ζ + i) ω t) for a damped mode, most of them by multiplying the previous value.

use super::series::Oscillation;
use crate::numerics::as_f64;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Values computed by multiplication before one is computed afresh: 256 products lose 1e-13 of the amplitude.
const LONGEST_RUN: usize = 256;

/// (−ζ + i) ω.
pub fn rate(mode: Oscillation) -> Complex<f64> {
    let omega = TAU * mode.frequency_hz;
    Complex::new(-mode.damping * omega, omega)
}

/// Yields e^((−ζ + i) ω t) at `start_s`, `start_s + step_s` and so on without end: the real part is the
/// cosine, the imaginary the sine.
pub fn uniform_ringing(mode: Oscillation, start_s: f64, step_s: f64) -> impl Iterator<Item = Complex<f64>> {
    let rate = rate(mode);
    let turn = (rate * step_s).exp();
    let mut value = Complex::new(1.0, 0.0);
    (0_usize..).map(move |i| {
        let time_s = start_s + as_f64(i) * step_s;
        value = if i.is_multiple_of(LONGEST_RUN) { (rate * time_s).exp() } else { value * turn };
        value
    })
}

/// Series that are computed in parallel: each step waits for the one before it.
const LANES: usize = 4;

/// Ringing at given times, if they are evenly spaced and at most [`LONGEST_RUN`] per lane; else `None`.
pub(super) fn evenly_spaced_ringing(mode: Oscillation, time_s: &[f64]) -> Option<Vec<Complex<f64>>> {
    let (&start_s, &second_s) = (time_s.first()?, time_s.get(1)?);
    let step_s = second_s - start_s;
    let is_even = time_s.windows(2).all(|t| (t[1] - t[0] - step_s).abs() < 1e-9 * step_s);
    if !is_even || time_s.len() > LANES * LONGEST_RUN {
        return None;
    }
    let rate = rate(mode);
    let turn = (rate * step_s).exp();
    let mut lanes = [(rate * start_s).exp(); LANES];
    for i in 1..LANES {
        lanes[i] = lanes[i - 1] * turn;
    }
    let far = turn * turn * turn * turn;
    let mut values = Vec::with_capacity(time_s.len() + LANES);
    while values.len() < time_s.len() {
        values.extend(lanes);
        lanes = lanes.map(|value| value * far);
    }
    values.truncate(time_s.len());
    Some(values)
}

/// Ringing at given increasing times, computed by rotation as long as they are evenly spaced.
pub(super) struct Ringing<'a> {
    time_s: &'a [f64],
    index: usize,
    rate: Complex<f64>,
    step_s: f64,
    turn: Complex<f64>,
    value: Complex<f64>,
}

impl<'a> Ringing<'a> {
    pub fn new(mode: Oscillation, time_s: &'a [f64]) -> Self {
        let rate = rate(mode);
        let step_s = time_s.get(1).map_or(0.0, |t| t - time_s[0]);
        Self { time_s, index: 0, rate, step_s, turn: (rate * step_s).exp(), value: Complex::new(0.0, 0.0) }
    }
}

impl Iterator for Ringing<'_> {
    type Item = Complex<f64>;

    fn next(&mut self) -> Option<Complex<f64>> {
        let t = *self.time_s.get(self.index)?;
        let before = self.index.checked_sub(1).map(|i| self.time_s[i]);
        let is_even = before.is_some_and(|b| (t - b - self.step_s).abs() < 1e-9 * self.step_s);
        let is_turned = is_even && !self.index.is_multiple_of(LONGEST_RUN);
        self.value = if is_turned { self.value * self.turn } else { (self.rate * t).exp() };
        self.index += 1;
        Some(self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODE: Oscillation = Oscillation { frequency_hz: 62.0, damping: 0.03 };

    fn direct(time_s: f64) -> Complex<f64> {
        let omega = TAU * 62.0;
        let (sin, cos) = (omega * time_s).sin_cos();
        Complex::new(cos, sin) * (-0.03 * omega * time_s).exp()
    }

    #[test]
    fn turning_on_is_the_function_itself() {
        // The largest value is e^(0.03·ω·10 ms) = 1.12; a run of 256 products loses 256 ε, the phase of 39
        // rad 39 ε.
        for (i, value) in (0_u32..50_000).zip(uniform_ringing(MODE, -0.01, 2e-6)) {
            assert!((value - direct(-0.01 + f64::from(i) * 2e-6)).norm() < 1e-13, "{i}");
        }
    }

    #[test]
    fn lanes_say_the_same() {
        let time_s: Vec<f64> = (0..241).map(|i| 1e-4 + f64::from(i) * 2.5e-4).collect();
        let values = evenly_spaced_ringing(MODE, &time_s).expect("even times");
        assert_eq!(values.len(), time_s.len());
        assert!(time_s.iter().zip(values).all(|(t, value)| (value - direct(*t)).norm() < 1e-12));
        assert!(evenly_spaced_ringing(MODE, &[0.0, 1.0, 3.0]).is_none());
    }

    #[test]
    fn a_gap_in_the_times_is_jumped() {
        let time_s: Vec<f64> =
            (0..240).filter(|i| !(60..75).contains(i)).map(|i| 1e-4 + f64::from(i) * 2.5e-4).collect();
        let values: Vec<_> = Ringing::new(MODE, &time_s).collect();
        assert_eq!(values.len(), time_s.len());
        for (t, value) in time_s.iter().zip(values) {
            // The uneven last digits of the times move the phase by up to 240 · 1e-17 · ω = 1e-12.
            assert!((value - direct(*t)).norm() < 1e-12, "{t}");
        }
    }
}
