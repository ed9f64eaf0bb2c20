//! Methods of finding first contact to their errors and times.

use super::sample::{self, DropClass, NOISY, Prepared};
use crate::data::STANDARD_GRAVITY_M_S2;
use crate::lab::data::{TrialPart, TrialRequest};
use crate::lab::methods::contest::{Contest, Purpose, by_class};
use crate::lab::methods::rivals::detector::{Detector, first_contact_by};

const CLASSES: [DropClass; 5] = [
    DropClass {
        name: "clean, 100 kHz",
        make: |plan, _, _| {
            plan.rate_hz = 1e5;
            plan.chain.white_noise_m_s2 = 0.02 * STANDARD_GRAVITY_M_S2;
        },
    },
    NOISY,
    DropClass { name: "20 ms pulse", make: |plan, _, _| plan.pulse_s = 0.02 },
    DropClass { name: "25 samples a pulse", make: |plan, _, _| plan.rate_hz = 25.0 / plan.pulse_s },
    DropClass { name: "force plateau", make: |plan, _, share| plan.yield_share = Some(0.4 + 0.4 * share) },
];

fn contest() -> Contest<Detector, Prepared, f64> {
    Contest {
        // Not found at all is as bad as a whole pulse off.
        purpose: Purpose::of_calls("first contact", "% of the pulse"),
        methods: Detector::ALL.to_vec(),
        default: Detector::default(),
        name: |detector| detector.words().to_owned(),
        run: |detector, drop| first_contact_by(detector, &drop.signals, &drop.coarse),
        error: |drop, found_s| 100.0 * (found_s - drop.contact_s).abs() / drop.drop.contact_s(),
        parts: |_| 1,
    }
}

pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let (contest, count) = (contest(), if request.quick { 12 } else { 60 });
    let mut part = by_class(&CLASSES, progress, |class| {
        contest.points(class.name, &sample::prepared(&sample::plans(class, count, request)), 1, request)
    });
    let off = "error of first contact, % of the pulse";
    let map = |kind| sample::grown(&contest, kind, off, Some, request);
    part.maps = ["white_noise", "low_rate"].into_iter().filter_map(map).collect();
    progress(1.0);
    part
}
