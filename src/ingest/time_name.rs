//! The name of a column or dataset to whether it holds times, and in what unit.

use super::time_unit;

/// Words that head times, without their unit.
const TIME_NAMES: [&str; 32] = [
    "time",
    "t",
    "zeit",
    "times",
    "timestamp",
    "timestamps",
    "time stamp",
    "zeitstempel",
    "messzeit",
    "abtastzeit",
    "uhrzeit",
    "elapsed",
    "elapsed time",
    "relative time",
    "relative zeit",
    "rel. time",
    "rel. zeit",
    "datetime",
    "date/time",
    "date time",
    // LabVIEW's name for the times of its measurement files.
    "x_value",
    "sec",
    "seconds",
    "ms",
    "msec",
    "us",
    "µs",
    "usec",
    "ns",
    "temps",
    "tempo",
    "tiempo",
];

/// Names of the axis of a plot: times where a unit of time stands beside it, else one axis of an accelerometer.
const AXIS_NAMES: [&str; 6] = ["x", "x-achse", "x-axis", "x achse", "x axis", "x_axis"];

/// Whether a name without its unit is one of times.
pub(super) fn is_time(bare: &str) -> bool {
    TIME_NAMES.contains(&bare.to_lowercase().as_str())
}

/// Whether a name without its unit is one of an axis.
pub(super) fn is_axis(bare: &str) -> bool {
    AXIS_NAMES.contains(&bare.to_lowercase().as_str())
}

/// `time_ms`, `TimeMs`, `Zeit in ms` or `t/ms` to its name and `ms`.
pub(super) fn split(name: &str) -> (&str, Option<&str>) {
    let name = name.trim();
    let is_unit = |text: &str| time_unit::seconds(text).is_some();
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
