//! Finds the stretches in which a channel stands at a limit: a level between two kinks with nothing but noise
//! on it, which no force on a cask has.

use super::runs::find_runs;
use crate::data::Span;
use crate::numerics::{as_f64, reduce, robust};

/// Fewest samples at a limit.
const LEAST_RUN: usize = 3;
/// White noise stays within this many standard deviations over some thousand samples, on either side.
const NOISE_FACTOR: f64 = 4.0;
/// A channel's peak is at least this many standard deviations of its noise: below that a level may hide any
/// force.
const LEAST_PEAK: f64 = 28.0;
/// A limit is level within this share of its height, beside the noise: an amplifier that recovers drifts, and
/// a filter after the limit rings, by up to 2 % in 100 simulated overloads.
const LEVEL_SHARE: f64 = 0.005;
/// No sample of the channel exceeds a limit by more than this share, which such ringing reaches.
const BEYOND_SHARE: f64 = 0.03;
/// Amplifiers limit both signs alike: a level below this share of the peak is not one of their limits.
const SYMMETRY: f64 = 0.6;
/// Power of the distance from its middle with which the flattest top rounded by ringing falls; an ordinary
/// top falls with the second power.
const FLATTEST: i32 = 4;
/// A level is divided into this many parts, whose means are compared.
const PARTS: usize = 8;
/// Range of the samples of a rounded top over the range of its [`PARTS`] means: 1.3 for the flattest.
const MEANS_RANGE_FACTOR: f64 = 1.3;
/// A level carries noise if its spread is at most this many times the standard deviation, which few thousand
/// samples before the contact determine to 3 %; more is a body that rings. At 1.25 one real plateau in 300 is
/// a limit.
const MOST_NOISE_FACTOR: f64 = 1.08;
/// A filter after the limit adds ringing of up to this share of the level.
const RINGING_SHARE: f64 = 5e-4;
/// The converter's step adds this many steps to a spread by the median, which is 0 below a noise of 0.74
/// steps.
const STEP_SHARE: f64 = 0.6;

/// Search of a channel's samples for levels at a limit.
pub(super) struct LimitSearch<'a> {
    force: &'a [f64],
    /// Standard deviation of the noise, the converter's steps included.
    noise: f64,
    /// Smallest and largest sample.
    extremes: (f64, f64),
    /// The larger magnitude of both.
    peak: f64,
}

impl<'a> LimitSearch<'a> {
    /// Prepares the search in samples with that `noise`, from a converter of that `step`.
    pub fn new(force: &'a [f64], noise: f64, step: f64) -> Self {
        let (low, high) = reduce::extremes(force, 0.0);
        Self { force, noise: noise.hypot(STEP_SHARE * step), extremes: (low, high), peak: high.max(-low) }
    }

    /// Finds the runs at a limit.
    pub fn find(&self) -> Vec<Span> {
        let mut found = Vec::new();
        let (low, high) = self.extremes;
        for (sign, extreme) in [(1.0, high), (-1.0, -low)] {
            if extreme < SYMMETRY * self.peak || self.peak < LEAST_PEAK * self.noise {
                continue;
            }
            let beyond = (BEYOND_SHARE * extreme).max(2.0 * NOISE_FACTOR * self.noise);
            let least = extreme - beyond - NOISE_FACTOR * self.noise;
            let within = NOISE_FACTOR * self.noise + LEVEL_SHARE * extreme;
            for near in find_runs(self.force, |f| sign * f >= least) {
                let level = sign * robust::median(&mut self.force[near.from..near.to].to_vec());
                let at_level =
                    find_runs(&self.force[near.from..near.to], |f| (sign * f - level).abs() <= within);
                let spans = at_level.iter().map(|s| Span { from: near.from + s.from, to: near.from + s.to });
                let is_limit = |span: &Span| {
                    span.to - span.from >= LEAST_RUN
                        && extreme - level <= beyond
                        && self.is_noise(*span)
                        && self.kinks(*span).iter().all(|fall| sign * fall > 1.0)
                };
                found.extend(spans.filter(is_limit));
            }
        }
        found
    }

    /// Divides a level into its parts.
    fn parts(&self, span: Span) -> std::slice::ChunksExact<'a, f64> {
        self.force[span.from..span.to].chunks_exact(((span.to - span.from) / PARTS).max(1))
    }

    /// True if the inner parts of a level carry nothing but noise.
    fn is_noise(&self, span: Span) -> bool {
        let parts: Vec<&[f64]> = self.parts(span).collect();
        let inner = parts.get(1..parts.len().max(2) - 1).unwrap_or_default();
        let count: usize = inner.iter().map(|part| part.len() - 1).sum();
        if count == 0 {
            return true;
        }
        let squares = |part: &&[f64]| {
            let mean = reduce::sum(part) / as_f64(part.len());
            reduce::sum_by(part, |f| (f - mean).powi(2))
        };
        let rms = (inner.iter().map(squares).sum::<f64>() / as_f64(count)).sqrt();
        let most = self.noise * (MOST_NOISE_FACTOR + 3.0 / (2.0 * as_f64(count)).sqrt());
        rms <= most.hypot(RINGING_SHARE * self.force[span.from])
    }

    /// Falls of the signal before a level and after it, towards 0 on the positive side, over the fall from
    /// the flattest rounded top: above 1 and below −1 that is a kink.
    fn kinks(&self, span: Span) -> [f64; 2] {
        let count = span.to - span.from;
        // The comparison reaches a quarter of the level beyond it: far enough for the slope to exceed the
        // noise.
        let reach = (count / 4).max(1);
        let part = (count / PARTS).max(1);
        let means: Vec<f64> = self.parts(span).map(|part| reduce::sum(part) / as_f64(part.len())).collect();
        let (low, high) = reduce::extremes(&means, means[0]);
        let range = (high - low) * if part > 1 { MEANS_RANGE_FACTOR } else { 1.0 };
        let depth = range + NOISE_FACTOR * self.noise / as_f64(part).sqrt();
        let rounded = depth * flattest_top_fall(count, reach);
        // A single sample of noise is no kink.
        let rounded = rounded.max(2.0 * NOISE_FACTOR * self.noise).max(f64::MIN_POSITIVE);
        let level = robust::median(&mut self.force[span.from..span.to].to_vec());
        let largest_fall = |beyond: &[f64]| {
            let off = beyond.iter().map(|f| level - f);
            off.fold(0.0, |far: f64, off| if off.abs() > far.abs() { off } else { far }) / rounded
        };
        let before = &self.force[span.from.saturating_sub(reach)..span.from];
        [before, &self.force[span.to..(span.to + reach).min(self.force.len())]].map(largest_fall)
    }
}

/// Depth of the flattest rounded top `reach` samples beyond its `count` samples, over the depth within them:
/// ((n − 1 + 2 r)/(n − 1))⁴.
pub(super) fn flattest_top_fall(count: usize, reach: usize) -> f64 {
    (as_f64(count - 1 + 2 * reach) / as_f64(count - 1)).powi(FLATTEST)
}
