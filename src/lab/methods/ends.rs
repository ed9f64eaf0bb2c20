//! The ways to continue a record beyond its ends to what they do to the ends.

use super::contest::{Contest, Method};
use crate::lab::chance::Chance;
use crate::lab::data::{TrialPoint, TrialRequest};
use crate::numerics::as_f64;
use crate::numerics::filter::ZeroPhaseLowPass;
use crate::numerics::filter::ends::{continued, cut};
use crate::numerics::filter::stage::{StateVariable, forward_and_back};
use rayon::prelude::*;
use std::f64::consts::{PI, SQRT_2};

/// Design frequency over sample rate.
const DESIGN: f64 = 1e-3;
/// Samples of the record that is filtered, 20/f; and of what stands before and behind it in the truth.
const RECORD: usize = 20_000;
const BEYOND: usize = 10_000;
/// Samples of each end that is looked at, 0.25/f.
const END: usize = 250;
/// Three times the coefficients of a second-order section, as `scipy.signal.sosfiltfilt` continues.
const NINE: usize = 9;

/// A record cut from a longer one.
struct CutRecord {
    samples: Vec<f64>,
    /// The longer one filtered, cut in the same way.
    truth: Vec<f64>,
}

impl CutRecord {
    /// Noise on a slope, in the filter's own noise a 1/f.
    fn of(slope: f64, seed: u64, number: u32) -> Self {
        let mut chance = Chance::new(seed, u64::from(number));
        let noise: Vec<f64> = (0..RECORD + 2 * BEYOND).map(|_| chance.normal()).collect();
        let slope = slope * own_noise() * DESIGN;
        let cut = |whole: &[f64]| -> Vec<f64> {
            let on_slope = |(i, x): (usize, &f64)| x + slope * (as_f64(i) - 0.5 * as_f64(RECORD));
            whole.iter().enumerate().map(on_slope).skip(BEYOND).take(RECORD).collect()
        };
        // The slope is a line: it passes the filter as it is.
        Self { samples: cut(&noise), truth: cut(&not_continued(&noise)) }
    }

    /// Filtered, its ends continued by `pad` samples that `beyond` makes of the end sample and the one as far inside.
    fn continued(&self, pad: usize, beyond: fn(f64, f64) -> f64) -> Vec<f64> {
        let (mut work, head) = continued(&self.samples, pad, beyond);
        forward_and_back(&StateVariable::new(gain(), SQRT_2), &mut work);
        cut(work, head, RECORD)
    }

    /// Root mean square error over both ends, in the filter's own noise.
    fn error(&self, made: &[f64]) -> f64 {
        let ends = (0..END).chain(RECORD - END..RECORD);
        let square: f64 = ends.map(|i| (made[i] - self.truth[i]).powi(2)).sum();
        (square / as_f64(2 * END)).sqrt() / own_noise()
    }
}

/// Both passes, started in the steady state of the end samples.
fn not_continued(samples: &[f64]) -> Vec<f64> {
    let mut work = samples.to_vec();
    forward_and_back(&StateVariable::new(gain(), SQRT_2), &mut work);
    work
}

/// g = tan(π f/f_s).
fn gain() -> f64 {
    (PI * DESIGN).tan()
}

/// Deviation of unit white noise behind both passes: √(∫ |H|² df · 2/f_s), |H| = 1/(1 + (f/f0)⁴).
fn own_noise() -> f64 {
    // ∫ 1/(1+x⁴)² dx over 0..∞ is 3π/(8√2); the noise's density is 2/f_s one-sided.
    (2.0 * DESIGN * 3.0 * PI / (8.0 * SQRT_2)).sqrt()
}

fn contest() -> Contest<CutRecord, Vec<f64>> {
    Contest {
        family: "record ends",
        error_unit: "of the filter's own noise",
        matters: 1.0,
        samples: Some(|record| record.samples.len()),
        methods: vec![
            Method::new("even", |record: &CutRecord| {
                Some(ZeroPhaseLowPass::with_design_hz(DESIGN, 1.0)?.apply(&record.samples))
            }),
            Method::new("odd, 9 samples", |record: &CutRecord| {
                Some(record.continued(NINE, |end, x| 2.0 * end - x))
            }),
            Method::new("none", |record: &CutRecord| Some(not_continued(&record.samples))),
        ],
        error: |record, made| record.error(&made),
    }
}

pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    let classes = [("noise", 0.0), ("noise on a gentle slope", 3.0), ("noise on a steep slope", 100.0)];
    contest().points(&classes, request, |&(class, slope)| {
        let record = |number: u32| CutRecord::of(slope, request.seed, number);
        (class.to_owned(), (0..request.either(24, 200)).into_par_iter().map(record).collect())
    })
}
