//! Samples to the spikes and dropouts of cables and connectors, which no pulse of a cask looks like.

use crate::data::{Issue, IssueCode, Severity, Signal};

/// A disturbance stands out of its neighbours by this share of the channel's peak …
const SHARE_OF_PEAK: f64 = 0.05;
/// … and by this many standard deviations of the noise.
const NOISE_FACTOR: f64 = 20.0;
/// The two neighbours on either side of a spike agree within this share of its height: those of a pulse's peak do not.
const AGREEMENT: f64 = 0.3;
/// Fewest equal samples in a row that are a dropout.
const LEAST_RUN: usize = 5;

/// Spikes of one sample and runs of equal samples entered by a jump, each kind as one issue; nothing is repaired.
pub(super) fn find(signal: &Signal) -> Vec<Issue> {
    let force = &signal.force_m_s2;
    let peak = force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    let height = (SHARE_OF_PEAK * peak).max(NOISE_FACTOR * signal.noise_m_s2);
    let is_lost = |i: usize| signal.gaps.iter().chain(&signal.clipped).any(|g| g.from <= i + 1 && i <= g.to);
    let spikes: Vec<usize> = (2..)
        .zip(force.windows(5))
        .filter(|(i, w)| {
            let (before, after) = (w[2] - w[1], w[2] - w[3]);
            let least = before.abs().min(after.abs());
            // Few samples stand out of both neighbours: what costs more is asked after that.
            least > height
                && before * after > 0.0
                && [w[1] - w[0], w[3] - w[1], w[4] - w[3]].iter().all(|d| d.abs() < AGREEMENT * least)
                && !is_lost(*i)
        })
        .map(|(i, _)| i)
        .collect();
    let mut issues = Vec::new();
    issues.extend(issue(signal, IssueCode::Spikes, &spikes, "spikes of one sample"));
    let dropouts: Vec<usize> = runs(force)
        .filter(|&(from, to)| {
            let jump =
                |a: usize, b: usize| force.get(a).zip(force.get(b)).map_or(0.0, |(x, y)| (x - y).abs());
            to - from >= LEAST_RUN
                && !is_lost(from)
                && (from.checked_sub(1).is_some_and(|i| jump(i, from) > height) || jump(to - 1, to) > height)
        })
        .map(|(from, _)| from)
        .collect();
    issues.extend(issue(
        signal,
        IssueCode::Dropout,
        &dropouts,
        "dropouts (equal samples in a row after a jump)",
    ));
    issues
}

/// Runs of equal samples, as `from..to`.
fn runs(force: &[f64]) -> impl Iterator<Item = (usize, usize)> + '_ {
    let mut from = 0;
    (1..=force.len()).filter_map(move |i| {
        #[allow(clippy::float_cmp, reason = "a dropout repeats a sample to the bit")]
        let ends = i == force.len() || force[i] != force[from];
        ends.then(|| (std::mem::replace(&mut from, i), i))
    })
}

fn issue(signal: &Signal, code: IssueCode, places: &[usize], what: &str) -> Option<Issue> {
    let (first, last) = (places.first()?, places.last()?);
    Some(
        Issue::new(
            code,
            Severity::Warning,
            format!(
                "{} has {} {what}: a cable or connector; what they add to or take from the velocity is in the result",
                signal.name,
                places.len()
            ),
        )
        .on(&signal.name)
        .between(signal.time_s(*first), signal.time_s(*last)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Axis, End};

    fn signal(force_m_s2: Vec<f64>) -> Signal {
        Signal {
            name: "A1".into(),
            end: End::First,
            axis: Axis::Transverse,
            position_m: 0.0,
            offset_m: 0.0,
            start_s: 0.0,
            sample_rate_hz: 1e4,
            force_m_s2,
            removed_offset_m_s2: 0.0,
            u_offset_m_s2: 0.0,
            noise_m_s2: 1.0,
            noise_spectrum: vec![],
            free_fall_s: 0.25,
            clipped: vec![],
            gaps: vec![],
        }
    }

    fn pulse() -> Vec<f64> {
        (0..400).map(|i| 4000.0 * (f64::from(i) / 400.0 * std::f64::consts::PI).sin()).collect()
    }

    #[test]
    fn a_pulse_has_neither() {
        assert!(find(&signal(pulse())).is_empty());
    }

    #[test]
    fn a_spike_and_a_dropout_are_named() {
        let mut force = pulse();
        force[100] += 900.0;
        force[200..220].fill(0.0);
        let codes: Vec<IssueCode> = find(&signal(force)).iter().map(|i| i.code).collect();
        assert_eq!(codes, [IssueCode::Spikes, IssueCode::Dropout]);
    }
}
