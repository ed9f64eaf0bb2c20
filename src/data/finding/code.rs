//! Names of the checks with their meaning, and the severity of a finding.

use serde::Serialize;

/// Severity of a finding: a note informs, a warning is to be read before the numbers are used, an error
/// removes a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing; the result stands.
    Note,
    /// The result may be off; the verdict is at least "review".
    Warning,
    /// A quantity is not determined; the verdict is "fail".
    Error,
}

/// Declares the codes, each with its subject and the meaning of its findings.
macro_rules! issue_codes {
    ($($code:ident, $group:literal: $meaning:literal;)*) => {
        /// The name of a quality check, written in `snake_case` in the result.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
        #[serde(rename_all = "snake_case")]
        pub enum IssueCode {$(#[doc = $meaning] $code,)*}

        /// All checks, with the meaning of their findings, by subject: the source of docs/quality.md.
        pub const CODES: &[(&str, (IssueCode, &str))] = &[$(($group, (IssueCode::$code, $meaning))),*];
    };
}

// Hints come first among findings of the same severity: the correction precedes its consequences.
issue_codes! {
    UsualSlip, "Drop": "if one usual slip in the cask file is corrected, everything agrees";
    MissingChannel, "File": "one end has no transverse channel";
    EndsExchanged, "Channels together": "after the first impact the second end would rise";
    Polarity, "Channels together": "the first end's impact seems to pull towards the target";
    SensorPosition, "Channels together": "a sensor is placed off the cask, or nearer to the other end";
    Clipped, "Channel": "samples stand at a limit of the measuring chain";
    Gap, "File": "samples are missing between two stretches of a channel";
    DuplicateBlocks, "File": "blocks or rows occur twice";
    DisorderedBlocks, "File": "blocks or rows are out of order and were sorted";
    Truncated, "File": "the file ends within a record, was never closed, or holds fewer rows than it states";
    Damaged, "File": "a part of the file cannot be decoded or fails its check sum";
    Unlisted, "File": "the recording holds more than `inspect` and `init` list";
    NonFinite, "File": "samples are empty, NaN or infinite and count as missing";
    TimeJitter, "File": "a channel's times jitter and were put on an even base";
    Clock, "File": "statements about the rate, or about the unit of times, are contradictory or not \
                    sufficient";
    LogTimeUsed, "File": "a message has no time stamp of its own, and its log time was used";
    Spikes, "Channel": "one to five samples are far off their neighbours";
    Dropout, "Channel": "runs of equal samples begin or end with a jump";
    Electrical, "Channel": "a channel jumps while no other does";
    DeadChannel, "Channel": "a channel shows only noise while others show the impacts";
    CopiedChannel, "Channel": "a channel has the samples of another one";
    Offset, "Channel": "a channel has an offset in the free fall, or the offset drifts";
    ZeroShift, "Channel": "the offset changes at an impact";
    Noise, "Channel": "noise makes the velocity uncertain";
    Hum, "Channel": "there is mains hum in the free fall";
    LowRate, "Channel": "the first pulse has too few samples";
    Aliasing, "Channel": "the signal has content up to half the sample rate, so higher frequencies are \
                          aliased";
    Filtered, "Channel": "the measuring chain low-passes a channel below the report's cut-off";
    AcCoupled, "Channel": "a channel is AC-coupled: stated and undone, or found by its droop";
    Scale, "Channels together": "units, sensitivities or rest levels contradict each other";
    NotRigid, "Channels together": "channels cannot belong to one rigid body, or the rotation does not \
                                    follow from the impact";
    NotPlanar, "Channels together": "the cask moves across the plane of the drop, or a sensor alone on the \
                                     skin cannot tell";
    Skew, "Channels together": "a channel responds to the first impact too early or too late";
    BeginsLate, "Channel": "the free fall is too short for an offset, or the recording begins in the impact";
    EndsEarly, "Drop": "the recording ends before the slap-down";
    NoImpact, "Drop": "the first end's velocity does not change as in an impact";
    SeveralDrops, "Drop": "the recording has another drop, which was not analysed";
    NoSlapDown, "Drop": "the second end shows no slap-down";
    SecondContact, "Drop": "the first end touches again or still, or something strikes the cask in the \
                            flight";
    Swings, "Drop": "the cask swings as a whole, on its contents or mounts";
    SecondImpact, "Drop": "the recording after the slap-down does not determine the second end's impact";
    Geometry, "Drop": "angle, height or the recorded fall contradict the motion";
    Friction, "Drop": "the sliding of the first end contradicts the cask file, or nothing shows it";
    RestitutionRange, "Drop": "k is outside 0 to 1";
    Disagreement, "Drop": "measured and predicted differ by more than their intervals";
    Observed, "Drop": "the result and another observation differ by more than their intervals";
    Simulation, "Drop": "a calculated curve cannot be rated, or reading it found something";
    FlightFit, "Drop": "the flight is too short, or not explained by plateau and modes";
}
