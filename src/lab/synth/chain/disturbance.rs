//! Disturbances added to a channel's samples, from its seed and chain: offset, zero shift, noise, hum, and a
//! cable that is shaken or whips.

use crate::lab::chance::Chance;
use crate::lab::data::Chain;
use crate::numerics::as_f64;
use std::f64::consts::{PI, TAU};

/// Number of random streams of a channel: each source of chance has its own, so that none changes another.
const STREAMS_A_CHANNEL: u64 = 8;

/// Lowest frequency of the 1/f noise, Hz; its corners lie an octave apart, which ripples by less than 0.1 dB.
const LOWEST_HZ: f64 = 1.0;

/// Frequencies of a shaken cable, Hz: those of the cask's bending.
const CABLE_HZ: (f64, f64) = (50.0, 500.0);

/// Damping of a whipping cable, as a share of the critical: it fades within a few waves.
const WHIP_DAMPING: f64 = 0.1;

/// Time over which the zero shift grows if there is no contact, s.
const NO_CONTACT_S: f64 = 5e-3;

/// True times of the samples, 0 at first contact.
pub(super) struct SampleTimes {
    /// Time of the first sample, s.
    pub from_s: f64,
    /// True sample rate, Hz.
    pub rate_hz: f64,
}

impl SampleTimes {
    fn time_s(&self, index: usize) -> f64 {
        self.from_s + as_f64(index) / self.rate_hz
    }

    /// Adds to each sample the value at its time.
    fn add(&self, samples_m_s2: &mut [f64], mut more_m_s2: impl FnMut(f64) -> f64) {
        samples_m_s2.iter_mut().enumerate().for_each(|(i, sample)| *sample += more_m_s2(self.time_s(i)));
    }
}

/// Adds everything of channel `index` to its samples.
pub(super) fn add(
    samples_m_s2: &mut [f64],
    (seed, index): (u64, usize),
    chain: &Chain,
    times: &SampleTimes,
    contacts_s: &[(f64, f64)],
) {
    let stream = |source: u64| Chance::new(seed, index as u64 * STREAMS_A_CHANNEL + source);
    let grown_s = contacts_s.first().map_or(NO_CONTACT_S, |c| (c.1 - c.0).max(f64::MIN_POSITIVE));
    times
        .add(samples_m_s2, |t_s| chain.offset_m_s2 + chain.zero_shift_m_s2 * (t_s / grown_s).clamp(0.0, 1.0));
    if chain.white_noise_m_s2 > 0.0 {
        let mut white = stream(0);
        times.add(samples_m_s2, |_| chain.white_noise_m_s2 * white.normal());
    }
    pink(samples_m_s2, chain.pink_noise_m_s2, times.rate_hz, &mut stream(1));
    if let Some((amplitude_m_s2, frequency_hz)) = chain.hum {
        let phase = stream(2).uniform(0.0, TAU);
        times.add(samples_m_s2, |t_s| amplitude_m_s2 * (TAU * frequency_hz * t_s + phase).sin());
    }
    if let Some((amplitude_m_s2, frequency_hz)) = chain.whip {
        times.add(samples_m_s2, |t_s| {
            let angle = TAU * frequency_hz * t_s.max(0.0);
            amplitude_m_s2 * (-WHIP_DAMPING * angle).exp() * angle.sin()
        });
    }
    if chain.cable_noise_m_s2 > 0.0 {
        cable(samples_m_s2, chain.cable_noise_m_s2, times, contacts_s, &mut stream(3));
    }
}

/// Noise of spectral density 1/f: equal parts of noise after first-order low-passes an octave apart.
fn pink(samples_m_s2: &mut [f64], sigma_m_s2: f64, rate_hz: f64, chance: &mut Chance) {
    if sigma_m_s2 <= 0.0 {
        return;
    }
    let corners_hz: Vec<f64> = std::iter::successors(Some(LOWEST_HZ), |corner_hz| Some(2.0 * corner_hz))
        .take_while(|corner_hz| *corner_hz <= 0.5 * rate_hz)
        .collect();
    let part = sigma_m_s2 / as_f64(corners_hz.len()).sqrt();
    for corner_hz in corners_hz {
        // x' = a x + √(1 − a²) w keeps the variance of w; a = e^(−2π f_c/f_s).
        let kept = (-TAU * corner_hz / rate_hz).exp();
        let fresh = (1.0 - kept * kept).sqrt();
        let mut state = chance.normal();
        for sample in samples_m_s2.iter_mut() {
            *sample += part * state;
            state = kept * state + fresh * chance.normal();
        }
    }
}

/// A swing of random frequency and phase under half a sine, over each contact.
fn cable(
    samples_m_s2: &mut [f64],
    amplitude_m_s2: f64,
    times: &SampleTimes,
    contacts_s: &[(f64, f64)],
    chance: &mut Chance,
) {
    for &(from_s, to_s) in contacts_s.iter().filter(|(from_s, to_s)| to_s > from_s) {
        let frequency_hz = CABLE_HZ.0 * (CABLE_HZ.1 / CABLE_HZ.0).powf(chance.uniform(0.0, 1.0));
        let phase = chance.uniform(0.0, TAU);
        let [first, last] = [from_s, to_s].map(|t| super::ceiling((t - times.from_s) * times.rate_hz));
        let last = last.min(samples_m_s2.len());
        for (i, sample) in samples_m_s2.iter_mut().enumerate().take(last).skip(first) {
            let since_s = times.time_s(i) - from_s;
            let envelope = (PI * since_s / (to_s - from_s)).sin();
            *sample += amplitude_m_s2 * envelope * (TAU * frequency_hz * since_s + phase).cos();
        }
    }
}

#[cfg(test)]
mod tests;
