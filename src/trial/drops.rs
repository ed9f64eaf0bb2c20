//! Methods that turn samples into a drop: events, flight, reconstruction, prediction.

use crate::data::TrialJob;

pub(super) fn jobs() -> Vec<TrialJob> {
    Vec::new()
}
