//! The commands of the laboratory: `synth` and `validate`.

pub mod campaign;
mod document;
pub mod synth;
mod trial;
pub mod validate;
