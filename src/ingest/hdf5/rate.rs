//! Attributes that state how often samples were taken to a rate.

use super::super::stated_rate::{self, Agreement, StatedRate};
use super::attributes::{Place, Value, value};
use super::dataset::Column;

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

/// What the attributes of one place state.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stated {
    /// The rate; where the first attribute is none, what it says instead.
    pub rate: Result<StatedRate, String>,
    /// Whether it is spelled as those listed, with one value, so that it says something even where that is no rate.
    pub is_sure: bool,
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

/// Hz a unit behind the name of a rate, without underscores.
const RATE_SUFFIXES: [(&str, f64); 4] = [("", 1.0), ("hz", 1.0), ("khz", 1e3), ("mhz", 1e6)];

/// Seconds a unit behind the name of an interval. No minutes: the end of `dt_min` says that it is the least.
const INTERVAL_SUFFIXES: [(&str, f64); 6] =
    [("", 1.0), ("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("µs", 1e-6), ("ns", 1e-9)];

/// What the name of an attribute says of its value.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Meaning {
    /// Whether it is spelled otherwise than those listed, which go before it.
    is_alike: bool,
    is_interval: bool,
    /// Which of those listed.
    place: usize,
    /// Hz or s a unit.
    scale: f64,
}

impl Meaning {
    /// Of a name as listed, or but for case, underscores and a unit behind it.
    fn of(name: &str) -> Option<Self> {
        let lists = [(&RATE_NAMES[..], &RATE_SUFFIXES[..]), (&INTERVAL_NAMES[..], &INTERVAL_SUFFIXES[..])];
        let found = |is_alike: bool, matches: &dyn Fn(&str, &str) -> bool| {
            lists.iter().zip([false, true]).find_map(|((names, suffixes), is_interval)| {
                let pairs = suffixes
                    .iter()
                    .flat_map(|suffix| names.iter().enumerate().map(move |name| (name, suffix)));
                let mut fitting = pairs.filter(|((_, listed), suffix)| matches(listed, suffix.0));
                fitting.next().map(|((place, _), suffix)| Self {
                    is_alike,
                    is_interval,
                    place,
                    scale: suffix.1,
                })
            })
        };
        let bare = plain(name);
        // FS is a full scale, DT a dead time and delta_T a temperature.
        let is_symbol = |listed: &str| ["fs", "dt", "deltat"].contains(&plain(listed).as_str());
        let is_low = name.ends_with(char::is_lowercase);
        found(false, &|listed, suffix| suffix.is_empty() && listed == name).or_else(|| {
            found(true, &|listed, suffix| {
                bare.strip_suffix(suffix) == Some(&plain(listed))
                    && (is_low || !suffix.is_empty() || !is_symbol(listed))
            })
        })
    }
}

fn plain(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, '_' | ' ' | '-')).flat_map(char::to_lowercase).collect()
}

/// Whether an attribute of this name may state a rate.
pub(super) fn is_named(name: &str) -> bool {
    Meaning::of(name).is_some()
}

/// The rate that the attributes of `place` state for a column.
pub(super) fn stated(place: &Place, column: &Column) -> Option<Stated> {
    let mut named: Vec<(Meaning, String)> =
        place.iter().filter_map(|(name, _)| Some((Meaning::of(name)?, name.clone()))).collect();
    let order = |(meaning, name): &(Meaning, String)| {
        (meaning.is_alike, meaning.is_interval, meaning.place, name.clone())
    };
    named.sort_by_key(order);
    let found = |(meaning, name): (Meaning, String)| {
        let hz = |number: f64| if meaning.is_interval { number.recip() } else { number };
        let (shown, rate_hz, is_known) = match value(place, &name, column) {
            Some(Value::Number(number)) => (number.to_string(), Some(hz(number * meaning.scale)), true),
            Some(Value::Text(text)) => {
                let number = if meaning.is_interval {
                    stated_rate::seconds(&text, meaning.scale)
                } else {
                    stated_rate::hz(&text, meaning.scale)
                };
                (format!("{text:?}"), number.map(hz), true)
            }
            None => ("a list of different values".to_owned(), None, false),
        };
        let rate_hz = rate_hz.filter(|rate_hz| rate_hz.is_finite() && *rate_hz > 0.0);
        (is_known && !meaning.is_alike, name, shown, rate_hz)
    };
    let mut all: Vec<_> = named.into_iter().map(found).collect();
    // What only looks like a rate is none where it says none.
    if all.iter().any(|(is_sure, .., rate_hz)| *is_sure || rate_hz.is_some()) {
        all.retain(|(is_sure, .., rate_hz)| *is_sure || rate_hz.is_some());
    }
    let mut all = all.into_iter();
    let (is_sure, name, shown, rate_hz) = all.next()?;
    let Some(rate_hz) = rate_hz else {
        let problem = format!(
            "nothing says when its samples were taken: the attribute {name} is {shown}, which is no rate or interval"
        );
        return Some(Stated { rate: Err(problem), is_sure, rival: None });
    };
    let rate = |name: &str, shown: &str, rate_hz: f64| StatedRate {
        place: format!("{name} = {shown}"),
        rate_hz,
        rounding: stated_rate::number_and_unit(shown.trim_matches('"'))
            .map_or(0.0, |found| stated_rate::rounding(found.0)),
    };
    let first = rate(&name, &shown, rate_hz);
    let others = all.filter_map(|(_, name, shown, rate_hz)| Some(rate(&name, &shown, rate_hz?)));
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
    Some(Stated { rate: Ok(first), is_sure: true, rival })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_told_in_other_spellings_and_with_units() {
        for (name, is_interval, scale) in [
            ("sample_rate_hz", false, 1.0_f64),
            ("Sample_Rate", false, 1.0),
            ("SAMPLE RATE", false, 1.0),
            ("sampleRate", false, 1.0),
            ("samplingRate_kHz", false, 1e3),
            ("fs_khz", false, 1e3),
            ("FS_Hz", false, 1.0),
            ("fs_MHz", false, 1e6),
            ("dt_us", true, 1e-6),
            ("dt_ns", true, 1e-9),
            ("Dt", true, 1.0),
            ("DT_ms", true, 1e-3),
            ("deltat", true, 1.0),
            ("wf_increment_s", true, 1.0),
        ] {
            let meaning = Meaning::of(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(
                (meaning.is_interval, meaning.scale.to_bits()),
                (is_interval, scale.to_bits()),
                "{name}"
            );
        }
        for name in ["FS", "DT", "delta_T", "dt_min", "rate", "fs_g", "sample_rate_divider", "offset"] {
            assert_eq!(Meaning::of(name), None, "{name}");
        }
    }
}
