//! The ways to continue a record beyond its ends to what they do to the ends.

use super::reference::low_passed;
use super::summary::{DIVERGED, Family, chance, silent_line};
use crate::lab::data::{TrialMap, TrialPart, TrialPoint, TrialRequest};
use crate::lab::methods::rivals::filter::{EndPadding, FilterForm, LowPass};
use crate::lab::methods::timing::{Effort, Work, in_turn};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::hint::black_box;

const FAMILY: Family =
    Family { name: "record ends", error_unit: "of the filter's own noise", time_per: "sample" };

/// Length of the record that is filtered, over 1/f; and what stands before and behind it in the truth.
const RECORD: f64 = 20.0;
const BEYOND: f64 = 10.0;
/// The ends that are looked at, over 1/f.
const END: f64 = 0.25;

/// A record cut from a longer one.
struct Scene {
    design: f64,
    /// Slope of the signal at both ends, in the filter's own noise a 1/f.
    slope: f64,
}

impl Scene {
    /// The cut record, its true filtered self from the longer one, and the filter's own noise.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of samples, positive and below 2^52"
    )]
    fn made(&self, seed: u64, case: u32) -> (Vec<f64>, Vec<f64>, f64) {
        let samples = |lengths: f64| (lengths / self.design).round() as usize;
        let (before, count) = (samples(BEYOND), samples(RECORD));
        let mut generator = chance(seed, case);
        let noise: Vec<f64> =
            (0..count + 2 * before).map(|_| StandardNormal.sample(&mut generator)).collect();
        let own = own_noise(self.design);
        let with_slope =
            |(i, x): (usize, &f64)| x + self.slope * own * self.design * (i as f64 - 0.5 * count as f64);
        let long: Vec<f64> = noise.iter().enumerate().map(with_slope).collect();
        // The slope is a line: it passes the filter as it is, and the reference's rest at its own ends would not let it.
        let smooth = low_passed(&noise, 2, self.design);
        let truth: Vec<f64> = smooth.iter().enumerate().map(with_slope).collect();
        (long[before..before + count].to_vec(), truth[before..before + count].to_vec(), own)
    }

    /// Root mean square error over both ends, in the filter's own noise; `None` where there is no such filter.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of samples, positive and below 2^52"
    )]
    fn error(&self, ends: EndPadding, (x, truth, own): &(Vec<f64>, Vec<f64>, f64)) -> Option<f64> {
        let made = LowPass::new(2, self.design, FilterForm::default(), ends)?.apply(x);
        let reach = ((END / self.design).ceil() as usize).max(1);
        let at_end = |i: &usize| *i < reach || *i + reach >= x.len();
        let square: f64 = (0..x.len()).filter(at_end).map(|i| (made[i] - truth[i]).powi(2)).sum();
        Some((square / (2 * reach) as f64).sqrt() / own)
    }
}

/// Deviation of unit white noise behind both passes: √(∫ |H|² df · 2/f_s), |H| = 1/(1 + (f/f0)⁴).
fn own_noise(design: f64) -> f64 {
    // ∫ 1/(1+x⁴)² dx over 0..∞ is 3π/(8√2); the noise's density is 2/f_s one-sided.
    (2.0 * design * 3.0 * std::f64::consts::PI / (8.0 * 2.0_f64.sqrt())).sqrt()
}

/// Median error over cases for every way.
fn errors(scene: &Scene, seed: u64, cases: u32) -> Vec<Vec<f64>> {
    (0..cases)
        .into_par_iter()
        .map(|case| {
            let made = scene.made(seed, case);
            EndPadding::ALL.iter().map(|ends| scene.error(*ends, &made).unwrap_or(DIVERGED)).collect()
        })
        .collect()
}

/// Speed-accuracy points of every class.
pub(super) fn points(request: &TrialRequest, effort: Option<Effort>) -> Vec<TrialPoint> {
    let classes = [
        ("noise", Scene { design: 1e-3, slope: 0.0 }),
        ("noise on a gentle slope", Scene { design: 1e-3, slope: 3.0 }),
        ("noise on a steep slope", Scene { design: 1e-3, slope: 100.0 }),
    ];
    let cases = if request.quick { 24 } else { 200 };
    let mut points = Vec::new();
    for (class, scene) in classes {
        let errors = errors(&scene, request.seed, cases);
        let timings = effort.map(|effort| {
            let (x, _, _) = scene.made(request.seed, 0);
            let mut work: Vec<Work> = EndPadding::ALL
                .iter()
                .map(|ends| -> Work {
                    let (filter, x) = (LowPass::new(2, scene.design, FilterForm::default(), *ends), &x);
                    Box::new(move || drop(black_box(filter.as_ref().map(|f| f.apply(black_box(x))))))
                })
                .collect();
            in_turn(&mut work, effort).into_iter().map(|t| t.per(x.len())).collect::<Vec<_>>()
        });
        for (i, ends) in EndPadding::ALL.iter().enumerate() {
            let errors = errors.iter().map(|case| case[i]).collect();
            let timing = timings.as_ref().and_then(|t| t.get(i).copied());
            points.push(FAMILY.point((ends.as_str(), class), *ends == EndPadding::default(), errors, timing));
        }
    }
    points
}

/// A map over scenes: the median error of each way at each.
fn map(
    text: [&str; 3],
    stresses: Vec<f64>,
    scene: impl Fn(f64) -> Scene,
    request: &TrialRequest,
) -> TrialMap {
    let cases = if request.quick { 9 } else { 60 };
    let columns: Vec<Vec<Vec<f64>>> =
        stresses.iter().map(|stress| errors(&scene(*stress), request.seed, cases)).collect();
    let line = |(i, ends): (usize, &EndPadding)| {
        let median = |column: &Vec<Vec<f64>>| {
            Some(super::summary::median_and_p95(column.iter().map(|case| case[i]).collect())[0])
        };
        silent_line(ends.as_str(), columns.iter().map(median).collect())
    };
    TrialMap {
        name: text[0].to_owned(),
        title: text[1].to_owned(),
        stress: text[2].to_owned(),
        is_log: true,
        error: "error at the ends, in the filter's own noise".to_owned(),
        // A point with three times the filter's noise stands out of its curve.
        limit: 3.0,
        lines: EndPadding::ALL.iter().enumerate().map(line).collect(),
        stresses,
    }
}

/// Where the ways fail: noise as the cut-off falls, slopes, and records shorter than the filter's memory.
pub(super) fn maps(request: &TrialRequest) -> Vec<TrialMap> {
    let decades = |from: i32, to: i32| -> Vec<f64> {
        (2 * from..=2 * to).map(|half| 10_f64.powf(0.5 * f64::from(half))).collect()
    };
    let rates = decades(1, if request.quick { 3 } else { 4 });
    vec![
        map(
            ["end-noise", "White noise at the ends of a record", "sample rate over design frequency"],
            rates,
            |ratio| Scene { design: 1.0 / ratio, slope: 0.0 },
            request,
        ),
        map(
            [
                "end-slope",
                "A slope at the ends of a record, f/fs = 0.003",
                "slope, the filter's own noise a 1/f",
            ],
            decades(-1, 3),
            |slope| Scene { design: 3e-3, slope },
            request,
        ),
        short_records(),
    ]
}

/// A pulse in a record that is shorter than the filter's memory.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples, positive and below 2^52"
)]
fn short_records() -> TrialMap {
    let design = 2e-3;
    let at = |t: f64| (-0.5 * (t * design / 0.2).powi(2)).exp();
    let long: Vec<f64> = (0..40_001).map(|i| at(f64::from(i) - 20_000.0)).collect();
    let truth = low_passed(&long, 2, design);
    let peak = truth[20_000];
    // 3.1/f of memory over the record's length: 0.1 to 10.
    let stresses: Vec<f64> = (-4..=4).map(|quarter| 10_f64.powf(0.25 * f64::from(quarter))).collect();
    let error = |ends: EndPadding, stress: f64| {
        let half = (0.5 * 3.1 / design / stress).round() as usize;
        let filter = LowPass::new(2, design, FilterForm::default(), ends)?;
        Some((filter.apply(&long[20_000 - half..=20_000 + half])[half] - peak).abs() / peak)
    };
    let line = |ends: &EndPadding| {
        silent_line(ends.as_str(), stresses.iter().map(|stress| error(*ends, *stress)).collect())
    };
    TrialMap {
        name: "short-records".to_owned(),
        title: "The peak of a pulse in a record that is shorter than the filter's memory".to_owned(),
        stress: "memory of the filter over the record's length".to_owned(),
        is_log: true,
        error: "error of the peak, of the peak".to_owned(),
        limit: 0.01,
        lines: EndPadding::ALL.iter().map(line).collect(),
        stresses,
    }
}

/// The whole job.
pub(super) fn run(request: &TrialRequest, done: &dyn Fn(f64)) -> TrialPart {
    let points = points(request, Some(Effort::of(request.quick)));
    done(0.5);
    TrialPart { points, maps: maps(request) }
}
