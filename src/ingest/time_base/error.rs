//! Why times give no uniform base.

use crate::ingest::refusal::Refusal;
use crate::ingest::shown::show;

/// That so many samples are too few.
pub(super) fn too_few(count: usize) -> Refusal {
    Refusal::new(
        format!("{count} sample(s) make no record: at least two are needed"),
        "name the source that holds the samples, or take this [[channel]] out of the cask file",
    )
}

/// Whether a rate is above zero and finite.
pub(super) fn check_rate(sample_rate_hz: f64) -> Result<(), Refusal> {
    if sample_rate_hz.is_finite() && sample_rate_hz > 0.0 {
        return Ok(());
    }
    let problem = format!("the sample rate is {sample_rate_hz} Hz: it must be above zero");
    Err(Refusal::new(problem, "write the true `sample_rate_hz` in this channel of the cask file"))
}

/// That there are not as many times as samples, where there are not.
pub(crate) fn check_lengths(times: usize, samples: usize) -> Result<(), Refusal> {
    if times == samples {
        return Ok(());
    }
    Err(Refusal::new(
        format!("there are {times} times but {samples} samples: each sample needs one time of its own"),
        "name the times of these samples (`time`), or give sample_rate_hz",
    ))
}

/// That a time, by its number from 1, is NaN or infinite.
pub(super) fn not_finite(number: usize, time_s: f64) -> Refusal {
    let problem = format!("time number {number} is {time_s}, which is no time");
    Refusal::new(problem, "remove that row in a copy, or name another source of times (`time`)")
}

/// That times jump so far that filling the gap, so many samples at the rate of the rest, would not fit in
/// memory.
pub(super) fn jump(from_s: f64, to_s: f64, lost: f64, rate_hz: f64) -> Refusal {
    let [from_s, to_s, rate_hz] = [from_s, to_s, rate_hz].map(show);
    let problem = format!(
        "times jump from {from_s} s to {to_s} s, which would be {lost:.3e} samples at {rate_hz} Hz: no gap \
         of one record"
    );
    Refusal::new(problem, "check the clock, or cut the recording there in a copy")
}
