//! The rungs of the reconstruction to how far off each leaves slap-down speed and k, and what all of them cost, which are made at once.

use super::contest::measured;
use super::drops::{CALM, DropClass, NOISY, ONE_MODE, SLOW_MODE};
use super::timing::in_turn;
use crate::analysis::analyze;
use crate::data::{Axis, DropResult, End, ReconstructionRung, Recording};
use crate::lab::data::{TrialPoint, TrialRequest, Truth};
use crate::lab::drawn::DrawnDrop;
use crate::lab::plan::DropPlan;
use crate::numerics::filter::ZeroPhaseLowPass;
use crate::numerics::quadrature::running_integral;
use rayon::prelude::*;
use std::hint::black_box;

const CLASSES: [DropClass; 5] = [
    CALM,
    NOISY,
    ONE_MODE,
    SLOW_MODE,
    DropClass { name: "12 ms pulse", make: |plan, _, _| plan.pulse_s = 0.012 },
];

/// Slap-down speed, m/s, and k, as a method says them.
#[derive(Clone, Copy, Default)]
struct Stated {
    speed: Option<f64>,
    k: Option<f64>,
}

/// A drop, its recording analysed.
struct AnalyzedDrop {
    truth: Truth,
    result: Option<DropResult>,
    by_notebook_m_s: Option<f64>,
}

impl AnalyzedDrop {
    fn of(plan: &DropPlan) -> Self {
        let drop = plan.draw();
        let read = drop.read(&drop.recorded());
        let result = read.as_ref().map(|read| analyze(read, &drop.stated).result);
        let by_notebook_m_s = read.and_then(|read| by_notebook_m_s(&drop, &read));
        Self { truth: drop.motion.truth, result, by_notebook_m_s }
    }

    fn by(&self, rung: ReconstructionRung) -> Stated {
        let choice = self.result.iter().flat_map(|result| &result.reconstruction);
        let candidate = choice.flat_map(|choice| &choice.candidates).find(|c| c.rung == rung);
        candidate.map_or_else(Stated::default, |c| Stated {
            speed: c.speed.map(|e| e.value),
            k: c.k.map(|e| e.value),
        })
    }

    fn as_taken(&self) -> Stated {
        self.result.as_ref().map_or_else(Stated::default, |result| Stated {
            speed: result.slap_down.speed.map(|e| e.value),
            k: result.k.map(|e| e.value),
        })
    }
}

/// What the result says to take.
const TAKEN: &str = "as taken";
/// What is no part of the analysis, and costs less.
const NOTEBOOK: &str = "second end alone, as in a notebook";

/// A method by its name.
type Saying = (&'static str, fn(&AnalyzedDrop) -> Stated);

const METHODS: [Saying; 6] = [
    ("channels", |drop| drop.by(ReconstructionRung::Channels)),
    ("planar", |drop| drop.by(ReconstructionRung::Planar)),
    ("flight", |drop| drop.by(ReconstructionRung::Flight)),
    ("joint", |drop| drop.by(ReconstructionRung::Joint)),
    (TAKEN, AnalyzedDrop::as_taken),
    (NOTEBOOK, |drop| Stated { speed: drop.by_notebook_m_s, k: None }),
];

/// Slap-down speed as one reads it off the second end's velocity: CFC 180, integrated, at the foot of the highest pulse.
fn by_notebook_m_s(drop: &DrawnDrop, read: &Recording) -> Option<f64> {
    let second = read.channels.iter().find(|c| c.end == End::Second && c.axis == Axis::Transverse)?;
    let force = second.force_m_s2(0, second.samples.len());
    let smooth = ZeroPhaseLowPass::with_cfc(180.0, second.sample_rate_hz)?.apply(&force);
    let top = (0..smooth.len()).max_by(|&a, &b| smooth[a].total_cmp(&smooth[b]))?;
    let foot = (0..top).rev().find(|&i| smooth[i] < 0.05 * smooth[top])?;
    Some(drop.stated.drop.impact_velocity_m_s - running_integral(&smooth, 1.0 / second.sample_rate_hz)[foot])
}

/// What is reconstructed.
struct Reconstructed {
    family: &'static str,
    error_unit: &'static str,
    /// What a method is off by where it gives no number.
    missing: f64,
    error: fn(&Stated, &Truth) -> Option<f64>,
}

const QUANTITIES: [Reconstructed; 2] = [
    Reconstructed {
        family: "reconstruction, speed",
        error_unit: "% of the slap-down speed",
        missing: 100.0,
        error: |stated, truth| Some(100.0 * (stated.speed? / truth.speed? - 1.0).abs()),
    },
    Reconstructed {
        family: "reconstruction, k",
        error_unit: "1",
        missing: 1.0,
        error: |stated, truth| Some((stated.k? - truth.k?).abs()),
    },
];

pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    let mut points: Vec<TrialPoint> = CLASSES.iter().flat_map(|class| of_class(class, request)).collect();
    // Speed, then k.
    points.sort_by(|a, b| b.family.cmp(&a.family));
    points
}

fn of_class(class: &DropClass, request: &TrialRequest) -> Vec<TrialPoint> {
    let plans = class.plans(request.either(6, 40), request);
    let Some([all_ns, notebook_ns]) = plans.first().and_then(|plan| times_ns(plan, request)) else {
        return Vec::new();
    };
    let drops: Vec<AnalyzedDrop> = plans.par_iter().map(AnalyzedDrop::of).collect();
    let point = |(method, says): Saying, of: &Reconstructed| {
        let errors: Vec<Option<f64>> =
            drops.iter().map(|drop| (of.error)(&says(drop), &drop.truth)).collect();
        let all = errors.iter().map(|error| error.unwrap_or(of.missing)).collect();
        // A method that never says anything of a quantity is none for it.
        errors.iter().any(Option::is_some).then(|| TrialPoint {
            family: of.family.to_owned(),
            method: method.to_owned(),
            class: class.name.to_owned(),
            is_default: method == TAKEN,
            error_unit: of.error_unit.to_owned(),
            time_per: "call".to_owned(),
            ..measured(all, if method == NOTEBOOK { notebook_ns } else { all_ns })
        })
    };
    METHODS
        .into_iter()
        .flat_map(|method| QUANTITIES.each_ref().map(|of| point(method, of)))
        .flatten()
        .collect()
}

/// Quartiles of what the analysis of a recording takes that is read, and of what the notebook takes, ns.
fn times_ns(plan: &DropPlan, request: &TrialRequest) -> Option<[[f64; 3]; 2]> {
    let drop = plan.draw();
    let read = drop.read(&drop.recorded())?;
    let analysis = || {
        black_box(analyze(black_box(&read), &drop.stated));
    };
    let notebook = || {
        black_box(by_notebook_m_s(&drop, black_box(&read)));
    };
    in_turn(&mut [Box::new(analysis), Box::new(notebook)], request.quick).try_into().ok()
}
