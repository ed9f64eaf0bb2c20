//! A campaign of random scenes with known truth: its request, and a row for each scene.

use crate::data::{Estimate, Method, Verdict, number_or_null};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::{BTreeMap, BTreeSet};

/// Number of a scene in a campaign: with the seed it names the same drop for ever.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SceneNumber {
    /// An undamaged scene: U0, U1 …
    Undamaged(u32),
    /// A scene with one damage, or of a sound kind: D0, D1 …
    Damaged(u32),
}

impl std::fmt::Display for SceneNumber {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Undamaged(number) => write!(f, "U{number}"),
            Self::Damaged(number) => write!(f, "D{number}"),
        }
    }
}

impl std::str::FromStr for SceneNumber {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let parsed =
            |digits: &str| digits.parse().map_err(|_| format!("no number behind its letter in {word:?}"));
        match word.split_at_checked(1) {
            Some(("U" | "u", digits)) => parsed(digits).map(Self::Undamaged),
            Some(("D" | "d", digits)) => parsed(digits).map(Self::Damaged),
            _ => Err("U and a number for an undamaged scene, D and a number for a damaged one".to_owned()),
        }
    }
}

impl Serialize for SceneNumber {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for SceneNumber {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

/// Request for a campaign.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CampaignRequest {
    /// Number of undamaged scenes, and of scenes with damage.
    pub scenes: u32,
    /// Seed of everything random.
    pub seed: u64,
    /// Kinds by name, or words for several: "all", "undamaged", "sound"; sorted and unique, so that shards of
    /// the same campaign agree.
    pub kinds: BTreeSet<String>,
    /// True if the cask file is exactly true.
    pub exact: bool,
}

/// Damage to a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Damage {
    /// The kind, by name.
    pub kind: String,
    /// Size, in `unit`.
    pub size: f64,
    /// Unit of the size; empty if a kind has only one size.
    pub unit: String,
}

/// A value with the half-width of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stated {
    /// The value; written as null if it is not a number.
    #[serde(deserialize_with = "number_or_null")]
    pub value: f64,
    /// The half-width.
    #[serde(deserialize_with = "number_or_null")]
    pub u95: f64,
}

impl From<Estimate> for Stated {
    fn from(Estimate { value, u95, .. }: Estimate) -> Self {
        Self { value, u95 }
    }
}

/// A measured quantity beside its truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scored {
    /// Result of the analysis.
    pub stated: Option<Stated>,
    /// True value, in the same unit.
    #[serde(rename = "true")]
    pub truth: Option<f64>,
}

/// Properties by which scenes are classed: the number of a scene reproduces everything else.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneFacts {
    /// The cask, by name.
    pub cask: String,
    /// True inclination at first contact, degrees.
    pub angle_deg: f64,
    /// Rate of the first channel, Hz.
    pub rate_hz: f64,
    /// True if the body is an elastic beam.
    pub elastic: bool,
}

/// One scene of a campaign: the content of a line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CampaignRow {
    /// Number of the scene.
    pub scene: SceneNumber,
    /// Damage to the scene.
    pub damage: Option<Damage>,
    /// Verdict of the analysis; `None` if the recording was refused.
    pub verdict: Option<Verdict>,
    /// Codes of the errors, each once.
    pub errors: Vec<String>,
    /// Codes of the warnings, each once.
    pub warnings: Vec<String>,
    /// The quantities, by name.
    pub quantities: BTreeMap<String, Scored>,
    /// The selected reconstruction method.
    pub rung: Option<Method>,
    /// Properties by which the scene is classed.
    pub facts: SceneFacts,
}

impl CampaignRow {
    /// Statement of a quantity, if there is one.
    pub fn find_stated(&self, quantity: &str) -> Option<Stated> {
        self.quantities.get(quantity)?.stated
    }

    /// True if the row states speed and k.
    pub fn has_numbers(&self) -> bool {
        ["speed", "k"].iter().all(|name| self.find_stated(name).is_some())
    }

    /// True value of a quantity.
    pub fn truth(&self, quantity: &str) -> Option<f64> {
        self.quantities.get(quantity)?.truth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_named_by_a_letter_and_a_number() {
        assert_eq!("U0".parse(), Ok(SceneNumber::Undamaged(0)));
        assert_eq!("d17".parse(), Ok(SceneNumber::Damaged(17)));
        for word in ["", "17", "Ux", "ü3", "D-1"] {
            assert!(word.parse::<SceneNumber>().is_err(), "{word}");
        }
    }

    #[test]
    fn kinds_are_said_in_one_order() {
        let kinds = ["skew", "hum", "skew"].map(str::to_owned).into();
        let text = serde_json::to_string(&CampaignRequest { scenes: 1, seed: 1, kinds, exact: false });
        assert!(text.expect("JSON").contains("[\"hum\",\"skew\"]"));
    }

    #[test]
    fn what_is_no_number_stays_none() {
        let said = Stated { value: f64::NAN, u95: 0.1 };
        let text = serde_json::to_string(&said).expect("JSON");
        assert!(serde_json::from_str::<Stated>(&text).expect("JSON").value.is_nan(), "{text}");
    }
}
