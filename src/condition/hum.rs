//! Finds mains hum in the free fall before first contact and subtracts it from the whole signal.

use crate::data::{ChannelFinding, Finding, Severity, Signal};
use crate::numerics::reduce::{block_means, block_size};
use crate::numerics::sinusoid::{self, Sinusoid};
use crate::numerics::{as_f64, robust};
use std::f64::consts::{PI, TAU};

/// Frequencies of power grids, Hz: Europe, America, railways.
const MAINS_HZ: [f64; 3] = [50.0, 60.0, 50.0 / 3.0];
/// Grids keep their frequency, and recorders their clock, within this share: 0.5 Hz of 50.
const FREQUENCY_SHARE: f64 = 0.01;
/// Highest harmonic that is searched: rectifiers produce odd ones up to the seventh.
const HARMONICS: u32 = 7;
/// Fewest periods of free fall that distinguish hum from a slope and from another grid.
const LEAST_PERIODS: f64 = 2.5;
/// A line exceeds this many of its standard uncertainties.
const LEAST_LINE_U: f64 = 6.0;
/// It also exceeds the lines beside it, as near as the stretch resolves them, by this factor: noise that is
/// not white has such lines too.
const NEIGHBOUR_FACTOR: f64 = 4.0;
/// Residual velocity of hum from which it is a warning, m/s: 0.2 % of a slap-down.
const MOST_RESIDUAL_M_S: f64 = 0.05;
/// A line whose velocity swings by less than this is not reported, m/s.
const LEAST_M_S: f64 = 0.002;
/// Sample rate to which samples are averaged for the search, Hz: ten times the highest harmonic.
const SEARCH_RATE_HZ: f64 = 4000.0;
/// Time over which the hum is extrapolated into the event, s: contact and flight.
const AHEAD_S: f64 = 0.1;

/// Finds hum before `before_s` and reports it; subtracts it from all samples if `take_off`.
pub(super) fn treat(signal: &mut Signal, before_s: f64, take_off: bool) -> Option<Finding> {
    let end = signal.index_from(before_s);
    if signal.gaps.iter().any(|gap| gap.from < end) {
        return None;
    }
    let block = block_size(SEARCH_RATE_HZ, signal.sample_rate_hz);
    let means = block_means(signal.force_m_s2.get(..end)?, block);
    let block_rate_hz = signal.sample_rate_hz / as_f64(block);
    let lines: Vec<Sinusoid> = find_lines(&means, block_rate_hz)
        .iter()
        .map(|line| undo_averaging(line, block, signal.sample_rate_hz))
        .collect();
    let fundamental = *lines.first()?;
    let swing = |line: &Sinusoid, size: f64| 2.0 * size / (TAU * line.frequency_hz);
    let whole_m_s: f64 = lines.iter().map(|line| swing(line, line.amplitude())).sum();
    if whole_m_s < LEAST_M_S {
        return None;
    }
    let used = means.len() * block;
    let middle = (as_f64(used) - 1.0) / 2.0;
    if take_off {
        for (i, f) in signal.force_m_s2.iter_mut().enumerate() {
            let since_s = (as_f64(i) - middle) / signal.sample_rate_hz;
            *f -= lines.iter().map(|line| line.value_at(since_s)).sum::<f64>();
        }
        for gap in signal.gaps.clone() {
            signal.force_m_s2[gap.from..gap.to].fill(0.0);
        }
    }
    let left_m_s =
        if take_off { residual_m_s(&lines, as_f64(used) / signal.sample_rate_hz, &swing) } else { whole_m_s };
    let finding = ChannelFinding::Hum {
        amplitude_m_s2: fundamental.amplitude(),
        frequency_hz: fundamental.frequency_hz,
        harmonics: lines.len() - 1,
        is_taken_off: take_off,
        left_m_s,
        severity: if left_m_s > MOST_RESIDUAL_M_S { Severity::Warning } else { Severity::Note },
    };
    Some(finding.tag(&signal.name))
}

/// Restores the amplitude that the mean over `block` samples takes from a line: sin(n x)/(n sin x), x = π
/// f/f_s.
fn undo_averaging(line: &Sinusoid, block: usize, sample_rate_hz: f64) -> Sinusoid {
    let x = PI * line.frequency_hz / sample_rate_hz;
    let share = (as_f64(block) * x).sin() / (as_f64(block) * x.sin());
    Sinusoid { cosine: line.cosine / share, sine: line.sine / share, ..*line }
}

/// Finds the fundamental of the strongest grid and its harmonics, as far as they stand out; empty if none
/// does.
fn find_lines(quiet: &[f64], sample_rate_hz: f64) -> Vec<Sinusoid> {
    let length_s = as_f64(quiet.len()) / sample_rate_hz;
    let mut residual = quiet.to_vec();
    let band = |f: f64| (f * (1.0 - FREQUENCY_SHARE), f * (1.0 + FREQUENCY_SHARE));
    let fundamental = MAINS_HZ
        .iter()
        .filter(|f| length_s * **f >= LEAST_PERIODS)
        .filter_map(|f| sinusoid::search(&residual, sample_rate_hz, band(*f)))
        .max_by(|a, b| a.amplitude().total_cmp(&b.amplitude()));
    let mut lines = Vec::new();
    let Some(fundamental) = fundamental.filter(|line| stands_out(line, &residual, sample_rate_hz)) else {
        return lines;
    };
    subtract(&mut residual, &fundamental, sample_rate_hz);
    lines.push(fundamental);
    for harmonic in 2..=HARMONICS {
        let frequency_hz = fundamental.frequency_hz * f64::from(harmonic);
        let Some(line) = sinusoid::fit(&residual, sample_rate_hz, frequency_hz) else { break };
        if stands_out(&line, &residual, sample_rate_hz) {
            subtract(&mut residual, &line, sample_rate_hz);
            lines.push(line);
        }
    }
    lines
}

/// True if a line exceeds its uncertainty and its neighbours in the samples in which it was found.
fn stands_out(line: &Sinusoid, samples: &[f64], sample_rate_hz: f64) -> bool {
    let mut residual = samples.to_vec();
    subtract(&mut residual, line, sample_rate_hz);
    let apart_hz = sample_rate_hz / as_f64(samples.len());
    let mut beside: Vec<f64> = [-3.0, -2.0, -1.5, 1.5, 2.0, 3.0]
        .iter()
        .filter_map(|n| sinusoid::fit(&residual, sample_rate_hz, line.frequency_hz + n * apart_hz))
        .map(|s| s.amplitude())
        .collect();
    let amplitude = line.amplitude();
    amplitude > LEAST_LINE_U * line_uncertainty(line, &residual)
        && (beside.is_empty() || amplitude > NEIGHBOUR_FACTOR * robust::median(&mut beside))
}

/// Standard uncertainty of the amplitude from the residual beside the line, as white noise: σ √(2/n).
fn line_uncertainty(line: &Sinusoid, residual: &[f64]) -> f64 {
    line.u_amplitude.max(robust::spread(residual) * (2.0 / as_f64(residual.len())).sqrt())
}

fn subtract(samples: &mut [f64], line: &Sinusoid, sample_rate_hz: f64) {
    let middle = (as_f64(samples.len()) - 1.0) / 2.0;
    for (i, x) in samples.iter_mut().enumerate() {
        *x -= line.value_at((as_f64(i) - middle) / sample_rate_hz);
    }
}

/// Swing of velocity at the end of the event that the lines' uncertainties allow, m/s, as twice the standard
/// uncertainty.
fn residual_m_s(lines: &[Sinusoid], length_s: f64, swing: &impl Fn(&Sinusoid, f64) -> f64) -> f64 {
    let ahead_s = length_s / 2.0 + AHEAD_S;
    lines
        .iter()
        .map(|line| {
            let u = line.u_amplitude;
            // The frequency of a sinusoid in white noise is known to √6/π of u_A/(A T) (Rife & Boorstyn
            // 1974).
            let u_frequency_hz = 6.0_f64.sqrt() / PI * u / (line.amplitude() * length_s);
            let drifted = line.amplitude() * (TAU * u_frequency_hz * ahead_s).min(2.0);
            2.0 * swing(line, u.hypot(drifted))
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::super::tests::signal;
    use super::*;
    use crate::data::FindingKind;
    use crate::data::example::noise;

    /// 0.2 s of free fall and 0.1 s after it at 10 kHz, noise of 2 m/s², with this beside it.
    fn channel(beside: impl Fn(f64) -> f64, seed: u64) -> Signal {
        signal((0..3000).map(|i| 2.0 * noise(i, seed) + beside(f64::from(i) * 1e-4)).collect())
    }

    fn mains(frequency_hz: f64, size: f64) -> impl Fn(f64) -> f64 {
        move |t| size * (TAU * frequency_hz * t + 1.0).sin()
    }

    #[test]
    fn hum_is_taken_off_as_far_as_the_event() {
        for frequency_hz in [49.8, 50.0, 60.1] {
            let mut humming = channel(mains(frequency_hz, 10.0), 3);
            let clean = channel(|_| 0.0, 3);
            let finding = treat(&mut humming, 0.2, true).expect("10 m/s² of hum");
            assert_eq!(finding.severity, Severity::Note, "{finding:?}");
            // u_A = 2 √(2/2000) = 0.063; u_f = 0.78 · 0.063/(10 · 0.2) = 25 mHz: 0.31 m/s² at 0.2 s from the
            // middle.
            let off = humming.force_m_s2.iter().zip(&clean.force_m_s2).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 3.0 * (0.063 + 0.31), "{frequency_hz}");
        }
    }

    #[test]
    fn harmonics_are_found_and_left_alone_where_that_is_wanted() {
        let both = |t: f64| mains(50.0, 10.0)(t) + mains(150.0, 5.0)(t);
        let mut humming = channel(both, 4);
        let before = humming.clone();
        let finding = treat(&mut humming, 0.2, false).expect("hum");
        let is_as_found = |what: &FindingKind| {
            matches!(
                what,
                FindingKind::Channel(ChannelFinding::Hum { harmonics: 1, is_taken_off: false, .. })
            )
        };
        assert!(is_as_found(&finding.what), "{finding:?}");
        // 2 · 10/(2π 50) + 2 · 5/(2π 150) = 0.074 m/s.
        assert_eq!(finding.severity, Severity::Warning);
        assert_eq!(humming, before);
    }

    #[test]
    fn noise_has_no_hum() {
        for seed in 0..20 {
            assert!(treat(&mut channel(|_| 0.0, seed), 0.2, true).is_none(), "{seed}");
            // A slow swing of the hook and a drift are not mains hum.
            let slow = |t: f64| 8.0 * (TAU * 4.0 * t).sin() + 30.0 * t;
            assert!(treat(&mut channel(slow, seed), 0.2, true).is_none(), "{seed}");
        }
    }

    #[test]
    fn too_short_a_fall_tells_no_hum() {
        assert!(treat(&mut channel(mains(50.0, 10.0), 1), 0.03, true).is_none());
    }
}
