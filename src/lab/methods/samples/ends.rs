//! The ways to continue a record beyond its ends to what they do to the ends.

use super::reference::low_passed;
use crate::lab::chance::Chance;
use crate::lab::data::{TrialMap, TrialPart, TrialRequest};
use crate::lab::methods::contest::{Contest, Purpose, by_class, map};
use crate::lab::methods::rivals::filter::{EndPadding, FilterForm, LowPass};
use rayon::prelude::*;

/// Length of the record that is filtered, over 1/f; and what stands before and behind it in the truth.
const RECORD: f64 = 20.0;
const BEYOND: f64 = 10.0;
/// The ends that are looked at, over 1/f.
const END: f64 = 0.25;

/// Noise on a slope.
struct NoisySlope {
    design: f64,
    /// Slope of the signal at both ends, in the filter's own noise a 1/f.
    slope: f64,
}

/// A record cut from a longer one.
struct CutRecord {
    design: f64,
    samples: Vec<f64>,
    /// The longer one filtered, cut in the same way.
    truth: Vec<f64>,
}

impl NoisySlope {
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of samples, positive and below 2^52"
    )]
    fn record(&self, seed: u64, number: u32) -> CutRecord {
        let samples = |lengths: f64| (lengths / self.design).round() as usize;
        let (before, count) = (samples(BEYOND), samples(RECORD));
        let mut chance = Chance::new(seed, u64::from(number));
        let noise: Vec<f64> = (0..count + 2 * before).map(|_| chance.normal()).collect();
        let slope = self.slope * own_noise(self.design) * self.design;
        let with_slope = |(i, x): (usize, &f64)| x + slope * (i as f64 - 0.5 * count as f64);
        let long: Vec<f64> = noise.iter().enumerate().map(with_slope).collect();
        // The slope is a line: it passes the filter as it is, and the reference's rest at its own ends would not let it.
        let smooth = low_passed(&noise, 2, self.design);
        let truth: Vec<f64> = smooth.iter().enumerate().map(with_slope).collect();
        let cut = |whole: &[f64]| whole[before..before + count].to_vec();
        CutRecord { design: self.design, samples: cut(&long), truth: cut(&truth) }
    }

    fn records(&self, request: &TrialRequest, count: u32) -> Vec<CutRecord> {
        (0..count).into_par_iter().map(|number| self.record(request.seed, number)).collect()
    }
}

/// Root mean square error over both ends, in the filter's own noise.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples, positive and below 2^52"
)]
fn error_at_ends(record: &CutRecord, made: &[f64]) -> f64 {
    let reach = ((END / record.design).ceil() as usize).max(1);
    let at_end = |i: &usize| *i < reach || *i + reach >= made.len();
    let square: f64 = (0..made.len()).filter(at_end).map(|i| (made[i] - record.truth[i]).powi(2)).sum();
    (square / (2 * reach) as f64).sqrt() / own_noise(record.design)
}

/// Deviation of unit white noise behind both passes: √(∫ |H|² df · 2/f_s), |H| = 1/(1 + (f/f0)⁴).
fn own_noise(design: f64) -> f64 {
    // ∫ 1/(1+x⁴)² dx over 0..∞ is 3π/(8√2); the noise's density is 2/f_s one-sided.
    (2.0 * design * 3.0 * std::f64::consts::PI / (8.0 * 2.0_f64.sqrt())).sqrt()
}

fn contest() -> Contest<EndPadding, CutRecord, Vec<f64>> {
    Contest {
        purpose: Purpose::of_samples("record ends", "of the filter's own noise"),
        methods: EndPadding::ALL.to_vec(),
        default: EndPadding::default(),
        name: |ends| ends.as_str().to_owned(),
        run: |ends, record| {
            let filter = LowPass::new(2, record.design, FilterForm::default(), ends)?;
            Some(filter.apply(&record.samples))
        },
        error: |record, made| error_at_ends(record, &made),
        parts: |record| record.samples.len(),
    }
}

/// Where the ways fail: noise as the cut-off falls, slopes, and records shorter than the filter's memory.
fn maps(request: &TrialRequest) -> Vec<TrialMap> {
    /// A point with three times the filter's noise stands out of its curve.
    const LIMIT: f64 = 3.0;
    let decades = |from: i32, to: i32| -> Vec<f64> {
        (2 * from..=2 * to).map(|half| 10_f64.powf(0.5 * f64::from(half))).collect()
    };
    let count = if request.quick { 9 } else { 60 };
    let ratios = decades(1, if request.quick { 3 } else { 4 });
    let noise = |ratio: &f64| NoisySlope { design: 1.0 / ratio, slope: 0.0 }.records(request, count);
    let slopes = decades(-1, 3);
    let slope = |slope: &f64| NoisySlope { design: 3e-3, slope: *slope }.records(request, count);
    let error = "error at the ends, in the filter's own noise";
    let over_rate =
        ["end-noise", "White noise at the ends of a record", "sample rate over design frequency", error];
    let over_slope = [
        "end-slope",
        "A slope at the ends of a record, f/fs = 0.003",
        "slope, the filter's own noise a 1/f",
        error,
    ];
    let noise_lines = contest().lines(&ratios, noise);
    let slope_lines = contest().lines(&slopes, slope);
    vec![
        map(over_rate, ratios, LIMIT, noise_lines),
        map(over_slope, slopes, LIMIT, slope_lines),
        short_records(),
    ]
}

/// A pulse in a record that is shorter than the filter's memory.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples, positive and below 2^52"
)]
fn short_records() -> TrialMap {
    let design = 2e-3;
    let at = |t: f64| (-0.5 * (t * design / 0.2).powi(2)).exp();
    let long: Vec<f64> = (0..40_001).map(|i| at(f64::from(i) - 20_000.0)).collect();
    let peak = low_passed(&long, 2, design)[20_000];
    // 3.1/f of memory over the record's length: 0.1 to 10.
    let stresses: Vec<f64> = (-4..=4).map(|quarter| 10_f64.powf(0.25 * f64::from(quarter))).collect();
    let record = |stress: &f64| {
        let half = (0.5 * 3.1 / design / stress).round() as usize;
        vec![CutRecord { design, samples: long[20_000 - half..=20_000 + half].to_vec(), truth: vec![peak] }]
    };
    let of_peak =
        |record: &CutRecord, made: Vec<f64>| (made[made.len() / 2] - record.truth[0]).abs() / record.truth[0];
    let lines = Contest { error: of_peak, ..contest() }.lines(&stresses, record);
    let words = [
        "short-records",
        "The peak of a pulse in a record that is shorter than the filter's memory",
        "memory of the filter over the record's length",
        "error of the peak, of the peak",
    ];
    map(words, stresses, 0.01, lines)
}

/// The whole job.
pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let classes = [("noise", 0.0), ("noise on a gentle slope", 3.0), ("noise on a steep slope", 100.0)];
    let count = if request.quick { 24 } else { 200 };
    let part = by_class(&classes, &|share| progress(0.5 * share), |&(class, slope)| {
        contest().points(class, &NoisySlope { design: 1e-3, slope }.records(request, count), 1, request)
    });
    TrialPart { maps: maps(request), ..part }
}
