//! dropcheck: what accelerometers on both ends of a dropped cask say about its slap-down, and whether to believe it.
//!
//! A recording and a cask file pass through the stages in the order that `analysis` alone knows; every stage imports only [`data`] and
//! [`numerics`].

mod analysis;
pub mod compare;
pub mod condition;
pub mod data;
pub mod events;
pub mod fit;
pub mod ingest;
pub mod judge;
#[cfg(feature = "lab")]
pub mod lab;
pub mod motion;
pub mod numerics;
pub mod predict;
pub mod report;

pub use analysis::analyze;
