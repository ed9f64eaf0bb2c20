//! Words for numbers and for refusals of the operating system, for messages.

/// Rounds `number` to this many significant digits.
pub(crate) fn to_digits(number: f64, digits: i32) -> f64 {
    if number == 0.0 || !number.is_finite() {
        return number;
    }
    #[allow(clippy::cast_possible_truncation, reason = "the exponent of a finite f64 is below 400")]
    let places = digits - 1 - number.abs().log10().floor() as i32;
    // A division by a power of ten is correctly rounded, a product with its inverse is not.
    let unit = 10_f64.powi(places.abs());
    if places < 0 { (number / unit).round() * unit } else { (number * unit).round() / unit }
}

/// Formats a number in full; a number of a damaged file may have hundreds of digits, and gets an exponent.
pub(crate) fn show(number: f64) -> String {
    if number == 0.0 || (1e-6..1e12).contains(&number.abs()) {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
}

/// Formats a number with this many significant digits.
pub(crate) fn digits(number: f64, digits: i32) -> String {
    show(to_digits(number, digits))
}

/// Formats a rate in Hz, to a tenth of a part in a million.
pub(crate) fn hz(rate_hz: f64) -> String {
    digits(rate_hz, 7)
}

/// The operating system's words without its error number.
pub(crate) fn os_text(refusal: &std::io::Error) -> String {
    let text = refusal.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

/// Rounds off the last digits of a sum or a conversion, so that 3 · 0.1 is 0.3; a double holds two to four
/// more.
pub fn round_off(value: f64) -> f64 {
    format!("{value:.12e}").parse().unwrap_or(value)
}
