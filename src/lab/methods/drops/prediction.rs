//! The rungs of the prediction to how far off a drop on stiff ends each is, and what it costs.

use super::scene::{ANF_10, ANF_18, Plan, VHLW};
use super::summary::{Subject, by_class, point};
use crate::data::{Body, BodyModel, Contact, Drop, Prediction, Rung};
use crate::lab::data::{TrialPart, TrialPoint, TrialRequest, Truth};
use crate::lab::methods::timing::{Effort, Work, in_turn};
use crate::predict;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;
use std::hint::black_box;
use std::ops::RangeInclusive;

/// Length of a stiff contact, s: the cask turns by 3e-4 of a radian in it and gains 5e-4 m/s by gravity.
const STIFF_S: f64 = 5e-5;

/// The same where L may come to rest on it, which has to be stepped as finely as a contact: longer, and as much further off.
const RESTED_S: f64 = 1e-3;

/// A thin rod of the length of ANF-18.
const ROD: super::scene::Build = ("rod", 4466.0, 5.512, 0.0);

/// Drops of one kind, from numbers between 0 and 1.
struct Class {
    name: &'static str,
    builds: &'static [super::scene::Build],
    contact: Contact,
    angle_deg: (f64, f64),
    k: (f64, f64),
    /// How often L touches again before R strikes.
    touches: RangeInclusive<u32>,
}

/// A drop with so small a k is predicted with k = 0: the limit that the rungs differ in.
const LIMIT_K: f64 = 2e-3;

const ANY: RangeInclusive<u32> = 0..=u32::MAX;

/// A rung, or the highest one with every touch of L an impact: the limit of stiff ends, where the program leaves grazes out.
#[derive(Clone, Copy, PartialEq)]
enum Method {
    By(Rung),
    EveryTouch,
}

impl Method {
    fn all() -> impl Iterator<Item = Self> {
        Rung::ALL.into_iter().map(Self::By).chain([Self::EveryTouch])
    }

    fn words(self) -> &'static str {
        match self {
            Self::By(rung) => rung.words(),
            Self::EveryTouch => "body, every touch an impact",
        }
    }

    fn predict(self, body: &Body, drop: &Drop, contact: Contact, k: f64) -> Prediction {
        match self {
            Self::By(rung) => predict::predict_by(rung, body, drop, contact, k),
            Self::EveryTouch => predict::predict_grazing(body, drop, contact, k, 0.0),
        }
    }
}

const CLASSES: [Class; 6] = [
    Class {
        name: "thin rod, rough",
        builds: &[ROD],
        contact: Contact::Rough,
        angle_deg: (5.0, 30.0),
        k: (0.1, 0.8),
        touches: ANY,
    },
    Class {
        name: "body, rough",
        builds: &[ANF_10, ANF_18, VHLW],
        contact: Contact::Rough,
        angle_deg: (5.0, 30.0),
        k: (0.1, 0.8),
        touches: ANY,
    },
    Class {
        name: "body, friction 0.3",
        builds: &[ANF_10, ANF_18, VHLW],
        contact: Contact::Coulomb(0.3),
        angle_deg: (5.0, 30.0),
        k: (0.1, 0.8),
        touches: ANY,
    },
    Class {
        name: "k to 0, rough",
        builds: &[ANF_10, ANF_18, VHLW],
        contact: Contact::Rough,
        angle_deg: (8.0, 40.0),
        k: (1e-3, 1e-3),
        touches: ANY,
    },
    Class {
        name: "first end lands once more, rough",
        builds: &[ANF_10, ANF_18, VHLW],
        contact: Contact::Rough,
        angle_deg: (62.0, 68.0),
        k: (0.1, 0.22),
        touches: 1..=1,
    },
    Class {
        name: "first end rattles, rough",
        builds: &[ANF_10, ANF_18, VHLW],
        contact: Contact::Rough,
        angle_deg: (58.0, 68.0),
        k: (0.1, 0.22),
        touches: 2..=u32::MAX,
    },
];

/// Errors are against `synth` on stiff ends.
pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let part = by_class(&CLASSES, progress, |class| of_class(class, request));
    progress(1.0);
    part
}

/// The drops of a class on stiff ends, with their truth; those in which R does not strike are left out.
fn drops(class: &Class, request: &TrialRequest) -> Vec<(Plan, Truth)> {
    let count = if request.quick { 10 } else { 60 } * if class.touches == ANY { 1 } else { 3 };
    let mut random = ChaCha8Rng::seed_from_u64(request.seed);
    let mut between = |(low, high): (f64, f64)| low + (high - low) * random.random::<f64>();
    let plans: Vec<Plan> = (0..count)
        .map(|number| Plan {
            pulse_s: if class.touches == ANY && class.k.1 > LIMIT_K { STIFF_S } else { RESTED_S },
            contact: class.contact,
            ..Plan::of(
                class.builds[number % class.builds.len()],
                between(class.angle_deg),
                between(class.k),
                0,
            )
        })
        .collect();
    plans
        .into_par_iter()
        .filter_map(|plan| {
            let truth = *plan.draw().truth();
            let is_wanted = truth.speed.is_some() && class.touches.contains(&truth.relands);
            is_wanted.then_some((plan, truth))
        })
        .collect()
}

fn of_class(class: &Class, request: &TrialRequest) -> Vec<TrialPoint> {
    let drops = drops(class, request);
    let Some((timed, timed_truth)) = drops.first() else { return Vec::new() };
    // The k that the stiff contact gave, not the one that it was built for.
    let stated_k = |truth: &Truth| truth.k.map_or(0.0, |k| if k < LIMIT_K { 0.0 } else { k.min(1.0) });
    let of = |plan: &Plan| {
        let (cask, drop) = plan.cask_and_drop();
        (predict::body(&cask, BodyModel::Body), drop)
    };
    let ((body, drop), k) = (of(timed), stated_k(timed_truth));
    let mut work: Vec<Work> = Vec::new();
    for method in Method::all() {
        work.push(Box::new(move || {
            black_box(method.predict(black_box(&body), &drop, class.contact, k));
        }));
    }
    let timings = in_turn(&mut work, Effort::of(request.quick));
    let points = Method::all().zip(timings).map(|(method, timing)| {
        let error_percent = |(plan, truth): &(Plan, Truth)| {
            let (body, drop) = of(plan);
            let predicted = method.predict(&body, &drop, class.contact, stated_k(truth));
            Some(100.0 * (predicted.slap_down_speed_m_s? / truth.speed? - 1.0).abs())
        };
        let errors: Vec<Option<f64>> = drops.iter().map(error_percent).collect();
        let subject = Subject {
            family: "prediction",
            method: method.words(),
            class: class.name,
            is_default: method == Method::By(Rung::FurtherImpacts),
            error_unit: "% of the slap-down speed",
        };
        point(subject, &errors, 100.0, timing)
    });
    points.collect()
}
