//! Finds the stretch with the first impact on whole channels, in one pass.

use super::block_means_m_s2;
use crate::data::{Axis, Channel, CoarseEvent, End, Onset};
use crate::numerics::{as_count, as_f64, reduce, robust};
use rayon::prelude::*;
use std::f64::consts::SQRT_2;
use std::ops::RangeInclusive;

/// Width over which a velocity change is looked for, s: longer than any first pulse (1–20 ms), shorter than a
/// flight.
const WIDTH_S: f64 = 0.025;

/// Blocks per width, so that its position is known to a fortieth; a slow record has fewer.
const BLOCKS: usize = 40;
/// Fewest blocks per width: a width of three samples holds a fall as well as an impact.
const LEAST_BLOCKS: usize = 4;

/// The first impact is the first change of L's velocity over the width to reach this share of its largest.
///
/// At the first impact L changes by (1 + k) v0 cos φ, later by less; spikes and the release change it by far
/// less.
const SHARE: f64 = 0.4;

/// A change of this share of the least possible first impact counts as the first impact, however large a
/// later one is.
const SHARE_OF_LEAST: f64 = 0.5;

/// If noise walks this many times as far within the width, it looks like an impact in some width of a record.
const WALK_FACTOR: f64 = 4.0;

/// A record is divided into this many parts, and the calmest shows the noise; a part has at least this many
/// blocks.
const PARTS: usize = 8;
const LEAST_PART: usize = 20;

/// Noise is as large in all of them within this factor.
const STEADY: f64 = 2.0;

/// A change of this share of the largest may be the slap-down, which is the first to reach half of it.
const LAST_SHARE: f64 = 0.3;
/// A change of this share of v0 may also be the slap-down: no slap-down is below 0.08 v0.
const LAST_SHARE_OF_FALL: f64 = 0.06;

/// The foot of a change lies at this share of it.
const FOOT: f64 = 0.1;
/// An end begins to move when its change reaches this share of its largest change.
const FIRST_SHARE: f64 = 0.15;
/// Below this share of the first impact's change an end is still falling.
const FALLING_SHARE: f64 = 0.1;

/// A change like the first impact's this long after it is another drop, in falls of v0/g: by then a body that
/// left the target with 0.7 v0 has come down twice, and strikes a third time with half of v0 at most.
const APART_FALLS: f64 = 2.5;
/// A change is like the first impact's within these factors: drops of one height at any of the usual angles
/// and k. A pulled cable makes a larger change, lifting or setting down the cask a smaller one.
const ALIKE_FACTORS: RangeInclusive<f64> = 0.6..=1.7;

/// Velocity changes of each transverse channel over the whole record, on which the first impact and further
/// drops are found.
pub struct Changes<'a>(Vec<ChannelChanges<'a>>);

/// Velocity changes of one channel.
struct ChannelChanges<'a> {
    channel: &'a Channel,
    /// Length of a block, s.
    block_s: f64,
    /// Blocks a width.
    blocks: usize,
    /// Change of the velocity over the width that ends with each block, m/s.
    changes_m_s: Vec<f64>,
    /// Standard deviation of that change from white noise alone, m/s; whether it is the same at all times.
    noise_m_s: f64,
    is_steady: bool,
}

/// Noise in which an impact is not found.
#[derive(Debug, Clone, PartialEq)]
pub struct HidingNoise {
    pub channel: String,
    /// Standard deviation of the velocity change within 25 ms from noise, m/s.
    pub noise_m_s: f64,
}

impl<'a> Changes<'a> {
    /// Scans all samples of the transverse channels once.
    pub fn new(channels: &'a [Channel]) -> Self {
        Self::along_axis(channels, Axis::Transverse)
    }

    /// Scans the channels along an axis.
    pub fn along_axis(channels: &'a [Channel], axis: Axis) -> Self {
        let along = channels.par_iter().filter(|c| c.axis == axis);
        Self(along.filter_map(ChannelChanges::new).collect())
    }

    /// The transverse channel of the first end; any other if that end has none.
    fn struck_channel(&self) -> Option<&ChannelChanges<'a>> {
        self.0.iter().find(|c| c.channel.end == End::First).or_else(|| self.0.first())
    }

    /// Sample rate of the channel that shows the first impact, Hz.
    pub fn rate_hz(&self) -> Option<f64> {
        self.struck_channel().map(|changing| changing.channel.sample_rate_hz)
    }

    /// Finds the first impact on the transverse channel of the first end, or, without one, on any transverse
    /// channel. The impact changes the velocity by at least `least_step_m_s`: v0 cos φ if L is struck.
    ///
    /// `None` if no channel moves at all, or if there are too few samples.
    pub fn locate(&self, least_step_m_s: f64) -> Option<CoarseEvent> {
        let struck = self.struck_channel().filter(|struck| struck.blocks >= LEAST_BLOCKS)?;
        let least_m_s = struck.least_m_s(least_step_m_s);
        let crossing = struck.changes_m_s.iter().position(|c| c.abs() >= least_m_s && least_m_s > 0.0)?;
        Some(struck.event_at(crossing))
    }

    /// Noise that could be mistaken for the impact which [`Changes::locate`] seeks; ringing of a body that a
    /// record begins with is none.
    pub fn find_hiding_noise(&self, least_step_m_s: f64) -> Option<HidingNoise> {
        let struck = self.struck_channel().filter(|struck| struck.blocks >= LEAST_BLOCKS)?;
        let noise_m_s = struck.noise_m_s;
        let begins = self.locate(least_step_m_s).is_some_and(|e| e.near_s < struck.channel.start_s);
        let is_noise = struck.is_steady || !begins;
        let hiding = || HidingNoise { channel: struck.channel.name.clone(), noise_m_s };
        (is_noise && WALK_FACTOR * noise_m_s > struck.least_m_s(least_step_m_s)).then(hiding)
    }

    /// A channel of the second end that is struck while the first end is still falling, and the lead of its
    /// clock, s.
    pub fn find_leading_clock(&self, event: &CoarseEvent, v0_m_s: f64) -> Option<Onset> {
        let struck = self.struck_channel()?;
        let is_still = |at_s: f64| {
            let least_m_s = FALLING_SHARE * event.velocity_step_m_s.abs();
            let until_s = at_s + 2.0 * WIDTH_S;
            let is_then = |i: &usize| struck.end_s(*i) < until_s;
            (0..struck.changes_m_s.len()).take_while(is_then).all(|i| struck.changes_m_s[i].abs() < least_m_s)
        };
        let first = |changing: &ChannelChanges| {
            let least_m_s = (FIRST_SHARE * changing.largest_m_s()).max(LAST_SHARE_OF_FALL * v0_m_s);
            // A change within the first width is not an impact, but hum or a level that moves later.
            let at = changing.find_motion(least_m_s).filter(|at| *at >= 2 * changing.blocks)?;
            let at_s = changing.end_s(at) - WIDTH_S;
            let delay_s = at_s - event.near_s;
            let found = Onset { channel: changing.channel.name.clone(), delay_s, u_s: WIDTH_S / 4.0 };
            (delay_s < -2.0 * WIDTH_S && is_still(at_s)).then_some(found)
        };
        self.second_end_channels().find_map(first)
    }

    /// Approximate delays with which the channels of the second end show the drop after the struck one, s:
    /// from the first impact, whose answer may seem late by milliseconds, and from the slap-down.
    pub fn delays_s(&self, v0_m_s: f64) -> Vec<f64> {
        let Some(struck) = self.struck_channel() else { return Vec::new() };
        let least_m_s = LAST_SHARE_OF_FALL * v0_m_s;
        // All channels of an end have one clock: the channel that answers first determines it.
        let earliest_s = |of_far: &dyn Fn(&ChannelChanges<'_>) -> Option<f64>| {
            self.second_end_channels().filter_map(of_far).min_by(f64::total_cmp)
        };
        let begins_s = struck.foot_s(least_m_s).zip(earliest_s(&|far| far.foot_s(least_m_s)));
        let again_s = struck.second_strike_s().zip(earliest_s(&|far| far.start_s(far.largest_m_s() / 2.0)));
        begins_s.into_iter().chain(again_s).map(|(struck_s, far_s)| far_s - struck_s).collect()
    }

    fn second_end_channels(&self) -> impl Iterator<Item = &ChannelChanges<'a>> {
        self.0.iter().filter(|changing| changing.channel.end == End::Second)
    }

    /// First impact of another drop in the same recording, long after the one at `event`; `fall_s` is the
    /// duration of a fall, s.
    pub fn find_another_drop(&self, event: &CoarseEvent, fall_s: f64) -> Option<CoarseEvent> {
        let struck = self.struck_channel()?;
        let changes = &struck.changes_m_s;
        let from_s = event.near_s + APART_FALLS * fall_s;
        let from = as_count((from_s - struck.channel.start_s) / struck.block_s).min(changes.len());
        let share = |change: &f64| change / event.velocity_step_m_s;
        let crossing = from + changes[from..].iter().position(|c| share(c) >= *ALIKE_FACTORS.start())?;
        let found = struck.event_at(crossing);
        ALIKE_FACTORS.contains(&share(&found.velocity_step_m_s)).then_some(found)
    }

    /// The last time within `after_s` of the event at which a transverse channel changes its velocity by a
    /// notable share of its largest change there, s: later parts need no detailed analysis.
    pub fn last_s(&self, event: &CoarseEvent, v0_m_s: f64, after_s: f64) -> Option<f64> {
        let of_channel = |changing: &ChannelChanges| {
            let changes = &changing.changes_m_s;
            let from = (0..changes.len()).find(|&i| changing.end_s(i) > event.near_s)?;
            let beyond_s = event.near_s + event.spread_s + after_s;
            let to = (from..changes.len()).find(|&i| changing.end_s(i) > beyond_s);
            let within = &changes[from..to.unwrap_or(changes.len())];
            let least_m_s = (LAST_SHARE * reduce::peak(within)).min(LAST_SHARE_OF_FALL * v0_m_s);
            within.iter().rposition(|c| c.abs() >= least_m_s).map(|last| changing.end_s(from + last))
        };
        self.0.iter().filter_map(of_channel).max_by(f64::total_cmp)
    }
}

impl<'a> ChannelChanges<'a> {
    fn new(channel: &'a Channel) -> Option<Self> {
        let (block_s, means) = block_means(channel)?;
        let offset = robust::median(&mut means.clone());
        let blocks = as_count((WIDTH_S / block_s).round()).clamp(1, BLOCKS);
        let mut sum = 0.0;
        let changes = (0..means.len()).map(|i| {
            sum += (means[i] - offset) * block_s;
            if i >= blocks {
                sum -= (means[i - blocks] - offset) * block_s;
            }
            sum
        });
        let changes_m_s = changes.collect();
        // Neighbours differ by √2 of the noise; the calmest part of the record shows no ringing.
        let apart: Vec<f64> = means.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let parts = apart.chunks((apart.len() / PARTS).max(LEAST_PART));
        let spreads: Vec<f64> = parts.filter(|part| part.len() >= LEAST_PART).map(robust::spread).collect();
        let least = spreads.iter().copied().reduce(f64::min).unwrap_or(0.0);
        let is_steady = reduce::peak(&spreads) < STEADY * least;
        let noise_m_s2 = least / SQRT_2;
        let noise_m_s = noise_m_s2 * block_s * as_f64(blocks).sqrt();
        Some(Self { channel, block_s, blocks, changes_m_s, noise_m_s, is_steady })
    }

    /// Smallest change that belongs to the first impact, m/s.
    fn least_m_s(&self, least_step_m_s: f64) -> f64 {
        (SHARE * self.largest_m_s()).min(SHARE_OF_LEAST * least_step_m_s)
    }

    fn largest_m_s(&self) -> f64 {
        reduce::peak(&self.changes_m_s)
    }

    /// The first block that ends a width over which the velocity changes by `least_m_s`, and by more than
    /// noise does.
    fn find_motion(&self, least_m_s: f64) -> Option<usize> {
        let least_m_s = least_m_s.max(WALK_FACTOR * self.noise_m_s);
        self.changes_m_s.iter().position(|c| c.abs() >= least_m_s)
    }

    /// Beginning of the width that [`Self::find_motion`] finds, s.
    fn start_s(&self, least_m_s: f64) -> Option<f64> {
        Some(self.end_s(self.find_motion(least_m_s)?) - WIDTH_S)
    }

    /// The time of [`Self::start_s`], moved back to where the change reached a tenth.
    fn foot_s(&self, least_m_s: f64) -> Option<f64> {
        let (moves, changes) = (self.find_motion(least_m_s)?, &self.changes_m_s);
        let still = moves.saturating_sub(3 * self.blocks)..moves.saturating_sub(self.blocks);
        let before_m_s = if still.is_empty() { 0.0 } else { robust::median(&mut changes[still].to_vec()) };
        let is_foot = |c: &f64| (c - before_m_s).abs() < FOOT * (changes[moves] - before_m_s).abs();
        let foot = changes[..moves].iter().rposition(is_foot).unwrap_or(moves);
        Some(self.end_s(foot) - WIDTH_S)
    }

    /// Beginning of the width over which the velocity changes notably once more after the first time, s.
    fn second_strike_s(&self) -> Option<f64> {
        let least_m_s = LAST_SHARE * self.largest_m_s();
        let is_notable = |c: &f64| c.abs() >= least_m_s;
        let first = self.changes_m_s.iter().position(is_notable)?;
        let calm = first + self.changes_m_s[first..].iter().position(|c| !is_notable(c))?;
        let again = calm + self.changes_m_s[calm..].iter().position(is_notable)?;
        Some(self.end_s(again) - WIDTH_S)
    }

    /// End of a block, s.
    fn end_s(&self, block: usize) -> f64 {
        self.channel.start_s + (as_f64(block) + 1.0) * self.block_s
    }

    /// The event whose change of velocity becomes notable at block `crossing`.
    fn event_at(&self, crossing: usize) -> CoarseEvent {
        let end = (crossing + self.blocks).min(self.changes_m_s.len());
        let changes = &self.changes_m_s[crossing..end];
        let step = changes.iter().fold(0.0_f64, |m, &c| if c.abs() > m.abs() { c } else { m });
        CoarseEvent { near_s: self.end_s(crossing) - WIDTH_S, spread_s: WIDTH_S, velocity_step_m_s: step }
    }
}

/// Length of a block, s, and the mean force of each, m/s²; a missing sample counts as the mean of its block,
/// a missing block as the previous one.
fn block_means(channel: &Channel) -> Option<(f64, Vec<f64>)> {
    let size = as_count((WIDTH_S * channel.sample_rate_hz / as_f64(BLOCKS)).round()).max(1);
    let mut blocks = block_means_m_s2(channel, 0..channel.samples.len(), size);
    let mut last = 0.0;
    for block in &mut blocks {
        if block.is_nan() {
            *block = last;
        }
        last = *block;
    }
    (!blocks.is_empty()).then_some((as_f64(size) / channel.sample_rate_hz, blocks))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Samples, example};

    /// A channel of 6 s at 10 kHz that is struck at the given times, s, by pulses of 5 ms that change its
    /// velocity by so much, m/s.
    fn channel(end: End, struck: &[(f64, f64)]) -> Channel {
        let force = |i: i32| {
            let at = |&&(from_s, _): &&(f64, f64)| (from_s..from_s + 5e-3).contains(&(f64::from(i) * 1e-4));
            struck.iter().find(at).map_or(0.0, |(_, change_m_s)| change_m_s / 5e-3)
        };
        Channel { end, ..example::channel((0..60_000).map(force).collect()) }
    }

    /// 2 s of rest, a fall of 0.64 s and rest again at so many samples a second, between them an impact of 20
    /// ms that takes 3 m/s more.
    fn slow(rate_hz: f64, impact_m_s: f64) -> Channel {
        let force = |i: u32| match f64::from(i) / rate_hz {
            t if (2.0..2.64).contains(&t) => 0.0,
            t if (2.64..2.66).contains(&t) => 9.81 + impact_m_s / 0.02,
            _ => 9.81,
        };
        let samples =
            Samples::F64((0..).map(force).take(channel(End::First, &[]).samples.len() / 50).collect());
        Channel { sample_rate_hz: rate_hz, samples, ..channel(End::First, &[]) }
    }

    #[test]
    fn the_width_of_a_slow_record_holds_no_fall() {
        let located = |rate_hz: f64, impact_m_s: f64| {
            let channels = [slow(rate_hz, impact_m_s)];
            Changes::new(&channels).locate(6.0)
        };
        for rate_hz in [198.0, 400.0] {
            let found = located(rate_hz, 9.0).expect("an impact");
            assert!((2.6..2.66).contains(&found.near_s), "{rate_hz}: {found:?}");
            assert!((found.velocity_step_m_s - 9.0).abs() < 2.0, "{rate_hz}: {found:?}");
            // The fall alone changes the velocity by 0.25 m/s within the width.
            assert!(located(rate_hz, 0.0).is_none_or(|e| e.velocity_step_m_s.abs() < 0.4), "{rate_hz}");
        }
        assert_eq!(located(60.0, 9.0), None);
    }

    #[test]
    fn a_second_end_that_is_struck_before_the_first_has_another_clock() {
        let ahead = |first: &[(f64, f64)], second: &[(f64, f64)]| {
            let second = Channel { name: "A2".into(), ..channel(End::Second, second) };
            let channels = [channel(End::First, first), second];
            let changes = Changes::new(&channels);
            changes.find_leading_clock(&changes.locate(12.0).expect("an impact"), 13.3)
        };
        let found = ahead(&[(1.0, 18.0), (1.06, -6.0)], &[(0.863, -4.0), (0.923, 20.0)]).expect("ahead");
        assert!(found.channel == "A2" && (found.delay_s + 0.137).abs() < 0.005, "{found:?}");
        let first = [(1.0, 18.0), (1.06, -6.0)];
        let hums = ahead(&first, &[0.0, 0.02, 0.04].map(|at_s| (at_s, 20.0)));
        assert_eq!(hums, None, "what swings from the first sample on");
        assert_eq!(ahead(&[(1.0, 18.0), (1.06, -6.0)], &[(1.0, -4.0), (1.06, 20.0)]), None);
        // With exchanged ends the channel of the stated first end begins to move when the other end is
        // struck.
        assert_eq!(ahead(&[(1.0, -4.0), (1.06, 20.0)], &[(1.0, 18.0), (1.06, -6.0)]), None);
    }

    #[test]
    fn either_blow_tells_how_far_a_clock_is_behind() {
        let behind_ms = |by_s: f64| {
            let second = channel(End::Second, &[(1.0 + by_s, -2.0), (1.06 + by_s, 20.0)]);
            let near = Channel { name: "A4".into(), ..channel(End::Second, &[(1.06 + by_s, 9.0)]) };
            let channels = [channel(End::First, &[(1.0, 18.0), (1.06, -12.0)]), near, second];
            Changes::new(&channels).delays_s(13.3).iter().map(|s| 1e3 * s).collect::<Vec<f64>>()
        };
        for by_ms in [-140.0, -30.0, 0.0, 10.0, 70.0] {
            let found = behind_ms(by_ms / 1e3);
            assert!(
                found.len() == 2 && found.iter().all(|ms| (ms - by_ms).abs() < 4.0),
                "{by_ms}: {found:?}"
            );
        }
    }

    #[test]
    fn noise_that_walks_as_far_as_an_impact_hides_it() {
        let hiding = |noise_m_s2: f64| {
            let Channel { samples, .. } = channel(End::First, &[(2.5, 20.0)]);
            let noisy = |i: usize| samples.get(i) + noise_m_s2 * example::noise(u32::try_from(i).unwrap(), 1);
            let channels = [example::channel((0..samples.len()).map(noisy).collect())];
            Changes::new(&channels).find_hiding_noise(13.0)
        };
        // White noise of 10 kHz walks by its size times 0.1 ms times √250 within 25 ms: 6.5 m/s over four.
        assert_eq!(hiding(800.0), None);
        let found = hiding(1300.0).expect("hidden");
        assert!(found.channel == "A1" && (found.noise_m_s - 2.06).abs() < 0.3, "{found:?}");
    }

    #[test]
    fn another_drop_is_an_impact_alike_that_no_rebound_can_be() {
        let another = |struck: &[(f64, f64)]| {
            let channels = [channel(End::First, struck)];
            let changes = Changes::new(&channels);
            changes.find_another_drop(&changes.locate(13.29).expect("an impact"), 1.355)
        };
        let found = another(&[(0.5, 20.0), (0.9, -12.0), (5.0, 16.0)]).expect("another drop");
        assert!((found.velocity_step_m_s - 16.0).abs() < 0.2, "{found:?}");
        assert!((4.97..5.0).contains(&found.near_s), "{found:?}");
        // A rebound, one that is too weak, a cable that is pulled, and one the other way.
        for later in [(2.5, 16.0), (5.0, 10.0), (5.0, 60.0), (5.0, -16.0)] {
            assert_eq!(another(&[(0.5, 20.0), later]), None, "{later:?}");
        }
    }

    #[test]
    fn a_slap_down_far_weaker_than_the_first_impact_is_not_left_behind() {
        let channels = [
            channel(End::First, &[(0.5, 20.0), (1.9, 20.0)]),
            channel(End::Second, &[(0.5, -10.0), (1.0, 1.1), (1.3, 0.4)]),
        ];
        let v0_m_s = 13.29;
        let changes = Changes::new(&channels);
        let event = changes.locate(v0_m_s).expect("an impact");
        let last_s = changes.last_s(&event, v0_m_s, 1.0).expect("a change");
        // The slap-down of 1.1 m/s lies within the width that ends there; 0.4 m/s is no slap-down, and 1.9 s
        // is outside the request.
        assert!((1.005..1.0051 + WIDTH_S).contains(&last_s), "{last_s}");
    }
}
