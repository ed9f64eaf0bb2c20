//! Methods that turn samples into samples: filters, ends of records, integration, cut-off.

mod cutoff;
mod double_double;
mod ends;
mod filters;
mod integration;
mod reference;
mod summary;

use crate::lab::data::{TrialJob, TrialPart, TrialPeerWork, TrialRequest};

pub(super) fn jobs() -> Vec<TrialJob> {
    vec![
        TrialJob { name: "filters", weight: 4.0, run: filters::run },
        TrialJob { name: "record-ends", weight: 2.0, run: ends::run },
        TrialJob { name: "integration", weight: 2.0, run: integration::run },
        TrialJob { name: "cut-off", weight: 1.0, run: cutoff::run },
    ]
}

/// The errors of these methods without their times, which are 0.
#[must_use]
pub fn accuracy(request: &TrialRequest) -> TrialPart {
    let points = [
        filters::points(request, None, &|_| ()),
        ends::points(request, None),
        integration::points(request, None),
        cutoff::points(request, None),
    ];
    // A tenth of the quick run's longest sum: what a test has time for.
    let maps = [
        filters::maps(request),
        ends::maps(request),
        integration::maps(request, 1_000_000),
        cutoff::maps(request),
    ];
    TrialPart { points: points.concat(), maps: maps.concat() }
}

/// The work of these methods that programs of others are given too.
#[must_use]
pub(super) fn peer_work(request: &TrialRequest) -> Vec<TrialPeerWork> {
    [filters::peer_work(request), integration::peer_work(request)].concat()
}
