//! Methods that turn samples into samples: filters, ends of records, integration, cut-off.

mod cutoff;
mod double_double;
mod ends;
mod filters;
mod integration;
mod reference;

use super::contest::DIVERGED;
use crate::lab::data::{TrialJob, TrialPeerWork, TrialRequest};

pub(super) fn jobs() -> Vec<TrialJob> {
    vec![
        TrialJob { name: "filters", weight: 4.0, run: filters::run },
        TrialJob { name: "record-ends", weight: 2.0, run: ends::run },
        TrialJob { name: "integration", weight: 2.0, run: integration::run },
        TrialJob { name: "cut-off", weight: 1.0, run: cutoff::run },
    ]
}

/// The work of these methods that programs of others are given too.
#[must_use]
pub(super) fn peer_work(request: &TrialRequest) -> Vec<TrialPeerWork> {
    [filters::peer_work(request), integration::peer_work(request)].concat()
}

/// Largest difference of two curves over the peak of the second.
fn worst_of_peak(made: impl Iterator<Item = f64>, truth: &[f64]) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_that_is_no_number_has_diverged() {
        assert!(worst_of_peak([1.0, f64::NAN].into_iter(), &[1.0, 1.0]) >= DIVERGED);
        assert!((worst_of_peak([1.0, 3.0].into_iter(), &[1.0, 2.0]) - 0.5).abs() < 1e-15);
    }
}
