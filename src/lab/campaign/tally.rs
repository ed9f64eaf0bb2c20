//! Rows, one after the other, to what the tables say of them.

use super::rungs::RungTally;
use super::statistics::{SceneGroup, SceneOutcome, outcome};
use crate::data::Verdict;
use crate::lab::data::{CampaignRequest, CampaignRow};
use crate::lab::drawn::BUILDS;
use std::collections::BTreeMap;

/// Scenes that passed and are wrong are listed up to this many.
const MOST_LISTED: usize = 1000;

/// Quantities that are counted of all groups; of [`GroupKey::Undamaged`] and [`GroupKey::Passed`] all ten
/// are.
const USUAL_QUANTITIES: usize = 5;

/// What a scene belongs to.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum GroupKey {
    /// Undamaged drops.
    Undamaged,
    /// Undamaged drops that passed.
    Passed,
    /// Drops with which nothing is wrong, those of a sound kind among them.
    Sound,
    /// Of them those of a kind; "undamaged" those of none.
    SoundKind(String),
    /// Of them those of a cask, stretched ones among them.
    Cask(&'static str),
    /// Of them those whose number of this name is small (0), middle (1) or large (2).
    Class(&'static str, usize),
    /// Drops with something wrong.
    Damaged,
    /// Of them those of a kind.
    DamagedKind(String),
}

/// A number of a scene.
type Number = fn(&CampaignRow) -> f64;

/// The truth of a quantity.
fn truth(row: &CampaignRow, name: &str) -> f64 {
    row.quantities.get(name).and_then(|scored| scored.truth).unwrap_or(f64::NAN)
}

/// What scenes are classed by, its unit, where the middle class begins and ends, and the number of a scene.
pub(super) const NUMBERS: [(&str, &str, [f64; 2], Number); 4] = [
    ("angle", "°", [5.0, 30.0], |row| row.facts.angle_deg),
    ("contact", " ms", [3.0, 10.0], |row| 1e3 * truth(row, "duration")),
    ("k", "", [0.1, 0.8], |row| truth(row, "k")),
    ("rate", " kHz", [10.0, 50.0], |row| row.facts.rate_hz / 1e3),
];

/// Whether nothing is wrong with the drop of this row.
fn is_sound_drop(row: &CampaignRow) -> bool {
    let is_sound = |name: &str| super::kinds().any(|kind| kind.name == name && kind.is_sound());
    row.damage.as_ref().is_none_or(|damage| is_sound(&damage.kind))
}

/// All groups of a scene.
fn groups(row: &CampaignRow) -> Vec<GroupKey> {
    let kind = row.damage.as_ref().map_or("undamaged", |damage| &damage.kind).to_owned();
    if !is_sound_drop(row) {
        return vec![GroupKey::Damaged, GroupKey::DamagedKind(kind)];
    }
    let classes = NUMBERS.iter().filter_map(|&(name, _, [low, high], number)| {
        let number = number(row);
        let class = if number < low { 0 } else { 1 + usize::from(number > high) };
        (!number.is_nan()).then_some(GroupKey::Class(name, class))
    });
    let mut groups: Vec<GroupKey> = classes.collect();
    groups.extend([GroupKey::Sound, GroupKey::SoundKind(kind)]);
    let cask = BUILDS.iter().map(|build| build.name).find(|name| row.facts.cask.starts_with(name));
    groups.extend(cask.map(GroupKey::Cask));
    if row.damage.is_none() {
        groups.push(GroupKey::Undamaged);
        groups.extend((row.verdict == Some(Verdict::Pass)).then_some(GroupKey::Passed));
    }
    groups
}

/// A campaign, counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    pub(super) request: CampaignRequest,
    groups: BTreeMap<GroupKey, SceneGroup>,
    pub(super) rungs: RungTally,
    /// The first of those that passed and are wrong.
    pub(super) missed: Vec<CampaignRow>,
    pub(super) missed_count: usize,
}

impl Tally {
    /// Of no scene yet.
    #[must_use]
    pub fn new(request: CampaignRequest) -> Self {
        Self {
            request,
            groups: BTreeMap::new(),
            rungs: RungTally::default(),
            missed: Vec::new(),
            missed_count: 0,
        }
    }

    /// Counts a scene.
    pub fn add(&mut self, row: &CampaignRow) {
        for key in groups(row) {
            let is_whole = matches!(key, GroupKey::Undamaged | GroupKey::Passed);
            let quantities = if is_whole { super::statistics::QUANTITIES.len() } else { USUAL_QUANTITIES };
            self.groups.entry(key).or_default().add(row, quantities);
        }
        self.rungs.add(row);
        if outcome(row) == SceneOutcome::Missed {
            self.missed_count += 1;
            if self.missed.len() < MOST_LISTED {
                self.missed.push(row.clone());
            }
        }
    }

    /// The scenes of a group; none: an empty one.
    pub(super) fn group(&self, key: &GroupKey) -> SceneGroup {
        self.groups.get(key).cloned().unwrap_or_default()
    }
}
