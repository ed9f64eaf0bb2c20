//! Pure mathematics on slices and functions; it knows nothing of drops.

pub mod damped_modes;
pub mod filter;
pub mod integration;
pub mod noise;
pub mod prior_fit;
pub mod projection;
pub mod quadrature;
pub mod reduce;
pub mod robust;
pub mod root;
pub mod sinusoid;
pub mod spectrum;
