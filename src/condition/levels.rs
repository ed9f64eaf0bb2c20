//! Samples to the stretches in which a channel stands at a limit: a level between two kinks with nothing but
//! noise on it, as no cask's force has.

use super::runs::runs;
use crate::data::Span;
use crate::numerics::{as_f64, reduce, robust};

/// Fewest samples at a limit.
const LEAST_RUN: usize = 3;
/// Standard deviations that white noise stays within over some thousand samples, on either side.
const NOISE_FACTOR: f64 = 4.0;
/// A channel's peak is so many standard deviations of its noise at the least: below that any force may hide
/// in a level.
const LEAST_PEAK: f64 = 28.0;
/// A limit is level within this share of it, beside the noise: an amplifier that recovers drifts, and a
/// filter behind the limit rings, by up to 2 % in 100 simulated overloads.
const LEVEL_SHARE: f64 = 0.005;
/// No sample of the channel is beyond a limit by more than this share, which such ringing reaches.
const BEYOND_SHARE: f64 = 0.03;
/// Amplifiers limit both signs alike: a level below this share of the peak is none of their limits.
const SYMMETRY: f64 = 0.6;
/// The flattest top that ringing rounds is taken to be one of this power of the distance from its middle; a
/// plain one is of the second.
const FLATTEST: i32 = 4;
/// Parts of a level of which the means are compared.
const PARTS: usize = 8;
/// The range of so many means of a rounded top over that of its samples, turned over: 1.3 for the flattest.
const RANGE_OF_MEANS: f64 = 1.3;
/// What stands on a level is noise up to this many times its standard deviation, which few thousand samples
/// before the contact tell to 3 %; more is a body that rings. At 1.25 one real plateau in 300 is a limit.
const MOST_NOISE: f64 = 1.08;
/// … and up to this share of the level, which a filter behind the limit leaves of its ringing.
const RINGING_SHARE: f64 = 5e-4;
/// What the converter's step adds to a spread by the median, in steps: that is 0 below a noise of 0.74 steps.
const STEP_SHARE: f64 = 0.6;

/// A channel's samples, and what its levels are measured by.
pub(super) struct Gauge<'a> {
    force: &'a [f64],
    /// Standard deviation of its noise, the converter's steps included.
    noise: f64,
    /// The largest sample, and its magnitude.
    extremes: (f64, f64),
    peak: f64,
}

impl<'a> Gauge<'a> {
    /// Of samples with that noise, from a converter of that `step`.
    pub fn new(force: &'a [f64], noise: f64, step: f64) -> Self {
        let (low, high) = reduce::extremes(force, 0.0);
        Self { force, noise: noise.hypot(STEP_SHARE * step), extremes: (low, high), peak: high.max(-low) }
    }

    /// The runs at a limit.
    pub fn limits(&self) -> Vec<Span> {
        let mut found = Vec::new();
        let (low, high) = self.extremes;
        for (sign, extreme) in [(1.0, high), (-1.0, -low)] {
            if extreme < SYMMETRY * self.peak || self.peak < LEAST_PEAK * self.noise {
                continue;
            }
            let beyond = (BEYOND_SHARE * extreme).max(2.0 * NOISE_FACTOR * self.noise);
            let least = extreme - beyond - NOISE_FACTOR * self.noise;
            let within = NOISE_FACTOR * self.noise + LEVEL_SHARE * extreme;
            for near in runs(self.force, |f| sign * f >= least) {
                let level = sign * robust::median(&mut self.force[near.from..near.to].to_vec());
                let at_level = runs(&self.force[near.from..near.to], |f| (sign * f - level).abs() <= within);
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

    /// A level's parts.
    fn parts(&self, span: Span) -> std::slice::ChunksExact<'a, f64> {
        self.force[span.from..span.to].chunks_exact(((span.to - span.from) / PARTS).max(1))
    }

    /// Whether all that stands on a level's inner parts is noise.
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
        let most = self.noise * (MOST_NOISE + 3.0 / (2.0 * as_f64(count)).sqrt());
        rms <= most.hypot(RINGING_SHARE * self.force[span.from])
    }

    /// By how much the signal falls off a level before it and after it, towards 0 on the positive side, over
    /// what it would off the flattest rounded top: above 1 and below −1 that is a kink.
    fn kinks(&self, span: Span) -> [f64; 2] {
        let count = span.to - span.from;
        // A quarter of the level beyond it: far enough for the slope to stand out of the noise.
        let reach = (count / 4).max(1);
        let part = (count / PARTS).max(1);
        let means: Vec<f64> = self.parts(span).map(|part| reduce::sum(part) / as_f64(part.len())).collect();
        let (low, high) = reduce::extremes(&means, means[0]);
        let range = (high - low) * if part > 1 { RANGE_OF_MEANS } else { 1.0 };
        let depth = range + NOISE_FACTOR * self.noise / as_f64(part).sqrt();
        // A top of that depth over n samples has fallen by ((n − 1 + 2 r)/(n − 1))⁴ of it r samples farther
        // on.
        let wider = as_f64(count - 1 + 2 * reach) / as_f64(count - 1);
        let rounded = depth * wider.powi(FLATTEST);
        // A single sample of noise is no kink.
        let rounded = rounded.max(2.0 * NOISE_FACTOR * self.noise).max(f64::MIN_POSITIVE);
        let level = robust::median(&mut self.force[span.from..span.to].to_vec());
        let farthest = |beyond: &[f64]| {
            let off = beyond.iter().map(|f| level - f);
            off.fold(0.0, |far: f64, off| if off.abs() > far.abs() { off } else { far }) / rounded
        };
        let before = &self.force[span.from.saturating_sub(reach)..span.from];
        [before, &self.force[span.to..(span.to + reach).min(self.force.len())]].map(farthest)
    }
}
