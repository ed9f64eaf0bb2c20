//! Force that drove a series' modes before it begins, and the initial phase that follows.

use super::series::Oscillation;
use crate::numerics::as_f64;
use nalgebra::Complex;

/// A force of known shape and unknown size that ended before a series begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Time before t = 0 at which the force began, s.
    pub age_s: f64,
    /// Length of a step, s.
    pub step_s: f64,
    /// Integral of the force over each step, in any unit.
    pub impulses: Vec<f64>,
}

impl Drive {
    /// Z / |Z| at t = 0, Z = Σ impulse e^((−ζ + i) ω age): a mode at rest before, so driven, rings on as Re(Z
    /// e^((−ζ + i) ω t))   (36)
    pub fn phase(&self, mode: Oscillation) -> Complex<f64> {
        let [turn, half_turn, aged] = self.mode_factors(mode);
        let nothing = Complex::new(0.0, 0.0);
        // Four sums run in parallel, each of every fourth impulse: a product waits for the one before it.
        let (head, blocks) = self.impulses.as_rchunks::<4>();
        let head = head.iter().fold(nothing, |z, impulse| z * turn + *impulse);
        let far = turn * turn * turn * turn;
        let sums = blocks.iter().fold([nothing, nothing, nothing, head], |sums, block| {
            [0, 1, 2, 3].map(|i| sums[i] * far + block[i])
        });
        let z = sums.iter().fold(nothing, |z, sum| z * turn + sum);
        let driven = z * half_turn * aged;
        if driven.norm() > 0.0 { driven / driven.norm() } else { Complex::new(1.0, 0.0) }
    }

    /// Change of ln Z with (−ζ + i) ω: the mean age of the force on the mode, s.
    pub(super) fn age_s(&self, mode: Oscillation) -> Complex<f64> {
        let (driven, by_rate) = self.integral_and_slope(mode);
        if driven.norm() > 0.0 { by_rate / driven } else { Complex::new(0.0, 0.0) }
    }

    /// Z, and its derivative with respect to (−ζ + i) ω.
    fn integral_and_slope(&self, mode: Oscillation) -> (Complex<f64>, Complex<f64>) {
        let [turn, half_turn, aged] = self.mode_factors(mode);
        let half_s = self.step_s / 2.0;
        let nothing = Complex::new(0.0, 0.0);
        let step = |(z, by_rate): (Complex<f64>, Complex<f64>), impulse: &f64| {
            let (aged, added) = (z * turn, half_turn * *impulse);
            (aged + added, by_rate * turn + aged * self.step_s + added * half_s)
        };
        let (z, by_rate) = self.impulses.iter().fold((nothing, nothing), step);
        (z * aged, (by_rate + z * self.time_since_end_s()) * aged)
    }

    /// Time before t = 0 at which the force ended, s.
    fn time_since_end_s(&self) -> f64 {
        self.age_s - as_f64(self.impulses.len()) * self.step_s
    }

    /// Factors of a mode for a step, for half a step, and for the time from the end of the force on.
    fn mode_factors(&self, mode: Oscillation) -> [Complex<f64>; 3] {
        let rate = super::ringing::rate(mode);
        [self.step_s, self.step_s / 2.0, self.time_since_end_s()].map(|time_s| (rate * time_s).exp())
    }
}

/// Components of a series beside its plateau.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Form<'a> {
    /// True if the series drifts.
    pub drift: bool,
    /// Force that drove its modes; `None`: each mode has an independent phase in each series.
    pub drive: Option<&'a Drive>,
}

impl Form<'_> {
    /// Free phases.
    pub const fn free(drift: bool) -> Form<'static> {
        Form { drift, drive: None }
    }

    /// Number of unknowns that a mode adds to a series.
    pub fn width(&self) -> usize {
        if self.drive.is_some() { 1 } else { 2 }
    }

    /// Converts coefficients of the modes to amplitudes of cosine and sine.
    pub(super) fn amplitudes(&self, modes: &[Oscillation], coefficients: &[f64]) -> Vec<(f64, f64)> {
        match self.drive {
            Some(drive) => {
                let parts = |(mode, size): (&Oscillation, &f64)| {
                    let phase = drive.phase(*mode);
                    (size * phase.re, -size * phase.im)
                };
                modes.iter().zip(coefficients).map(parts).collect()
            }
            None => coefficients.chunks_exact(2).map(|c| (c[0], c[1])).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Seeds, Series, fit};
    use super::*;
    use std::f64::consts::TAU;

    /// A mode struck by a half sine of 5 ms that ended 1 ms before the series: ∫ F(τ) e^(−ζω(t−τ)) cos ω(t−τ)
    /// dτ, summed finely.
    fn struck(mode: Oscillation, t_s: f64) -> f64 {
        let (omega, steps) = (TAU * mode.frequency_hz, 2000);
        (0..steps)
            .map(|i| {
                let tau_s = 5e-3 * (f64::from(i) + 0.5) / f64::from(steps);
                let since_s = t_s + 6e-3 - tau_s;
                let force = (std::f64::consts::PI * tau_s / 5e-3).sin() / f64::from(steps);
                force * (-mode.damping * omega * since_s).exp() * (omega * since_s).cos()
            })
            .sum()
    }

    #[test]
    fn a_flight_shorter_than_half_a_period_is_resolved_by_the_drive() {
        // 12 ms of a 31 Hz mode with 3 % damping on plateaus of 20 and −7.
        let truth = Oscillation { frequency_hz: 31.0, damping: 0.03 };
        let series: Vec<Series> = [(20.0, 9.0), (-7.0, 6.0)]
            .into_iter()
            .map(|(plateau, size)| {
                let time_s: Vec<f64> = (0..120).map(|i| f64::from(i) * 1e-4).collect();
                let value = time_s.iter().map(|&t| plateau + size * struck(truth, t)).collect();
                Series { time_s, value, steps_s: vec![], floor: 1e-4 }
            })
            .collect();
        let half_sine = |i: i32| (std::f64::consts::PI * (f64::from(i) + 0.5) / 100.0).sin();
        let drive = Drive { age_s: 6e-3, step_s: 5e-5, impulses: (0..100).map(half_sine).collect() };
        let form = Form { drift: false, drive: Some(&drive) };
        let fit =
            fit(&series, &[], Some(&Seeds::new(&series, (20.0, 600.0), Some(&drive))), form).expect("a fit");
        assert!((fit.modes[0].frequency_hz - 31.0).abs() < 0.1, "{fit:?}");
        // The grids of drive and truth differ by (ωh)²/24 = 1e-6 of the amplitude, which a window this short
        // blows up a hundredfold.
        assert!((fit.series[0].plateau - 20.0).abs() < 2e-3, "{fit:?}");
        assert!((fit.series[1].plateau + 7.0).abs() < 2e-3);
    }

    #[test]
    fn nothing_that_drives_is_no_phase_of_its_own() {
        let drive = Drive { age_s: 1.0, step_s: 0.1, impulses: vec![0.0; 5] };
        assert_eq!(drive.phase(Oscillation { frequency_hz: 1.0, damping: 0.0 }), Complex::new(1.0, 0.0));
    }
}
