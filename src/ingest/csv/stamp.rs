//! Date-time stamps (ISO 8601) to seconds from the first.

use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;

/// Stamps of one table, counted from the first.
#[derive(Debug, Default)]
pub(super) struct Stamps {
    zero_ns: Option<i128>,
    is_absolute: bool,
}

impl Stamps {
    /// Seconds from the first stamp seen; `None` where `cell` is no stamp.
    pub(super) fn seconds(&mut self, cell: &[u8]) -> Option<f64> {
        let (at_ns, is_absolute) = nanoseconds(std::str::from_utf8(cell).ok()?)?;
        if self.zero_ns.is_none() {
            self.is_absolute = is_absolute;
        }
        let zero_ns = *self.zero_ns.get_or_insert(at_ns);
        let since_ns = i64::try_from(at_ns - zero_ns).ok()?;
        #[allow(
            clippy::cast_precision_loss,
            reason = "whole and rest apart: exact to a part of a nanosecond"
        )]
        Some((since_ns / 1_000_000_000) as f64 + (since_ns % 1_000_000_000) as f64 * 1e-9)
    }

    /// The first stamp, ns since 1970; `None` without stamps.
    pub(super) fn zero_unix_ns(&self) -> Option<i64> {
        self.zero_ns.filter(|_| self.is_absolute).and_then(|zero| i64::try_from(zero).ok())
    }

    /// Whether any stamp was seen.
    pub(super) fn any(&self) -> bool {
        self.zero_ns.is_some()
    }
}

/// Whether a cell looks like a stamp: `2026-11-20…`.
pub(super) fn is_stamp(cell: &[u8]) -> bool {
    cell.len() >= 10 && cell[..4].iter().all(u8::is_ascii_digit) && cell[4] == b'-' && cell[7] == b'-'
}

/// Nanoseconds since 1970, and whether the stamp states its offset from UTC; without one UTC is taken, which differences do not see.
fn nanoseconds(text: &str) -> Option<(i128, bool)> {
    let text = text.trim().trim_matches('"');
    if !is_stamp(text.as_bytes()) {
        return None;
    }
    // A decimal comma is ISO 8601 as well.
    let text = text.replace(',', ".");
    if let Ok(stamp) = text.parse::<Timestamp>() {
        return Some((stamp.as_nanosecond(), true));
    }
    let civil: DateTime = text.parse().ok()?;
    let stamp = civil.to_zoned(TimeZone::UTC).ok()?.timestamp();
    Some((stamp.as_nanosecond(), false))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_count_from_the_first() {
        let mut stamps = Stamps::default();
        assert_eq!(stamps.seconds(b"2026-11-20T12:00:00.000100Z"), Some(0.0));
        let second = stamps.seconds(b"2026-11-20T13:00:01.000200+01:00").unwrap();
        assert!((second - 1.0001).abs() < 1e-12);
        assert_eq!(stamps.zero_unix_ns(), Some(1_795_176_000_000_100_000));
        let mut local = Stamps::default();
        assert_eq!(local.seconds(b"2026-11-20 12:00:00,5"), Some(0.0));
        assert_eq!((local.zero_unix_ns(), local.any()), (None, true));
        assert_eq!(local.seconds(b"20.11.2026 12:00"), None);
    }
}
