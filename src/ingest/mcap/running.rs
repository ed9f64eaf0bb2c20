//! A stream of times and samples to what a listing says of it, in little memory.

use super::column::seconds_from;
use crate::data::Samples;

/// So many intervals settle what an interval is; enough to outvote a gap among them.
const FIRST_INTERVALS: usize = 64;
/// So many blocks are remembered with their times; beyond, gaps are no longer counted and memory stays small.
pub(super) const MOST_SEGMENTS: usize = 100_000;
/// An interval longer than this many usual ones is a gap.
const GAP_INTERVALS: f64 = 1.5;

/// Counts, range and times of the samples seen so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Running {
    pub(super) samples: u64,
    range: Option<(f64, f64)>,
    first_ns: i64,
    last_ns: i64,
    intervals: [f64; FIRST_INTERVALS],
    interval_count: usize,
    usual_s: f64,
    regular_s: f64,
    regular_count: u64,
    gaps: u64,
    blocks: usize,
}

/// A block's time, length and stated rate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    pub(super) start_ns: i64,
    pub(super) count: u64,
    pub(super) rate_hz: Option<f64>,
}

/// Times, as a listing shows them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Timing {
    pub(super) sample_rate_hz: Option<f64>,
    pub(super) duration_s: Option<f64>,
    pub(super) gaps: Option<u64>,
}

impl Default for Running {
    fn default() -> Self {
        Self {
            samples: 0,
            range: None,
            first_ns: i64::MAX,
            last_ns: i64::MIN,
            intervals: [0.0; FIRST_INTERVALS],
            interval_count: 0,
            usual_s: 0.0,
            regular_s: 0.0,
            regular_count: 0,
            gaps: 0,
            blocks: 0,
        }
    }
}

impl Running {
    /// One sample at its own time.
    pub(super) fn number(&mut self, time_ns: i64, value: f64) {
        if self.samples > 0 && time_ns > self.last_ns {
            self.interval(seconds_from(time_ns, self.last_ns));
        }
        self.samples += 1;
        self.see_time(time_ns);
        self.see(value);
    }

    /// A block that begins at `time_ns`.
    pub(super) fn block(&mut self, time_ns: i64, samples: &Samples) {
        self.blocks += 1;
        self.samples += samples.len() as u64;
        self.see_time(time_ns);
        match samples {
            Samples::F32(samples) => samples.iter().for_each(|&value| self.see(f64::from(value))),
            Samples::F64(samples) => samples.iter().for_each(|&value| self.see(value)),
        }
    }

    /// Smallest and largest finite sample.
    pub(super) fn range(&self) -> Option<(f64, f64)> {
        self.range
    }

    /// The earliest time, ns since 1970.
    pub(super) fn first_ns(&self) -> Option<i64> {
        (self.samples > 0).then_some(self.first_ns)
    }

    /// Rate, duration and gaps; `segments` are the blocks, where the samples came in blocks.
    pub(super) fn timing(mut self, segments: &[Segment]) -> Timing {
        if self.blocks > segments.len() {
            let duration_s = Some(seconds_from(self.last_ns, self.first_ns));
            return Timing { duration_s, gaps: None, ..block_timing(segments) };
        }
        if self.blocks > 0 {
            return block_timing(segments);
        }
        if self.samples < 2 {
            return Timing::default();
        }
        if self.interval_count < FIRST_INTERVALS {
            self.settle();
        }
        #[allow(clippy::cast_precision_loss, reason = "counts stay below 2^53")]
        let rate_hz = self.regular_count as f64 / self.regular_s;
        Timing {
            sample_rate_hz: rate_hz.is_finite().then_some(rate_hz),
            duration_s: Some(seconds_from(self.last_ns, self.first_ns)),
            gaps: Some(self.gaps),
        }
    }

    fn see_time(&mut self, time_ns: i64) {
        self.first_ns = self.first_ns.min(time_ns);
        self.last_ns = self.last_ns.max(time_ns);
    }

    fn see(&mut self, value: f64) {
        if value.is_finite() {
            self.range =
                Some(self.range.map_or((value, value), |(low, high)| (low.min(value), high.max(value))));
        }
    }

    fn interval(&mut self, interval_s: f64) {
        if self.interval_count < FIRST_INTERVALS {
            if let Some(place) = self.intervals.get_mut(self.interval_count) {
                *place = interval_s;
            }
            self.interval_count += 1;
            if self.interval_count == FIRST_INTERVALS {
                self.settle();
            }
        } else {
            self.judge(interval_s);
        }
    }

    /// Takes the median of the first intervals as the usual one and judges them by it.
    fn settle(&mut self) {
        let mut first = self.intervals;
        let Some(seen) = first.get_mut(..self.interval_count) else { return };
        seen.sort_unstable_by(f64::total_cmp);
        self.usual_s = seen.get(seen.len() / 2).copied().unwrap_or(0.0);
        for interval_s in self.intervals.into_iter().take(self.interval_count) {
            self.judge(interval_s);
        }
    }

    fn judge(&mut self, interval_s: f64) {
        if interval_s > GAP_INTERVALS * self.usual_s {
            self.gaps += 1;
        } else {
            self.regular_s += interval_s;
            self.regular_count += 1;
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "block lengths stay below 2^53")]
fn block_timing(segments: &[Segment]) -> Timing {
    let mut order = segments.to_vec();
    order.sort_by_key(|segment| segment.start_ns);
    order.dedup_by_key(|segment| segment.start_ns);
    let mut derived_hz: Vec<f64> = order
        .windows(2)
        .filter_map(|pair| match pair {
            [a, b] => Some(a.count as f64 / seconds_from(b.start_ns, a.start_ns)),
            _ => None,
        })
        .collect();
    derived_hz.sort_unstable_by(f64::total_cmp);
    let stated_hz =
        order.iter().find_map(|segment| segment.rate_hz).filter(|rate| rate.is_finite() && *rate > 0.0);
    let Some(rate_hz) = stated_hz.or_else(|| derived_hz.get(derived_hz.len() / 2).copied()) else {
        return Timing::default();
    };
    let end_s =
        |segment: &Segment, zero_ns| seconds_from(segment.start_ns, zero_ns) + segment.count as f64 / rate_hz;
    let gaps = order
        .windows(2)
        .filter(|pair| match pair {
            // From the last sample of one to the first of the next.
            [a, b] => {
                seconds_from(b.start_ns, a.start_ns) - (a.count as f64 - 1.0) / rate_hz
                    > GAP_INTERVALS / rate_hz
            }
            _ => false,
        })
        .count();
    let duration_s = order.first().map(|first| {
        order.iter().map(|segment| end_s(segment, first.start_ns)).fold(0.0, f64::max) - 1.0 / rate_hz
    });
    Timing { sample_rate_hz: Some(rate_hz), duration_s, gaps: Some(gaps as u64) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_one_gap_keep_their_rate() {
        let mut running = Running::default();
        for i in (0..100).chain(120..300_i32) {
            running.number(1_700_000_000_000_000_000 + i64::from(i) * 1_000_000, f64::from(i));
        }
        let timing = running.timing(&[]);
        // Intervals of exactly 1 ms: rounding alone is left.
        assert!((timing.sample_rate_hz.unwrap() - 1000.0).abs() < 1e-6);
        assert_eq!((timing.gaps, running.range()), (Some(1), Some((0.0, 299.0))));
        assert!((timing.duration_s.unwrap() - 0.299).abs() < 1e-12);
    }

    #[test]
    fn blocks_out_of_order_are_no_gap_and_a_missing_one_is() {
        let segment = |start_ms: i64| Segment { start_ns: start_ms * 1_000_000, count: 10, rate_hz: None };
        let timing = block_timing(&[0, 20, 10, 30, 60].map(segment));
        assert!((timing.sample_rate_hz.unwrap() - 1000.0).abs() < 1e-9);
        assert_eq!(timing.gaps, Some(1));
        assert!((timing.duration_s.unwrap() - 0.069).abs() < 1e-12);
    }
}
