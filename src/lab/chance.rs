//! Random numbers from a seed and the number of a stream.

use super::envelope::Range;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};

/// Standard deviations in the half-width that holds 95 % of a normal distribution, as in the analysis.
const SIGMAS_OF_95: f64 = 2.0;

/// The random numbers of one scene or case.
pub(super) struct Chance(ChaCha8Rng);

impl Chance {
    /// Every scene has its own random stream, so that none changes another.
    pub(super) fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    /// Evenly between two values.
    pub(super) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Draws uniformly between the logarithms of the ends of a range.
    pub(super) fn log_uniform(&mut self, [low, high]: Range) -> f64 {
        self.uniform(low.ln(), high.ln()).exp()
    }

    /// True with this probability.
    pub(super) fn flip(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }

    /// 1 or −1.
    pub(super) fn sign(&mut self) -> f64 {
        if self.flip(0.5) { 1.0 } else { -1.0 }
    }

    /// Draws a factor that is too large or too small by `percent`.
    pub(super) fn factor(&mut self, percent: f64) -> f64 {
        let factor = 1.0 + percent / 100.0;
        if self.flip(0.5) { factor } else { 1.0 / factor }
    }

    /// Draws a normal deviate of a quantity with this 95 % half-width.
    pub(super) fn vary(&mut self, half_width: f64) -> f64 {
        half_width / SIGMAS_OF_95 * self.normal()
    }

    /// A standard normal deviate.
    pub(super) fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// An index below `count`; 0 if `count` is 0.
    pub(super) fn index(&mut self, count: usize) -> usize {
        if count == 0 { 0 } else { self.0.random_range(0..count) }
    }

    /// Draws one of `all`, which must not be empty.
    pub(super) fn choose<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.index(all.len())]
    }

    /// A seed for the noise of a recording.
    pub(super) fn seed(&mut self) -> u64 {
        // TOML and JSON readers hold whole numbers of 53 bits reliably.
        self.0.random::<u64>() >> 11
    }
}

/// Rounds to three digits, as a person would state the value.
pub(super) fn round_to_three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// Rounds to this many decimal places, as a person would state the value.
pub(super) fn round(value: f64, places: i32) -> f64 {
    // Division by a power of ten gives the number nearest to the decimal one; multiplication by its inverse
    // does not.
    let scale = 10_f64.powi(places);
    (value * scale).round() / scale
}
