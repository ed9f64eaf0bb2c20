//! Why times give no uniform base.

use crate::ingest::refusal::Refusal;
use crate::ingest::shown::{digits, short};

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
    /// Times repeat so often, and change so seldom or unevenly, that they do not tell when a sample was
    /// taken.
    #[error(
        "the times are cut to {} s: {count} samples share {} times that are too few or too uneven to tell \
         their rate; \
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
        "times jump from {} s to {} s, which would be {lost:.3e} samples at {} Hz: no gap of one record; \
         check the clock, \
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
        Ok(())
    } else {
        Err(TimeBaseError::Rate { sample_rate_hz })
    }
}
