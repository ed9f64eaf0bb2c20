//! Findings on a set-up before the drop: code, severity and sentence of each.

use super::{Finding, FindingKind, IssueCode as Code, Severity};

/// An angular-rate sensor that has warmed up has a smaller error, °/s.
const LARGE_DEG_S: f64 = 5.0;

/// Likely reason why a channel at rest reads a wrong level.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the words say it; the number is a factor, the text a channel's name")]
pub enum RestCause {
    #[error("its sign is turned; turn `polarity` round, or the sensor")]
    Sign,
    #[error("{0} reads what this one should, and the reverse; exchange their `source`, or their cables")]
    Exchanged(String),
    #[error("that is the other axis of the cask; correct `axis`, or how the sensor sits")]
    Axis,
    #[error(
        "it feels no gravity: AC-coupled (state `coupling`, or switch it to DC), unplugged, or its scale far \
         too small"
    )]
    Nothing,
    #[error("{0:.4} times as much, the factor between two units; correct `unit` or `sensitivity`")]
    Unit(f64),
    #[error("{0:.3} times as much; correct `sensitivity`, the amplifier's gain, or `unit`")]
    Gain(f64),
    #[error("balance the amplifier; if it is, correct `sensitivity`, `axis` or `unit`")]
    Open,
}

findings! {
/// A finding on a recording at rest; if it concerns a channel, its words follow the channel's name.
pub enum RestFinding of Rest {
    /// The channel reads this level at rest, with this tolerance.
    Reads { reads_g: f64, expected_g: f64, most_g: f64, cause: RestCause } => (cause.code(), Error, Nothing),
        ("reads {reads_g:+.2} g at rest, where {expected_g:+.2} ± {most_g:.1} g is expected: {cause}");
    /// All samples are equal.
    OneValue => (Code::DeadChannel, Error, Nothing),
        ("holds one value, without any noise: unplugged, stuck, the wrong `source`, or steps of the \
         converter above the noise; check cable, amplifier and range");
    /// The level changes at rest.
    Unsteady => (Code::Offset, Warning, Nothing),
        ("does not rest: its level changes by more than 2 % of g; wait until cask and amplifier are steady");
    /// An angular-rate sensor reads this level.
    Rate { reads_deg_s: f64 }
        => (Code::Offset, if reads_deg_s.abs() > LARGE_DEG_S { Warning } else { Note }, Nothing),
        ("reads {reads_deg_s:+.2}°/s at rest, where 0 is expected{}",
         if reads_deg_s.abs() > LARGE_DEG_S { ": balance it, or correct its `unit`" }
         else { "; the rest before the release takes it off" });
    /// The level of an angular-rate sensor changes.
    Turning => (Code::Offset, Warning, Nothing),
        ("does not rest: its level changes by more than 1°/s; wait until the cask and the sensor are steady");
    /// Noise or the steps of the converter leave the offset undetermined.
    OpenOffset { u95_g: f64 } => (Code::Noise, Warning, Nothing),
        ("has an offset that is open by ± {u95_g:.2} g: slow noise, or coarse steps of the converter; choose \
         a smaller range or more bits, and check the cable");
    /// The range is below the peak expected of a first impact of this length; a note if the impact may be
    /// longer.
    Range { range_g: f64, peak_g: f64, pulse_s: f64, is_sure: bool }
        => (Code::Clipped, if *is_sure { Warning } else { Note }, Nothing),
        ("has a range of {range_g:.0} g; a first impact of {:.0} ms peaks at up to {peak_g:.0} g there, \
         ringing aside: choose a larger range, or state `duration_s` under `[contact]`", 1e3 * pulse_s);
    /// The time before the trigger is too short.
    ShortPretrigger { before_s: f64, least_s: f64 } => (Code::BeginsLate, Warning, Nothing),
        ("the times begin {:.0} ms before zero, their trigger: too little of the free fall before an impact; \
         set a pre-trigger of {least_s} s or more", 1e3 * before_s);
    /// The record after the trigger ends before the slap-down.
    ShortRecord { after_s: f64, needs_s: f64 } => (Code::EndsEarly, Warning, Nothing),
        ("the record ends {after_s:.2} s behind its trigger; the slap-down takes up to {needs_s:.2} s: \
         record longer");
    /// The finding concerns the file with the rest before a drop, which is separate from the recording of the
    /// drop.
    InRestFile { file: String, found: String, what: Code } => (*what, Note, Nothing),
        ("in the file of the rest, {file}: {found}");
    /// The recording holds a number of taps other than two.
    Blows { count: usize } => (Code::NoImpact, Warning, Nothing),
        ("{count} blows are seen where one on each end is expected: strike each end once, the first end \
         first, a second apart, so that every transverse channel answers");
    /// The channel responds first to the tap on the other end.
    OtherEnd { struck: &'static str } => (Code::EndsExchanged, Error, Nothing),
        ("answers the blow on the {struck} end before the channels of that end: the ends are exchanged; \
         correct `end` and `position_m`, or `source`, or exchange the cables");
    /// The first swing after a tap from below is negative.
    SwingsDown => (Code::Polarity, Error, Nothing),
        ("swings down under a blow from below on its own end, which reads positive: turn `polarity` round");
    /// The clocks of two channels differ, as both taps show.
    ClocksApart { behind_s: f64, other: String } => (Code::Skew, Warning, Nothing),
        ("is {:.1} ms behind {other} by both blows: their clocks are apart; use one trigger", 1e3 * behind_s);
}
}

impl RestCause {
    fn code(&self) -> Code {
        match self {
            Self::Sign => Code::Polarity,
            Self::Nothing => Code::AcCoupled,
            _ => Code::Scale,
        }
    }
}

impl RestFinding {
    /// Attributes the finding to the named channel.
    pub fn tag(self, channel: &str) -> Finding {
        let (row, message) = (self.row(), format!("{channel} {self}"));
        Finding::build(FindingKind::Rest(self), row, &message).tag(channel)
    }
}
