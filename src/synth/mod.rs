//! A scene to the motion of its cask, and that motion to what a perfect sensor on the cask reads.
//!
//! The motion comes from forces alone: a rigid body in the plane on two corners that crush. Nothing here is taken from
//! the impact formulas of the analysis, so that either can be held against the other.

mod beam;
mod body;
mod contact;
mod crush;
mod motion;
mod sensor;
mod truth;

pub use beam::MOST_MODES;
pub use crush::{Pulse, crushable_end};
pub use motion::simulate;
pub use sensor::specific_force_m_s2;

#[cfg(test)]
mod example;
