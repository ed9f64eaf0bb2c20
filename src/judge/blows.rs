//! Finds shocks in a flight that its ringing does not predict: loose contents that strike the cask, once or
//! repeatedly.

use super::tilt::tilt_m_s2;
use crate::data::{Cask, ChannelFinding, Events, Finding, FlightFit, IssueCode, Signal};
use crate::numerics::linear_prediction::{MOST_BEFORE, predict_linearly};
use crate::numerics::reduce::{self, block_means, block_size, converter_step, peak};
use crate::numerics::{as_count, as_f64};
use std::ops::Range;

/// Rate of the means that are examined, Hz: a blow lasts one to some milliseconds.
const RATE_HZ: f64 = 8_000.0;
/// Length of the pieces that are examined separately, s: ringing at the beginning of a long flight, and its
/// residual, has decayed at its end.
const PIECE_S: f64 = 0.1;
/// A mean whose deviation from its prediction is this many times that of the means before it is a shock.
/// Modes that the prediction cannot include also leave a residual, but one that decays.
const SHOCK_LIMIT: f64 = 6.0;
/// A window of all channels is struck if its deviation exceeds noise by this much, after the interval over
/// which the flight was fitted: of 310 sound drops of elastic beams none is named.
const COMBINED_LIMIT: f64 = 7.0;
/// A step found by (21b) is a shock from this value on: in those drops it finds 22 steps, of at most 2.8.
const SHARP_LIMIT: f64 = 3.0;
/// A shock of one channel of the first size, while no other exceeds the second, is not one of the cask: a
/// blow moves all places of a rigid body, and those near its centre of percussion ring.
const ALONE_SIZE: f64 = 24.0;
const OTHERS_SIZE: f64 = 4.0;
/// Windows in which all channels are combined, s, and the fewest means of one.
const WINDOW_S: f64 = 1e-3;
const FEWEST_MEANS: f64 = 4.0;
/// Number of means before a mean that are compared with it: 3 ms, longer than most shocks. A third of them is
/// enough at first.
const BEFORE: usize = 24;
const FEWEST_BEFORE: usize = 8;
/// Smallest spread, as a share of the largest mean: less changes no velocity by 1 % of v0.
const LEAST_SPREAD: f64 = 3e-4;
/// Smallest spread, as a share of an axial channel's mean reading from bending: the RMS of its variation at
/// twice the frequency.
const TILT_SPREAD: f64 = 0.7;
/// The onset of the slap-down may begin this much earlier than it was found, s, plus a share of the flight.
const FOOT_S: f64 = 1e-3;
const FOOT: f64 = 0.06;
/// Blows closer together than this are one, s.
const APART_S: f64 = 3e-3;

/// Names the channel with the largest shock in the flight, with the times; `found` names disturbed channels.
pub fn judge_blows(
    signals: &[Signal],
    flight: &FlightFit,
    events: &Events,
    found: &[Finding],
    cask: &Cask,
) -> Option<Finding> {
    let contact_s = events.first_contact_s()?;
    let channels = find_deviations(signals, flight, events, found, cask);
    // Within that interval a step is searched by (21b), and modes that were not fitted ring.
    let is_shaken = |window: &Deviation| window.size > COMBINED_LIMIT && window.time_s > flight.to_s;
    let shaken: Vec<Deviation> = combine_channels(&channels).into_iter().filter(is_shaken).collect();
    let is_in_one = |mean: &Deviation| shaken.iter().any(|w| (w.time_s - mean.time_s).abs() < WINDOW_S);
    let hardest = |channel: &ChannelDeviations<'_>| {
        let struck = channel.means.iter().filter(|mean| mean.size > SHOCK_LIMIT || is_in_one(mean));
        struck.map(|mean| mean.size).fold(0.0, f64::max)
    };
    let struck = channels.iter().max_by(|a, b| hardest(a).total_cmp(&hardest(b)))?;
    let alone_s = struck.means.iter().filter(|mean| mean.size > SHOCK_LIMIT).map(|mean| mean.time_s);
    let mut times_s: Vec<f64> = alone_s.chain(shaken.iter().map(|window| window.time_s)).collect();
    times_s.sort_by(f64::total_cmp);
    let (first_s, last_s) = (*times_s.first()?, *times_s.last()?);
    let mut before_s = f64::NEG_INFINITY;
    times_s.retain(|&t| t - std::mem::replace(&mut before_s, t) > APART_S);
    let after_s = times_s.iter().map(|t| t - contact_s).collect();
    let size = hardest(struck);
    let is_near = |mean: &&Deviation| times_s.iter().any(|time_s| (time_s - mean.time_s).abs() < APART_S);
    let mut others = channels.iter().filter(|channel| channel.signal.name != struck.signal.name);
    let largest = |c: &ChannelDeviations<'_>| c.means.iter().filter(is_near).map(|m| m.size).reduce(f64::max);
    let is_alone = channels.len() > 1
        && size > ALONE_SIZE
        && others.all(|other| largest(other).is_some_and(|size| size < OTHERS_SIZE));
    let found = if is_alone {
        ChannelFinding::JumpsAlone { after_s, far: size }
    } else {
        ChannelFinding::Struck { after_s, far: size }
    };
    Some(found.tag(&struck.signal.name).span(first_s, last_s))
}

/// True if a shock of the flight is as sharp as a blow on a cask, or if no prediction covers it. A step that
/// compensates for modes that were not fitted has no shock.
pub fn is_sharp(signals: &[Signal], flight: &FlightFit, events: &Events, cask: &Cask, at_s: f64) -> bool {
    let windows = combine_channels(&find_deviations(signals, flight, events, &[], cask));
    let near = windows.iter().filter(|window| (window.time_s - at_s).abs() < APART_S);
    near.map(|window| window.size).reduce(f64::max).is_none_or(|size| size > SHARP_LIMIT)
}

/// A channel with the deviations of its means from their predictions.
struct ChannelDeviations<'a> {
    signal: &'a Signal,
    means: Vec<Deviation>,
}

fn find_deviations<'a>(
    signals: &'a [Signal],
    flight: &FlightFit,
    events: &Events,
    found: &[Finding],
    cask: &Cask,
) -> Vec<ChannelDeviations<'a>> {
    let foot_s = |struck_s: f64| FOOT_S + FOOT * (struck_s - flight.from_s);
    let span_s = flight.from_s..events.slap_down_s().map_or(flight.to_s, |t| t - foot_s(t));
    let whole = signals.iter().filter(|s| !is_disturbed(s, &span_s, found));
    let least_m_s2 = |s| TILT_SPREAD * tilt_m_s2(s, signals, flight, cask).abs();
    let means = |signal| deviations(signal, &span_s, least_m_s2(signal));
    whole.map(|signal| ChannelDeviations { signal, means: means(signal) }).collect()
}

/// Combines all channels, window by window: the number of standard deviations by which Σ size² exceeds the
/// number of means; for noise that is χ².
fn combine_channels(channels: &[ChannelDeviations<'_>]) -> Vec<Deviation> {
    let means = || channels.iter().flat_map(|l| &l.means);
    let [first_s, last_s] = [f64::min, f64::max].map(|end| means().map(|m| m.time_s).reduce(end));
    let (Some(first_s), Some(last_s)) = (first_s, last_s) else { return Vec::new() };
    let half = |time_s: f64| as_count((time_s - first_s) / (WINDOW_S / 2.0));
    let mut halves = vec![(0.0, 0.0); half(last_s) + 1];
    for mean in means() {
        let (squares, count) = &mut halves[half(mean.time_s)];
        *squares += mean.size.powi(2);
        *count += 1.0;
    }
    let of_window = |(i, w): (usize, &[(f64, f64)])| {
        let (squares, count) = (w[0].0 + w[1].0, w[0].1 + w[1].1);
        let size = (squares - count) / (2.0_f64 * count).sqrt();
        let time_s = first_s + as_f64(i + 1) * WINDOW_S / 2.0;
        (count >= FEWEST_MEANS).then_some(Deviation { time_s, size })
    };
    halves.windows(2).enumerate().filter_map(of_window).collect()
}

/// True if samples between two times are missing, clipped or part of a spike.
fn is_disturbed(signal: &Signal, span_s: &Range<f64>, found: &[Finding]) -> bool {
    let touches = |spans: &[_]| signal.overlaps(spans, span_s.start, span_s.end);
    let is_spiked = |f: &Finding| {
        f.code == IssueCode::Spikes
            && f.channel.as_ref() == Some(&signal.name)
            && f.from_s.is_none_or(|t| t < span_s.end)
            && f.to_s.is_none_or(|t| t > span_s.start)
    };
    touches(&signal.gaps) || touches(&signal.clipped) || found.iter().any(is_spiked)
}

/// Deviation of a mean from its prediction.
struct Deviation {
    time_s: f64,
    /// Deviation over that of the means before it.
    size: f64,
}

/// Deviations of the means of an interval; none if it is too short.
fn deviations(signal: &Signal, span_s: &Range<f64>, least_m_s2: f64) -> Vec<Deviation> {
    let from = signal.index_from(span_s.start);
    let samples = signal.force_m_s2.get(from..signal.index_from(span_s.end)).unwrap_or_default();
    let block = block_size(RATE_HZ, signal.sample_rate_hz);
    let means = block_means(samples, block);
    let rounding_m_s2 = rounding_of_means(samples, block);
    let least_m_s2 = (LEAST_SPREAD * peak(&means)).max(least_m_s2).max(f64::MIN_POSITIVE);
    let pieces = as_count(((span_s.end - span_s.start) / PIECE_S).round().max(1.0));
    let length = means.len().div_ceil(pieces).max(1);
    let of_piece = |i: usize| {
        // Each piece but the first begins within the one before, so that all of its own means are judged.
        let first = (i * length).saturating_sub(MOST_BEFORE + BEFORE);
        let Some(prediction) =
            predict_linearly(means.get(first..means.len().min((i + 1) * length)).unwrap_or_default())
        else {
            return Vec::new();
        };
        let spread_m_s2 = prediction.spread.hypot(prediction.gain * rounding_m_s2).max(least_m_s2);
        let time_s = |j: usize| signal.time_s(from + (first + prediction.before + j) * block);
        let judged = prediction.left.iter().enumerate().skip(if i == 0 { FEWEST_BEFORE } else { BEFORE });
        let of_mean = |(j, left): (usize, &f64)| {
            let before = &prediction.left[j.saturating_sub(BEFORE)..j];
            let before_m_s2 = (reduce::dot(before, before) / as_f64(before.len())).sqrt();
            Deviation { time_s: time_s(j), size: left.abs() / spread_m_s2.max(before_m_s2) }
        };
        judged.map(of_mean).collect()
    };
    (0..pieces).flat_map(of_piece).collect()
}

/// Standard uncertainty of means from a converter's step q: q/√12 of each sample that differs from the one
/// before; equal samples share one error.
fn rounding_of_means(samples: &[f64], block: usize) -> f64 {
    let step = converter_step(samples);
    let changes = samples.windows(2).filter(|w| (w[1] - w[0]).abs() >= step).count();
    let independent = as_f64(block * changes) / as_f64(samples.len().max(1));
    step / (12.0 * independent.max(1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{FindingKind, Span, example};
    use std::f64::consts::{PI, TAU};

    /// Two modes that ring from 20 ms on, noise of ± 0.5, and half sines of 2 ms at these times, s, with this
    /// peak.
    fn signal(at_s: &[f64], peak: f64) -> Signal {
        let noise = |i: u32| {
            let mut hash = (u64::from(i) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            hash = (hash ^ (hash >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            f64::from(((hash >> 32) & 0xFFFF) as u16) / 65_536.0 - 0.5
        };
        let force = |i: u32| {
            let t = f64::from(i) / 5e4;
            let mode = |hz: f64, size: f64| size * (-0.02 * TAU * hz * t).exp() * (TAU * hz * t).sin();
            let blow = |&from_s: &f64| {
                let x = (t - from_s) / 2e-3;
                if (0.0..1.0).contains(&x) { peak * (PI * x).sin() } else { 0.0 }
            };
            mode(80.0, 300.0) + mode(230.0, 100.0) + noise(i) + at_s.iter().map(blow).sum::<f64>()
        };
        Signal { noise_m_s2: 0.5, ..example::signal(5e4, (0..15_000).map(force).collect()) }
    }

    fn found(signal: &Signal, to_s: f64) -> Option<Finding> {
        let flight = example::flight(0.025, 0.1, vec![]);
        let events = example::events(0.02, to_s);
        judge_blows(std::slice::from_ref(signal), &flight, &events, &[], &example::cask(1.0, 5.0, 0.0))
    }

    #[test]
    fn a_train_of_blows_is_told_with_its_times() {
        for to_s in [0.1, 0.29] {
            let finding = found(&signal(&[0.04, 0.052, 0.07], 60.0), to_s).expect("blows");
            let FindingKind::Channel(ChannelFinding::Struck { after_s, .. }) = &finding.what else {
                panic!("{finding:?}")
            };
            let are = after_s
                .iter()
                .zip([0.020, 0.032, 0.050])
                .all(|(found, true_s)| (found - true_s).abs() < 2.5e-3);
            assert!(after_s.len() == 3 && are, "{after_s:?}");
        }
    }

    #[test]
    fn a_shock_of_one_channel_alone_is_electrical() {
        let code = |other: &Signal| {
            let signals = [signal(&[0.06], 400.0), Signal { name: "A2".into(), ..other.clone() }];
            let flight = example::flight(0.025, 0.1, vec![]);
            let events = example::events(0.02, 0.1);
            judge_blows(&signals, &flight, &events, &[], &example::cask(1.0, 5.0, 0.0)).map(|f| f.code)
        };
        assert_eq!(code(&signal(&[], 0.0)), Some(IssueCode::Electrical));
        assert_eq!(code(&signal(&[0.06], -60.0)), Some(IssueCode::SecondContact));
    }

    #[test]
    fn ringing_is_no_blow_nor_is_the_foot_of_the_slap_down() {
        assert!(found(&signal(&[], 0.0), 0.1).is_none());
        assert!(found(&signal(&[], 0.0), 0.29).is_none());
        assert!(found(&signal(&[0.096], 60.0), 0.1).is_none());
    }

    #[test]
    fn what_four_channels_show_a_little_at_one_time_stands_out_together() {
        let signal = signal(&[0.06], 60.0);
        let means = |struck: Range<u32>| {
            let size = |i: u32| if struck.contains(&i) { 2.5 } else { 1.0 };
            let mean = |i: u32| Deviation { time_s: 0.2 + f64::from(i) / 8e3, size: size(i) };
            (0..400).map(mean).collect()
        };
        let largest = |struck: Range<u32>, channels: usize| {
            let channels: Vec<ChannelDeviations<'_>> = (0..channels)
                .map(|_| ChannelDeviations { signal: &signal, means: means(struck.clone()) })
                .collect();
            combine_channels(&channels).into_iter().max_by(|a, b| a.size.total_cmp(&b.size)).expect("windows")
        };
        // Some 32 means of (2.5² − 1) over √64, and 8 over √16.
        let four = largest(200..212, 4);
        assert!((18.0..25.0).contains(&four.size) && (0.225..0.227).contains(&four.time_s), "{}", four.size);
        assert!((9.0..12.5).contains(&largest(200..212, 1).size));
        assert!(largest(0..0, 4).size.abs() < 1e-9);
        let (cask, flight) = (example::cask(1.0, 5.0, 0.0), example::flight(0.025, 0.1, vec![]));
        let events = example::events(0.02, 0.29);
        let sharp = |at_s| is_sharp(std::slice::from_ref(&signal), &flight, &events, &cask, at_s);
        // Before the first prediction nothing contradicts a shock.
        assert!(sharp(0.061) && sharp(0.022));
    }

    #[test]
    fn modes_that_the_prediction_has_no_room_for_are_no_shock() {
        let with_modes = |blow: f64| {
            let mut signal = signal(if blow > 0.0 { &[0.06] } else { &[] }, blow);
            for (i, force) in (0_u32..).zip(&mut signal.force_m_s2) {
                let t = f64::from(i) / 5e4 - 0.02;
                // The overtones of a slender beam up to 3.5 kHz, as strong in velocity.
                let mode = |m: f64| {
                    let w = TAU * 80.0 * ((2.0 * m + 1.0) / 3.0).powi(2);
                    2e-3 * w * (-0.01 * w * t).exp() * (w * t).cos()
                };
                *force += if t > 0.0 { (2_u32..10).map(|m| mode(f64::from(m))).sum() } else { 0.0 };
            }
            signal
        };
        for to_s in [0.1, 0.29] {
            assert!(found(&with_modes(0.0), to_s).is_none());
            assert!(found(&with_modes(300.0), to_s).is_some());
        }
    }

    #[test]
    fn a_coarse_converter_and_lost_samples_are_no_blow() {
        let mut coarse = signal(&[], 0.0);
        for f in &mut coarse.force_m_s2 {
            *f = (*f / 20.0).round() * 20.0;
        }
        assert!(found(&coarse, 0.1).is_none() && found(&coarse, 0.29).is_none());
        let mut lost = signal(&[], 0.0);
        lost.force_m_s2[2500..2600].fill(0.0);
        assert!(found(&lost, 0.1).is_some());
        lost.gaps = vec![Span { from: 2500, to: 2600 }];
        assert!(found(&lost, 0.1).is_none());
    }
}
