//! Attributes that state how often samples were taken to a rate.

use super::super::time_unit;
use super::attributes::{Value, value};
use super::dataset::Column;
use hdf5_metno::Location;

/// Attributes that hold a rate, Hz.
const RATE_NAMES: [&str; 11] = [
    "sample_rate_hz",
    "sample_rate",
    "fs",
    "sampling_rate_hz",
    "sampling_rate",
    "sampling_frequency",
    "sample_frequency",
    "SampleRate",
    "SamplingRate",
    "Fs",
    "fs_hz",
];

/// Attributes that hold the interval between samples, s; `wf_increment` is that of LabVIEW's waveforms.
const INTERVAL_NAMES: [&str; 5] = ["dt", "wf_increment", "sample_interval", "sampling_interval", "delta_t"];

/// Hz a unit of rate.
const UNITS: [(&str, f64); 13] = [
    ("hz", 1.0),
    ("khz", 1e3),
    ("mhz", 1e6),
    ("s/s", 1.0),
    ("ks/s", 1e3),
    ("ms/s", 1e6),
    ("sa/s", 1.0),
    ("ksa/s", 1e3),
    ("msa/s", 1e6),
    ("1/s", 1.0),
    ("sps", 1.0),
    ("ksps", 1e3),
    ("samples/s", 1.0),
];

/// The rate that the attributes of `place` state for a column, Hz; where one is no rate, what it says instead.
pub(super) fn stated(place: &Location, column: &Column) -> Option<Result<f64, String>> {
    let found = |names: &[&'static str], of: fn(&str) -> Option<f64>| {
        names.iter().find_map(|name| {
            Some(match value(place, name, column)? {
                Value::Number(number) => (*name, number.to_string(), Some(number)),
                Value::Text(text) => (*name, format!("{text:?}"), of(&text)),
            })
        })
    };
    let rate = found(&RATE_NAMES, of_text);
    let rate = rate.or_else(|| {
        let (name, shown, interval_s) = found(&INTERVAL_NAMES, seconds)?;
        Some((name, shown, interval_s.map(f64::recip)))
    });
    let (name, shown, rate_hz) = rate?;
    let rate_hz = rate_hz.filter(|rate_hz| rate_hz.is_finite() && *rate_hz > 0.0);
    Some(rate_hz.ok_or_else(|| {
        format!("nothing says when its samples were taken: the attribute {name} is {shown}, which is no rate or interval")
    }))
}

/// "50000", "50 kHz" or "50kS/s" to Hz.
fn of_text(text: &str) -> Option<f64> {
    let (number, unit) = number_and_unit(text)?;
    let scale = UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(unit)).map(|unit| unit.1);
    scale.or_else(|| unit.is_empty().then_some(1.0)).map(|scale| number * scale)
}

/// "2e-5" or "20 us" to s.
fn seconds(text: &str) -> Option<f64> {
    let (number, unit) = number_and_unit(text)?;
    time_unit::seconds(unit).or_else(|| unit.is_empty().then_some(1.0)).map(|scale| number * scale)
}

fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    // The longest beginning that is a number: the e of an exponent is a letter too.
    let ends = text.char_indices().map(|(at, c)| at + c.len_utf8()).rev();
    ends.into_iter().find_map(|end| {
        let number: f64 = text[..end].trim_end().parse().ok()?;
        Some((number, text[end..].trim()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_intervals_are_read_with_their_units() {
        for (text, rate_hz) in [
            ("50000", 5e4),
            (" 50 kHz ", 5e4),
            ("50kS/s", 5e4),
            ("5e4Hz", 5e4),
            ("1 MHz", 1e6),
            ("100 1/s", 100.0),
        ] {
            assert_eq!(of_text(text), Some(rate_hz), "{text}");
        }
        for (text, interval_s) in [("2e-5", 2e-5), ("20 us", 20.0 * 1e-6), ("0.5ms", 0.5 * 1e-3)] {
            assert_eq!(seconds(text), Some(interval_s), "{text}");
        }
        for text in ["", "fast", "50 V", "Hz", "20 us"] {
            assert_eq!(of_text(text), None, "{text}");
        }
        assert_eq!(seconds("50 kHz"), None);
    }
}
