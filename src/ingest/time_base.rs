//! Recorded times and samples to one uniform base, with the error of doing so known.

mod block_rate;
mod blocks;
mod coarse;
mod error;
mod fit;
mod missing;
mod order;
mod pieces;
mod resample;
mod stamps;
mod uniform;

pub(super) use block_rate::{PREFIX, lay as lay_blocks, place as place_blocks};
pub use blocks::from_blocks;
pub use error::TimeBaseError;
use error::check_rate;
pub(super) use pieces::Content;
pub use uniform::{Block, Uniform};

use super::clock::{self, Claims, Taken};
use crate::data::{Finding, Jitter, Samples, TimesFinding};
use fit::Fit;
use order::Ordered;
use std::sync::OnceLock;
pub(super) use uniform::Number;
use uniform::Placed;

/// Times that lie nearer to the base than this part of the sample interval (RMS) leave their samples where they are: at
/// 2 % a sine of a tenth of the sample rate is off by 1 % of itself at most, a tenth of what its sampling costs.
const STEADY_PART: f64 = 0.02;

/// What rounding is believed to do to the rate of times at most, as a part of it: three times in whole hundredths of a second tell none.
const MOST_ROUNDING: f64 = 1e-2;

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
    pub fn place(&self, samples: Samples, claims: &Claims) -> Result<Uniform, TimeBaseError> {
        if self.each_s.len() != samples.len() {
            return Err(TimeBaseError::Lengths { times: self.each_s.len(), samples: samples.len() });
        }
        claims.cask_hz.map_or(Ok(()), check_rate)?;
        match samples {
            Samples::F32(v) => Ok(place(self, v, claims)?.into_uniform(Samples::F32)),
            Samples::F64(v) => Ok(place(self, v, claims)?.into_uniform(Samples::F64)),
        }
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
    Times::new(times_s).place(samples, &Claims::of_cask(declared_rate_hz))
}

/// Samples without times, at the rate that is claimed.
///
/// # Errors
/// As [`from_rate`]; [`TimeBaseError::Refused`] where none is stated, or two that contradict each other.
pub fn from_claims(start_s: f64, claims: &Claims, samples: Samples) -> Result<Uniform, TimeBaseError> {
    at_taken(start_s, claims.weigh(None)?, samples)
}

/// Samples at the rate that was taken, with what contradicts it.
pub(super) fn at_taken(start_s: f64, taken: Taken, samples: Samples) -> Result<Uniform, TimeBaseError> {
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
    uniform.gaps = match &mut uniform.samples {
        Samples::F32(v) => missing::mark_non_finite(v, 0, clock, &mut uniform.issues),
        Samples::F64(v) => missing::mark_non_finite(v, 0, clock, &mut uniform.issues),
    };
    Ok(uniform)
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
    let rounding = (fit.resolution_s / span_s).min(MOST_ROUNDING);
    let own = clock::of_times(1.0 / fit.period_s, rounding);
    let taken = claims.weigh(Some(&own))?;
    let sample_rate_hz = taken.rate_hz;
    issues.extend(taken.issues);
    let non_finite = missing::mark_non_finite_timed(&mut samples, &times_s, &mut issues);
    missing::report_gaps(&fit, &times_s, &mut issues);
    if fit.rms_s > STEADY_PART * fit.period_s && fit.max_s > 0.75 * fit.resolution_s {
        let moved = resample::resample(&times_s, &samples, &fit);
        issues.push(jitter(&fit, fit::two_periods(&times_s), &moved.error));
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

fn jitter(fit: &Fit, two_periods_s: Option<(f64, f64)>, error: &resample::Difference) -> Finding {
    let resample::Difference { rms_percent, max_percent } = *error;
    let rates_hz = two_periods_s.map(|(short_s, long_s)| (1.0 / short_s, 1.0 / long_s));
    let &Fit { period_s, rms_s, max_s, .. } = fit;
    TimesFinding::Jitter(Jitter { period_s, rms_s, max_s, rms_percent, max_percent, rates_hz }).into()
}

#[cfg(test)]
mod tests;
