//! A second-order Butterworth low-pass forward and back: zero phase, stable at any cut-off.

mod stage;

use super::as_count;
use stage::StateVariable;
use std::f64::consts::{PI, SQRT_2};

/// Design frequency of a channel frequency class over its number: 2.0775 (ISO 6487, SAE J211-1)   (25)
pub const CFC_DESIGN: f64 = 2.0775;

/// −3 dB frequency of two passes of a second-order Butterworth over its design frequency: (√2 − 1)^(1/4).
pub const TWO_PASS_CUTOFF: f64 = 0.802_243_262_923_150_2;

/// Paddings after which a sample has no more influence: 1e-18 of it.
const MEMORY: usize = 3;

/// Two passes of a second-order Butterworth low-pass in trapezoidal state-variable form.
///
/// g = tan(π f / f_s), R = 1/√2; the state-variable form keeps its round-off near 1e-15 of the peak where
/// direct forms lose all digits as f/f_s → 0 (Zavalishin 2012, chapter 4).   (26)
#[derive(Debug, Clone, PartialEq)]
pub struct LowPass {
    gain: f64,
    stage: StateVariable,
    padding: usize,
}

impl LowPass {
    /// Designs the filter by the design frequency of one pass, Hz, at a sample rate, Hz; `None` if it is not
    /// below half the rate.
    pub fn with_design_hz(design_hz: f64, sample_rate_hz: f64) -> Option<Self> {
        if !(design_hz > 0.0 && design_hz < 0.5 * sample_rate_hz) {
            return None;
        }
        let g = (PI * design_hz / sample_rate_hz).tan();
        // The impulse response decays as e^(−√½ 2π f t): 1e-6 of it remains after 3.1 / f.
        let padding = as_count((3.1 * sample_rate_hz / design_hz).ceil());
        Some(Self { gain: g, stage: StateVariable::new(g, SQRT_2), padding })
    }

    /// Designs the filter by the channel frequency class.
    pub fn with_cfc(cfc: f64, sample_rate_hz: f64) -> Option<Self> {
        Self::with_design_hz(CFC_DESIGN * cfc, sample_rate_hz)
    }

    /// Designs the filter by the −3 dB frequency of both passes together, Hz.
    pub fn with_cutoff_hz(cutoff_hz: f64, sample_rate_hz: f64) -> Option<Self> {
        Self::with_design_hz(cutoff_hz / TWO_PASS_CUTOFF, sample_rate_hz)
    }

    /// The filtered samples; both ends are mirrored for the filter's own memory.
    pub fn apply(&self, samples: &[f64]) -> Vec<f64> {
        self.apply_each(&[samples]).pop().unwrap_or_default()
    }

    /// Filters several series, which takes little longer than one if they have the same length.
    pub fn apply_each(&self, all: &[&[f64]]) -> Vec<Vec<f64>> {
        let (mut work, heads): (Vec<_>, Vec<_>) =
            all.iter().map(|samples| pad(samples, self.padding)).unzip();
        stage::filter_all(&self.stage, MEMORY * self.padding, &mut work);
        work.into_iter().zip(heads).zip(all).map(|((work, head), own)| crop(work, head, own.len())).collect()
    }

    /// Filters pulses that are zero before and after.
    pub fn apply_to_pulses<const N: usize>(&self, pulses: [&[f64]; N]) -> [Vec<f64>; N] {
        let mut work = pulses.map(|pulse| {
            let after = std::iter::repeat_n(&0.0, self.padding);
            std::iter::once(&0.0).chain(pulse).chain(after).copied().collect::<Vec<f64>>()
        });
        stage::filter_all(&self.stage, MEMORY * self.padding, &mut work);
        let mut counts = pulses.iter().map(|pulse| pulse.len());
        work.map(|work| crop(work, 1, counts.next().unwrap_or_default()))
    }

    /// |H| of both passes together at a frequency, Hz, at the design sample rate of the filter.
    pub fn magnitude(&self, frequency_hz: f64, sample_rate_hz: f64) -> f64 {
        let warped = (PI * frequency_hz / sample_rate_hz).tan() / self.gain;
        1.0 / (1.0 + warped.powi(4))
    }
}

/// Mirrors the samples at both ends for `pad` samples, at most for all but the end sample; returns the number
/// in front too.
fn pad(samples: &[f64], pad: usize) -> (Vec<f64>, usize) {
    let n = samples.len();
    let pad = pad.min(n.saturating_sub(1));
    if pad == 0 {
        return (samples.to_vec(), 0);
    }
    let mut work = Vec::with_capacity(n + 2 * pad);
    work.extend(samples[1..=pad].iter().rev());
    work.extend_from_slice(samples);
    work.extend(samples[n - 1 - pad..n - 1].iter().rev());
    (work, pad)
}

/// The `count` samples behind the first `head`.
fn crop(mut work: Vec<f64>, head: usize, count: usize) -> Vec<f64> {
    work.drain(..head);
    work.truncate(count);
    work
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minus_3_db_point_is_where_it_is_said() {
        let filter = LowPass::with_cutoff_hz(300.0, 1e6).expect("below Nyquist");
        // Warping at f/fs = 3e-4 is (π f/fs)²/3 = 3e-7.
        assert!((filter.magnitude(300.0, 1e6) - 0.5_f64.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn a_sine_keeps_its_phase_and_takes_the_stated_gain() {
        let (rate, f) = (10_000.0, 250.0);
        let filter = LowPass::with_cfc(180.0, rate).expect("below Nyquist");
        let x: Vec<f64> = (0..4000).map(|i| (2.0 * PI * f * f64::from(i) / rate).sin()).collect();
        let y = filter.apply(&x);
        let gain = filter.magnitude(f, rate);
        for i in 1000..3000 {
            assert!((y[i] - gain * x[i]).abs() < 1e-9, "{i}");
        }
    }

    #[test]
    fn constants_and_lines_pass_unchanged() {
        let filter = LowPass::with_cfc(60.0, 20_000.0).expect("below Nyquist");
        let line: Vec<f64> = (0..5000).map(|i| 3.0 + 0.01 * f64::from(i)).collect();
        let out = filter.apply(&line);
        // The mirror makes a kink of a line's end; after the filter's memory 1e-6 of the slope's own size in
        // it is left.
        let memory = filter.padding;
        let inside = memory..line.len() - memory;
        assert!(line[inside.clone()].iter().zip(&out[inside]).all(|(a, b)| (a - b).abs() < 1e-4));
        assert!(filter.apply(&[3.0; 500]).iter().all(|y| (y - 3.0).abs() < 1e-12));
        assert!(LowPass::with_cfc(6000.0, 20_000.0).is_none());
    }

    #[test]
    fn round_off_stays_small_at_a_ten_thousandth_of_the_rate() {
        // A step far from the ends settles to its height: no drift of a nearly integrating filter.
        let filter = LowPass::with_design_hz(1.0, 10_000.0).expect("below Nyquist");
        let x = vec![1.0; 200_000];
        assert!(filter.apply(&x).iter().all(|y| (y - 1.0).abs() < 1e-12));
    }

    #[test]
    fn mirrored_ends_leave_the_filters_own_noise_there() {
        use crate::numerics::robust::spread;
        // Uniform noise from a multiplicative congruence, and of its middle the same without what stands
        // beside it.
        let mut state = 1_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from(u32::try_from(state >> 40).unwrap_or_default()) / f64::from(1 << 24) - 0.5
        };
        let whole: Vec<f64> = (0..40_000).map(|_| noise()).collect();
        let filter = LowPass::with_design_hz(1.0, 1000.0).expect("below Nyquist");
        let truth = filter.apply(&whole);
        let own = spread(&truth[10_000..30_000]);
        let off = |from: usize| {
            let cut = filter.apply(&whole[from..from + 20_000]);
            let ends = (0..250).chain(19_750..20_000);
            let square: f64 = ends.map(|i| (cut[i] - truth[from + i]).powi(2)).sum();
            (square / 500.0).sqrt()
        };
        // An end adds noise of about the filter's own size; over a quarter of 1/f it is one normal value at
        // each end.
        for from in (7000..13_000).step_by(500) {
            assert!(off(from) < 2.5 * own, "{from}: {} of {own}", off(from));
        }
    }
}
