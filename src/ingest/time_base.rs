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

pub(super) use block_rate::place as place_blocks;
pub use blocks::from_blocks;
pub(super) use error::check_lengths;
use error::check_rate;
pub use pieces::{Block, Uniform};
pub(super) use stamps::line;

use super::clock::{self, Claims, Taken};
use super::refusal::Refusal;
use crate::data::{Samples, TimesFinding};
use crate::numerics::{as_f64, extent};
use fit::BaseFit;
use order::Ordered;
use std::sync::OnceLock;

/// Times that lie nearer to the base than this part of the sample interval (RMS) leave their samples where
/// they are: at 2 % a sine of a tenth of the sample rate is off by 1 % of itself at most, a tenth of what its
/// sampling costs.
const STEADY_PART: f64 = 0.02;

/// What rounding is believed to do to the rate of times at most, as a part of it: three times in whole
/// hundredths of a second tell none.
const MOST_ROUNDING: f64 = 1e-2;

/// Times that several channels may share; what they say of a base is found once.
pub struct ChannelTimes<'a> {
    each_s: &'a [f64],
    rise: bool,
    fit: OnceLock<Result<BaseFit, Refusal>>,
}

impl<'a> ChannelTimes<'a> {
    /// One time a sample, s.
    #[must_use]
    pub fn new(times_s: &'a [f64]) -> Self {
        Self { each_s: times_s, rise: order::rise(times_s), fit: OnceLock::new() }
    }

    /// Samples with a time each on a uniform base: sorted, doubles dropped, gaps NaN, real jitter
    /// interpolated.
    ///
    /// The rate is the one that [`Claims::weigh`] takes; gaps are counted at the times' own rate.
    ///
    /// # Errors
    /// [`Refusal`] where the times make no record.
    pub fn place(&self, samples: Samples, claims: &Claims) -> Result<Uniform, Refusal> {
        check_lengths(self.each_s.len(), samples.len())?;
        claims.cask_hz.map_or(Ok(()), check_rate)?;
        let mut issues = Vec::new();
        let Ordered { times_s, mut samples, is_coarse } =
            order::ordered(self.each_s, self.rise, samples, &mut issues)?;
        if is_coarse {
            let placed = coarse::place(&times_s, samples, claims, issues)?;
            return Ok(Uniform { span_s: Some(self.span_s()), ..placed });
        }
        let fit = if self.rise { self.fit()? } else { BaseFit::new(&times_s)? };
        let span_s = times_s[times_s.len() - 1] - times_s[0];
        let rounding = (fit.resolution_s / span_s).min(MOST_ROUNDING);
        let own = clock::of_times(1.0 / fit.period_s, rounding);
        let Taken { rate_hz: sample_rate_hz, issues: of_rate, .. } = claims.weigh(Some(&own))?;
        issues.extend(of_rate);
        let mut gaps = missing::mark(&mut samples, 0, |i| times_s[i], &mut issues);
        missing::report_gaps(&fit, &times_s, &mut issues);
        let (mut start_s, mut time_jitter_s) = (fit.start_s, 0.0);
        if fit.rms_s > STEADY_PART * fit.period_s && fit.max_s > 0.75 * fit.resolution_s {
            let moved = resample::resample(&times_s, &samples, &fit);
            issues.push(TimesFinding::Jitter(moved.jitter).into());
            (start_s, time_jitter_s, samples) = (moved.start_s, fit.rms_s, moved.samples);
            gaps = missing::spans(&samples);
        } else if fit.runs.len() > 1 {
            samples = missing::spread(&samples, &fit);
            gaps = missing::spans(&samples);
        }
        let span_s = Some(self.span_s());
        Ok(Uniform { start_s, span_s, sample_rate_hz, samples, gaps, time_jitter_s, issues })
    }

    /// The earliest and the latest of the times, s.
    fn span_s(&self) -> (f64, f64) {
        match self.each_s {
            [first_s, .., last_s] if self.rise => (*first_s, *last_s),
            each_s => extent(each_s.iter().copied()),
        }
    }

    /// The base nearest to the times as they stand, where they rise.
    fn fit(&self) -> Result<BaseFit, Refusal> {
        self.fit.get_or_init(|| BaseFit::new(self.each_s)).clone()
    }
}

/// [`ChannelTimes::place`] of a single channel.
///
/// # Errors
/// As that.
pub fn from_times(
    times_s: &[f64],
    samples: Samples,
    declared_rate_hz: Option<f64>,
) -> Result<Uniform, Refusal> {
    ChannelTimes::new(times_s).place(samples, &Claims::of_cask(declared_rate_hz))
}

/// Samples without times, at the rate that is claimed.
///
/// # Errors
/// Where samples or times make no record, where no rate is stated, or two that contradict each other.
pub fn from_claims(start_s: f64, claims: &Claims, samples: Samples) -> Result<Uniform, Refusal> {
    at_taken(start_s, claims.weigh(None)?, samples)
}

/// Samples at the rate that was taken, with what contradicts it: only non-finite ones are looked for.
///
/// # Errors
/// [`Refusal`] where there are fewer than two samples or the rate is none.
pub(super) fn at_taken(start_s: f64, taken: Taken, mut samples: Samples) -> Result<Uniform, Refusal> {
    let sample_rate_hz = taken.rate_hz;
    check_rate(sample_rate_hz)?;
    if samples.len() < 2 {
        return Err(error::too_few(samples.len()));
    }
    if !start_s.is_finite() {
        return Err(error::not_finite(1, start_s));
    }
    let mut issues = Vec::new();
    let gaps = missing::mark(&mut samples, 0, |i| start_s + as_f64(i) / sample_rate_hz, &mut issues);
    issues.extend(taken.issues);
    Ok(Uniform { start_s, span_s: None, sample_rate_hz, samples, gaps, time_jitter_s: 0.0, issues })
}

#[cfg(test)]
mod tests;
