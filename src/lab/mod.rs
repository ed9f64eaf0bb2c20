//! The laboratory: scenes with a known truth, through everything, to how far off the analysis is and what
//! other methods would do.
//!
//! It is no part of the product: it may use anything of it, and of the program only the command line uses it.

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
