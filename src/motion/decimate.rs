//! Reduces signals with a high sample rate to means at a rate that the motion of a cask needs.

use crate::data::Signal;
use crate::numerics::reduce::{block_means, block_size};
use crate::numerics::{as_count, as_f64, robust};
use std::borrow::Cow;

/// Lowest rate for the motion, Hz: a pulse with a kink in it is integrated to below 1e-6 of its area there
/// (docs/validation.md), and the modes of a cask lie below 2 kHz.
const ENOUGH_HZ: f64 = 1e5;

/// Fewest means of the free fall that determine the noise.
const FEWEST: usize = 64;

/// Averages each signal over blocks at a rate of at least [`ENOUGH_HZ`] and of `least_hz`: the sum of the
/// means, which is the velocity, is that of the samples   (27b)
///
/// If one signal is clipped or has gaps all stay as they are: both are located to the sample.
pub(super) fn decimate(signals: &[Signal], least_hz: f64) -> Cow<'_, [Signal]> {
    let block = |s: &Signal| block_size(least_hz.max(ENOUGH_HZ), s.sample_rate_hz);
    let is_whole = |s: &Signal| s.clipped.is_empty() && s.gaps.is_empty();
    if signals.iter().all(is_whole) && signals.iter().any(|s| block(s) > 1) {
        Cow::Owned(signals.iter().map(|s| average(s, block(s))).collect())
    } else {
        Cow::Borrowed(signals)
    }
}

/// Averages one signal over blocks of `block` samples, each mean at the middle of its samples.
fn average(signal: &Signal, block: usize) -> Signal {
    let means = block_means(&signal.force_m_s2, block);
    let sample_rate_hz = signal.sample_rate_hz / as_f64(block);
    let middle_s = as_f64(block - 1) / 2.0 / signal.sample_rate_hz;
    let quiet = &means[..as_count(signal.free_fall_s * sample_rate_hz).min(means.len())];
    // White noise is assumed if there are too few means to show their noise.
    let noise_m_s2 = if quiet.len() < FEWEST {
        signal.noise_m_s2 / as_f64(block).sqrt()
    } else {
        robust::mean_and_rms(quiet).1.min(signal.noise_m_s2)
    };
    Signal {
        name: signal.name.clone(),
        start_s: signal.start_s + middle_s,
        sample_rate_hz,
        force_m_s2: means,
        noise_m_s2,
        noise_spectrum: signal.noise_spectrum.clone(),
        clipped: vec![],
        gaps: vec![],
        ..*signal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Span, example};
    use crate::motion::Integrated;
    use std::f64::consts::PI;

    const RATE_HZ: f64 = 5e5;

    /// The first end's channel from 0 s on, 0.1 s of it.
    fn signal(force_m_s2: impl Fn(f64) -> f64) -> Signal {
        Signal {
            noise_m_s2: 1.0,
            free_fall_s: 0.05,
            ..example::signal(RATE_HZ, (0..50_000).map(|i| force_m_s2(f64::from(i) / RATE_HZ)).collect())
        }
    }

    #[test]
    fn the_velocity_of_means_is_that_of_the_pulse() {
        // A half sine of 4 ms from 50 ms on, begun between two samples: 1 m/s² · 2/π · 4 ms in all.
        let begin_s = 0.050_001_3;
        let phase = |t: f64| ((t - begin_s) / 4e-3).clamp(0.0, 1.0) * PI;
        let signals = [signal(|t| phase(t).sin())];
        let integrated = Integrated::new(&signals, 0.05);
        assert!((integrated.signals[0].sample_rate_hz - 1e5).abs() < 1e-6);
        let area_m_s = 8e-3 / PI;
        for i in 0..60 {
            let time_s = 0.0495 + f64::from(i) * 1e-4;
            let exact_m_s = area_m_s * (1.0 - phase(time_s).cos()) / 2.0;
            let off = (integrated.velocities[0].velocity_at(time_s) - exact_m_s) / area_m_s;
            // Between two means the velocity is a line: T²/8 of the slope's change, 8e-6 of the area at the
            // most.
            assert!(off.abs() < 1e-5, "{time_s}: {off}");
        }
        let off = integrated.velocities[0].velocity_at(0.06) / area_m_s - 1.0;
        assert!(off.abs() < 1e-7, "{off}");
    }

    #[test]
    fn what_is_clipped_lost_or_slow_stays_as_it_is() {
        let whole = signal(|_| 0.0);
        let at = |sample_rate_hz: f64| Signal { sample_rate_hz, ..whole.clone() };
        let span = vec![Span { from: 3, to: 5 }];
        let is_decimated = |signals: &[Signal]| matches!(decimate(signals, 0.0), Cow::Owned(_));
        assert!(is_decimated(&[whole.clone(), at(2e5), at(1e4)]));
        assert!(!is_decimated(&[at(1.9e5), at(1e4)]));
        assert!(!is_decimated(&[whole.clone(), Signal { clipped: span.clone(), ..whole.clone() }]));
        assert!(!is_decimated(&[whole.clone(), Signal { gaps: span, ..whole }]));
    }

    #[test]
    fn means_hold_slow_noise_and_less_of_fast_noise() {
        let slow = signal(|t| 2.0_f64.sqrt() * (2.0 * PI * 60.0 * t).sin());
        let fast = signal(|t| 2.0_f64.sqrt() * (2.0 * PI * 1e5 * (t + 1e-6)).sin());
        let noise = |signal: Signal| decimate(&[signal], 0.0)[0].noise_m_s2;
        assert!((noise(slow.clone()) - 1.0).abs() < 0.01);
        // A period is five samples.
        assert!(noise(fast) < 1e-6);
        let unknown = Signal { free_fall_s: 0.0, ..slow };
        assert!((noise(unknown) - 1.0 / 5.0_f64.sqrt()).abs() < 1e-12);
    }
}
