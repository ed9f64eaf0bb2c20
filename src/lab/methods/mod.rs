//! Each method of the program beside its rivals: time, error against a truth, and where it fails.

mod contest;
mod drops;
mod front;
pub mod rivals;
mod samples;
pub mod timing;

pub use front::front;

use crate::lab::data::{Trial, TrialJob, TrialMachine, TrialPart, TrialPeerWork, TrialRequest};

/// The parts of the trial, in the order in which they run.
#[must_use]
pub fn jobs() -> Vec<TrialJob> {
    [samples::jobs(), drops::jobs()].concat()
}

/// The work that programs of others are given too.
#[must_use]
pub fn peer_work(request: &TrialRequest) -> Vec<TrialPeerWork> {
    [samples::peer_work(request), drops::peer_work(request)].concat()
}

/// All parts as one trial; `peers` says what became of the programs of others.
#[must_use]
pub fn gather(
    request: TrialRequest,
    machine: TrialMachine,
    peers: String,
    parts: impl IntoIterator<Item = TrialPart>,
) -> Trial {
    let (mut points, mut maps) = (Vec::new(), Vec::new());
    for part in parts {
        points.extend(part.points);
        maps.extend(part.maps);
    }
    Trial {
        schema: "dropcheck.validation/1".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        request,
        machine,
        peers,
        is_on_front: front(&points),
        points,
        maps,
    }
}
