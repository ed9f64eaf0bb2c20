//! Errors and times of a method to a point of its chart.

use crate::lab::data::{TrialPart, TrialPoint};
use crate::lab::methods::timing::Timing;
use crate::numerics::robust;

/// What a point is of.
#[derive(Clone, Copy)]
pub(super) struct Subject<'a> {
    pub family: &'a str,
    pub method: &'a str,
    pub class: &'a str,
    pub is_default: bool,
    /// Of what the error is a share, or its unit.
    pub error_unit: &'a str,
}

/// The point of a method whose time is that of one call; a case without a number counts as `missing`.
pub(super) fn point(subject: Subject, errors: &[Option<f64>], missing: f64, timing: Timing) -> TrialPoint {
    let errors: Vec<f64> = errors.iter().map(|error| error.unwrap_or(missing)).collect();
    TrialPoint {
        family: subject.family.to_owned(),
        method: subject.method.to_owned(),
        class: subject.class.to_owned(),
        is_default: subject.is_default,
        median_error: median(&errors),
        p95_error: percentile(&errors, 0.95),
        error_unit: subject.error_unit.to_owned(),
        time_ns: timing.median_ns,
        time_quartiles_ns: timing.quartiles_ns,
        time_per: "call".to_owned(),
        cases: u32::try_from(errors.len()).unwrap_or(u32::MAX),
    }
}

pub(super) fn median(values: &[f64]) -> f64 {
    robust::median(&mut values.to_vec())
}

/// The smallest value that at least this share of all do not exceed; NaN of none.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a positive count of cases"
)]
pub(super) fn percentile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let index = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(index.saturating_sub(1)).copied().unwrap_or(f64::NAN)
}

/// The points of class after class; `progress` is told the share that is done.
pub(super) fn by_class<C>(
    classes: &[C],
    progress: &dyn Fn(f64),
    of_class: impl Fn(&C) -> Vec<TrialPoint>,
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
