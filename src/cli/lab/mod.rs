//! The commands of the laboratory: `synth` and `validate`.

pub mod campaign;
mod document;
mod shards;
pub mod synth;
mod trial;
pub mod validate;
