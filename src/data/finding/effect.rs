//! Effect of a finding on the result: the parts that it removes, and where it counts.

use serde::{Serialize, Serializer};

/// A part of the result that a finding may remove.
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
    /// All numbers of the motion.
    Motion,
}

/// Effect of a finding on the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// Removes nothing.
    Nothing,
    /// Removes nothing, and states what would explain the other findings.
    Hint,
    /// Removes nothing; entirely before or after the drop it is a note.
    Local,
    /// As `Local`, for missing samples.
    LostSamples,
    /// As `Local`, for samples that no cask can produce.
    Disturbance,
    /// Removes nothing; the cask file may state a position wrongly.
    DoubtfulPlace,
    /// Removes a channel's peak, or a channel that the others or the mass properties replace.
    Channel,
    /// Removes a channel's velocity step, and the motion unless the other channels determine that step.
    VelocityStep,
    /// Removes a channel that nothing replaces.
    ChannelAndMotion,
    /// Removes the second end's channel, and all quantities that it alone shows.
    SecondEnd,
    /// Removes all that follows the flight.
    SlapDown,
    /// Removes the second end's impact.
    SecondImpact,
    /// Removes the motion: it differs from the model, or the samples do not show it.
    Motion,
    /// Removes the motion, which contradicts the cask file.
    Contradiction,
    /// Removes both impacts, because there is none.
    Everything,
}

impl Effect {
    /// The parts that it removes.
    pub fn parts(self) -> &'static [ResultPart] {
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
        self.parts().serialize(to)
    }
}
