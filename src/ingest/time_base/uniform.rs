//! Samples on a uniform base, and the blocks that come to one.

use crate::data::{Finding, Samples, Span};

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
    pub issues: Vec<Finding>,
}

/// A contiguous run of samples with its own start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Time of its first sample, s.
    pub start_s: f64,
    /// Number of its samples.
    pub count: usize,
}
