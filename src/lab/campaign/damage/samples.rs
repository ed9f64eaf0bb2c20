//! A damage that shows in the samples alone to the samples that have it.

use super::super::Case;
use super::{Kind, SOUND};
use crate::data::Unit;
use crate::lab::data::{SyntheticChannel, SyntheticRecording};
use std::f64::consts::TAU;

pub(super) const KINDS: &[Kind] = &[
    Kind {
        name: "non_finite",
        sizes: &[0.1, 1.0, 10.0, 50.0],
        unit: "% of the samples",
        after: non_finite,
        ..SOUND
    },
    Kind { name: "dead", after: |case, recording, _| dies(case, recording, -1.0), ..SOUND },
    Kind {
        name: "dies",
        sizes: &[0.0, 5.0, 30.0, 90.0],
        unit: "% of the way to the slap-down",
        after: |case, recording, size| dies(case, recording, size / 100.0),
        ..SOUND
    },
    Kind {
        name: "unplugged",
        sizes: &[0.0, 0.1, 1.0, 10.0, 100.0],
        unit: "g of hum",
        after: unplugged,
        ..SOUND
    },
    Kind { name: "drift", sizes: &[1.0, 3.0, 10.0, 30.0, 100.0], unit: "g/s", after: drift, ..SOUND },
    Kind { name: "spikes", sizes: &[1.0, 5.0, 20.0, 100.0], unit: "spikes", after: spikes, ..SOUND },
    Kind {
        name: "aliasing",
        sizes: &[3.0, 10.0, 30.0, 100.0, 300.0],
        unit: "% of the peak",
        before: |case, _| {
            case.scene.channels.iter_mut().for_each(|channel| channel.chain.anti_alias_hz = None);
        },
        after: aliasing,
        ..SOUND
    },
    Kind {
        name: "g_called_m_s2",
        sizes: &[1.0, 2.0],
        unit: "channels",
        after: |case, recording, size| unit(case, recording, size, Unit::MetrePerSecondSquared),
        ..SOUND
    },
    Kind {
        name: "m_s2_called_g",
        sizes: &[1.0, 2.0],
        unit: "channels",
        after: |case, recording, size| unit(case, recording, size, Unit::G),
        ..SOUND
    },
];

/// One of A1 and A2.
fn one<'a>(case: &mut Case, recording: &'a mut SyntheticRecording) -> &'a mut SyntheticChannel {
    &mut recording.channels[case.chance.index(2)]
}

/// Index of the sample at `since_s` after first contact.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast from float saturates")]
fn index(case: &Case, channel: &SyntheticChannel, since_s: f64) -> usize {
    let number = (case.scene.before_s + since_s) * channel.sample_rate_hz;
    (number.round() as usize).min(channel.samples.len())
}

/// Time of sample `index` after first contact, s.
#[allow(clippy::cast_precision_loss, reason = "counts stay below 2^52")]
fn time_s(case: &Case, channel: &SyntheticChannel, index: usize) -> f64 {
    index as f64 / channel.sample_rate_hz - case.scene.before_s
}

/// 1 g in the channel's unit.
fn g_in(channel: &SyntheticChannel) -> f64 {
    if channel.unit == "g" { 1.0 } else { super::super::recorder::STANDARD_GRAVITY_M_S2 }
}

/// The largest magnitude of a channel, in its unit.
fn peak(channel: &SyntheticChannel) -> f64 {
    channel.samples.iter().fold(0.0_f64, |peak, x| peak.max(f64::from(x.abs())))
}

#[allow(clippy::cast_possible_truncation, reason = "recorders store single precision")]
fn stored(value: f64) -> f32 {
    value as f32
}

/// Infinite samples here and there between first contact and slap-down.
fn non_finite(case: &mut Case, recording: &mut SyntheticRecording, size: f64) {
    let way_s = case.motion.truth.slap_t.unwrap_or(0.0);
    let channel = one(case, recording);
    for i in index(case, channel, -5e-3)..index(case, channel, way_s) {
        if case.chance.is(size / 100.0) {
            channel.samples[i] = f32::INFINITY;
        }
    }
}

/// The value stays from a share of the way to the slap-down on; below 0: over the whole record.
fn dies(case: &mut Case, recording: &mut SyntheticRecording, share: f64) {
    let way_s = case.motion.truth.slap_t.unwrap_or(0.0);
    let channel = one(case, recording);
    let from = if share < 0.0 { 0 } else { index(case, channel, share * way_s) };
    let held = channel.samples.get(from).copied().unwrap_or(0.0);
    channel.samples[from..].fill(held);
}

/// Nothing but noise and mains hum.
fn unplugged(case: &mut Case, recording: &mut SyntheticRecording, size: f64) {
    let phase = case.chance.even(0.0, TAU);
    let channel = one(case, recording);
    let g = g_in(channel);
    for i in 0..channel.samples.len() {
        let hum = size * (TAU * 50.0 * time_s(case, channel, i) + phase).sin();
        channel.samples[i] = stored(g * (hum + 0.05 * case.chance.normal()));
    }
}

/// A slope over the whole record.
fn drift(case: &mut Case, recording: &mut SyntheticRecording, size: f64) {
    let slope = size * case.chance.sign();
    let channel = one(case, recording);
    let g = g_in(channel);
    for i in 0..channel.samples.len() {
        let since_s = time_s(case, channel, i) + case.scene.before_s;
        channel.samples[i] += stored(g * slope * since_s);
    }
}

/// Single samples off by half to twice the peak, between 20 ms before first contact and the slap-down.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small whole number")]
fn spikes(case: &mut Case, recording: &mut SyntheticRecording, size: f64) {
    let way_s = case.motion.truth.slap_t.unwrap_or(0.0);
    let channel = one(case, recording);
    let peak = peak(channel);
    for _ in 0..size as usize {
        let since_s = case.chance.even(-20e-3, way_s);
        let at = index(case, channel, since_s);
        let off = case.chance.sign() * case.chance.even(0.5, 2.0) * peak;
        if let Some(sample) = channel.samples.get_mut(at) {
            *sample += stored(off);
        }
    }
}

/// The structure rings between half and three times the sample rate after both impacts, and no filter takes it off.
fn aliasing(case: &mut Case, recording: &mut SyntheticRecording, size: f64) {
    /// Ringing of a bolted structure at tens of kilohertz fades within this, s.
    const FADES_S: f64 = 3e-3;
    let way_s = case.motion.truth.slap_t.unwrap_or(0.0);
    let times_rate = case.chance.even(0.5, 3.0);
    for channel in &mut recording.channels {
        let amplitude = size / 100.0 * peak(channel);
        for struck_s in [0.0, way_s] {
            let phase = case.chance.even(0.0, TAU);
            for i in index(case, channel, struck_s)..channel.samples.len() {
                let since_s = time_s(case, channel, i) - struck_s;
                let fading = amplitude * (-since_s / FADES_S).exp();
                let swing = (TAU * times_rate * channel.sample_rate_hz * since_s + phase).sin();
                channel.samples[i] += stored(fading * swing);
            }
        }
    }
}

/// Cask file and recording both say `unit`, and the samples are in the other one.
fn unit(case: &mut Case, recording: &mut SyntheticRecording, size: f64, unit: Unit) {
    let g_m_s2 = super::super::recorder::STANDARD_GRAVITY_M_S2;
    let (only, all) = (case.chance.index(2), size > 1.5);
    for (i, channel) in recording.channels.iter_mut().enumerate() {
        let in_g = channel.unit == "g";
        // What the samples must be multiplied by to be in the unit that is not stated.
        let factor = match (unit, in_g) {
            (Unit::G, true) => g_m_s2,
            (Unit::G, false) | (_, true) => 1.0,
            (_, false) => 1.0 / g_m_s2,
        };
        if all || i == only {
            channel.samples.iter_mut().for_each(|x| *x = stored(f64::from(*x) * factor));
            if unit == Unit::G { "g" } else { "m/s^2" }.clone_into(&mut channel.unit);
            case.stated.channels[i].unit = Some(unit);
        }
        case.stated.channels[i].full_scale = None;
    }
}
