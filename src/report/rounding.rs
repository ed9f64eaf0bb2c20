//! Formats numbers with the digits that their uncertainty justifies.

use crate::data::Estimate;

/// Shown for a quantity that is not determined.
pub(super) const MISSING: &str = "–";

/// Significant digits of a half-width, and so of the value beside it: two (JCGM 100:2008, 7.2.6).
const INTERVAL_DIGITS: usize = 2;

/// Digits of a value whose interval is unknown or zero.
const BARE_DIGITS: usize = 4;

/// Formats "23.90 ± 0.31 m/s", or the dash of a missing quantity. Seconds are shown in ms.
pub(super) fn interval(estimate: Option<&Estimate>) -> String {
    let Some(estimate) = estimate.filter(|e| e.value.is_finite()) else { return MISSING.to_owned() };
    let (factor, unit) = match estimate.unit {
        "s" => (1e3, "ms"),
        "deg" => (1.0, "°"),
        "1" => (1.0, ""),
        unit => (1.0, unit),
    };
    let (value, u95) = (estimate.value * factor, estimate.u95 * factor);
    let text = if u95.is_finite() && u95 > 0.0 {
        let decimals = count_decimals(u95, INTERVAL_DIGITS);
        format!("{} ± {} {unit}", fixed(value, decimals), fixed(u95, decimals))
    } else {
        let u95 = if u95.is_finite() { "0" } else { "unknown" };
        format!("{} ± {u95} {unit}", significant(value, BARE_DIGITS))
    };
    text.trim_end().to_owned()
}

/// Formats `value ± u95 unit` for a pair without an [`Estimate`].
pub(super) fn pair(value: f64, u95: f64, unit: &'static str) -> String {
    interval(Some(&Estimate::new(value, u95, unit)))
}

/// Formats `value` with `digits` significant digits, no exponent within 1e-4 to 1e7.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) {
        return format!("{value:.*e}", digits.saturating_sub(1)).replace('-', "−");
    }
    fixed(value, count_decimals(value, digits))
}

/// Formats `value` with `digits` significant digits and without the zeros at its end: for settings and sizes.
pub(crate) fn plain(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    if text.contains('.') && !text.contains('e') {
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    text
}

/// Formats an optional number with `digits` significant digits, or the dash.
pub(crate) fn optional(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| MISSING.to_owned(), |value| significant(value, digits))
}

/// Formats an optional number with fixed decimals, or the dash.
pub(crate) fn optional_fixed(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| MISSING.to_owned(), |value| fixed(value, decimals))
}

/// "+1.7 %", with the sign always, or the dash.
pub(super) fn percent(value: impl Into<Option<f64>>) -> String {
    match optional_fixed(value.into(), 1) {
        text if text == MISSING => text,
        text if text.starts_with('−') || text == "0.0" => format!("{text} %"),
        text => format!("+{text} %"),
    }
}

/// Formats `value` with `decimals`, a true minus sign, and no minus before a zero; or the dash.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| b == b'0' || b == b'.') => digits.to_owned(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// Number of decimals that show `digits` significant digits of `value` after it is rounded to them.
fn count_decimals(value: f64, digits: usize) -> usize {
    // The exponent is read from the rounded text, so that 0.0996 counts as 0.10.
    let text = format!("{:.*e}", digits.saturating_sub(1), value.abs());
    let exponent: i32 = text.split('e').nth(1).and_then(|e| e.parse().ok()).unwrap_or(0);
    let wanted = i32::try_from(digits).unwrap_or(i32::MAX) - 1 - exponent;
    usize::try_from(wanted.clamp(0, 12)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_sets_the_digits() {
        let cases = [
            (23.904, 0.312, "m/s", "23.90 ± 0.31 m/s"),
            (23.904, 0.0996, "m/s", "23.90 ± 0.10 m/s"),
            (0.5588, 0.012, "1", "0.559 ± 0.012"),
            (0.071_055, 0.000_012, "s", "71.055 ± 0.012 ms"),
            (-5.04, 1.4, "deg", "−5.0 ± 1.4 °"),
            (1234.5, 150.0, "m/s", "1234 ± 150 m/s"),
            (-0.001, 0.3, "m/s", "0.00 ± 0.30 m/s"),
            (13.288_34, 0.0, "m/s", "13.29 ± 0 m/s"),
            (13.288_34, f64::NAN, "m/s", "13.29 ± unknown m/s"),
            (f64::NAN, 0.1, "m/s", "–"),
        ];
        for (value, u95, unit, text) in cases {
            assert_eq!(pair(value, u95, unit), text);
        }
        assert_eq!(interval(None), "–");
    }

    #[test]
    fn bare_numbers_keep_their_significant_digits() {
        assert_eq!(significant(0.0, 4), "0.000");
        assert_eq!(significant(298.65, 3), "299");
        assert_eq!(significant(1.0e-7, 2), "1.0e−7");
        assert_eq!(plain(9.0, 4), "9");
        assert_eq!(plain(100_000.0, 6), "100000");
        assert_eq!(plain(0.792, 6), "0.792");
    }

    #[test]
    fn a_percentage_carries_its_sign() {
        assert_eq!(percent(1.71), "+1.7 %");
        assert_eq!(percent(-3.0), "−3.0 %");
        assert_eq!(percent(-0.01), "0.0 %");
    }
}
