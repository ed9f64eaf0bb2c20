//! Errors of many cases to points and lines of the trial.

use crate::lab::data::{TrialLine, TrialPoint};
use crate::lab::methods::timing::Timing;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

/// What stands for an error that is no number or beyond all bounds: the method diverged.
pub(super) const DIVERGED: f64 = 1e9;

/// What all points of a chart share.
#[derive(Clone, Copy)]
pub(super) struct Family {
    pub(super) name: &'static str,
    pub(super) error_unit: &'static str,
    pub(super) time_per: &'static str,
}

impl Family {
    /// A point; without a timing its time is 0.
    pub(super) fn point(
        self,
        (method, class): (&str, &str),
        is_default: bool,
        errors: Vec<f64>,
        timing: Option<Timing>,
    ) -> TrialPoint {
        let cases = u32::try_from(errors.len()).unwrap_or(u32::MAX);
        let [median_error, p95_error] = median_and_p95(errors);
        TrialPoint {
            family: self.name.to_owned(),
            method: method.to_owned(),
            class: class.to_owned(),
            is_default,
            median_error,
            p95_error,
            error_unit: self.error_unit.to_owned(),
            time_ns: timing.map_or(0.0, |t| t.median_ns),
            time_quartiles_ns: timing.map_or([0.0; 2], |t| t.quartiles_ns),
            time_per: self.time_per.to_owned(),
            cases,
        }
    }
}

/// Median and 95th percentile; what is no number counts as diverged.
pub(super) fn median_and_p95(mut errors: Vec<f64>) -> [f64; 2] {
    for error in &mut errors {
        *error = if error.is_nan() { DIVERGED } else { error.abs().min(DIVERGED) };
    }
    errors.sort_by(f64::total_cmp);
    let Some(last) = errors.len().checked_sub(1) else { return [DIVERGED; 2] };
    [errors[last / 2], errors[(95 * last).div_ceil(100)]]
}

/// A line of a map whose method has no way to say that something is wrong.
pub(super) fn silent_line(method: &str, errors: Vec<Option<f64>>) -> TrialLine {
    let noticed = vec![None; errors.len()];
    let errors = errors.into_iter().map(|e| e.map(|e| median_and_p95(vec![e])[0])).collect();
    TrialLine { method: method.to_owned(), errors, noticed }
}

/// Largest difference of two curves over the peak of the second.
pub(super) fn worst_of_peak(made: impl Iterator<Item = f64>, truth: &[f64]) -> f64 {
    let peak = truth.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let mut worst = 0.0_f64;
    for (made, true_value) in made.zip(truth) {
        let off = (made - true_value).abs();
        if off.is_nan() {
            return DIVERGED;
        }
        worst = worst.max(off);
    }
    worst / peak.max(f64::MIN_POSITIVE)
}

/// The random numbers of one case: a stream of its own, so that none moves another.
pub(super) fn chance(seed: u64, case: u32) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(u64::from(case));
    generator
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_of_cases() {
        let bits = |values: [f64; 2]| values.map(f64::to_bits);
        assert_eq!(bits(median_and_p95(vec![3.0, -1.0, 2.0])), bits([2.0, 3.0]));
        assert_eq!(bits(median_and_p95(vec![f64::NAN, 1.0])), bits([1.0, DIVERGED]));
        assert!(worst_of_peak([1.0, f64::NAN].into_iter(), &[1.0, 1.0]) >= DIVERGED);
    }
}
