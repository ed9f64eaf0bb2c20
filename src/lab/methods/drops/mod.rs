//! Methods that turn samples into a drop: events, flight, reconstruction, prediction; and what breaks the whole.

mod detection;
mod flight;
mod method_map;
mod prediction;
mod reconstruction;
mod roots;
mod sample;
mod scene;
mod stresses;
mod summary;
mod sweep;

use crate::lab::data::{TrialJob, TrialPart, TrialRequest};

pub(in crate::lab::methods) use reconstruction::peer_work;

pub(super) fn jobs() -> Vec<TrialJob> {
    let job = |name, weight, run| TrialJob { name, weight, run };
    vec![
        job("first-contact", 1.0, detection::run),
        job("flight-fit", 6.0, flight::run),
        job("reconstruction", 6.0, reconstruction::run),
        job("root", 0.5, roots::run),
        job("prediction", 4.0, prediction::run),
        job("recorder", 12.0, recorder),
        job("statements", 6.0, statements),
        job("drops", 9.0, drops),
    ]
}

fn recorder(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    sweep::run(stresses::RECORDER, request, progress)
}

fn statements(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    sweep::run(stresses::STATEMENTS, request, progress)
}

fn drops(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    sweep::run(stresses::DROPS, request, progress)
}
