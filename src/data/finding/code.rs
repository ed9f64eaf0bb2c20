//! The names of the checks with what they mean, and how much a finding weighs.

use serde::Serialize;

/// How much an issue weighs: a note informs, a warning asks for a person's look, an error takes a quantity
/// away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing; the result stands.
    Note,
    /// The result may be off; the verdict is at least "review".
    Warning,
    /// A quantity cannot be had; the verdict is "fail".
    Error,
}

/// The codes, each with what it speaks of and what a finding of it means.
macro_rules! issue_codes {
    ($($code:ident, $group:literal: $meaning:literal;)*) => {
        /// The name of a quality check, written in `snake_case` in the result.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
        #[serde(rename_all = "snake_case")]
        pub enum IssueCode {$(#[doc = $meaning] $code,)*}

        /// Every check with what a finding of it means, by what it speaks of: docs/quality.md is made of it.
        pub const CODES: &[(&str, (IssueCode, &str))] = &[$(($group, (IssueCode::$code, $meaning))),*];
    };
}

// First of their severity: what mends goes before what follows from it.
issue_codes! {
    UsualSlip, "Drop": "with one usual slip in the cask file put right everything closes";
    MissingChannel, "File": "one end has no transverse channel";
    EndsExchanged, "Channels together": "the second end would rise";
    Polarity, "Channels together": "the first end's impact pulls towards the target";
    SensorPosition, "Channels together": "a sensor placed off the cask, or nearer to the other end";
    Clipped, "Channel": "samples stand at a limit of the measuring chain";
    Gap, "File": "samples are missing between two stretches of a channel";
    DuplicateBlocks, "File": "blocks or rows came twice";
    DisorderedBlocks, "File": "blocks or rows came out of order and were put right";
    Truncated, "File": "the file ends within a record, was never closed, or holds fewer rows than it states";
    Damaged, "File": "a part of the file does not decode or fails its check sum";
    Unlisted, "File": "the recording holds more than `inspect` and `init` list";
    NonFinite, "File": "empty, NaN or infinite samples, which count as missing";
    TimeJitter, "File": "a channel's own times jitter and were put on an even base";
    Clock, "File": "what tells the rate, or the unit of times, contradicts itself or does not tell it";
    LogTimeUsed, "File": "a message carried no stamp of its own, and its log time was taken";
    Spikes, "Channel": "one to five samples far off their neighbours";
    Dropout, "Channel": "runs of equal samples entered or left by a jump";
    DeadChannel, "Channel": "a channel does not move while others do";
    CopiedChannel, "Channel": "a channel holds the samples of another one";
    Offset, "Channel": "an offset, or its drift, in the free fall";
    ZeroShift, "Channel": "the offset changes at an impact";
    Noise, "Channel": "noise that makes the velocity uncertain";
    Hum, "Channel": "mains hum in the free fall";
    LowRate, "Channel": "too few samples over the first pulse";
    Aliasing, "Channel": "content up to half the sample rate: what lies above has folded down";
    AcCoupled, "Channel": "a channel coupled AC: stated and undone, or found by its droop";
    Scale, "Channels together": "units, sensitivities or rest levels that contradict each other, or that nothing tests";
    NotRigid, "Channels together": "channels that cannot belong to one rigid body, or a rotation that the impact does not give";
    Skew, "Channels together": "a channel whose answer to the first impact is apart in time";
    BeginsLate, "Channel": "too little free fall for an offset, or a start in the impact";
    EndsEarly, "Drop": "the recording ends before the slap-down";
    NoImpact, "Drop": "no channel changes its velocity as an impact does";
    SeveralDrops, "Drop": "another drop in the same recording, which was not analysed";
    NoSlapDown, "Drop": "the second end shows no slap-down";
    SecondContact, "Drop": "the first end touches again, or something strikes the cask in the flight";
    SecondImpact, "Drop": "what follows the slap-down does not tell what the second end's impact came to";
    Geometry, "Drop": "angle, height or the recorded fall contradict the motion";
    Friction, "Drop": "how the first end slides contradicts the cask file, or nothing tells it";
    RestitutionRange, "Drop": "k lies outside 0 to 1";
    Disagreement, "Drop": "measured and predicted lie apart beyond their intervals";
    Observed, "Drop": "the result and what was observed otherwise lie apart beyond their intervals";
    FlightFit, "Drop": "the flight is too short, or not explained by plateau and modes";
}
