//! Methods of finding first contact to their errors and times.

use super::contest::{Contest, Method};
use super::drops::{DropClass, NOISY, Prepared};
use crate::data::STANDARD_GRAVITY_M_S2;
use crate::events::first_contact;
use crate::events::onset::{FOOT, FirstPulse, NOISE_FACTOR};
use crate::lab::data::{TrialPoint, TrialRequest};

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

fn contest() -> Contest<Prepared, f64> {
    Contest {
        family: "first contact",
        error_unit: "% of the pulse",
        matters: 1.0,
        samples: None,
        methods: vec![
            Method::new("line through the rise", |drop: &Prepared| {
                Some(first_contact(&drop.signals, &drop.coarse)?.time_s)
            }),
            Method::new("threshold", threshold),
        ],
        error: |drop, found_s| 100.0 * (found_s - drop.contact_s).abs() / drop.drop.contact_s(),
    }
}

/// The first sample beyond 2 % of the peak, or beyond 6 standard deviations of the noise where that is more.
fn threshold(drop: &Prepared) -> Option<f64> {
    let FirstPulse { signal, stretch, sign } = FirstPulse::about(&drop.signals, &drop.coarse)?;
    let force = signal.force_m_s2.get(stretch.clone())?;
    let peak = force.iter().map(|f| sign * f).max_by(f64::total_cmp)?;
    let level = peak.max(NOISE_FACTOR / FOOT * signal.noise_m_s2) * FOOT;
    Some(signal.time_s(stretch.start + force.iter().position(|f| sign * f > level)?))
}

pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    contest().points(&CLASSES, request, |class| {
        (class.name.to_owned(), class.prepared(request.either(12, 60), request))
    })
}
