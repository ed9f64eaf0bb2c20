//! What a recording says of a rate, as written there, to a number in Hz with its rounding.

use super::vocabulary::{Meaning, rate_unit_hz, time_unit_s};

/// A number of at least so many digits may be rounded; one of fewer is taken as it stands.
const ROUNDED_DIGITS: usize = 3;

/// Printed with at least so many decimals, as C and LabVIEW do unasked, a number may be rounded however few
/// digits it has.
const PRINTED_DECIMALS: i32 = 6;

/// A rate that something says.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Statement {
    /// What says it, for people: `Delta_X = 0.0001 s`.
    pub place: String,
    /// Samples a second, Hz.
    pub rate_hz: f64,
    /// How far it may be off for its last digit is rounded, as a part of itself.
    pub rounding: f64,
    /// How far from the samples it stands: 0 is said of them alone, such as the attribute of a dataset; 1 and
    /// more of all that a group or a file holds, which may have other rates.
    pub distance: usize,
}

impl Statement {
    /// `name = 50 kHz` or `name = 2e-5` of the samples alone; without a unit in so many Hz or s as `meaning`
    /// says. `None` where it is no rate above zero.
    pub(super) fn of(name: &str, text: &str, meaning: Meaning) -> Option<Self> {
        let (number, unit) = number_and_unit(text)?;
        let value: f64 = number.parse().ok()?;
        let rate_hz = match meaning {
            Meaning::Rate(unit_hz) => value * if unit.is_empty() { unit_hz } else { rate_unit_hz(unit)? },
            Meaning::Interval(unit_s) => {
                (value * if unit.is_empty() { unit_s } else { time_unit_s(unit)? }).recip()
            }
            Meaning::Count => return None,
        };
        (rate_hz.is_finite() && rate_hz > 0.0)
            .then(|| Self::by(format!("{name} = {text}"), rate_hz, rounding(number)))
    }

    /// A rate in Hz that `place` says of the samples alone, off by the part `rounding` of itself at most.
    pub(super) fn by(place: impl Into<String>, rate_hz: f64, rounding: f64) -> Self {
        Self { place: place.into(), rate_hz, rounding, distance: 0 }
    }

    /// The same, said of all that stands in a group or a file.
    pub(super) fn at(self, distance: usize) -> Self {
        Self { distance, ..self }
    }
}

/// Half a unit of the last digit of a number as a part of it; 0 where it is taken as it stands.
///
/// `0.000020` may be 19.5 µs, which is printed so; `0.00002` is no rounding of anything.
pub(super) fn rounding(number: &str) -> f64 {
    let number = number.trim().trim_start_matches(['-', '+']);
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let count = |text: &str| text.bytes().filter(u8::is_ascii_digit).count();
    let decimals = mantissa.split_once(['.', ',']).map_or(0, |(_, fraction)| count(fraction));
    let digits = count(mantissa.trim_start_matches(['0', '.', ',']));
    let (Ok(decimals), Ok(exponent)) = (i32::try_from(decimals), exponent.parse::<i32>()) else { return 0.0 };
    let is_printed = decimals >= PRINTED_DECIMALS && !number.contains(['e', 'E']);
    let Ok(value) = mantissa.replace(',', ".").parse::<f64>() else { return 0.0 };
    if value == 0.0 || exponent.abs() > 300 || (digits < ROUNDED_DIGITS && !is_printed) {
        return 0.0;
    }
    0.5 * 10_f64.powi(-decimals) / value
}

/// "50 kHz" to "50" and "kHz".
pub(super) fn number_and_unit(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    // The longest beginning that is a number: the e of an exponent is a letter too.
    let ends = text.char_indices().map(|(at, c)| at + c.len_utf8()).rev();
    ends.into_iter().find_map(|end| {
        let number = text[..end].trim_end();
        number.parse::<f64>().ok()?;
        Some((number, text[end..].trim()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_digit_of_a_number_may_be_rounded() {
        for (number, expected) in [
            ("0.000020", 0.025),
            ("0,000100", 0.005),
            ("1.95e-5", 0.5 / 195.0),
            ("51200", 0.5 / 51_200.0),
            ("0.0001", 0.0),
            ("5E-5", 0.0),
            ("0.0000", 0.0),
            ("words", 0.0),
            ("", 0.0),
        ] {
            assert!((rounding(number) - expected).abs() < 1e-12, "{number}: {}", rounding(number));
        }
    }

    #[test]
    fn rates_and_intervals_are_read_with_their_units() {
        let hz = |text, meaning| Statement::of("fs", text, meaning).map(|stated| stated.rate_hz);
        for (text, rate_hz) in [
            ("50000", 5e4),
            (" 50 kHz ", 5e4),
            ("50kS/s", 5e4),
            ("5e4Hz", 5e4),
            ("1 MHz", 1e6),
            ("100 1/s", 100.0),
        ] {
            assert_eq!(hz(text, Meaning::Rate(1.0)), Some(rate_hz), "{text}");
        }
        assert_eq!(hz("50", Meaning::Rate(1e3)), Some(5e4));
        for (text, interval_s) in [("2e-5", 2e-5), ("20 us", 20.0 * 1e-6), ("0.5ms", 0.5 * 1e-3)] {
            assert_eq!(hz(text, Meaning::Interval(1.0)), Some(1.0 / interval_s), "{text}");
        }
        for text in ["", "fast", "50 V", "Hz", "20 us", "0", "-5", "inf"] {
            assert_eq!(hz(text, Meaning::Rate(1.0)), None, "{text}");
        }
        assert_eq!(hz("50 kHz", Meaning::Interval(1.0)), None);
    }
}
