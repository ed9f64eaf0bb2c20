//! Mistakes in the cask file that would explain an analysis that contradicts itself.

use super::estimate::Estimate;
use serde::Serialize;
use std::borrow::Cow;

/// Difference in χ² of the consistency checks from which one explanation is worse than another: chance
/// exceeds three standard deviations once in 400.
pub const DECISIVE_CHI_SQUARE: f64 = 9.0;

/// A stated number and the value with which the motion would be consistent; in SI units, for a scale or clock
/// its factor.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenedInput {
    /// The key to correct, with its table unless it belongs to a channel.
    pub key: &'static str,
    /// The channel, where the key is one's.
    pub channel: Option<String>,
    /// Value that the cask file states.
    pub stated: f64,
    /// Value that would explain the contradiction.
    pub explains: f64,
    /// χ² of the consistency checks with that value.
    pub chi_square: f64,
}

/// Mistake in a key of the cask file: the file states x where `offset` + `factor` x is meant, or exchanges
/// the sources of two channels.
#[derive(Debug, Clone, PartialEq)]
pub struct Mistake {
    /// The key, with its table unless it belongs to a channel; `[cask]` for all lengths there.
    pub key: &'static str,
    /// The channels, where the key is theirs.
    pub names: Vec<String>,
    /// Correction, such as "in ft" or "0.15 in place of 0.65".
    pub correction: Cow<'static, str>,
    /// Offset, in the unit that the key's number has here.
    pub offset: f64,
    /// The factor.
    pub factor: f64,
}

/// Mistakes that make everything consistent when corrected together, and the result with these corrections.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedRemedy {
    /// One mistake, or two.
    pub mistakes: Vec<Mistake>,
    /// The causes, one per mistake.
    pub causes: Vec<StatedCause>,
}

/// Explanation of a contradiction; a row of `causes` in the result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StatedCause {
    /// The key of the cask file, with its table unless it belongs to a channel.
    pub key: &'static str,
    /// The channels, where the key is theirs.
    pub names: Vec<String>,
    /// The stated number, in the unit of the key; for a scale other than 1 and for a polarity its factor.
    pub stated: Option<f64>,
    /// The number with which everything is consistent.
    pub explains: Option<f64>,
    /// Slap-down speed with it, m/s.
    pub speed: Option<Estimate>,
    /// Effective coefficient of restitution with that number.
    pub k: Option<Estimate>,
}

impl StatedRemedy {
    /// Names the keys and their corrections, as "`position_m` of A1 0.15 in place of 0.65".
    pub(crate) fn keys(&self) -> String {
        let words = |Mistake { key, names, correction, .. }: &Mistake| match &names[..] {
            [] => format!("`{key}` {correction}"),
            names => {
                let between = if names.len() > 2 { ", " } else { " and " };
                format!("`{key}` of {} {correction}", names.join(between))
            }
        };
        self.mistakes.iter().map(words).collect::<Vec<_>>().join(" and ")
    }
}
