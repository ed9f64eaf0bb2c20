//! The words by which recordings name times, rates, intervals and units to what they mean; the one list of
//! them.

/// Lists of words, a kind each; several lines of a kind are one list.
const WORDS: &str = include_str!("vocabulary.txt");

/// The words of every list whose kind begins so, with what stands behind that.
fn lists(kind: &str) -> impl Iterator<Item = (&'static str, &'static str)> {
    WORDS.lines().filter_map(move |line| line.strip_prefix(kind)?.split_once(": "))
}

/// Whether a list holds the word.
pub(super) fn has_word(kind: &str, word: &str) -> bool {
    lists(kind).any(|(rest, words)| rest.is_empty() && words.split(", ").any(|known| known == word))
}

/// Whether a name holds one of the parts of a list.
pub(super) fn has_listed_part(kind: &str, name: &str) -> bool {
    lists(kind).any(|(_, words)| words.split(", ").any(|part| name.contains(part)))
}

/// What the name of an attribute, a field or a line above a table says of its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Meaning {
    /// A rate; Hz a unit.
    Rate(f64),
    /// An interval between samples; seconds a unit.
    Interval(f64),
    /// A number of samples.
    Count,
}

/// The meaning of a name, whatever its case and what parts its words; a unit may stand behind it: `Sample
/// Rate kHz`, `dt_us`.
pub(super) fn meaning(name: &str) -> Option<Meaning> {
    let parted: Vec<&str> = name.split(['_', ' ', '-']).filter(|word| !word.is_empty()).collect();
    let bare = parted.concat().to_lowercase();
    let is_symbol = has_word("symbol", &bare) && name.ends_with(char::is_uppercase);
    if let Some(meaning) = plain_meaning(&bare).filter(|_| !is_symbol) {
        return Some(meaning);
    }
    // `fsHz` and `sampleRateHz` part the unit by its capital alone.
    let (rest, unit) = match parted[..] {
        [ref rest @ .., unit] if !rest.is_empty() => (rest.concat().to_lowercase(), unit.to_owned()),
        _ => {
            let at = name.char_indices().rev().find(|(_, c)| c.is_uppercase())?.0;
            (name[..at].to_lowercase(), name[at..].to_owned())
        }
    };
    match plain_meaning(&rest)? {
        Meaning::Rate(_) => rate_unit_hz(&unit).map(Meaning::Rate),
        // `dt_min` is the least interval, not one in minutes.
        Meaning::Interval(_) => time_unit_s(&unit).filter(|unit_s| *unit_s <= 1.0).map(Meaning::Interval),
        Meaning::Count => None,
    }
}

fn plain_meaning(bare: &str) -> Option<Meaning> {
    if has_word("rate", bare) {
        Some(Meaning::Rate(1.0))
    } else if has_word("interval", bare) {
        Some(Meaning::Interval(1.0))
    } else {
        has_word("count", bare).then_some(Meaning::Count)
    }
}

/// Seconds a unit of time, whatever its case; `None` where the word names none.
///
/// What the CF conventions of netCDF write behind it, "since 1970-01-01", says only where the times begin.
pub(super) fn time_unit_s(unit: &str) -> Option<f64> {
    let unit = unit.split_once(" since ").map_or(unit, |(unit, _)| unit);
    of_list("time unit ", unit)
}

/// Hz a unit of rate, whatever its case; `None` where the word names none.
pub(super) fn rate_unit_hz(unit: &str) -> Option<f64> {
    of_list("rate unit ", unit)
}

fn of_list(kind: &str, unit: &str) -> Option<f64> {
    let unit = unit.trim().to_lowercase();
    let found = lists(kind).find(|(_, words)| words.split(", ").any(|known| known == unit));
    found.and_then(|(size, _)| size.parse().ok())
}

/// Whether a word is a unit that a row of units may hold; brackets around it do not count.
pub(super) fn is_unit(word: &str) -> bool {
    let bare = word.trim().trim_matches(['[', ']', '(', ')', '"']).trim();
    crate::data::acceleration_unit_m_s2(bare).is_some()
        || time_unit_s(bare).is_some()
        || rate_unit_hz(bare).is_some()
        || has_word("other unit", &bare.to_lowercase())
}

/// Whether a name without its unit is one of times.
pub(super) fn is_time(bare: &str) -> bool {
    has_word("time", &bare.to_lowercase())
}

/// Whether a name is one of times, with a unit or without; a unit alone is none.
pub(super) fn is_named_time(name: &str) -> bool {
    is_time(split(name).0) && time_unit_s(name).is_none()
}

/// Whether a field or column of that name says which sensor its message or row is of.
pub(super) fn is_sensor(name: &str) -> bool {
    has_word("sensor", &joined(name))
}

/// Whether a column of that name says which sensor its row is of: `Kanal`, `field.header.frame_id`.
pub(super) fn is_sensor_of_rows(name: &str) -> bool {
    is_sensor(name) || has_word("sensor of rows", &joined(name)) || joined(name).ends_with("frameid")
}

/// Whether a name without its unit is one of a sensor's own times in a message of ROS: `field.header.stamp`.
pub(super) fn is_stamp(bare: &str) -> bool {
    bare.replace(['/', '_'], ".").ends_with("header.stamp")
}

/// Whether a line that begins so names the columns of a table.
pub(super) fn titles_names(cell: &str) -> bool {
    has_word("names", &joined(cell))
}

/// Whether a line that begins so holds the units of the columns of a table.
pub(super) fn titles_units(cell: &str) -> bool {
    has_word("units", &joined(cell))
}

/// Whether a line that begins so sums up a table.
pub(super) fn is_summary(cell: &str) -> bool {
    has_word("summary", joined(cell).trim_end_matches(':'))
}

/// Whether a column of that name counts the rows.
pub(super) fn is_counter(name: &str) -> bool {
    has_word("counter", &joined(name))
}

/// Whether a column of that name may count messages or toggle with each, as the buses of vehicles do: few
/// numbers that return are no ids then.
pub(super) fn may_count(name: &str) -> bool {
    let name = joined(name);
    is_counter(&name) || (has_listed_part("may count", &name) && !is_sensor_of_rows(&name))
}

/// Whether a name holds one of these parts.
pub(super) fn has_part(parts: &str, name: &str) -> bool {
    parts.split_whitespace().any(|part| name.contains(part))
}

/// A name in lower case without what parts its words.
pub(super) fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

fn joined(name: &str) -> String {
    name.trim().to_lowercase().replace([' ', '_', '-', '.'], "")
}

/// Whether a name without its unit is one of an axis.
pub(super) fn is_axis(bare: &str) -> bool {
    has_word("axis", &bare.to_lowercase())
}

/// `time_ms`, `TimeMs`, `Zeit in ms` or `t/ms` to its name and `ms`.
pub(super) fn split(name: &str) -> (&str, Option<&str>) {
    let name = name.trim();
    let is_unit = |text: &str| time_unit_s(text).is_some();
    if let Some((bare, unit)) = name.rsplit_once(['_', ' ', '/', '-', '.', ',', ':'])
        && is_unit(unit)
    {
        return (without_in(bare), Some(unit));
    }
    let is_hump = |pair: &(char, char)| pair.0.is_lowercase() && pair.1.is_uppercase();
    let pairs = name.chars().zip(name.chars().skip(1));
    if let Some(last) = pairs.enumerate().filter(|(_, pair)| is_hump(pair)).map(|(i, _)| i).last()
        && let Some((at, _)) = name.char_indices().nth(last + 1)
        && is_unit(&name[at..])
    {
        return (without_in(&name[..at]), Some(&name[at..]));
    }
    (name, is_unit(name).then_some(name))
}

/// "Zeit in" and "time /" to the name.
fn without_in(name: &str) -> &str {
    let name = name.trim_end_matches(['_', ' ', '/', '-', '.', ',', ':']);
    let bare = [" in", "_in", "In"].iter().find_map(|word| name.strip_suffix(word));
    bare.unwrap_or(name).trim_end()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_rates_and_intervals_are_known_with_their_units() {
        for (name, meaning_of_it) in [
            ("sample_rate_hz", Meaning::Rate(1.0)),
            ("sampleRateHz", Meaning::Rate(1.0)),
            ("SampleRate", Meaning::Rate(1.0)),
            ("Sampling Rate", Meaning::Rate(1.0)),
            ("fs", Meaning::Rate(1.0)),
            ("Fs", Meaning::Rate(1.0)),
            ("fs_khz", Meaning::Rate(1e3)),
            ("FS_Hz", Meaning::Rate(1.0)),
            ("Abtastrate", Meaning::Rate(1.0)),
            ("dt", Meaning::Interval(1.0)),
            ("dt_us", Meaning::Interval(1e-6)),
            ("wf_increment", Meaning::Interval(1.0)),
            ("Number of samples", Meaning::Count),
        ] {
            assert_eq!(meaning(name), Some(meaning_of_it), "{name}");
        }
        for name in ["FS", "DT", "delta_T", "dt_min", "rate", "fsx", "samples_s", "", "_", "f", "Hz"] {
            assert_eq!(meaning(name), None, "{name}");
        }
    }

    #[test]
    fn words_of_units_are_known_whatever_their_case_and_brackets() {
        for word in ["g", "[m/s²]", "(ms)", "V", "kHz", "°C", "-", "\"mV\"", "Sekunden"] {
            assert!(is_unit(word), "{word}");
        }
        for word in ["A1", "3.5", "", "furlong", "Kanal 1"] {
            assert!(!is_unit(word), "{word}");
        }
        assert_eq!(time_unit_s("milliseconds since 2026-11-01"), Some(1e-3));
    }
}
