//! Spectrum of the noise in a quiet stretch of samples, and the uncertainty that this noise adds to an
//! integral.

use super::spectrum::forward_transform;
use super::{as_count, as_f64};
use rustfft::num_complex::Complex;
use std::f64::consts::{PI, TAU};

/// Sine tapers averaged (Riedel & Sidorenko 1995): 2 × 5 degrees of freedom per line, a resolution of 3
/// lines.
const TAPERS: u32 = 5;
/// First line used: those below lie within the tapers' resolution of the mean that was subtracted.
const FIRST_LINE: usize = 3;
/// Lines averaged into the first bin; each later bin is as wide as this share of its frequency.
const FIRST_BIN_LINES: usize = 4;
const BIN_SHARE: f64 = 0.25;
/// The lowest bins rise towards low frequencies if they exceed those three octaves up by this factor; 1/f
/// gives 8, white noise 1 ± 0.3.
const RISE_FACTOR: f64 = 3.0;
/// Frequencies per decade of the integral, and its beginning as a share of the lowest frequency that matters:
/// for white noise and 1/f the uncertainty is accurate to 3e-4, for noise that rises with frequency to 2 %.
const STEPS_A_DECADE: f64 = 100.0;
const LOWEST_SHARE: f64 = 1e-2;

/// One-sided power spectral density of the samples less their mean: bins of (frequency in Hz, unit²/Hz),
/// ascending.
///
/// The method is the mean of sine tapers, averaged over lines into bins that widen with frequency. Empty for
/// fewer than 32 samples.
pub fn spectrum(quiet: &[f64], sample_rate_hz: f64) -> Vec<(f64, f64)> {
    let n = quiet.len();
    if n < 32 {
        return Vec::new();
    }
    let mean = quiet.iter().sum::<f64>() / as_f64(n);
    let fft = forward_transform(n);
    let mut lines = vec![0.0; n / 2];
    for taper in 1..=TAPERS {
        let turn = PI * f64::from(taper) / as_f64(n + 1);
        let weight = |i: usize| (2.0 / as_f64(n + 1)).sqrt() * (turn * as_f64(i + 1)).sin();
        let mut work: Vec<Complex<f64>> =
            quiet.iter().enumerate().map(|(i, x)| Complex::new(weight(i) * (x - mean), 0.0)).collect();
        fft.process(&mut work);
        for (line, value) in lines.iter_mut().zip(&work) {
            // S = 2 |Σ w x e^(−iωt)|² / f_s with Σ w² = 1   (Q2)
            *line += 2.0 * value.norm_sqr() / (sample_rate_hz * f64::from(TAPERS));
        }
    }
    let mut bins = Vec::new();
    let mut from = FIRST_LINE;
    while from < lines.len() {
        let width = as_count(BIN_SHARE * as_f64(from)).max(FIRST_BIN_LINES);
        let to = (from + width).min(lines.len());
        let frequency_hz = (as_f64(from + to - 1) / 2.0) * sample_rate_hz / as_f64(n);
        bins.push((frequency_hz, lines[from..to].iter().sum::<f64>() / as_f64(to - from)));
        from = to;
    }
    bins
}

/// Standard uncertainty of ∫ noise dt over `integrate_s`, less that time × the noise's mean over the `mean_s`
/// just before it.
///
/// u² = ∫ S(f) |H(f)|² df, H = (e^(iωT) − 1)/(iω) − T (1 − e^(−iωT0))/(iωT0)   (Q3). `spectrum` comes from
/// [`spectrum`]; between its bins the density is a power of the frequency, below them it is flat, or 1/f if
/// it rises. 0 for an empty one.
pub fn integral_uncertainty_by(spectrum: &[(f64, f64)], mean_s: f64, integrate_s: f64) -> f64 {
    let (Some(&lowest), Some(&highest)) = (spectrum.first(), spectrum.last()) else { return 0.0 };
    if !(mean_s > 0.0 && integrate_s > 0.0) {
        return 0.0;
    }
    // A power law through the two lowest bins would follow their scatter: their mean is compared with that
    // three octaves up.
    let mean = |bins: &[(f64, f64)], power: i32| {
        bins.iter().map(|b| b.1 * b.0.powi(power)).sum::<f64>()
            / f64::from(u32::try_from(bins.len()).unwrap_or(1))
    };
    let low = &spectrum[..spectrum.len().min(2)];
    let above = spectrum.partition_point(|bin| bin.0 < 8.0 * lowest.0);
    let high = &spectrum[above..spectrum.len().min(above + 2)];
    let rises = !high.is_empty() && mean(low, 0) > RISE_FACTOR * mean(high, 0);
    let (level, hyperbola) = (mean(low, 0), mean(low, 1));
    let power = |pair: &[(f64, f64)]| {
        let (a, b) = (pair[0], pair[1]);
        (a.1 > 0.0 && b.1 > 0.0).then(|| (b.1 / a.1).ln() / (b.0 / a.0).ln())
    };
    let powers: Vec<Option<f64>> = spectrum.windows(2).map(power).collect();
    let density = |f: f64| {
        if f <= lowest.0 {
            return if rises { hyperbola / f } else { level };
        }
        let next = spectrum.partition_point(|bin| bin.0 < f).min(spectrum.len() - 1).max(1);
        let (a, b) = (spectrum[next - 1], spectrum[next]);
        powers[next - 1].map_or(a.1.max(b.1), |power| a.1 * (f / a.0).powf(power))
    };
    let from_hz = LOWEST_SHARE * lowest.0.min(1.0 / (mean_s + integrate_s));
    let ratio = 10.0_f64.powf(1.0 / STEPS_A_DECADE);
    let grid = std::iter::successors(Some(from_hz * ratio.sqrt()), |f| Some(f * ratio));
    let width = ratio.sqrt() - 1.0 / ratio.sqrt();
    let square: f64 = grid
        .take_while(|f| *f <= highest.0)
        .map(|f| density(f) * weight_square(f, mean_s, integrate_s) * f * width)
        .sum();
    square.sqrt()
}

/// |H(f)|² of (Q3), s².
fn weight_square(frequency_hz: f64, mean_s: f64, integrate_s: f64) -> f64 {
    let omega = TAU * frequency_hz;
    let i_omega = Complex::new(0.0, omega);
    let integral = (Complex::from_polar(1.0, omega * integrate_s) - 1.0) / i_omega;
    let mean = (Complex::new(1.0, 0.0) - Complex::from_polar(1.0, -omega * mean_s)) / (i_omega * mean_s);
    (integral - mean * integrate_s).norm_sqr()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand::rngs::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    const RATE_HZ: f64 = 2000.0;

    /// White noise of variance 1, or with `pink` that of first-order low-passes an octave apart: 1/f above 1
    /// Hz.
    fn noise(count: usize, pink: bool, generator: &mut ChaCha8Rng) -> Vec<f64> {
        let mut draw = || -> f64 { StandardNormal.sample(generator) };
        if !pink {
            return (0..count).map(|_| draw()).collect();
        }
        let mut sum = vec![0.0; count];
        for octave in 0..10 {
            let kept = (-TAU * 2.0_f64.powi(octave) / RATE_HZ).exp();
            let mut state = draw();
            for s in &mut sum {
                *s += state;
                state = kept * state + (1.0 - kept * kept).sqrt() * draw();
            }
        }
        sum
    }

    /// Mean squares over many draws of 0.25 s and the 0.06 s after it: what the spectrum says and what really
    /// was.
    fn squares(pink: bool) -> (f64, f64) {
        let (before, after, draws) = (500, 120, 400_u32);
        let mut generator = ChaCha8Rng::seed_from_u64(7);
        let (mut said, mut was) = (0.0, 0.0);
        for _ in 0..draws {
            let all = noise(before + after, pink, &mut generator);
            let mean = all[..before].iter().sum::<f64>() / 500.0;
            let gained = all[before..].iter().map(|x| (x - mean) / RATE_HZ).sum::<f64>();
            was += gained * gained / f64::from(draws);
            said += integral_uncertainty(&all[..before], RATE_HZ, 0.06).powi(2) / f64::from(draws);
        }
        (said, was)
    }

    /// Uncertainty from samples: their spectrum, and the mean over all of them.
    #[allow(clippy::cast_precision_loss, reason = "sample counts stay below 2^52")]
    fn integral_uncertainty(quiet: &[f64], sample_rate_hz: f64, integrate_s: f64) -> f64 {
        integral_uncertainty_by(
            &spectrum(quiet, sample_rate_hz),
            quiet.len() as f64 / sample_rate_hz,
            integrate_s,
        )
    }

    #[test]
    fn white_noise_adds_what_the_closed_form_says() {
        let (said, was) = squares(false);
        // u² = σ²/f_s (T + T²/T0); 400 squares of a normal variable are known to 7 %, the spectra's mean to
        // 0.45/√400.
        let expected = (0.06 + 0.06_f64.powi(2) / 0.25) / RATE_HZ;
        assert!((was / expected - 1.0).abs() < 0.21, "{was} {expected}");
        assert!((said / expected - 1.0).abs() < 0.07, "{said} {expected}");
    }

    #[test]
    fn noise_that_falls_with_frequency_adds_more_and_is_not_taken_for_white() {
        let (said, was) = squares(true);
        // 7 % by the draws; the tapers smear three lines to either side, over which the mean of 1/f is up to
        // twice its middle.
        assert!(said / was > 0.8 && said / was < 2.0, "{said} {was}");
        // White noise of the same variance (10) would add (0.06 + 0.0144) · 10 / 2000: far less.
        assert!(said > 3.0 * 10.0 * 0.0744 / RATE_HZ, "{said}");
    }

    #[test]
    fn the_spectrum_holds_the_variance() {
        let mut generator = ChaCha8Rng::seed_from_u64(3);
        let quiet = noise(20_000, false, &mut generator);
        let bins = spectrum(&quiet, RATE_HZ);
        assert!(bins.windows(2).all(|w| w[1].0 > w[0].0) && bins.len() < 60, "{}", bins.len());
        // 2 σ²/f_s = 1e-3 in the high bins, which average hundreds of lines of 2 degrees of freedom and more:
        // ± 15 % is 3 σ.
        assert!(bins.iter().filter(|b| b.0 > 100.0).all(|b| (b.1 / 1e-3 - 1.0).abs() < 0.15));
        assert!(spectrum(&quiet[..10], RATE_HZ).is_empty());
        assert!(integral_uncertainty(&quiet[..10], RATE_HZ, 0.06).abs() < 1e-300);
    }
}
