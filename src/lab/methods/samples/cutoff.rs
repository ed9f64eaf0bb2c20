//! Ways to choose a cut-off to how well the filtered curve shows the peak of a pulse with ringing on it, and time.

use crate::data::FilterChoice;
use crate::lab::chance::Chance;
use crate::lab::data::{TrialMap, TrialPart, TrialRequest};
use crate::lab::methods::contest::{Contest, Purpose, by_class, map};
use crate::motion::cutoff_hz;
use crate::numerics::filter::ZeroPhaseLowPass;
use crate::numerics::spectrum::magnitude;
use rayon::prelude::*;
use std::f64::consts::PI;

const RATE_HZ: f64 = 100_000.0;

/// A way to choose.
#[derive(Clone, Copy, PartialEq)]
enum CutoffRule {
    Class(f64),
    Mass,
    Pulse,
    MassAndPulse,
    Spectrum,
}

const RULES: [CutoffRule; 8] = [
    CutoffRule::MassAndPulse,
    CutoffRule::Mass,
    CutoffRule::Pulse,
    CutoffRule::Spectrum,
    CutoffRule::Class(60.0),
    CutoffRule::Class(180.0),
    CutoffRule::Class(600.0),
    CutoffRule::Class(1000.0),
];

/// A mass so large that the rule by mass asks for next to nothing, kg.
const NO_MASS_KG: f64 = 1e15;
/// Share of the spectrum's largest line at which the cut-off from the spectrum is set.
const SPECTRUM_SHARE: f64 = 0.02;

impl CutoffRule {
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
    fn hz(self, record: &RingingPulse) -> f64 {
        let RingingPulse { samples, class: PulseOfCask { mass_kg, pulse_s, .. } } = record;
        match self {
            Self::Class(class) => cutoff_hz(FilterChoice::Cfc(class), *mass_kg, None).0,
            Self::Mass => cutoff_hz(FilterChoice::Auto, *mass_kg, None).0,
            Self::Pulse => cutoff_hz(FilterChoice::Auto, NO_MASS_KG, Some(*pulse_s)).0,
            Self::MassAndPulse => cutoff_hz(FilterChoice::Auto, *mass_kg, Some(*pulse_s)).0,
            Self::Spectrum => {
                let (frequency_hz, magnitude) = magnitude(samples, RATE_HZ);
                highest_above_hz(&frequency_hz, &magnitude, SPECTRUM_SHARE)
            }
        }
    }
}

/// What the cask does in the pulse.
#[derive(Clone, Copy)]
struct PulseOfCask {
    name: &'static str,
    mass_kg: f64,
    pulse_s: f64,
    /// Height of the ringing, of the pulse's.
    ringing: f64,
    /// Deviation of the noise, of the pulse's height.
    noise: f64,
}

const CLASSES: [PulseOfCask; 4] = [
    PulseOfCask { name: "1 t, pulse of 5 ms, ringing of 20 %", mass_kg: 1e3, pulse_s: 5e-3, ..USUAL },
    PulseOfCask { name: "4.5 t, pulse of 10 ms, ringing of 20 %", ..USUAL },
    PulseOfCask { name: "100 t, pulse of 30 ms, ringing of 20 %", mass_kg: 1e5, pulse_s: 3e-2, ..USUAL },
    PulseOfCask { name: "4.5 t, pulse of 10 ms, no ringing", ringing: 0.0, ..USUAL },
];

const USUAL: PulseOfCask = PulseOfCask { name: "", mass_kg: 4.5e3, pulse_s: 1e-2, ringing: 0.2, noise: 0.02 };

/// A half sine of height 1 between two silences, a mode of 4 to 20 of its frequencies set off with it, and noise.
struct RingingPulse {
    class: PulseOfCask,
    samples: Vec<f64>,
}

impl RingingPulse {
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of samples, positive and below 2^52"
    )]
    fn of(class: PulseOfCask, seed: u64, number: u32) -> Self {
        let PulseOfCask { pulse_s, ringing, noise, .. } = class;
        let mut chance = Chance::new(seed, u64::from(number));
        let mode_hz = 0.5 / pulse_s * 4.0 * 5.0_f64.powf(chance.even(0.0, 1.0));
        let silence_s = pulse_s.max(0.05);
        let count = ((2.0 * silence_s + pulse_s) * RATE_HZ) as usize;
        let mut sample = |i: usize| {
            let t = i as f64 / RATE_HZ - silence_s;
            let pulse = if (0.0..pulse_s).contains(&t) { (PI * t / pulse_s).sin() } else { 0.0 };
            // 2 % of damping, as bolted steel has.
            let turn = 2.0 * PI * mode_hz * t;
            let ring = if t > 0.0 { ringing * (-0.02 * turn).exp() * turn.sin() } else { 0.0 };
            pulse + ring + noise * chance.normal()
        };
        Self { class, samples: (0..count).map(&mut sample).collect() }
    }
}

fn contest() -> Contest<CutoffRule, RingingPulse, Vec<f64>> {
    Contest {
        purpose: Purpose::of_samples("cut-off", "of the pulse's peak"),
        methods: RULES.to_vec(),
        default: CutoffRule::MassAndPulse,
        name: CutoffRule::name,
        run: |rule, record| {
            let filter = ZeroPhaseLowPass::with_cutoff_hz(rule.hz(record), RATE_HZ)?;
            Some(filter.apply(&record.samples))
        },
        error: |_, filtered| (filtered.into_iter().fold(f64::NEG_INFINITY, f64::max) - 1.0).abs(),
        parts: |record| record.samples.len(),
    }
}

/// Where the rules fail: pulses that grow short.
fn maps(request: &TrialRequest) -> Vec<TrialMap> {
    let stresses: Vec<f64> = (8..=24).map(|eighth| 10_f64.powf(0.125 * f64::from(eighth))).collect();
    let lines = contest().lines(&stresses, |per_s| {
        let class = PulseOfCask { pulse_s: 1.0 / per_s, ringing: 0.0, noise: 0.0, ..USUAL };
        vec![RingingPulse::of(class, request.seed, 0)]
    });
    let words = [
        "cutoff-over-pulse",
        "The filtered peak of a half sine that grows short, cask of 4.5 t",
        "1 over the pulse's length, 1/s",
        "error of the peak, of the peak",
    ];
    vec![map(words, stresses, 0.01, lines)]
}

/// The whole job.
pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let count = if request.quick { 40 } else { 400 };
    let part = by_class(&CLASSES, &|share| progress(0.9 * share), |class| {
        let record = |number: u32| RingingPulse::of(*class, request.seed, number);
        let records: Vec<RingingPulse> = (0..count).into_par_iter().map(record).collect();
        contest().points(class.name, &records, 1, request)
    });
    TrialPart { maps: maps(request), ..part }
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
