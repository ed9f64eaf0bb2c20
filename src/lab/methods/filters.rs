//! The forms of a low-pass to their round-off and time, over the cut-off.

use super::contest::{Contest, Method};
use super::reference::{low_passed, worst_of_peak};
use crate::lab::chance::Chance;
use crate::lab::data::{TrialPoint, TrialRequest};
use crate::numerics::as_f64;
use crate::numerics::filter::stage::StateVariable;
use rayon::prelude::*;
use rustfft::num_traits::Float;
use rustfft::{FftPlanner, num_complex::Complex};
use std::f64::consts::{FRAC_PI_4, PI, SQRT_2};

/// Samples of the shortest record: a turn of the clock is then work, not overhead.
const SHORTEST: usize = 20_000;

/// A record that a low-pass of this g = tan(π f/f_s) is laid on.
struct FilterCase {
    gain: f64,
    samples: Vec<f64>,
    narrowed: Vec<f32>,
    truth: Vec<f64>,
}

impl FilterCase {
    #[allow(clippy::cast_possible_truncation, reason = "single precision is what is tried")]
    fn of(design: f64, seed: u64, number: u32) -> Self {
        let gain = (PI * design).tan();
        let samples = pulse(design, &mut Chance::new(seed, u64::from(number)), f64::from(number));
        let truth = low_passed(&samples, gain);
        Self { gain, narrowed: samples.iter().map(|x| *x as f32).collect(), samples, truth }
    }
}

fn contest() -> Contest<FilterCase, Vec<f64>> {
    Contest {
        family: "filter",
        error_unit: "of the peak",
        samples: Some(|case| case.samples.len()),
        methods: vec![
            Method::new("state-variable", |case: &FilterCase| Some(state_variable(case.gain, &case.samples))),
            Method::new("direct-form sections", |case: &FilterCase| Some(direct(case.gain, &case.samples))),
            Method::new("direct-form sections, f32", |case: &FilterCase| {
                Some(direct(case.gain, &case.narrowed).into_iter().map(f64::from).collect())
            }),
            Method::new("FFT", |case: &FilterCase| Some(by_spectrum(case.gain, &case.samples))),
        ],
        error: |case, made| worst_of_peak(&made, &case.truth),
    }
}

/// Two trapezoidal integrators (26), forward and back from rest.
pub(super) fn state_variable(gain: f64, samples: &[f64]) -> Vec<f64> {
    let (stage, mut work) = (StateVariable::new(gain, SQRT_2), samples.to_vec());
    stage.run(work.iter_mut(), &mut [0.0; 2]);
    stage.run(work.iter_mut().rev(), &mut [0.0; 2]);
    work
}

/// b (1 + z⁻¹)² / (1 + a₁ z⁻¹ + a₂ z⁻²) in transposed direct form II, forward and back from rest.
fn direct<T: Float>(gain: f64, samples: &[T]) -> Vec<T> {
    let (square, cross) = (gain * gain, SQRT_2 * gain);
    let coefficients = [square, 2.0 * (square - 1.0), 1.0 - cross + square];
    let [b, a1, a2] = coefficients.map(|x| T::from(x / (1.0 + cross + square)).unwrap_or_else(T::zero));
    let mut work = samples.to_vec();
    for _ in 0..2 {
        let (mut s1, mut s2) = (T::zero(), T::zero());
        for x in &mut work {
            let y = b * *x + s1;
            s1 = (b + b) * *x - a1 * y + s2;
            s2 = b * *x - a2 * y;
            *x = y;
        }
        work.reverse();
    }
    work
}

/// |H|² = 1/(1 + (tan(π f/f_s)/g)⁴) on the lines of the spectrum; silence at both ends closes the ring.
fn by_spectrum(gain: f64, samples: &[f64]) -> Vec<f64> {
    // The least of 2ⁿ, 3·2ⁿ, 9·2ⁿ that holds them all.
    let lengths = [1, 3, 9].map(|odd| odd * samples.len().div_ceil(odd).next_power_of_two());
    let length = lengths.into_iter().fold(usize::MAX, usize::min);
    let mut work: Vec<Complex<f64>> = samples.iter().map(|x| Complex::from(*x)).collect();
    work.resize(length, Complex::default());
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(length).process(&mut work);
    for (k, line) in work.iter_mut().enumerate() {
        let warped = (PI * as_f64(k.min(length - k)) / as_f64(length)).tan() / gain;
        *line /= as_f64(length) * (1.0 + warped.powi(4));
    }
    planner.plan_fft_inverse(length).process(&mut work);
    work[..samples.len()].iter().map(|c| c.re).collect()
}

/// A pulse with noise in the middle of silence so long that the filter forgets to 1e-16 before either end.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples, positive and below 2^52"
)]
fn pulse(design: f64, chance: &mut Chance, number: f64) -> Vec<f64> {
    // e^(−R 2π f t) = 1e-16 after 5.9 / (R f).
    let silence = 5.9 / (FRAC_PI_4.sin() * design);
    let half = 2.0 / design;
    let count = ((2.0 * (silence + half)).ceil() as usize).max(SHORTEST);
    let middle = 0.5 * as_f64(count) + number * 0.37;
    let at = |i: usize| {
        let t = (as_f64(i) - middle) / half;
        if t.abs() >= 1.0 { 0.0 } else { (0.5 * PI * t).cos().powi(4) + 0.01 * chance.normal() }
    };
    (0..count).map(at).collect()
}

pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    contest().points(&[1e-1, 1e-2, 1e-3, 1e-4, 1e-5], request, |&design| {
        let count = if design < 1e-4 { request.either(1, 3) } else { request.either(3, 15) };
        let case = |number: u32| FilterCase::of(design, request.seed, number);
        (format!("order 2, f/fs = {design:e}"), (0..count).into_par_iter().map(case).collect())
    })
}
