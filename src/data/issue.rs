//! What speaks against a recording or a result: a code, a severity and a sentence.

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

/// The name of a quality check, written in `snake_case` in the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum IssueCode {
    /// Samples stand at a limit of the measuring chain.
    Clipped,
    /// Samples are missing between two stretches of a channel.
    Gap,
    /// Blocks or rows came twice.
    DuplicateBlocks,
    /// Blocks or rows came out of order.
    DisorderedBlocks,
    /// The file ends in the middle of a record, or its writer never closed it.
    Truncated,
    /// A part of the file does not decode or fails its check sum.
    Damaged,
    /// More than a listing shows.
    Unlisted,
    /// NaN, infinite or empty samples.
    NonFinite,
    /// The channel's own times jitter and were put on a uniform base.
    TimeJitter,
    /// What tells the rate or the unit of the times is contradicted or leaves them in doubt.
    Clock,
    /// A message carried no stamp, and its log time was taken.
    LogTimeUsed,
    /// Single samples far off their neighbours.
    Spikes,
    /// Runs of equal samples entered by a jump.
    Dropout,
    /// A channel that does not move.
    DeadChannel,
    /// A constant offset before the impact.
    Offset,
    /// The offset changes at an impact.
    ZeroShift,
    /// Noise that limits the result.
    Noise,
    /// Mains hum, and taken off.
    Hum,
    /// Too few samples over the pulse.
    LowRate,
    /// Content up to half the sample rate: what lies above folds down.
    Aliasing,
    /// A channel coupled AC, and corrected for it.
    AcCoupled,
    /// A first end that reads as if mounted the other way round.
    Polarity,
    /// First and second end seem exchanged.
    EndsExchanged,
    /// Amplitudes that suggest another unit or scale.
    Scale,
    /// Channels that cannot belong to one rigid body.
    NotRigid,
    /// A sensor that the cask file puts where none can be.
    SensorPosition,
    /// Channels whose events lie apart in time.
    Skew,
    /// The recording begins too late for an offset or the first contact.
    BeginsLate,
    /// The recording ends before the slap-down.
    EndsEarly,
    /// No impact was found.
    NoImpact,
    /// Another drop in the same recording.
    SeveralDrops,
    /// No slap-down was found.
    NoSlapDown,
    /// L touches again before R strikes.
    SecondContact,
    /// Angle or height contradict the data.
    Geometry,
    /// The contact law contradicts the data.
    Friction,
    /// k lies outside 0 to 1.
    RestitutionRange,
    /// Measured and predicted lie apart beyond their intervals.
    Disagreement,
    /// The flight is too short or too disturbed for its fit.
    FlightFit,
    /// A channel needed for the quantity is not there.
    MissingChannel,
}

/// One finding about a recording or a result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Issue {
    /// Which check speaks.
    pub code: IssueCode,
    /// How much it weighs.
    pub severity: Severity,
    /// The channel's name in the cask file, where it concerns one.
    pub channel: Option<String>,
    /// One sentence: what was found, its size, and what to do.
    pub message: String,
    /// Start of the span it concerns, s from the recording's first sample.
    pub from_s: Option<f64>,
    /// End of that span, s from the recording's first sample.
    pub to_s: Option<f64>,
}

/// A message with its middle left out where it quotes more of a file than a person reads: 600 characters are eight lines.
#[must_use]
pub fn shortened(message: &str) -> std::borrow::Cow<'_, str> {
    const MOST_BYTES: usize = 600;
    if message.len() <= MOST_BYTES {
        return message.into();
    }
    let from = message.floor_char_boundary(MOST_BYTES / 2);
    let to = message.ceil_char_boundary(message.len() - MOST_BYTES / 2);
    format!("{} … {}", &message[..from], &message[to..]).into()
}

impl Issue {
    /// An issue of the whole recording.
    #[must_use]
    pub fn new(code: IssueCode, severity: Severity, message: impl Into<String>) -> Self {
        let message = message.into();
        let message = shortened(&message).into_owned();
        Self { code, severity, channel: None, message, from_s: None, to_s: None }
    }

    /// The same, about one channel.
    #[must_use]
    pub fn on(mut self, channel: &str) -> Self {
        self.channel = Some(channel.to_owned());
        self
    }

    /// The same, about a span of time, s from the recording's first sample.
    #[must_use]
    pub fn between(mut self, from_s: f64, to_s: f64) -> Self {
        self.from_s = Some(from_s);
        self.to_s = Some(to_s);
        self
    }
}
