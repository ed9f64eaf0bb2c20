//! Methods that turn samples into a drop: events, flight, reconstruction, prediction; and what breaks the whole.

mod detection;
mod flight;
mod prediction;
mod reconstruction;
mod roots;
mod sample;
mod sweep;

use crate::lab::data::TrialJob;

pub(in crate::lab::methods) use reconstruction::peer_work;

pub(super) fn jobs() -> Vec<TrialJob> {
    let job = |name, weight, run| TrialJob { name, weight, run };
    vec![
        job("first-contact", 1.0, detection::run),
        job("flight-fit", 6.0, flight::run),
        job("reconstruction", 6.0, reconstruction::run),
        job("root", 0.5, roots::run),
        job("prediction", 4.0, prediction::run),
        job("recorder", 12.0, |request, progress| sweep::run("chain", request, progress)),
        job("statements", 4.0, |request, progress| sweep::run("stated", request, progress)),
        job("drops", 9.0, |request, progress| sweep::run("drop", request, progress)),
    ]
}
