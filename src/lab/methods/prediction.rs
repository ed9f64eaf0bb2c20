//! The rungs of the prediction to how far off a drop on stiff ends each is, and what it costs.

use super::points::{Answer, KnownDrop, SPEED, WayQuantity, Worked, scored};
use crate::data::{Body, BodyModel, Contact, Drop, Rung};
use crate::lab::chance::Chance;
use crate::lab::data::{TrialPoint, TrialRequest};
use crate::lab::drawn::{ANF_10, ANF_18, Build, DropPlan, VHLW};
use crate::predict;
use rayon::prelude::*;
use std::hint::black_box;
use std::ops::RangeInclusive;

/// Length of a stiff contact, s: the cask turns by 3e-4 of a radian in it and gains 5e-4 m/s by gravity.
const STIFF_S: f64 = 5e-5;

/// The same where L may come to rest on it, which has to be stepped as finely as a contact: longer, and as
/// much further off.
const RESTED_S: f64 = 1e-3;

/// A thin rod of the length of ANF-18.
const ROD: Build = Build { name: "rod", section_m: 0.0, ..ANF_18 };

/// Drops of one kind, from numbers between 0 and 1.
struct PredictedClass {
    name: &'static str,
    builds: &'static [Build],
    contact: Contact,
    angle_deg: (f64, f64),
    k: (f64, f64),
    /// Length of the contact, where it is not short.
    pulse_s: Option<(f64, f64)>,
    /// How often L touches again before R strikes.
    touches: RangeInclusive<u32>,
}

/// A drop with so small a k is predicted with k = 0: the limit that the rungs differ in.
const LIMIT_K: f64 = 2e-3;

const ANY: RangeInclusive<u32> = 0..=u32::MAX;

/// A drop on stiff ends: what a prediction is given, and what happened.
struct StiffDrop {
    body: Body,
    drop: Drop,
    contact: Contact,
    k: f64,
    known: KnownDrop,
}

const BODY: PredictedClass = PredictedClass {
    name: "body, rough",
    builds: &[ANF_10, ANF_18, VHLW],
    contact: Contact::Rough,
    angle_deg: (5.0, 30.0),
    k: (0.1, 0.8),
    pulse_s: None,
    touches: ANY,
};
const RATTLES: PredictedClass = PredictedClass {
    name: "first end rattles, rough",
    angle_deg: (58.0, 68.0),
    k: (0.1, 0.22),
    touches: 2..=u32::MAX,
    ..BODY
};
const CLASSES: [PredictedClass; 7] = [
    PredictedClass { name: "thin rod, rough", builds: &[ROD], ..BODY },
    BODY,
    PredictedClass { name: "body, rough, contact of 5 to 25 ms", pulse_s: Some((5e-3, 0.025)), ..BODY },
    PredictedClass { name: "body, friction 0.3", contact: Contact::Coulomb(0.3), ..BODY },
    PredictedClass { name: "k to 0, rough", angle_deg: (8.0, 40.0), k: (1e-3, 1e-3), ..BODY },
    PredictedClass {
        name: "first end lands once more, rough",
        angle_deg: (62.0, 68.0),
        touches: 1..=1,
        ..RATTLES
    },
    RATTLES,
];

/// What it is called among the ways.
pub(super) const FAMILY: &str = "prediction, given k";

/// Errors are against `synth` on stiff ends.
const QUANTITY: WayQuantity = WayQuantity { family: FAMILY, time_per: "call", ..SPEED };

/// Calls of a rung that are timed together: the shortest takes no longer than the clock.
const CALLS: u32 = 20;

/// The highest rung first, which is what the program takes; last, as none, the limit of stiff ends, where the
/// program leaves grazes out.
fn rungs() -> impl Iterator<Item = Option<Rung>> {
    Rung::ALL.into_iter().rev().map(Some).chain([None])
}

/// The slap-down speed by a rung, m/s.
fn speed_m_s(rung: Option<Rung>, at: &StiffDrop) -> Option<f64> {
    let prediction = match rung {
        Some(rung) => predict::predict_by(rung, &at.body, &at.drop, at.contact, at.k),
        None => predict::predict_grazing(&at.body, &at.drop, at.contact, at.k, 0.0),
    };
    prediction.slap_down_speed_m_s
}

/// The points of all rungs by class; a drop of which a rung gives no speed is missing there.
pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    let drops: Vec<StiffDrop> = CLASSES.iter().flat_map(|class| drops(class, request)).collect();
    let named = |(i, rung): (usize, Option<Rung>)| {
        Worked::named(rung.map_or("body, every touch an impact", Rung::words), i == 0)
    };
    let mut worked: Vec<Worked> = rungs().enumerate().map(named).collect();
    for drop in &drops {
        for (worked, rung) in worked.iter_mut().zip(rungs()) {
            worked.timed(CALLS, || Some(Answer::bare(speed_m_s(rung, black_box(drop)), None)));
        }
    }
    let known: Vec<KnownDrop> = drops.iter().map(|drop| drop.known).collect();
    scored(&QUANTITY, &worked, &known)
}

/// The drops of a class on stiff ends, with their truth; those in which R does not strike are left out.
fn drops(class: &PredictedClass, request: &TrialRequest) -> Vec<StiffDrop> {
    let count = request.either(10, 60) * if class.touches == ANY { 1 } else { 3 };
    let mut chance = Chance::new(request.seed, 0);
    let stiff_s = if class.touches == ANY && class.k.1 > LIMIT_K { STIFF_S } else { RESTED_S };
    let plans: Vec<DropPlan> = (0..count)
        .map(|number| {
            let build = class.builds[number % class.builds.len()];
            DropPlan {
                pulse_s: class.pulse_s.map_or(stiff_s, |pulse_s| chance.between(pulse_s)),
                contact: class.contact,
                ..DropPlan::of(build, chance.between(class.angle_deg), chance.between(class.k), 0)
            }
        })
        .collect();
    let stiff = |plan: &DropPlan| {
        let drawn = plan.draw();
        let truth = drawn.motion.truth;
        let drop = StiffDrop {
            body: predict::body(&drawn.scene.cask, BodyModel::Body),
            drop: Drop { contact_duration_s: truth.contact_s?, ..drawn.scene.drop },
            contact: class.contact,
            // The k that the stiff contact gave, not the one that it was built for.
            k: truth.k.map_or(0.0, |k| if k < LIMIT_K { 0.0 } else { k.min(1.0) }),
            known: KnownDrop { class: class.name, truth },
        };
        truth.speed?;
        class.touches.contains(&truth.relands).then_some(drop)
    };
    plans.par_iter().filter_map(stiff).collect()
}
