//! The names of the checks with what they mean, and how much a finding weighs.

use serde::Serialize;

/// How much an issue weighs: a note informs, a warning asks for a person's look, an error takes a quantity away.
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

/// The name of a quality check, written in `snake_case` in the result; [`CODES`] says what each means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "CODES says what each means")]
pub enum IssueCode {
    // First of their severity: what mends goes before what follows from it.
    UsualSlip,
    MissingChannel,
    EndsExchanged,
    Polarity,
    SensorPosition,
    Clipped,
    Gap,
    DuplicateBlocks,
    DisorderedBlocks,
    Truncated,
    Damaged,
    Unlisted,
    NonFinite,
    TimeJitter,
    Clock,
    LogTimeUsed,
    Spikes,
    Dropout,
    DeadChannel,
    CopiedChannel,
    Offset,
    ZeroShift,
    Noise,
    Hum,
    LowRate,
    Aliasing,
    AcCoupled,
    Scale,
    NotRigid,
    Skew,
    BeginsLate,
    EndsEarly,
    NoImpact,
    SeveralDrops,
    NoSlapDown,
    SecondContact,
    SecondImpact,
    Geometry,
    Friction,
    RestitutionRange,
    Disagreement,
    Observed,
    FlightFit,
}

/// Every check with what a finding of it means, by what it speaks of: docs/quality.md is made of it.
pub const CODES: [(&str, &[(IssueCode, &str)]); 4] = [
    (
        "File",
        &[
            (
                IssueCode::Truncated,
                "the file ends within a record, was never closed, or holds fewer rows than it states",
            ),
            (IssueCode::Damaged, "a part of the file does not decode or fails its check sum"),
            (IssueCode::DuplicateBlocks, "blocks or rows came twice"),
            (IssueCode::DisorderedBlocks, "blocks or rows came out of order and were put right"),
            (IssueCode::Gap, "samples are missing between two stretches of a channel"),
            (IssueCode::Unlisted, "the recording holds more than `inspect` and `init` list"),
            (IssueCode::NonFinite, "empty, NaN or infinite samples, which count as missing"),
            (IssueCode::TimeJitter, "a channel's own times jitter and were put on an even base"),
            (
                IssueCode::Clock,
                "what tells the rate, or the unit of times, contradicts itself or does not tell it",
            ),
            (IssueCode::LogTimeUsed, "a message carried no stamp of its own, and its log time was taken"),
            (IssueCode::MissingChannel, "one end has no transverse channel"),
        ],
    ),
    (
        "Channel",
        &[
            (IssueCode::Clipped, "samples stand at a limit of the measuring chain"),
            (IssueCode::Spikes, "one to five samples far off their neighbours"),
            (IssueCode::Dropout, "runs of equal samples entered or left by a jump"),
            (IssueCode::DeadChannel, "a channel does not move while others do"),
            (IssueCode::CopiedChannel, "a channel holds the samples of another one"),
            (IssueCode::Offset, "an offset, or its drift, in the free fall"),
            (IssueCode::ZeroShift, "the offset changes at an impact"),
            (IssueCode::AcCoupled, "a channel coupled AC: stated and undone, or found by its droop"),
            (IssueCode::Noise, "noise that makes the velocity uncertain"),
            (IssueCode::Hum, "mains hum in the free fall"),
            (IssueCode::LowRate, "too few samples over the first pulse"),
            (IssueCode::Aliasing, "content up to half the sample rate: what lies above has folded down"),
            (IssueCode::BeginsLate, "too little free fall for an offset, or a start in the impact"),
        ],
    ),
    (
        "Channels together",
        &[
            (IssueCode::Polarity, "the first end's impact pulls towards the target"),
            (IssueCode::EndsExchanged, "the second end would rise"),
            (
                IssueCode::Scale,
                "units, sensitivities or rest levels that contradict each other, or that nothing tests",
            ),
            (
                IssueCode::NotRigid,
                "channels that cannot belong to one rigid body, or a rotation that the impact does not give",
            ),
            (IssueCode::SensorPosition, "a sensor placed off the cask, or nearer to the other end"),
            (IssueCode::Skew, "a channel whose answer to the first impact is apart in time"),
        ],
    ),
    (
        "Drop",
        &[
            (IssueCode::UsualSlip, "with one usual slip in the cask file put right everything closes"),
            (IssueCode::NoImpact, "no channel changes its velocity as an impact does"),
            (IssueCode::SeveralDrops, "another drop in the same recording, which was not analysed"),
            (IssueCode::NoSlapDown, "the second end shows no slap-down"),
            (IssueCode::EndsEarly, "the recording ends before the slap-down"),
            (
                IssueCode::SecondContact,
                "the first end touches again, or something strikes the cask in the flight",
            ),
            (
                IssueCode::SecondImpact,
                "what follows the slap-down does not tell what the second end's impact came to",
            ),
            (IssueCode::Geometry, "angle, height or the recorded fall contradict the motion"),
            (IssueCode::Friction, "how the first end slides contradicts the cask file, or nothing tells it"),
            (IssueCode::RestitutionRange, "k lies outside 0 to 1"),
            (IssueCode::FlightFit, "the flight is too short, or not explained by plateau and modes"),
            (IssueCode::Disagreement, "measured and predicted lie apart beyond their intervals"),
            (
                IssueCode::Observed,
                "the result and what was observed otherwise lie apart beyond their intervals",
            ),
        ],
    ),
];
