//! Recorded times and samples to one uniform base, with the error of doing so known.

mod blocks;
mod coarse;
mod cut;
mod fit;
mod missing;
mod order;
mod resample;

pub(super) use super::clock::RATE_TOLERANCE;
pub(super) use super::shown::{short, to_digits};
pub use blocks::from_blocks;
pub(super) use coarse::period as period_of_changes;
pub(super) use cut::{cut, unit_s, usual_hz};

use super::clock::{self, Claims, Refusal};
use super::shown::digits;
use crate::data::{Issue, IssueCode, Samples, Severity, Span};
use fit::Fit;
use order::Ordered;
use std::sync::OnceLock;

/// Samples on a uniform base.
#[derive(Debug, Clone, PartialEq)]
pub struct Uniform {
    /// Time of sample 0, in the clock of the times given, s.
    pub start_s: f64,
    /// Rate, Hz.
    pub sample_rate_hz: f64,
    /// Samples; NaN where missing.
    pub samples: Samples,
    /// Stretches without samples.
    pub gaps: Vec<Span>,
    /// RMS distance of the recorded times from the base, s; 0 where samples were not moved.
    pub time_jitter_s: f64,
    /// What was put right: duplicates, disorder, gaps, jitter (times in the clock of the times given).
    pub issues: Vec<Issue>,
}

impl Uniform {
    /// The same samples at a declared rate, which wins over that of the recorded times, with a warning.
    ///
    /// # Errors
    /// [`TimeBaseError::Rate`] where it is no rate.
    pub(super) fn at(mut self, declared_hz: f64) -> Result<Self, TimeBaseError> {
        check_rate(declared_hz)?;
        let own = clock::of_times(self.sample_rate_hz, 0.0);
        self.issues.extend(Claims::of_cask(Some(declared_hz)).weigh(Some(&own))?.issues);
        self.sample_rate_hz = declared_hz;
        Ok(self)
    }
}

impl TimeBaseError {
    /// What is wrong with its own remedy where it has one, else with this.
    pub(super) fn refusal(self, remedy: &str) -> Refusal {
        match self {
            Self::Refused(refusal) => refusal,
            other => Refusal::new(other.to_string(), remedy),
        }
    }
}

/// A contiguous run of samples with its own start and rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Time of its first sample, s.
    pub start_s: f64,
    /// Rate, Hz.
    pub sample_rate_hz: f64,
    /// Number of its samples.
    pub count: usize,
}

/// Why times give no uniform base.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TimeBaseError {
    /// There are fewer than two samples.
    #[error("{count} sample(s) make no record: at least two are needed")]
    TooFew {
        /// How many there are.
        count: usize,
    },
    /// Times and samples differ in number.
    #[error("there are {times} times but {samples} samples: each sample needs one time of its own")]
    Lengths {
        /// Number of times.
        times: usize,
        /// Number of samples.
        samples: usize,
    },
    /// A time is NaN or infinite.
    #[error(
        "time number {number} is {time_s}, which is no time: remove that row or name another time source"
    )]
    NotFinite {
        /// Which, counted from 1.
        number: usize,
        /// Its value, s.
        time_s: f64,
    },
    /// All times are the same.
    #[error("all times are {time_s} s: these are no times; give sample_rate_hz instead")]
    AllEqual {
        /// The value, s.
        time_s: f64,
    },
    /// Times repeat so often, and change so seldom or unevenly, that they do not tell when a sample was taken.
    #[error(
        "the times are cut to {} s: {count} samples share {} times that are too few or too uneven to tell their rate; \
         give sample_rate_hz for this channel",
        digits(*step_s, 3),
        changes + 1
    )]
    TooCoarse {
        /// What they are cut to, s.
        step_s: f64,
        /// How many times are later than the one before.
        changes: usize,
        /// Number of times.
        count: usize,
    },
    /// Times jump so far that filling the gap would not fit in memory.
    #[error(
        "times jump from {} s to {} s, which would be {lost:.3e} samples at {} Hz: no gap of one record; check the clock, \
         or cut the recording there",
        short(*from_s), short(*to_s), short(*sample_rate_hz)
    )]
    Jump {
        /// Last time before the jump, s.
        from_s: f64,
        /// First time after it, s.
        to_s: f64,
        /// Samples that would have to be filled in.
        lost: f64,
        /// The rate of the rest, Hz.
        sample_rate_hz: f64,
    },
    /// Nothing states a rate, or rates contradict each other.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// A rate is zero, negative or no number.
    #[error(
        "the sample rate is {sample_rate_hz} Hz: it must be above zero; set sample_rate_hz in the cask file"
    )]
    Rate {
        /// The rate, Hz.
        sample_rate_hz: f64,
    },
    /// Blocks of one channel differ in rate.
    #[error(
        "blocks differ in sample rate: {first_hz} Hz at first, {other_hz} Hz from {at_s} s on; \
         cut the recording there, or set sample_rate_hz if one of them is wrong"
    )]
    RateChanges {
        /// Rate of the first block, Hz.
        first_hz: f64,
        /// The other rate, Hz.
        other_hz: f64,
        /// Where it starts, s.
        at_s: f64,
    },
}

/// Times that lie nearer to the base than this part of the sample interval (RMS) leave their samples where they are: at
/// 2 % a sine of a tenth of the sample rate is off by 1 % of itself at most, a tenth of what its sampling costs.
const STEADY_PART: f64 = 0.02;

/// A sample type that a base can hold.
pub(super) trait Number: Copy {
    /// What stands where a sample is missing.
    const MISSING: Self;
    /// As f64.
    fn to_f64(self) -> f64;
    /// From f64, rounded.
    fn from_f64(value: f64) -> Self;
}

impl Number for f32 {
    const MISSING: Self = f32::NAN;
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[allow(clippy::cast_possible_truncation, reason = "interpolated between f32 samples")]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
}

impl Number for f64 {
    const MISSING: Self = f64::NAN;
    fn to_f64(self) -> f64 {
        self
    }
    fn from_f64(value: f64) -> Self {
        value
    }
}

/// Samples placed on a base, before their type is forgotten again.
struct Placed<S> {
    start_s: f64,
    sample_rate_hz: f64,
    samples: Vec<S>,
    gaps: Vec<Span>,
    time_jitter_s: f64,
    issues: Vec<Issue>,
}

impl<S> Placed<S> {
    fn into_uniform(self, wrap: impl FnOnce(Vec<S>) -> Samples) -> Uniform {
        Uniform {
            start_s: self.start_s,
            sample_rate_hz: self.sample_rate_hz,
            samples: wrap(self.samples),
            gaps: self.gaps,
            time_jitter_s: self.time_jitter_s,
            issues: self.issues,
        }
    }
}

/// Times that several channels may share; what they say of a base is found once.
pub struct Times<'a> {
    each_s: &'a [f64],
    rise: bool,
    fit: OnceLock<Result<Fit, TimeBaseError>>,
}

impl<'a> Times<'a> {
    /// One time a sample, s.
    #[must_use]
    pub fn new(times_s: &'a [f64]) -> Self {
        Self { each_s: times_s, rise: order::rise(times_s), fit: OnceLock::new() }
    }

    /// Samples with a time each on a uniform base: sorted, doubles dropped, gaps NaN, real jitter interpolated.
    ///
    /// The rate is the one that [`Claims::weigh`] takes; gaps are counted at the times' own rate.
    ///
    /// # Errors
    /// [`TimeBaseError`] where the times make no record.
    pub fn place_by(&self, samples: Samples, claims: &Claims) -> Result<Uniform, TimeBaseError> {
        if self.each_s.len() != samples.len() {
            return Err(TimeBaseError::Lengths { times: self.each_s.len(), samples: samples.len() });
        }
        claims.cask_hz.map_or(Ok(()), check_rate)?;
        match samples {
            Samples::F32(v) => Ok(place(self, v, claims)?.into_uniform(Samples::F32)),
            Samples::F64(v) => Ok(place(self, v, claims)?.into_uniform(Samples::F64)),
        }
    }

    /// The same where nothing but a cask file may state a rate.
    ///
    /// # Errors
    /// As [`Times::place_by`].
    pub fn place(&self, samples: Samples, declared_rate_hz: Option<f64>) -> Result<Uniform, TimeBaseError> {
        self.place_by(samples, &Claims::of_cask(declared_rate_hz))
    }

    /// The base nearest to the times as they stand, where they rise.
    fn fit(&self) -> Result<Fit, TimeBaseError> {
        self.fit.get_or_init(|| Fit::new(self.each_s)).clone()
    }
}

/// [`Times::place`] of a single channel.
///
/// # Errors
/// As that.
pub fn from_times(
    times_s: &[f64],
    samples: Samples,
    declared_rate_hz: Option<f64>,
) -> Result<Uniform, TimeBaseError> {
    Times::new(times_s).place(samples, declared_rate_hz)
}

/// Samples without times, at the rate that is claimed.
///
/// # Errors
/// As [`from_rate`]; [`TimeBaseError::Refused`] where none is stated, or two that contradict each other.
pub fn from_claims(start_s: f64, claims: &Claims, samples: Samples) -> Result<Uniform, TimeBaseError> {
    let taken = claims.weigh(None)?;
    let mut uniform = from_rate(start_s, taken.rate_hz, samples)?;
    uniform.issues.extend(taken.issues);
    Ok(uniform)
}

/// Samples without times, at a known rate: only non-finite ones are looked for.
///
/// # Errors
/// [`TimeBaseError`] where there are fewer than two samples or the rate is none.
pub fn from_rate(start_s: f64, sample_rate_hz: f64, samples: Samples) -> Result<Uniform, TimeBaseError> {
    check_rate(sample_rate_hz)?;
    if samples.len() < 2 {
        return Err(TimeBaseError::TooFew { count: samples.len() });
    }
    if !start_s.is_finite() {
        return Err(TimeBaseError::NotFinite { number: 1, time_s: start_s });
    }
    let mut uniform = Uniform {
        start_s,
        sample_rate_hz,
        samples,
        gaps: Vec::new(),
        time_jitter_s: 0.0,
        issues: Vec::new(),
    };
    let clock = (start_s, sample_rate_hz);
    let (count, gaps) = match &mut uniform.samples {
        Samples::F32(v) => missing::mark_non_finite(v, clock, &mut uniform.issues),
        Samples::F64(v) => missing::mark_non_finite(v, clock, &mut uniform.issues),
    };
    debug_assert_eq!(count == 0, gaps.is_empty());
    uniform.gaps = gaps;
    Ok(uniform)
}

fn check_rate(sample_rate_hz: f64) -> Result<(), TimeBaseError> {
    if sample_rate_hz.is_finite() && sample_rate_hz > 0.0 {
        Ok(())
    } else {
        Err(TimeBaseError::Rate { sample_rate_hz })
    }
}

fn place<S: Number>(times: &Times, samples: Vec<S>, claims: &Claims) -> Result<Placed<S>, TimeBaseError> {
    let mut issues = Vec::new();
    let (times_s, mut samples) = match order::ordered((times.each_s, times.rise), samples, &mut issues)? {
        Ordered::Strict(times_s, samples) => (times_s, samples),
        Ordered::Coarse(times_s, samples) => {
            return coarse::place(&times_s, samples, claims, issues);
        }
    };
    let fit = if times.rise { times.fit()? } else { Fit::new(&times_s)? };
    let span_s = times_s[times_s.len() - 1] - times_s[0];
    let own = clock::of_times(1.0 / fit.period_s, fit.resolution_s / span_s);
    let taken = claims.weigh(Some(&own))?;
    let sample_rate_hz = taken.rate_hz;
    issues.extend(taken.issues);
    let non_finite = missing::mark_non_finite_timed(&mut samples, &times_s, &mut issues);
    missing::report_gaps(&fit, &times_s, &mut issues);
    if fit.rms_s > STEADY_PART * fit.period_s && fit.max_s > 0.75 * fit.resolution_s {
        let moved = resample::resample(&times_s, &samples, &fit);
        issues.push(jitter_note(&fit, fit::two_periods(&times_s), &moved.error));
        let gaps = missing::spans(&moved.samples);
        return Ok(Placed {
            start_s: moved.start_s,
            sample_rate_hz,
            samples: moved.samples,
            gaps,
            time_jitter_s: fit.rms_s,
            issues,
        });
    }
    let samples = if fit.runs.len() == 1 { samples } else { missing::spread(&samples, &fit) };
    let gaps = if fit.runs.len() == 1 && non_finite == 0 { Vec::new() } else { missing::spans(&samples) };
    Ok(Placed { start_s: fit.start_s, sample_rate_hz, samples, gaps, time_jitter_s: 0.0, issues })
}

fn jitter_note(fit: &Fit, two_periods_s: Option<(f64, f64)>, error: &resample::Difference) -> Issue {
    /// In intervals: late stamps, with a gap or two that they make up, stay below; a clock 2 % off for a thousand samples is beyond.
    const MOST_LATE: f64 = 2.0;
    let is_late = fit.rms_s > MOST_LATE * fit.period_s;
    let asked = match two_periods_s {
        Some((short_s, long_s)) => format!(
            "; they rise at {:.6} Hz in one part and at {:.6} Hz in another, which is no jitter but a clock that changed its rate: look at \
             the times; where the samples were taken evenly, take the times out in a copy and state sample_rate_hz",
            1.0 / short_s,
            1.0 / long_s
        ),
        None if is_late => "; so far off is no jitter but a clock that ran at another rate for a while, was set or began anew: look at the times".into(),
        None => String::new(),
    };
    let is_jitter = asked.is_empty();
    Issue::new(
        if is_jitter { IssueCode::TimeJitter } else { IssueCode::Clock },
        if is_jitter { Severity::Note } else { Severity::Warning },
        format!(
            "times lie {:.3e} s (RMS, {:.1} % of the sample interval) off a uniform base at {:.6} Hz, {:.3e} s at most; \
             the samples were interpolated onto it. Cubic and linear interpolation differ by {:.2} % of the largest \
             sample RMS, {:.2} % at most, which bounds the error of doing so{asked}",
            fit.rms_s,
            100.0 * fit.rms_s / fit.period_s,
            1.0 / fit.period_s,
            fit.max_s,
            error.rms_percent,
            error.max_percent
        ),
    )
}

#[cfg(test)]
mod tests;
