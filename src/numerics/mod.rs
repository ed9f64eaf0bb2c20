//! Pure mathematics on slices and functions; it knows nothing of drops.

pub mod quadrature;
pub mod root;
