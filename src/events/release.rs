//! The record before first contact to the moment of release.

use crate::data::{Axis, Channel, Drop};
use crate::numerics::robust;

/// A step from rest to free fall counts where it is at least this share of g cos φ, and at most 1.5 of it.
const LEAST_STEP: f64 = 0.5;

/// Release, s from the recording's first sample, and the rest level before it (less the free-fall level), m/s².
///
/// Looked for as the step from +g cos φ to 0 on a transverse channel between 0.5 and 1.5 of the fall time √(2 h / g) before
/// `contact_s`; `None` where the record does not reach back that far or shows no such step.
#[must_use]
pub fn release(channel: &Channel, drop: &Drop, contact_s: f64) -> Option<(f64, f64)> {
    let lean = match channel.axis {
        Axis::Transverse => drop.angle_rad.cos(),
        Axis::Axial => drop.angle_rad.sin(),
    };
    let expected_m_s2 = drop.gravity_m_s2 * lean;
    let fall_s = drop.impact_velocity_m_s / drop.gravity_m_s2;
    let from = channel.index_at(contact_s - 1.5 * fall_s);
    let to = channel.index_at(contact_s - 0.5 * fall_s);
    let end = channel.index_at(contact_s - 0.02 * fall_s);
    // 5 ms a block: short against a fall, long against noise.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive sample count")]
    let size = ((0.005 * channel.sample_rate_hz) as usize).max(1);
    if to < from + 4 * size || end <= to {
        return None;
    }
    let blocks: Vec<f64> = channel
        .force_m_s2(from, end)
        .chunks(size)
        .map(|c| robust::median(&mut c.iter().copied().filter(|x| x.is_finite()).collect::<Vec<_>>()))
        .collect();
    let falling = robust::median(&mut blocks[(to - from) / size..].to_vec());
    let half_m_s2 = falling + 0.5 * expected_m_s2;
    // The last block above half of g cos φ is the end of the rest.
    let last = blocks[..(to - from) / size].iter().rposition(|b| *b > half_m_s2)?;
    let before = &blocks[last.saturating_sub(20)..=last.saturating_sub(1)];
    let rest = robust::median(&mut before.to_vec()) - falling;
    if !(LEAST_STEP * expected_m_s2..1.5 * expected_m_s2).contains(&rest) || expected_m_s2 <= 0.0 {
        return None;
    }
    let start = from + last.saturating_sub(1) * size;
    let force = channel.force_m_s2(start, start + 4 * size);
    let level = falling + rest / 2.0;
    // The last sample above half the step; noise about it is averaged by counting those above in the two blocks.
    let above = force.iter().filter(|f| **f > level).count();
    #[allow(clippy::cast_precision_loss, reason = "a few hundred samples")]
    Some((channel.time_s(start) + above as f64 / channel.sample_rate_hz, rest))
}
