//! Blocks shorter than what their stamps are cut to, which share stamps, to blocks one behind another.

use super::column::{RawBlock, seconds_from};
use crate::data::{Issue, IssueCode, Samples, Severity};
use crate::ingest::time_base;

/// From one message of so many on that carries the stamp of the one before the stamps are too coarse, rather than blocks sent again.
const SHARED_OF: usize = 10;

/// Messages that carry the stamp of the one before, though their samples differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shared {
    /// How many do.
    count: usize,
    /// Of how many.
    of: usize,
}

impl std::fmt::Display for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { count, of } = self;
        write!(
            f,
            "{count} of {of} messages carry the same stamp as the one before though their samples differ: the stamps are coarser than a block is long"
        )
    }
}

impl Shared {
    /// `None` where few do.
    pub(super) fn of(blocks: &[RawBlock], samples: &Samples) -> Option<Self> {
        let mut end = 0;
        let differ = |pair: &&[RawBlock]| {
            let (from, to) = (end, end + pair[0].count);
            end = to;
            pair[0].time_ns == pair[1].time_ns
                && (pair[0].count != pair[1].count
                    || (0..pair[1].count)
                        .any(|i| samples.get(from + i).total_cmp(&samples.get(to + i)).is_ne()))
        };
        let count = blocks.windows(2).filter(differ).count();
        (SHARED_OF * count > blocks.len()).then_some(Self { count, of: blocks.len() })
    }

    /// Stamps for blocks one behind another at a rate in Hz, in the order of the file, and a warning; `None` where those there do not bear it out.
    ///
    /// They do where each lies less than one cut before its block: a block that is lost, or another rate, leaves that soon. They do not
    /// where they fit better without the blocks that share one, as where those were sent twice.
    pub(super) fn laid(self, blocks: &[RawBlock], rate_hz: f64) -> Option<(Vec<i64>, Issue)> {
        let first = blocks.first()?;
        let intervals: Vec<(f64, f64)> = blocks
            .windows(2)
            .map(|pair| (as_f64(pair[0].count), seconds_from(pair[1].time_ns, pair[0].time_ns)))
            .collect();
        let cut_s = time_base::unit_s(&intervals, rate_hz)?;
        let (mut place, mut alone, mut off_s, mut off_alone_s) =
            (0.0, 0.0, Spread::default(), Spread::default());
        for (block, (length, interval_s)) in blocks.iter().zip(intervals.iter().chain([&(0.0, 1.0)])) {
            let stamp_s = seconds_from(block.time_ns, first.time_ns);
            off_s.add(stamp_s - place / rate_hz);
            off_alone_s.add(stamp_s - alone / rate_hz);
            place += length;
            alone += if *interval_s > 0.0 { *length } else { 0.0 };
        }
        let is_even = off_s.width() <= cut_s + 0.5 / rate_hz && off_s.width() < off_alone_s.width();
        if !is_even || intervals.iter().any(|interval| interval.1 < 0.0) {
            return None;
        }
        let start_s = 0.5 * (off_s.low + off_s.high + cut_s);
        let mut place = 0.0;
        let stamps = blocks.iter().map(|block| {
            let stamp_ns = first.time_ns + nanoseconds(start_s + place / rate_hz);
            place += as_f64(block.count);
            stamp_ns
        });
        let message = format!(
            "{self}, cut to {cut_s} s; at {rate_hz} Hz they bear out blocks one behind another, as which they were taken, but for one lost at either \
             end, and a rate off by up to {:.1} %: have the recorder stamp finer",
            100.0 * cut_s * rate_hz / place_of_all(blocks)
        );
        Some((stamps.collect(), Issue::new(IssueCode::Clock, Severity::Warning, message)))
    }
}

/// The least and the largest of some numbers.
#[derive(Default)]
struct Spread {
    low: f64,
    high: f64,
}

impl Spread {
    fn add(&mut self, s: f64) {
        (self.low, self.high) = (self.low.min(s), self.high.max(s));
    }

    fn width(&self) -> f64 {
        self.high - self.low
    }
}

fn place_of_all(blocks: &[RawBlock]) -> f64 {
    as_f64(blocks.iter().map(|block| block.count).sum())
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a float-to-integer cast saturates; times of a recording fit"
)]
fn nanoseconds(time_s: f64) -> i64 {
    (time_s * 1e9).round() as i64
}

#[allow(clippy::cast_precision_loss, reason = "lengths and counts of blocks are far below 2^53")]
fn as_f64(count: usize) -> f64 {
    count as f64
}
