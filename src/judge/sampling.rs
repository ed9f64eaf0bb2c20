//! Judges if sample rate and anti-alias filter suited the first pulse.

use crate::data::{ChannelFinding, End, Events, Finding, Signal, transverse};
use crate::numerics::spectrum::magnitude;
use crate::numerics::{as_f64, reduce};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::Range;

/// Fewest samples over a first pulse for an error of its area below 1 %: that of the trapezoid over a half
/// sine of N is π²/12 N².
const LEAST_SAMPLES: f64 = 10.0;
/// Shares of its peak at which a pulse's width is determined, each with the share of a half sine's length
/// that lies above it: 1 − 2 asin(share)/π. A force plateau is as wide at half its height as at its base, a
/// pulse that continues as ringing is not: the smaller length counts.
const FLANKS: [(f64, f64); 2] = [(0.15, 0.904), (0.5, 2.0 / 3.0)];
/// The pulse is the first run above the flank that reaches this share of the interval's peak: later ringing
/// may be higher.
const REACHED_SHARE: f64 = 0.5;
/// The flank lies this many standard deviations of the noise above zero.
const NOISE_FACTOR: f64 = 6.0;
/// Start of the band, as a share of the sample rate, in which an anti-alias filter leaves no content; it ends
/// at half the rate.
const BAND_SHARE: f64 = 0.4;
/// Largest content of the band over the maximum of the spectrum: 0.05 aliases to 2.5 % of the velocity step.
/// Drawn pulses of 25 samples and more that end in a jump (k = 0.02) reach 0.026, pulses of 5 samples begin
/// at 0.14.
const MOST_CONTENT: f64 = 0.05;
/// Content below this share shows a filter: the trapezoid then misses less than that share of a pulse's area.
const LEAST_CONTENT: f64 = 0.01;
/// Content below this many times the noise in the band is noise.
const NOISE_CONTENT: f64 = 3.0;
/// Longest contact whose pulse is searched, s.
const LONGEST_S: f64 = 0.05;

/// Judges how each channel samples the first impact: enough samples, and no content up to half the sample
/// rate.
///
/// `disturbed` names the channels whose single samples are off: their spectra say nothing about a filter.
pub(super) fn judge_sampling(signals: &[Signal], events: &Events, disturbed: &[&str]) -> Vec<Finding> {
    let (Some(struck), Some(contact_s)) = (transverse(signals, End::First), events.first_contact_s()) else {
        return Vec::new();
    };
    let to_s = events.separation_s().unwrap_or(contact_s + LONGEST_S).min(contact_s + LONGEST_S);
    let Some((pulse_s, SampledPulse { length_s, share })) = find_pulse(struck, contact_s..to_s) else {
        return Vec::new();
    };
    let contents: Vec<Option<BandContent>> = signals.par_iter().map(|s| band_content(s, pulse_s)).collect();
    let struck_content = signals.iter().zip(&contents).find(|(s, _)| s.name == struck.name);
    let largest = struck_content.and_then(|(_, c)| c.as_ref()).map_or(0.0, |c| c.largest);
    let mut findings = Vec::new();
    for (signal, content) in signals.iter().zip(contents) {
        let is_filtered = content.as_ref().is_some_and(|found| found.in_band < LEAST_CONTENT * largest);
        let low = low_rate(&signal.name, signal.sample_rate_hz, length_s, share).filter(|_| !is_filtered);
        findings.extend(low.map(|found| found.span(pulse_s.0, pulse_s.1)));
        if !disturbed.contains(&signal.name.as_str()) {
            findings.extend(content.and_then(|found| judge_aliasing(signal, pulse_s, &found, largest)));
        }
    }
    findings
}

/// A pulse as it was sampled.
struct SampledPulse {
    /// Length of a half sine of this width, s.
    length_s: f64,
    /// Share of the contact's change of velocity.
    share: f64,
}

/// Finds where the force of the first pulse exceeds the lower flank and falls below it, s, and how it was
/// sampled.
fn find_pulse(signal: &Signal, contact_s: Range<f64>) -> Option<((f64, f64), SampledPulse)> {
    let from = signal.index_from(contact_s.start).saturating_sub(1);
    let force = signal.force_m_s2.get(from..)?;
    let within = force.get(..signal.index_from(contact_s.end).saturating_sub(from) + 2).unwrap_or(force);
    let largest = |force: &[f64]| force.iter().fold(0.0_f64, |m, f| m.max(*f));
    let (noise, peak) = (NOISE_FACTOR * signal.noise_m_s2, largest(within));
    let calm = reduce::average_noise(within, noise, FLANKS[0].0 * peak, peak);
    let (force, within, noise) = match &calm {
        Some((means, width)) => (&means[..], &means[..], noise / as_f64(*width).sqrt()),
        None => (force, within, noise),
    };
    let peak = largest(within);
    let reached = within.iter().position(|f| *f > REACHED_SHARE * peak)?;
    let [foot, shoulder] = FLANKS.map(|(share, _)| (share * peak).max(noise));
    let low = (0..reached).rev().find(|&i| force[i] <= foot)?;
    let high = (reached..force.len()).find(|&i| force[i] <= foot)?;
    // Dips from ringing do not end the upper half of the pulse.
    let high_half = (reached..high).rev().find(|&i| force[i] > shoulder)? + 1;
    let rise = |i: usize, level: f64| as_f64(i) + (level - force[i]) / (force[i + 1] - force[i]);
    let fall = |i: usize, level: f64| as_f64(i) - (level - force[i]) / (force[i - 1] - force[i]);
    let whole = (rise(low, foot), fall(high, foot));
    let half = fall(high_half, shoulder) - rise(reached - 1, shoulder);
    let samples = ((whole.1 - whole.0) / FLANKS[0].1).min(half / FLANKS[1].1);
    let at_s = |position: f64| signal.time_s(from) + position / signal.sample_rate_hz;
    let share = (reduce::sum(&force[low..high]) / reduce::sum(within)).clamp(0.0, 1.0);
    let sampled = SampledPulse { length_s: samples / signal.sample_rate_hz, share };
    (foot < 0.5 * peak).then(|| ((at_s(whole.0), at_s(whole.1)), sampled))
}

/// Sample rate for a pulse of this length, Hz: twice the least, which leaves an error of 0.2 % of its area.
pub fn fit_rate_hz(length_s: f64) -> f64 {
    2.0 * LEAST_SAMPLES / length_s
}

/// Frequency above which an anti-alias filter leaves no content, Hz.
pub fn nothing_from_hz(sample_rate_hz: f64) -> f64 {
    BAND_SHARE * sample_rate_hz
}

/// Reports too few samples over a pulse of this length that makes a `share` of the velocity step.
pub(super) fn low_rate(name: &str, sample_rate_hz: f64, length_s: f64, share: f64) -> Option<Finding> {
    let samples = length_s * sample_rate_hz;
    (samples / share.sqrt() < LEAST_SAMPLES).then(|| {
        // π²/12 N² of the area of a half sine: its two kinks against the trapezoid.
        let off_percent = 100.0 * share * PI * PI / 12.0 / (samples * samples);
        let least_hz = fit_rate_hz(length_s);
        let finding = ChannelFinding::LowRate { samples, pulse_s: length_s, off_percent, least_hz };
        finding.tag(name)
    })
}

/// Fourier integral of the stretch about the pulse, m/s.
struct BandContent {
    /// RMS of its magnitude in the band below half the sample rate.
    in_band: f64,
    /// Largest magnitude.
    largest: f64,
    /// Noise in the band.
    noise: f64,
}

/// Analyses the interval that extends a pulse's length beyond it on both sides, tapered to zero by half a
/// cosine.
fn band_content(signal: &Signal, pulse_s: (f64, f64)) -> Option<BandContent> {
    let margin_s = (pulse_s.1 - pulse_s.0).max(4.0 / signal.sample_rate_hz);
    let (from, to) = (signal.index_from(pulse_s.0 - margin_s), signal.index_from(pulse_s.1 + margin_s));
    let mut force = signal.force_m_s2.get(from..to)?.to_vec();
    let count = force.len();
    let margin = signal.index_from(pulse_s.0).saturating_sub(from).max(1);
    for i in 0..margin.min(count / 2) {
        let weight = 0.5 - 0.5 * (PI * (as_f64(i) + 0.5) / as_f64(margin)).cos();
        force[i] *= weight;
        force[count - 1 - i] *= weight;
    }
    // Zeros after a short interval only interpolate its spectrum.
    force.resize(count.max(512), 0.0);
    let (frequency_hz, size) = magnitude(force.into_iter(), signal.sample_rate_hz);
    let band = &size[frequency_hz.partition_point(|f| *f < BAND_SHARE * signal.sample_rate_hz)..];
    Some(BandContent {
        in_band: (band.iter().map(|m| m * m).sum::<f64>() / as_f64(band.len().max(1))).sqrt(),
        largest: size.iter().fold(0.0, |m, s| s.max(m)),
        noise: signal.noise_m_s2 * as_f64(count).sqrt() / signal.sample_rate_hz,
    })
}

fn judge_aliasing(signal: &Signal, pulse_s: (f64, f64), band: &BandContent, most: f64) -> Option<Finding> {
    if signal.overlaps(&signal.gaps, pulse_s.0, pulse_s.1) {
        return None;
    }
    let share = band.in_band / most;
    let finding = ChannelFinding::Aliasing { share, sample_rate_hz: signal.sample_rate_hz };
    (share > MOST_CONTENT && band.in_band > NOISE_CONTENT * band.noise)
        .then(|| finding.tag(&signal.name).span(pulse_s.0, pulse_s.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{At, IssueCode, example};

    /// Samples `force` from 20 ms on at a rate, with the two events.
    fn codes(rate_hz: f64, found_end_s: f64, force: impl Fn(f64) -> f64) -> Vec<IssueCode> {
        let count = 100_000;
        let force_m_s2 = (0..count).map(|i| f64::from(i) / rate_hz - 0.020_04).take_while(|t| *t < 0.2);
        let signal = Signal {
            noise_m_s2: 0.1,
            free_fall_s: 0.02,
            ..example::signal(rate_hz, force_m_s2.map(|t| if t > 0.0 { force(t) } else { 0.0 }).collect())
        };
        let events = Events {
            first_contact: Some(At::exact(0.02)),
            separation: Some(At::exact(0.02 + found_end_s)),
            ..Events::default()
        };
        judge_sampling(&[signal], &events, &[]).iter().map(|i| i.code).collect()
    }

    fn half_sine(t: f64, length_s: f64) -> f64 {
        if t < length_s { 5000.0 * (PI * t / length_s).sin() } else { 0.0 }
    }

    /// A mode as strong as the pulse that continues to ring after it.
    fn ringing(t: f64, length_s: f64, frequency_hz: f64) -> f64 {
        half_sine(t, length_s) + 2500.0 * (-40.0 * t).exp() * (2.0 * PI * frequency_hz * t).sin()
    }

    #[test]
    fn a_pulse_of_four_samples_is_named_however_long_the_contact_was_found() {
        for end_s in [0.0029, 0.0116] {
            let found = codes(1400.0, end_s, |t| half_sine(t, 0.0029));
            assert!(found.contains(&IssueCode::LowRate), "{end_s}: {found:?}");
        }
        let rung = codes(1400.0, 0.0116, |t| ringing(t, 0.0029, 60.0));
        assert!(rung.contains(&IssueCode::LowRate), "{rung:?}");
    }

    #[test]
    fn twenty_samples_are_enough_with_and_without_ringing() {
        assert!(codes(7000.0, 0.0029, |t| half_sine(t, 0.0029)).is_empty());
        assert!(codes(7000.0, 0.0029, |t| ringing(t, 0.0029, 60.0)).is_empty());
        // 450 Hz over 10 ms at 15 samples a period.
        assert!(codes(6750.0, 0.01, |t| ringing(t, 0.01, 450.0)).is_empty());
    }

    #[test]
    fn a_spike_that_makes_little_of_the_step_may_be_sampled_coarsely() {
        // A spike of three samples before 20 ms of crush: a twentieth of the step, and a third.
        let spike = |area: f64| {
            move |t: f64| half_sine(t, 3e-4) * area + 0.05 * half_sine(t, 0.02) + 100.0 * f64::from(t < 0.02)
        };
        assert!(!codes(1e4, 0.02, spike(0.3)).contains(&IssueCode::LowRate));
        assert!(codes(1e4, 0.02, spike(3.0)).contains(&IssueCode::LowRate));
    }

    #[test]
    fn what_rings_up_to_half_the_rate_is_aliasing_and_below_a_filter_it_is_not() {
        let resonance = |f: f64, height: f64| {
            move |t: f64| half_sine(t, 0.005) + height * (-300.0 * t).exp() * (2.0 * PI * f * t).sin()
        };
        assert_eq!(codes(1e4, 0.005, resonance(4600.0, 2000.0)), [IssueCode::Aliasing]);
        // A third of the rate, which a filter at a quarter to 40 % of the rate passes.
        assert!(codes(1e4, 0.005, resonance(2800.0, 800.0)).is_empty());
    }
}
