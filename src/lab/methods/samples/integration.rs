//! Rules and sums of a running integral to their errors on pulses whose integral is known, and time.

use super::reference::worst_of_peak;
use crate::lab::chance::Chance;
use crate::lab::data::{TrialMap, TrialPart, TrialPeerWork, TrialRequest};
use crate::lab::methods::contest::{Contest, Purpose, by_class, map, silent_line};
use crate::lab::methods::rivals::integration::{IntegrationRule, Summation, running_integral_by};
use rayon::prelude::*;
use std::f64::consts::PI;

const INTEGRATION: Purpose = Purpose::of_samples("integration", "of the velocity step");

/// Rule and sum.
type IntegrationMethod = (IntegrationRule, Summation);

const METHODS: [IntegrationMethod; 7] = [
    (IntegrationRule::CorrectedTrapezoid, Summation::F64),
    (IntegrationRule::Trapezoid, Summation::F64),
    (IntegrationRule::Simpson, Summation::F64),
    (IntegrationRule::CubicSpline, Summation::F64),
    (IntegrationRule::Spectral, Summation::F64),
    (IntegrationRule::CorrectedTrapezoid, Summation::F32),
    (IntegrationRule::CorrectedTrapezoid, Summation::Compensated),
];

/// A pulse of height 1 between two silences.
#[derive(Clone, Copy)]
struct ForcePulse {
    /// Its slope jumps at both ends: a half sine; else three derivatives are continuous: sin⁴.
    kinked: bool,
    /// Share of the record before it.
    start: f64,
    /// Share of the record that it takes.
    length: f64,
}

impl ForcePulse {
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
struct PulseClass {
    name: &'static str,
    samples: u32,
    kinked: bool,
    noise: f64,
}

const CLASSES: [PulseClass; 5] = [
    PulseClass { name: "smooth pulse, 10 kHz", samples: 1_000, kinked: false, noise: 0.0 },
    PulseClass { name: "smooth pulse, 100 kHz", samples: 10_000, kinked: false, noise: 0.0 },
    PulseClass { name: "kinked pulse, 10 kHz", samples: 1_000, kinked: true, noise: 0.0 },
    PulseClass { name: "kinked pulse, 100 kHz", samples: 10_000, kinked: true, noise: 0.0 },
    PulseClass { name: "smooth pulse with 1 % noise, 100 kHz", samples: 10_000, kinked: false, noise: 0.01 },
];

/// Samples of a record of length 1, and its true velocities.
struct ForceRecord {
    force: Vec<f64>,
    velocity: Vec<f64>,
}

impl PulseClass {
    fn record(&self, length: f64, seed: u64, number: u32) -> ForceRecord {
        let mut chance = Chance::new(seed, u64::from(number));
        // The pulse begins anywhere between two samples.
        let pulse = ForcePulse { kinked: self.kinked, start: chance.even(0.3, 0.4), length };
        let share = |i: u32| f64::from(i) / f64::from(self.samples);
        let force = (0..=self.samples).map(|i| pulse.force(share(i)) + self.noise * chance.normal());
        let force = force.collect();
        ForceRecord { force, velocity: (0..=self.samples).map(|i| pulse.velocity(share(i))).collect() }
    }
}

fn contest(methods: &[IntegrationMethod]) -> Contest<IntegrationMethod, ForceRecord, Vec<f64>> {
    Contest {
        purpose: INTEGRATION,
        methods: methods.to_vec(),
        default: (IntegrationRule::default(), Summation::default()),
        name: |(rule, summation)| match summation {
            Summation::F64 => rule.as_str().to_owned(),
            other => format!("{}, {}", rule.as_str(), other.as_str()),
        },
        run: |(rule, summation), record| {
            let step = 1.0 / f64::from(u32::try_from(record.force.len() - 1).unwrap_or(u32::MAX));
            Some(running_integral_by(rule, summation, &record.force, step))
        },
        error: |record, made| worst_of_peak(made.into_iter(), &record.velocity),
        parts: |record| record.force.len(),
    }
}

/// Error over the samples in a pulse.
fn over_step(kinked: bool, request: &TrialRequest) -> TrialMap {
    let stresses: Vec<f64> = (-10..=-1).map(|quarter| 10_f64.powf(0.25 * f64::from(quarter))).collect();
    let count = if request.quick { 25 } else { 200 };
    let class = PulseClass { name: "", samples: 2_000, kinked, noise: 0.0 };
    let records = |stress: &f64| {
        // The record has 2000 samples: the pulse takes as many of them as one step is a share of it.
        let length = 1.0 / (f64::from(class.samples) * stress);
        (0..count).map(|number| class.record(length, request.seed, number)).collect()
    };
    let lines = contest(&METHODS[..5]).lines(&stresses, records);
    let shape = if kinked { "kinked" } else { "smooth" };
    let words = [
        &format!("step-over-pulse-{shape}"),
        &format!("Velocity along a {shape} pulse as the samples in it grow few"),
        "time between samples over the pulse's length",
        "error, of the velocity step",
    ];
    map(words, stresses, 0.01, lines)
}

/// Relative error of sums of ever more samples: offset 1000 counts, noise of 256, held against the exact sum of whole numbers.
fn accumulation(request: &TrialRequest, longest: u64) -> TrialMap {
    let stresses: Vec<u64> = (3..=8)
        .flat_map(|decade| [1, 2, 5].map(|part| part * 10_u64.pow(decade)))
        .take_while(|count| *count <= longest)
        .collect();
    let counts = || {
        let mut chance = Chance::new(request.seed, 0);
        std::iter::repeat_with(move || 1000 - 256 + i64::try_from(chance.index(512)).unwrap_or(0))
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
            silent_line(summation.as_str().to_owned(), errors)
        })
        .collect();
    #[allow(clippy::cast_precision_loss, reason = "counts of samples up to 1e8")]
    let stresses = stresses.into_iter().map(|count| count as f64).collect();
    let words =
        ["accumulation", "Sums of ever more samples with an offset", "samples summed", "error, of the sum"];
    map(words, stresses, 0.01, lines)
}

/// What programs of others are given.
pub(super) fn peer_work(request: &TrialRequest) -> Vec<TrialPeerWork> {
    let work = |class: &PulseClass| {
        let ForceRecord { force, velocity } = class.record(0.1, request.seed, 0);
        TrialPeerWork {
            family: INTEGRATION.name,
            class: class.name.to_owned(),
            low_pass: None,
            drop: None,
            samples: force,
            truth: velocity,
            error_unit: INTEGRATION.error_unit,
        }
    };
    CLASSES.iter().map(work).collect()
}

/// The whole job: pulses of 8 to 12 ms in a record of 0.1 s; few samples in a pulse, and many in a record.
pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let count = if request.quick { 50 } else { 400 };
    let part = by_class(&CLASSES, &|share| progress(0.6 * share), |class| {
        let record = |number: u32| {
            class.record(0.08 + 0.04 * f64::from(number) / f64::from(count), request.seed, number)
        };
        let records: Vec<ForceRecord> = (0..count).into_par_iter().map(record).collect();
        contest(&METHODS).points(class.name, &records, 1, request)
    });
    let longest = if request.quick { 10_000_000 } else { 100_000_000 };
    let maps = vec![over_step(false, request), over_step(true, request), accumulation(request, longest)];
    TrialPart { maps, ..part }
}
