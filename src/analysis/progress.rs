//! How far an analysis came, with what it found on the way.

use super::comparison::Measured;
use super::flight::Flown;

/// How far an analysis came from the first impact on.
pub(super) enum Reached {
    /// The times, as far as they were found, and the curves of the channels.
    Impact,
    /// The motion too, but what it says of the impacts is not to be stated.
    Flown(Box<Flown>),
    /// The quantities, beside their prediction.
    Measured(Box<Flown>, Measured),
}
