//! The name of a unit of time to seconds.

/// Seconds per `unit`, whatever its case; `None` where it names no unit of time.
pub(super) fn seconds(unit: &str) -> Option<f64> {
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
