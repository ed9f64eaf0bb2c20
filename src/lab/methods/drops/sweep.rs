//! A stress that grows, on several drops, through the whole program to how far off it is and whether it noticed.

use super::scene::{ANF_10, ANF_18, Drawn, ESBB, Plan, VHLW};
use super::summary::{fraction, median};
use crate::analysis::analyze;
use crate::data::{Analysis, Estimate, Verdict};
use crate::lab::data::{BendingMode, TrialLine, TrialMap, TrialPart, TrialRequest, Truth};
use rayon::prelude::*;

/// A slap-down speed further off has failed, %: what a drop test must resolve.
const SPEED_LIMIT_PERCENT: f64 = 1.0;

/// The same of k: dv/dk = v0/2 (contract of the rod at small angles) makes 1 % of 1.75 v0 of speed out of it.
const K_LIMIT: f64 = 0.035;

/// Something that grows until the analysis fails.
pub(super) struct Stress {
    /// Name of its map.
    pub name: &'static str,
    /// What its map shows.
    pub title: &'static str,
    /// What grows, with its unit.
    pub axis: &'static str,
    pub is_log: bool,
    /// From harmless to gross; the quick run takes every third.
    pub values: &'static [f64],
    /// Whether k has a map of its own.
    pub tells_k: bool,
    /// What it does to a sound plan.
    pub apply: fn(&mut Plan, &Facts, f64),
}

/// What a stress may need to know of the sound drop.
pub(super) struct Facts {
    pub flight_s: f64,
    pub contact_s: f64,
    /// Slap-down after first contact, s.
    pub slap_s: f64,
    /// Peak of the first channel over the first contact, m/s².
    pub peak_m_s2: f64,
}

impl Facts {
    fn of(drawn: &Drawn) -> Self {
        let truth = drawn.truth();
        Self {
            flight_s: truth.flight_s.unwrap_or(0.0),
            contact_s: truth.contact_s.unwrap_or(0.0),
            slap_s: truth.slap_t.unwrap_or(0.0),
            peak_m_s2: drawn.first_peak_m_s2(),
        }
    }
}

/// The drops that every stress is laid on: four casks, angles of 10 to 25°, k of 0.3 to 0.6, pulses of 3 to 8 ms, each with a weak mode.
pub(super) fn plans(request: &TrialRequest) -> Vec<Plan> {
    let plan = |order: u64, build, (angle_deg, k, pulse_s), frequency_hz| Plan {
        pulse_s,
        modes: vec![BendingMode { order: 1, frequency_hz, damping: 0.03, strength: 0.3 }],
        ..Plan::of(build, angle_deg, k, request.seed + order)
    };
    let mut plans = vec![
        plan(0, ANF_18, (15.0, 0.5, 5e-3), 120.0),
        plan(1, ANF_10, (10.0, 0.35, 4e-3), 150.0),
        plan(2, VHLW, (20.0, 0.3, 8e-3), 180.0),
        plan(3, ESBB, (12.0, 0.6, 3e-3), 90.0),
        plan(4, ANF_18, (25.0, 0.45, 6e-3), 100.0),
    ];
    if request.quick {
        plans.truncate(3);
    }
    plans
}

/// One quantity of one analysis against its truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scored {
    /// In percent for the speed, in units of k for k; none where no number was given.
    pub error: Option<f64>,
    /// The verdict is not "pass", or the interval holds the truth.
    pub noticed: bool,
}

impl Scored {
    fn of(stated: Option<Estimate>, truth: Option<f64>, scale: f64, passed: bool) -> Self {
        match (stated, truth) {
            (Some(stated), Some(truth)) => {
                let off = (stated.value - truth).abs();
                Self { error: Some(scale * off), noticed: !passed || off <= stated.u95 }
            }
            // A number for what did not happen is wholly off.
            (Some(stated), None) => Self { error: Some(scale * stated.value.abs()), noticed: !passed },
            (None, _) => Self { error: None, noticed: !passed },
        }
    }

    fn fails(&self, limit: f64) -> bool {
        self.error.is_none_or(|error| error > limit)
    }
}

/// A stressed plan through the whole program: its truth, and what the analysis said; none where the recording was refused.
pub(super) fn analysed(
    stress: &Stress,
    (plan, facts): &(Plan, Facts),
    value: f64,
) -> (Truth, Option<Analysis>) {
    let mut plan = plan.clone();
    (stress.apply)(&mut plan, facts, value);
    let drawn = plan.draw();
    let analysis = drawn.recorded().1.map(|recording| analyze(&recording, &drawn.stated));
    (*drawn.truth(), analysis)
}

/// Slap-down speed and k of an analysis against the truth.
pub(super) fn scored((truth, analysis): (Truth, Option<Analysis>)) -> [Scored; 2] {
    let result = analysis.map(|a| a.result);
    let passed = result.as_ref().is_some_and(|r| r.verdict == Verdict::Pass);
    let percent = truth.speed.map_or(100.0, |speed| 100.0 / speed);
    let (speed, k) = result.map_or((None, None), |r| (r.slap_down.speed, r.k));
    [Scored::of(speed, truth.speed, percent, passed), Scored::of(k, truth.k, 1.0, passed)]
}

/// The plans with what is to be known of them before they are stressed.
pub(super) fn sound(request: &TrialRequest) -> Vec<(Plan, Facts)> {
    plans(request)
        .into_par_iter()
        .map(|plan| {
            let facts = Facts::of(&plan.draw());
            (plan, facts)
        })
        .collect()
}

/// The stresses of one run.
pub(super) fn values(stress: &Stress, request: &TrialRequest) -> Vec<f64> {
    stress.values.iter().copied().step_by(if request.quick { 3 } else { 1 }).collect()
}

/// Every stress of a list to its maps.
pub(super) fn run(stresses: &[Stress], request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let sound = sound(request);
    let mut part = TrialPart::default();
    for (done, stress) in stresses.iter().enumerate() {
        progress(fraction(done, stresses.len()));
        let values = values(stress, request);
        let cases: Vec<(f64, &(Plan, Facts))> =
            values.iter().flat_map(|value| sound.iter().map(|plan| (*value, plan))).collect();
        let scored: Vec<[Scored; 2]> =
            cases.par_iter().map(|(value, sound)| scored(analysed(stress, sound, *value))).collect();
        let [speeds, ks] = [0, 1].map(|i| scored.iter().map(|s| s[i]).collect::<Vec<_>>());
        part.maps.push(map(stress, &values, &speeds, Quantity::Speed));
        if stress.tells_k {
            part.maps.push(map(stress, &values, &ks, Quantity::K));
        }
    }
    progress(1.0);
    part
}

#[derive(Clone, Copy, PartialEq)]
enum Quantity {
    Speed,
    K,
}

/// `scored` holds all drops of the first value, then all of the second.
fn map(stress: &Stress, values: &[f64], scored: &[Scored], quantity: Quantity) -> TrialMap {
    let drops = scored.len() / values.len().max(1);
    let (limit, error, suffix) = match quantity {
        Quantity::Speed => (SPEED_LIMIT_PERCENT, "error of the slap-down speed, %", ""),
        Quantity::K => (K_LIMIT, "error of k", "-k"),
    };
    let groups: Vec<&[Scored]> = scored.chunks(drops.max(1)).collect();
    TrialMap {
        name: format!("{}{suffix}", stress.name),
        title: stress.title.to_owned(),
        stress: stress.axis.to_owned(),
        is_log: stress.is_log,
        stresses: values.to_vec(),
        error: error.to_owned(),
        limit,
        lines: vec![
            TrialLine {
                method: format!("median of {drops} drops"),
                errors: groups.iter().map(|group| middle(group)).collect(),
                noticed: groups.iter().map(|group| Some(is_mostly_noticed(group))).collect(),
            },
            TrialLine {
                method: format!("worst of {drops} drops"),
                errors: groups.iter().map(|group| worst(group)).collect(),
                noticed: groups.iter().map(|group| Some(is_noticed(group, limit))).collect(),
            },
        ],
    }
}

/// None where fewer than half of the drops have a number.
fn middle(group: &[Scored]) -> Option<f64> {
    let errors: Vec<f64> = group.iter().filter_map(|s| s.error).collect();
    (2 * errors.len() > group.len()).then(|| median(&errors))
}

fn worst(group: &[Scored]) -> Option<f64> {
    group.iter().filter_map(|s| s.error).max_by(f64::total_cmp)
}

fn is_mostly_noticed(group: &[Scored]) -> bool {
    2 * group.iter().filter(|s| s.noticed).count() > group.len()
}

/// Whether every drop that fails is noticed; where none fails, whether every interval holds the truth.
fn is_noticed(group: &[Scored], limit: f64) -> bool {
    let failing = || group.iter().filter(|s| s.fails(limit));
    if failing().next().is_some() { failing().all(|s| s.noticed) } else { group.iter().all(|s| s.noticed) }
}
