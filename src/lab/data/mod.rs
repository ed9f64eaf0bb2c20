//! The plain structs of the laboratory; they hold no algorithm.

mod campaign;
mod scene;
mod synthetic;
mod trial;

pub use campaign::*;
pub use scene::*;
pub use synthetic::*;
pub use trial::*;
