//! The measuring chain, element by element, from the specific force at each sensor to the samples of the
//! recorder.
//!
//! In order: tilt and cross axis, resonance, AC coupling, anti-alias filter, sampling by the recorder's
//! clock, offset, zero shift, noise, hum, cable, scale and polarity, converter, dropouts, gaps, stamps.

mod analog;
mod disturbance;

use crate::data::{Axis, End, STANDARD_GRAVITY_M_S2, rate_unit_rad_s};
use crate::lab::data::{
    Chain, MotionStep, RateSensor, Scene, SceneChannel, SimulatedMotion, SyntheticChannel, SyntheticRecording,
};
use crate::numerics::{as_count, to_f32};

/// Reading of a perfect sensor at a channel's place and axis at given times, m/s²; for an angular-rate
/// sensor, rad/s.
type Force<'a> = &'a dyn Fn(&SceneChannel, &[f64]) -> Vec<f64>;

/// The drop as the chain sees it.
struct SensedDrop<'a> {
    force_m_s2: Force<'a>,
    /// Intervals in which an end is on the target, s.
    contacts_s: Vec<(f64, f64)>,
    /// End of the record, s after first contact.
    end_s: f64,
}

/// Records `motion` with the recorder of `scene`. The same scene gives the same bits.
pub fn record(scene: &Scene, motion: &SimulatedMotion) -> SyntheticRecording {
    let force = |seat: &SceneChannel, times_s: &[f64]| match rate_unit_rad_s(&seat.unit) {
        Some(_) => super::rotation_rad_s(scene, motion, seat.position_m, times_s),
        None => super::specific_force_m_s2(scene, motion, seat, times_s),
    };
    let last_s = motion.steps.last().map_or(0.0, |step| step.time_s);
    let drive = SensedDrop {
        force_m_s2: &force,
        contacts_s: contacts_s(motion),
        end_s: motion.truth.slap_t.map_or(last_s, |slap_s| slap_s + scene.after_s),
    };
    let seats = true_seats(scene).into_iter().chain(scene.extras.rates.iter().map(rate_seat));
    let mut channels: Vec<SyntheticChannel> =
        seats.enumerate().map(|(i, seat)| channel(scene, &seat, i, &drive)).collect();
    let earliest_s = channels.iter().map(|c| c.start_s).reduce(f64::min).unwrap_or(0.0);
    for channel in &mut channels {
        channel.start_s -= earliest_s;
    }
    SyntheticRecording {
        channels,
        // The recorder counts samples and treats its stated rate as the true one.
        first_contact_s: scene.before_s * (1.0 + scene.clock_error) - earliest_s,
        truth: motion.truth,
        seed: scene.seed,
    }
}

/// Channels at their true places: if the ends are exchanged each is on the cable of its partner on the other
/// end.
fn true_seats(scene: &Scene) -> Vec<SceneChannel> {
    let mut seats = scene.channels.clone();
    if !scene.swapped_ends {
        return seats;
    }
    for axis in [Axis::Transverse, Axis::Axial] {
        let on_end = |end| {
            let all = scene.channels.iter().enumerate();
            all.filter(move |(_, c)| c.end == end && c.axis == axis).map(|(i, _)| i)
        };
        for (first, second) in on_end(End::First).zip(on_end(End::Second)) {
            for (to, from) in [(first, second), (second, first)] {
                let from = &scene.channels[from];
                (seats[to].position_m, seats[to].offset_m) = (from.position_m, from.offset_m);
            }
        }
    }
    seats
}

/// Spans in which either end is pressed against the target, s.
fn contacts_s(motion: &SimulatedMotion) -> Vec<(f64, f64)> {
    let is_pressed = |step: &MotionStep| step.loads_n.iter().any(|(_, normal_n)| *normal_n > 0.0);
    let runs = motion.steps.chunk_by(|before, after| is_pressed(before) == is_pressed(after));
    runs.filter(|run| is_pressed(&run[0])).map(|run| (run[0].time_s, run[run.len() - 1].time_s)).collect()
}

fn channel(scene: &Scene, seat: &SceneChannel, index: usize, drive: &SensedDrop) -> SyntheticChannel {
    let rate_hz = seat.sample_rate_hz * (1.0 + scene.clock_error);
    let count = count((scene.before_s + drive.end_s) * rate_hz);
    let mut samples_m_s2 = analog::sample_analog(scene, seat, drive, rate_hz, count);
    let times = disturbance::SampleTimes { from_s: -scene.before_s, rate_hz };
    disturbance::add(&mut samples_m_s2, (scene.seed, index), &seat.chain, &times, &drive.contacts_s);
    let sign = if seat.chain.swapped_polarity { -1.0 } else { 1.0 };
    for sample in &mut samples_m_s2 {
        *sample = convert(*sample * seat.chain.scale * sign, &seat.chain);
    }
    hold(&mut samples_m_s2, &seat.chain.dropouts_s, seat.sample_rate_hz, None);
    hold(&mut samples_m_s2, &seat.chain.gaps_s, seat.sample_rate_hz, Some(f64::NAN));
    let of_force = if seat.unit == "g" { STANDARD_GRAVITY_M_S2 } else { 1.0 };
    let unit = rate_unit_rad_s(&seat.unit).unwrap_or(of_force);
    let samples = samples_m_s2.iter().map(|x| to_f32(x / unit)).collect();
    SyntheticChannel {
        name: seat.name.clone(),
        unit: seat.unit.clone(),
        start_s: seat.chain.skew_s,
        sample_rate_hz: seat.sample_rate_hz,
        samples,
    }
}

/// Channel of an angular-rate sensor with its chain, in rad/s instead of m/s².
fn rate_seat(sensor: &RateSensor) -> SceneChannel {
    SceneChannel {
        name: sensor.name.clone(),
        position_m: sensor.position_m,
        unit: sensor.unit.clone(),
        sample_rate_hz: sensor.sample_rate_hz,
        chain: Chain {
            scale: sensor.scale,
            offset_m_s2: sensor.offset_rad_s,
            white_noise_m_s2: sensor.white_noise_rad_s,
            ..Chain::default()
        },
        ..SceneChannel::default()
    }
}

/// A count from a product of time and rate; at least 1.
fn count(number: f64) -> usize {
    as_count(number.round()).max(1)
}

/// The first index that is not before `number`.
fn ceiling(number: f64) -> usize {
    // A time intended to fall on a sample does so in spite of rounding.
    as_count((number - 1e-6).ceil())
}

/// Clips at ± full scale; with bits, rounds to steps of full scale over 2^(bits − 1), the uppermost code a
/// step below it.
fn convert(signal_m_s2: f64, chain: &Chain) -> f64 {
    let Some(full_scale_m_s2) = chain.full_scale_m_s2 else { return signal_m_s2 };
    let Some(bits) = chain.bits else { return signal_m_s2.clamp(-full_scale_m_s2, full_scale_m_s2) };
    let codes = 2_f64.powi(i32::from(bits) - 1);
    let step_m_s2 = full_scale_m_s2 / codes;
    (signal_m_s2 / step_m_s2).round().clamp(-codes, codes - 1.0) * step_m_s2
}

/// Repeats the last value within each span, s after the first sample, or replaces all by `lost`.
fn hold(samples: &mut [f64], spans_s: &[(f64, f64)], rate_hz: f64, lost: Option<f64>) {
    for &(from_s, to_s) in spans_s {
        let to = ceiling(to_s * rate_hz).min(samples.len());
        let from = ceiling(from_s * rate_hz).min(to);
        let held = from.checked_sub(1).map_or(0.0, |before| samples[before]);
        samples[from..to].fill(lost.unwrap_or(held));
    }
}

#[cfg(test)]
mod tests;
