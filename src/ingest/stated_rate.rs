//! A rate that a recording states, against others, to whether they are one.

use super::time_base::{RATE_TOLERANCE, short, to_digits};

/// Rates further apart than this are no two clocks: one of the statements is wrong, and nothing tells which.
const FAR: f64 = 1e-2;

/// A number of at least so many digits may be rounded; one of fewer is taken as it stands.
const ROUNDED_DIGITS: usize = 3;

/// Printed with at least so many decimals, as C and LabVIEW do unasked, a number may be rounded however few digits it has.
const PRINTED_DECIMALS: i32 = 6;

/// A rate as a recording states it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StatedRate {
    /// Where and how, for people: `Delta_X = 0.0001 s`.
    pub place: String,
    /// Samples a second, Hz.
    pub rate_hz: f64,
    /// How far it may be off for its last digit is rounded, as a part of itself.
    pub rounding: f64,
}

/// How a stated rate and another get along.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Agreement {
    /// Within rounding and what clocks are apart.
    Same,
    /// By more than that.
    Apart,
    /// By more than 1 %.
    FarApart,
}

impl StatedRate {
    /// How it agrees with a rate in Hz that may itself be off by a part of `rounding`.
    pub(super) fn agreement(&self, rate_hz: f64, rounding: f64) -> Agreement {
        let apart = (self.rate_hz / rate_hz - 1.0).abs();
        let explained = self.rounding + rounding;
        if apart <= RATE_TOLERANCE.max(explained) {
            Agreement::Same
        } else if apart <= FAR.max(explained) {
            Agreement::Apart
        } else {
            Agreement::FarApart
        }
    }

    /// It with its rate, for people.
    pub(super) fn shown(&self) -> String {
        format!("{}, which is {} Hz", self.place, shown_hz(self.rate_hz))
    }
}

/// A rate for people, as it can be written into a cask file.
pub(super) fn shown_hz(rate_hz: f64) -> String {
    short(to_digits(rate_hz, 7))
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
    fn rates_are_the_same_within_clocks_and_rounding() {
        let stated = |rounding| StatedRate { place: "fs = 10 kHz".into(), rate_hz: 1e4, rounding };
        for (rate_hz, rounding, expected) in [
            (10_009.0, 0.0, Agreement::Same),
            (10_050.0, 0.0, Agreement::Apart),
            (10_050.0, 6e-3, Agreement::Same),
            (9_500.0, 0.0, Agreement::FarApart),
            (9_500.0, 0.03, Agreement::FarApart),
            (9_800.0, 0.03, Agreement::Same),
        ] {
            assert_eq!(stated(rounding).agreement(rate_hz, 0.0), expected, "{rate_hz} {rounding}");
        }
        assert_eq!(stated(0.0).agreement(9_990.0 / 1.02, 0.02), Agreement::FarApart);
        assert_eq!(stated(0.0).shown(), "fs = 10 kHz, which is 10000 Hz");
    }
}
