//! Samples to the runs that stand at a limit of the measuring chain.

use super::levels::Gauge;
use super::runs::runs;
use crate::data::{Channel, ChannelFinding, Finding, Span};
use crate::numerics::reduce;

/// Standard deviations of the noise within which samples count as standing at the stated full scale: noise
/// may come after the limit.
const NOISE_FACTOR: f64 = 6.0;

/// A reading above this share of the full scale, beside the noise, is beyond it: data sheets round it, and a
/// filter behind the limit rings.
const BEYOND: f64 = 1.05;

/// Values that differ by less than this share of the peak are the same.
const LEAST_STEP: f64 = 1e-9;

/// A bending cask rings on through a force that stays level, a stiff one along its axis does not: there, and
/// in other quantities, what still has this share of the noise is no limit. Noise that comes after the limit
/// is taken to be less.
const NOISE_LEFT: f64 = 0.6;

/// Runs of `force` (m/s², of `channel`, with `noise_m_s2` on it) at the stated full scale, or at a level that
/// no force has, as indices; `rings` where a force that stays level would. What was taken off is `rest`.
pub(super) fn clipped(
    channel: &Channel,
    force: &[f64],
    rest: f64,
    noise_m_s2: f64,
    rings: bool,
) -> Vec<Span> {
    let mut spans = Vec::new();
    if let Some(limit) = channel.full_scale {
        // One flat from its first to its last sample within the noise of the limit.
        let limit_m_s2 = (limit * channel.scale_m_s2).abs();
        let (at, near) = (0.999 * limit_m_s2, limit_m_s2 - NOISE_FACTOR * noise_m_s2);
        let reaches = |span: &Span| force[span.from..span.to].iter().any(|f| (f + rest).abs() >= at);
        spans.extend(runs(force, |f| (f + rest).abs() >= near.min(at)).into_iter().filter(reaches));
    }
    let gauge = Gauge::new(force, noise_m_s2, converter_step(channel, force, noise_m_s2));
    let is_known = |s: &Span| spans.iter().any(|known: &Span| known.from < s.to && s.from < known.to);
    let limits: Vec<Span> =
        gauge.limits(if rings { 1.0 } else { NOISE_LEFT }).into_iter().filter(|s| !is_known(s)).collect();
    spans.extend(limits);
    spans.sort_by_key(|s| s.from);
    spans
}

/// Samples beyond the stated full scale and the noise on it, which then is none.
pub(super) fn beyond_full_scale(channel: &Channel, force: &[f64], noise_m_s2: f64) -> Option<Finding> {
    let full_scale_m_s2 = (channel.full_scale? * channel.scale_m_s2).abs();
    let reads_m_s2 = reduce::peak(force);
    let most_m_s2 = BEYOND * full_scale_m_s2 + NOISE_FACTOR * noise_m_s2;
    let found = ChannelFinding::BeyondFullScale { reads_m_s2, full_scale_m_s2 };
    (reads_m_s2 > most_m_s2).then(|| found.on(&channel.name))
}

/// The converter's step where it exceeds the noise, else 0.
pub(super) fn converter_step(channel: &Channel, force: &[f64], noise: f64) -> f64 {
    let peak = reduce::peak(force);
    let (moved, least) = (channel.time_jitter_s > 0.0, LEAST_STEP * peak);
    let is_noise = !moved && reduce::least_step_beyond(force, least, noise - least) == 0.0;
    Some(step(force, moved, peak)).filter(|s| !is_noise && s.is_finite()).unwrap_or(0.0).max(least)
}

/// The converter's step, infinite where the samples tell none: the least distance of neighbours. Of samples
/// that were `moved` to other times only those among equals stand where they did.
#[allow(clippy::float_cmp, reason = "between equal samples a cubic is theirs to the bit")]
fn step(force: &[f64], moved: bool, peak: f64) -> f64 {
    let least = LEAST_STEP * peak;
    if !moved {
        return reduce::least_step(force, least);
    }
    let mut levels: Vec<f64> = force.windows(2).filter(|w| w[0] == w[1]).map(|w| w[0]).collect();
    levels.sort_unstable_by(f64::total_cmp);
    let step = reduce::least_step(&levels, least);
    // A limit and rest alone are no steps.
    if step < peak / 4.0 { step } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::STANDARD_GRAVITY_M_S2;
    use crate::data::example::{self, noise};
    use crate::numerics::robust;

    fn channel(full_scale: Option<f64>) -> Channel {
        Channel { scale_m_s2: 9.806_65, unit: "g".into(), full_scale, ..example::channel(vec![]) }
    }

    fn pulse(limit: f64) -> Vec<f64> {
        (0..200).map(|i| (4000.0 * (f64::from(i) / 200.0 * std::f64::consts::PI).sin()).min(limit)).collect()
    }

    #[test]
    fn a_flat_top_is_found() {
        let spans = clipped(&channel(None), &pulse(3000.0), 0.0, 0.0, true);
        assert_eq!(spans.len(), 1);
        assert!(spans[0].from > 40 && spans[0].to < 160);
    }

    #[test]
    fn a_rounded_top_of_a_coarse_converter_is_not() {
        // 28 of 4000 is a step of a 10-bit converter over 3.6 times the peak.
        for step in [10.0, 28.0] {
            let coarse: Vec<f64> = pulse(1e9).iter().map(|f| (f / step).round() * step).collect();
            assert!(clipped(&channel(None), &coarse, 0.0, 0.0, true).is_empty(), "{step}");
        }
        assert!(clipped(&channel(None), &pulse(1e9), 0.0, 0.0, true).is_empty());
    }

    /// Quiet, a half sine with ringing of a fifth of it and the ringing that stays, with noise of less than a
    /// step, as a converter of so many bits over so many peaks writes it; the pulse has `length` samples.
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
                    clipped(&channel(None), &force, 0.0, robust::spread(&force[..200]), true)
                };
                for range in [3.0, 4.1, 5.9, 8.3, 11.7, 16.9, 23.0, 30.0] {
                    assert!(found(range).is_empty(), "{bits} bits over {range} peaks, {length} samples");
                }
                // Ringing parts the flat top of the shortest.
                for range in if length > 20 { &[0.4, 0.5, 0.8][..] } else { &[0.4] } {
                    assert!(!found(*range).is_empty(), "{bits} bits over {range} peaks, {length} samples");
                }
            }
        }
    }

    #[test]
    fn three_samples_about_a_smooth_peak_are_no_flat_top() {
        // The peak, samples 0.02 of the pulse apart, as flat as a second and a fourth power make it.
        let top = |power: i32| -> Vec<f64> {
            (-25..=25).map(|i| 4000.0 * (1.0 - (f64::from(i) / 25.0).abs().powi(power))).collect()
        };
        for noise_m_s2 in [0.05, 0.5, 1.1, 2.0, 5.0] {
            for power in [2, 4] {
                assert!(
                    clipped(&channel(None), &top(power), 0.0, noise_m_s2, true).is_empty(),
                    "{noise_m_s2} {power}"
                );
            }
        }
    }

    #[test]
    fn samples_moved_to_other_times_keep_the_converters_steps() {
        let moved = Channel { time_jitter_s: 1e-5, ..channel(None) };
        // Cubics at a place that wanders between the samples, no farther than those reach.
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
                |range: f64| clipped(&moved, &between(&converted(12, range, length, 4)), 0.0, 0.0, true);
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
        assert_eq!(clipped(&channel(None), &noisy(3800.0), 0.0, 1.0, true).len(), 1);
        assert!(clipped(&channel(None), &noisy(1e9), 0.0, 1.0, true).is_empty());
    }

    #[test]
    fn the_stated_full_scale_counts() {
        // 300 g is 2942 m/s².
        assert_eq!(clipped(&channel(Some(300.0)), &pulse(1e9), 0.0, 0.0, true).len(), 1);
        assert!(clipped(&channel(Some(500.0)), &pulse(1e9), 0.0, 0.0, true).is_empty());
    }

    #[test]
    fn what_reads_beyond_its_full_scale_says_so() {
        let found = |full_scale: f64| beyond_full_scale(&channel(Some(full_scale)), &pulse(3900.0), 5.0);
        assert!(found(300.0).is_some() && found(390.0).is_none() && found(500.0).is_none());
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
        // A force that a limiter keeps level rings with the body that it pushes, by 2 % of it here.
        let rings = |i: u32| if i < 100 { 0.0 } else { 60.0 * (0.15 * f64::from(i)).sin() };
        let crushing: Vec<f64> =
            limited(0.0, 0.0).iter().zip(0..).map(|(f, i)| f + rings(i) + 5.0 * noise(i, 3)).collect();
        assert!(clipped(&channel(None), &crushing, 0.0, 5.0, true).is_empty());
        assert_eq!(clipped(&channel(None), &limited(5.0, 0.0), 0.0, 5.0, true).len(), 1);
        assert_eq!(clipped(&channel(None), &limited(5.0, 1.5), 0.0, 5.2, true).len(), 1);
        // All of the noise behind the limit, as a converter has it; along the axis that may be a force.
        assert_eq!(clipped(&channel(None), &limited(0.0, 5.0), 0.0, 5.0, true).len(), 1);
        assert!(clipped(&channel(None), &limited(0.0, 5.0), 0.0, 5.0, false).is_empty());
        // One flat from its first to its last sample within the noise of the stated limit.
        let stated =
            clipped(&channel(Some(3000.0 / STANDARD_GRAVITY_M_S2)), &limited(0.0, 5.0), 0.0, 5.0, true);
        assert!(stated.len() == 1 && stated[0].to - stated[0].from > 90, "{stated:?}");
        // The stated limit of 300 g is 2942 m/s²: then noise does not matter.
        assert!(!clipped(&channel(Some(300.0)), &crushing, 0.0, 5.0, true).is_empty());
    }
}
