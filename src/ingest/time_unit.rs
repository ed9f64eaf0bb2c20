//! The name of a unit of time to seconds.

/// Seconds per `unit`, whatever its case; `None` where it names no unit of time.
///
/// What the CF conventions of netCDF write behind it, "since 1970-01-01", says only where the times begin.
pub(super) fn seconds(unit: &str) -> Option<f64> {
    let unit = unit.split_once(" since ").map_or(unit, |(unit, _)| unit);
    match unit.trim().to_lowercase().as_str() {
        "s" | "sec" | "secs" | "second" | "seconds" | "sek" | "sekunde" | "sekunden" => Some(1.0),
        "ms" | "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" | "millisekunden" => Some(1e-3),
        "us" | "µs" | "μs" | "usec" | "µsec" | "μsec" | "micros" | "microsecond" | "microseconds"
        | "mikrosekunden" => Some(1e-6),
        "ns" | "nsec" | "nanos" | "nanosecond" | "nanoseconds" | "nanosekunden" => Some(1e-9),
        "min" | "minute" | "minutes" | "minuten" => Some(60.0),
        "h" | "hour" | "hours" | "std" | "stunden" => Some(3600.0),
        _ => None,
    }
}
