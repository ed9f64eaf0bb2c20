//! Why times give no uniform base.

use crate::ingest::refusal::Refusal;
use crate::ingest::shown::short;

/// Why times give no uniform base.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TimeBaseError {
    /// There are fewer than two samples.
    #[error("{count} sample(s) make no record: at least two are needed")]
    TooFew {
        /// How many there are.
        count: usize,
    },
    /// Times, samples or a rate that make no record, in words.
    #[error("{0}")]
    Told(String),
    /// Nothing states a rate, or rates contradict each other.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

impl TimeBaseError {
    /// What is wrong with its own remedy where it has one, else with this.
    pub(crate) fn refusal(self, remedy: &str) -> Refusal {
        match self {
            Self::Refused(refusal) => refusal,
            other => Refusal::new(other.to_string(), remedy),
        }
    }
}

/// Whether a rate is above zero and finite.
pub(super) fn check_rate(sample_rate_hz: f64) -> Result<(), TimeBaseError> {
    if sample_rate_hz.is_finite() && sample_rate_hz > 0.0 {
        return Ok(());
    }
    Err(TimeBaseError::Told(format!(
        "the sample rate is {sample_rate_hz} Hz: it must be above zero; set sample_rate_hz in the cask file"
    )))
}

/// That there are not as many times as samples, where there are not.
pub(in crate::ingest) fn check_lengths(times: usize, samples: usize) -> Result<(), TimeBaseError> {
    if times == samples {
        return Ok(());
    }
    let problem =
        format!("there are {times} times but {samples} samples: each sample needs one time of its own");
    Err(TimeBaseError::Told(problem))
}

/// That a time, by its number from 1, is NaN or infinite.
pub(super) fn not_finite(number: usize, time_s: f64) -> TimeBaseError {
    TimeBaseError::Told(format!(
        "time number {number} is {time_s}, which is no time: remove that row or name another time source"
    ))
}

/// That times jump so far that filling the gap, so many samples at the rate of the rest, would not fit in
/// memory.
pub(super) fn jump(from_s: f64, to_s: f64, lost: f64, rate_hz: f64) -> TimeBaseError {
    let [from_s, to_s, rate_hz] = [from_s, to_s, rate_hz].map(short);
    TimeBaseError::Told(format!(
        "times jump from {from_s} s to {to_s} s, which would be {lost:.3e} samples at {rate_hz} Hz: no gap \
         of one record; check the clock, or cut the recording there"
    ))
}
