//! Pure mathematics on slices and functions; it knows nothing of drops.

pub mod damped_modes;
pub mod filter;
pub mod free_beam;
pub mod linear_prediction;
pub mod noise;
pub mod pooled;
pub mod prior_fit;
pub mod projection;
pub mod quadrature;
pub mod reduce;
pub mod robust;
pub mod root;
pub mod sinusoid;
pub mod spectrum;

/// A count of samples or the like as a number; exact below 2^53.
#[must_use]
#[allow(clippy::cast_precision_loss, reason = "counts stay below 2^53")]
pub fn as_f64(count: usize) -> f64 {
    count as f64
}
