//! Finds the free fall in the record before the first impact: the moment of release and the first touch that
//! ends it.

use super::block_means_m_s2;
use crate::data::{AtRest, Channel, Drop, RestLevel, RestReading, of_either};
use crate::numerics::{as_count, as_f64, reduce, robust};
use std::cell::OnceCell;
use std::f64::consts::PI;
use std::ops::Range;

/// Least and largest step from rest to free fall, as a share of g cos φ: sensors on a tilted cask, a hook
/// that gives way.
const STEP: std::ops::Range<f64> = 0.5..1.5;
/// Length of a block, s: short against a fall, long against noise and spikes.
const BLOCK_S: f64 = 0.005;
/// Blocks of a level, 40 ms: as long as a crane's hook rings.
const LEVEL: usize = 8;
/// Blocks on either side of a step that belong to no level, 20 ms: mains hum moves a step by 13 ms.
const STEP_BLOCKS: usize = 4;
/// Blocks over which a departure from the free-fall level is averaged, 20 ms: ringing above 50 Hz has no mean
/// over them.
const DEPARTURE_BLOCKS: usize = 4;
/// A step must exceed this many of its standard uncertainties: noise of 1/f makes steps too.
const STEP_IN_U: f64 = 6.0;
/// Departure that ends a fall, as a share of g cos φ: far above the drag of a cask, below any touch that
/// carries its weight.
const TOUCH: f64 = 0.25;
/// A signal exceeds the noise if it is this many standard deviations above zero.
const NOISE_FACTOR: f64 = 6.0;
/// A level is not yet at rest if it differs by this share of g cos φ from the level before the release, or by
/// this many of the levels' scatters: the cask is still hoisted or swings.
const UNREST: f64 = 0.02;
const UNREST_SCATTERS: f64 = 5.0;
/// Share of the levels of a recording at rest that must agree: a tap on each end moves two or three.
const LEAST_SHARE_AT_REST: f64 = 0.7;
/// If gravity acts on an axis with less than this, m/s², the channel does not show the rest.
const FLAT_M_S2: f64 = 0.5;
/// The release is sought this many of the cask file's fall times back, so that a wrong height is seen as
/// such.
const REACH: f64 = 3.0;
/// A stretch shorter than this share of the cask file's fall time is no fall: it would mean a hundredth of
/// its height.
const SHORTEST: f64 = 0.1;

/// A free fall with rest before it, as one channel shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeFall {
    /// Half-way down the step from rest to free fall, s from the recording's first sample.
    pub release_s: f64,
    /// First touch: the first sustained departure from the free-fall level, or first contact, s from the
    /// recording's first sample.
    pub end_s: f64,
    /// Rest level less free-fall level, m/s².
    pub rest_m_s2: f64,
    /// Standard uncertainty of the rest level, from the scatter of the levels of rest and fall, m/s².
    pub u_rest_m_s2: f64,
}

/// The longest free fall before `contact_s` that begins with a step from rest, +g cos φ, to a level that then
/// stays.
///
/// It may end before `contact_s`, if water, a guide or a soft layer is touched before the impact. `None` if
/// the record does not reach back to the rest, or shows no such step (an AC-coupled sensor).
pub fn free_fall(channel: &Channel, drop: &Drop, contact_s: f64) -> Option<FreeFall> {
    let weight_m_s2 = drop.weight_m_s2(channel.axis);
    if !feels_gravity(channel, drop) {
        return None;
    }
    let fall_s = drop.impact_velocity_m_s / drop.gravity_m_s2;
    let record = Record::new(channel, 0..channel.index_at(contact_s), weight_m_s2)?;
    let contact = (contact_s - channel.time_s(0)) * channel.sample_rate_hz;
    let from = channel.index_at(contact_s - REACH * fall_s - 0.5) / record.size;
    record
        .steps(from)
        .into_iter()
        .filter_map(|block| record.find_fall(block, contact))
        .filter(|(_, length)| *length > (SHORTEST * fall_s).max(0.05) * channel.sample_rate_hz)
        .max_by(|(_, a), (_, b)| a.total_cmp(b))
        .map(|(fall, _)| fall)
}

/// Level of a channel in a file of the rest, less the level of the whole free fall before `contact_s`, as
/// [`free_fall`] gives it for a recording with both; `None` if the fall is shorter than two levels.
pub fn rest_level(channel: &Channel, rest: RestReading, drop: &Drop, contact_s: f64) -> Option<RestLevel> {
    let weight_m_s2 = drop.weight_m_s2(channel.axis);
    let from = channel.index_at(contact_s - drop.impact_velocity_m_s / drop.gravity_m_s2);
    let record = Record::new(channel, from..channel.index_at(contact_s), weight_m_s2)?;
    let (end, most_m_s2) = (record.blocks.len() - 1, TOUCH * weight_m_s2);
    let mut of_fall = record.levels(0..end);
    // Levels before the fall do not belong to it.
    let last = *of_fall.first()?;
    of_fall.truncate(of_fall.iter().take_while(|level| (*level - last).abs() <= most_m_s2).count());
    Some(RestLevel {
        channel: channel.name.clone(),
        axis: channel.axis,
        rest_m_s2: channel.scale_m_s2 * rest.level - robust::mean_and_rms(&of_fall).0,
        u_m_s2: (channel.scale_m_s2 * rest.u).hypot(record.u_mean(&of_fall, most_m_s2)),
    })
}

/// True if gravity acts on a channel's axis at rest.
pub fn feels_gravity(channel: &Channel, drop: &Drop) -> bool {
    drop.weight_m_s2(channel.axis) > FLAT_M_S2
}

/// Level of a recording that is entirely at rest; `None` if it is shorter than two levels.
///
/// Levels that a tap moves are left out.
pub fn at_rest(channel: &Channel, gravity_m_s2: f64) -> Option<AtRest> {
    let record = Record::new(channel, 0..channel.samples.len(), gravity_m_s2)?;
    let levels = record.levels(0..record.blocks.len());
    let median = robust::median(&mut levels.clone());
    let off = |level: &f64| (level - median).abs();
    let middle = levels.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b)))?;
    let steps: Vec<f64> = levels.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let scatter_m_s2 = robust::spread(&steps).hypot(record.converter_step_m_s2());
    let most_m_s2 = (UNREST * gravity_m_s2).max(UNREST_SCATTERS * scatter_m_s2);
    let still: Vec<f64> =
        levels.iter().copied().filter(|level| (level - middle).abs() <= most_m_s2).collect();
    Some(AtRest {
        level_m_s2: robust::mean_and_rms(&still).0,
        u_m_s2: record.u_mean(&still, scatter_m_s2),
        is_still: as_f64(still.len()) >= LEAST_SHARE_AT_REST * as_f64(levels.len()),
        least_step_m_s2: record.converter_step_m_s2(),
    })
}

/// The samples before first contact and the means of their blocks: a median would follow the steps of a
/// coarse converter.
struct Record<'a> {
    channel: &'a Channel,
    samples: Range<usize>,
    size: usize,
    blocks: Vec<f64>,
    weight_m_s2: f64,
    /// Step of the converter, computed once when it is first needed.
    converter_step_m_s2: OnceCell<f64>,
    u_rounding_m_s2: OnceCell<f64>,
}

impl<'a> Record<'a> {
    /// Makes the record; `None` if it is shorter than two levels.
    fn new(channel: &'a Channel, samples: Range<usize>, weight_m_s2: f64) -> Option<Self> {
        let size = as_count((BLOCK_S * channel.sample_rate_hz).round()).max(1);
        let mut blocks = block_means_m_s2(channel, samples.clone(), size);
        blocks.truncate(samples.len() / size);
        let is_long = blocks.len() > 2 * LEVEL + 2;
        is_long.then_some(Self {
            channel,
            samples,
            size,
            blocks,
            weight_m_s2,
            converter_step_m_s2: OnceCell::new(),
            u_rounding_m_s2: OnceCell::new(),
        })
    }

    /// The samples in a range counted from the record's first, limited to the available samples, m/s².
    fn force_m_s2(&self, range: Range<usize>) -> Vec<f64> {
        let at = |i: usize| (self.samples.start + i).min(self.samples.end);
        self.channel.force_m_s2(at(range.start), at(range.end))
    }

    /// Median of the blocks `from..to` that hold samples; NaN where none does.
    fn level(&self, from: usize, to: usize) -> f64 {
        let blocks = self.blocks.get(from..to.min(self.blocks.len())).unwrap_or_default();
        robust::median(&mut blocks.iter().copied().filter(|b| b.is_finite()).collect::<Vec<_>>())
    }

    /// The blocks after `from` in which a level changes to one lower by about the weight, each step once.
    fn steps(&self, from: usize) -> Vec<usize> {
        let height = |i: usize| self.level(i - LEVEL, i) - self.level(i + 1, i + 1 + LEVEL);
        let heights: Vec<(usize, f64)> =
            (from.max(LEVEL)..self.blocks.len() - LEVEL).map(|i| (i, height(i) / self.weight_m_s2)).collect();
        heights
            .chunk_by(|a, b| STEP.contains(&a.1) == STEP.contains(&b.1))
            .filter(|run| STEP.contains(&run[0].1))
            .filter_map(|run| run.get(run.len() / 2).map(|step| step.0))
            .collect()
    }

    /// The fall after a step, and its length in samples.
    fn find_fall(&self, step: usize, contact: f64) -> Option<(FreeFall, f64)> {
        let near = self.level(step + 1, step + 1 + LEVEL);
        let end = self.departure(step, near);
        // The level of the whole fall is better known than that of its beginning.
        let falling = self.level(step + 1, end.unwrap_or(self.blocks.len()));
        let departure = self.departure(step, falling);
        let end = departure.map_or(contact, |block| self.touch(step, block, falling));
        let of_fall =
            self.levels(step + STEP_BLOCKS..departure.unwrap_or(self.blocks.len()).saturating_sub(1));
        let at_rest = self.rest_levels_before(step, &of_fall);
        let fall = robust::mean_and_rms(&of_fall).0;
        let rest = robust::mean_and_rms(&at_rest).0 - if fall.is_finite() { fall } else { falling };
        let u_falling = self.u_mean(&of_fall, TOUCH * self.weight_m_s2);
        let u_rest = u_falling.hypot(self.u_mean(&at_rest, robust::mean_and_rms(&of_fall).1));
        let u_step = u_rest.hypot(self.converter_step_m_s2() / 6.0_f64.sqrt());
        // If single levels scatter as far as the step, the step may lie anywhere.
        let scatter_m_s2 = robust::mean_and_rms(&of_fall).1;
        if !STEP.contains(&(rest / self.weight_m_s2)) || rest < STEP_IN_U * u_step.max(scatter_m_s2) {
            return None;
        }
        let start = self.crossing(step, falling + 0.5 * rest);
        let time_s = |sample: f64| self.channel.time_s(0) + sample / self.channel.sample_rate_hz;
        let (release_s, end_s) = (time_s(start), time_s(end));
        Some((FreeFall { release_s, end_s, rest_m_s2: rest, u_rest_m_s2: u_rest }, end - start))
    }

    /// Standard uncertainty of a level from the converter's rounding, m/s²: noise before it reduces that
    ///
    /// u = q/√12 e^(−2π²σ²/q²)
    fn u_rounding_m_s2(&self) -> f64 {
        *self.u_rounding_m_s2.get_or_init(|| {
            let step = self.converter_step_m_s2();
            let count = self.samples.len();
            let pairs = (0..count.saturating_sub(1)).step_by(robust::stride(count));
            let pairs = pairs.map(|i| self.force_m_s2(i..i + 2));
            let apart: Vec<f64> = pairs.map(|w| w[1] - w[0]).filter(|d| d.is_finite()).collect();
            let square = (robust::spread(&apart).powi(2) / 2.0 / step.powi(2) - 1.0 / 12.0).max(0.0);
            let left = if square.is_finite() { (-2.0 * PI * PI * square).exp() } else { 1.0 };
            left * step / 12.0_f64.sqrt()
        })
    }

    /// Smallest difference of neighbouring samples, m/s².
    fn converter_step_m_s2(&self) -> f64 {
        *self.converter_step_m_s2.get_or_init(|| {
            let scale = self.channel.scale_m_s2.abs();
            let (samples, range) = (&self.channel.samples, self.samples.clone());
            let least = scale * of_either!(samples, v => reduce::least_step(&v[range], 1e-9 / scale));
            if least.is_finite() { least } else { 0.0 }
        })
    }

    /// Means of [`LEVEL`] blocks each, from the end of `blocks` back, m/s².
    fn levels(&self, blocks: Range<usize>) -> Vec<f64> {
        let blocks = self.blocks.get(blocks).unwrap_or_default();
        blocks.rchunks_exact(LEVEL).map(|of| robust::mean_and_rms(of).0).filter(|l| l.is_finite()).collect()
    }

    /// Levels of the rest before a step, back to where the cask was not yet at rest; `of_fall` shows the
    /// scatter of the levels.
    fn rest_levels_before(&self, step: usize, of_fall: &[f64]) -> Vec<f64> {
        let scatter_m_s2 = robust::mean_and_rms(of_fall).1.hypot(self.converter_step_m_s2());
        let most_m_s2 = (UNREST * self.weight_m_s2).max(UNREST_SCATTERS * scatter_m_s2);
        let levels = self.levels(0..step.saturating_sub(STEP_BLOCKS));
        let Some(&last) = levels.first() else { return vec![f64::NAN] };
        levels.into_iter().take_while(|level| (level - last).abs() <= most_m_s2).collect()
    }

    /// Standard uncertainty of the mean of levels, m/s²: from their scatter as if they were independent, and
    /// from the difference of their halves, which covers noise of every colour; a single level has the given
    /// scatter.
    fn u_mean(&self, levels: &[f64], of_one_m_s2: f64) -> f64 {
        let n = as_f64(levels.len().max(1));
        let (earlier, later) = levels.split_at(levels.len() / 2);
        let mean = |levels: &[f64]| robust::mean_and_rms(levels).0;
        let (scatter_m_s2, drift_m_s2) = if levels.len() > 1 {
            (robust::mean_and_rms(levels).1 / n.sqrt(), (mean(earlier) - mean(later)).abs() / 2.0)
        } else {
            (of_one_m_s2, 0.0)
        };
        // A scatter over n levels has a relative uncertainty of 1/√(2n): few levels get that margin twice.
        let margin = 1.0 + (2.0 / n).sqrt();
        margin * scatter_m_s2.max(drift_m_s2).hypot(self.u_rounding_m_s2())
    }

    /// The block from which on the mean over [`DEPARTURE_BLOCKS`] blocks is off the free-fall level; `None`
    /// if the level stays to the end.
    fn departure(&self, step: usize, falling: f64) -> Option<usize> {
        let after = self.blocks.get(step + DEPARTURE_BLOCKS..)?;
        let off = |b: &f64| if b.is_finite() { b - falling } else { 0.0 };
        let mean = |w: &[f64]| w.iter().map(off).sum::<f64>() / as_f64(DEPARTURE_BLOCKS);
        let means: Vec<f64> = after.windows(DEPARTURE_BLOCKS).map(mean).collect();
        // The threshold includes the scatter of the fall's own means: noise of 1/f departs by itself.
        let level = (TOUCH * self.weight_m_s2).max(NOISE_FACTOR * robust::spread(&means));
        let window = means.iter().position(|m| m.abs() > level)?;
        let block = after[window..].iter().position(|b| off(b).abs() > TOUCH * self.weight_m_s2)?;
        Some(step + DEPARTURE_BLOCKS + window + block)
    }

    /// The sample in or just before `block` from which most of a block's length is off the free-fall level.
    fn touch(&self, step: usize, block: usize, falling: f64) -> f64 {
        let calm = self.force_m_s2((step + 2) * self.size..(block - 1) * self.size);
        let finite: Vec<f64> = robust::thin(&calm).filter(|f| f.is_finite()).collect();
        let noise = if finite.is_empty() { 0.0 } else { robust::spread(&finite) };
        let level = (TOUCH * self.weight_m_s2).max(NOISE_FACTOR * noise);
        let start = (block - 1) * self.size;
        let force = self.force_m_s2(start..start + 3 * self.size);
        let is_off = |f: &f64| (f - falling).abs() > level;
        let found = (start..start + 2 * self.size).find(|&i| {
            let at = i - start;
            let ahead = force.get(at..(at + self.size).min(force.len())).unwrap_or_default();
            ahead.first().is_some_and(is_off)
                && ahead.iter().filter(|f| is_off(f)).count() * 3 >= 2 * ahead.len()
        });
        as_f64(found.unwrap_or(block * self.size))
    }

    /// Time at which the samples about a step fall below `level`: the samples above it are counted, so that
    /// noise averages.
    fn crossing(&self, step: usize, level: f64) -> f64 {
        let start = step.saturating_sub(LEVEL / 2) * self.size;
        let about = self.force_m_s2(start..(step + LEVEL / 2) * self.size);
        as_f64(start + about.iter().filter(|f| **f > level).count())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;

    const RATE_HZ: f64 = 10_000.0;

    fn drop() -> Drop {
        // 4 m/s: a fall of 0.4077 s.
        Drop { impact_velocity_m_s: 4.0, ..Drop::from_height(0.8155, 0.0) }
    }

    /// Noise of ±0.5 m/s² about what `force` says at each time, for 3 s.
    fn channel(force: impl Fn(f64) -> f64) -> Channel {
        let mut state = 1_u32;
        let samples = (0..30_000)
            .map(|i| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                force(f64::from(i) / RATE_HZ) + f64::from(state) / f64::from(u32::MAX) - 0.5
            })
            .collect();
        Channel { sample_rate_hz: RATE_HZ, ..example::channel(samples) }
    }

    /// Rest to 1.5 s, fall to 1.9 s, then 2 g that decay until a hard stop at 2.1 s; all on an offset of 6
    /// m/s².
    fn soft_entry(t: f64) -> f64 {
        6.0 + match t {
            t if t < 1.5 => 9.81,
            t if t < 1.9 => 0.0,
            t if t < 2.1 => 20.0 - 40.0 * (t - 1.9),
            _ => 400.0,
        }
    }

    #[test]
    fn noise_takes_the_converter_s_rounding_off_a_level() {
        let u_rest = |step: f64| {
            let fine = channel(soft_entry);
            let coarse = (0..fine.samples.len()).map(|i| (fine.samples.get(i) / step).round() * step);
            let coarse = Channel { samples: example::channel(coarse.collect()).samples, ..fine };
            free_fall(&coarse, &drop(), 2.1).expect("a fall").u_rest_m_s2
        };
        // The noise is 0.72 and 0.14 steps: a level is known to its scatter, and to 0.66 q/√12 of each level.
        assert!(u_rest(0.4) < 0.02, "{}", u_rest(0.4));
        assert!(u_rest(2.0) > 0.3, "{}", u_rest(2.0));
    }

    #[test]
    fn the_fall_ends_at_the_first_touch_not_at_the_larger_stop() {
        let fall = free_fall(&channel(soft_entry), &drop(), 2.1).expect("a fall");
        // Steps between two samples are found to a sample.
        assert!((fall.release_s - 1.5).abs() < 2.0 / RATE_HZ, "{fall:?}");
        assert!((fall.end_s - 1.9).abs() < 2.0 / RATE_HZ, "{fall:?}");
        // The medians of blocks of 50 samples of uniform noise lie within 0.2 of the truth.
        assert!((fall.rest_m_s2 - 9.81).abs() < 0.2, "{fall:?}");
        // A mean of 50 uniform samples scatters by 0.041, one of eight such by 0.014, and the fall has nine
        // of those; known to a half.
        assert!((0.003..0.02).contains(&fall.u_rest_m_s2), "{fall:?}");
    }

    #[test]
    fn a_fall_straight_into_the_impact_ends_with_first_contact() {
        let fall = free_fall(&channel(|t| if t < 1.5 { 9.81 } else { 0.0 }), &drop(), 1.912_34);
        assert!((fall.expect("a fall").end_s - 1.912_34).abs() < 1e-9);
    }

    #[test]
    fn ringing_after_the_release_does_not_end_the_fall() {
        let ringing = |t: f64| {
            let ring = if t > 1.5 { 8.0 * (-10.0 * (t - 1.5)).exp() * (500.0 * t).sin() } else { 0.0 };
            soft_entry(t) + ring
        };
        let fall = free_fall(&channel(ringing), &drop(), 2.1).expect("a fall");
        assert!((fall.end_s - 1.9).abs() < 1e-3, "{fall:?}");
        // The ring crosses the middle of the step within its period of 12.6 ms.
        assert!((fall.release_s - 1.5).abs() < 0.0126, "{fall:?}");
    }

    #[test]
    fn a_height_that_is_wrong_does_not_hide_the_fall() {
        let wrong = Drop { height_m: 0.2, impact_velocity_m_s: 1.981, ..drop() };
        let fall = free_fall(&channel(soft_entry), &wrong, 2.1).expect("a fall");
        assert!((fall.end_s - fall.release_s - 0.4).abs() < 4.0 / RATE_HZ, "{fall:?}");
    }

    #[test]
    fn without_rest_before_it_there_is_no_release() {
        assert_eq!(free_fall(&channel(|_| 0.0), &drop(), 2.1), None);
        assert_eq!(free_fall(&channel(soft_entry), &drop(), 0.05), None);
        assert_eq!(free_fall(&channel(|t| 0.3 * soft_entry(t)), &drop(), 2.1), None);
    }
}
