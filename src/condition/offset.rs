//! The free fall before first contact to a channel's offset and noise.

use crate::data::{Issue, IssueCode, Severity, Signal};
use crate::numerics::{noise, robust};

/// Least free fall an offset is taken from, s: a period of 50 Hz hum is 20 ms, and half of it still bounds an offset.
const LEAST_S: f64 = 0.01;

/// Offsets above this are worth a warning, m/s²: 5 g is past what any accelerometer's data sheet allows as bias.
const LARGE_M_S2: f64 = 50.0;

/// Offsets above this are worth a note, m/s².
const NOTABLE_M_S2: f64 = 0.98;

/// Takes the mean before `before_s` off the signal and notes noise and uncertainty in it.
pub(super) fn remove(signal: &mut Signal, before_s: f64) -> Vec<Issue> {
    let mut issues = Vec::new();
    let end = signal.index_from(before_s);
    let length_s = before_s - signal.start_s;
    let quiet: Vec<f64> = (0..end)
        .filter(|i| !signal.gaps.iter().any(|g| g.from <= *i && *i < g.to))
        .map(|i| signal.force_m_s2[i])
        .collect();
    if length_s < LEAST_S || quiet.len() < 8 {
        issues.push(
            Issue::new(
                IssueCode::BeginsLate,
                Severity::Warning,
                format!(
                    "{} has {:.1} ms of free fall before the first impact: no offset could be taken from it. Record from before the release",
                    signal.name,
                    1e3 * length_s.max(0.0)
                ),
            )
            .on(&signal.name),
        );
        // Without free fall the offset may be as large as a usual one.
        signal.u_offset_m_s2 = NOTABLE_M_S2;
        return issues;
    }
    let (mean, rms) = robust::mean_and_rms(&quiet);
    let (first, second) = quiet.split_at(quiet.len() / 2);
    let wander = (robust::mean_and_rms(first).0 - robust::mean_and_rms(second).0).abs();
    signal.removed_offset_m_s2 = mean;
    signal.noise_m_s2 = robust::spread(&quiet).max(1e-3 * rms);
    signal.noise_spectrum = noise::spectrum(&quiet, signal.sample_rate_hz);
    signal.free_fall_s = length_s;
    #[allow(clippy::cast_precision_loss, reason = "sample counts stay below 2^52")]
    {
        // White noise averages out; what differs between the two halves does not.
        signal.u_offset_m_s2 = (rms / (quiet.len() as f64).sqrt()).max(wander / 2.0);
    }
    let gaps = signal.gaps.clone();
    for (i, f) in signal.force_m_s2.iter_mut().enumerate() {
        if !gaps.iter().any(|g| g.from <= i && i < g.to) {
            *f -= mean;
        }
    }
    if mean.abs() > NOTABLE_M_S2 {
        let severity = if mean.abs() > LARGE_M_S2 { Severity::Warning } else { Severity::Note };
        issues.push(
            Issue::new(
                IssueCode::Offset,
                severity,
                format!(
                    "{} reads {:+.2} g before the first impact, where free fall reads 0; that offset was taken off",
                    signal.name,
                    mean / 9.806_65
                ),
            )
            .on(&signal.name),
        );
    }
    issues
}
