//! The laboratory: scenes with a known truth, through everything, to how far off the analysis is and what other methods would do.
//!
//! It is no part of the product: it may use anything of it, and of the program only the command line uses it.

pub mod campaign;
pub mod data;
pub mod in_memory;
pub mod methods;
pub mod report;
pub mod scene_file;
pub mod synth;

use crate::data::{Cask, Contact, Drop, End};
use crate::ingest::IngestError;
use crate::lab::data::{CrushableEnd, Scene, SceneFile, SyntheticRecording, WantedImpact};
use std::path::Path;

/// Reads and checks a scene file for [`synthesise`].
///
/// # Errors
/// One diagnostic that shows the line.
pub fn scene_file(path: &Path) -> Result<SceneFile, IngestError> {
    Ok(scene_file::parse(path, &crush)?)
}

/// The stiffnesses of an end that give a wanted impact.
fn crush(cask: &Cask, drop: &Drop, contact: Contact, end: End, wanted: WantedImpact) -> CrushableEnd {
    let WantedImpact { duration_s, restitution, yield_share } = wanted;
    let pulse = synth::Pulse { duration_s, restitution, yield_share };
    synth::crushable_end(cask, drop, contact, end, pulse)
}

/// The recording of a scene by its sensors and recorder, and its truth. The same scene gives the same bits.
#[must_use]
pub fn synthesise(scene: &Scene) -> SyntheticRecording {
    synth::record(scene, &synth::simulate(scene))
}
