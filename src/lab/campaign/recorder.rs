//! Adds sensors and a recorder to a drop, sound and as drop tests use them, both true and as stated.

use crate::data::{Axis, End, STANDARD_GRAVITY_M_S2, Tolerances};
use crate::lab::chance::{Chance, round};
use crate::lab::damage::Wish;
use crate::lab::data::{Chain, SceneChannel};
use crate::lab::drawn::{DrawnDrop, spec, unit_m_s2};
use crate::lab::envelope::{AROUND_DEG, CLOCK_MS, RATES_HZ, SENSORS};
use crate::numerics::as_count;

/// Least samples in the first contact and in a period of the highest listed mode, or of an elastic body's
/// first: a filter removes the others.
const CONTACT_SAMPLES: f64 = 25.0;
const PERIOD_SAMPLES: f64 = 15.0;

/// Most samples of a channel, if a slower recorder would do.
const MOST_SAMPLES: f64 = 1.2e5;

/// A resonance is simulated up to this rate; faster recorders have sensors that resonate beyond their band.
const RESONANT_HZ: f64 = 50e3;

/// Puts sensors on the cask and a recorder behind them.
pub(super) fn equip(case: &mut DrawnDrop, wish: &Wish, exact: bool) {
    let rate_hz = set_duration(case, wish);
    let seats = seats(case, wish);
    let chain = chain(&mut case.chance, rate_hz);
    let unit = if case.chance.flip(0.8) { "g" } else { "m/s^2" };
    let late_s =
        if case.chance.flip(0.2) { 1e-3 * case.chance.uniform(CLOCK_MS[0], CLOCK_MS[1]) } else { 0.0 };
    for seat in seats {
        // The second end may have a separate recorder.
        let skew_s = if seat.end == End::Second && !exact { late_s } else { 0.0 };
        let chain = Chain { skew_s, ..chain.clone() };
        let seat = SceneChannel { unit: unit.into(), sample_rate_hz: rate_hz, chain, ..seat };
        case.stated.channels.push(spec(&seat));
        let channel = mount(case, seat, exact);
        case.scene.channels.push(channel);
    }
    converters(case);
}

/// Sets the duration of the record; returns the sample rate, Hz.
fn set_duration(case: &mut DrawnDrop, wish: &Wish) -> f64 {
    let truth = case.motion.truth;
    let chance = &mut case.chance;
    let fall_s = case.scene.fall_s();
    let rest = wish.rest.unwrap_or(chance.flip(0.2));
    let is_short = chance.flip(0.8);
    let drawn_s = if rest {
        fall_s + chance.uniform(0.1, 0.4)
    } else {
        chance.uniform(0.05, if is_short { 0.3_f64.min(0.95 * fall_s) } else { 0.95 * fall_s })
    };
    let end_s = truth.slap_t.unwrap_or(0.0) + case.scene.after_s;
    let bending_hz = case.scene.elastic.map(|body| body.first_bending_hz);
    let listed_hz = case.scene.modes.iter().map(|mode| mode.frequency_hz);
    let highest_hz = listed_hz.chain(bending_hz).fold(0.0, f64::max);
    let needed_hz = (CONTACT_SAMPLES / truth.contact_s.unwrap_or(1e-3)).max(PERIOD_SAMPLES * highest_hz);
    let fast: Vec<f64> = RATES_HZ.iter().copied().filter(|hz| *hz >= needed_hz).collect();
    let before_s = |hz: f64| if hz >= 1e5 && !rest { drawn_s.min(0.08) } else { drawn_s };
    // A damage does not need thousands of further samples.
    let most = if wish.kind.is_empty() { MOST_SAMPLES } else { MOST_SAMPLES / 3.0 };
    let affordable: Vec<f64> =
        fast.iter().copied().filter(|hz| hz * (before_s(*hz) + end_s) <= most).collect();
    let slowest_hz = fast.first().or(RATES_HZ.last()).copied().unwrap_or(needed_hz);
    let rate_hz = if affordable.is_empty() { slowest_hz } else { chance.choose(&affordable) };
    (case.scene.rest, case.scene.before_s) = (rest, before_s(rate_hz));
    rate_hz
}

/// Draws the stated positions of the sensors: a transverse one near each end, often more, sometimes an axial
/// one; all on one line of the skin, or each elsewhere.
fn seats(case: &mut DrawnDrop, wish: &Wish) -> Vec<SceneChannel> {
    let cask = &case.stated.cask;
    let chance = &mut case.chance;
    let common_deg = chance.choose(&AROUND_DEG);
    let is_mixed = chance.flip(0.3);
    let mut place = |name: &str, end, axis, (nearest_m, farthest_m): (f64, f64)| {
        let from_end_m = chance.uniform(nearest_m, farthest_m);
        let around_deg = if is_mixed { chance.choose(&AROUND_DEG) } else { common_deg };
        let position_m = if end == End::First { from_end_m } else { cask.length_m - from_end_m };
        let offset_m = round(-around_deg.to_radians().cos() * cask.height_m / 2.0, 3);
        SceneChannel { axis, offset_m, ..SceneChannel::perfect(name, end, round(position_m, 3)) }
    };
    let farthest_m = (0.1 * cask.length_m).min(0.4);
    let (near, inner) = ((farthest_m / 8.0, farthest_m), (farthest_m, 0.45 * cask.length_m));
    let mut seats = vec![
        place("A1", End::First, Axis::Transverse, near),
        place("A2", End::Second, Axis::Transverse, near),
    ];
    let more = [End::First, End::Second].into_iter().cycle().zip(3..).take(10);
    let more: Vec<_> = more.map(|(end, i)| place(&format!("A{i}"), end, Axis::Transverse, inner)).collect();
    let axial = place("X1", End::First, Axis::Axial, near);
    let count = if chance.flip(0.5) { 2 } else { as_count(chance.log_uniform(SENSORS).round()) };
    let least = if wish.third_channel { 3 } else { 2 };
    seats.extend(more.into_iter().take(count.max(least) - 2));
    seats.extend(wish.axial.unwrap_or(chance.flip(0.15)).then_some(axial));
    seats
}

/// Draws the properties that all channels share: filter, sensor type, level of the noise.
fn chain(chance: &mut Chance, rate_hz: f64) -> Chain {
    let noise_m_s2 = chance.log_uniform([0.02, 0.5]) * STANDARD_GRAVITY_M_S2;
    // Power of the 1/f part.
    let pink = chance.uniform(0.0, 0.1);
    let resonance_hz = rate_hz * chance.log_uniform([0.8, 2.0]);
    let damping = chance.log_uniform([0.02, 0.7]);
    Chain {
        resonance: (chance.flip(0.5) && rate_hz <= RESONANT_HZ).then_some((resonance_hz, damping)),
        anti_alias_hz: Some(rate_hz / chance.uniform(2.5, 4.0)),
        white_noise_m_s2: noise_m_s2 * (1.0 - pink).sqrt(),
        pink_noise_m_s2: noise_m_s2 * pink.sqrt(),
        ..Chain::perfect()
    }
}

/// Adds the errors of mounting, within the tolerances, to a stated channel.
fn mount(case: &mut DrawnDrop, seat: SceneChannel, exact: bool) -> SceneChannel {
    let Tolerances { calibration, cross_axis, position_m, .. } = case.stated.tolerances;
    let off = if exact { 0.0 } else { 1.0 };
    let chance = &mut case.chance;
    SceneChannel {
        position_m: (seat.position_m + off * chance.vary(position_m)).clamp(0.0, case.stated.cask.length_m),
        chain: Chain {
            scale: 1.0 + off * chance.vary(calibration),
            cross_axis: off * chance.vary(cross_axis),
            offset_m_s2: chance.uniform(-0.5, 0.5) * STANDARD_GRAVITY_M_S2,
            ..seat.chain
        },
        ..seat
    }
}

/// Gives every channel a converter, of which its peak fills a share; half of the cask files state the full
/// scale.
fn converters(case: &mut DrawnDrop) {
    /// A Butterworth of fourth order overshoots a step by 11 %; pulses of 25 samples by far less.
    const OVERSHOOT: f64 = 0.05;
    let bits = case.chance.choose(&[16_u8, 18, 20, 24]);
    let is_stated = case.chance.flip(0.5);
    for i in 0..case.scene.channels.len() {
        let room = case.chance.log_uniform([1.2, 10.0]);
        let peak_m_s2 = case.peak_m_s2(i);
        // A channel adds offset, noise, and the overshoot of its filters.
        let chain = &case.scene.channels[i].chain;
        let noise_m_s2 = 5.0 * (chain.white_noise_m_s2 + chain.pink_noise_m_s2);
        let beyond_m_s2 = OVERSHOOT * peak_m_s2 + chain.offset_m_s2.abs() + noise_m_s2;
        let limit_m_s2 = room * (peak_m_s2 + beyond_m_s2);
        case.scene.channels[i].chain.full_scale_m_s2 = Some(limit_m_s2);
        case.scene.channels[i].chain.bits = Some(bits);
        case.stated.channels[i].full_scale =
            is_stated.then(|| limit_m_s2 / unit_m_s2(&case.scene.channels[i].unit));
    }
}
