//! The words by which recordings name times, rates, intervals and units to what they mean; the one list of
//! them.

/// Words that head times, without their unit, in lower case; `X_Value` is that of LabVIEW's files, `__time`
/// that of PlotJuggler's.
#[rustfmt::skip]
const TIMES: [&str; 41] = [
    "time", "__time", "t", "zeit", "times", "timestamp", "timestamps", "time stamp", "zeitstempel",
    "messzeit", "abtastzeit", "uhrzeit", "elapsed", "elapsed time", "relative time", "relative zeit",
    "rel. time", "rel. zeit", "datetime", "date/time", "date time", "x_value", "sec", "secs", "seconds", "ms",
    "msec", "us", "µs", "usec", "ns", "temps", "tempo", "tiempo",
    "micros", "millis", "tid", "tijd", "czas", "时间", "時間",
];

/// Names of the axis of a plot: times where a unit of time stands beside it, else one axis of an
/// accelerometer.
const AXES: [&str; 7] = ["source", "x", "x-achse", "x-axis", "x achse", "x axis", "x_axis"];

/// Names of a rate, in lower case without what parts their words: `Sample Rate` and `sample_rate` are
/// `samplerate`.
#[rustfmt::skip]
const RATES: [&str; 10] = [
    // `startingtimerate` is what NWB has beside the time of the first sample.
    "startingtimerate", "samplerate", "samplingrate", "samplingfrequency", "samplefrequency", "fs",
    "scanrate", "abtastrate", "abtastfrequenz", "samplingfrequenz",
];

/// Names of the interval between samples, as [`RATES`]; `wfincrement` is that of LabVIEW's waveforms.
#[rustfmt::skip]
const INTERVALS: [&str; 11] = [
    // `xinc` is Keysight's, with its unit beside it.
    "xinc", "hresolution", "dt", "deltat", "wfincrement", "sampleinterval", "samplinginterval",
    "sampleperiod", "samplingperiod", "abtastintervall", "abtastperiode",
];

/// Names of the number of samples, as [`RATES`]; LabVIEW writes `Samples`.
#[rustfmt::skip]
const COUNTS: [&str; 10] = [
    "samples", "numberofsamples", "no.ofsamples", "samplecount", "samplesperchannel", "recordlength",
    "numberofpoints", "anzahlwerte", "anzahlmesswerte", "anzahlabtastwerte",
];

/// Names of a column that counts the rows, as [`RATES`].
#[rustfmt::skip]
const COUNTERS: [&str; 12] = [
    "sample", "samples", "sampleno", "samplenr", "index", "idx", "n", "no", "nr", "#", "count", "counter",
];

/// Names of the sensor that a message or a row is of, as [`RATES`].
#[rustfmt::skip]
const SENSORS: [&str; 12] = [
    "frameid", "sensor", "sensorid", "sensorname", "sensornumber", "sensorno", "device", "deviceid",
    "devicename", "node", "nodeid", "serialnumber",
];

/// Names that say so of a row of a table; in messages they name much else.
#[rustfmt::skip]
const SENSORS_OF_ROWS: [&str; 14] = [
    "id", "name", "module", "moduleid", "channel", "channelid", "channelname", "location", "source", "topic",
    "mac", "kanal", "knoten", "messstelle",
];

/// First words of lines above a table that name its columns, or hold their units, in exports of oscilloscopes
/// and crash recorders.
const NAMES: [&str; 2] = ["tracename", "channelname"];
const UNITS: [&str; 5] = ["vunit", "unit", "units", "engineeringunit", "yunitlabel"];

/// First words of lines that sum up a table, as [`RATES`].
#[rustfmt::skip]
const SUMMARIES: [&str; 16] = [
    "sum", "summe", "total", "mean", "average", "mittelwert", "mittel", "min", "minimum", "max", "maximum",
    "std", "rms", "end", "ende", "eof",
];

/// Names that in capitals mean something else: FS is a full scale, DT a dead time, `delta_T` a temperature.
const SYMBOLS: [&str; 3] = ["fs", "dt", "deltat"];

/// Units of time, in lower case, with seconds a unit.
const TIME_UNITS: [(&[&str], f64); 7] = [
    (&["s", "sec", "secs", "second", "seconds", "sek", "sekunde", "sekunden"], 1.0),
    (&["ms", "msec", "msecs", "millis", "millisecond", "milliseconds", "millisekunden"], 1e-3),
    (
        &["us", "µs", "μs", "usec", "µsec", "μsec", "micros", "microsecond", "microseconds", "mikrosekunden"],
        1e-6,
    ),
    (
        &["ns", "nsec", "nsecs", "nanosec", "nanosecs", "nanos", "nanosecond", "nanoseconds", "nanosekunden"],
        1e-9,
    ),
    (&["min", "minute", "minutes", "minuten"], 60.0),
    (&["h", "hour", "hours", "std", "stunden"], 3600.0),
    (&["days", "tage"], 86_400.0),
];

/// Units of a rate, in lower case, with Hz a unit.
const RATE_UNITS: [(&[&str], f64); 3] = [
    (&["hz", "hertz", "s/s", "sa/s", "1/s", "sps", "samples/s", "samples/sec"], 1.0),
    (&["khz", "ks/s", "ksa/s", "ksps"], 1e3),
    (&["mhz", "ms/s", "msa/s", "msps"], 1e6),
];

/// Units of what else a recorder may hold, in lower case; those of accelerations are in
/// [`crate::data::acceleration_unit_m_s2`].
const OTHER_UNITS: [&str; 58] = [
    "v", "volt", "volts", "mv", "µv", "uv", "n", "kn", "lbf", "°c", "°c/10", "degc", "c", "°f", "k", "bar",
    "mbar", "pa", "hpa", "kpa", "mpa", "psi", "%", "-", "–", "1", "mm", "cm", "m", "km", "in", "ft", "m/s",
    "km/h", "mph", "rad/s", "deg/s", "°/s", "rpm", "deg", "°", "a", "ma", "µm/m", "um/m", "µε", "ue", "ut",
    "µt", "gauss", "kg", "nm", "rad", "counts", "count", "lsb", "digits", "pc/g",
];

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
    let is_symbol = SYMBOLS.contains(&bare.as_str()) && name.ends_with(char::is_uppercase);
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
    if RATES.contains(&bare) {
        Some(Meaning::Rate(1.0))
    } else if INTERVALS.contains(&bare) {
        Some(Meaning::Interval(1.0))
    } else {
        COUNTS.contains(&bare).then_some(Meaning::Count)
    }
}

/// Seconds a unit of time, whatever its case; `None` where the word names none.
///
/// What the CF conventions of netCDF write behind it, "since 1970-01-01", says only where the times begin.
pub(super) fn time_unit_s(unit: &str) -> Option<f64> {
    let unit = unit.split_once(" since ").map_or(unit, |(unit, _)| unit);
    of_list(&TIME_UNITS, unit)
}

/// Hz a unit of rate, whatever its case; `None` where the word names none.
pub(super) fn rate_unit_hz(unit: &str) -> Option<f64> {
    of_list(&RATE_UNITS, unit)
}

fn of_list(units: &[(&[&str], f64)], unit: &str) -> Option<f64> {
    let unit = unit.trim().to_lowercase();
    units.iter().find(|(names, _)| names.contains(&unit.as_str())).map(|unit| unit.1)
}

/// Whether a word is a unit that a row of units may hold; brackets around it do not count.
pub(super) fn is_unit(word: &str) -> bool {
    let bare = word.trim().trim_matches(['[', ']', '(', ')', '"']).trim();
    crate::data::acceleration_unit_m_s2(bare).is_some()
        || time_unit_s(bare).is_some()
        || rate_unit_hz(bare).is_some()
        || OTHER_UNITS.contains(&bare.to_lowercase().as_str())
}

/// Whether a name without its unit is one of times.
pub(super) fn is_time(bare: &str) -> bool {
    TIMES.contains(&bare.to_lowercase().as_str())
}

/// Whether a name is one of times, with a unit or without; a unit alone is none.
pub(super) fn is_named_time(name: &str) -> bool {
    is_time(split(name).0) && time_unit_s(name).is_none()
}

/// Whether a field or column of that name says which sensor its message or row is of.
pub(super) fn is_sensor(name: &str) -> bool {
    SENSORS.contains(&joined(name).as_str())
}

/// Whether a column of that name says which sensor its row is of: `Kanal`, `field.header.frame_id`.
pub(super) fn is_sensor_of_rows(name: &str) -> bool {
    is_sensor(name) || SENSORS_OF_ROWS.contains(&joined(name).as_str()) || joined(name).ends_with("frameid")
}

/// Whether a name without its unit is one of a sensor's own times in a message of ROS: `field.header.stamp`.
pub(super) fn is_stamp(bare: &str) -> bool {
    bare.replace(['/', '_'], ".").ends_with("header.stamp")
}

/// Whether a line that begins so names the columns of a table.
pub(super) fn titles_names(cell: &str) -> bool {
    NAMES.contains(&joined(cell).as_str())
}

/// Whether a line that begins so holds the units of the columns of a table.
pub(super) fn titles_units(cell: &str) -> bool {
    UNITS.contains(&joined(cell).as_str())
}

/// Whether a line that begins so sums up a table.
pub(super) fn is_summary(cell: &str) -> bool {
    SUMMARIES.contains(&joined(cell).trim_end_matches(':'))
}

/// Whether a column of that name counts the rows.
pub(super) fn is_counter(name: &str) -> bool {
    COUNTERS.contains(&joined(name).as_str())
}

/// Whether a column of that name may count messages or toggle with each, as the buses of vehicles do: few
/// numbers that return are no ids then.
pub(super) fn may_count(name: &str) -> bool {
    const PARTS: &str = "count cnt alive seq frame toggle parity cycle phase heartbeat zähl zaehl pkt packet \
                         record";
    let name = joined(name);
    is_counter(&name) || (has_part(PARTS, &name) && !is_sensor_of_rows(&name))
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
    AXES.contains(&bare.to_lowercase().as_str())
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
