//! Methods of finding first contact to their errors and times.

use super::sample::{self, Class, Prepared};
use super::scene::STANDARD_GRAVITY_M_S2;
use super::summary::{Subject, fraction, point};
use crate::data::{TrialPart, TrialPoint, TrialRequest};
use crate::events::{Detector, first_contact_by};
use crate::trial::timing::{Effort, Work, in_turn};
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

/// |t − truth| in percent of the first contact's length.
fn error_percent(drop: &Prepared, found_s: f64) -> f64 {
    let contact_s = drop.drawn.truth().contact_s.unwrap_or(f64::NAN);
    100.0 * (found_s - drop.contact_s).abs() / contact_s
}

pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let mut part = TrialPart::default();
    for (done, class) in CLASSES.iter().enumerate() {
        progress(fraction(done, CLASSES.len()));
        let count = if request.quick { 12 } else { 60 };
        part.points.extend(of_class(
            class,
            &sample::prepared(&sample::plans(class, count, request)),
            request,
        ));
    }
    progress(1.0);
    part
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
        let errors: Vec<Option<f64>> = drops
            .iter()
            .map(|d| {
                first_contact_by(detector, &d.signals, &d.coarse).map(|found_s| error_percent(d, found_s))
            })
            .collect();
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
