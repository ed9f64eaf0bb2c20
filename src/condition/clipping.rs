//! Samples to the runs that stand at a limit of the measuring chain.

use crate::data::{Channel, Span};

/// Fewest equal samples at an extreme that make a flat top.
const LEAST_RUN: usize = 3;

/// A run counts where the slope into it, times its length, exceeds this many smallest steps: a rounded peak read by a coarse
/// converter enters its flat top with a slope of about one step a sample.
const STEEPNESS: f64 = 8.0;

/// Runs of `force` (m/s², of `channel`) at the stated full scale or flat at an extreme, as indices into `force`.
pub(super) fn clipped(channel: &Channel, force: &[f64]) -> Vec<Span> {
    let mut spans = Vec::new();
    if let Some(limit) = channel.full_scale {
        let limit_m_s2 = (limit * channel.scale_m_s2).abs();
        spans.extend(runs(force, |f| f.abs() >= 0.999 * limit_m_s2));
    }
    let (low, high) = force
        .iter()
        .filter(|f| f.is_finite())
        .fold((0.0_f64, 0.0_f64), |(low, high), &f| (low.min(f), high.max(f)));
    for extreme in [low, high] {
        for span in runs(force, |f| (f - extreme).abs() <= 1e-9 * extreme.abs() && extreme.abs() > 0.0) {
            if span.to - span.from >= LEAST_RUN && is_flat_top(force, span) && !spans.contains(&span) {
                spans.push(span);
            }
        }
    }
    spans.sort_by_key(|s| s.from);
    spans
}

fn runs(force: &[f64], inside: impl Fn(f64) -> bool) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut from = None;
    for i in 0..=force.len() {
        let is_in = i < force.len() && inside(force[i]);
        match (is_in, from) {
            (true, None) => from = Some(i),
            (false, Some(start)) => {
                spans.push(Span { from: start, to: i });
                from = None;
            }
            _ => {}
        }
    }
    spans
}

/// Whether the signal runs into the flat steeply, as into a stop, and not as over a rounded top.
#[allow(clippy::cast_precision_loss, reason = "a run of samples")]
fn is_flat_top(force: &[f64], span: Span) -> bool {
    let level = force[span.from];
    let near = &force[span.from.saturating_sub(50)..(span.to + 50).min(force.len())];
    let smallest = near
        .windows(2)
        .map(|w| (w[1] - w[0]).abs())
        .filter(|d| *d > 1e-9 * level.abs())
        .fold(f64::INFINITY, f64::min);
    let into = span.from.checked_sub(1).map_or(0.0, |i| (level - force[i]).abs());
    let out = force.get(span.to).map_or(0.0, |f| (level - f).abs());
    let run = (span.to - span.from) as f64;
    into.max(out) * run > STEEPNESS * smallest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Axis, Coupling, End, Samples};

    fn channel(full_scale: Option<f64>) -> Channel {
        Channel {
            name: "A1".into(),
            end: End::First,
            axis: Axis::Transverse,
            source: "a".into(),
            position_m: 0.0,
            offset_m: 0.0,
            start_s: 0.0,
            sample_rate_hz: 1e4,
            samples: Samples::F64(vec![]),
            scale_m_s2: 9.806_65,
            unit: "g".into(),
            unit_origin: "cask file",
            full_scale,
            gaps: vec![],
            time_jitter_s: 0.0,
            coupling: Coupling::Dc,
        }
    }

    fn pulse(limit: f64) -> Vec<f64> {
        (0..200).map(|i| (4000.0 * (f64::from(i) / 200.0 * std::f64::consts::PI).sin()).min(limit)).collect()
    }

    #[test]
    fn a_flat_top_is_found() {
        let spans = clipped(&channel(None), &pulse(3000.0));
        assert_eq!(spans.len(), 1);
        assert!(spans[0].from > 40 && spans[0].to < 160);
    }

    #[test]
    fn a_rounded_top_of_a_coarse_converter_is_not() {
        let coarse: Vec<f64> = pulse(1e9).iter().map(|f| (f / 10.0).round() * 10.0).collect();
        assert!(clipped(&channel(None), &coarse).is_empty());
        assert!(clipped(&channel(None), &pulse(1e9)).is_empty());
    }

    #[test]
    fn the_stated_full_scale_counts() {
        // 300 g is 2942 m/s².
        assert_eq!(clipped(&channel(Some(300.0)), &pulse(1e9)).len(), 1);
        assert!(clipped(&channel(Some(500.0)), &pulse(1e9)).is_empty());
    }
}
