//! The commands of the laboratory: `synth` and `validate`.

mod document;
pub mod synth;
mod trial;
pub mod validate;
