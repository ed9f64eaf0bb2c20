//! Simulates a scene: the motion of its cask, the readings of a sensor on the cask, and the samples that its
//! recorder writes.
//!
//! The motion follows from forces alone: a rigid body in the plane on two corners that crush. Nothing here
//! comes from the impact formulas of the analysis, so that each can check the other.

mod body;
mod chain;
mod contact;
mod crush;
mod elastic;
mod motion;
mod sensor;
mod truth;

pub use body::{MOST_LOOSE, bending_m_s2};
pub use chain::record;
pub use crush::crushable_end;
pub use motion::{simulate, simulate_one_flight};
pub use sensor::{rotation_rad_s, specific_force_m_s2};

#[cfg(test)]
mod example;
