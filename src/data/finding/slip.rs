//! What is usually confused in a cask file, to the words for what would be put right.

use super::drop::numbers;
use crate::data::Estimate;

/// What a key of the cask file says amiss: a number x where `from` + `by` x is meant, or the sources of two
/// channels.
#[derive(Debug, Clone, PartialEq)]
pub struct Slip {
    /// The key, with its table where that is no channel's; `[cask]` for all lengths there.
    pub key: &'static str,
    /// The channels, where the key is theirs.
    pub names: Vec<String>,
    /// What mends it, as "in ft".
    pub right: &'static str,
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
    /// Slap-down speed, m/s.
    pub speed: Option<Estimate>,
    /// Effective coefficient of restitution.
    pub k: Option<Estimate>,
}

impl Cure {
    /// What would be put right, where, and what that makes of the result.
    pub(super) fn words(&self) -> String {
        let words = |Slip { key, names, right, .. }: &Slip| match &names[..] {
            [] => format!("`{key}` {right}"),
            names => {
                format!("`{key}` of {} {right}", names.join(if names.len() > 2 { ", " } else { " and " }))
            }
        };
        let all = self.slips.iter().map(words).collect::<Vec<_>>().join(" and ");
        format!("with {all} everything is consistent, at {}", numbers(self.speed, self.k))
    }
}
