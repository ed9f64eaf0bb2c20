//! Methods that do the same work, and cases of it, to points of the trial: how far off each is, and what it costs.

use super::timing::{Work, in_turn};
use crate::lab::data::{TrialPoint, TrialRequest};
use crate::numerics::{as_f64, robust};
use rayon::prelude::*;
use std::hint::black_box;

/// What stands for an error that is no number or beyond all bounds: the method diverged.
pub(super) const DIVERGED: f64 = 1e9;

/// What a method that answers a call is off by where it gives no number, %: wholly.
const NO_NUMBER: f64 = 100.0;

/// Makes an outcome of a case; none where it gives no number.
type Run<C, O> = Box<dyn Fn(&C) -> Option<O> + Sync>;

/// A way to make an outcome `O` of a case `C`.
pub(super) struct Method<C, O> {
    /// Its public name.
    name: String,
    run: Run<C, O>,
}

impl<C, O> Method<C, O> {
    pub(super) fn new(name: impl Into<String>, run: impl Fn(&C) -> Option<O> + Sync + 'static) -> Self {
        Self { name: name.into(), run: Box::new(run) }
    }
}

/// A family of methods for the same work.
pub(super) struct Contest<C, O> {
    /// What the methods are for: "filter".
    pub family: &'static str,
    /// Of what the error is a share, or its unit.
    pub error_unit: &'static str,
    /// From where on a difference between two methods matters, in `error_unit`.
    pub matters: f64,
    /// How many samples a case has, of which one is timed; none: a call is timed.
    pub samples: Option<fn(&C) -> usize>,
    /// What the program takes where nothing is said, then its rivals.
    pub methods: Vec<Method<C, O>>,
    /// How far off an outcome is.
    pub error: fn(&C, O) -> f64,
}

impl<C: Sync, O> Contest<C, O> {
    /// The points of class after class, of which `named` gives the name and the cases.
    pub(super) fn points<K>(
        &self,
        classes: &[K],
        request: &TrialRequest,
        named: impl Fn(&K) -> (String, Vec<C>),
    ) -> Vec<TrialPoint> {
        let of_class = |class| {
            let (name, cases) = named(class);
            self.of_class(&name, &cases, request)
        };
        classes.iter().flat_map(of_class).collect()
    }

    /// Times are those of the first case.
    fn of_class(&self, class: &str, cases: &[C], request: &TrialRequest) -> Vec<TrialPoint> {
        let Some(first) = cases.first() else { return Vec::new() };
        let mut work: Vec<Work> = Vec::new();
        for Method { run, .. } in &self.methods {
            work.push(Box::new(move || drop(black_box(run(black_box(first))))));
        }
        let times_ns = in_turn(&mut work, request.quick);
        let (time_per, parts, missing) = match self.samples {
            Some(samples) => ("sample", samples(first), DIVERGED),
            None => ("call", 1, NO_NUMBER),
        };
        let point = |(i, (method, time_ns)): (usize, (&Method<C, O>, [f64; 3]))| {
            let error = |case: &C| (method.run)(case).map_or(missing, |outcome| (self.error)(case, outcome));
            let words = TrialPoint {
                family: self.family.to_owned(),
                method: method.name.clone(),
                class: class.to_owned(),
                is_default: i == 0,
                error_unit: self.error_unit.to_owned(),
                time_per: time_per.to_owned(),
                matters: self.matters,
                ..TrialPoint::default()
            };
            measured(words, cases.par_iter().map(error).collect(), time_ns.map(|ns| ns / as_f64(parts)))
        };
        self.methods.iter().zip(times_ns).enumerate().map(point).collect()
    }
}

/// A point with these words, of the errors of cases and the quartiles of a time.
pub(super) fn measured(
    words: TrialPoint,
    errors: Vec<f64>,
    [lower_ns, time_ns, upper_ns]: [f64; 3],
) -> TrialPoint {
    let cases = u32::try_from(errors.len()).unwrap_or(u32::MAX);
    let [median_error, p95_error] = median_and_p95(errors.clone());
    let time_quartiles_ns = [lower_ns, upper_ns];
    TrialPoint { median_error, p95_error, time_ns, time_quartiles_ns, cases, errors, ..words }
}

/// What all classes together are called.
pub const ALL_CLASSES: &str = "all";

/// Points of a family with one more for each method: of all its cases, in the median of its times.
pub(super) fn with_pooled(mut points: Vec<TrialPoint>) -> Vec<TrialPoint> {
    let Some(class) = points.first().map(|p| p.class.clone()) else { return points };
    let methods: Vec<TrialPoint> = points.iter().filter(|p| p.class == class).cloned().collect();
    for words in methods {
        let of: Vec<&TrialPoint> = points.iter().filter(|p| p.method == words.method).collect();
        let middle = |number: fn(&TrialPoint) -> f64| {
            robust::median(&mut of.iter().map(|p| number(p)).collect::<Vec<_>>())
        };
        let held: Vec<f64> = of.iter().filter_map(|p| p.held).collect();
        let all = TrialPoint {
            class: ALL_CLASSES.to_owned(),
            missing: of.iter().map(|p| p.missing).sum(),
            promised: words.promised.map(|_| middle(|p| p.promised.unwrap_or(f64::NAN))),
            held: words.held.map(|_| held.iter().sum::<f64>() / as_f64(held.len())),
            ..words
        };
        let times_ns =
            [middle(|p| p.time_quartiles_ns[0]), middle(|p| p.time_ns), middle(|p| p.time_quartiles_ns[1])];
        points.push(measured(all, of.iter().flat_map(|p| p.errors.iter().copied()).collect(), times_ns));
    }
    points
}

/// Median and 95th percentile, each that of a case; what is no number counts as diverged.
pub(super) fn median_and_p95(mut errors: Vec<f64>) -> [f64; 2] {
    for error in &mut errors {
        *error = if error.is_nan() { DIVERGED } else { error.abs().min(DIVERGED) };
    }
    errors.sort_by(f64::total_cmp);
    let Some(last) = errors.len().checked_sub(1) else { return [DIVERGED; 2] };
    [errors[last / 2], errors[(95 * last).div_ceil(100)]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_of_cases() {
        let bits = |values: [f64; 2]| values.map(f64::to_bits);
        assert_eq!(bits(median_and_p95(vec![3.0, -1.0, 2.0])), bits([2.0, 3.0]));
        assert_eq!(bits(median_and_p95(vec![f64::NAN, 1.0])), bits([1.0, DIVERGED]));
    }
}
