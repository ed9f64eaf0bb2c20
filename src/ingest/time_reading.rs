//! Numbers in a column or dataset of times to seconds, also where nothing says their unit.

use super::time_base::{short, to_digits};
use super::{time_name, time_unit};
use crate::data::{Issue, IssueCode, Severity};

/// Units of time that a recorder may have left out, with seconds a unit.
pub(super) const UNITS: [(&str, f64); 4] = [("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)];

/// 1990-01-01 and 2100-01-01, s since 1970: no recorder counts the time since then by chance.
const EPOCH_S: (f64, f64) = (631_152_000.0, 4_102_444_800.0);

/// Rates at which impacts are recorded, Hz: from pulses of 10 ms at ten samples each to the fastest transient recorders.
const USUAL_HZ: (f64, f64) = (1e3, 5e6);

/// The least rate of times that count ms, µs or ns since 1970, Hz: a counter of ns since its start looks like µs since 1970 at a thousandth of its rate.
const LEAST_EPOCH_HZ: f64 = 100.0;

/// Below this rate a contact of 10 ms holds not one sample, Hz: no recording of a drop is lost with those that are refused.
const LEAST_HZ: f64 = 100.0;

/// Less than any contact with its flight, s: so short a record is of another unit.
const SHORTEST_S: f64 = 0.02;

/// A stated rate tells units apart, which are thousandfold, by this part of itself.
const ALIKE: f64 = 0.1;

/// How many intervals are looked at: their median only has to tell a thousandfold.
const LOOKED_AT: usize = 4096;

/// What the numbers in a column of times count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Scale {
    /// So many seconds a unit.
    Known(f64),
    /// Nothing says it.
    Open,
    /// A unit that is none of time.
    Unknown,
    /// So many seconds by its name, and so many by its unit.
    Twofold(f64, f64),
}

impl Scale {
    /// As the unit that stands beside the name says, and the name.
    pub(super) fn of(name: &str, unit: Option<&str>) -> Self {
        let named_s = time_name::split(name).1.and_then(time_unit::seconds);
        match unit.map(str::trim) {
            None | Some("" | "-" | "1") => named_s.map_or(Self::Open, Self::Known),
            Some(unit) => match (named_s, time_unit::seconds(unit)) {
                (_, None) => Self::Unknown,
                (Some(named_s), Some(unit_s)) if named_s.total_cmp(&unit_s).is_ne() => {
                    Self::Twofold(named_s, unit_s)
                }
                (_, Some(unit_s)) => Self::Known(unit_s),
            },
        }
    }
}

/// What holds times, and how it says their unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Carrier {
    /// A column, by its header.
    Column,
}

impl Carrier {
    fn stating(self, unit: &str) -> String {
        match self {
            Self::Column => format!("head the column with [{unit}]"),
        }
    }
}

/// How the numbers in a column of times are read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reading {
    /// Seconds a unit.
    pub scale_s: f64,
    /// Nothing says that it is seconds, and there is a likelier unit.
    pub doubt: Option<Doubt>,
}

/// Why times without a unit may be no seconds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Doubt {
    /// The rate that they give in seconds, Hz.
    rate_hz: f64,
    /// Whether they rise by 1 from row to row.
    counts: bool,
    /// Units in which they would be a usual recording, with the rate in Hz.
    likelier: Vec<(&'static str, f64)>,
}

impl Reading {
    /// The reading of `times` that count `scale`, in a channel whose rate is stated or not.
    pub(super) fn of(scale: Scale, times: &[f64], declared_rate_hz: Option<f64>) -> Self {
        Self::by(scale, || Clock::of(times), declared_rate_hz)
    }

    /// The same of times of which the clock, asked for where the unit is open, is known.
    pub(super) fn by(
        scale: Scale,
        clock: impl FnOnce() -> Option<Clock>,
        declared_rate_hz: Option<f64>,
    ) -> Self {
        let sure = |scale_s| Self { scale_s, doubt: None };
        if let Scale::Known(scale_s) = scale {
            return sure(scale_s);
        }
        let Some(clock) = clock() else { return sure(1.0) };
        let agrees = |scale_s: f64, hz: f64| (clock.rate / scale_s / hz - 1.0).abs() < ALIKE;
        if let Scale::Twofold(named_s, unit_s) = scale {
            // Without a rate that tells them apart there is an error, or in a listing a warning.
            let is_named = declared_rate_hz.is_some_and(|hz| agrees(named_s, hz));
            return sure(if is_named { named_s } else { unit_s });
        }
        if let Some(scale_s) = clock.since_1970() {
            return sure(scale_s);
        }
        if let Some(declared_hz) = declared_rate_hz {
            let is_it = |(_, scale_s): &&(_, f64)| agrees(*scale_s, declared_hz);
            // A counter of the samples, with what is missing left out of it.
            let else_s = if clock.counts { declared_hz.recip() } else { 1.0 };
            return sure(UNITS.iter().find(is_it).map_or(else_s, |unit| unit.1));
        }
        let likelier: Vec<(&str, f64)> = UNITS[1..]
            .iter()
            .filter(|(_, scale_s)| {
                (USUAL_HZ.0..=USUAL_HZ.1).contains(&(clock.rate / scale_s))
                    && clock.span * scale_s >= SHORTEST_S
            })
            .map(|(name, scale_s)| (*name, clock.rate / scale_s))
            .collect();
        let is_doubtful = clock.rate < USUAL_HZ.0 && !likelier.is_empty();
        let doubt = Doubt { rate_hz: clock.rate, counts: clock.counts, likelier };
        Self { scale_s: 1.0, doubt: is_doubtful.then_some(doubt) }
    }

    /// The times to seconds.
    pub(super) fn apply(&self, times: &mut [f64]) {
        #[allow(clippy::float_cmp, reason = "1.0 is the literal for seconds")]
        if self.scale_s != 1.0 {
            for t in times {
                *t *= self.scale_s;
            }
        }
    }

    /// The doubt in words, for times in the column headed so.
    pub(super) fn issue(&self, header: &str, carrier: Carrier) -> Option<Issue> {
        let doubt = self.doubt.as_ref()?;
        let message = format!("{}: {}", doubt.problem(header, carrier), doubt.mend(carrier));
        Some(Issue::new(IssueCode::Clock, Severity::Warning, message))
    }
}

impl Doubt {
    /// Whether the times in seconds are of no use whatever they are.
    pub(super) fn is_grave(&self) -> bool {
        self.rate_hz < LEAST_HZ
    }

    pub(super) fn problem(&self, header: &str, carrier: Carrier) -> String {
        let place = match carrier {
            Carrier::Column => format!("column {header:?}"),
        };
        format!(
            "nothing says the unit of the times in {place}; taken as seconds they give a rate of {}",
            rate(self.rate_hz)
        )
    }

    pub(super) fn mend(&self, carrier: Carrier) -> String {
        let asked: Vec<String> = self
            .likelier
            .iter()
            .map(|(name, rate_hz)| format!("{name}, which is {}", rate(*rate_hz)))
            .collect();
        let (name, rate_hz) = self.likelier[0];
        let counter = if self.counts {
            "do they count the samples? Then write sample_rate_hz in each [[channel]]. Or "
        } else {
            ""
        };
        format!(
            "{counter}are they in {}? Then {} in a copy, or write sample_rate_hz = {} in each [[channel]]; {} if they are seconds",
            asked.join(", or in "),
            carrier.stating(name),
            short(to_digits(rate_hz, 6)),
            carrier.stating("s")
        )
    }
}

fn rate(rate_hz: f64) -> String {
    let (value, unit) = if rate_hz < 1e3 { (rate_hz, "Hz") } else { (rate_hz / 1e3, "kHz") };
    format!("{} {unit}", short(to_digits(value, 4)))
}

/// What the bare numbers say.
pub(super) struct Clock {
    pub first: f64,
    pub last: f64,
    /// Rows per unit.
    pub rate: f64,
    pub span: f64,
    /// Whether most rise by exactly 1, and all by whole numbers.
    pub counts: bool,
}

impl Clock {
    pub(super) fn of(times: &[f64]) -> Option<Self> {
        // Rows of other channels may hold no time.
        let (first, last, count) = times
            .iter()
            .filter(|t| t.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY, 0_usize), |(a, b, n), &t| (a.min(t), b.max(t), n + 1));
        let span = last - first;
        if count < 2 || !(span.is_finite() && span > 0.0) {
            return None;
        }
        #[allow(clippy::cast_precision_loss, reason = "row counts stay below 2^52")]
        let mean = span / (count - 1) as f64;
        let stride = times.len().div_ceil(LOOKED_AT);
        let pairs = times.windows(2).step_by(stride);
        let mut steps: Vec<f64> = pairs.map(|pair| pair[1] - pair[0]).filter(|d| *d > 0.0).collect();
        let middle = steps.len() / 2;
        let median =
            if steps.is_empty() { mean } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 };
        let is_whole = |time: &f64| time.is_nan() || time.fract().abs() < f64::EPSILON;
        let counts = (median - 1.0).abs() < f64::EPSILON && times.iter().all(is_whole);
        // A pause lengthens the mean, times that repeat the median.
        Some(Self { first, last, rate: 1.0 / mean.min(median), span, counts })
    }

    /// Seconds a unit of times that count from 1970.
    fn since_1970(&self) -> Option<f64> {
        let is_it = |(_, scale_s): &&(_, f64)| {
            let least_hz = if *scale_s < 1.0 { LEAST_EPOCH_HZ } else { 1.0 };
            self.first * scale_s > EPOCH_S.0
                && self.last * scale_s < EPOCH_S.1
                && (least_hz..=USUAL_HZ.1).contains(&(self.rate / scale_s))
        };
        UNITS.iter().find(is_it).map(|unit| unit.1)
    }
}
