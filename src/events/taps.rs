//! Finds a channel's responses to taps on a cask at rest.

use crate::data::{Channel, TapAnswer};
use crate::numerics::{as_count, as_f64, robust};

/// A tap exceeds this many spreads of the noise: none of ten million samples of noise does.
const TAP_SPREADS: f64 = 20.0;
/// Ringing stays above the noise without a pause of this length, s; taps by hand are farther apart.
const PAUSE_S: f64 = 0.25;
/// The peak of a tap is sought this long, and its foot this long before it is loud, s.
const PEAK_S: f64 = 0.02;
const FOOT_S: f64 = 0.01;
/// Shares of its peak at which the response begins, and at which its direction is read.
const FOOT: f64 = 0.1;
const SWING: f64 = 0.3;
/// The foot passes this many spreads of the noise.
const FOOT_SPREADS: f64 = 8.0;

/// The channel's responses to the taps that it shows, in the order of time.
pub fn tap_answers(channel: &Channel) -> Vec<TapAnswer> {
    let mut force = channel.force_m_s2(0, channel.samples.len());
    let (centre, spread) = robust::centre_and_spread(&force);
    for f in &mut force {
        *f = if f.is_finite() { *f - centre } else { 0.0 };
    }
    let rate_hz = channel.sample_rate_hz;
    let samples = |length_s: f64| as_count((length_s * rate_hz).ceil());
    let mut answers = Vec::new();
    let mut last = None;
    for i in (0..force.len()).filter(|&i| spread > 0.0 && force[i].abs() > TAP_SPREADS * spread) {
        let is_new = last.is_none_or(|last| i - last > samples(PAUSE_S));
        last = Some(i);
        if is_new {
            let answer = &force[i.saturating_sub(samples(FOOT_S))..(i + samples(PEAK_S)).min(force.len())];
            let peak = answer.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
            let first = |least: f64| answer.iter().position(|f| f.abs() >= least).unwrap_or(0);
            let foot = i.saturating_sub(samples(FOOT_S)) + first((FOOT * peak).max(FOOT_SPREADS * spread));
            let goes_up = answer[first(SWING * peak)] > 0.0;
            answers.push(TapAnswer { at_s: channel.start_s + as_f64(foot) / rate_hz, goes_up });
        }
    }
    answers
}
