//! What a finding does to the result: the parts that it takes away, and where it weighs.

use serde::{Serialize, Serializer};

/// A part of the result that a finding may take away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ResultPart {
    /// The samples of a channel, or a velocity step in them.
    Channel,
    /// Time and numbers of the first impact, and k.
    FirstImpact,
    /// Time and numbers of the slap-down, and the comparison.
    SlapDown,
    /// The second end's impact, and the speed of its corner.
    SecondImpact,
    /// Every number of the motion.
    Motion,
}

/// What a finding does to the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// Takes nothing away.
    Nothing,
    /// Takes nothing, and says what would explain the other findings.
    Hint,
    /// Takes nothing; wholly before or after the drop it is a note.
    Local,
    /// As `Local`: samples are missing.
    LostSamples,
    /// As `Local`: samples that no cask makes.
    Disturbance,
    /// Takes nothing; the cask file may state a place wrongly.
    DoubtfulPlace,
    /// Takes a channel's peak, or a channel that the others or the mass properties replace.
    Channel,
    /// Takes a channel's velocity step, and the motion unless the other channels determine that step.
    VelocityStep,
    /// Takes a channel that nothing replaces.
    ChannelAndMotion,
    /// Takes the second end's channel, and with it what only that shows.
    SecondEnd,
    /// Takes all that follows the flight.
    SlapDown,
    /// Takes the second end's impact.
    SecondImpact,
    /// Takes the motion: it is another one, or the samples do not show it.
    Motion,
    /// Takes the motion, which contradicts what the cask file states.
    Contradiction,
    /// Takes both impacts: there is none.
    Everything,
}

impl Effect {
    /// The parts that it takes away.
    pub fn takes(self) -> &'static [ResultPart] {
        use ResultPart::{Channel, FirstImpact, Motion, SecondImpact, SlapDown};
        match self {
            Self::Channel => &[Channel],
            Self::VelocityStep | Self::ChannelAndMotion => &[Channel, Motion],
            Self::SecondEnd => &[Channel, SlapDown, SecondImpact],
            Self::SlapDown => &[SlapDown, SecondImpact],
            Self::SecondImpact => &[SecondImpact],
            Self::Motion | Self::Contradiction => &[Motion],
            Self::Everything => &[FirstImpact, SlapDown, SecondImpact, Motion],
            _ => &[],
        }
    }

    /// True if a finding away from the drop is a note.
    pub fn is_local(self) -> bool {
        matches!(self, Self::Local | Self::LostSamples | Self::Disturbance)
    }

    /// True if a mistake in the cask file may be the cause.
    pub fn doubts_cask_file(self) -> bool {
        matches!(self, Self::Contradiction | Self::DoubtfulPlace)
    }
}

impl Serialize for Effect {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.takes().serialize(to)
    }
}
