//! Numbers in a column or dataset of times to seconds: by the unit that is stated, by 1970, or by a rate that
//! is stated.

use super::refusal::Refusal;
use super::shown;
use super::vocabulary::{split, time_unit_s};
use crate::numerics::{as_f64, robust};
use jiff::{Timestamp, civil::DateTime, tz::TimeZone};

/// Units of time that a recorder may have left out, with seconds a unit.
const UNITS: [(&str, f64); 4] = [("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)];

/// A unit of spreadsheets alone, which count from 1900.
const DAY: (&str, f64) = ("days", 86_400.0);

/// 1954 to 2119 as they count, and rows a day that at so many a second are no seconds since a start.
const SHEET_DAYS: std::ops::Range<f64> = 2e4..8e4;
const LEAST_A_DAY: f64 = 1e6;

/// 1990-01-01 and 2100-01-01, s since 1970: no recorder counts the time since then by chance.
const EPOCH_S: (f64, f64) = (631_152_000.0, 4_102_444_800.0);

/// The unit of Windows' file times, which count from 1601-01-01, and how long before 1970 that is, s.
const WINDOWS_TICK_S: f64 = 1e-7;
const WINDOWS_EPOCH_S: f64 = 11_644_473_600.0;

/// Rates at which impacts are recorded, Hz: from pulses of 10 ms at ten samples each to the fastest transient
/// recorders.
const USUAL_HZ: (f64, f64) = (1e3, 5e6);

/// The least rate of times that count ms, µs or ns since 1970, Hz: a counter of ns since its start looks like
/// µs since 1970 at a thousandth of its rate.
const LEAST_EPOCH_HZ: f64 = 100.0;

/// Less than any contact with its flight, s: so short a record is of another unit.
const SHORTEST_S: f64 = 0.02;

/// A stated rate tells units apart, which are thousandfold, by this part of itself.
const ALIKE: f64 = 0.1;

/// Times of a second column without a unit are in the one in which they run as long as the first to this
/// factor: other units are farther.
const NEAR: f64 = 3.0;

/// The date and time that `text` is by ISO 8601, and whether it states its offset from UTC: without one UTC
/// is taken, which differences do not see.
pub(super) fn dated(text: &str) -> Option<(Timestamp, bool)> {
    let utc = || TimeZone::UTC.to_timestamp(text.parse::<DateTime>().ok()?).ok();
    text.parse().map_or_else(|_| Some((utc()?, false)), |at| Some((at, true)))
}

/// Seconds since 1970 that a number is by its size alone, in s, ms, µs or ns.
pub(super) fn since_1970_s(number: f64) -> Option<f64> {
    UNITS.iter().map(|unit| number * unit.1).find(|time_s| (EPOCH_S.0..EPOCH_S.1).contains(time_s))
}

/// What the numbers in a column of times count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Scale {
    /// So many seconds a unit.
    Known(f64),
    /// Nothing says it.
    Open,
    /// A unit that is none of time.
    Unknown,
    /// So many seconds by its name, and so many by its unit: `time_ms` in `s`.
    Twofold(f64, f64),
}

impl Scale {
    /// As the unit that stands beside the name says, and the name.
    pub(super) fn of(name: &str, unit: Option<&str>) -> Self {
        let named_s = split(name).1.and_then(time_unit_s);
        match unit.map(str::trim) {
            None | Some("" | "-" | "1") => named_s.map_or(Self::Open, Self::Known),
            Some(unit) => match (named_s, time_unit_s(unit)) {
                (_, None) => Self::Unknown,
                (Some(named_s), Some(unit_s)) if named_s.total_cmp(&unit_s).is_ne() => {
                    Self::Twofold(named_s, unit_s)
                }
                (_, Some(unit_s)) => Self::Known(unit_s),
            },
        }
    }

    /// Seconds a unit of a second column of times, beside first times that run for `span_s`; `None` where it
    /// counts rows or something else.
    pub(super) fn beside(self, span_s: f64, others: &[f64]) -> Option<f64> {
        match self {
            Self::Known(unit_s) => Some(unit_s),
            Self::Unknown | Self::Twofold(..) => None,
            Self::Open => {
                let counted = Counted::of(others)?;
                let ratio = |unit_s: &f64| counted.span * unit_s / span_s;
                let units = UNITS.iter().map(|unit| unit.1).chain([60.0, 3600.0, 86_400.0]);
                let mut near = units.filter(|unit_s| (1.0 / NEAR..NEAR).contains(&ratio(unit_s)));
                near.next().filter(|_| !counted.is_counter)
            }
        }
    }
}

/// What holds times, with its name for people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Carrier<'a> {
    /// A column, which states a unit by its header.
    Column(&'a str),
    /// A dataset, which states it by an attribute.
    Dataset(&'a str),
    /// A field of records, which states it by its name: attributes are for the samples in them.
    Field(&'a str),
}

impl Carrier<'_> {
    fn stating(self, unit: &str) -> String {
        match self {
            Self::Column(_) => format!("head the column with [{unit}]"),
            Self::Field(_) => format!("name the field as t_{unit}"),
            Self::Dataset(_) => format!("give the dataset an attribute unit = \"{unit}\""),
        }
    }

    fn place(self) -> String {
        match self {
            Self::Column(header) => format!("column {header:?}"),
            Self::Dataset(source) | Self::Field(source) => source.to_owned(),
        }
    }
}

/// Seconds a unit of times that count `scale`, in channels whose rate is stated or not; `counted` is asked
/// where that alone does not tell it.
///
/// # Errors
/// [`Refusal`] where the unit is none of time, where name and unit contradict each other, and where none is
/// stated and the times are a usual recording in ms, µs or ns but not in s.
pub(super) fn seconds_a_unit(
    scale: Scale,
    carrier: Carrier,
    counted: impl Fn() -> Option<Counted>,
    stated_hz: Option<f64>,
) -> Result<f64, Refusal> {
    match scale {
        Scale::Known(unit_s) => Ok(unit_s),
        Scale::Unknown => Err(Refusal::new(
            format!("the times in {} are in a unit that is none of time known here", carrier.place()),
            format!(
                "{}, or give sample_rate_hz and another time column",
                carrier.stating("s").replace("s]", "s], [ms], [µs] or [ns]")
            ),
        )),
        Scale::Twofold(named_s, unit_s) => {
            let agrees = |scale_s: &f64| {
                stated_hz.zip(counted()).is_some_and(|(hz, counted)| counted.is_at(*scale_s, hz))
            };
            [named_s, unit_s].into_iter().find(agrees).ok_or_else(|| {
                Refusal::new(
                    format!(
                        "the times in {} are in another unit by their name than by their unit",
                        carrier.place()
                    ),
                    "correct the one that is wrong in a copy, or write sample_rate_hz in each [[channel]], \
                     which tells them apart",
                )
            })
        }
        Scale::Open => counted().map_or(Ok(1.0), |counted| counted.seconds_a_unit(carrier, stated_hz)),
    }
}

/// Whether numbers rise as times do: nine of ten do not fall behind the one before, and they get on.
pub(super) fn rise(numbers: &[f64]) -> bool {
    let rising = numbers.windows(2).filter(|pair| pair[0] <= pair[1]).count();
    let pairs = numbers.len().saturating_sub(1);
    pairs > 0 && 10 * rising >= 9 * pairs && numbers[0] < numbers[pairs]
}

/// Seconds a unit of numbers that messages of so many samples carry as their times: as [`seconds_a_unit`],
/// and where nothing states it the unit in which they run as long as the log times do.
///
/// # Errors
/// As there.
pub(super) fn seconds_a_tick(
    each: &[f64],
    samples_each: f64,
    logged_s: f64,
    (scale, carrier): (Scale, Carrier),
    stated_hz: Option<f64>,
) -> Result<f64, Refusal> {
    let counted = || {
        let counted = Counted::of(each)?;
        Some(Counted { rate: counted.rate * samples_each, ..counted })
    };
    let is_open = scale == Scale::Open && counted().is_some_and(|counted| counted.since_1970().is_none());
    let logged = Some(logged_s).filter(|s| is_open && *s > 0.0);
    let as_logged = logged.and_then(|logged_s| scale.beside(logged_s, each));
    as_logged.map_or_else(|| seconds_a_unit(scale, carrier, counted, stated_hz), Ok)
}

/// What bare numbers say of the time that they count.
pub(super) struct Counted {
    pub first: f64,
    pub last: f64,
    /// Rows per unit.
    pub rate: f64,
    pub span: f64,
    /// Whether most rise by exactly 1, and all by whole numbers.
    pub is_counter: bool,
}

impl Counted {
    /// `None` where no two times differ.
    pub(super) fn of(times: &[f64]) -> Option<Self> {
        /// How many intervals are looked at: their median only has to tell a thousandfold.
        const LOOKED_AT: usize = 4096;
        // Rows of other channels may hold no time.
        let (first, last, count) = times
            .iter()
            .filter(|t| t.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY, 0_usize), |(a, b, n), &t| (a.min(t), b.max(t), n + 1));
        let span = last - first;
        if count < 2 || !(span.is_finite() && span > 0.0) {
            return None;
        }
        let mean = span / as_f64(count - 1);
        let pairs = times.windows(2).step_by(times.len().div_ceil(LOOKED_AT));
        let mut steps: Vec<f64> = pairs.map(|pair| pair[1] - pair[0]).filter(|d| *d > 0.0).collect();
        let median = if steps.is_empty() { mean } else { robust::median(&mut steps) };
        let is_whole = |time: &f64| time.is_nan() || time.fract().abs() < f64::EPSILON;
        let is_counter = (median - 1.0).abs() < f64::EPSILON && times.iter().all(is_whole);
        // A pause lengthens the mean, times that repeat the median.
        Some(Self { first, last, rate: 1.0 / mean.min(median), span, is_counter })
    }

    /// Whether the times run at a rate in Hz if a unit is so many seconds.
    fn is_at(&self, unit_s: f64, rate_hz: f64) -> bool {
        (self.rate / unit_s / rate_hz - 1.0).abs() < ALIKE
    }

    fn seconds_a_unit(&self, carrier: Carrier, stated_hz: Option<f64>) -> Result<f64, Refusal> {
        if let Some(unit_s) = self.since_1970() {
            return Ok(unit_s);
        }
        let are_days = SHEET_DAYS.contains(&self.first) && self.rate > LEAST_A_DAY;
        if are_days && stated_hz.is_none() {
            return Err(self.doubt(carrier, &[&DAY]));
        }
        if let Some(stated_hz) = stated_hz {
            let found = UNITS.iter().chain([&DAY]).find(|(_, unit_s)| self.is_at(*unit_s, stated_hz));
            // A counter of the samples, with what is missing left out of it.
            let else_s = if self.is_counter { stated_hz.recip() } else { 1.0 };
            return Ok(found.map_or(else_s, |unit| unit.1));
        }
        let is_usual = |unit: &&(&str, f64)| {
            (USUAL_HZ.0..=USUAL_HZ.1).contains(&(self.rate / unit.1)) && self.span * unit.1 >= SHORTEST_S
        };
        let likelier: Vec<_> = UNITS[1..].iter().filter(is_usual).collect();
        if self.rate >= USUAL_HZ.0 || likelier.is_empty() {
            Ok(1.0)
        } else {
            Err(self.doubt(carrier, &likelier))
        }
    }

    fn doubt(&self, carrier: Carrier, likelier: &[&(&str, f64)]) -> Refusal {
        let named = |(name, unit_s): &(&str, f64)| {
            format!("{name}, which is {} Hz", shown::digits(self.rate / unit_s, 4))
        };
        let asked: Vec<String> = likelier.iter().map(|unit| named(unit)).collect();
        let (name, unit_s) = likelier[0];
        let counter = if self.is_counter {
            "do they count the samples? Then write sample_rate_hz in each [[channel]]. Or "
        } else {
            ""
        };
        Refusal::new(
            format!(
                "nothing says the unit of the times in {}; taken as seconds they give a rate of {} Hz",
                carrier.place(),
                shown::digits(self.rate, 4)
            ),
            format!(
                "{counter}are they in {}? Then {} in a copy, or write sample_rate_hz = {} in each \
                 [[channel]]; {} if they are seconds",
                asked.join(", or in "),
                carrier.stating(name),
                shown::digits(self.rate / unit_s, 6),
                carrier.stating("s")
            ),
        )
    }

    /// Seconds a unit of times that count from 1970.
    fn since_1970(&self) -> Option<f64> {
        let is_it = |(_, unit_s): &&(&str, f64)| {
            let least_hz = if *unit_s < 1.0 { LEAST_EPOCH_HZ } else { 1.0 };
            self.first * unit_s > EPOCH_S.0
                && self.last * unit_s < EPOCH_S.1
                && (least_hz..=USUAL_HZ.1).contains(&(self.rate / unit_s))
        };
        let by_windows = [self.first, self.last].map(|number| WINDOWS_TICK_S * number - WINDOWS_EPOCH_S);
        let is_windows = by_windows[0] > EPOCH_S.0
            && by_windows[1] < EPOCH_S.1
            && (LEAST_EPOCH_HZ..=USUAL_HZ.1).contains(&(self.rate / WINDOWS_TICK_S));
        let found = UNITS.iter().find(is_it).map(|unit| unit.1);
        found.or_else(|| is_windows.then_some(WINDOWS_TICK_S))
    }
}
