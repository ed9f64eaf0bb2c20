//! Attributes that state how often samples were taken to a rate.

use super::super::stated_rate::{self, Agreement, StatedRate};
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

/// What the attributes of one place state.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stated {
    /// The rate; where the first attribute is none, what it says instead.
    pub rate: Result<StatedRate, String>,
    /// Another attribute there that states another rate.
    pub rival: Option<Rival>,
}

/// Two attributes that contradict each other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rival {
    /// Both, in words.
    pub problem: String,
    /// Which rates to choose from.
    pub mend: String,
    /// Whether they are apart by more than 1 %.
    pub is_far: bool,
}

/// The rate that the attributes of `place` state for a column.
pub(super) fn stated(place: &Location, column: &Column) -> Option<Stated> {
    let found = |name: &'static str, hz_of: fn(&str) -> Option<f64>, hz: fn(f64) -> f64| {
        let (shown, rate_hz) = match value(place, name, column)? {
            Value::Number(number) => (number.to_string(), Some(hz(number))),
            Value::Text(text) => (format!("{text:?}"), hz_of(&text)),
        };
        Some((name, shown, rate_hz.filter(|rate_hz| rate_hz.is_finite() && *rate_hz > 0.0)))
    };
    let rates = RATE_NAMES.iter().filter_map(|name| found(name, of_text, |hz| hz));
    let of_interval = |text: &str| seconds(text).map(f64::recip);
    let mut all = rates.chain(INTERVAL_NAMES.iter().filter_map(|name| found(name, of_interval, f64::recip)));
    let (name, shown, rate_hz) = all.next()?;
    let Some(rate_hz) = rate_hz else {
        let problem = format!(
            "nothing says when its samples were taken: the attribute {name} is {shown}, which is no rate or interval"
        );
        return Some(Stated { rate: Err(problem), rival: None });
    };
    let rate = |name: &str, shown: &str, rate_hz: f64| StatedRate {
        place: format!("{name} = {shown}"),
        rate_hz,
        rounding: number_and_unit(shown.trim_matches('"'))
            .map_or(0.0, |found| stated_rate::rounding(found.0)),
    };
    let first = rate(name, &shown, rate_hz);
    let others = all.filter_map(|(name, shown, rate_hz)| Some(rate(name, &shown, rate_hz?)));
    let apart = others.map(|other| (first.agreement(other.rate_hz, other.rounding), other));
    let rival = apart.filter(|(agreement, _)| *agreement != Agreement::Same).max_by_key(|(a, _)| *a);
    let rival = rival.map(|(agreement, other)| Rival {
        problem: format!(
            "the attributes {} and {} contradict each other: one of the two is wrong, and every velocity goes with the rate",
            first.shown(),
            other.shown()
        ),
        mend: mend(&first, &other),
        is_far: agreement == Agreement::FarApart,
    });
    Some(Stated { rate: Ok(first), rival })
}

impl Stated {
    /// That the group at `path`, farther off, states another rate; the nearer one goes before it, however far they are apart.
    pub(super) fn rival_of(&self, outer: &Self, path: &str) -> Option<Rival> {
        let (Ok(near), Ok(far)) = (&self.rate, &outer.rate) else { return None };
        (near.agreement(far.rate_hz, far.rounding) != Agreement::Same).then(|| Rival {
            problem: format!(
                "the group {path} states {}; nearer to the samples stands {}, which was taken: one of the two is wrong, or the group's is for other datasets",
                far.shown(),
                near.shown()
            ),
            mend: mend(near, far),
            is_far: false,
        })
    }
}

fn mend(one: &StatedRate, other: &StatedRate) -> String {
    format!(
        "write the right one into this channel of the cask file: sample_rate_hz = {} or sample_rate_hz = {}",
        stated_rate::shown_hz(one.rate_hz),
        stated_rate::shown_hz(other.rate_hz)
    )
}

/// "50000", "50 kHz" or "50kS/s" to Hz.
fn of_text(text: &str) -> Option<f64> {
    let (number, unit) = parsed(text)?;
    let scale = UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(unit)).map(|unit| unit.1);
    scale.or_else(|| unit.is_empty().then_some(1.0)).map(|scale| number * scale)
}

/// "2e-5" or "20 us" to s.
fn seconds(text: &str) -> Option<f64> {
    let (number, unit) = parsed(text)?;
    time_unit::seconds(unit).or_else(|| unit.is_empty().then_some(1.0)).map(|scale| number * scale)
}

fn parsed(text: &str) -> Option<(f64, &str)> {
    let (number, unit) = number_and_unit(text)?;
    Some((number.parse().ok()?, unit))
}

/// "50 kHz" to "50" and "kHz".
fn number_and_unit(text: &str) -> Option<(&str, &str)> {
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
