//! Ways to choose a cut-off to how well the filtered curve shows the peak of a pulse with ringing on it, and time.

use super::contest::{Contest, Method};
use crate::data::FilterChoice;
use crate::lab::chance::Chance;
use crate::lab::data::{TrialPoint, TrialRequest};
use crate::motion::cutoff_hz;
use crate::numerics::as_f64;
use crate::numerics::filter::ZeroPhaseLowPass;
use rayon::prelude::*;
use std::f64::consts::PI;

const RATE_HZ: f64 = 100_000.0;

/// A mass so large that the rule by mass asks for next to nothing, kg.
const NO_MASS_KG: f64 = 1e15;

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

const USUAL: PulseOfCask = PulseOfCask {
    name: "4.5 t, pulse of 10 ms, ringing of 20 %",
    mass_kg: 4.5e3,
    pulse_s: 1e-2,
    ringing: 0.2,
    noise: 0.02,
};
const CLASSES: [PulseOfCask; 5] = [
    PulseOfCask { name: "1 t, pulse of 5 ms, ringing of 20 %", mass_kg: 1e3, pulse_s: 5e-3, ..USUAL },
    USUAL,
    PulseOfCask { name: "100 t, pulse of 30 ms, ringing of 20 %", mass_kg: 1e5, pulse_s: 3e-2, ..USUAL },
    PulseOfCask { name: "4.5 t, pulse of 10 ms, no ringing", ringing: 0.0, ..USUAL },
    PulseOfCask { name: "4.5 t, pulse of 1 ms alone", pulse_s: 1e-3, ringing: 0.0, noise: 0.0, ..USUAL },
];

/// A half sine of height 1 between two silences, a mode of 4 to 20 of its frequencies set off with it, and noise.
struct RingingPulse {
    class: PulseOfCask,
    samples: Vec<f64>,
}

impl RingingPulse {
    #[allow(
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
            let t = as_f64(i) / RATE_HZ - silence_s;
            let pulse = if (0.0..pulse_s).contains(&t) { (PI * t / pulse_s).sin() } else { 0.0 };
            // 2 % of damping, as bolted steel has.
            let turn = 2.0 * PI * mode_hz * t;
            let ring = if t > 0.0 { ringing * (-0.02 * turn).exp() * turn.sin() } else { 0.0 };
            pulse + ring + noise * chance.normal()
        };
        Self { class, samples: (0..count).map(&mut sample).collect() }
    }
}

/// The filtered pulse, its cut-off chosen so of the mass and the pulse's length.
fn chosen(name: &str, hz: impl Fn(f64, f64) -> f64 + Sync + 'static) -> Method<RingingPulse, Vec<f64>> {
    Method::new(name, move |record: &RingingPulse| {
        let hz = hz(record.class.mass_kg, record.class.pulse_s);
        Some(ZeroPhaseLowPass::with_cutoff_hz(hz, RATE_HZ)?.apply(&record.samples))
    })
}

fn contest() -> Contest<RingingPulse, Vec<f64>> {
    let mut methods = vec![
        chosen("larger of mass and pulse", |kg, s| cutoff_hz(FilterChoice::Auto, kg, Some(s)).0),
        chosen("from the mass", |kg, _| cutoff_hz(FilterChoice::Auto, kg, None).0),
        chosen("from the pulse", |_, s| cutoff_hz(FilterChoice::Auto, NO_MASS_KG, Some(s)).0),
    ];
    methods.extend([60.0, 180.0, 600.0, 1000.0].map(|class| {
        chosen(&format!("CFC {class}"), move |kg, _| cutoff_hz(FilterChoice::Cfc(class), kg, None).0)
    }));
    Contest {
        family: "cut-off",
        error_unit: "of the pulse's peak",
        matters: 1e-2,
        samples: Some(|record| record.samples.len()),
        methods,
        error: |_, filtered| (filtered.into_iter().fold(f64::NEG_INFINITY, f64::max) - 1.0).abs(),
    }
}

pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    contest().points(&CLASSES, request, |class| {
        let record = |number: u32| RingingPulse::of(*class, request.seed, number);
        (class.name.to_owned(), (0..request.either(40, 400)).into_par_iter().map(record).collect())
    })
}
