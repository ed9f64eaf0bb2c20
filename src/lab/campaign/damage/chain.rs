//! A damage of sensor, cable or recorder to the measuring chain that has it.

use super::super::Case;
use super::super::draw::{Flight, Wish};
use super::super::recorder::{self, STANDARD_GRAVITY_M_S2 as G_M_S2};
use super::{Kind, SOUND, rest};
use crate::data::End;
use crate::lab::data::Chain;

pub(super) const KINDS: &[Kind] = &[
    Kind {
        name: "clip_first",
        sizes: &[2.0, 10.0, 30.0, 60.0],
        unit: "% of the peak cut off",
        before: |case, size| clip(case, End::First, size),
        ..SOUND
    },
    Kind {
        name: "clip_second",
        sizes: &[2.0, 10.0, 30.0, 60.0],
        unit: "% of the peak cut off",
        before: |case, size| clip(case, End::Second, size),
        ..SOUND
    },
    Kind {
        name: "gap_impact",
        sizes: &[3.0, 10.0, 30.0, 100.0],
        unit: "% of the contact",
        before: gap_impact,
        ..SOUND
    },
    Kind {
        name: "gap_flight",
        sizes: &[3.0, 10.0, 30.0, 80.0],
        unit: "% of the flight",
        before: gap_flight,
        ..SOUND
    },
    Kind {
        name: "dropouts",
        sizes: &[3.0, 10.0, 30.0, 100.0],
        unit: "% of the contact each",
        before: dropouts,
        ..SOUND
    },
    Kind {
        name: "offset",
        sizes: &[1.0, 10.0, 100.0, 1000.0],
        unit: "g",
        before: |case, size| one(case, |chain, sign| chain.offset_m_s2 = sign * size * G_M_S2),
        ..SOUND
    },
    Kind {
        name: "zero_shift",
        sizes: &[0.3, 1.0, 3.0, 10.0, 30.0],
        unit: "g",
        before: |case, size| one(case, |chain, sign| chain.zero_shift_m_s2 = sign * size * G_M_S2),
        ..SOUND
    },
    Kind {
        name: "ac_undeclared",
        sizes: &[0.1, 0.3, 1.0, 3.0, 10.0],
        unit: "Hz",
        before: |case, size| {
            one(case, |chain, _| chain.ac_time_constant_s = Some(1.0 / (std::f64::consts::TAU * size)));
        },
        ..SOUND
    },
    Kind {
        name: "hum",
        sizes: &[0.3, 1.0, 3.0, 10.0, 30.0, 100.0],
        unit: "g",
        before: |case, size| each(case, |chain| chain.hum = Some((size * G_M_S2, 50.0))),
        ..SOUND
    },
    Kind {
        name: "white_noise",
        sizes: &[1.0, 3.0, 10.0, 30.0, 100.0],
        unit: "g",
        before: |case, size| each(case, |chain| chain.white_noise_m_s2 = size * G_M_S2),
        ..SOUND
    },
    Kind {
        name: "pink_noise",
        sizes: &[1.0, 3.0, 10.0, 30.0, 100.0],
        unit: "g",
        before: |case, size| each(case, |chain| chain.pink_noise_m_s2 = size * G_M_S2),
        ..SOUND
    },
    Kind {
        name: "cable_noise",
        sizes: &[10.0, 30.0, 100.0, 300.0, 1000.0],
        unit: "g",
        before: |case, size| one(case, |chain, _| chain.cable_noise_m_s2 = size * G_M_S2),
        ..SOUND
    },
    Kind {
        name: "skew",
        sizes: &[0.1, 0.5, 1.0, 3.0, 10.0, 20.0],
        unit: "ms",
        before: |case, size| one(case, |chain, sign| chain.skew_s = sign * size * 1e-3),
        ..SOUND
    },
    Kind {
        name: "clock_rate",
        sizes: &[0.1, 0.3, 1.0, 3.0, 10.0],
        unit: "%",
        wish: |_| rest(false),
        before: clock,
        ..SOUND
    },
    Kind {
        name: "clock_rate_rest",
        sizes: &[0.1, 0.3, 1.0, 3.0, 10.0],
        unit: "%",
        wish: |_| rest(true),
        before: clock,
        ..SOUND
    },
    Kind {
        name: "low_rate",
        sizes: &[2.0, 4.0, 6.0, 12.0, 25.0],
        unit: "samples in the contact",
        before: low_rate,
        ..SOUND
    },
    Kind {
        name: "polarity_first",
        before: |case, _| case.scene.channels[0].chain.swapped_polarity = true,
        ..SOUND
    },
    Kind {
        name: "polarity_second",
        before: |case, _| case.scene.channels[1].chain.swapped_polarity = true,
        ..SOUND
    },
    Kind {
        name: "polarity_all",
        before: |case, _| {
            case.scene.channels.iter_mut().for_each(|channel| channel.chain.swapped_polarity = true);
        },
        ..SOUND
    },
    Kind { name: "ends_exchanged", before: |case, _| case.scene.swapped_ends = true, ..SOUND },
    Kind {
        name: "scale_one",
        sizes: &[1.0, 3.0, 10.0, 30.0, 100.0],
        unit: "%",
        before: |case, size| scale(case, size, false),
        ..SOUND
    },
    Kind {
        name: "scale_all",
        sizes: &[1.0, 3.0, 10.0, 30.0, 100.0],
        unit: "%",
        wish: |_| rest(false),
        before: |case, size| scale(case, size, true),
        ..SOUND
    },
    Kind {
        name: "scale_all_rest",
        sizes: &[1.0, 3.0, 10.0, 30.0, 100.0],
        unit: "%",
        wish: |_| rest(true),
        before: |case, size| scale(case, size, true),
        ..SOUND
    },
    Kind {
        name: "not_rigid",
        sizes: &[3.0, 10.0, 30.0, 100.0],
        unit: "%",
        wish: |_| Wish { third_channel: true, slow_recorder: true, ..Wish::new() },
        before: not_rigid,
        ..SOUND
    },
    Kind {
        name: "begins_late",
        sizes: &[-30.0, -10.0, -3.0, 0.0, 3.0],
        unit: "ms after first contact",
        before: begins_late,
        ..SOUND
    },
    Kind {
        name: "ends_early",
        sizes: &[-80.0, -50.0, -10.0, -2.0, 2.0],
        unit: "% of the way past the slap-down",
        before: ends_early,
        ..SOUND
    },
    Kind { name: "no_impact", sizes: &[5.0, 50.0], unit: "ms short of it", before: no_impact, ..SOUND },
    Kind {
        name: "second_contact",
        wish: |_| Wish { flight: Flight::LandsAgain, slow_recorder: true, ..Wish::new() },
        ..SOUND
    },
    Kind {
        name: "short_flight",
        wish: |_| Wish { flight: Flight::Short, slow_recorder: true, ..Wish::new() },
        ..SOUND
    },
];

/// Changes the chain of A1 or A2, with a sign by chance.
///
/// The converter's range goes, so that the damage stands alone.
fn one(case: &mut Case, change: impl FnOnce(&mut Chain, f64)) {
    let (which, sign) = (case.chance.index(2), case.chance.sign());
    change(&mut case.scene.channels[which].chain, sign);
    unlimited(case);
}

/// Changes the chain of every channel.
fn each(case: &mut Case, change: impl Fn(&mut Chain)) {
    case.scene.channels.iter_mut().for_each(|channel| change(&mut channel.chain));
    unlimited(case);
}

/// A converter that never clips.
fn unlimited(case: &mut Case) {
    for (channel, spec) in case.scene.channels.iter_mut().zip(&mut case.stated.channels) {
        (channel.chain.full_scale_m_s2, channel.chain.bits, spec.full_scale) = (None, None, None);
    }
}

/// Cuts `size` percent off the largest that a transverse channel of `end` reads; half of the cask files state the limit.
fn clip(case: &mut Case, end: End, size: f64) {
    let which = usize::from(end == End::Second);
    let limit_m_s2 = (1.0 - size / 100.0) * recorder::peak_m_s2(case, which);
    let is_stated = case.chance.is(0.5);
    let channel = &mut case.scene.channels[which];
    channel.chain.full_scale_m_s2 = Some(limit_m_s2);
    case.stated.channels[which].full_scale = is_stated.then(|| limit_m_s2 / recorder::unit_m_s2(channel));
}

/// A recorder that runs fast or slow.
fn clock(case: &mut Case, size: f64) {
    case.scene.clock_error = case.chance.sign() * size / 100.0;
}

/// First contact by the recorder's clock, its length and the way from there to the slap-down, s.
fn times_s(case: &Case) -> (f64, f64, f64) {
    let truth = &case.motion.truth;
    (case.scene.before_s, truth.contact_s.unwrap_or(0.0), truth.slap_t.unwrap_or(0.0))
}

/// Some of the channels: one or all.
fn some(case: &mut Case) -> Vec<usize> {
    let (all, which) = (case.chance.is(0.4), case.chance.index(2));
    if all { (0..case.scene.channels.len()).collect() } else { vec![which] }
}

fn gap_impact(case: &mut Case, size: f64) {
    let (first_s, contact_s, _) = times_s(case);
    let from_s = first_s + case.chance.even(-0.2, 0.8) * contact_s;
    for i in some(case) {
        case.scene.channels[i].chain.gaps_s.push((from_s, from_s + size / 100.0 * contact_s));
    }
}

fn gap_flight(case: &mut Case, size: f64) {
    let (first_s, contact_s, way_s) = times_s(case);
    let flight_s = way_s - contact_s;
    let from_s = first_s + contact_s + case.chance.even(0.05, 0.97 - size / 100.0 * 0.9) * flight_s;
    for i in some(case) {
        case.scene.channels[i].chain.gaps_s.push((from_s, from_s + size / 100.0 * 0.9 * flight_s));
    }
}

/// One in the contact, two in the flight.
fn dropouts(case: &mut Case, size: f64) {
    let (first_s, contact_s, way_s) = times_s(case);
    let which = case.chance.index(2);
    for (low_s, high_s) in [(0.0, contact_s), (contact_s, way_s), (contact_s, way_s)] {
        let from_s = first_s + case.chance.even(low_s, high_s);
        case.scene.channels[which].chain.dropouts_s.push((from_s, from_s + size / 100.0 * contact_s));
    }
}

/// So many samples in the contact, and no filter before the sampling.
fn low_rate(case: &mut Case, size: f64) {
    let (_, contact_s, _) = times_s(case);
    for channel in &mut case.scene.channels {
        // As a recorder is set: in whole hertz.
        channel.sample_rate_hz = (size / contact_s).round().max(100.0);
        channel.chain.anti_alias_hz = None;
    }
}

/// One or all channels too large or too small.
fn scale(case: &mut Case, size: f64, all: bool) {
    let (which, up) = (case.chance.index(2), case.chance.is(0.5));
    let factor = if up { 1.0 + size / 100.0 } else { 1.0 / (1.0 + size / 100.0) };
    for (i, channel) in case.scene.channels.iter_mut().enumerate() {
        if all || i == which {
            channel.chain.scale *= factor;
        }
    }
    unlimited(case);
}

/// The second sensor of the first end shows another step than its neighbour.
fn not_rigid(case: &mut Case, size: f64) {
    let up = case.chance.is(0.5);
    case.scene.channels[2].chain.scale *= if up { 1.0 + size / 100.0 } else { 1.0 / (1.0 + size / 100.0) };
    unlimited(case);
}

fn begins_late(case: &mut Case, size: f64) {
    case.scene.before_s = -size * 1e-3;
    case.scene.rest = false;
}

fn ends_early(case: &mut Case, size: f64) {
    let (_, contact_s, way_s) = times_s(case);
    case.scene.after_s = size / 100.0 * (way_s - contact_s);
}

fn no_impact(case: &mut Case, size: f64) {
    let (_, _, way_s) = times_s(case);
    case.scene.before_s = case.scene.before_s.max(0.1);
    case.scene.after_s = -way_s - size * 1e-3;
}
