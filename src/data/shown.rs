//! Numbers and refusals of the operating system to words for messages.

/// `number` rounded to so many significant digits.
pub(crate) fn to_digits(number: f64, digits: i32) -> f64 {
    if number == 0.0 || !number.is_finite() {
        return number;
    }
    #[allow(clippy::cast_possible_truncation, reason = "the exponent of a finite f64 is below 400")]
    let places = digits - 1 - number.abs().log10().floor() as i32;
    // A division by a power of ten is rounded right where a product with its inverse is not.
    let unit = 10_f64.powi(places.abs());
    if places < 0 { (number / unit).round() * unit } else { (number * unit).round() / unit }
}

/// A number as it is; a number of a damaged file may have hundreds of digits, and stands with an exponent.
pub(crate) fn short(number: f64) -> String {
    if number == 0.0 || (1e-6..1e12).contains(&number.abs()) {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
}

/// A number with so many significant digits.
pub(crate) fn digits(number: f64, digits: i32) -> String {
    short(to_digits(number, digits))
}

/// A rate in Hz, to a tenth of a part in a million.
pub(crate) fn hz(rate_hz: f64) -> String {
    digits(rate_hz, 7)
}

/// The operating system's words without its error number.
pub(crate) fn bare(refusal: &std::io::Error) -> String {
    let text = refusal.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

/// Free of the last digits of a sum or a conversion, so that 3 · 0.1 is 0.3; a double holds two to four more.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.12e}").parse().unwrap_or(value)
}
