//! Each disturbance against its definition: size, spectrum, when it acts.

use super::super::super::example;
use super::*;
use crate::data::Axis;

const RATE_HZ: f64 = 10_000.0;
const COUNT: usize = 1 << 17;

fn added(change: impl FnOnce(&mut Chain)) -> Vec<f64> {
    let mut chain = example::channel(Axis::Transverse, 0.0, 0.0).chain;
    change(&mut chain);
    let mut samples = vec![0.0; COUNT];
    let times = SampleTimes { from_s: -0.1, rate_hz: RATE_HZ };
    add(&mut samples, (5, 1), &chain, &times, &[(0.0, 5e-3), (0.07, 0.08)]);
    samples
}

#[allow(clippy::cast_precision_loss, reason = "small counts")]
fn rms(samples: &[f64]) -> f64 {
    (samples.iter().map(|x| x * x).sum::<f64>() / samples.len() as f64).sqrt()
}

/// Power of `samples` in a band, by Goertzel's sum over frequencies that fit in stretches of 4096.
#[allow(clippy::cast_precision_loss, reason = "small counts")]
fn power(samples: &[f64], bins: std::ops::Range<u32>) -> f64 {
    let stretch = 4096;
    let mut sum = 0.0;
    for part in samples.chunks_exact(stretch) {
        for bin in bins.clone() {
            let step = TAU * f64::from(bin) / stretch as f64;
            let (re, im) = part.iter().enumerate().fold((0.0, 0.0), |(re, im), (i, x)| {
                let (sin, cos) = (step * i as f64).sin_cos();
                (re + x * cos, im + x * sin)
            });
            sum += re * re + im * im;
        }
    }
    sum / f64::from(bins.end - bins.start)
}

#[test]
fn white_noise_has_its_deviation_and_a_flat_spectrum() {
    let noise = added(|c| c.white_noise_m_s2 = 2.0);
    // The deviation of 131072 values is uncertain by 1/√(2n) = 0.2 %.
    assert!((rms(&noise) / 2.0 - 1.0).abs() < 4.0 * 0.002);
    // 32 stretches of 20 lines: each mean is uncertain by 1/√640 = 4 %.
    let ratio = power(&noise, 20..40) / power(&noise, 1000..1020);
    assert!((ratio - 1.0).abs() < 4.0 * 0.056, "{ratio}");
}

#[test]
fn pink_noise_has_its_deviation_and_falls_by_ten_a_decade() {
    let noise = added(|c| c.pink_noise_m_s2 = 2.0);
    // The slowest of 13 equal parts has 13 s · 2π of independent stretches: 1/13 · √(2/82) of the power is
    // uncertain, all of them 2 %.
    assert!((rms(&noise) / 2.0 - 1.0).abs() < 4.0 * 0.02, "{}", rms(&noise));
    // Mean of 1/f over the lines; the means of power are uncertain by 4 % each, the shape by 0.1 dB = 2 %
    // and, a decade below half the rate, by the missing octaves above: (f/5 kHz)² of the power and its folded
    // image, 3 %.
    let inverse = |bins: std::ops::Range<u32>| {
        let lines = f64::from(bins.end - bins.start);
        bins.map(|bin| 1.0 / f64::from(bin)).sum::<f64>() / lines
    };
    let wanted = inverse(20..40) / inverse(200..220);
    let ratio = power(&noise, 20..40) / power(&noise, 200..220);
    assert!((ratio / wanted - 1.0).abs() < 0.25, "{ratio}, not {wanted}");
}

#[test]
fn offset_is_there_always_and_zero_shift_grows_over_the_first_contact() {
    let samples = added(|c| (c.offset_m_s2, c.zero_shift_m_s2) = (3.0, 8.0));
    for (index, wanted) in [(0, 3.0), (999, 3.0), (1025, 7.0), (1050, 11.0), (100_000, 11.0)] {
        assert!((samples[index] - wanted).abs() < 1e-9, "{index}: {}", samples[index]);
    }
}

#[test]
fn hum_is_a_sine_of_its_amplitude_and_frequency() {
    let hum = added(|c| c.hum = Some((0.5, 50.0)));
    // 200 samples a period: the peak of a sine is found to 1.2e-4.
    let peak = hum.iter().fold(0.0_f64, |p, x| p.max(x.abs()));
    assert!((peak / 0.5 - 1.0).abs() < 2e-4, "{peak}");
    assert!((0..1000).all(|i| (hum[i] - hum[i + 200]).abs() < 1e-9 && (hum[i] + hum[i + 100]).abs() < 1e-9));
}

#[test]
fn the_cable_is_shaken_during_contacts_only() {
    let samples = added(|c| c.cable_noise_m_s2 = 4.0);
    let is_contact = |i: usize| (1000..1050).contains(&i) || (1700..1800).contains(&i);
    let peak = samples.iter().fold(0.0_f64, |p, x| p.max(x.abs()));
    assert!(peak <= 4.0 && peak > 1.0, "{peak}");
    assert!((0..COUNT).all(|i| is_contact(i) || samples[i].abs() < f64::EPSILON));
    assert!((1700..1800).any(|i| samples[i].abs() > 0.4));
}
