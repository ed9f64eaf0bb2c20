//! Methods that turn samples into samples: filters, ends of records, integration, cut-off.

mod cutoff;
mod double_double;
mod ends;
mod filters;
mod integration;
mod reference;

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
