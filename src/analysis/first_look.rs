//! Describes a channel without a cask file: its extremes, level and noise, and what looks like a fall and an
//! impact.

use crate::data::{Channel, ChannelLook, Drop, Extreme, ListedChannel, is_number};
use crate::events;
use crate::ingest::{self, Limits, Progress, RecordingFile};
use crate::numerics::{as_f64, reduce, robust};
use std::ops::Range;

/// Level and noise are determined from at most this share of the record, and this many seconds.
const FIRST_SHARE: f64 = 0.05;
const FIRST_S: f64 = 0.25;

/// Smallest change of velocity within 25 ms that looks like an impact, m/s: a fall from 5 cm.
const LEAST_STEP_M_S: f64 = 1.0;

/// An impact begins at this share of its peak.
const ONSET_SHARE: f64 = 0.1;

/// Drop height that the search for a fall expects, m, as in the IAEA regulations: falls of up to three times
/// and down to a tenth of its time are found.
const USUAL_HEIGHT_M: f64 = 9.0;

/// Looks at these sources of a recording one after the other, and hands over each with its index, or the
/// reason why it cannot be read.
pub fn look_at_each<'a>(
    recording: impl Into<RecordingFile<'a>>,
    listed: &[&ListedChannel],
    limits: Limits,
    progress: Progress,
    mut take: impl FnMut(usize, Result<(Channel, ChannelLook), String>),
) {
    ingest::read_listed(recording, listed, limits, progress, |number, read| {
        let look = read.map(|mut channel| {
            let look = first_look(&mut channel);
            (channel, look)
        });
        take(number, look.map_err(|error| error.to_string()));
    });
}

/// Looks at every sample; leaves the channel unchanged.
fn first_look(channel: &mut Channel) -> ChannelLook {
    let impact_s = find_impact_s(channel).filter(|_| channel.scale_m_s2.is_finite());
    let fall_s = impact_s.and_then(|impact_s| find_fall_s(channel, impact_s));
    let (level, noise) = first_level(channel, impact_s);
    let none = Extreme { value: f64::NAN, time_s: channel.start_s };
    let [smallest, largest] = channel.extremes().unwrap_or([none; 2]);
    ChannelLook { smallest, largest, level, noise, fall_s, impact_s }
}

/// Median and spread of the first samples, all before the impact.
fn first_level(channel: &Channel, impact_s: Option<f64>) -> (f64, f64) {
    let duration_s = as_f64(channel.samples.len()) / channel.sample_rate_hz;
    let first = channel.index_at(channel.start_s + (FIRST_SHARE * duration_s).min(FIRST_S));
    let before = impact_s.map_or(usize::MAX, |impact_s| channel.index_at(impact_s).saturating_sub(1));
    let first = (0..first.clamp(1, channel.samples.len()).min(before)).map(|i| channel.samples.get(i));
    robust::centre_and_spread(&first.filter(|sample| is_number(*sample)).collect::<Vec<_>>())
}

/// Time at which the first large change of velocity begins, s.
pub(super) fn find_impact_s(channel: &Channel) -> Option<f64> {
    // The limit is a share of the largest change, however small.
    let event =
        events::Changes::along_axis(std::slice::from_ref(channel), channel.axis).locate(f64::INFINITY)?;
    let [from, near, to] = [-1.0, 0.0, 2.0].map(|n| channel.index_at(event.near_s + n * event.spread_s));
    let force_m_s2 = channel.force_m_s2(from, to);
    let before = force_m_s2[..near - from].iter().copied().filter(|f| f.is_finite());
    let level_m_s2 = Some(robust::median(&mut before.collect::<Vec<_>>())).filter(|level| level.is_finite());
    let off_m_s2: Vec<f64> = force_m_s2.iter().map(|f| (f - level_m_s2.unwrap_or_default()).abs()).collect();
    let least_m_s2 = ONSET_SHARE * reduce::peak(&off_m_s2);
    let begins = off_m_s2.iter().position(|off| *off >= least_m_s2)?;
    (event.velocity_step_m_s.abs() >= LEAST_STEP_M_S).then(|| channel.time_s(from + begins))
}

/// Finds a fall with rest before it, for either direction of the sensor, s.
fn find_fall_s(channel: &mut Channel, impact_s: f64) -> Option<Range<f64>> {
    let usual = Drop::from_height(USUAL_HEIGHT_M, 0.0);
    let mut try_and_turn = || {
        let fall = events::free_fall(channel, &usual, impact_s);
        channel.scale_m_s2 = -channel.scale_m_s2;
        fall
    };
    let falls = [try_and_turn(), try_and_turn()];
    falls.into_iter().flatten().next().map(|fall| fall.release_s..fall.end_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;

    /// Simulates at 10 kHz: rest to 1 s, a fall to 2 s, an impact of 5 ms with 400 m/s² and rest again, on
    /// noise of 0.5.
    fn dropped(sign: f64) -> Channel {
        let force = |i: u32| match f64::from(i) / 1e4 {
            t if t < 1.0 => 9.81,
            t if t < 2.0 => 0.0,
            t if t < 2.005 => 400.0,
            _ => 9.81,
        };
        example::channel((0..30_000).map(|i| sign * force(i) + 0.5 * example::noise(i, 1)).collect())
    }

    #[test]
    fn a_fall_and_an_impact_are_seen_whichever_way_the_sensor_is_mounted() {
        for sign in [1.0, -1.0] {
            let mut channel = dropped(sign);
            let look = first_look(&mut channel);
            let (fall_s, impact_s) =
                (look.fall_s.clone().expect("a fall"), look.impact_s.expect("an impact"));
            assert!((fall_s.start - 1.0).abs() < 2e-3 && (fall_s.end - 2.0).abs() < 2e-3, "{fall_s:?}");
            assert!((impact_s - 2.0).abs() < 2e-4, "{impact_s}");
            // The median and the spread of 1500 samples scatter by 0.016 and 0.02.
            assert!((look.level - sign * 9.81).abs() < 0.07 && (look.noise - 0.5).abs() < 0.08, "{look:?}");
            assert_eq!(channel, dropped(sign));
        }
    }

    #[test]
    fn what_is_no_acceleration_or_only_noise_is_not_guessed_about() {
        let other = Channel { scale_m_s2: f64::NAN, ..dropped(1.0) };
        let calm = example::channel((0..30_000).map(|i| example::noise(i, 1)).collect());
        for mut channel in [other, calm] {
            let look = first_look(&mut channel);
            assert_eq!((look.fall_s, look.impact_s), (None, None));
            assert!(look.level.is_finite() && look.noise.is_finite());
        }
    }

    #[test]
    fn extremes_are_the_first_of_their_size_and_no_missing_samples() {
        let samples = vec![f64::NAN, 3.0, -2.0, 9.91e37, 3.0, -2.0];
        let look = first_look(&mut example::channel(samples));
        assert_eq!(look.smallest, Extreme { time_s: 2e-4, value: -2.0 });
        assert_eq!(look.largest, Extreme { time_s: 1e-4, value: 3.0 });
    }
}
