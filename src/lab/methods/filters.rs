//! The forms of a low-pass to their round-off and time, over the cut-off.

use super::contest::{Contest, Method, worst_of_peak};
use crate::lab::chance::Chance;
use crate::lab::data::{TrialPoint, TrialRequest};
use crate::numerics::as_f64;
use crate::numerics::filter::stage::{StateVariable, forward_and_back};
use rayon::prelude::*;
use rustfft::num_traits::Float;
use std::f64::consts::{PI, SQRT_2};

/// Samples of the shortest record: a turn of the clock is then work, not overhead.
const SHORTEST: usize = 20_000;

/// A record of sines that a low-pass of this g = tan(π f/f_s) is laid on, and what it leaves of their middle.
struct FilterCase {
    gain: f64,
    samples: Vec<f64>,
    /// Samples after which either end is forgotten to 1e-16.
    silence: usize,
    truth: Vec<f64>,
}

impl FilterCase {
    /// Sines of a third, one and three of the design frequency: |H|² = 1/(1 + (tan(π f/f_s)/g)⁴) of each is left.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of samples, positive and below 2^52"
    )]
    fn of(design: f64, seed: u64, number: u32) -> Self {
        let (gain, mut chance) = ((PI * design).tan(), Chance::new(seed, u64::from(number)));
        // e^(−R 2π f t) = 1e-16 after 5.9 / (R f), R = sin 45°.
        let silence = (5.9 * SQRT_2 / design).ceil() as usize;
        let count = (2 * silence + (4.0 / design) as usize).max(SHORTEST);
        let sines = [1.0 / 3.0, 1.0, 3.0].map(|times| (times * design, chance.even(0.0, 2.0 * PI)));
        let sum = |is_left: bool, i: usize| -> f64 {
            let sine = |(share, phase): (f64, f64)| {
                let left = if is_left { 1.0 / (1.0 + ((PI * share).tan() / gain).powi(4)) } else { 1.0 };
                // The turns are taken off before the multiplication: 1e-16 of one is left at any sample.
                left * (2.0 * PI * (share * as_f64(i)).fract() + phase).sin()
            };
            sines.into_iter().map(sine).sum()
        };
        let samples = (0..count).map(|i| sum(false, i)).collect();
        Self { gain, samples, silence, truth: (silence..count - silence).map(|i| sum(true, i)).collect() }
    }

    fn error(&self, made: &[f64]) -> f64 {
        worst_of_peak(&made[self.silence..], &self.truth)
    }
}

fn contest() -> Contest<FilterCase, Vec<f64>> {
    Contest {
        family: "filter",
        error_unit: "of the peak",
        matters: 1e-3,
        samples: Some(|case| case.samples.len()),
        methods: vec![
            Method::new("state-variable", |case: &FilterCase| Some(state_variable(case.gain, &case.samples))),
            Method::new("direct-form sections", |case: &FilterCase| Some(direct(case.gain, &case.samples))),
            #[allow(clippy::cast_possible_truncation, reason = "single precision is what is tried")]
            Method::new("direct-form sections, f32", |case: &FilterCase| {
                let narrowed: Vec<f32> = case.samples.iter().map(|x| *x as f32).collect();
                Some(direct(case.gain, &narrowed).into_iter().map(f64::from).collect())
            }),
        ],
        error: |case, made| case.error(&made),
    }
}

/// Two trapezoidal integrators (26), forward and back from rest.
pub(super) fn state_variable(gain: f64, samples: &[f64]) -> Vec<f64> {
    let mut work = samples.to_vec();
    forward_and_back(&StateVariable::new(gain, SQRT_2), &mut work);
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

pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    contest().points(&[1e-1, 1e-2, 1e-3, 1e-4, 1e-5], request, |&design| {
        let count = if design < 1e-4 { request.either(1, 3) } else { request.either(3, 15) };
        let case = |number: u32| FilterCase::of(design, request.seed, number);
        (format!("order 2, f/fs = {design:e}"), (0..count).into_par_iter().map(case).collect())
    })
}
