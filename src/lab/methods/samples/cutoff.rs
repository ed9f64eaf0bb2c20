//! Ways to choose a cut-off to how well the filtered curve shows the peak of a pulse with ringing on it, and time.

use super::summary::{Family, chance, silent_line};
use crate::data::FilterChoice;
use crate::lab::data::{TrialMap, TrialPart, TrialPoint, TrialRequest};
use crate::lab::methods::timing::{Effort, Work, in_turn};
use crate::motion::cutoff_hz;
use crate::numerics::filter::ZeroPhaseLowPass;
use crate::numerics::spectrum::magnitude;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::hint::black_box;

const FAMILY: Family = Family { name: "cut-off", error_unit: "of the pulse's peak", time_per: "sample" };

const RATE_HZ: f64 = 100_000.0;

/// A way to choose.
#[derive(Clone, Copy, PartialEq)]
enum Choice {
    Class(f64),
    Mass,
    Pulse,
    MassAndPulse,
    Spectrum,
}

const CHOICES: [Choice; 8] = [
    Choice::MassAndPulse,
    Choice::Mass,
    Choice::Pulse,
    Choice::Spectrum,
    Choice::Class(60.0),
    Choice::Class(180.0),
    Choice::Class(600.0),
    Choice::Class(1000.0),
];

/// A mass so large that the rule by mass asks for next to nothing, kg.
const NO_MASS_KG: f64 = 1e15;
/// Share of the spectrum's largest line at which the cut-off from the spectrum is set.
const SPECTRUM_SHARE: f64 = 0.02;

impl Choice {
    fn name(self) -> String {
        match self {
            Self::Class(class) => format!("CFC {class}"),
            Self::Mass => "from the mass".to_owned(),
            Self::Pulse => "from the pulse".to_owned(),
            Self::MassAndPulse => "larger of mass and pulse".to_owned(),
            Self::Spectrum => "from the spectrum".to_owned(),
        }
    }

    /// −3 dB frequency of both passes, Hz.
    fn hz(self, mass_kg: f64, pulse_s: f64, samples: &[f64]) -> f64 {
        match self {
            Self::Class(class) => cutoff_hz(FilterChoice::Cfc(class), mass_kg, None).0,
            Self::Mass => cutoff_hz(FilterChoice::Auto, mass_kg, None).0,
            Self::Pulse => cutoff_hz(FilterChoice::Auto, NO_MASS_KG, Some(pulse_s)).0,
            Self::MassAndPulse => cutoff_hz(FilterChoice::Auto, mass_kg, Some(pulse_s)).0,
            Self::Spectrum => {
                let (frequency_hz, magnitude) = magnitude(samples, RATE_HZ);
                highest_above_hz(&frequency_hz, &magnitude, SPECTRUM_SHARE)
            }
        }
    }

    fn filtered(self, mass_kg: f64, pulse_s: f64, samples: &[f64]) -> Option<Vec<f64>> {
        let hz = self.hz(mass_kg, pulse_s, samples);
        Some(ZeroPhaseLowPass::with_cutoff_hz(hz, RATE_HZ)?.apply(samples))
    }

    /// Error of the peak, of the peak.
    fn error(self, mass_kg: f64, pulse_s: f64, samples: &[f64]) -> Option<f64> {
        let peak = self.filtered(mass_kg, pulse_s, samples)?.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Some((peak - 1.0).abs())
    }
}

struct Class {
    name: &'static str,
    mass_kg: f64,
    pulse_s: f64,
    /// Height of the ringing, of the pulse's.
    ringing: f64,
}

const CLASSES: [Class; 4] = [
    Class { name: "1 t, pulse of 5 ms, ringing of 20 %", mass_kg: 1e3, pulse_s: 5e-3, ringing: 0.2 },
    Class { name: "4.5 t, pulse of 10 ms, ringing of 20 %", mass_kg: 4.5e3, pulse_s: 1e-2, ringing: 0.2 },
    Class { name: "100 t, pulse of 30 ms, ringing of 20 %", mass_kg: 1e5, pulse_s: 3e-2, ringing: 0.2 },
    Class { name: "4.5 t, pulse of 10 ms, no ringing", mass_kg: 4.5e3, pulse_s: 1e-2, ringing: 0.0 },
];

/// A half sine of height 1 between two silences, a mode of 4 to 20 of its frequencies set off with it, 2 % of noise.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples, positive and below 2^52"
)]
fn made(pulse_s: f64, ringing: f64, noise: f64, (seed, case): (u64, u32)) -> Vec<f64> {
    let mut generator = chance(seed, case);
    let mode_hz = 0.5 / pulse_s * 4.0 * 5.0_f64.powf(generator.random::<f64>());
    let silence_s = pulse_s.max(0.05);
    let count = ((2.0 * silence_s + pulse_s) * RATE_HZ) as usize;
    (0..count)
        .map(|i| {
            let t = i as f64 / RATE_HZ - silence_s;
            let pulse = if (0.0..pulse_s).contains(&t) { (PI * t / pulse_s).sin() } else { 0.0 };
            // 2 % of damping, as bolted steel has.
            let turn = 2.0 * PI * mode_hz * t;
            let ring = if t > 0.0 { ringing * (-0.02 * turn).exp() * turn.sin() } else { 0.0 };
            let sampled: f64 = StandardNormal.sample(&mut generator);
            pulse + ring + noise * sampled
        })
        .collect()
}

/// Speed-accuracy points of every class.
pub(super) fn points(request: &TrialRequest, effort: Option<Effort>) -> Vec<TrialPoint> {
    let cases = if request.quick { 40 } else { 400 };
    let mut points = Vec::new();
    for class in &CLASSES {
        let Class { mass_kg, pulse_s, ringing, .. } = *class;
        let errors: Vec<Vec<f64>> = (0..cases)
            .into_par_iter()
            .map(|case| {
                let x = made(pulse_s, ringing, 0.02, (request.seed, case));
                CHOICES.iter().map(|c| c.error(mass_kg, pulse_s, &x).unwrap_or(f64::NAN)).collect()
            })
            .collect();
        let timings = effort.map(|effort| {
            let x = made(pulse_s, ringing, 0.02, (request.seed, 0));
            let mut work: Vec<Work> = CHOICES
                .iter()
                .map(|choice| -> Work {
                    let x = &x;
                    Box::new(move || drop(black_box(choice.filtered(mass_kg, pulse_s, black_box(x)))))
                })
                .collect();
            in_turn(&mut work, effort).into_iter().map(|t| t.per(x.len())).collect::<Vec<_>>()
        });
        for (i, choice) in CHOICES.iter().enumerate() {
            let errors = errors.iter().map(|case| case[i]).collect();
            let timing = timings.as_ref().and_then(|t| t.get(i).copied());
            let is_default = *choice == Choice::MassAndPulse;
            points.push(FAMILY.point((&choice.name(), class.name), is_default, errors, timing));
        }
    }
    points
}

/// Where the ways fail: pulses that grow short.
pub(super) fn maps(request: &TrialRequest) -> Vec<TrialMap> {
    let stresses: Vec<f64> = (8..=24).map(|eighth| 10_f64.powf(0.125 * f64::from(eighth))).collect();
    let columns: Vec<Vec<Option<f64>>> = stresses
        .par_iter()
        .map(|per_s| {
            let x = made(1.0 / per_s, 0.0, 0.0, (request.seed, 0));
            CHOICES.iter().map(|choice| choice.error(4.5e3, 1.0 / per_s, &x)).collect()
        })
        .collect();
    let line = |(i, choice): (usize, &Choice)| {
        silent_line(&choice.name(), columns.iter().map(|column| column[i]).collect())
    };
    vec![TrialMap {
        name: "cutoff-over-pulse".to_owned(),
        title: "The filtered peak of a half sine that grows short, cask of 4.5 t".to_owned(),
        stress: "1 over the pulse's length, 1/s".to_owned(),
        is_log: true,
        stresses,
        error: "error of the peak, of the peak".to_owned(),
        limit: 0.01,
        lines: CHOICES.iter().enumerate().map(line).collect(),
    }]
}

/// The whole job.
pub(super) fn run(request: &TrialRequest, done: &dyn Fn(f64)) -> TrialPart {
    let points = points(request, Some(Effort::of(request.quick)));
    done(0.9);
    TrialPart { points, maps: maps(request) }
}

/// The highest frequency, Hz, at which the magnitude exceeds this share of its largest, by [`magnitude`]'s answer; 0 for an empty one.
fn highest_above_hz(frequency_hz: &[f64], magnitude: &[f64], share: f64) -> f64 {
    let largest = magnitude.iter().copied().fold(0.0, f64::max);
    let last = magnitude.iter().rposition(|m| *m > share * largest);
    last.and_then(|line| frequency_hz.get(line)).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_highest_line_of_two_sines_is_that_of_the_faster() {
        let turn = |i: i32| f64::from(i) * std::f64::consts::TAU;
        let wave: Vec<f64> = (0..256).map(|i| (turn(i) / 16.0).sin() + 0.1 * (turn(i) / 4.0).sin()).collect();
        let (f, m) = magnitude(&wave, 256.0);
        assert!((highest_above_hz(&f, &m, 0.05) - 64.0).abs() < 1e-9);
        assert!((highest_above_hz(&f, &m, 0.2) - 16.0).abs() < 1e-9);
        assert!(highest_above_hz(&[], &[], 0.5).abs() < 1e-300);
    }
}
