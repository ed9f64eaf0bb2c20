//! Pure mathematics on slices and functions, independent of drops.

pub mod damped_modes;
pub mod filter;
pub mod free_beam;
pub mod linear_prediction;
pub mod noise;
pub mod pooled;
pub mod prior_fit;
pub mod projection;
pub mod quadrature;
pub mod rating;
pub mod reduce;
pub mod robust;
pub mod root;
pub mod shock_response;
pub mod sinusoid;
pub mod spectrum;
#[cfg(feature = "lab")]
pub mod thick_beam;

/// A count of samples or the like as a number; exact below 2^53.
#[allow(clippy::cast_precision_loss, reason = "counts stay below 2^53")]
pub fn as_f64(count: usize) -> f64 {
    count as f64
}

/// Converts a number to a count: negative values and NaN to 0, values that are too large to the largest
/// count.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates so")]
pub fn as_count(number: f64) -> usize {
    number as usize
}

/// The least and the largest of some numbers; infinity and its negative if there are none.
pub fn extent(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| (least.min(x), most.max(x)))
}

/// A time in whole nanoseconds, as files stamp it.
#[allow(clippy::cast_possible_truncation, reason = "a cast from float saturates")]
pub fn nanoseconds(time_s: f64) -> i64 {
    (time_s * 1e9).round() as i64
}

/// Converts to single precision: seven digits, more than any recorder resolves, in half the bytes of
/// seventeen.
#[allow(clippy::cast_possible_truncation, reason = "the loss of digits is meant")]
pub fn to_f32(value: f64) -> f32 {
    value as f32
}
