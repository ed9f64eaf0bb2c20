//! Shock response spectrum of uniform samples: the maxima of damped oscillators on that base.

use nalgebra::Complex;
use std::f64::consts::{PI, TAU};

/// Oscillators that are followed at once: a single one waits for each step.
const LANES: usize = 8;

/// For each oscillator: its natural frequency, Hz, the largest absolute acceleration, in the unit of the
/// samples, and the largest relative displacement times ω, in that unit times s; of either sign, while the
/// samples last and after them, at rest before them   (52)
pub fn shock_response(
    samples: &[f64],
    sample_rate_hz: f64,
    frequencies_hz: &[f64],
    quality: f64,
) -> Vec<ShockResponse> {
    let of_lanes = |few: &[f64]| {
        let oscillators: Vec<Oscillator> =
            few.iter().map(|f| Oscillator::new(*f, sample_rate_hz, quality)).collect();
        follow(samples, &oscillators)
    };
    frequencies_hz.chunks(LANES).flat_map(of_lanes).collect()
}

/// Maxima of one oscillator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShockResponse {
    /// Natural frequency, Hz.
    pub frequency_hz: f64,
    /// Largest absolute acceleration, in the unit of the samples.
    pub acceleration: f64,
    /// Largest relative displacement times ω, in that unit times s.
    pub pseudo_velocity: f64,
}

/// q̇ = λ q + a; the relative displacement is −Im q/ω_d, the absolute acceleration −Im(λ² q)/ω_d.
#[derive(Clone, Copy)]
struct Oscillator {
    frequency_hz: f64,
    rate: Complex<f64>,
    /// Factor of q over a step, and the contributions of the samples before and after it, with a line between
    /// them.
    decay: Complex<f64>,
    gains: [Complex<f64>; 2],
}

impl Oscillator {
    fn new(frequency_hz: f64, sample_rate_hz: f64, quality: f64) -> Self {
        let damping = 0.5 / quality;
        let rate = Complex::new(-damping, (1.0 - damping * damping).sqrt()) * (TAU * frequency_hz);
        let step = rate / sample_rate_hz;
        let decay = step.exp();
        let held = (decay - 1.0) / step;
        let ramp = (held - 1.0) / step;
        let gains = [(held - ramp) / sample_rate_hz, ramp / sample_rate_hz];
        Self { frequency_hz, rate, decay, gains }
    }

    /// The largest |Im(c q)| from now on, of a q without further excitation.
    fn residual(&self, factor: Complex<f64>, state: Complex<f64>) -> f64 {
        let now = factor * state;
        let phase = (self.rate * now).arg();
        let turn = if phase > 0.0 { PI - phase } else { -phase };
        (now * (self.rate * (turn / self.rate.im)).exp()).im.abs()
    }
}

#[allow(clippy::needless_range_loop, reason = "lanes side by side, which a processor takes at once")]
fn follow(samples: &[f64], oscillators: &[Oscillator]) -> Vec<ShockResponse> {
    let lane = |part: fn(&Oscillator) -> f64| -> [f64; LANES] {
        std::array::from_fn(|k| oscillators.get(k).map_or(0.0, part))
    };
    let (decay_re, decay_im) = (lane(|o| o.decay.re), lane(|o| o.decay.im));
    let (before_re, before_im) = (lane(|o| o.gains[0].re), lane(|o| o.gains[0].im));
    let (after_re, after_im) = (lane(|o| o.gains[1].re), lane(|o| o.gains[1].im));
    let (square_re, square_im) = (lane(|o| o.rate.powi(2).re), lane(|o| o.rate.powi(2).im));
    let [mut re, mut im, mut most_acceleration, mut most_displacement] = [[0.0_f64; LANES]; 4];
    let mut before = 0.0;
    for &after in samples {
        for k in 0..LANES {
            let (old_re, old_im) = (re[k], im[k]);
            re[k] = decay_re[k] * old_re - decay_im[k] * old_im + before_re[k] * before + after_re[k] * after;
            im[k] = decay_re[k] * old_im + decay_im[k] * old_re + before_im[k] * before + after_im[k] * after;
            most_acceleration[k] =
                most_acceleration[k].max((square_re[k] * im[k] + square_im[k] * re[k]).abs());
            most_displacement[k] = most_displacement[k].max(im[k].abs());
        }
        before = after;
    }
    let found = |(k, o): (usize, &Oscillator)| {
        let (state, turns) = (Complex::new(re[k], im[k]), TAU * o.frequency_hz / o.rate.im);
        let acceleration = most_acceleration[k].max(o.residual(o.rate.powi(2), state)) / o.rate.im;
        let pseudo_velocity = most_displacement[k].max(o.residual(Complex::new(1.0, 0.0), state)) * turns;
        ShockResponse { frequency_hz: o.frequency_hz, acceleration, pseudo_velocity }
    };
    oscillators.iter().enumerate().map(found).collect()
}
