//! Methods of finding first contact to their errors and times.

use super::method_map::{self, MethodStress};
use super::sample::{self, Class, Prepared};
use super::scene::STANDARD_GRAVITY_M_S2;
use super::summary::{Subject, by_class, point};
use crate::lab::data::{TrialPart, TrialPoint, TrialRequest};
use crate::lab::methods::rivals::detector::{Detector, first_contact_by};
use crate::lab::methods::timing::{Effort, Work, in_turn};
use std::hint::black_box;

const CLASSES: [Class; 5] = [
    Class {
        name: "clean, 100 kHz",
        make: |plan, _, _| {
            plan.rate_hz = 1e5;
            plan.each_chain(|c| c.white_noise_m_s2 = 0.02 * STANDARD_GRAVITY_M_S2);
        },
    },
    Class {
        name: "5 g of noise",
        make: |plan, _, _| plan.each_chain(|c| c.white_noise_m_s2 = 5.0 * STANDARD_GRAVITY_M_S2),
    },
    Class { name: "20 ms pulse", make: |plan, _, _| plan.pulse_s = 0.02 },
    Class { name: "25 samples a pulse", make: |plan, _, _| plan.rate_hz = 25.0 / plan.pulse_s },
    Class { name: "force plateau", make: |plan, _, share| plan.yield_share = Some(0.4 + 0.4 * share) },
];

const STRESSES: [MethodStress; 2] = [
    MethodStress {
        name: "first-contact-noise",
        title: "First contact by each method under white noise",
        axis: "RMS of the noise, g",
        error: "error of first contact, % of the pulse",
        values: &[0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 50.0, 70.0, 100.0, 200.0],
        apply: |plan, _, g| plan.each_chain(|c| c.white_noise_m_s2 = g * STANDARD_GRAVITY_M_S2),
    },
    MethodStress {
        name: "first-contact-rate",
        title: "First contact by each method on few samples",
        axis: "samples in the first contact",
        error: "error of first contact, % of the pulse",
        values: &[500.0, 300.0, 200.0, 100.0, 70.0, 50.0, 30.0, 20.0, 15.0, 10.0, 7.0, 5.0, 3.0],
        apply: |plan, _, samples| plan.rate_hz = samples / plan.pulse_s,
    },
];

/// |t − truth| in percent of the first contact's length.
fn error_percent(drop: &Prepared, found_s: f64) -> f64 {
    let contact_s = drop.drawn.truth().contact_s.unwrap_or(f64::NAN);
    100.0 * (found_s - drop.contact_s).abs() / contact_s
}

pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let count = if request.quick { 12 } else { 60 };
    let mut part = by_class(&CLASSES, progress, |class| {
        of_class(class, &sample::prepared(&sample::plans(class, count, request)), request)
    });
    let names = Detector::ALL.map(Detector::words);
    for stress in &STRESSES {
        part.maps.push(method_map::map(stress, request, &names, &|drop| {
            Detector::ALL.map(|d| off(d, drop)).into()
        }));
    }
    progress(1.0);
    part
}

/// The error of one detector; none where it finds nothing.
fn off(detector: Detector, drop: &Prepared) -> Option<f64> {
    let found_s = first_contact_by(detector, &drop.signals, &drop.coarse)?;
    Some(error_percent(drop, found_s))
}

fn of_class(class: &Class, drops: &[Prepared], request: &TrialRequest) -> Vec<TrialPoint> {
    let Some(timed) = drops.first() else { return Vec::new() };
    let mut work: Vec<Work> = Vec::new();
    for detector in Detector::ALL {
        work.push(Box::new(move || {
            black_box(first_contact_by(detector, black_box(&timed.signals), &timed.coarse));
        }));
    }
    let timings = in_turn(&mut work, Effort::of(request.quick));
    let points = Detector::ALL.into_iter().zip(timings).map(|(detector, timing)| {
        let errors: Vec<Option<f64>> = drops.iter().map(|drop| off(detector, drop)).collect();
        let subject = Subject {
            family: "first contact",
            method: detector.words(),
            class: class.name,
            is_default: detector == Detector::default(),
            error_unit: "% of the pulse",
        };
        // Not found at all is as bad as a whole pulse off.
        point(subject, &errors, 100.0, timing)
    });
    points.collect()
}
