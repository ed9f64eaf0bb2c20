//! Stamps of blocks to what they are cut to, where that shows.

use super::order::as_f64;

/// Stamps are held as s from the first, with more digits than this part of what they are cut to.
pub(super) const ROUND_OFF: f64 = 1e-4;

/// What stamps are cut to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::ingest) struct Cut {
    /// In s.
    pub unit_s: f64,
    /// Whether it explains every interval, so that nothing is lost between blocks.
    pub is_whole: bool,
}

/// Fewer intervals differ where samples are lost here and there.
const SHOWN: usize = 3;

/// How far, in cuts, the stamps may lie about even ones: one, and what the slope of a line through a few tens of them leaves.
const WIDEST: f64 = 1.5;

/// What stamps are cut to at a rate in Hz: of the samples of each block and the seconds to the next stamp.
///
/// Stamps of whole milliseconds may be exact. Where they are cut, some intervals between blocks differ from the usual, by no more than
/// one cut, and what they differ by does not add up: samples that are lost do, and a rate that is another.
pub(in crate::ingest) fn cut(intervals: &[(f64, f64)], rate_hz: f64) -> Option<Cut> {
    let unit_s = unit_s(intervals, rate_hz)?;
    let usual_hz = usual_hz(intervals)?;
    let is_uneven = |(length, s): &&(f64, f64)| {
        let off_s = (s - length / usual_hz).abs();
        off_s * usual_hz >= 0.5 && off_s <= unit_s * (1.0 + ROUND_OFF)
    };
    let is_gap = |(length, s): &(f64, f64)| (s * usual_hz - length).abs() > 0.5 * length;
    let is_shown = |uneven: usize| uneven >= SHOWN;
    if is_shown(intervals.iter().filter(is_uneven).count())
        && spread_s(intervals, rate_hz, |_| false) <= WIDEST * unit_s
    {
        return Some(Cut { unit_s, is_whole: true });
    }
    let between_gaps = intervals.iter().filter(|interval| !is_gap(interval)).filter(is_uneven).count();
    (is_shown(between_gaps) && spread_s(intervals, rate_hz, is_gap) <= WIDEST * unit_s)
        .then_some(Cut { unit_s, is_whole: false })
}

/// The largest step of 1, 2 or 5 · 10ⁿ s above a sample's time that all intervals are multiples of.
pub(in crate::ingest) fn unit_s(intervals: &[(f64, f64)], rate_hz: f64) -> Option<f64> {
    let is_multiple = |steps: f64| (steps - steps.round()).abs() < ROUND_OFF;
    let steps_s = (0..=6).flat_map(|digits| [1.0, 0.5, 0.2].map(|step| step * 10_f64.powi(-digits)));
    steps_s
        .take_while(|unit_s| unit_s * rate_hz > 1.0)
        .find(|unit_s| !intervals.is_empty() && intervals.iter().all(|(_, s)| is_multiple(s / unit_s)))
}

/// The median of what blocks and their intervals say, Hz.
pub(in crate::ingest) fn usual_hz(intervals: &[(f64, f64)]) -> Option<f64> {
    let mut rates_hz: Vec<f64> = intervals.iter().map(|(length, s)| length / s).collect();
    let middle = rates_hz.len() / 2;
    (!rates_hz.is_empty()).then(|| *rates_hz.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// How far the stamps spread about even ones, s; from each gap on anew.
fn spread_s(intervals: &[(f64, f64)], rate_hz: f64, is_gap: impl Fn(&(f64, f64)) -> bool) -> f64 {
    let (mut off_s, mut low_s, mut high_s, mut widest_s) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for interval in intervals {
        if is_gap(interval) {
            (off_s, low_s, high_s) = (0.0, 0.0, 0.0);
        } else {
            off_s += interval.1 - interval.0 / rate_hz;
            (low_s, high_s) = (low_s.min(off_s), high_s.max(off_s));
        }
        widest_s = widest_s.max(high_s - low_s);
    }
    widest_s
}

/// The inner blocks that are shorter than nine of ten others, which are all alike: how many, and the most samples that one is short of.
pub(super) fn short_blocks(lengths: &[usize]) -> Option<(usize, usize)> {
    let (_, inner) = lengths.split_last()?;
    let mut sorted = inner.to_vec();
    sorted.sort_unstable();
    let usual = *sorted.get(sorted.len() / 2)?;
    let short = sorted.partition_point(|&length| length < usual);
    let alike = sorted.partition_point(|&length| length <= usual) - short;
    let is_usual = 10.0 * as_f64(alike) >= 9.0 * as_f64(sorted.len());
    (is_usual && short > 0).then(|| (short, usual - sorted[0]))
}
