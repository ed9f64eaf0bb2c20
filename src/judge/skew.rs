//! The delays between the channels' answers to the first impact to what speaks against their clocks.

use crate::data::{BENDING_WAVE_M_S, Cask, Issue, IssueCode, Onset, Severity, Signal};

/// Delays within this many samples beside their uncertainty are none: first contact itself lies between two samples.
const SAMPLES: f64 = 1.5;
/// A late answer that a wave could explain is worth a note beyond this, s.
const NOTABLE_S: f64 = 3e-4;

/// Holds each delay against what a body can do: answer at once, or as late as a bending wave, never before it is struck.
#[must_use]
pub fn judge_skew(onsets: &[Onset], signals: &[Signal], cask: &Cask, shifted: bool) -> Vec<Issue> {
    let done = if shifted { "; it was shifted back by as much" } else { "" };
    let mut issues: Vec<Issue> = onsets.iter().filter_map(|onset| skew(onset, signals, cask)).collect();
    for issue in issues.iter_mut().filter(|i| i.severity == Severity::Warning) {
        issue.message.push_str(done);
    }
    issues
}

fn skew(onset: &Onset, signals: &[Signal], cask: &Cask) -> Option<Issue> {
    let rate_hz = signals.iter().map(|s| s.sample_rate_hz).fold(f64::INFINITY, f64::min);
    let slack_s = 2.0 * onset.u_s + SAMPLES / rate_hz;
    let wave_s = cask.length_m / BENDING_WAVE_M_S;
    let size = format!("{:.2} ± {:.2} ms", 1e3 * onset.delay_s.abs(), 2e3 * onset.u_s);
    let name = &onset.channel;
    let (severity, message) = if onset.delay_s < -slack_s {
        (
            Severity::Warning,
            format!(
                "{name} answers the first impact {size} before the first end is struck, which no body does: the channels' clocks are apart; record them with one trigger, or shift the channel"
            ),
        )
    } else if onset.delay_s > wave_s + slack_s {
        (
            Severity::Warning,
            format!(
                "{name} answers the first impact {size} after the first end is struck, and a bending wave needs {:.1} ms at most: the channels' clocks are apart; record them with one trigger, or shift the channel",
                1e3 * wave_s
            ),
        )
    } else if onset.delay_s > slack_s + NOTABLE_S {
        (
            Severity::Note,
            format!(
                "{name} answers the first impact {size} after the first end is struck: a bending wave may take as long, or the channels' clocks are apart; check that one trigger starts both"
            ),
        )
    } else {
        return None;
    };
    Some(Issue::new(IssueCode::Skew, severity, message).on(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn severity(delay_s: f64, u_s: f64) -> Option<Severity> {
        let cask = Cask {
            name: "A".into(),
            mass_kg: 1.0,
            length_m: 5.0,
            height_m: 0.0,
            width_m: None,
            cog_m: 2.5,
            inertia_kg_m2: 1.0,
            is_body: false,
        };
        let onset = Onset { channel: "A2".into(), delay_s, u_s };
        judge_skew(&[onset], &[], &cask, false).first().map(|i| i.severity)
    }

    #[test]
    fn only_what_no_body_does_is_a_warning() {
        assert_eq!(severity(0.0, 1e-5), None);
        assert_eq!(severity(-3e-4, 2e-4), None);
        assert_eq!(severity(-3e-4, 1e-5), Some(Severity::Warning));
        assert_eq!(severity(2e-4, 1e-5), None);
        assert_eq!(severity(2e-3, 1e-5), Some(Severity::Note));
        assert_eq!(severity(5.2e-3, 2e-4), Some(Severity::Note));
        assert_eq!(severity(5.5e-3, 1e-4), Some(Severity::Warning));
    }
}
