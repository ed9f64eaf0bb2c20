//! Stamps of blocks to the rate that they tell, and to what they are cut to, where that shows.

use super::pieces::Block;
use crate::ingest::clock::RATE_TOLERANCE;
use crate::ingest::shown::to_digits;
use crate::numerics::{as_f64, robust};

/// Stamps are held as s from the first, with more digits than this part of what they are cut to.
pub(super) const ROUND_OFF: f64 = 1e-4;

/// Fewer intervals differ where samples are lost here and there.
const SHOWN: usize = 3;

/// How far, in cuts, the stamps may lie about even ones: one, and what the slope of a line through a few tens
/// of them leaves.
const WIDEST: f64 = 1.5;

/// Fewer intervals between blocks agree by chance.
const ENOUGH: usize = 4;

/// A block and the stamp of the next.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval {
    /// Samples of the block.
    pub(super) length: f64,
    /// From its stamp to the next, s.
    pub(super) s: f64,
}

/// The intervals between stamps that rise.
pub(super) struct Intervals(pub(super) Vec<Interval>);

/// What stamps are cut to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StampCut {
    /// In s.
    pub(super) unit_s: f64,
    /// Whether it explains every interval, so that nothing is lost between blocks.
    pub(super) is_whole: bool,
}

/// The rate that stamps tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Told {
    pub(super) rate_hz: f64,
    /// How far it may be off, as a part of itself.
    pub(super) uncertainty: f64,
    /// Whether so few intervals tell it that a gap among them would not show.
    pub(super) is_few: bool,
}

impl Intervals {
    /// Of blocks in any order; of those that share a stamp the first counts.
    pub(super) fn of(blocks: &[Block]) -> Self {
        let mut order = blocks.to_vec();
        order.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
        order.dedup_by(|later, kept| later.start_s <= kept.start_s);
        Self::between(&order, |block| (block.start_s, block.count))
    }

    /// Of what is in order, each with its stamp and how many samples it has.
    pub(super) fn between<B>(blocks: &[B], stamped: impl Fn(&B) -> (f64, usize)) -> Self {
        let interval = |pair: &[B]| {
            let [(start_s, count), (next_s, _)] = [&pair[0], &pair[1]].map(&stamped);
            Interval { length: as_f64(count), s: next_s - start_s }
        };
        Self(blocks.windows(2).map(interval).collect())
    }

    /// The median of what blocks and their intervals say, Hz; NaN without any.
    fn usual_hz(&self) -> f64 {
        robust::median(&mut self.0.iter().map(|interval| interval.length / interval.s).collect::<Vec<_>>())
    }

    /// The rate of the blocks that follow one another: the one that is claimed where half of them follow
    /// exactly at it, for those behind which samples are lost look like another. `None` where one in ten does
    /// not follow, as where a writer hurries after its samples.
    pub(super) fn told(&self, claimed_hz: Option<f64>) -> Option<Told> {
        let usual_hz = self.usual_hz();
        let is_gap = |interval: &Interval| interval.is_apart(usual_hz);
        let following: Vec<&Interval> = self.0.iter().filter(|interval| !is_gap(interval)).collect();
        if following.is_empty() || 10 * following.len() < 9 * self.0.len() {
            return None;
        }
        let span_s: f64 = following.iter().map(|interval| interval.s).sum();
        let line_hz = self.line_hz(mean_hz(following.iter().copied()), is_gap);
        let exact =
            |rate_hz: f64| following.iter().copied().filter(move |interval| interval.is_exact(rate_hz));
        let is_borne_out = |rate_hz: &f64| 2 * exact(*rate_hz).count() >= self.0.len();
        let rate_hz = match claimed_hz.filter(is_borne_out) {
            Some(claimed_hz) => claimed_hz,
            None if is_borne_out(&usual_hz) && self.cut(line_hz).is_none() => mean_hz(exact(usual_hz)),
            None => line_hz,
        };
        let cut_s = self.unit_s(rate_hz).unwrap_or(0.0);
        let is_apart =
            |interval: &Interval| is_gap(interval) || !interval.is_exact(rate_hz) && is_borne_out(&rate_hz);
        let uncertainty = self.spread_s(rate_hz, is_apart).max(cut_s) / span_s;
        Some(Told { rate_hz, uncertainty, is_few: self.0.len() < ENOUGH })
    }

    /// The rate of a line through the stamps, which follow one another as at about `mean_hz` or leave a gap
    /// between.
    fn line_hz(&self, mean_hz: f64, is_gap: impl Fn(&Interval) -> bool) -> f64 {
        let (mut place, mut time_s) = (0.0, 0.0);
        let mut points = vec![(0.0, 0.0)];
        for interval in &self.0 {
            place += if is_gap(interval) { interval.s * mean_hz } else { interval.length };
            time_s += interval.s;
            points.push((place, time_s));
        }
        to_digits(1.0 / line(&points).1, 10)
    }

    /// What stamps are cut to, where that shows at a rate in Hz.
    ///
    /// Stamps of whole milliseconds may be exact. Where they are cut, some intervals between blocks differ
    /// from the usual, by no more than one cut, and what they differ by does not add up: samples that are
    /// lost do, and a rate that is another.
    pub(super) fn cut(&self, rate_hz: f64) -> Option<StampCut> {
        let (unit_s, usual_hz) = (self.unit_s(rate_hz)?, self.usual_hz());
        let is_uneven = |interval: &&Interval| {
            let off_s = (interval.s - interval.length / usual_hz).abs();
            off_s * usual_hz >= 0.5 && off_s <= unit_s * (1.0 + ROUND_OFF)
        };
        let fits = |is_whole: &bool| {
            let is_gap = |interval: &Interval| !is_whole && interval.is_apart(usual_hz);
            let uneven = self.0.iter().filter(|interval| !is_gap(interval)).filter(is_uneven).count();
            uneven >= SHOWN && self.spread_s(rate_hz, is_gap) <= WIDEST * unit_s
        };
        [true, false].into_iter().find(fits).map(|is_whole| StampCut { unit_s, is_whole })
    }

    /// The largest step of 1, 2 or 5 · 10ⁿ s above a sample's time that all intervals are multiples of.
    pub(super) fn unit_s(&self, rate_hz: f64) -> Option<f64> {
        let is_multiple = |steps: f64| (steps - steps.round()).abs() < ROUND_OFF;
        let steps_s = (0..=6).flat_map(|digits| [1.0, 0.5, 0.2].map(|step| step * 10_f64.powi(-digits)));
        steps_s.take_while(|unit_s| unit_s * rate_hz > 1.0).find(|unit_s| {
            !self.0.is_empty() && self.0.iter().all(|interval| is_multiple(interval.s / unit_s))
        })
    }

    /// How far the stamps spread about even ones, s; from each gap on anew.
    fn spread_s(&self, rate_hz: f64, is_gap: impl Fn(&Interval) -> bool) -> f64 {
        let (mut off_s, mut low_s, mut high_s, mut widest_s) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        for interval in &self.0 {
            if is_gap(interval) {
                (off_s, low_s, high_s) = (0.0, 0.0, 0.0);
            } else {
                off_s += interval.s - interval.length / rate_hz;
                (low_s, high_s) = (low_s.min(off_s), high_s.max(off_s));
            }
            widest_s = widest_s.max(high_s - low_s);
        }
        widest_s
    }
}

impl Interval {
    /// Samples by which the next stamp is later than the end of the block.
    pub(super) fn miss(&self, rate_hz: f64) -> f64 {
        self.s * rate_hz - self.length
    }

    /// Whether the next block follows this one within what clocks are apart.
    fn is_exact(&self, rate_hz: f64) -> bool {
        self.miss(rate_hz).abs() <= RATE_TOLERANCE * self.length
    }

    /// Whether the next block does not follow this one: half a block is missing between them, or shared.
    fn is_apart(&self, rate_hz: f64) -> bool {
        self.miss(rate_hz).abs() > 0.5 * self.length
    }
}

/// Samples over time, Hz.
fn mean_hz<'a>(intervals: impl Iterator<Item = &'a Interval>) -> f64 {
    let (length, span_s) =
        intervals.fold((0.0, 0.0), |sums, interval| (sums.0 + interval.length, sums.1 + interval.s));
    // Ten digits are more than any clock has, and fewer than round-off spoils.
    to_digits(length / span_s, 10)
}

/// The middle of points, and the slope of the line through them that is nearest in y.
pub(crate) fn line(points: &[(f64, f64)]) -> ((f64, f64), f64) {
    let n = as_f64(points.len());
    let mean_x = points.iter().map(|point| point.0).sum::<f64>() / n;
    let mean_y = points.iter().map(|point| point.1).sum::<f64>() / n;
    let (square, cross) = points.iter().fold((0.0, 0.0), |(square, cross), (x, y)| {
        (square + (x - mean_x).powi(2), cross + (x - mean_x) * (y - mean_y))
    });
    ((mean_x, mean_y), if square > 0.0 { cross / square } else { 0.0 })
}
