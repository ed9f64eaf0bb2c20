//! Finds the runs of samples that stand at a limit of the measuring chain.

use super::levels::{LimitSearch, flattest_top_fall};
use super::runs::find_runs;
use crate::data::{Axis, Channel, ChannelFinding, Finding, LEAST_FLANK, Span};
use crate::numerics::{as_f64, reduce, robust};
use std::cell::LazyCell;

/// Fewest samples at an extreme that make a flat top.
const LEAST_RUN: usize = 3;

/// Samples within this many standard deviations of the noise stand at an extreme: noise may be added after
/// the limit.
const NOISE_FACTOR: f64 = 6.0;

/// A reading above this share of the full scale, beside the noise, exceeds it: data sheets round the full
/// scale, and a filter after the limit rings.
const BEYOND_SHARE: f64 = 1.05;

/// Values that differ by less than this share of the peak are equal.
const LEAST_STEP: f64 = 1e-9;

/// A limit acts after the sensor's noise and removes it: a level with at least this share of the noise from
/// sample to sample is a constant force, such as that of a cask that is crushed. Noise that is added after
/// the limit is assumed to be less.
const LEAST_NOISE_SHARE: f64 = 0.6;

/// Smallest fall of a limited flank, as a share of the peak.
const FLANK_SHARE: f64 = 0.2;

/// Finds the runs of `force` (m/s², of `channel`, with `noise_m_s2` on it) at the stated full scale or flat
/// at an extreme, as indices.
///
/// The first `quiet` samples lie before the impact; `level` was subtracted from `force`.
pub(super) fn find_clipped(
    channel: &Channel,
    force: &[f64],
    level: f64,
    noise_m_s2: f64,
    quiet: usize,
) -> Vec<Span> {
    let roughness = roughness(force.get(..quiet).unwrap_or_default());
    let mut spans = Vec::new();
    if let Some(limit) = channel.full_scale {
        let limit_m_s2 = (limit * channel.scale_m_s2).abs();
        // A run is a limit if at least one sample reaches it; the others lie within the noise of it.
        let (at, near) = (0.999 * limit_m_s2, limit_m_s2 - NOISE_FACTOR * noise_m_s2);
        let reaches = |span: &Span| force[span.from..span.to].iter().any(|f| (f + level).abs() >= at);
        spans.extend(find_runs(force, |f| (f + level).abs() >= near.min(at)).into_iter().filter(reaches));
    }
    let (low, high) = reduce::extremes(force, 0.0);
    let peak = high.max(-low);
    // If the converter's step exceeds the noise, all values within a step are equal to it.
    let is_resampled = channel.time_jitter_s > 0.0;
    let step = LazyCell::new(|| step(force, is_resampled, peak));
    let (noise, least) = (NOISE_FACTOR * noise_m_s2, LEAST_STEP * peak);
    let step_beyond = |noise: f64| {
        let is_noise = !is_resampled && reduce::least_step_beyond(force, least, noise - least) == 0.0;
        if is_noise { 0.0 } else { *step }
    };
    let band = noise.max(least + step_beyond(noise));
    let is_new = |known: &[Span], span: &Span| known.iter().all(|s| s.to <= span.from || span.to <= s.from);
    for extreme in [low, high] {
        if extreme.abs() < 4.0 * band {
            continue;
        }
        for span in find_runs(force, |f| (f - extreme).abs() <= band) {
            let is_limit =
                |span| is_flat_top(force, span, band, *step) && !carries_noise(force, span, roughness);
            if span.to - span.from >= LEAST_RUN && is_new(&spans, &span) && is_limit(span) {
                spans.push(span);
            }
        }
    }
    if channel.axis == Axis::Transverse {
        // Noise of the converter is added after a limit of the amplifier: only these levels show such a
        // limit.
        let mut limits = LimitSearch::new(force, noise_m_s2, step_beyond(noise_m_s2).max(least)).find();
        limits.retain(|span| is_new(&spans, span));
        spans.extend(limits);
        spans.extend(find_limited_flanks(force, roughness, peak));
    }
    spans.sort_by_key(|s| s.from);
    spans
}

/// Finds the flanks towards 0, or through it, that fall in a straight line between two kinks: no force does
/// so, the amplifier could not follow it. An impact limiter rises in a straight line too, but its fall is
/// rounded.
fn find_limited_flanks(force: &[f64], roughness: f64, peak: f64) -> Vec<Span> {
    let slopes: Vec<f64> = force.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut flanks = LimitSearch::new(&slopes, roughness * std::f64::consts::SQRT_2, 0.0).find();
    flanks.retain(|flank| {
        let (from, to) = (force[flank.from], force[flank.to]);
        let is_long = flank.to - flank.from >= LEAST_FLANK && (from - to).abs() > FLANK_SHARE * peak;
        is_long && (from.abs() > to.abs() || (from * to < 0.0 && from.abs() > FLANK_SHARE / 2.0 * peak))
    });
    flanks
}

/// Reports samples beyond the stated full scale and its noise: the full scale is stated wrongly.
pub(super) fn judge_full_scale(channel: &Channel, force: &[f64], noise_m_s2: f64) -> Option<Finding> {
    let full_scale_m_s2 = (channel.full_scale? * channel.scale_m_s2).abs();
    let reads_m_s2 = reduce::peak(force);
    let most_m_s2 = BEYOND_SHARE * full_scale_m_s2 + NOISE_FACTOR * noise_m_s2;
    let finding = ChannelFinding::BeyondFullScale { reads_m_s2, full_scale_m_s2 };
    (reads_m_s2 > most_m_s2).then(|| finding.tag(&channel.name))
}

/// Returns the converter's step, the least distance of neighbours; 0 if the samples show none. If they were
/// resampled to even times, only equal neighbours still have their recorded value.
#[allow(clippy::float_cmp, reason = "between equal samples a cubic is theirs to the bit")]
fn step(force: &[f64], is_resampled: bool, peak: f64) -> f64 {
    let least = LEAST_STEP * peak;
    if !is_resampled {
        return Some(reduce::least_step(force, least)).filter(|step| step.is_finite()).unwrap_or(0.0);
    }
    let mut levels: Vec<f64> = force.windows(2).filter(|w| w[0] == w[1]).map(|w| w[0]).collect();
    levels.sort_unstable_by(f64::total_cmp);
    let step = reduce::least_step(&levels, least);
    // A limit and the level at rest alone are no steps.
    if step < peak / 4.0 { step } else { 0.0 }
}

/// Standard deviation of the noise from the steps between samples, to which slow oscillations add nothing.
fn roughness(quiet: &[f64]) -> f64 {
    let pairs = quiet.windows(2).step_by(robust::stride(quiet.len()));
    let steps: Vec<f64> = pairs.map(|w| w[1] - w[0]).filter(|d| d.is_finite()).collect();
    if steps.len() < 8 { 0.0 } else { robust::spread(&steps) / std::f64::consts::SQRT_2 }
}

/// True if the inside of a flat run still has the sensor's noise.
fn carries_noise(force: &[f64], span: Span, roughness: f64) -> bool {
    let inside = &force[span.from + 1..(span.to - 1).max(span.from + 1)];
    let steps: f64 = inside.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
    let count = inside.len().saturating_sub(1);
    count > 0 && roughness > 0.0 && (steps / as_f64(count) / 2.0).sqrt() > LEAST_NOISE_SHARE * roughness
}

/// True if the signal enters and leaves the flat run steeply, as at a stop, and not as over the flattest
/// rounded top.
fn is_flat_top(force: &[f64], span: Span, band: f64, step: f64) -> bool {
    let run = span.to - span.from;
    // The comparison reaches a quarter of the run beyond it: far enough for the slope to exceed the noise.
    let reach = (run / 4).max(1);
    let top = force[span.from];
    let largest_fall = |beyond: &[f64]| beyond.iter().map(|f| (top - f).abs()).fold(0.0, f64::max);
    let before = largest_fall(&force[span.from.saturating_sub(reach)..span.from]);
    let after = largest_fall(&force[span.to..(span.to + reach).min(force.len())]);
    let (low, high) = reduce::extremes(&force[span.from..span.to], top);
    // The range of the run, and at least half of the band: a few samples of noise may lie near one another by
    // chance.
    let depth = (high - low + step).max(band / 2.0);
    // The less steep side counts: a kink has one steep side.
    before.min(after) > depth * (flattest_top_fall(run, reach) - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example::{self, noise};

    fn channel(full_scale: Option<f64>) -> Channel {
        Channel { scale_m_s2: 9.806_65, unit: "g".into(), full_scale, ..example::channel(vec![]) }
    }

    fn pulse(limit: f64) -> Vec<f64> {
        (0..200).map(|i| (4000.0 * (f64::from(i) / 200.0 * std::f64::consts::PI).sin()).min(limit)).collect()
    }

    #[test]
    fn a_flat_top_is_found() {
        let spans = find_clipped(&channel(None), &pulse(3000.0), 0.0, 0.0, 0);
        assert_eq!(spans.len(), 1);
        assert!(spans[0].from > 40 && spans[0].to < 160);
    }

    #[test]
    fn a_flank_that_the_amplifier_does_not_follow_is_limited() {
        let quiet = vec![0.0; 200];
        let limited = |force: &[f64], most: f64| {
            let mut last = 0.0;
            let follow = |f: &f64| {
                last += (f - last).clamp(-most, most);
                last
            };
            let behind: Vec<f64> = [&quiet[..], force, &quiet].concat().iter().map(follow).collect();
            let noisy: Vec<f64> = behind.iter().zip(0..).map(|(f, i)| f + 0.5 * noise(i, 3)).collect();
            find_limited_flanks(&noisy, roughness(&noisy[..200]), 4000.0)
        };
        // A half sine of 4000 over 200 samples rises by up to 63 a sample.
        let [flank] = limited(&pulse(1e9), 30.0)[..] else { panic!("one flank") };
        assert!(flank.from > 300 && flank.to - flank.from > 60, "{flank:?}");
        assert_eq!(limited(&pulse(1e9), 1e9), []);
        // The second force passes through 0 into a deeper trough and rises again.
        let through = |most: f64| {
            let swing = |i: u32| if i < 100 { 2500.0 } else { 4000.0 } * (f64::from(i) * 0.031_416).sin();
            limited(&(0..200).map(swing).collect::<Vec<_>>(), most)
        };
        assert_eq!((through(60.0).len(), through(1e9).len()), (2, 0));
        // An impact limiter rises in a straight line to its plateau, and releases gradually.
        let crush = |i: u32| (75.0 * f64::from(i)).min(3000.0) * (1.0 - (f64::from(i) / 200.0).powi(8));
        assert_eq!(limited(&(0..200).map(crush).collect::<Vec<_>>(), 1e9), []);
    }

    #[test]
    fn a_rounded_top_of_a_coarse_converter_is_not() {
        // 28 of 4000 is a step of a 10-bit converter over 3.6 times the peak.
        for step in [10.0, 28.0] {
            let coarse: Vec<f64> = pulse(1e9).iter().map(|f| (f / step).round() * step).collect();
            assert!(find_clipped(&channel(None), &coarse, 0.0, 0.0, 0).is_empty(), "{step}");
        }
        assert!(find_clipped(&channel(None), &pulse(1e9), 0.0, 0.0, 0).is_empty());
    }

    /// Simulates quiet, a half sine with ringing of a fifth of it and the ringing that follows, with noise of
    /// less than a step, as a converter of `bits` bits over `range` peaks writes it; the pulse has `length`
    /// samples.
    fn converted(bits: i32, range: f64, length: u32, seed: u64) -> Vec<f64> {
        use std::f64::consts::PI;
        let codes = 2_f64.powi(bits - 1);
        let step = 4000.0 * range / codes;
        let sample = |i: u32| {
            let x = (f64::from(i) - 200.37) / f64::from(length);
            let half_sine = if (0.0..1.0).contains(&x) { (PI * x).sin() } else { 0.0 };
            let ringing = 0.2 * (-0.4 * x).exp() * (2.0 * PI * (2.3 + 0.01 * f64::from(bits)) * x).sin();
            let force = 4000.0 * (half_sine + if x > 0.0 { ringing } else { 0.0 });
            ((force / step + 0.2 * noise(i, seed)).round()).clamp(-codes, codes - 1.0) * step
        };
        (0..200 + 4 * length).map(sample).collect()
    }

    #[test]
    fn a_converter_far_above_the_peak_is_not_clipped_and_one_below_it_is() {
        for (bits, seed) in [(10, 1), (11, 2), (12, 3)] {
            for length in [20, 47, 110, 260, 900, 3000] {
                let found = |range: f64| {
                    let force = converted(bits, range, length, seed);
                    find_clipped(&channel(None), &force, 0.0, robust::spread(&force[..200]), 200)
                };
                for range in [3.0, 4.1, 5.9, 8.3, 11.7, 16.9, 23.0, 30.0] {
                    assert!(found(range).is_empty(), "{bits} bits over {range} peaks, {length} samples");
                }
                // Ringing divides the flat top of the shortest pulse.
                for range in if length > 20 { &[0.4, 0.5, 0.8][..] } else { &[0.4] } {
                    assert!(!found(*range).is_empty(), "{bits} bits over {range} peaks, {length} samples");
                }
            }
        }
    }

    #[test]
    fn three_samples_about_a_smooth_peak_are_no_flat_top() {
        // Samples of the peak, 0.02 of the pulse apart, that falls with the second and with the fourth power.
        let top = |power: i32| -> Vec<f64> {
            (-25..=25).map(|i| 4000.0 * (1.0 - (f64::from(i) / 25.0).abs().powi(power))).collect()
        };
        for noise_m_s2 in [0.05, 0.5, 1.1, 2.0, 5.0] {
            for power in [2, 4] {
                assert!(
                    find_clipped(&channel(None), &top(power), 0.0, noise_m_s2, 0).is_empty(),
                    "{noise_m_s2} {power}"
                );
            }
        }
    }

    #[test]
    fn samples_moved_to_other_times_keep_the_converters_steps() {
        let moved = Channel { time_jitter_s: 1e-5, ..channel(None) };
        // The values are interpolated by cubics at varying positions between the samples, within the range of
        // those.
        let between = |force: &[f64]| -> Vec<f64> {
            let (low, high) = reduce::extremes(force, 0.0);
            let cubic = |(w, i): (&[f64], i32)| {
                let x = 0.5 + 0.3 * (0.7 * f64::from(i)).sin();
                let [before, slope, after] = [w[1] - w[0], w[2] - w[1], w[3] - w[2]];
                let (left, right) = ((slope - before) / 2.0, (after - slope) / 2.0);
                (w[1] + x * (slope + (x - 1.0) * (left + (x + 1.0) * (right - left) / 3.0))).clamp(low, high)
            };
            force.windows(4).zip(0..).map(cubic).collect()
        };
        for length in [110, 900] {
            let clipped_within =
                |range: f64| find_clipped(&moved, &between(&converted(12, range, length, 4)), 0.0, 0.0, 200);
            assert!(clipped_within(10.0).is_empty() && clipped_within(25.0).is_empty(), "{length}");
            assert!(!clipped_within(0.5).is_empty() && !clipped_within(0.8).is_empty(), "{length}");
        }
    }

    #[test]
    fn a_flat_top_with_noise_on_it_is_found_and_a_rounded_one_is_not() {
        let noisy = |limit: f64| -> Vec<f64> {
            let hash = |i: usize| f64::from(u16::try_from(i * 40_503 % 65_536).unwrap_or(0)) / 65_536.0 - 0.5;
            pulse(limit).iter().enumerate().map(|(i, f)| f + 3.4 * hash(i)).collect()
        };
        // Uniform noise of ±1.7 has a standard deviation of 1.
        assert_eq!(find_clipped(&channel(None), &noisy(3800.0), 0.0, 1.0, 0).len(), 1);
        assert!(find_clipped(&channel(None), &noisy(1e9), 0.0, 1.0, 0).is_empty());
    }

    #[test]
    fn the_stated_full_scale_counts() {
        // 300 g is 2942 m/s².
        assert_eq!(find_clipped(&channel(Some(300.0)), &pulse(1e9), 0.0, 0.0, 0).len(), 1);
        assert!(find_clipped(&channel(Some(500.0)), &pulse(1e9), 0.0, 0.0, 0).is_empty());
    }

    /// 100 samples of free fall and a pulse cut at 3000 m/s², with noise before the limit and after it.
    fn limited(before: f64, after: f64) -> Vec<f64> {
        let shape = |i: u32| {
            if i < 100 { 0.0 } else { 4000.0 * (f64::from(i - 100) / 200.0 * std::f64::consts::PI).sin() }
        };
        (0..300).map(|i| (shape(i) + before * noise(i, 1)).min(3000.0) + after * noise(i, 2)).collect()
    }

    #[test]
    fn a_force_that_stays_level_keeps_its_noise_and_a_limit_does_not() {
        let crushing: Vec<f64> =
            limited(0.0, 0.0).iter().zip(0..).map(|(f, i)| f + 5.0 * noise(i, 3)).collect();
        let along = Channel { axis: Axis::Axial, ..channel(None) };
        assert!(find_clipped(&along, &crushing, 0.0, 5.0, 100).is_empty());
        // A constant force of an impact limiter rings with the body in a transverse channel, by 2 % of it
        // here; a level with noise alone, which a converter adds after the limit, is a limit.
        let rings = |i: u32| if i < 100 { 0.0 } else { 60.0 * (0.15 * f64::from(i)).sin() };
        let ringing: Vec<f64> = crushing.iter().zip(0..).map(|(f, i)| f + rings(i)).collect();
        assert!(find_clipped(&channel(None), &ringing, 0.0, 5.0, 100).is_empty());
        assert_eq!(find_clipped(&channel(None), &crushing, 0.0, 5.0, 100).len(), 1);
        assert_eq!(find_clipped(&channel(None), &limited(5.0, 0.0), 0.0, 5.0, 100).len(), 1);
        assert_eq!(find_clipped(&channel(None), &limited(5.0, 1.5), 0.0, 5.2, 100).len(), 1);
        // The stated limit of 300 g is 2942 m/s²: then noise does not matter.
        assert!(!find_clipped(&channel(Some(300.0)), &crushing, 0.0, 5.0, 100).is_empty());
    }

    #[test]
    fn what_reads_beyond_its_full_scale_says_so() {
        let found = |full_scale: f64| judge_full_scale(&channel(Some(full_scale)), &pulse(3900.0), 5.0);
        assert!(found(300.0).is_some() && found(390.0).is_none() && found(500.0).is_none());
    }
}
