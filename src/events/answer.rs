//! Measures the delay between the responses of two channels to the first impact.

use crate::data::{Axis, End, Onset, Signal, transverse};
use crate::numerics::projection::residual_square;
use crate::numerics::quadrature::running_integral;
use crate::numerics::reduce::{block_means, peak};
use crate::numerics::{as_count, as_f64};
use rayon::prelude::*;
use std::ops::Range;

/// A response below this share of the struck end's peak is not used: the sensor sits near the centre of
/// percussion.
const LEAST_SHARE: f64 = 0.02;
/// A response below this many standard deviations of its noise is not used.
const LEAST_NOISE: f64 = 10.0;
/// The response is seen where it first passes this many standard deviations.
const SEEN_NOISE: f64 = 6.0;
/// Responses are sought this long before first contact and after the contact, s: clocks and bending waves.
const BEFORE_S: f64 = 8e-3;
const AFTER_S: f64 = 6e-3;
/// Residual of the expansion in integrals, as a share of the RMS of a response: modes up to 450 Hz over a
/// millisecond.
const MODEL_SHARE: f64 = 0.005;
/// Lengths of the stretches fitted after the response is seen, s: short ones hold few modes, long ones exceed
/// the noise.
const LENGTHS_S: [f64; 7] = [0.4e-3, 0.7e-3, 1e-3, 1.5e-3, 2e-3, 3e-3, 4e-3];
/// Longest first contact whose peak is used, s.
const CONTACT_S: f64 = 0.02;
/// Most block means to which a stretch is fitted: over the longest stretch 50 per period of 450 Hz.
const POINTS: usize = 80;
/// Steps that differ by less than this share are equal: over a fit of [`POINTS`] the error stays below a
/// millionth of a step.
const SAME_STEP: f64 = 1e-9;
/// Starts after the answer is seen, s, up to which the force may still turn its direction, and lengths of the
/// stretches fitted from there on, s.
const LATER_S: [f64; 3] = [0.4e-3, 0.8e-3, 1.6e-3];
const LATER_LENGTHS_S: [f64; 3] = [1e-3, 2e-3, 4e-3];
/// A delay must explain those stretches better than no delay by this many variances of the noise: three
/// standard deviations.
const BETTER_VARIANCES: f64 = 10.0;
/// Longest time in which a force turns its direction, s: L that slides back at 0.5 m/s is held within a
/// millisecond, at 0.1 m/s within 0.4 ms.
const TURNS_S: f64 = 7e-4;
/// Delays tried in a fit, and between the best two of them.
const TRIED_DELAYS: u32 = 80;
const REFINED_DELAYS: u32 = 20;

/// Delays of the answers of all transverse channels relative to the struck end's channel.
///
/// Rigid body and bending respond to a force F with a F + b ∫∫F + c ∫∫∫∫F + … from the same moment on   (Q1).
/// The struck end's channel represents F; the delay is the one at which its integrals explain the other
/// channel best. Channels that hardly respond are omitted.
pub fn answers(signals: &[Signal], contact_s: f64) -> Vec<Onset> {
    let Some(struck) = transverse(signals, End::First) else { return Vec::new() };
    let Some(cause) = Cause::new(struck, contact_s) else { return Vec::new() };
    signals
        .iter()
        .filter(|s| s.axis == Axis::Transverse && s.name != struck.name)
        .filter_map(|signal| AnswerFit::new(signal, &cause)?.delay())
        .collect()
}

/// The struck end's channel from first contact on, and its repeated integrals.
struct Cause {
    contact_s: f64,
    start_s: f64,
    sample_rate_hz: f64,
    integrals: Vec<Vec<f64>>,
    peak: f64,
    noise: f64,
}

impl Cause {
    fn new(signal: &Signal, contact_s: f64) -> Option<Self> {
        let rate_hz = signal.sample_rate_hz;
        let from = signal.index_from(contact_s - BEFORE_S);
        let to = signal.index_from(contact_s + CONTACT_S + AFTER_S);
        let struck = signal.index_from(contact_s - 1.0 / rate_hz).saturating_sub(from);
        let mut force = signal.force_m_s2.get(from..to)?.to_vec();
        force.get_mut(..struck)?.fill(0.0);
        let mut integrals = vec![force];
        for _ in 0..4 {
            // With milliseconds as the unit of time the integrals have the same order of magnitude as the
            // force.
            let next = running_integral(integrals.last()?, 1e3 / rate_hz);
            integrals.push(next);
        }
        let largest = peak(&integrals[0]);
        (largest > 0.0).then_some(Self {
            contact_s,
            start_s: signal.time_s(from),
            sample_rate_hz: rate_hz,
            integrals,
            peak: largest,
            noise: signal.noise_m_s2,
        })
    }

    /// Averages the integrals of these orders over blocks of `block` samples; the others are left empty.
    fn average_blocks(&self, block: usize, orders: &[usize]) -> Self {
        let of_order = |order| match self.integrals.get(order) {
            Some(values) if orders.contains(&order) => block_means(values, block),
            _ => Vec::new(),
        };
        Self {
            start_s: self.start_s + as_f64(block - 1) / 2.0 / self.sample_rate_hz,
            sample_rate_hz: self.sample_rate_hz / as_f64(block),
            integrals: (0..self.integrals.len()).map(of_order).collect(),
            ..*self
        }
    }

    /// The integrals of these orders at `count` times from `from_s` on, `step_s` apart, linear between
    /// samples.
    fn regressors(&self, orders: &[usize], from_s: f64, step_s: f64, count: usize) -> Vec<Vec<f64>> {
        let first = (from_s - self.start_s) * self.sample_rate_hz;
        let step = step_s * self.sample_rate_hz;
        let values = orders.iter().filter_map(|&order| self.integrals.get(order));
        values
            .filter(|values| values.len() >= 2)
            .map(|values| {
                // Both series have the same times except for a fraction of a step, if both channels have the
                // same rate.
                let (index, share) = (as_count(first), first.fract());
                let same = if first >= 0.0 && (step - 1.0).abs() < SAME_STEP {
                    values.get(index..index + count + 1)
                } else {
                    None
                };
                if let Some(same) = same {
                    return same.windows(2).map(|pair| pair[0] + share * (pair[1] - pair[0])).collect();
                }
                let last = values.len().saturating_sub(2);
                let at = |i: usize| {
                    let position = (first + as_f64(i) * step).max(0.0);
                    let index = as_count(position).min(last);
                    let share = (position - as_f64(index)).min(1.0);
                    values[index] + share * (values[index + 1] - values[index])
                };
                (0..count).map(at).collect()
            })
            .collect()
    }
}

/// A channel around its answer.
struct AnswerFit<'a> {
    signal: &'a Signal,
    cause: &'a Cause,
    /// First sample that exceeds the noise.
    seen: usize,
    /// Noise of the channel and, through its share of the cause, of the cause, m/s².
    noise: f64,
}

impl<'a> AnswerFit<'a> {
    fn new(signal: &'a Signal, cause: &'a Cause) -> Option<Self> {
        let from = signal.index_from(cause.contact_s - BEFORE_S);
        let to = signal.index_from(cause.contact_s + CONTACT_S);
        let force = signal.force_m_s2.get(from..to)?;
        let largest = peak(force);
        if largest < (LEAST_NOISE * signal.noise_m_s2).max(LEAST_SHARE * cause.peak) {
            return None;
        }
        let foot = (SEEN_NOISE * signal.noise_m_s2).max(LEAST_SHARE * largest);
        let seen = from + force.iter().position(|f| f.abs() > foot)?;
        let is_whole = !signal.overlaps(&signal.gaps, cause.contact_s - BEFORE_S, cause.contact_s + AFTER_S);
        let noise = signal.noise_m_s2.hypot(cause.noise * largest / cause.peak);
        (is_whole && seen > from).then_some(Self { signal, cause, seen, noise })
    }

    /// The delay from the shortest stretch that determines it well; its uncertainty includes the differences
    /// of the longer stretches.
    fn delay(&self) -> Option<Onset> {
        let fits: Vec<Onset> = LENGTHS_S.par_iter().filter_map(|&length_s| self.fit(length_s)).collect();
        let fine_s = 5e-5_f64.max(0.5 / self.signal.sample_rate_hz);
        let taken = fits
            .iter()
            .find(|fit| fit.u_s <= fine_s)
            .or_else(|| fits.iter().min_by(|a, b| a.u_s.total_cmp(&b.u_s)))?;
        let comparable = fits.iter().filter(|fit| fit.u_s < 4.0 * taken.u_s + fine_s);
        let apart_s = comparable.map(|fit| (fit.delay_s - taken.delay_s).abs()).fold(0.0, f64::max);
        let mut u_s = taken.u_s.max(apart_s / 2.0);
        // An answer that begins below the noise looks late: if no delay explains it as well, the delay is not
        // determined.
        if self.needs_no_delay(taken.delay_s) {
            u_s = u_s.max(taken.delay_s.abs() / 2.0);
        }
        // A clock is apart all along.
        if (2.0 * u_s..TURNS_S).contains(&taken.delay_s.abs()) && !self.confirms_delay(taken.delay_s) {
            u_s = taken.delay_s.abs() / 2.0;
        }
        Some(Onset { u_s, ..taken.clone() })
    }

    /// The best delay over a stretch that ends `length_s` after the answer is seen; `None` if no fit is
    /// possible.
    fn fit(&self, length_s: f64) -> Option<Onset> {
        const ORDERS: [usize; 3] = [0, 2, 4];
        let rate_hz = self.signal.sample_rate_hz;
        let back_s = (2.0 * length_s).clamp(5e-4, 3e-3);
        let (from, to) = (
            self.seen.saturating_sub(as_count(back_s * rate_hz) + 4),
            self.seen + as_count(length_s * rate_hz),
        );
        if to - self.seen < ORDERS.len() + 4 {
            return None;
        }
        let block = (to - from).div_ceil(POINTS);
        let values = block_means(self.signal.force_m_s2.get(from..to)?, block);
        // The block lasts as long if the other channel has another rate.
        let of_cause = as_count(as_f64(block) * self.cause.sample_rate_hz / rate_hz).max(1);
        let cause = self.cause.average_blocks(of_cause, &ORDERS);
        let noise = self.block_noise(block);
        let begin_s = self.signal.time_s(from) + as_f64(block - 1) / 2.0 / rate_hz;
        let left =
            |delay_s: f64| residual(&values, begin_s - delay_s, as_f64(block) / rate_hz, &cause, &ORDERS);
        let seen_s = self.signal.time_s(self.seen) - self.cause.contact_s;
        let (low_s, high_s) = (seen_s - back_s - 3.0 / rate_hz, seen_s + length_s / 2.0);
        let (step_s, coarse) = scan(low_s..high_s, TRIED_DELAYS, &left);
        let best = (0..coarse.len()).min_by(|&a, &b| coarse[a].1.total_cmp(&coarse[b].1))?;
        if best == 0 || best + 1 == coarse.len() {
            return None;
        }
        let (_, fine) = scan(coarse[best - 1].0..coarse[best + 1].0, REFINED_DELAYS, &left);
        let &(delay_s, least) = fine.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let freedom = as_f64(values.len() - ORDERS.len() - 1);
        let answered = as_f64(to - self.seen) / as_f64(block);
        let model = MODEL_SHARE * size(&values, answered);
        if (least / freedom).sqrt() > (2.0 * noise).hypot(model) {
            return None;
        }
        // Twice the standard uncertainty is the point at which the sum of squares has grown by four
        // variances, or by the error of the model.
        let variance = (least / freedom).max(noise.powi(2));
        let limit = least + 4.0 * variance + model.powi(2) * answered / 4.0;
        let mut as_good = coarse.iter().filter(|c| c.1 <= limit).map(|c| c.0);
        let first_s = as_good.next().unwrap_or(delay_s);
        let last_s = as_good.next_back().unwrap_or(first_s);
        let u_s = ((last_s - first_s) / 4.0).max(step_s / 4.0);
        Some(Onset { channel: self.signal.name.clone(), delay_s, u_s })
    }

    /// True if rigid body, bending and its damping explain some stretch from first contact on without any
    /// delay.
    fn needs_no_delay(&self, delay_s: f64) -> bool {
        const ORDERS: [usize; 5] = [0, 1, 2, 3, 4];
        let signal = self.signal;
        LENGTHS_S[..6].iter().any(|&length_s| {
            let contact_s = self.cause.contact_s;
            let from = signal.index_from(contact_s - 1e-3).min(self.seen.saturating_sub(4));
            let begins = self.seen.max(signal.index_from(contact_s + delay_s));
            let to = begins + as_count(length_s * signal.sample_rate_hz);
            let Some(values) = signal.force_m_s2.get(from..to) else { return false };
            let square: f64 = values.iter().map(|v| v * v).sum();
            let stands_out = square > 9.0 * as_f64(values.len()) * self.noise.powi(2);
            if values.len() < ORDERS.len() + 6 || !stands_out {
                return false;
            }
            let step_s = 1.0 / signal.sample_rate_hz;
            let left = residual(values, signal.time_s(from), step_s, self.cause, &ORDERS);
            let rms = (left / as_f64(values.len() - 6)).sqrt();
            rms < (1.5 * self.noise).hypot(MODEL_SHARE * size(values, as_f64((to - self.seen).max(1))))
        })
    }

    /// True if the later part of the answer supports this delay rather than none: otherwise the force may
    /// have turned its direction in the beginning, for example if L slides back until it sticks.
    ///
    /// The motion up to then continues as a straight line.
    fn confirms_delay(&self, delay_s: f64) -> bool {
        const ORDERS: [usize; 3] = [0, 2, 4];
        let (signal, rate_hz) = (self.signal, self.signal.sample_rate_hz);
        let mut in_favour = 0.0;
        for (later_s, length_s) in LATER_S.iter().flat_map(|&s| LATER_LENGTHS_S.map(|length_s| (s, length_s)))
        {
            let from = self.seen + as_count(later_s * rate_hz);
            let to = from + as_count(length_s * rate_hz);
            let block = ((to - from) / POINTS).max(1);
            let Some(force) = signal.force_m_s2.get(from..to) else { continue };
            let values = block_means(force, block);
            let of_cause = as_count(as_f64(block) * self.cause.sample_rate_hz / rate_hz).max(1);
            let cause = self.cause.average_blocks(of_cause, &ORDERS);
            let begin_s = signal.time_s(from) + as_f64(block - 1) / 2.0 / rate_hz;
            let count = values.len();
            if count < ORDERS.len() + 8 {
                continue;
            }
            let left = |delay_s: f64| {
                let step_s = as_f64(block) / rate_hz;
                let mut regressors = cause.regressors(&ORDERS, begin_s - delay_s, step_s, count);
                regressors.extend([vec![1.0; count], (0..count).map(as_f64).collect()]);
                residual_square(&values, regressors)
            };
            let (without, with) = (left(0.0), left(delay_s));
            let freedom = as_f64(count - ORDERS.len() - 2);
            let noise = self.block_noise(block);
            let variance = noise.powi(2).max(without.min(with) / freedom);
            let explained = (1.5 * noise).hypot(MODEL_SHARE * size(&values, as_f64(count)));
            if (without.min(with) / freedom).sqrt() > explained {
                continue;
            }
            in_favour += (without - with) / variance;
        }
        in_favour > BETTER_VARIANCES
    }

    /// Noise of the means of `block` samples, from those before first contact, since noise need not be white.
    fn block_noise(&self, block: usize) -> f64 {
        let to = self.signal.index_from(self.cause.contact_s - BEFORE_S);
        let before = self.signal.force_m_s2.get(to.saturating_sub(POINTS * block)..to).unwrap_or_default();
        let means = block_means(before, block);
        let rms = size(&means, as_f64(means.len().max(1)));
        if block == 1 { self.noise } else { (self.noise / as_f64(block).sqrt()).max(rms).min(self.noise) }
    }
}

/// Sum of squares of `values` that the cause's integrals do not explain; `values` begin at `from_s`, `step_s`
/// apart.
fn residual(values: &[f64], from_s: f64, step_s: f64, cause: &Cause, orders: &[usize]) -> f64 {
    residual_square(values, cause.regressors(orders, from_s, step_s, values.len()))
}

/// Root mean square of the values over `count`, if the values outside are close to zero.
fn size(values: &[f64], count: f64) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / count).sqrt()
}

/// Evaluates `function` at `steps` + 1 places over a range, and returns their distance too.
fn scan(over: Range<f64>, steps: u32, function: &impl Fn(f64) -> f64) -> (f64, Vec<(f64, f64)>) {
    let step = (over.end - over.start) / f64::from(steps);
    let places = (0..=steps).map(|i| over.start + f64::from(i) * step);
    (step, places.map(|x| (x, function(x))).collect())
}

#[cfg(test)]
mod tests;
