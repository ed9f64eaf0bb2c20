//! Rules and sums of a running integral to their errors on pulses whose integral is known, and time.

use super::summary::{Family, chance, silent_line, worst_of_peak};
use crate::lab::data::{TrialMap, TrialPart, TrialPeerWork, TrialPoint, TrialRequest};
use crate::lab::methods::rivals::integration::{IntegrationRule, Summation, running_integral_by};
use crate::lab::methods::timing::{Effort, Work, in_turn};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::hint::black_box;

const FAMILY: Family = Family { name: "integration", error_unit: "of the velocity step", time_per: "sample" };

/// Rule and sum.
type Method = (IntegrationRule, Summation);

const METHODS: [Method; 7] = [
    (IntegrationRule::CorrectedTrapezoid, Summation::F64),
    (IntegrationRule::Trapezoid, Summation::F64),
    (IntegrationRule::Simpson, Summation::F64),
    (IntegrationRule::CubicSpline, Summation::F64),
    (IntegrationRule::Spectral, Summation::F64),
    (IntegrationRule::CorrectedTrapezoid, Summation::F32),
    (IntegrationRule::CorrectedTrapezoid, Summation::Compensated),
];

fn name((rule, summation): Method) -> String {
    match summation {
        Summation::F64 => rule.as_str().to_owned(),
        other => format!("{}, {}", rule.as_str(), other.as_str()),
    }
}

/// A pulse of height 1 between two silences.
#[derive(Clone, Copy)]
struct Pulse {
    /// Its slope jumps at both ends: a half sine; else three derivatives are continuous: sin⁴.
    kinked: bool,
    /// Share of the record before it.
    start: f64,
    /// Share of the record that it takes.
    length: f64,
}

impl Pulse {
    fn force(self, share: f64) -> f64 {
        let angle = PI * (share - self.start) / self.length;
        if !(0.0..=PI).contains(&angle) {
            0.0
        } else if self.kinked {
            angle.sin()
        } else {
            angle.sin().powi(4)
        }
    }

    /// Its integral from the record's beginning.
    fn velocity(self, share: f64) -> f64 {
        let angle = (PI * (share - self.start) / self.length).clamp(0.0, PI);
        let area = if self.kinked {
            1.0 - angle.cos()
        } else {
            0.375 * angle - 0.25 * (2.0 * angle).sin() + (4.0 * angle).sin() / 32.0
        };
        self.length / PI * area
    }
}

/// A class: a record of 0.1 s.
struct Class {
    name: &'static str,
    samples: u32,
    kinked: bool,
    noise: f64,
}

const CLASSES: [Class; 5] = [
    Class { name: "smooth pulse, 10 kHz", samples: 1_000, kinked: false, noise: 0.0 },
    Class { name: "smooth pulse, 100 kHz", samples: 10_000, kinked: false, noise: 0.0 },
    Class { name: "kinked pulse, 10 kHz", samples: 1_000, kinked: true, noise: 0.0 },
    Class { name: "kinked pulse, 100 kHz", samples: 10_000, kinked: true, noise: 0.0 },
    Class { name: "smooth pulse with 1 % noise, 100 kHz", samples: 10_000, kinked: false, noise: 0.01 },
];

/// Samples and true velocities of a case; the record's length is 1.
fn made(class: &Class, length: f64, seed: u64, case: u32) -> (Vec<f64>, Vec<f64>) {
    let mut generator = chance(seed, case);
    // The pulse begins anywhere between two samples.
    let start = 0.3 + 0.1 * generator.random::<f64>();
    let pulse = Pulse { kinked: class.kinked, start, length };
    let share = |i: u32| f64::from(i) / f64::from(class.samples);
    let force = (0..=class.samples).map(|i| {
        let noise: f64 = StandardNormal.sample(&mut generator);
        pulse.force(share(i)) + class.noise * noise
    });
    (force.collect(), (0..=class.samples).map(|i| pulse.velocity(share(i))).collect())
}

fn error((rule, summation): Method, (force, truth): &(Vec<f64>, Vec<f64>)) -> f64 {
    let step = 1.0 / f64::from(u32::try_from(force.len() - 1).unwrap_or(u32::MAX));
    worst_of_peak(running_integral_by(rule, summation, force, step).into_iter(), truth)
}

/// Speed-accuracy points of every class; pulses of 8 to 12 ms.
pub(super) fn points(request: &TrialRequest, effort: Option<Effort>) -> Vec<TrialPoint> {
    let cases = if request.quick { 50 } else { 400 };
    let mut points = Vec::new();
    for class in &CLASSES {
        let errors: Vec<Vec<f64>> = (0..cases)
            .into_par_iter()
            .map(|case| {
                let length = 0.08 + 0.04 * f64::from(case) / f64::from(cases);
                let made = made(class, length, request.seed, case);
                METHODS.iter().map(|method| error(*method, &made)).collect()
            })
            .collect();
        let timings = effort.map(|effort| {
            let (force, _) = made(class, 0.1, request.seed, 0);
            let mut work: Vec<Work> = METHODS
                .iter()
                .map(|&(rule, summation)| -> Work {
                    let force = &force;
                    Box::new(move || {
                        drop(black_box(running_integral_by(rule, summation, black_box(force), 1e-5)));
                    })
                })
                .collect();
            in_turn(&mut work, effort).into_iter().map(|t| t.per(force.len())).collect::<Vec<_>>()
        });
        for (i, method) in METHODS.iter().enumerate() {
            let errors = errors.iter().map(|case| case[i]).collect();
            let is_default = *method == (IntegrationRule::default(), Summation::default());
            let timing = timings.as_ref().and_then(|t| t.get(i).copied());
            points.push(FAMILY.point((&name(*method), class.name), is_default, errors, timing));
        }
    }
    points
}

/// Error over the samples in a pulse.
fn over_step(kinked: bool, request: &TrialRequest) -> TrialMap {
    let shape = if kinked { "kinked" } else { "smooth" };
    let stresses: Vec<f64> = (-10..=-1).map(|quarter| 10_f64.powf(0.25 * f64::from(quarter))).collect();
    let cases = if request.quick { 25 } else { 200 };
    let class = Class { name: "", samples: 2_000, kinked, noise: 0.0 };
    let rules = &METHODS[..5];
    let line = |method: &Method| {
        let at = |stress: &f64| {
            // The record has 2000 samples: the pulse takes as many of them as one step is a share of it.
            let length = 1.0 / (f64::from(class.samples) * stress);
            let errors = (0..cases).map(|case| error(*method, &made(&class, length, request.seed, case)));
            Some(super::summary::median_and_p95(errors.collect())[0])
        };
        silent_line(&name(*method), stresses.iter().map(at).collect())
    };
    TrialMap {
        name: format!("step-over-pulse-{shape}"),
        title: format!("Velocity along a {shape} pulse as the samples in it grow few"),
        stress: "time between samples over the pulse's length".to_owned(),
        is_log: true,
        error: "error, of the velocity step".to_owned(),
        limit: 0.01,
        lines: rules.iter().map(line).collect(),
        stresses,
    }
}

/// Relative error of sums of ever more samples: offset 1000 counts, noise of 256, held against the exact sum of whole numbers.
fn accumulation(request: &TrialRequest, longest: u64) -> TrialMap {
    let stresses: Vec<u64> = (3..=8)
        .flat_map(|decade| [1, 2, 5].map(|part| part * 10_u64.pow(decade)))
        .take_while(|count| *count <= longest)
        .collect();
    let counts = || {
        let mut generator = chance(request.seed, 0);
        std::iter::repeat_with(move || 1000 - 256 + i64::from(generator.next_u32() >> 23))
    };
    let mut exact = Vec::new();
    let (mut sum, mut at) = (0_i64, 0_u64);
    for count in counts() {
        sum += count;
        at += 1;
        if Some(&at) == stresses.get(exact.len()) {
            exact.push(sum);
        }
        if exact.len() == stresses.len() {
            break;
        }
    }
    let lines = Summation::ALL
        .par_iter()
        .map(|summation| {
            // A scale that is a power of two keeps every term exact.
            #[allow(clippy::cast_precision_loss, reason = "counts below 2^11, their sums below 2^52")]
            let terms = counts().map(|count| count as f64 / 1024.0);
            let mut errors = Vec::new();
            for (sum, at) in summation.partial_sums(terms).zip(1_u64..) {
                if Some(&at) == stresses.get(errors.len()) {
                    #[allow(clippy::cast_precision_loss, reason = "sums below 2^52")]
                    let truth = exact[errors.len()] as f64 / 1024.0;
                    errors.push(Some((sum - truth).abs() / truth));
                }
                if errors.len() == stresses.len() {
                    break;
                }
            }
            silent_line(summation.as_str(), errors)
        })
        .collect();
    #[allow(clippy::cast_precision_loss, reason = "counts of samples up to 1e8")]
    let stresses = stresses.into_iter().map(|count| count as f64).collect();
    TrialMap {
        name: "accumulation".to_owned(),
        title: "Sums of ever more samples with an offset".to_owned(),
        stress: "samples summed".to_owned(),
        is_log: true,
        stresses,
        error: "error, of the sum".to_owned(),
        limit: 0.01,
        lines,
    }
}

/// Where rules and sums fail: few samples in a pulse, and many in a record.
pub(super) fn maps(request: &TrialRequest, longest: u64) -> Vec<TrialMap> {
    vec![over_step(false, request), over_step(true, request), accumulation(request, longest)]
}

/// What programs of others are given.
pub(super) fn peer_work(request: &TrialRequest) -> Vec<TrialPeerWork> {
    let work = |class: &Class| {
        let (samples, truth) = made(class, 0.1, request.seed, 0);
        TrialPeerWork {
            family: FAMILY.name,
            class: class.name.to_owned(),
            low_pass: None,
            drop: None,
            samples,
            truth,
            error_unit: FAMILY.error_unit,
        }
    };
    CLASSES.iter().map(work).collect()
}

/// The whole job.
pub(super) fn run(request: &TrialRequest, done: &dyn Fn(f64)) -> TrialPart {
    let points = points(request, Some(Effort::of(request.quick)));
    done(0.6);
    let longest = if request.quick { 10_000_000 } else { 100_000_000 };
    TrialPart { points, maps: maps(request, longest) }
}
