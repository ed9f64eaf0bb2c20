//! Turns channels as read into signals that can be integrated: offset, hum, gaps, clipping and noise of each.

mod clipping;
mod disturbed;
mod hum;
mod levels;
mod offset;
mod other;
mod runs;

pub use other::{measured_rotation, read_other};

use crate::data::{
    Cask, Channel, ChannelFinding, CoarseEvent, Corrections, Coupling, Drop, Finding, Recording, Signal,
};
use crate::numerics::robust;
use rayon::prelude::*;

/// Length of free fall that determines the offset, s: long compared with noise and hum, short compared with
/// any free fall from above 0.4 m.
const OFFSET_TIME_S: f64 = 0.25;

/// Longest reach of the signals after the coarse event, s: the longest flight to slap-down (steep drops) and
/// its pulse.
const LONGEST_AFTER_S: f64 = 1.6;

/// Shortest reach of the signals, s: the slap-down of a flat drop and its ringing.
const LEAST_AFTER_S: f64 = 0.15;

/// Least speed at which R descends, as a share of v0; its height is that of an angle 10° steeper.
const SLOWEST_DESCENT: f64 = 0.25;

/// Reach of the signals around the coarse event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Before it, s.
    pub before_s: f64,
    /// After it, s.
    pub after_s: f64,
}

impl Reach {
    /// Computes the reach from the free fall before first contact and the latest slap-down after it.
    pub fn for_drop(cask: &Cask, drop: &Drop) -> Self {
        let steeper_rad = (drop.angle_rad + 10.0_f64.to_radians()).min(std::f64::consts::FRAC_PI_2);
        let descent_s = cask.length_m * steeper_rad.sin() / (SLOWEST_DESCENT * drop.impact_velocity_m_s);
        Self {
            before_s: OFFSET_TIME_S.min(0.8 * drop.impact_velocity_m_s / drop.gravity_m_s2),
            after_s: (descent_s + LEAST_AFTER_S / 2.0).clamp(LEAST_AFTER_S, LONGEST_AFTER_S),
        }
    }

    /// Extends the reach to the end of the longest flight to slap-down.
    pub fn with_longest_flight(self) -> Self {
        Self { after_s: LONGEST_AFTER_S, ..self }
    }

    /// Limits the reach to the ringing after the last change of velocity, s after the coarse event.
    pub fn cut_at(self, last_change_s: f64) -> Self {
        Self { after_s: self.after_s.min(last_change_s.max(0.0) + LEAST_AFTER_S), ..self }
    }
}

/// Cuts every channel to the window of the event, removes offset and hum as `corrections` allow, and marks
/// clipped and missing samples.
///
/// Returns the signals in the order of the channels and the findings on them.
pub fn condition(
    recording: &Recording,
    event: &CoarseEvent,
    reach: &Reach,
    corrections: Corrections,
) -> (Vec<Signal>, Vec<Finding>) {
    let treat = |channel| condition_channel(channel, event, reach, corrections);
    let (signals, mut findings): (Vec<_>, Vec<Vec<_>>) = recording.channels.par_iter().map(treat).unzip();
    findings.par_iter_mut().enumerate().for_each(|(index, findings)| {
        findings.extend(disturbed::find_spikes(&signals, index, event.velocity_step_m_s));
    });
    (signals, findings.into_iter().flatten().collect())
}

/// Treats one channel as [`condition`] does, without the checks that compare several.
pub fn condition_channel(
    channel: &Channel,
    event: &CoarseEvent,
    reach: &Reach,
    corrections: Corrections,
) -> (Signal, Vec<Finding>) {
    let from = channel.index_at(event.near_s - reach.before_s);
    let to = channel.index_at(event.near_s + event.spread_s + reach.after_s);
    let mut findings = Vec::new();
    let mut force = match channel.coupling {
        Coupling::Dc => channel.force_m_s2(from, to),
        Coupling::Ac { time_constant_s } => {
            findings.push(ChannelFinding::AcStated { time_constant_s }.tag(&channel.name));
            let mut whole = channel.force_m_s2(0, to);
            restore_low_frequencies(&mut whole, channel.sample_rate_hz, time_constant_s);
            whole.split_off(from.min(whole.len()))
        }
    };
    let before = channel.index_at(event.near_s).saturating_sub(from).min(force.len());
    let quiet: Vec<f64> = robust::thin(&force[..before]).filter(|f| f.is_finite()).collect();
    let noise_m_s2 = if quiet.is_empty() { 0.0 } else { robust::spread(&quiet) };
    let clipped = clipping::find_clipped(channel, &force, 0.0, noise_m_s2, before);
    findings.extend(clipping::judge_full_scale(channel, &force, noise_m_s2));
    let gaps = runs::find_runs(&force, |f| !f.is_finite());
    for f in &mut force {
        if !f.is_finite() {
            *f = 0.0;
        }
    }
    let mut signal = Signal {
        name: channel.name.clone(),
        end: channel.end,
        axis: channel.axis,
        position_m: channel.position_m,
        offset_m: channel.offset_m,
        start_s: channel.time_s(from),
        sample_rate_hz: channel.sample_rate_hz,
        force_m_s2: force,
        clipped,
        gaps,
        ..Signal::default()
    };
    findings.extend(disturbed::mark_dropouts(&mut signal, noise_m_s2, event.near_s));
    findings.extend(hum::treat(&mut signal, event.near_s, corrections.hum));
    findings.extend(offset::treat(&mut signal, event.near_s, corrections.offset));
    (signal, findings)
}

/// Undoes a first-order high-pass: x = y + ∫ y dt / T   (19), from the channel's first sample on.
fn restore_low_frequencies(force: &mut [f64], sample_rate_hz: f64, time_constant_s: f64) {
    let mut integral = 0.0;
    let mut previous = 0.0;
    for f in force {
        let y = if f.is_finite() { *f } else { 0.0 };
        integral += f64::midpoint(previous, y) / sample_rate_hz;
        previous = y;
        *f += integral / time_constant_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Span, example};

    /// A transverse channel of the first end at 10 kHz.
    pub(super) fn signal(force_m_s2: Vec<f64>) -> Signal {
        Signal { noise_m_s2: 1.0, ..example::signal(1e4, force_m_s2) }
    }

    #[test]
    fn an_ac_coupled_step_is_put_back() {
        // A high-pass turns a step into y = e^(−t/T); the inverse restores 1 within the trapezoid's h²/12 T².
        let (rate, constant) = (10_000.0, 0.3);
        let mut y: Vec<f64> = (0..5000).map(|i| (-f64::from(i) / rate / constant).exp()).collect();
        y[0] = 1.0;
        restore_low_frequencies(&mut y, rate, constant);
        // The first half step is lost: h / 2T.
        assert!(y.iter().all(|v| (v - 1.0).abs() < 1e-4 / (2.0 * constant) + 1e-8));
    }

    #[test]
    fn missing_samples_are_spans() {
        let force = [0.0, f64::NAN, f64::NAN, 1.0, f64::NAN];
        assert_eq!(
            runs::find_runs(&force, |f| !f.is_finite()),
            [Span { from: 1, to: 3 }, Span { from: 4, to: 5 }]
        );
    }
}
