//! Times of the events on conditioned channels: release, first contact, separation, slap-down.

mod answer;
mod locate;
mod onset;
mod release;
mod separation;
mod taps;

pub use answer::answers;
pub use locate::{Changes, HidingNoise};
pub use onset::{cut_short, departure, first_contact, slap_down};
pub use release::{FreeFall, at_rest, feels_gravity, free_fall, rest_level};
pub use separation::{first_separation, impulse_end, refine_end, seat_delay_s, separation};
pub use taps::tap_answers;

use crate::data::{Channel, End, Signal, of_either, transverse};
use crate::numerics::reduce;
use std::ops::Range;

/// Slope of the first bending mode of a free uniform beam at its end over its value there, times the length
/// (Blevins 1979).
const END_SLOPE: f64 = 4.65;
/// If the mode at a sensor is below this share of that at its end, the sensor is near a node and cannot
/// cancel the mode.
const LEAST_SHAPE: f64 = 0.2;

/// The transverse signal nearest to an end from a time on, without the first bending mode, which both ends of
/// a beam show alike: the other end's signal is subtracted in the ratio of the mode's shape at both. Impacts
/// remain, and those of the other end change their sign.
///
/// The signal is unchanged if the other end has none of the same times, or if either sensor is near a node.
/// Returned with its composition: signals by name, each with its weight.
pub fn without_first_mode(
    signals: &[Signal],
    end: End,
    from_s: f64,
    length_m: f64,
) -> Option<(Signal, Vec<(String, f64)>)> {
    let own = transverse(signals, end)?;
    let other = transverse(signals, if end == End::First { End::Second } else { End::First });
    let shape = |s: &Signal| 1.0 - END_SLOPE * s.position_m.min(length_m - s.position_m).max(0.0) / length_m;
    let from = own.index_from(from_s);
    let mut parts = vec![(own.name.clone(), 1.0)];
    let of_same_times = other.filter(|o| {
        (o.sample_rate_hz / own.sample_rate_hz - 1.0).abs() < 1e-9
            && (o.start_s - own.start_s).abs() * own.sample_rate_hz < 1.0
            && shape(o).min(shape(own)) > LEAST_SHAPE
    });
    // At the end of the other end's signal the mode would return as a jump.
    let mut free = own.cut(from, of_same_times.map_or(usize::MAX, |other| other.force_m_s2.len()));
    if let Some(other) = of_same_times {
        let ratio = shape(own) / shape(other);
        // f − Y(d)/Y(d′) f′, Y = 1 − 4.65 d/l   (37)
        for (force, other_m_s2) in free.force_m_s2.iter_mut().zip(other.force_m_s2.iter().skip(from)) {
            *force -= ratio * other_m_s2;
        }
        free.noise_m_s2 = own.noise_m_s2.hypot(ratio * other.noise_m_s2);
        parts.push((other.name.clone(), -ratio));
    }
    Some((free, parts))
}

/// Means of the finite samples of blocks of `size` over a range of a channel, m/s²; NaN for a block without
/// any.
fn block_means_m_s2(channel: &Channel, range: Range<usize>, size: usize) -> Vec<f64> {
    let mut means = of_either!(&channel.samples, v => reduce::finite_block_means(&v[range], size));
    for mean in &mut means {
        *mean *= channel.scale_m_s2;
    }
    means
}
