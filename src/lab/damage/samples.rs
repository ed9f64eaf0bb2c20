//! Damages that change the samples alone.

use super::super::data::{SyntheticChannel, SyntheticRecording};
use super::super::drawn::{DrawnDrop, DropPlan, unit_m_s2};
use super::super::synth;
use crate::data::{STANDARD_GRAVITY_M_S2, Unit};
use crate::numerics::{as_count, as_f64, to_f32};
use std::f64::consts::TAU;

/// Damages the recording by `kind`; kinds that belong to another object have no effect.
pub(super) fn apply(kind: &str, case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    match kind {
        "non_finite" => non_finite(case, recording, size),
        "dead" => dies(case, recording, -1.0),
        "dies" => dies(case, recording, size / 100.0),
        "unplugged" => unplug(case, recording, size),
        "limited_first" => limit(case, recording, 0, size),
        "limited_second" => limit(case, recording, 1, size),
        "slewing" => limit_slew(case, recording, size),
        "overloaded" => overload(case, recording, size),
        "compressed" => compress(case, recording, size),
        "breaks" => breaks(case, recording, size),
        "loose_plug" => loose_plug(case, recording, size),
        "trigger" => trigger(case, recording, size),
        "drift" => drift(case, recording, size),
        "spikes" => spikes(case, recording, size),
        "base_strain" => base_strain(case, recording, size),
        "thermal" => thermal(case, recording, size),
        "aliasing" => aliasing(case, recording, size),
        "g_called_m_s2" => unit(case, recording, size, Unit::MetrePerSecondSquared),
        "m_s2_called_g" => unit(case, recording, size, Unit::G),
        "copied" => recording.channels[1].samples = recording.channels[0].samples.clone(),
        _ => {}
    }
}

/// Picks A1 or A2 at random.
fn pick<'a>(case: &mut DrawnDrop, recording: &'a mut SyntheticRecording) -> &'a mut SyntheticChannel {
    &mut recording.channels[case.chance.index(2)]
}

/// Index of the sample at `since_s` after first contact.
fn index(case: &DrawnDrop, channel: &SyntheticChannel, since_s: f64) -> usize {
    let number = (case.scene.before_s + since_s) * channel.sample_rate_hz;
    as_count(number.round()).min(channel.samples.len())
}

/// Time of sample `index` after first contact, s.
fn time_s(case: &DrawnDrop, channel: &SyntheticChannel, index: usize) -> f64 {
    channel.time_s(index) - case.scene.before_s
}

/// 1 g in the channel's unit.
fn g_in(channel: &SyntheticChannel) -> f64 {
    STANDARD_GRAVITY_M_S2 / unit_m_s2(&channel.unit)
}

/// The largest magnitude of a channel, in its unit.
fn peak(channel: &SyntheticChannel) -> f64 {
    channel.samples.iter().fold(0.0_f64, |peak, x| peak.max(f64::from(x.abs())))
}

/// Puts infinite samples in random places between first contact and slap-down.
fn non_finite(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let way_s = case.contact_to_strike_s();
    let channel = pick(case, recording);
    for i in index(case, channel, -5e-3)..index(case, channel, way_s) {
        if case.chance.flip(size / 100.0) {
            channel.samples[i] = f32::INFINITY;
        }
    }
}

/// Freezes the value from a share of the time to the slap-down on; below 0 over the whole record.
fn dies(case: &mut DrawnDrop, recording: &mut SyntheticRecording, share: f64) {
    let way_s = case.contact_to_strike_s();
    let channel = pick(case, recording);
    let from = if share < 0.0 { 0 } else { index(case, channel, share * way_s) };
    let held = channel.samples.get(from).copied().unwrap_or(0.0);
    channel.samples[from..].fill(held);
}

/// Replaces a channel by noise and mains hum.
fn unplug(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let phase = case.chance.uniform(0.0, TAU);
    let channel = pick(case, recording);
    let g = g_in(channel);
    for i in 0..channel.samples.len() {
        let hum = size * (TAU * 50.0 * time_s(case, channel, i) + phase).sin();
        channel.samples[i] = to_f32(g * (hum + 0.05 * case.chance.normal()));
    }
}

/// Noise of a converter, g.
const CONVERTER_G: f64 = 0.1;

/// Limits the signal at `size` percent below the peak, with the converter's noise after it.
fn limit(case: &mut DrawnDrop, recording: &mut SyntheticRecording, which: usize, size: f64) {
    let channel = &mut recording.channels[which];
    let (limit, noise) = ((1.0 - size / 100.0) * peak(channel), CONVERTER_G * g_in(channel));
    for sample in &mut channel.samples {
        *sample = to_f32(f64::from(*sample).clamp(-limit, limit) + noise * case.chance.normal());
    }
    case.stated.channels[which].full_scale = None;
}

/// Limits the slope to `size` percent below the steepest.
fn limit_slew(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let channel = pick(case, recording);
    let steepest = channel.samples.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
    let most = to_f32((1.0 - size / 100.0) * f64::from(steepest));
    let mut reads = channel.samples.first().copied().unwrap_or(0.0);
    for sample in &mut channel.samples {
        reads += (*sample - reads).clamp(-most, most);
        *sample = reads;
    }
}

/// Limits the signal at `size` percent below the peak, with a recovery within 5 to 50 ms.
fn overload(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let fades_s = case.chance.log_uniform([5e-3, 50e-3]);
    let channel = pick(case, recording);
    let limit = (1.0 - size / 100.0) * peak(channel);
    let kept = (-1.0 / (fades_s * channel.sample_rate_hz)).exp();
    let mut charged = 0.0;
    for sample in &mut channel.samples {
        let force = f64::from(*sample);
        let beyond = force - force.clamp(-limit, limit);
        charged = kept * charged - (1.0 - kept) * beyond;
        *sample = to_f32(force - beyond + charged);
    }
}

/// Reads the peak too low by `size` percent, and smaller forces by less: by the cube of the reading.
fn compress(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let channel = pick(case, recording);
    let peak = peak(channel);
    for sample in &mut channel.samples {
        let force = f64::from(*sample);
        *sample = to_f32(force * (1.0 - size / 100.0 * (force / peak).powi(2)));
    }
}

/// Breaks the cable after `size` percent of the time to the slap-down: noise from there on, about 0 or at a
/// rail.
fn breaks(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let since_s = size / 100.0 * case.contact_to_strike_s();
    let rail = if case.chance.flip(0.5) { case.chance.sign() } else { 0.0 };
    let channel = pick(case, recording);
    let (level, noise, from) =
        (rail * peak(channel), CONVERTER_G * g_in(channel), index(case, channel, since_s));
    for sample in &mut channel.samples[from..] {
        *sample = to_f32(level + noise * case.chance.normal());
    }
}

/// Disconnects the plug for 0.3 to 2 ms, `size` times between first contact and slap-down.
fn loose_plug(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let way_s = case.contact_to_strike_s();
    let channel = pick(case, recording);
    for _ in 0..as_count(size) {
        let (since_s, long_s) = (case.chance.uniform(0.0, way_s), case.chance.log_uniform([3e-4, 2e-3]));
        let span = index(case, channel, since_s)..index(case, channel, since_s + long_s);
        channel.samples[span].fill(0.0);
    }
}

/// Adds the pulse that a trigger couples into a channel within the first contact: `size` percent of the peak,
/// fading within half a millisecond.
fn trigger(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    const FADES_S: f64 = 5e-4;
    let since_s = case.chance.uniform(0.0, case.contact_s());
    let share = case.chance.sign() * size / 100.0;
    let channel = pick(case, recording);
    let (amplitude, fades) = (share * peak(channel), FADES_S * channel.sample_rate_hz);
    let from = index(case, channel, since_s);
    for (i, sample) in channel.samples[from..].iter_mut().enumerate() {
        *sample += to_f32(amplitude * (-as_f64(i) / fades).exp());
    }
}

/// A slope over the whole record.
fn drift(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let slope = size * case.chance.sign();
    let channel = pick(case, recording);
    let g = g_in(channel);
    for i in 0..channel.samples.len() {
        let since_s = time_s(case, channel, i) + case.scene.before_s;
        channel.samples[i] += to_f32(g * slope * since_s);
    }
}

/// Changes single samples by half to twice the peak, between 20 ms before first contact and the slap-down.
fn spikes(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let way_s = case.contact_to_strike_s();
    let channel = pick(case, recording);
    let peak = peak(channel);
    for _ in 0..as_count(size) {
        let since_s = case.chance.uniform(-20e-3, way_s);
        let at = index(case, channel, since_s);
        let off = case.chance.sign() * case.chance.uniform(0.5, 2.0) * peak;
        if let Some(sample) = channel.samples.get_mut(at) {
            *sample += to_f32(off);
        }
    }
}

/// Adds base strain in step with the bending from the first end's force.
fn base_strain(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let first = &recording.channels[0];
    let mode = DropPlan::mode(1, case.scene.modes.first().map_or(100.0, |mode| mode.frequency_hz));
    let step_s = 1.0 / first.sample_rate_hz;
    let pulse = index(case, first, 0.0)..index(case, first, case.contact_s());
    let (mut bent, mut velocity) = (0.0, 0.0);
    let bending = first.samples.iter().enumerate().map(|(i, force)| {
        let drive = if pulse.contains(&i) { f64::from(*force) } else { 0.0 };
        velocity += synth::bending_m_s2(&mode, drive, bent, velocity) * step_s;
        bent += velocity * step_s;
        bent
    });
    let bending: Vec<f64> = bending.collect();
    let most = bending.iter().fold(f64::MIN_POSITIVE, |most, x| most.max(x.abs()));
    let share = case.chance.sign() * size / 100.0;
    let channel = pick(case, recording);
    let amplitude = share * peak(channel);
    channel.samples.iter_mut().zip(bending).for_each(|(x, bent)| *x += to_f32(amplitude * bent / most));
}

/// Adds the drift from heat in a channel from the peak of its first impact on, fading within 5 to 100 ms.
fn thermal(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    let (share, fades_s) = (case.chance.sign() * size / 100.0, case.chance.log_uniform([5e-3, 0.1]));
    let half_way_s = case.contact_to_strike_s() / 2.0;
    let which = case.chance.index(2);
    let channel = &mut recording.channels[which];
    let (from, to) = (index(case, channel, 0.0), index(case, channel, half_way_s));
    let struck = (from..to).max_by(|a, b| channel.samples[*a].abs().total_cmp(&channel.samples[*b].abs()));
    let (amplitude, fades) = (share * peak(channel), fades_s * channel.sample_rate_hz);
    for (i, sample) in channel.samples.iter_mut().skip(struck.unwrap_or(to)).enumerate() {
        *sample += to_f32(amplitude * (-as_f64(i) / fades).exp());
    }
}

/// Adds ringing of the structure between half and three times the sample rate after both impacts, without a
/// filter against it.
fn aliasing(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64) {
    /// Time in which ringing of a bolted structure at tens of kilohertz fades, s.
    const FADES_S: f64 = 3e-3;
    let way_s = case.contact_to_strike_s();
    let times_rate = case.chance.uniform(0.5, 3.0);
    for channel in &mut recording.channels {
        let amplitude = size / 100.0 * peak(channel);
        for struck_s in [0.0, way_s] {
            let phase = case.chance.uniform(0.0, TAU);
            for i in index(case, channel, struck_s)..channel.samples.len() {
                let since_s = time_s(case, channel, i) - struck_s;
                let fading = amplitude * (-since_s / FADES_S).exp();
                let swing = (TAU * times_rate * channel.sample_rate_hz * since_s + phase).sin();
                channel.samples[i] += to_f32(fading * swing);
            }
        }
    }
}

/// Writes samples in another unit than `unit`, which cask file and recording both state.
fn unit(case: &mut DrawnDrop, recording: &mut SyntheticRecording, size: f64, unit: Unit) {
    let (only, all) = (case.chance.index(2), size > 1.5);
    for (i, channel) in recording.channels.iter_mut().enumerate() {
        // The factor converts the samples to the unit that is not stated.
        let factor = unit_m_s2(&channel.unit) / if unit == Unit::G { 1.0 } else { STANDARD_GRAVITY_M_S2 };
        if all || i == only {
            channel.samples.iter_mut().for_each(|x| *x = to_f32(f64::from(*x) * factor));
            if unit == Unit::G { "g" } else { "m/s^2" }.clone_into(&mut channel.unit);
            case.stated.channels[i].unit = Some(unit);
        }
        case.stated.channels[i].full_scale = None;
    }
}
