//! Samples on a uniform base, and the blocks that come to one: where their samples lie among those of all,
//! and which of them are the same.

use super::order::is_same;
use crate::data::{Finding, IssueCode, ListedChannel, Samples, Span};
use crate::numerics::as_f64;
use std::ops::Range;

/// Samples on a uniform base.
#[derive(Debug, Clone, PartialEq)]
pub struct Uniform {
    /// Time of sample 0, in the clock of the times given, s.
    pub start_s: f64,
    /// The earliest and the latest of the times given, s; `None` where there are none.
    pub span_s: Option<(f64, f64)>,
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

impl Uniform {
    /// Adds to a listing when the samples were taken.
    pub(in crate::ingest) fn list(&self, listed: &mut ListedChannel) {
        let has_gap = self.issues.iter().any(|issue| issue.code == IssueCode::Gap);
        let even_s = as_f64(self.samples.len().saturating_sub(1)) / self.sample_rate_hz;
        listed.sample_rate_hz = Some(self.sample_rate_hz);
        listed.start_s = Some(self.span_s.map_or(self.start_s, |(first_s, _)| first_s));
        listed.duration_s = Some(self.span_s.map_or(even_s, |(first_s, last_s)| last_s - first_s));
        listed.gaps = self.span_s.map(|_| if has_gap { self.gaps.len() as u64 } else { 0 });
    }
}

/// A contiguous run of samples with its own start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Time of its first sample, s.
    pub start_s: f64,
    /// Number of its samples.
    pub count: usize,
}

/// A block, its samples a range of those of all blocks.
pub(super) struct Piece {
    pub(super) start_s: f64,
    pub(super) samples: Range<usize>,
    /// The place of its first sample on the base, once it is laid.
    pub(super) place: usize,
}

impl Piece {
    /// The place behind its last sample.
    pub(super) fn end(&self) -> usize {
        self.place + self.samples.len()
    }
}

/// The blocks with the places of their samples among those of all.
pub(super) fn pieces(blocks: &[Block]) -> Vec<Piece> {
    let mut end = 0;
    let piece = |block: &Block| {
        let samples = end..end + block.count;
        end = samples.end;
        Piece { start_s: block.start_s, samples, place: 0 }
    };
    blocks.iter().map(piece).collect()
}

/// Whether two blocks of the same length hold the same of these `samples`.
pub(super) fn are_same(samples: &Samples, one: &Piece, other: &Piece) -> bool {
    is_run(samples, one.samples.start, other.samples.start, one.samples.len())
}

/// Whether so many samples from `one` on are those from `other` on.
fn is_run(samples: &Samples, one: usize, other: usize, count: usize) -> bool {
    one.max(other) + count <= samples.len()
        && (0..count).all(|i| is_same(samples.get(one + i), samples.get(other + i)))
}

/// Whether the first blocks end, at a rate, with the samples that the next begins with: windows that overlap.
pub(super) fn overlaps(samples: &Samples, blocks: &[Block], rate_hz: f64) -> bool {
    const LOOKED_AT: usize = 8;
    let mut end = 0;
    blocks.windows(2).take(LOOKED_AT).all(|pair| {
        let count = pair[0].count;
        end += count;
        let left = as_f64(count) - (pair[1].start_s - pair[0].start_s) * rate_hz;
        let shared = (0..=count.min(pair[1].count)).find(|&n| as_f64(n) >= left - 0.5).unwrap_or(0);
        is_run(samples, end - shared, end, shared)
    })
}
