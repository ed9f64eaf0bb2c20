//! A whole channel to the stretch in which the first impact lies, in one pass.

use crate::data::{Axis, Channel, CoarseEvent, Drop, End, Recording};
use crate::numerics::robust;

/// Width over which a velocity change is looked for, s: longer than any first pulse (1–20 ms), shorter than a flight.
const WIDTH_S: f64 = 0.025;

/// Blocks a width, so that its place is known to a fortieth.
const BLOCKS: usize = 40;

/// The first impact is where L's velocity change over the width first reaches this share of its largest.
///
/// At the first impact L changes by (1 + k) v0 cos φ, later by less; spikes and the release change it by far less.
const SHARE: f64 = 0.4;

/// A change of this share of v0 cos φ is the first impact too, whatever comes later: L loses all of it.
const SHARE_OF_FALL: f64 = 0.5;

/// Finds the first impact on the transverse channel of the first end (or, without one, on any transverse channel).
///
/// `None` where no channel moves at all.
#[must_use]
pub fn locate(recording: &Recording, drop: &Drop) -> Option<CoarseEvent> {
    let transverse = || recording.channels.iter().filter(|c| c.axis == Axis::Transverse);
    let channel = transverse().find(|c| c.end == End::First).or_else(|| transverse().next())?;
    let (block_s, means) = block_means(channel)?;
    let offset = robust::median(&mut means.clone());
    let mut sum = 0.0;
    let mut changes = Vec::with_capacity(means.len());
    for (i, mean) in means.iter().enumerate() {
        sum += (mean - offset) * block_s;
        if i >= BLOCKS {
            sum -= (means[i - BLOCKS] - offset) * block_s;
        }
        changes.push(sum);
    }
    let largest = changes.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    let lost_m_s = SHARE_OF_FALL * drop.impact_velocity_m_s * drop.angle_rad.cos().max(0.1);
    let least_m_s = (SHARE * largest).min(lost_m_s);
    let crossing = changes.iter().position(|c| c.abs() >= least_m_s && largest > 0.0)?;
    #[allow(clippy::cast_precision_loss, reason = "block counts stay below 2^52")]
    let near_s = channel.start_s + (crossing as f64 + 1.0) * block_s - WIDTH_S;
    let end = (crossing + BLOCKS).min(changes.len());
    let step = changes[crossing..end].iter().fold(0.0_f64, |m, &c| if c.abs() > m.abs() { c } else { m });
    Some(CoarseEvent { near_s, spread_s: WIDTH_S, velocity_step_m_s: step })
}

/// Length of a block, s, and the mean force of each, m/s²; missing samples count as the block's others.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "sample counts stay below 2^52"
)]
fn block_means(channel: &Channel) -> Option<(f64, Vec<f64>)> {
    use crate::data::Samples;
    fn means<T: Copy + Into<f64>>(samples: &[T], size: usize, scale: f64) -> Vec<f64> {
        let mut last = 0.0;
        samples
            .chunks(size)
            .map(|chunk| {
                let (mut sum, mut count) = (0.0, 0.0);
                for &x in chunk {
                    let x: f64 = x.into();
                    if x.is_finite() {
                        sum += x;
                        count += 1.0;
                    }
                }
                if count > 0.0 {
                    last = scale * sum / count;
                }
                last
            })
            .collect()
    }
    let size = ((WIDTH_S * channel.sample_rate_hz / BLOCKS as f64).round() as usize).max(1);
    let blocks = match &channel.samples {
        Samples::F32(v) => means(v, size, channel.scale_m_s2),
        Samples::F64(v) => means(v, size, channel.scale_m_s2),
    };
    (!blocks.is_empty()).then_some((size as f64 / channel.sample_rate_hz, blocks))
}
