//! Rows, one after the other, to the counts that stand in the tables: of the scenes of each class, and of
//! what every rung of the reconstruction says.

use super::DamageKind;
use super::statistics::{QUANTITIES, SceneGroup, SceneOutcome, Spread, outcome};
use crate::data::{ReconstructionRung, Verdict};
use crate::lab::data::{CampaignRequest, CampaignRow, Stated};
use crate::lab::drawn::{BUILDS, DRAWN};
use std::collections::BTreeMap;

/// Scenes that passed and are wrong are listed up to this many.
const MOST_LISTED: usize = 1000;

/// Quantities that are counted of all classes; of undamaged drops all ten are.
const USUAL_QUANTITIES: usize = 5;

/// A table that has a row for each of several classes of scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ClassTable {
    /// Undamaged drops: those that passed, then all.
    Undamaged,
    /// Drops with which nothing is wrong, by kind, then all.
    SoundKinds,
    /// The same by cask, and by whether a number of theirs is small, middle or large.
    SoundClasses,
    /// Drops with something wrong, by kind, then all.
    DamagedKinds,
    /// Undamaged drops that have a motion, by what asks for a higher rung of the reconstruction, then all.
    Rungs,
}

/// Scenes that are counted together: a row of a table.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct SceneClass {
    table: ClassTable,
    /// Which row of it.
    place: usize,
    words: String,
}

impl SceneClass {
    fn new(table: ClassTable, place: usize, words: &str) -> Self {
        Self { table, place, words: words.to_owned() }
    }
}

/// The place of all scenes of a table.
const LAST: usize = usize::MAX;

/// The classes that a scene belongs to.
fn classes(row: &CampaignRow) -> Vec<SceneClass> {
    let is_own = |kind: &DamageKind| row.damage.as_ref().is_some_and(|damage| damage.kind == kind.name);
    let kind = super::kinds().enumerate().find(|(_, kind)| is_own(kind));
    let is_sound = kind.map_or(row.damage.is_none(), |(_, kind)| kind.is_sound());
    // Undamaged drops stand before the kinds.
    let (place, name) = kind.map_or((0, "undamaged"), |(i, kind)| (i + 1, kind.name));
    let table = if is_sound { ClassTable::SoundKinds } else { ClassTable::DamagedKinds };
    let mut classes = vec![SceneClass::new(table, place, name), SceneClass::new(table, LAST, "all")];
    if is_sound {
        classes.extend(sound_classes(row));
    }
    if row.damage.is_none() {
        classes.push(SceneClass::new(ClassTable::Undamaged, LAST, "all"));
        let passed = SceneClass::new(ClassTable::Undamaged, 0, "passed");
        classes.extend((row.verdict == Some(Verdict::Pass)).then_some(passed));
        classes.extend(row.rung.iter().flat_map(|_| rung_classes(row)));
    }
    classes
}

/// The two kinds of bodies, as classes and limits name them.
pub(in crate::lab) const BODIES: [&str; 2] = ["rigid bodies with modes", "elastic bodies"];

/// Body, cask, and small, middle or large numbers.
fn sound_classes(row: &CampaignRow) -> Vec<SceneClass> {
    let class = |place, words: &str| SceneClass::new(ClassTable::SoundClasses, place, words);
    let body = usize::from(row.facts.elastic);
    let casks = BUILDS.map(|build| build.name).into_iter().chain([DRAWN]);
    let cask = casks.zip(2..).find(|(name, _)| row.facts.cask.starts_with(name));
    let mut classes = vec![class(body, BODIES[body])];
    classes.extend(cask.map(|(name, i)| class(i, name)));
    // Where the middle class begins and ends.
    for (i, (name, unit, [low, high], number)) in (2 + BUILDS.len()..).zip([
        ("angle", "°", [5.0, 30.0], Some(row.facts.angle_deg)),
        ("contact", " ms", [3.0, 10.0], row.truth("duration").map(|contact_s| 1e3 * contact_s)),
        ("k", "", [0.1, 0.8], row.truth("k")),
        ("rate", " kHz", [10.0, 50.0], Some(row.facts.rate_hz / 1e3)),
    ]) {
        let (size, between) = match number {
            None => continue,
            Some(small) if small < low => (0, format!("below {low}")),
            Some(large) if large > high => (2, format!("above {high}")),
            Some(_) => (1, format!("{low} to {high}")),
        };
        classes.push(class(3 * i + size, &format!("{name} {between}{unit}")));
    }
    classes
}

/// What in a scene asks for a higher rung, or is none of the rungs' business.
fn rung_classes(row: &CampaignRow) -> impl Iterator<Item = SceneClass> {
    let asks = [
        ("elastic body", row.facts.elastic),
        ("no mode", row.facts.modes == 0 && !row.facts.elastic),
        ("one mode", row.facts.modes == 1),
        ("two modes", row.facts.modes == 2),
        ("three modes", row.facts.modes == 3),
        ("force plateau", row.facts.yields),
        ("rest recorded", row.facts.rest),
        ("contact above 10 ms", row.truth("duration").is_some_and(|contact_s| contact_s > 0.01)),
        ("all", true),
    ];
    let held = asks.into_iter().enumerate().filter(|(_, (_, is_so))| *is_so);
    held.map(|(place, (words, _))| SceneClass::new(ClassTable::Rungs, place, words))
}

/// What a rung says of the drops for which one is taken.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct RungSpreads {
    pub speed: Spread,
    pub k: Spread,
    /// By how many of the taken one's half-widths it would change the speed.
    pub changes: Spread,
}

/// A campaign, counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    pub(super) request: CampaignRequest,
    groups: BTreeMap<SceneClass, SceneGroup>,
    /// Of undamaged drops, by the rung taken and the one that says it.
    pub(super) rungs: BTreeMap<(ReconstructionRung, ReconstructionRung), RungSpreads>,
    /// The first of those that passed and are wrong.
    pub(super) missed: Vec<CampaignRow>,
    pub(super) missed_count: usize,
}

impl Tally {
    /// Of no scene yet.
    pub fn new(request: CampaignRequest) -> Self {
        Self { request, groups: BTreeMap::new(), rungs: BTreeMap::new(), missed: Vec::new(), missed_count: 0 }
    }

    /// Counts a scene.
    pub fn add(&mut self, row: &CampaignRow) {
        for class in classes(row) {
            let is_whole = class.table == ClassTable::Undamaged;
            let quantities = if is_whole { QUANTITIES.len() } else { USUAL_QUANTITIES };
            self.groups.entry(class).or_default().add(row, quantities);
        }
        if let Some(taken) = row.rung.filter(|_| row.damage.is_none()) {
            self.add_rungs(row, taken);
        }
        if outcome(row) == SceneOutcome::Missed {
            self.missed_count += 1;
            if self.missed.len() < MOST_LISTED {
                self.missed.push(row.clone());
            }
        }
    }

    fn add_rungs(&mut self, row: &CampaignRow, taken: ReconstructionRung) {
        for said in &row.rungs {
            let spreads = self.rungs.entry((taken, said.rung)).or_default();
            spreads.speed.add(said.speed.zip(row.truth("speed")), true);
            spreads.k.add(said.k.zip(row.truth("k")), false);
            let change =
                row.stated("speed").zip(said.speed).map(|(own, said)| (said.value - own.value) / own.u95);
            spreads.changes.add(change.map(|value| (Stated { value, u95: 0.0 }, 0.0)), false);
        }
    }

    /// The scenes of each row of a table, by its words.
    pub(super) fn groups(&self, table: ClassTable) -> Vec<(&str, &SceneGroup)> {
        let own = self.groups.iter().filter(|(class, _)| class.table == table);
        own.map(|(class, group)| (&class.words[..], group)).collect()
    }
}
