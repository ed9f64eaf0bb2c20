//! Commands of the laboratory: `synth` and `validate`.

pub mod campaign;
pub mod synth;
mod trial;
pub mod validate;
