//! Judges a channel's clock from the delay of its answer to the first impact.

use crate::data::{ChannelFinding, Finding, Onset, Signal};

/// Delay in samples, beside its uncertainty, that counts as none: first contact itself lies between two
/// samples.
const SAMPLES: f64 = 1.5;
/// Delay explained by a wave from which it is a note, s.
const NOTABLE_S: f64 = 3e-4;

/// Compares a delay with what a body can do: it answers at once, or as late as a bending wave, which takes up
/// to `wave_s`, but never before it is struck; only the struck end's own sensor may be late by `lag_s`.
pub fn judge_skew(
    onset: &Onset,
    signals: &[Signal],
    [lag_s, wave_s]: [f64; 2],
    is_shifted: bool,
) -> Option<Finding> {
    let &Onset { delay_s, u_s, .. } = onset;
    let rate_hz = signals.iter().map(|s| s.sample_rate_hz).fold(f64::INFINITY, f64::min);
    let slack_s = 2.0 * u_s + SAMPLES / rate_hz;
    let finding = if delay_s < -slack_s - lag_s {
        ChannelFinding::AnswersEarly { delay_s, u_s, is_shifted }
    } else if delay_s > wave_s + slack_s {
        ChannelFinding::AnswersLate { delay_s, u_s, wave_s, is_shifted }
    } else if delay_s > slack_s + NOTABLE_S {
        ChannelFinding::AnswersAsAWave { delay_s, u_s }
    } else {
        return None;
    };
    Some(finding.tag(&onset.channel))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Severity;

    fn severity(delay_s: f64, u_s: f64) -> Option<Severity> {
        let onset = Onset { channel: "A2".into(), delay_s, u_s };
        judge_skew(&onset, &[], [0.0, 5e-3], false).map(|f| f.severity)
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
