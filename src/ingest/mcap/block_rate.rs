//! Stamps and lengths of blocks to the rate that they tell, and to whether it bears out a stated one.

use super::column::{RawBlock, seconds_from};
use crate::data::{Issue, IssueCode, Samples, Severity};
use crate::ingest::time_base::{self, RATE_TOLERANCE, TimeBaseError};

/// A declared rate further than this from that of the stamps is no correction of them: computers' clocks and doubled stamps stay below.
pub(super) const FAR: f64 = 0.1;

/// Fewer intervals between blocks agree by chance.
const ENOUGH: usize = 4;

/// A rate this far from that of a few stamps is worth a warning: every velocity is off by as much, and a stamp 1 ms late in blocks of 0.2 s
/// stays below.
const FEW_APART: f64 = 5e-3;

/// A warning where a few blocks are stamped as at another rate than the one that was taken.
pub(super) fn few_blocks(own_hz: f64, taken_hz: f64) -> Option<Issue> {
    ((taken_hz / own_hz - 1.0).abs() > FEW_APART).then(|| {
        let message = format!(
            "its few blocks are stamped as at {own_hz:.1} Hz, and {taken_hz:.1} Hz is stated: samples between them are missing, or the rate is wrong, and every velocity with it"
        );
        Issue::new(IssueCode::Clock, Severity::Warning, message)
    })
}

/// A rate that stamps tell no better than this, as a part of itself, is none: as where single times are coarse.
const UNKNOWN: f64 = 1e-2;

/// What the stamps of blocks say.
pub(super) struct Derived {
    pub(super) rate_hz: f64,
    /// The samples of each block and the seconds to the next stamp.
    intervals: Vec<(f64, f64)>,
    /// Nine of ten intervals say the same to [`FAR`]: the stamps are those of the samples, not of a writer that hurries after them.
    pub(super) is_steady: bool,
    /// What the stamps are cut to, where intervals of equal blocks differ by it, s; else 0.
    cut_s: f64,
    span_s: f64,
}

impl Derived {
    /// Length over time to the next of neighbouring blocks: the median tells which follow one another, a line through their stamps the rate.
    pub(super) fn of(blocks: &[RawBlock]) -> Option<Self> {
        let mut order: Vec<(i64, usize)> = blocks.iter().map(|block| (block.time_ns, block.count)).collect();
        order.sort_unstable();
        order.dedup_by_key(|(time_ns, _)| *time_ns);
        let (first, last) = (order.first()?, order.last()?);
        let span_s = seconds_from(last.0, first.0);
        let intervals: Vec<(f64, f64)> = order
            .iter()
            .zip(order.iter().skip(1))
            .map(|((from, length), (to, _))| (as_f64(*length), seconds_from(*to, *from)))
            .collect();
        let usual_hz = time_base::usual_hz(&intervals)?;
        // Where all follow one another; else gaps are left out.
        let line_hz = through(&intervals, None);
        let cut_at = |hz: f64| time_base::cut(&intervals, hz).map(|cut| (cut, hz));
        let cut = cut_at(line_hz).filter(|(cut, _)| cut.is_whole).or_else(|| {
            let line_hz = through(&intervals, Some(through(&intervals, Some(usual_hz))));
            cut_at(line_hz)
        });
        let cut_s = cut.map_or(0.0, |(cut, _)| cut.unit_s);
        // A line through stamps that are even adds but its round-off.
        let rate_hz = cut.map_or(usual_hz, |(_, line_hz)| line_hz);
        let is_alike = |(length, s): &&(f64, f64)| {
            (length / s / rate_hz - 1.0).abs() < FAR || (length / rate_hz - s).abs() <= cut_s
        };
        let alike = intervals.iter().filter(is_alike).count();
        let is_steady = intervals.len() >= ENOUGH && 10 * alike >= 9 * intervals.len();
        Some(Self { rate_hz, intervals, is_steady, cut_s, span_s })
    }

    /// Whether a rate in Hz puts the blocks one behind another but for what their stamps are cut to.
    pub(super) fn is_explained_by(&self, rate_hz: f64) -> bool {
        time_base::cut(&self.intervals, rate_hz).is_some_and(|cut| cut.is_whole)
    }

    /// Whether steady stamps, fine enough to do so, tell the rate in Hz.
    pub(super) fn bears_out(&self, rate_hz: f64) -> bool {
        self.is_steady
            && (rate_hz / self.rate_hz - 1.0).abs() <= RATE_TOLERANCE
            && self.doubt() <= RATE_TOLERANCE
    }

    /// How far the rate of cut stamps may be off, as a part of it.
    ///
    /// A line through n stamps, each off by up to half a cut (uniform), has a slope of this standard deviation; twice it.
    fn doubt(&self) -> f64 {
        2.0 * self.cut_s / (self.span_s * as_f64(self.intervals.len() + 1).sqrt())
    }

    /// Whether so few blocks say it that a rate which contradicts them looks like samples that are missing.
    pub(super) fn is_few(&self) -> bool {
        self.intervals.len() < ENOUGH
    }

    /// The rate that the messages state and that of their steady stamps, where it is another by far.
    ///
    /// Blocks that cover the beginning of the next with the same samples are windows that overlap.
    pub(super) fn contradiction(&self, blocks: &[RawBlock], samples: &Samples) -> Option<(f64, f64)> {
        let stated_hz = blocks.first()?.rate_hz.filter(|hz| hz.is_finite() && *hz > 0.0)?;
        let is_far = (stated_hz / self.rate_hz - 1.0).abs() > FAR;
        let is_window = stated_hz < self.rate_hz && overlap(blocks, samples, stated_hz);
        (self.is_steady && is_far && !is_window && !self.is_explained_by(stated_hz))
            .then_some((stated_hz, self.rate_hz))
    }

    /// A warning where an interval is longer than the usual by just what stamps may be cut to: a block is lost, or the rate is another.
    fn is_lost_or_cut(&self) -> Option<Issue> {
        let unit_s =
            time_base::unit_s(&self.intervals, self.rate_hz).filter(|unit_s| *unit_s <= COARSEST_S)?;
        let longer_s = |(length, s): &(f64, f64)| s - length / self.rate_hz;
        let is_it = |interval: &(f64, f64)| ((longer_s(interval) - unit_s) * self.rate_hz).abs() < 0.5;
        self.intervals.iter().any(is_it).then(|| {
            let message = format!(
                "a stamp comes {unit_s} s late, which all stamps are multiples of: samples are missing there, or the stamps are cut to that and \
                 {:.1} Hz, had from them, is off by up to {:.1} %: give sample_rate_hz for this channel",
                self.rate_hz,
                100.0 * unit_s / self.span_s
            );
            Issue::new(IssueCode::Clock, Severity::Warning, message)
        })
    }

    /// A warning where equal blocks are stamped evenly on so coarse a grid that blocks of another length would be, and their rate is an odd one.
    ///
    /// Over n intervals stamps that are cut stay even as long as they run off by less than a cut in all.
    fn is_on_grid(&self) -> Option<Issue> {
        // All multiples of a longer one are multiples of one of these.
        let widest_s = time_base::unit_s(&self.intervals, self.rate_hz)?;
        let is_multiple = |unit_s: &f64| (widest_s / unit_s - (widest_s / unit_s).round()).abs() < 1e-6;
        let unit_s = [COARSEST_S, 0.5 * COARSEST_S].into_iter().find(is_multiple).unwrap_or(widest_s);
        let part = unit_s / self.span_s;
        let first = self.intervals.first()?;
        let are_equal = self.intervals.iter().all(|(length, _)| length.total_cmp(&first.0).is_eq());
        (are_equal && part > RATE_TOLERANCE && !is_usual(self.rate_hz)).then(|| {
            let message = format!(
                "all stamps are multiples of {unit_s} s: if they are cut to that, {:.1} Hz, had from them, is off by up to {:.1} %: \
                 give sample_rate_hz for this channel",
                self.rate_hz,
                100.0 * part
            );
            Issue::new(IssueCode::Clock, Severity::Warning, message)
        })
    }

    /// How well cut stamps tell the rate: a warning beyond what clocks are apart.
    ///
    /// # Errors
    /// They tell it to no better than 1 %.
    pub(super) fn resolution(&self, samples: usize) -> Result<Option<Issue>, TimeBaseError> {
        if self.cut_s == 0.0 {
            return Ok(self.is_lost_or_cut().or_else(|| self.is_on_grid()));
        }
        let part = self.doubt();
        if part > UNKNOWN {
            return Err(TimeBaseError::TooCoarse {
                step_s: self.cut_s,
                changes: self.intervals.len(),
                count: samples,
            });
        }
        Ok((part > RATE_TOLERANCE).then(|| {
            let message = format!(
                "the blocks' stamps are cut to {} s and tell their rate to ± {:.2} %: give sample_rate_hz for this channel",
                self.cut_s,
                100.0 * part
            );
            Issue::new(IssueCode::Clock, Severity::Warning, message)
        }))
    }
}

/// Stamps are cut to this at the coarsest, s: the tick of a computer's clock.
const COARSEST_S: f64 = 0.02;

/// Whether a rate has one or two digits and no prime factors but 2 and 5, as 40 and 64 kHz: stamps that are cut make one by chance only.
///
/// Not 51.2 and 102.4 kHz: blocks of 1024 at 100 kHz, stamped to 10 ms, look like it.
fn is_usual(rate_hz: f64) -> bool {
    const DIGITS: [f64; 9] = [10.0, 16.0, 20.0, 25.0, 32.0, 40.0, 50.0, 64.0, 80.0];
    let digits = 10.0 * rate_hz / 10_f64.powf(rate_hz.log10().floor());
    DIGITS.iter().any(|usual| (digits / usual - 1.0).abs() < 1e-9)
}

/// The rate of a line through the stamps, where blocks all follow one another, or as at about `rate_hz` or leave a gap between.
fn through(intervals: &[(f64, f64)], rate_hz: Option<f64>) -> f64 {
    let (mut place, mut time_s) = (0.0, 0.0);
    let mut points = vec![(0.0, 0.0)];
    for (length, interval_s) in intervals {
        let steps = rate_hz.map_or(*length, |rate_hz| interval_s * rate_hz);
        place += if (steps - length).abs() < 0.5 * length { *length } else { steps };
        time_s += interval_s;
        points.push((place, time_s));
    }
    let n = as_f64(points.len());
    let mean = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / n, sum.1 + point.1 / n));
    let (square, cross) = points.iter().fold((0.0, 0.0), |sum, point| {
        let (x, y) = (point.0 - mean.0, point.1 - mean.1);
        (sum.0 + x * x, sum.1 + x * y)
    });
    if cross > 0.0 { square / cross } else { rate_hz.unwrap_or(1.0) }
}

/// Whether the first blocks end, at that rate, with the samples that the next begins with.
fn overlap(blocks: &[RawBlock], samples: &Samples, rate_hz: f64) -> bool {
    const LOOKED_AT: usize = 8;
    let mut end = 0;
    blocks.windows(2).take(LOOKED_AT).all(|pair| {
        let (count, next) = (pair[0].count, pair[1].count);
        end += count;
        let steps = seconds_from(pair[1].time_ns, pair[0].time_ns) * rate_hz;
        let shared = (0..=count.min(next)).find(|&n| steps + as_f64(n) >= as_f64(count) - 0.5).unwrap_or(0);
        (0..shared).all(|i| samples.get(end - shared + i).total_cmp(&samples.get(end + i)).is_eq())
    })
}

#[allow(clippy::cast_precision_loss, reason = "lengths and counts of blocks are far below 2^53")]
fn as_f64(count: usize) -> f64 {
    count as f64
}
