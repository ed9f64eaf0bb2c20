//! A stress that grows, on several drops, to how far off each rival method is.

use super::sample::{self, Class, Prepared};
use super::scene::Plan;
use super::summary::median;
use crate::lab::data::{TrialLine, TrialMap, TrialRequest};
use rayon::prelude::*;

/// A method is off by 1 % of what it measures.
const LIMIT_PERCENT: f64 = 1.0;

/// Something that grows until the methods fail.
pub(super) struct MethodStress {
    pub name: &'static str,
    pub title: &'static str,
    pub axis: &'static str,
    /// What the error is, with its unit.
    pub error: &'static str,
    /// From harmless to gross; the quick run takes every third.
    pub values: &'static [f64],
    /// What it does to a sound plan, with its flight, s.
    pub apply: fn(&mut Plan, f64, f64),
}

const SOUND: Class = Class { name: "sound", make: |_, _, _| {} };

/// The median error of each of `methods` along `stress`; `errors` gives one error a method, in their order.
pub(super) fn map(
    stress: &MethodStress,
    request: &TrialRequest,
    methods: &[&str],
    errors: &(dyn Fn(&Prepared) -> Vec<Option<f64>> + Sync),
) -> TrialMap {
    let values: Vec<f64> = stress.values.iter().copied().step_by(if request.quick { 3 } else { 1 }).collect();
    let plans: Vec<(Plan, f64)> = sample::plans(&SOUND, if request.quick { 5 } else { 25 }, request)
        .into_iter()
        .map(|plan| {
            let flight_s = plan.draw().truth().flight_s.unwrap_or(0.0);
            (plan, flight_s)
        })
        .collect();
    let stressed = |value: f64| -> Vec<Plan> {
        let apply = |(plan, flight_s): &(Plan, f64)| {
            let mut plan = plan.clone();
            (stress.apply)(&mut plan, *flight_s, value);
            plan
        };
        plans.iter().map(apply).collect()
    };
    let mut lines: Vec<TrialLine> = methods
        .iter()
        .map(|method| TrialLine { method: (*method).to_owned(), errors: Vec::new(), noticed: Vec::new() })
        .collect();
    for value in &values {
        let drops = sample::prepared(&stressed(*value));
        let found: Vec<Vec<Option<f64>>> = drops.par_iter().map(errors).collect();
        for (i, line) in lines.iter_mut().enumerate() {
            let of_method: Vec<f64> = found.iter().filter_map(|f| f.get(i).copied().flatten()).collect();
            line.errors.push((2 * of_method.len() > plans.len()).then(|| median(&of_method)));
            line.noticed.push(None);
        }
    }
    TrialMap {
        name: stress.name.to_owned(),
        title: stress.title.to_owned(),
        stress: stress.axis.to_owned(),
        is_log: true,
        stresses: values,
        error: stress.error.to_owned(),
        limit: LIMIT_PERCENT,
        lines,
    }
}
