//! Samples on a uniform base, and the blocks and the numbers that come to one.

use crate::data::{Issue, Samples, Span};

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

/// A contiguous run of samples with its own start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Time of its first sample, s.
    pub start_s: f64,
    /// Number of its samples.
    pub count: usize,
}

/// A sample type that a base can hold.
pub(in crate::ingest) trait Number: Copy {
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
pub(super) struct Placed<S> {
    pub start_s: f64,
    pub sample_rate_hz: f64,
    pub samples: Vec<S>,
    pub gaps: Vec<Span>,
    pub time_jitter_s: f64,
    pub issues: Vec<Issue>,
}

impl<S> Placed<S> {
    pub(super) fn into_uniform(self, wrap: impl FnOnce(Vec<S>) -> Samples) -> Uniform {
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
