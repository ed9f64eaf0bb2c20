//! Rules and sums of a running integral to their errors on pulses whose integral is known, and time.

use super::contest::{Contest, Method, worst_of_peak};
use crate::lab::chance::Chance;
use crate::lab::data::{TrialPoint, TrialRequest};
use crate::numerics::quadrature::running_integral;
use rayon::prelude::*;
use std::f64::consts::PI;

/// A record of 0.1 s with a pulse of height 1 between two silences.
struct PulseClass {
    name: &'static str,
    samples: u32,
    /// Its slope jumps at both ends: a half sine; else three derivatives are continuous: sin⁴.
    kinked: bool,
    noise: f64,
    /// What stands on every sample.
    offset: f64,
}

const SMOOTH: PulseClass =
    PulseClass { name: "smooth pulse, 10 kHz", samples: 1_000, kinked: false, noise: 0.0, offset: 0.0 };
const CLASSES: [PulseClass; 6] = [
    SMOOTH,
    PulseClass { name: "smooth pulse, 100 kHz", samples: 10_000, ..SMOOTH },
    PulseClass { name: "kinked pulse, 10 kHz", kinked: true, ..SMOOTH },
    PulseClass { name: "kinked pulse, 100 kHz", samples: 10_000, kinked: true, ..SMOOTH },
    PulseClass { name: "smooth pulse with 1 % noise, 100 kHz", samples: 10_000, noise: 0.01, ..SMOOTH },
    PulseClass { name: "smooth pulse on an offset, 1e6 samples", samples: 1_000_000, offset: 1.0, ..SMOOTH },
];

/// Samples of a record of length 1, and its true velocities.
struct ForceRecord {
    force: Vec<f64>,
    velocity: Vec<f64>,
}

impl ForceRecord {
    fn step(&self) -> f64 {
        1.0 / f64::from(u32::try_from(self.force.len() - 1).unwrap_or(u32::MAX))
    }

    fn sums<T: Copy + std::ops::AddAssign>(&self, nothing: T, narrowed: fn(f64) -> T) -> Vec<T> {
        let half_step = 0.5 * self.step();
        let mut sum = nothing;
        let sums = self.force.windows(2).map(|w| {
            sum += narrowed(half_step * (w[0] + w[1]));
            sum
        });
        std::iter::once(nothing).chain(sums).collect()
    }
}

impl PulseClass {
    /// The pulse takes this share of the record, and begins anywhere between two samples.
    fn record(&self, length: f64, seed: u64, number: u32) -> ForceRecord {
        let mut chance = Chance::new(seed, u64::from(number));
        let start = chance.even(0.3, 0.4);
        let shares = (0..=self.samples).map(|i| f64::from(i) / f64::from(self.samples));
        let angle = |share: f64| (PI * (share - start) / length).clamp(0.0, PI);
        let force = |share: f64| {
            let pulse = if self.kinked { angle(share).sin() } else { angle(share).sin().powi(4) };
            pulse + self.offset + self.noise * chance.normal()
        };
        let velocity = |share: f64| {
            let angle = angle(share);
            let area = if self.kinked {
                1.0 - angle.cos()
            } else {
                0.375 * angle - 0.25 * (2.0 * angle).sin() + (4.0 * angle).sin() / 32.0
            };
            length / PI * area + self.offset * share
        };
        ForceRecord { force: shares.clone().map(force).collect(), velocity: shares.map(velocity).collect() }
    }
}

fn contest() -> Contest<ForceRecord, Vec<f64>> {
    Contest {
        family: "integration",
        error_unit: "of the velocity step",
        matters: 1e-3,
        samples: Some(|record| record.force.len()),
        methods: vec![
            Method::new("corrected trapezoid", |record: &ForceRecord| {
                Some(running_integral(&record.force, record.step()))
            }),
            Method::new("trapezoid", |record: &ForceRecord| Some(record.sums(0.0, |x| x))),
            #[allow(clippy::cast_possible_truncation, reason = "single precision is what is tried")]
            Method::new("trapezoid, f32", |record: &ForceRecord| {
                Some(record.sums(0.0_f32, |x| x as f32).into_iter().map(f64::from).collect())
            }),
        ],
        error: |record, made| worst_of_peak(&made, &record.velocity),
    }
}

/// Pulses of 8 to 12 ms.
pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    contest().points(&CLASSES, request, |class| {
        // No more than some 100 MB at a time.
        let count = request.either(50, 400).min(5_000_000 / class.samples);
        let record = |number: u32| {
            class.record(0.08 + 0.04 * f64::from(number) / f64::from(count), request.seed, number)
        };
        (class.name.to_owned(), (0..count).into_par_iter().map(record).collect())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_exact_where_theory_says_so() {
        let record = |degree: i32| ForceRecord {
            force: (0..=40).map(|i| (f64::from(i) / 40.0).powi(degree)).collect(),
            velocity: (0..=40)
                .map(|i| (f64::from(i) / 40.0).powi(degree + 1) / f64::from(degree + 1))
                .collect(),
        };
        let (line, parabola) = (record(1), record(2));
        // Values up to 1, forty additions.
        assert!(worst_of_peak(&line.sums(0.0, |x| x), &line.velocity) < 1e-14);
        assert!(worst_of_peak(&parabola.sums(0.0, |x| x), &parabola.velocity) > 1e-5);
    }
}
