//! Samples to the stretches in which a channel stands at a level between two kinks, with nothing but noise
//! on it, as no cask's force does: at a limit, or where a cable left it.

use super::runs::{runs, runs_of_pairs};
use crate::data::{ChannelFinding, Finding, LevelKind, Signal, Span};
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

/// A break jumps by so many standard deviations of the noise …
const JUMP_NOISE: f64 = 20.0;
/// … and by this share of the peak; one shorter than [`LONG`] samples by the other: at few samples a period
/// ringing stands still for ten by chance.
const JUMP_SHARE: f64 = 0.01;
const SHORT_JUMP_SHARE: f64 = 0.05;
const LONG: usize = 24;
/// Fewest samples of a break, and of one that lasts until the record ends.
const LEAST_BREAK: usize = 10;
const LEAST_END: usize = 30;
/// Within so many samples of a jump the signal is where it goes on from there: a filter of fourth order at a
/// quarter of the rate settles in them.
const SETTLED: usize = 12;
/// A jump makes this share of that way in two samples; a half sine of 40 samples 0.2. Where only one side
/// jumps, because the signal passes the level as the contact comes back, that one makes the other share.
const JUMP: f64 = 0.55;
const CLEAR_JUMP: f64 = 0.75;
/// A level below this share of the peak is zero, one above the other the rail.
const ZERO_SHARE: f64 = 0.01;
const RAIL_SHARE: f64 = 0.75;

/// A channel's samples, and what its levels are measured by.
pub(super) struct Gauge<'a> {
    pub force: &'a [f64],
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

    /// The runs at a limit, with at most `noise_left` of the noise on them.
    pub fn limits(&self, noise_left: f64) -> Vec<Span> {
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
                        && self.is_noise(*span, noise_left)
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
    fn is_noise(&self, span: Span, noise_left: f64) -> bool {
        let parts: Vec<&[f64]> = self.parts(span).collect();
        let inner = parts.get(1..parts.len().max(2) - 1).unwrap_or_default();
        let count: usize = inner.iter().map(|part| part.len() - 1).sum();
        if count == 0 {
            return true;
        }
        let squares = |part: &&[f64]| {
            let mean = reduce::sum(part) / as_f64(part.len());
            reduce::sum_of(part, |f| (f - mean).powi(2))
        };
        let rms = (inner.iter().map(squares).sum::<f64>() / as_f64(count)).sqrt();
        if noise_left < 1.0 {
            // Where a force may stay level, no chance of few samples speaks for a limit.
            return rms <= noise_left * self.noise;
        }
        let most = self.noise * (MOST_NOISE + 3.0 / (2.0 * as_f64(count)).sqrt());
        rms <= most.hypot(RINGING_SHARE * self.force[span.from])
    }

    /// Whether the means of a level's inner parts differ by noise alone.
    fn is_even(&self, span: Span) -> bool {
        let means: Vec<f64> = self.parts(span).map(|part| reduce::sum(part) / as_f64(part.len())).collect();
        let inner = means.get(1..means.len().max(2) - 1).unwrap_or_default();
        let Some(first) = inner.first() else { return false };
        let (low, high) = reduce::extremes(inner, *first);
        let samples = as_f64(((span.to - span.from) / PARTS).max(1));
        high - low < 2.0 * NOISE_FACTOR * self.noise / samples.sqrt()
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
        // A top of that depth over n samples has fallen by ((n − 1 + 2 r)/(n − 1))⁴ − 1 of it r samples
        // farther on.
        let wider = as_f64(count - 1 + 2 * reach) / as_f64(count - 1);
        let rounded = depth * (wider.powi(FLATTEST) - 1.0);
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

    /// The breaks from sample `from` on.
    fn breaks(&self, from: usize) -> Vec<Span> {
        let mut found: Vec<Span> = Vec::new();
        let height = (JUMP_NOISE * self.noise).max(JUMP_SHARE * self.peak);
        let behind = self.force.get(from..).unwrap_or_default();
        if self.peak < LEAST_PEAK * self.noise || behind.len() < LEAST_BREAK {
            return found;
        }
        let mut tried = [0; 2];
        for jump in runs_of_pairs(behind, &behind[2..], |a, b| (b - a).abs() > height) {
            let (before, after) = (from + jump.from, from + jump.to + 1);
            for seed in [before.saturating_sub(SETTLED / 2), before, after, after + SETTLED / 2] {
                for (wide, tried) in [0.0, 1.0].into_iter().zip(&mut tried) {
                    if seed < *tried || seed < from || seed >= self.force.len() {
                        continue;
                    }
                    let band = 2.0 * NOISE_FACTOR * self.noise + wide * JUMP_SHARE * self.peak;
                    let span = self.level_about(seed, band, from);
                    *tried = span.to;
                    let is_new = found.iter().all(|other| other.to <= span.from || span.to <= other.from);
                    if is_new && self.is_break(span) {
                        found.push(span);
                    }
                }
            }
        }
        found
    }

    /// As far from `seed` as all samples lie within `band`.
    fn level_about(&self, seed: usize, band: f64, from: usize) -> Span {
        let (mut low, mut high) = (self.force[seed], self.force[seed]);
        let mut is_within = |f: &f64| {
            let wider = (low.min(*f), high.max(*f));
            let is_within = wider.1 - wider.0 <= band;
            if is_within {
                (low, high) = wider;
            }
            is_within
        };
        let after = self.force[seed..].iter().take_while(|f| is_within(f)).count();
        let before = self.force[from..seed].iter().rev().take_while(|f| is_within(f)).count();
        Span { from: seed - before, to: seed + after }
    }

    fn is_break(&self, span: Span) -> bool {
        let count = span.to - span.from;
        if count < LEAST_BREAK || !self.is_noise(span, 1.0) || !self.is_even(span) {
            return false;
        }
        let jumps = [self.jump(span, true), self.jump(span, false)];
        let is_torn = span.to + 2 >= self.force.len() && count > LEAST_END;
        let [before, after] = jumps.map(|share| share > JUMP);
        let kinks = self.kinks(span).map(|fall| fall.abs() > 1.0);
        let one_jumps =
            (jumps[0] > CLEAR_JUMP && kinks[1]) || (jumps[1] > CLEAR_JUMP && kinks[0] && span.from > 0);
        (before && (after || is_torn)) || one_jumps
    }

    /// The share that two samples make of the way from a level to where the signal is before it or after it;
    /// 0 where that is no farther than a break jumps.
    fn jump(&self, span: Span, before: bool) -> f64 {
        let beyond: Vec<f64> = if before {
            self.force[span.from.saturating_sub(SETTLED)..=span.from].iter().rev().copied().collect()
        } else {
            self.force[span.to - 1..(span.to + SETTLED).min(self.force.len())].to_vec()
        };
        let level = reduce::sum(&self.force[span.from..span.to]) / as_f64(span.to - span.from);
        let way = beyond.iter().map(|f| (f - level).abs()).fold(0.0, f64::max);
        let step = beyond.windows(3).map(|w| (w[2] - w[0]).abs()).fold(0.0, f64::max);
        let share = if span.to - span.from < LONG { SHORT_JUMP_SHARE } else { JUMP_SHARE };
        if way > (JUMP_NOISE * self.noise).max(share * self.peak) { step / way } else { 0.0 }
    }
}

/// Where a cable may have broken contact from `from_s` on, by the samples of one channel.
pub(super) fn breaks(signal: &Signal, step: f64, from_s: f64) -> Vec<Span> {
    let gauge = Gauge::new(&signal.force_m_s2, signal.noise_m_s2, step);
    let lost = || signal.gaps.iter().chain(&signal.clipped);
    let mut breaks = gauge.breaks(signal.index_from(from_s));
    breaks.retain(|span| lost().all(|l| l.to < span.from || span.to < l.from));
    breaks
}

/// Of each channel the breaks that no other one has at the same time: a force that stands still does so in
/// several, and a cable by itself.
pub(super) fn of_one_channel(signals: &[Signal], breaks: &[Vec<Span>]) -> Vec<Vec<Span>> {
    let times_s = |i: usize, s: &Span| (signals[i].time_s(s.from), signals[i].time_s(s.to));
    let is_own = |own: usize, span: &Span| {
        let (from_s, to_s) = times_s(own, span);
        let others = (0..signals.len()).filter(|other| *other != own);
        let mut spans = others.flat_map(|other| breaks[other].iter().map(move |s| times_s(other, s)));
        spans.all(|other| other.1 < from_s || to_s < other.0)
    };
    (0..signals.len()).map(|i| breaks[i].iter().filter(|s| is_own(i, s)).copied().collect()).collect()
}

/// Marks breaks as gaps, sets them to 0 and says so.
pub(super) fn mark(signal: &mut Signal, breaks: Vec<Span>) -> Option<Finding> {
    let longest = *breaks.iter().max_by_key(|span| span.to - span.from)?;
    let level_m_s2 = robust::median(&mut signal.force_m_s2[longest.from..longest.to].to_vec());
    let (peak, noise) = (reduce::peak(&signal.force_m_s2), signal.noise_m_s2);
    let at = match level_m_s2.abs() {
        level if level < ZERO_SHARE * peak + 2.0 * NOISE_FACTOR * noise => LevelKind::Zero,
        level if level > RAIL_SHARE * peak => LevelKind::Rail,
        _ => LevelKind::Offset,
    };
    let (first, last) = (breaks.iter().map(|s| s.from).min()?, breaks.iter().map(|s| s.to).max()?);
    let found = ChannelFinding::Broken {
        at,
        level_m_s2,
        breaks: breaks.len(),
        length_s: as_f64(longest.to - longest.from) / signal.sample_rate_hz,
        most_m_s: breaks.iter().map(|span| signal.bridged_m_s(*span)).fold(0.0, f64::max),
    };
    for span in &breaks {
        signal.force_m_s2[span.from..span.to].fill(0.0);
    }
    signal.gaps.extend(breaks);
    signal.gaps.sort_by_key(|gap| gap.from);
    Some(found.on(&signal.name).between(signal.time_s(first), signal.time_s(last)))
}

#[cfg(test)]
mod tests {
    use super::super::tests::signal;
    use super::*;
    use crate::data::FindingKind;
    use crate::data::example::noise;

    /// 20 ms of free fall, a half sine of 20 ms and ringing, at 10 kHz with noise of 1 m/s².
    fn struck() -> Signal {
        let shape = |i: u32| {
            let since = f64::from(i) - 200.0;
            let half_sine =
                if since < 200.0 { 4000.0 * (since / 200.0 * std::f64::consts::PI).sin() } else { 0.0 };
            half_sine + 300.0 * (-since / 400.0).exp() * (0.05 * since).sin()
        };
        signal((0..900).map(|i| if i < 200 { 0.0 } else { shape(i) } + noise(i, 1)).collect())
    }

    fn named(mut signal: Signal) -> Option<(LevelKind, Vec<Span>)> {
        let own = breaks(&signal, 0.0, 0.015);
        let found = mark(&mut signal, own)?;
        let FindingKind::Channel(ChannelFinding::Broken { at, .. }) = found.what else { panic!("{found:?}") };
        Some((at, signal.gaps))
    }

    #[test]
    fn a_break_is_a_gap_named_by_its_level() {
        for from in [260, 415, 500] {
            let kinds = [(0.0, LevelKind::Zero), (-900.0, LevelKind::Offset), (6000.0, LevelKind::Rail)];
            for (level, kind) in kinds {
                let mut broken = struck();
                for (f, i) in broken.force_m_s2[from..from + 40].iter_mut().zip(0..) {
                    *f = level + noise(i, 2);
                }
                let (at, gaps) = named(broken).expect("a break");
                assert_eq!(at, kind, "{from}");
                let [Span { from: begins, to }] = gaps[..] else { panic!("{gaps:?}") };
                assert!(begins.abs_diff(from) < 2 && to.abs_diff(from + 40) < 2, "{from} {gaps:?}");
            }
        }
    }

    #[test]
    fn a_torn_cable_stays_at_zero_and_a_sound_drop_has_no_break() {
        assert!(named(struck()).is_none());
        let mut torn = struck();
        for (f, i) in torn.force_m_s2[430..].iter_mut().zip(0..) {
            *f = noise(i, 2);
        }
        assert_eq!(named(torn).map(|(at, _)| at), Some(LevelKind::Zero));
    }
}
