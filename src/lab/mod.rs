//! The laboratory: scenes with a known truth go through the whole program, to measure its errors and those of
//! other methods.
//!
//! It does not belong to the product: it may use any part of it, and only the command line uses the
//! laboratory.

pub mod campaign;
mod chance;
mod damage;
pub mod data;
mod drawn;
mod envelope;
pub mod in_memory;
pub mod methods;
pub mod report;
pub mod scene_file;
pub mod synth;

use crate::lab::data::{Scene, SyntheticRecording};

/// The recording of a scene by its sensors and recorder, and its truth. The same scene gives the same bits.
pub fn synthesise(scene: &Scene) -> SyntheticRecording {
    synth::record(scene, &synth::simulate(scene))
}
