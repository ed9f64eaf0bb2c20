//! Conditioned channels to the times that matter: release, first contact, separation, slap-down.

mod answer;
mod locate;
mod onset;
mod release;

pub use answer::answers;
pub use locate::locate;
pub use onset::{first_contact, first_separation, separation, slap_down};
pub use release::{FreeFall, free_fall};

use crate::data::{Axis, End, Signal};

/// The transverse signal nearest to an end: what happens there shows on it first.
#[must_use]
pub fn transverse(signals: &[Signal], end: End) -> Option<&Signal> {
    let from_middle = |s: &Signal| if end == End::First { s.position_m } else { -s.position_m };
    signals
        .iter()
        .filter(|s| s.axis == Axis::Transverse && s.end == end)
        .min_by(|a, b| from_middle(a).total_cmp(&from_middle(b)))
}
