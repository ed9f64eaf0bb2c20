//! Each method of the program beside its rivals: time, error against a truth, and where it fails.

mod drops;
mod front;
mod samples;
pub mod timing;

pub use front::front;
pub use samples::accuracy as sample_accuracy;

use crate::data::TrialJob;

/// The parts of the trial, in the order in which they run.
#[must_use]
pub fn jobs() -> Vec<TrialJob> {
    [samples::jobs(), drops::jobs()].concat()
}
