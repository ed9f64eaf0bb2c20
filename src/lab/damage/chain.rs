//! Damages of sensor, cable or recorder that change the measuring chain.

use super::super::chance::round;
use super::super::data::Chain;
use super::super::drawn::{DrawnDrop, unit_m_s2};
use crate::data::STANDARD_GRAVITY_M_S2;
use std::f64::consts::TAU;

/// Damages the scene by `kind`; kinds that belong to another object have no effect.
pub(super) fn apply(kind: &str, case: &mut DrawnDrop, size: f64) {
    let size_m_s2 = size * STANDARD_GRAVITY_M_S2;
    match kind {
        "clip_first" => clip(case, 0, size),
        "clip_second" => clip(case, 1, size),
        "gap_impact" => {
            let from_s = case.scene.before_s + case.chance.uniform(-0.2, 0.8) * case.contact_s();
            lose_span(case, from_s, size / 100.0 * case.contact_s());
        }
        "gap_flight" => {
            let (contact_s, flight_s) = (case.contact_s(), case.contact_to_strike_s() - case.contact_s());
            let share = case.chance.uniform(0.05, 0.97 - size / 100.0 * 0.9);
            let from_s = case.scene.before_s + contact_s + share * flight_s;
            lose_span(case, from_s, size / 100.0 * 0.9 * flight_s);
        }
        "dropouts" => add_dropouts(case, size),
        "offset" => change_one(case, |chain, sign| chain.offset_m_s2 = sign * size_m_s2),
        "zero_shift" => change_one(case, |chain, sign| chain.zero_shift_m_s2 = sign * size_m_s2),
        "ac_undeclared" => change_one(case, |chain, _| chain.ac_time_constant_s = Some(1.0 / (TAU * size))),
        "hum" => change_each(case, |chain| chain.hum = Some((size_m_s2, 50.0))),
        "white_noise" => change_each(case, |chain| chain.white_noise_m_s2 = size_m_s2),
        "pink_noise" => change_each(case, |chain| chain.pink_noise_m_s2 = size_m_s2),
        "cable_noise" => change_one(case, |chain, _| chain.cable_noise_m_s2 = size_m_s2),
        "skew" => change_one(case, |chain, sign| chain.skew_s = sign * size * 1e-3),
        "clock_rate" | "clock_rate_rest" => case.scene.clock_error = case.chance.sign() * size / 100.0,
        "low_rate" => low_rate(case, size),
        "polarity_first" => case.scene.channels[0].chain.swapped_polarity = true,
        "polarity_second" => case.scene.channels[1].chain.swapped_polarity = true,
        "polarity_all" => chains(case).for_each(|chain| chain.swapped_polarity = true),
        "ends_exchanged" => case.scene.swapped_ends = true,
        "scale_one" => {
            let which = case.chance.index(2);
            scale(case, size, which..which + 1);
        }
        "scale_all" | "scale_all_rest" => {
            // A number is drawn as for one channel, so that both kinds continue with the same random numbers.
            case.chance.index(2);
            scale(case, size, 0..case.scene.channels.len());
        }
        // The second sensor of the first end shows another step than its neighbour.
        "not_rigid" => scale(case, size, 2..3),
        "begins_late" => {
            case.scene.before_s = -size * 1e-3;
            case.scene.rest = false;
        }
        "ends_early" => case.scene.after_s = size / 100.0 * (case.contact_to_strike_s() - case.contact_s()),
        "no_impact" => {
            case.scene.before_s = case.scene.before_s.max(0.1);
            case.scene.after_s = -case.contact_to_strike_s() - size * 1e-3;
        }
        "tilt" => case.scene.channels[0].chain.tilt_rad = size.to_radians(),
        "roll" | "roll_unstated" => roll(case, size, kind == "roll"),
        "whip" => add_whip(case, size),
        "coarse" | "coarser" => coarse(case, size),
        "filter_one" => change_one(case, |chain, _| {
            chain.anti_alias_hz = chain.anti_alias_hz.map(|cutoff_hz| cutoff_hz.min(size));
        }),
        "aliasing" => chains(case).for_each(|chain| chain.anti_alias_hz = None),
        _ => {}
    }
}

fn chains(case: &mut DrawnDrop) -> impl Iterator<Item = &mut Chain> {
    case.scene.channels.iter_mut().map(|channel| &mut channel.chain)
}

/// Changes the chain of A1 or A2, with a random sign.
///
/// The converter's range is removed, so that the damage acts alone.
fn change_one(case: &mut DrawnDrop, change: impl FnOnce(&mut Chain, f64)) {
    let (which, sign) = (case.chance.index(2), case.chance.sign());
    change(&mut case.scene.channels[which].chain, sign);
    remove_limits(case);
}

/// Changes the chain of every channel.
fn change_each(case: &mut DrawnDrop, change: impl FnMut(&mut Chain)) {
    chains(case).for_each(change);
    remove_limits(case);
}

/// A converter that never clips.
fn remove_limits(case: &mut DrawnDrop) {
    for (channel, spec) in case.scene.channels.iter_mut().zip(&mut case.stated.channels) {
        (channel.chain.full_scale_m_s2, channel.chain.bits, spec.full_scale) = (None, None, None);
    }
}

/// Clips `size` percent off the largest reading of channel `which`; half of the cask files state the limit.
fn clip(case: &mut DrawnDrop, which: usize, size: f64) {
    let limit_m_s2 = (1.0 - size / 100.0) * case.peak_m_s2(which);
    let is_stated = case.chance.flip(0.5);
    let channel = &mut case.scene.channels[which];
    channel.chain.full_scale_m_s2 = Some(limit_m_s2);
    case.stated.channels[which].full_scale = is_stated.then(|| limit_m_s2 / unit_m_s2(&channel.unit));
}

/// Removes a span of one channel or of all.
fn lose_span(case: &mut DrawnDrop, from_s: f64, long_s: f64) {
    let (all, which) = (case.chance.flip(0.4), case.chance.index(2));
    let lost = chains(case).enumerate().filter(|(i, _)| all || *i == which);
    lost.for_each(|(_, chain)| chain.gaps_s.push((from_s, from_s + long_s)));
}

/// Adds one dropout in the contact and two in the flight.
fn add_dropouts(case: &mut DrawnDrop, size: f64) {
    let (first_s, contact_s, way_s) = (case.scene.before_s, case.contact_s(), case.contact_to_strike_s());
    let which = case.chance.index(2);
    for (low_s, high_s) in [(0.0, contact_s), (contact_s, way_s), (contact_s, way_s)] {
        let from_s = first_s + case.chance.uniform(low_s, high_s);
        case.scene.channels[which].chain.dropouts_s.push((from_s, from_s + size / 100.0 * contact_s));
    }
}

/// Sets the rate that gives `size` samples in the contact, without a filter before the sampling.
fn low_rate(case: &mut DrawnDrop, size: f64) {
    let contact_s = case.contact_s();
    for channel in &mut case.scene.channels {
        // Recorders are set in whole hertz.
        channel.sample_rate_hz = (size / contact_s).round().max(100.0);
        channel.chain.anti_alias_hz = None;
    }
}

/// Some channels too large or too small.
fn scale(case: &mut DrawnDrop, size: f64, which: std::ops::Range<usize>) {
    let factor = case.chance.factor(size);
    case.scene.channels[which].iter_mut().for_each(|channel| channel.chain.scale *= factor);
    remove_limits(case);
}

/// Adds the roll from a tilted edge of the first end, with sensors up to half a section off the plane.
fn roll(case: &mut DrawnDrop, size: f64, is_stated: bool) {
    case.scene.extras.roll_rad_s = case.chance.sign() * size.to_radians();
    for (channel, spec) in case.scene.channels.iter_mut().zip(&mut case.stated.channels) {
        channel.lateral_m = round(case.chance.uniform(-0.5, 0.5) * case.scene.cask.height_m, 3);
        spec.lateral_m = if is_stated { channel.lateral_m } else { 0.0 };
    }
    remove_limits(case);
}

/// Adds a slow wave of `size` percent of the peak, on one channel.
fn add_whip(case: &mut DrawnDrop, size: f64) {
    let which = case.chance.index(2);
    let amplitude_m_s2 = case.chance.sign() * size / 100.0 * case.peak_m_s2(which);
    let wave = (amplitude_m_s2, case.chance.log_uniform([4.0, 60.0]));
    case.scene.channels[which].chain.whip = Some(wave);
    remove_limits(case);
}

/// Sets converters of 10 to 12 bits whose step is `size` percent of the peak, and which do not clip.
fn coarse(case: &mut DrawnDrop, size: f64) {
    let has_room = |bits: &u8| size / 100.0 * 2_f64.powi(i32::from(*bits) - 1) > 1.5;
    let bits: Vec<u8> = (10..=12).filter(has_room).collect();
    let bits = case.chance.choose(&bits);
    remove_limits(case);
    for i in 0..case.scene.channels.len() {
        let full_scale_m_s2 = size / 100.0 * case.peak_m_s2(i) * 2_f64.powi(i32::from(bits) - 1);
        let chain = &mut case.scene.channels[i].chain;
        (chain.full_scale_m_s2, chain.bits) = (Some(full_scale_m_s2), Some(bits));
    }
}
