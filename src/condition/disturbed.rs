//! Finds the spikes and dropouts of cables and connectors, which no pulse of a cask resembles.

use super::runs::find_step_runs;
use crate::data::{ChannelFinding, Finding, Severity, Signal, Span};
use crate::numerics::{as_count, as_f64, reduce, robust};
use std::ops::Range;

/// A disturbance differs from its neighbours by this share of the channel's peak.
const SHARE_OF_PEAK: f64 = 0.05;
/// It also differs by this many standard deviations of the noise.
const NOISE_FACTOR: f64 = 20.0;
/// The two neighbours on either side of a spike agree within this share of its height, unlike those of a
/// pulse's peak.
const AGREEMENT: f64 = 0.3;
/// In this many samples on either side of a spike the median second difference is less than [`CALM_SHARE`] of
/// its height: a mode of a few samples per period has such extremes next to one another.
const AROUND: usize = 12;
const CALM_SHARE: f64 = 0.2;
/// A spike is a disturbance only if nothing beside it, on its channel or another, has this share of its
/// sharpness: bending waves of a struck cask pass a recorder's filter as pulses of two to five samples.
const AS_SHARP_SHARE: f64 = 0.4;
/// Time beside a spike that is searched for equally sharp samples, s; at least [`AROUND`] samples.
const BESIDE_S: f64 = 1e-3;
/// Longest spike, in samples: a longer break of contact is a dropout or a burst.
const LONGEST_SPIKE: usize = 5;
/// Largest area of a spike, as a share of the impact's velocity change: a larger one is a pulse with too few
/// samples.
const SHARE_OF_STEP: f64 = 0.1;
/// Spikes whose areas add to less are a note, m/s: 0.1 % of a slap-down.
const SMALL_M_S: f64 = 0.02;
/// Fewest equal samples in a row after a jump that make a dropout.
const LEAST_RUN: usize = 5;
/// Fewest equal samples without a jump, if noise keeps samples from repeating: if at most [`MOST_REPEATED`]
/// of them are equal to the last, 5 in 10⁸ runs are as long.
const LEAST_QUIET_RUN: usize = 8;
const MOST_REPEATED: f64 = 0.09;

/// Height above which a deviation is a disturbance, m/s².
fn height(peak_m_s2: f64, noise_m_s2: f64) -> f64 {
    (SHARE_OF_PEAK * peak_m_s2).max(NOISE_FACTOR * noise_m_s2)
}

fn is_lost(signal: &Signal, index: usize) -> bool {
    signal.gaps.iter().chain(&signal.clipped).any(|g| g.from <= index + 1 && index <= g.to)
}

/// Finds the spikes of one to five samples in one of the signals, with their total area; repairs nothing.
pub(super) fn find_spikes(signals: &[Signal], index: usize, velocity_step_m_s: f64) -> Option<Finding> {
    let signal = signals.get(index)?;
    let force = &signal.force_m_s2;
    let height = height(reduce::peak(force), signal.noise_m_s2);
    let most_m_s = SHARE_OF_STEP * velocity_step_m_s.abs();
    let (mut found, mut held_m_s) = (Vec::new(), 0.0);
    // Few samples differ that much from the one before: the costly tests follow for these alone.
    let high = find_step_runs(force, |before, f| (f - before).abs() > height);
    let mut free_from = 2;
    for i in high.into_iter().flat_map(|steps| steps.from + 1..=steps.to) {
        if i < free_from || i + 2 >= force.len() {
            continue;
        }
        let spike = (1..=LONGEST_SPIKE)
            .find_map(|width| spike_area(force, i, width, height).map(|a| (width, a)))
            .map(|(width, area)| (width, area / signal.sample_rate_hz))
            .filter(|(_, area_m_s)| *area_m_s < most_m_s && !is_lost(signal, i))
            .filter(|(width, _)| *width == 1 || is_sharpest(signals, signal, i..i + width));
        if let Some((width, area_m_s)) = spike {
            found.push(i);
            held_m_s += area_m_s;
            free_from = i + width + 1;
        }
    }
    let (first, last) = (found.first()?, found.last()?);
    let severity = if held_m_s > SMALL_M_S { Severity::Warning } else { Severity::Note };
    let found = ChannelFinding::Spikes { count: found.len(), held_m_s, severity };
    Some(found.tag(&signal.name).span(signal.time_s(*first), signal.time_s(*last)))
}

/// Area of the `width` samples from `i` on above their neighbours, m/s² × samples, if they are a spike.
fn spike_area(force: &[f64], i: usize, width: usize, height: f64) -> Option<f64> {
    let (before, run, after) =
        (force.get(i - 2..i)?, force.get(i..i + width)?, force.get(i + width..i + width + 2)?);
    let base = f64::midpoint(before[1], after[0]);
    let sign = (run[0] - base).signum();
    let least = run.iter().map(|f| sign * (f - base)).fold(f64::INFINITY, f64::min);
    let is_flat = [before[1] - before[0], after[0] - before[1], after[1] - after[0]]
        .iter()
        .all(|step| step.abs() < AGREEMENT * least);
    (least > height && is_flat && bend_around(force, i, width) < CALM_SHARE * least)
        .then(|| run.iter().map(|f| sign * (f - base)).sum())
}

/// Median of the second differences about the `width` samples from `i` on, without them, m/s².
fn bend_around(force: &[f64], i: usize, width: usize) -> f64 {
    let beside = [i.saturating_sub(AROUND)..i, i + width..(i + width + AROUND).min(force.len())];
    robust::median(&mut beside.into_iter().flat_map(|range| bends(&force[range])).collect::<Vec<_>>())
}

/// Sizes of the second differences of samples, m/s².
fn bends(force: &[f64]) -> impl Iterator<Item = f64> {
    force.windows(3).map(|f| (f[0] - 2.0 * f[1] + f[2]).abs())
}

/// True if nothing near a run of samples is almost as sharp, on its channel or on another with its rate.
fn is_sharpest(signals: &[Signal], signal: &Signal, run: Range<usize>) -> bool {
    let beside = AROUND.max(as_count(BESIDE_S * signal.sample_rate_hz));
    let sharpest = |signal: &Signal, over: Range<usize>| {
        let over = over.start.min(over.end)..over.end.min(signal.force_m_s2.len());
        bends(signal.force_m_s2.get(over).unwrap_or_default()).fold(0.0, f64::max)
    };
    let spike = sharpest(signal, run.start.saturating_sub(2)..run.end + 2);
    let [before, after] = [run.start.saturating_sub(beside + 2), run.end + beside + 2];
    let is_like = |other: &&Signal| {
        let is_of_rate = (other.sample_rate_hz / signal.sample_rate_hz - 1.0).abs() < 0.01;
        is_of_rate && other.name != signal.name
    };
    let on_others = signals.iter().filter(is_like).map(|other| {
        let [from, to] = [before, after].map(|i| other.index_from(signal.time_s(i)));
        sharpest(other, from..to)
    });
    let on_this_channel =
        [before..run.start.saturating_sub(1), run.end + 1..after].map(|over| sharpest(signal, over));
    on_this_channel.into_iter().chain(on_others).all(|sharp| sharp < AS_SHARP_SHARE * spike)
}

/// Marks runs of equal samples that no converter gives as gaps, sets them to 0 and reports them.
pub(super) fn mark_dropouts(signal: &mut Signal, noise_m_s2: f64, before_s: f64) -> Option<Finding> {
    let end = signal.index_from(before_s);
    let force = &signal.force_m_s2;
    let equal = find_repeats(force);
    if equal.is_empty() {
        return None;
    }
    let (low, high) = reduce::extremes(force, 0.0);
    let height = height(high.max(-low), noise_m_s2);
    let quiet = force.get(..end).unwrap_or_default();
    #[allow(clippy::float_cmp, reason = "a dropout repeats a sample to the bit")]
    let equal_pairs = quiet.windows(2).filter(|pair| pair[0] == pair[1]).count();
    let repeated = as_f64(equal_pairs) / as_f64(quiet.len().max(1));
    let is_noisy = quiet.len() > 50 && repeated < MOST_REPEATED;
    let jump = |a: usize, b: usize| force.get(a).zip(force.get(b)).map_or(0.0, |(x, y)| (x - y).abs());
    let dropouts: Vec<Span> = equal
        .into_iter()
        .map(|steps| (steps.from, steps.to + 1))
        .filter(|&(from, to)| {
            let jumps =
                from.checked_sub(1).is_some_and(|i| jump(i, from) > height) || jump(to - 1, to) > height;
            let least = if is_noisy { LEAST_QUIET_RUN } else { usize::MAX };
            #[allow(clippy::float_cmp, reason = "a limit repeats to the bit")]
            let at_limit = (force[from] == low || force[from] == high) && force[from] != 0.0;
            (to - from >= least || jumps)
                && !at_limit
                && !is_lost(signal, from)
                && !is_rounded(force, from..to)
        })
        .map(|(from, to)| Span { from, to })
        .collect();
    let (first, last) = (*dropouts.first()?, *dropouts.last()?);
    let samples: usize = dropouts.iter().map(|d| d.to - d.from).sum();
    let most_m_s = dropouts.iter().map(|d| bridge_area_m_s(signal, *d)).fold(0.0, f64::max);
    for span in &dropouts {
        signal.force_m_s2[span.from..span.to].fill(0.0);
    }
    let stretches = dropouts.len();
    signal.gaps.extend(dropouts);
    signal.gaps.sort_by_key(|gap| gap.from);
    let finding = ChannelFinding::Dropout { stretches, samples, most_m_s };
    Some(finding.tag(&signal.name).span(signal.time_s(first.from), signal.time_s(last.to)))
}

/// True if equal samples are one step of numbers cut to three digits, such as `7.27E+02`: the values around
/// the run change by whole steps of a size that fits the numbers.
fn is_rounded(force: &[f64], run: Range<usize>) -> bool {
    /// The last of three digits is at least this share of the number.
    const LEAST_STEP: f64 = 9e-4;
    let about = force.get(run.start.saturating_sub(AROUND)..run.end + AROUND).unwrap_or_default();
    let step = |pair: &[f64]| (pair[1] - pair[0]).abs();
    let steps = || about.windows(2).map(step).filter(|step| *step > 0.0);
    let least = steps().fold(f64::INFINITY, f64::min);
    let is_whole = |step: f64| (step / least - (step / least).round()).abs() < 0.05;
    let mut ends = [run.start, run.end].into_iter().filter_map(|at| force.get(at.checked_sub(1)?..=at));
    least >= LEAST_STEP * force[run.start].abs()
        && steps().count() > LEAST_RUN
        && steps().all(is_whole)
        && ends.all(|end| step(end) < 1.5 * least)
}

/// Finds the runs of at least [`LEAST_RUN`] equal samples, from the first step between them to just after the
/// last: each has a step whose index is a multiple of `LEAST_RUN − 1`, so that the others need no test.
fn find_repeats(force: &[f64]) -> Vec<Span> {
    #[allow(clippy::float_cmp, reason = "a dropout repeats a sample to the bit")]
    let repeats = |&i: &usize| force.get(i).zip(force.get(i + 1)).is_some_and(|(a, b)| a == b);
    let mut found: Vec<Span> = Vec::new();
    // Few of the tested steps have an equal one next to them: without this test the processor mispredicts at
    // each repeated value of a coarse converter.
    let is_run = |i: usize| repeats(&i) & (repeats(&(i + 1)) | (i > 0 && repeats(&(i - 1))));
    for i in (0..force.len()).step_by(LEAST_RUN - 1) {
        if is_run(i) && found.last().is_none_or(|before| i >= before.to) {
            let from = (0..i).rev().take_while(repeats).last().unwrap_or(i);
            let to = (i..force.len()).take_while(repeats).last().map_or(i, |last| last + 1);
            found.extend((to + 1 - from >= LEAST_RUN).then_some(Span { from, to }));
        }
    }
    found
}

/// Area of a straight bridge over a span, against 0, m/s.
fn bridge_area_m_s(signal: &Signal, span: Span) -> f64 {
    let at = |i: Option<usize>| i.and_then(|i| signal.force_m_s2.get(i)).copied().unwrap_or(0.0);
    let middle = f64::midpoint(at(span.from.checked_sub(1)), at(Some(span.to)));
    middle.abs() * as_f64(span.to - span.from) / signal.sample_rate_hz
}

#[cfg(test)]
mod tests {
    use super::super::tests::signal;
    use super::*;
    use crate::data::FindingKind;
    use crate::data::example::noise;

    /// 50 ms of free fall and a half sine of 40 ms at 10 kHz, noise of 1 m/s².
    fn pulse() -> Signal {
        let shape = |i: u32| {
            if i < 500 { 0.0 } else { 4000.0 * (f64::from(i - 500) / 400.0 * std::f64::consts::PI).sin() }
        };
        signal((0..900).map(|i| shape(i) + noise(i, 1)).collect())
    }

    #[test]
    fn a_pulse_has_neither() {
        assert!(find_spikes(&[pulse()], 0, 20.0).is_none());
        assert!(mark_dropouts(&mut pulse(), 1.0, 0.04).is_none());
        // A pulse of five samples, and ringing of fifteen samples per period, are no spikes either.
        let mut short = pulse();
        short.force_m_s2[300..305].copy_from_slice(&[2000.0, 3600.0, 4000.0, 3500.0, 1900.0]);
        assert!(find_spikes(&[short], 0, 1.5).is_none());
        let ringing = |i: u32| 3000.0 * (f64::from(i) * std::f64::consts::TAU / 15.0).sin() + noise(i, 2);
        assert!(find_spikes(&[signal((0..900).map(ringing).collect())], 0, 20.0).is_none());
    }

    #[test]
    fn spikes_of_one_to_five_samples_are_named_with_what_they_hold() {
        for width in 1..=5 {
            let mut spiky = pulse();
            for f in &mut spiky.force_m_s2[200..200 + width] {
                *f += 900.0;
            }
            let finding = find_spikes(&[spiky], 0, 20.0).expect("a spike");
            let FindingKind::Channel(ChannelFinding::Spikes { count: 1, held_m_s: held, .. }) = finding.what
            else {
                panic!("{finding:?}")
            };
            // 900 m/s² for 0.1 ms a sample, noise of 1 m/s² on it.
            #[allow(clippy::cast_precision_loss, reason = "at most 5")]
            let expected = 0.09 * width as f64;
            assert!((held - expected).abs() < 0.01 * expected + 6e-4, "{held} {expected}");
        }
        let mut small = pulse();
        small.force_m_s2[100] += 205.0;
        small.sample_rate_hz = 2e4;
        assert_eq!(find_spikes(&[small], 0, 20.0).map(|i| i.severity), Some(Severity::Note));
    }

    #[test]
    fn a_wave_that_another_channel_shows_as_sharp_is_no_spike() {
        // A bending wave after a recorder's filter is a pulse of a few samples.
        let struck = |at: usize, share: f64| {
            let mut struck = pulse();
            for (f, wave) in struck.force_m_s2[at..].iter_mut().zip([-10.0, -600.0, -1100.0, -650.0, -20.0]) {
                *f += share * wave;
            }
            struck
        };
        let other = |name: &str, at: usize, share: f64| Signal { name: name.into(), ..struck(at, share) };
        let is_spike = |signals: [Signal; 2]| find_spikes(&signals, 0, 20.0).is_some();
        assert!(is_spike([struck(600, 1.0), other("A2", 600, 0.1)]));
        assert!(is_spike([struck(600, 1.0), other("A2", 700, 1.0)]));
        assert!(!is_spike([struck(600, 1.0), other("A2", 607, -0.6)]));
    }

    #[test]
    fn a_dropout_is_a_gap() {
        for from in [100, 700] {
            let mut dropped = pulse();
            let held = if from == 100 { dropped.force_m_s2[from] } else { 0.0 };
            dropped.force_m_s2[from..from + 20].fill(held);
            assert!(mark_dropouts(&mut dropped, 1.0, 0.04).is_some(), "{from}");
            assert_eq!(dropped.gaps, [Span { from, to: from + 20 }]);
        }
    }

    #[test]
    fn a_coarse_converter_repeats_itself_without_dropping_out() {
        let mut coarse = pulse();
        for f in &mut coarse.force_m_s2 {
            *f = (*f / 10.0).round() * 10.0;
        }
        assert!(mark_dropouts(&mut coarse, 1.0, 0.04).is_none());
    }
}
