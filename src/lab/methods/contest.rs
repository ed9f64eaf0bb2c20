//! Methods that do the same work, and cases of it, to points and lines of the trial: how far off each is, and what it costs.

use super::timing::{Effort, Timing, Work, in_turn};
use crate::lab::data::{TrialLine, TrialMap, TrialPart, TrialPoint, TrialRequest};
use rayon::prelude::*;
use std::hint::black_box;

/// What stands for an error that is no number or beyond all bounds: the method diverged.
pub(super) const DIVERGED: f64 = 1e9;

/// What all points of a chart share.
#[derive(Clone, Copy)]
pub(super) struct Purpose {
    /// What the methods are for: "filter".
    pub name: &'static str,
    /// Of what the error is a share, or its unit.
    pub error_unit: &'static str,
    /// What the time is of: "sample", "call".
    pub time_per: &'static str,
    /// What a case counts as in which a method gives no number.
    pub missing: f64,
}

/// What a method did on the cases of a class.
pub(super) struct MethodRecord {
    pub method: String,
    pub is_default: bool,
    pub errors: Vec<Option<f64>>,
    pub timing: Timing,
}

impl Purpose {
    /// Of methods whose time is that of a sample.
    pub(super) const fn of_samples(name: &'static str, error_unit: &'static str) -> Self {
        Self { name, error_unit, time_per: "sample", missing: DIVERGED }
    }

    /// Of methods that answer a call by a number; without one they are wholly off.
    pub(super) const fn of_calls(name: &'static str, error_unit: &'static str) -> Self {
        Self { name, error_unit, time_per: "call", missing: 100.0 }
    }

    /// The point of a method on a class.
    pub(super) fn point(&self, class: &str, record: MethodRecord) -> TrialPoint {
        let cases = u32::try_from(record.errors.len()).unwrap_or(u32::MAX);
        let errors = record.errors.into_iter().map(|error| error.unwrap_or(self.missing));
        let [median_error, p95_error] = median_and_p95(errors.collect());
        TrialPoint {
            family: self.name.to_owned(),
            method: record.method,
            class: class.to_owned(),
            is_default: record.is_default,
            median_error,
            p95_error,
            error_unit: self.error_unit.to_owned(),
            time_ns: record.timing.median_ns,
            time_quartiles_ns: record.timing.quartiles_ns,
            time_per: self.time_per.to_owned(),
            cases,
        }
    }
}

/// Methods `M` that make an outcome `O` of a case `C`.
pub(super) struct Contest<M, C, O> {
    pub purpose: Purpose,
    pub methods: Vec<M>,
    /// What the program takes where nothing is said.
    pub default: M,
    /// The method by its public name.
    pub name: fn(M) -> String,
    /// The work; none where the method gives no number.
    pub run: fn(M, &C) -> Option<O>,
    /// How far off the outcome is.
    pub error: fn(&C, O) -> f64,
    /// How many of what the time is of a case has.
    pub parts: fn(&C) -> usize,
}

impl<M: Copy + PartialEq + Sync, C: Sync, O> Contest<M, C, O> {
    /// The error of each method, in their order, on each case.
    fn errors(&self, cases: &[C]) -> Vec<Vec<Option<f64>>> {
        let on = |case: &C, method: M| (self.run)(method, case).map(|outcome| (self.error)(case, outcome));
        let of_case = |case: &C| -> Vec<_> { self.methods.iter().map(|method| on(case, *method)).collect() };
        let by_case: Vec<Vec<Option<f64>>> = cases.par_iter().map(of_case).collect();
        (0..self.methods.len()).map(|i| by_case.iter().map(|errors| errors[i]).collect()).collect()
    }

    /// The points of a class of cases; times are those of the first `timed` of them.
    pub(super) fn points(
        &self,
        class: &str,
        cases: &[C],
        timed: usize,
        request: &TrialRequest,
    ) -> Vec<TrialPoint> {
        let timed = &cases[..timed.min(cases.len())];
        let work = |method: &M| -> Work {
            let method = *method;
            Box::new(move || {
                for case in timed {
                    drop(black_box((self.run)(method, black_box(case))));
                }
            })
        };
        let parts = timed.iter().map(self.parts).sum();
        let timings =
            in_turn(&mut self.methods.iter().map(work).collect::<Vec<_>>(), Effort::of(request.quick));
        let records = self.methods.iter().zip(self.errors(cases)).zip(timings);
        let point = |((method, errors), timing): ((&M, Vec<Option<f64>>), Timing)| {
            let (method, is_default) = ((self.name)(*method), *method == self.default);
            self.purpose.point(class, MethodRecord { method, is_default, errors, timing: timing.per(parts) })
        };
        if cases.is_empty() { Vec::new() } else { records.map(point).collect() }
    }

    /// The median error of each method over the cases at each stress; none where fewer than half of them have a number.
    pub(super) fn lines<S: Sync>(
        &self,
        stresses: &[S],
        cases: impl Fn(&S) -> Vec<C> + Sync,
    ) -> Vec<TrialLine> {
        let column = |stress: &S| -> Vec<_> {
            self.errors(&cases(stress)).iter().map(|errors| middle(errors)).collect()
        };
        let columns: Vec<Vec<Option<f64>>> = stresses.par_iter().map(column).collect();
        let line = |(i, method): (usize, &M)| {
            silent_line((self.name)(*method), columns.iter().map(|column| column[i]).collect())
        };
        self.methods.iter().enumerate().map(line).collect()
    }
}

/// A map by its name, its title, what grows and what the error is; above `limit` a method has failed.
pub(super) fn map(words: [&str; 4], stresses: Vec<f64>, limit: f64, lines: Vec<TrialLine>) -> TrialMap {
    let [name, title, stress, error] = words.map(str::to_owned);
    let least = stresses.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = stresses.iter().copied().fold(0.0, f64::max);
    TrialMap {
        name,
        title,
        stress,
        is_log: least > 0.0 && largest > 10.0 * least,
        stresses,
        error,
        limit,
        lines,
    }
}

/// Some of a list: all in the full run, every third in the quick one.
pub(super) fn some_of(values: &[f64], request: &TrialRequest) -> Vec<f64> {
    values.iter().copied().step_by(if request.quick { 3 } else { 1 }).collect()
}

/// A line of a map whose method has no way to say that something is wrong.
pub(super) fn silent_line(method: String, errors: Vec<Option<f64>>) -> TrialLine {
    let noticed = vec![None; errors.len()];
    let errors = errors.into_iter().map(|e| e.map(|e| median_and_p95(vec![e])[0])).collect();
    TrialLine { method, errors, noticed }
}

/// The median of the numbers; none where fewer than half are any.
pub(super) fn middle(errors: &[Option<f64>]) -> Option<f64> {
    let numbers: Vec<f64> = errors.iter().copied().flatten().collect();
    (2 * numbers.len() > errors.len()).then(|| median_and_p95(numbers)[0])
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

/// The points of class after class; `progress` is told the share that is done.
pub(super) fn by_class<K>(
    classes: &[K],
    progress: &dyn Fn(f64),
    of_class: impl Fn(&K) -> Vec<TrialPoint>,
) -> TrialPart {
    let mut part = TrialPart::default();
    for (done, class) in classes.iter().enumerate() {
        progress(fraction(done, classes.len()));
        part.points.extend(of_class(class));
    }
    part
}

/// `part` of `whole`.
#[allow(clippy::cast_precision_loss, reason = "a share for a progress bar")]
pub(super) fn fraction(part: usize, whole: usize) -> f64 {
    part as f64 / whole.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_of_cases() {
        let bits = |values: [f64; 2]| values.map(f64::to_bits);
        assert_eq!(bits(median_and_p95(vec![3.0, -1.0, 2.0])), bits([2.0, 3.0]));
        assert_eq!(bits(median_and_p95(vec![f64::NAN, 1.0])), bits([1.0, DIVERGED]));
        assert_eq!(middle(&[Some(2.0), None]), None);
    }

    #[test]
    fn an_axis_is_logarithmic_over_more_than_a_decade() {
        let is_log = |stresses: &[f64]| map([""; 4], stresses.to_vec(), 1.0, Vec::new()).is_log;
        assert!(is_log(&[100.0, 1.0]) && !is_log(&[2.0, 20.0]) && !is_log(&[100.0, 0.0]));
    }
}
