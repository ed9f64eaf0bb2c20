//! Date-time stamps and clock times to seconds from the first:
//!
//! | kind | examples |
//! |---|---|
//! | ISO 8601 | `2026-11-20T12:34:56.789Z`, `2026-11-20 12:34:56,789` |
//! | date and time | `20.11.2026 12:34:56,789`, `11/20/2026 12:34:56.789`, `2026/11/20 12:34:56 PM`, `20-Nov-2026 12:34:56.789` |
//! | time of day | `12:34:56.789`, `12:34:56:789`, `7:04:05 p.m.`, `0 days 12:34:56.789` |

use crate::ingest::times::dated;
use jiff::civil::Date;
use std::borrow::Cow;
use std::collections::BTreeMap;

const SECOND_NS: i64 = 1_000_000_000;
const DAY_NS: i64 = 86_400 * SECOND_NS;

/// How a stamp is written; a column keeps to the kind that it begins with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Spelling {
    Iso,
    Dated,
    OfDay,
}

/// Stamps of one table, counted from the first of their kind, so that columns of one kind share a clock.
#[derive(Debug, Default)]
pub(super) struct Stamps {
    zeros_ns: [Option<i64>; 3],
    is_absolute: bool,
    /// By their slots.
    columns: BTreeMap<usize, Running>,
}

/// One column so far.
#[derive(Debug, Clone, Copy)]
struct Running {
    kind: Spelling,
    /// The last date as it stands there, and its day from 1970.
    date: [i16; 3],
    day: i64,
    /// The last time within its day.
    last_ns: i64,
    /// The days that have gone by without being said.
    passed_ns: i64,
}

impl Stamps {
    /// Seconds from the first stamp seen; `None` where `cell` is no stamp, or of another kind than the others
    /// in its column, `slot`.
    pub(super) fn seconds(&mut self, slot: usize, cell: &[u8]) -> Option<f64> {
        let stamp = Stamp::of(cell)?;
        let column = self.columns.entry(slot).or_insert_with(|| Running::from(&stamp));
        let at_ns = column.follow(&stamp)?;
        let zero_ns = &mut self.zeros_ns[stamp.kind as usize];
        if stamp.kind == Spelling::Iso && zero_ns.is_none() {
            self.is_absolute = stamp.is_absolute;
        }
        let since_ns = at_ns.checked_sub(*zero_ns.get_or_insert(at_ns))?;
        #[allow(clippy::cast_precision_loss, reason = "whole and rest apart: exact to a part of a ns")]
        Some((since_ns / SECOND_NS) as f64 + (since_ns % SECOND_NS) as f64 * 1e-9)
    }

    /// The first stamp, ns since 1970; `None` without stamps that state their offset from UTC.
    pub(super) fn zero_unix_ns(&self) -> Option<i64> {
        self.zeros_ns[Spelling::Iso as usize].filter(|_| self.is_absolute)
    }

    /// Whether the column holds stamps.
    pub(super) fn are_in(&self, slot: usize) -> bool {
        self.columns.contains_key(&slot)
    }
}

impl Running {
    fn from(stamp: &Stamp) -> Self {
        let day = readings(stamp.date).into_iter().flatten().next().map_or(0, day);
        Self { kind: stamp.kind, date: stamp.date, day, last_ns: stamp.at_ns, passed_ns: 0 }
    }

    /// Nanoseconds on a clock that goes on past midnight.
    fn follow(&mut self, stamp: &Stamp) -> Option<i64> {
        if stamp.kind != self.kind {
            return None;
        }
        match stamp.kind {
            Spelling::Iso => Some(stamp.at_ns),
            Spelling::Dated => {
                if stamp.date != self.date {
                    self.day += days_between(self.date, stamp.date)?;
                    self.date = stamp.date;
                }
                self.day.checked_mul(DAY_NS)?.checked_add(stamp.at_ns)
            }
            Spelling::OfDay => {
                // No drop lasts for half a day: a fall by more is midnight, a rise by more a row out of order
                // there.
                if self.last_ns - stamp.at_ns > DAY_NS / 2 {
                    self.passed_ns += DAY_NS;
                } else if stamp.at_ns - self.last_ns > DAY_NS / 2 && self.passed_ns > 0 {
                    self.passed_ns -= DAY_NS;
                }
                self.last_ns = stamp.at_ns;
                Some(stamp.at_ns + self.passed_ns)
            }
        }
    }
}

/// Whether a cell is a stamp with a time of day; a date alone is none, nor are minutes and seconds.
pub(super) fn is_stamp(cell: &[u8]) -> bool {
    Stamp::of(cell).is_some()
}

/// One cell.
struct Stamp {
    kind: Spelling,
    /// The numbers of its date as they stand there; 0 where it has none, or of [`Spelling::Iso`].
    date: [i16; 3],
    /// Since 1970 or midnight.
    at_ns: i64,
    /// Whether it states its offset from UTC.
    is_absolute: bool,
}

impl Stamp {
    fn of(cell: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(cell).ok()?.trim().trim_matches('"');
        let is_iso =
            |b: &[u8]| b.len() > 11 && b[..4].iter().all(u8::is_ascii_digit) && b[4] == b'-' && b[7] == b'-';
        if is_iso(text.as_bytes()) { Self::iso(text) } else { Self::clock(text) }
    }

    fn iso(text: &str) -> Option<Self> {
        // A decimal comma is ISO 8601 as well.
        let (at, is_absolute) = dated(&text.replace(',', "."))?;
        let at_ns = i64::try_from(at.as_nanosecond()).ok()?;
        Some(Self { kind: Spelling::Iso, date: [0; 3], at_ns, is_absolute })
    }

    fn clock(text: &str) -> Option<Self> {
        let (text, half) = halved(text);
        let (date, clock) = match text.rsplit_once([' ', 'T']) {
            Some((date, clock)) => (Some(date.trim_end().trim_end_matches(',')), clock),
            None => (None, text),
        };
        let (hours, rest) = clock.split_once(':')?;
        let (minutes, seconds) = rest.split_once(':')?;
        // "12:050.25" counts ms behind the last colon.
        let is_ms = |ms: &str| ms.find(['.', ',']).unwrap_or(ms.len()) == 3;
        let (seconds, fraction) = match seconds.split_once(':').filter(|(_, ms)| is_ms(ms)) {
            Some((seconds, ms)) => (seconds, Cow::Owned(ms.replace(['.', ','], ""))),
            None => seconds.split_once(['.', ',']).map_or((seconds, "0".into()), |(s, f)| (s, f.into())),
        };
        // pandas counts "0 days 00:00:00.1".
        let days = date.and_then(|date| date.strip_suffix(" days").or_else(|| date.strip_suffix(" day")));
        let (date, days) = days.map_or(Some((date, 0)), |days| Some((None, whole(days, 3)?)))?;
        let (hours, minutes, seconds) = (whole(hours, 3)?, whole(minutes, 2)?, whole(seconds, 2)?);
        // 12 AM is midnight, 12 PM noon.
        let hours = match half {
            Some(half) if (1..=12).contains(&hours) => hours % 12 + half,
            Some(_) => return None,
            None => hours,
        };
        if seconds > 59 || minutes > 59 || (date.is_some() && hours > 23) {
            return None;
        }
        let (kind, date) = match date.map(numbers) {
            Some(date) => (Spelling::Dated, date.filter(|date| readings(*date).iter().any(Option::is_some))?),
            None => (Spelling::OfDay, [0; 3]),
        };
        let at_ns =
            (3600 * (24 * days + hours) + 60 * minutes + seconds) * SECOND_NS + fraction_ns(&fraction)?;
        Some(Self { kind, date, at_ns, is_absolute: false })
    }
}

/// "7:04:05 PM" or "7:04:05 p.m." to "7:04:05" and the hours of noon; without either as it is.
fn halved(text: &str) -> (&str, Option<i64>) {
    let half = |(suffix, hours): (&str, i64)| {
        let (clock, end) = text.split_at_checked(text.len().checked_sub(suffix.len())?)?;
        end.eq_ignore_ascii_case(suffix).then(|| (clock.trim_end(), Some(hours)))
    };
    [("AM", 0), ("PM", 12), ("A.M.", 0), ("P.M.", 12)].into_iter().find_map(half).unwrap_or((text, None))
}

/// A whole number of so many digits at most.
fn whole(text: &str, digits: usize) -> Option<i64> {
    let is_whole = (1..=digits).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
    is_whole.then(|| text.parse().ok())?
}

/// Digits behind the decimal mark to nanoseconds; more than nine are cut.
fn fraction_ns(digits: &str) -> Option<i64> {
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    format!("{:0<9}", &digits[..digits.len().min(9)]).parse().ok()
}

/// The three numbers of a date.
fn numbers(date: &str) -> Option<[i16; 3]> {
    let mark = date.chars().find(|c| matches!(c, '.' | '/' | '-'))?;
    let number = |part: &str| whole(part, 4).and_then(|n| i16::try_from(n).ok()).or_else(|| month(part));
    let mut parts = date.split(mark).map(number);
    let numbers = [parts.next()??, parts.next()??, parts.next()??];
    parts.next().is_none().then_some(numbers)
}

/// "Mar" or "März" to 3.
fn month(name: &str) -> Option<i16> {
    const MONTHS: [&str; 12] =
        ["jan", "feb", "mar mär", "apr", "may mai", "jun", "jul", "aug", "sep", "oct okt", "nov", "dec dez"];
    let start: String = name.to_lowercase().chars().take(3).collect();
    let place = MONTHS.iter().position(|month| start.chars().count() == 3 && month.contains(&start))?;
    i16::try_from(place + 1).ok()
}

/// A date as day first and as month first; the year leads where it is told by its size.
fn readings([a, b, c]: [i16; 3]) -> [Option<Date>; 2] {
    let date = |year: i16, month: i16, day: i16| {
        let year = if year < 100 { year + 2000 } else { year };
        Date::new(year, i8::try_from(month).ok()?, i8::try_from(day).ok()?).ok()
    };
    if a > 31 { [date(a, b, c); 2] } else { [date(c, b, a), date(c, a, b)] }
}

/// Days from one date of a column to another: whether day or month stands first, their order makes neighbours
/// of neighbours.
fn days_between(from: [i16; 3], to: [i16; 3]) -> Option<i64> {
    let both = readings(from).into_iter().zip(readings(to));
    both.filter_map(|(from, to)| Some(day(to?) - day(from?))).min_by_key(|days| days.abs())
}

/// A date's day from 1970.
fn day(date: Date) -> i64 {
    date.duration_since(Date::constant(1970, 1, 1)).as_hours() / 24
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_count_from_the_first() {
        let mut stamps = Stamps::default();
        assert_eq!(stamps.seconds(0, b"2026-11-20T12:00:00.000100Z"), Some(0.0));
        let second = stamps.seconds(0, b"2026-11-20T13:00:01.000200+01:00").unwrap();
        assert!((second - 1.0001).abs() < 1e-12);
        assert_eq!(stamps.zero_unix_ns(), Some(1_795_176_000_000_100_000));
        // Another column's share the clock.
        assert_eq!(stamps.seconds(1, b"2026-11-20T12:00:02.000100Z"), Some(2.0));
        let mut local = Stamps::default();
        assert_eq!(local.seconds(0, b"2026-11-20 12:00:00,5"), Some(0.0));
        assert_eq!((local.zero_unix_ns(), local.are_in(0), local.are_in(1)), (None, true, false));
        assert_eq!(local.seconds(0, b"20.11.2026 12:00"), None);
    }

    /// Seconds of the cells of one column.
    fn seconds(cells: &[&str]) -> Vec<Option<f64>> {
        let mut stamps = Stamps::default();
        cells.iter().map(|cell| stamps.seconds(0, cell.as_bytes())).collect()
    }

    #[test]
    fn clock_times_go_on_past_midnight() {
        for cells in [
            ["23:59:59.5", "23:59:59.75", "00:00:00.25", "23:59:59.875", "0:00:01"],
            [
                "31.12.2026 23:59:59,5",
                "31.12.2026 23:59:59,75",
                "01.01.2027 00:00:00,25",
                "31.12.2026 23:59:59,875",
                "01.01.2027 00:00:01",
            ],
            [
                "11/12/26 11:59:59.5 p.m.",
                "11/12/26 23:59:59.75",
                "11/13/26 12:00:00.25 a.m.",
                "11/12/26 23:59:59.875",
                "11/13/26 00:00:01",
            ],
            [
                "05/06/2026 23:59:59.5",
                "05/06/2026 23:59:59.75",
                "06/06/2026 00:00:00.25",
                "05/06/2026 23:59:59.875",
                "06/06/2026 00:00:01",
            ],
            [
                "2026/02/28 23:59:59.5",
                "2026/02/28 23:59:59.75",
                "2026/03/01 00:00:00.25",
                "2026/02/28 23:59:59.875",
                "2026/03/01 00:00:01",
            ],
        ] {
            assert_eq!(seconds(&cells), [0.0, 0.25, 0.75, 0.375, 1.5].map(Some), "{cells:?}");
        }
        // A second session on another day is no part of the first.
        assert_eq!(seconds(&["20.11.2026 10:00:00", "22.11.2026 10:00:00"])[1], Some(2.0 * 86_400.0));
    }

    #[test]
    fn a_column_keeps_to_one_kind() {
        assert_eq!(
            seconds(&["12:34:56.5", "34:57.5", "2026-11-20T12:34:58Z", "12:34:57"]),
            [Some(0.0), None, None, Some(0.5)]
        );
    }

    #[test]
    fn what_is_no_time_of_day_is_no_stamp() {
        for cell in [
            "2026-11-20",
            "20.11.2026",
            "12:34",
            "12:60:00",
            "12:34:60.5",
            "12:34:56.",
            "12:34:56.7x",
            ":34:56",
            "1:2:3:4",
            "10:11:12:05",
            "20-Foo-2026 1:02:03",
            "13:34:56 PM",
            "34:56.5 AM",
            "PM",
            "31.02.2026 12:00:00",
            "1.2 12:00:00",
            "x 12:00:00",
            "24:00.5 12:00:00",
            "34:56.789",
            "7:04:05 p. m.",
            "20.11.2026 24:00:00",
            "12.5",
            "",
        ] {
            assert!(!is_stamp(cell.as_bytes()), "{cell}");
        }
        for cell in [
            "12:34:56",
            "7:04:05,123456789123",
            "100:00:00.0",
            "7:04:05 PM",
            "7:04:05am",
            "20.11.2026, 12:00:00",
            "20-11-2026 1:02:03",
            "20-Nov-2026 1:02:03.5",
            "0 days 00:00:00.000125",
            "10:11:12:050",
            "10:11:12:050.125",
            "2026-11-20T12:00Z",
        ] {
            assert!(is_stamp(cell.as_bytes()), "{cell}");
        }
        for (cells, later_s) in [
            (["10:11:12:999.500", "10:11:13:000.250"], 0.000_75),
            (["0 days 23:59:59.5", "1 days 00:00:00.25"], 0.75),
            (["31-Mar-2026 23:59:59.5", "01-Apr-2026 00:00:00.25"], 0.75),
        ] {
            assert!((seconds(&cells)[1].unwrap() - later_s).abs() < 1e-12, "{cells:?}");
        }
        let cut = seconds(&["00:00:00", "00:00:00,1234567899"])[1].unwrap();
        assert!((cut - 0.123_456_789).abs() < 1e-15, "{cut}");
    }
}
