//! Finds the common cause of the channels' drifts in the flight: an AC coupling that nobody stated, or a
//! target on which L rests.

use crate::data::{
    Axis, CaskFile, ChannelFinding, Coupling, Drop, DropFinding, Finding, FlightFit, Plateau, Signal,
};

/// Range of the time constants that are searched, s: shorter ones leave no step to measure, longer ones lose
/// less than 2 % of it in 50 ms and resemble 1/f noise.
const TIME_CONSTANTS_S: std::ops::RangeInclusive<f64> = 0.03..=2.5;
/// Smallest step whose droop is used, as a share of the largest.
const LEAST_STEP: f64 = 0.1;
/// A droop counts beyond this many of its standard uncertainties.
const LEAST_DROOP_U: f64 = 4.0;
/// Range of the reading of the channel nearest to L over g cos φ while the target carries L: it is less
/// farther from the corner, and while the cask turns.
const CARRIED_SHARES: std::ops::RangeInclusive<f64> = 0.5..=1.25;
/// Droops over steps agree within this share of their mean beside their uncertainties: that is residual
/// ringing of the fit.
const AGREEMENT: f64 = 0.2;

/// Compares the drifts of the channels stated as DC with the effect of one high-pass on their steps.
///
/// After a step s a first-order high-pass reads −s/T, where s is the remaining step: drift over step is −1/T
/// on every channel   (Q4). A zero shift of one channel is unrelated to the step of another, so that one
/// channel alone shows nothing.
pub fn judge_coupling(signals: &[Signal], flight: &FlightFit, cask_file: &CaskFile) -> Vec<Finding> {
    let stated = cask_file.channels.iter().filter(|c| c.coupling != Coupling::Dc);
    let declared_ac: Vec<&str> = stated.map(|c| c.name.as_str()).collect();
    if !flight.drift {
        return Vec::new();
    }
    let mut findings = judge_undeclared(signals, flight, &declared_ac);
    if declared_ac.is_empty() {
        findings.extend(judge_supported(signals, flight, &cask_file.drop));
    }
    findings
}

/// Reports a push that carries L's corner: it accelerates every transverse channel in proportion to its
/// velocity step (38), and a sensor at the corner reads g cos φ. The first end then rests on the target, or
/// bounces there.
fn judge_supported(signals: &[Signal], flight: &FlightFit, drop: &Drop) -> Option<Finding> {
    let transverse: Vec<&str> =
        signals.iter().filter(|s| s.axis == Axis::Transverse).map(|s| s.name.as_str()).collect();
    let plateaus = flight.plateaus.iter().filter(|p| transverse.contains(&p.channel.as_str()));
    let growths: Vec<Trend> = plateaus.map(|p| Trend::new(p, signals, 1.0)).collect();
    let rate_hz = common_rate(&growths)?;
    let most_m_s2 = growths.iter().map(|g| g.plateau.zero_shift_m_s2).fold(0.0, f64::max);
    if !CARRIED_SHARES.contains(&(most_m_s2 / (drop.gravity_m_s2 * drop.angle_rad.cos()))) {
        return None;
    }
    Some(Finding::from(DropFinding::Carried { rate_hz }).span(flight.from_s, flight.to_s))
}

fn judge_undeclared(signals: &[Signal], flight: &FlightFit, declared_ac: &[&str]) -> Vec<Finding> {
    let is_stated = |name: &str| declared_ac.contains(&name);
    let all: Vec<&Plateau> = flight.plateaus.iter().filter(|p| !is_stated(&p.channel)).collect();
    let largest_m_s = all.iter().map(|p| p.velocity_step_m_s.abs()).fold(0.0, f64::max);
    let droops: Vec<Trend> = all
        .into_iter()
        .filter(|p| signals.iter().any(|s| s.name == p.channel))
        .filter(|p| p.velocity_step_m_s.abs() > LEAST_STEP * largest_m_s)
        .map(|p| Trend::new(p, signals, -1.0))
        .collect();
    let Some(rate) = common_rate(&droops) else { return Vec::new() };
    let time_constant_s = 1.0 / rate;
    if !TIME_CONSTANTS_S.contains(&time_constant_s) {
        return Vec::new();
    }
    droops
        .iter()
        .map(|Trend { plateau, .. }| {
            let finding = ChannelFinding::AcUnstated {
                droop_m_s2: plateau.zero_shift_m_s2,
                step_m_s: plateau.velocity_step_m_s,
                time_constant_s,
            };
            finding.tag(&plateau.channel).span(flight.from_s, flight.to_s)
        })
        .collect()
}

/// Drift in the flight over the velocity step before it.
struct Trend<'a> {
    plateau: &'a Plateau,
    rate_hz: f64,
    u_hz: f64,
}

impl<'a> Trend<'a> {
    /// Computes a drift in the direction of the step (sign 1), or against it (−1).
    fn new(plateau: &'a Plateau, signals: &[Signal], sign: f64) -> Self {
        let step_m_s = plateau.velocity_step_m_s;
        let signal = signals.iter().find(|s| s.name == plateau.channel);
        let u_offset_m_s2 = signal.map_or(0.0, |s| s.u_offset_m_s2);
        Self {
            plateau,
            rate_hz: sign * plateau.zero_shift_m_s2 / step_m_s,
            u_hz: plateau.u_zero_shift_m_s2.hypot(u_offset_m_s2) / step_m_s.abs(),
        }
    }
}

/// Rate on which at least two trends agree, each clearly beyond its uncertainty, such as 3.2 Hz ± 0.1 Hz of
/// A1 and 3.3 Hz ± 0.1 Hz of A2; Hz.
fn common_rate(trends: &[Trend]) -> Option<f64> {
    let is_sure = trends.iter().all(|t| t.rate_hz > LEAST_DROOP_U * t.u_hz);
    if trends.len() < 2 || !is_sure {
        return None;
    }
    let weight = |t: &Trend| 1.0 / (t.u_hz * t.u_hz).max(f64::MIN_POSITIVE);
    let total: f64 = trends.iter().map(weight).sum();
    let mean = trends.iter().map(|t| t.rate_hz * weight(t)).sum::<f64>() / total;
    let agree = trends.iter().all(|t| (t.rate_hz - mean).abs() < AGREEMENT * mean + 2.0 * t.u_hz);
    (agree && mean > 0.0).then_some(mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{FindingKind, example};

    fn signal(name: &str) -> Signal {
        Signal { name: name.into(), free_fall_s: 0.25, ..example::signal(1e4, vec![]) }
    }

    /// A flight with these steps (m/s) and drifts (m/s²) of two channels, each drift known to 0.5 m/s².
    fn flight(first: (f64, f64), second: (f64, f64)) -> FlightFit {
        let plateau = |channel: &str, (velocity_step_m_s, zero_shift_m_s2): (f64, f64)| Plateau {
            u_m_s: 0.01,
            zero_shift_m_s2,
            u_zero_shift_m_s2: 0.5,
            ..example::plateau(channel, velocity_step_m_s)
        };
        FlightFit {
            drift: true,
            ..example::flight(0.0, 0.06, vec![plateau("A1", first), plateau("A2", second)])
        }
    }

    fn found(first: (f64, f64), second: (f64, f64), stated: &[&str]) -> Vec<FindingKind> {
        let findings = judge_undeclared(&[signal("A1"), signal("A2")], &flight(first, second), stated);
        findings.into_iter().map(|f| f.what).collect()
    }

    #[test]
    fn a_first_end_that_the_target_carries_is_told_from_a_zero_shift() {
        let drop = Drop { impact_velocity_m_s: 3.13, ..Drop::from_height(0.5, 0.1) };
        let is_carried = |first, second| {
            judge_supported(&[signal("A1"), signal("A2")], &flight(first, second), &drop).is_some()
        };
        // Near the corner 8.6 m/s² of g cos φ = 9.76, and −0.43 of that where the step is.
        assert!(is_carried((2.6, 8.6), (-1.12, -3.7)));
        // Both channels shifted in proportion, by more than a target can carry; one alone; out of proportion.
        assert!(!is_carried((2.6, 18.0), (-1.12, -7.7)));
        assert!(!is_carried((2.6, 8.6), (-1.12, 0.1)));
        assert!(!is_carried((2.6, 8.6), (-1.12, -9.0)));
    }

    #[test]
    fn droops_in_proportion_are_a_coupling() {
        // T = 0.3 s: 19/0.3 and −7/0.3, less the droop so far.
        let both = found((19.0, -61.0), (-7.0, 23.0), &[]);
        assert_eq!(both.len(), 2);
        let FindingKind::Channel(ChannelFinding::AcUnstated { time_constant_s, .. }) = both[0] else {
            panic!("{both:?}")
        };
        assert!((time_constant_s - 0.31).abs() < 5e-3, "{both:?}");
        assert!(found((19.0, -61.0), (-7.0, 23.0), &["A1", "A2"]).is_empty());
    }

    #[test]
    fn a_zero_shift_is_none() {
        // One channel alone; both with the same sign; both out of proportion; none.
        assert!(found((19.0, -61.0), (-7.0, 0.4), &[]).is_empty());
        assert!(found((19.0, -61.0), (-7.0, -23.0), &[]).is_empty());
        assert!(found((19.0, -61.0), (-7.0, 60.0), &[]).is_empty());
        assert!(found((19.0, -0.3), (-7.0, 0.2), &[]).is_empty());
        assert!(found((19.0, -61.0), (-0.5, 1.7), &[]).is_empty());
    }
}
