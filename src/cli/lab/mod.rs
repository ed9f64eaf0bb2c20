//! The commands of the laboratory: `synth` and `validate`.

mod document;
mod machine;
mod peers;
mod progress;
pub mod synth;
mod trial;
pub mod validate;
