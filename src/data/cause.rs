//! What would explain an analysis that contradicts itself: keys of the cask file that say amiss.

use super::estimate::Estimate;
use serde::Serialize;
use std::borrow::Cow;

/// χ² of the closures by which one explanation must be worse than another: chance gives three standard
/// deviations to one in 400.
pub const CLEARLY: f64 = 9.0;

/// A stated number that, were it another one, would meet what the motion must meet; in SI units, of a scale
/// or clock its factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Opening {
    /// The key that would mend it, with its table where that is no channel's.
    pub key: &'static str,
    /// The channel, where the key is one's.
    pub channel: Option<String>,
    /// As it is stated.
    pub stated: f64,
    /// As it would have to be.
    pub explains: f64,
    /// χ² of what the motion must meet, so.
    pub chi_square: f64,
}

/// What a key of the cask file says amiss: a number x where `from` + `by` x is meant, or the sources of two
/// channels.
#[derive(Debug, Clone, PartialEq)]
pub struct Slip {
    /// The key, with its table where that is no channel's; `[cask]` for all lengths there.
    pub key: &'static str,
    /// The channels, where the key is theirs.
    pub names: Vec<String>,
    /// What mends it, as "in ft" or "0.15 in place of 0.65".
    pub right: Cow<'static, str>,
    /// In the unit that the key's number has here.
    pub from: f64,
    /// The factor.
    pub by: f64,
}

/// Slips with which, put right at once, everything is consistent, and what the result then is.
#[derive(Debug, Clone, PartialEq)]
pub struct Cure {
    /// One slip, or two.
    pub slips: Vec<Slip>,
    /// The causes, one a slip.
    pub causes: Vec<StatedCause>,
}

/// What explains a contradiction; a row of `causes` in the result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StatedCause {
    /// The key of the cask file, with its table where that is no channel's.
    pub key: &'static str,
    /// The channels, where the key is theirs.
    pub names: Vec<String>,
    /// The number stated, in the unit of the key; of a scale that is not 1, of a polarity its factor.
    pub stated: Option<f64>,
    /// The number with which everything is consistent.
    pub explains: Option<f64>,
    /// Slap-down speed with it, m/s.
    pub speed: Option<Estimate>,
    /// Effective coefficient of restitution with it.
    pub k: Option<Estimate>,
}

impl Cure {
    /// The keys and what mends them, as "`position_m` of A1 0.15 in place of 0.65".
    pub(crate) fn keys(&self) -> String {
        let words = |Slip { key, names, right, .. }: &Slip| match &names[..] {
            [] => format!("`{key}` {right}"),
            names => {
                format!("`{key}` of {} {right}", names.join(if names.len() > 2 { ", " } else { " and " }))
            }
        };
        self.slips.iter().map(words).collect::<Vec<_>>().join(" and ")
    }
}
