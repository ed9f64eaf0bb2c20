//! Counts rows, one after the other, for the tables of each class of scenes. The counts add up exactly in
//! whatever order and parts the rows are counted.

use super::DamageKind;
use super::score::{SceneOutcome, outcome};
use crate::data::Verdict;
use crate::lab::data::{CampaignRequest, CampaignRow, Stated};
use crate::lab::drawn::{BUILDS, DRAWN};
use crate::numerics::robust::quantile_by;
use std::collections::BTreeMap;

/// Quantities by their names in scores and in tables; true if in percent of the truth; decimals.
pub(super) const QUANTITIES: [(&str, &str, bool, usize); 10] = [
    ("speed", "slap-down speed, %", true, 2),
    ("k", "k", false, 4),
    ("vertical", "vertical velocity, m/s", false, 3),
    ("horizontal", "horizontal velocity, m/s", false, 3),
    ("omega", "ω after the impact, %", true, 2),
    ("flight", "flight time, %", true, 2),
    ("angle", "angle at slap-down, °", false, 3),
    ("duration", "duration of the first contact, %", true, 2),
    ("contact_time", "time of the first contact, s", false, 6),
    ("slap_down_time", "time of the slap-down, s", false, 6),
];

/// Magnitudes counted in bins of a relative width of 1/500: quantiles are accurate to a thousandth, with at
/// most some thousand counts.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Magnitudes {
    bins: BTreeMap<u32, u32>,
    count: usize,
    largest: f64,
}

/// Low bits of a number that its bin ignores: all but sign, exponent and nine of its fraction.
const BITS_LEFT_OUT: u32 = 43;

impl Magnitudes {
    fn add(&mut self, value: f64) {
        let value = if value.is_nan() { f64::INFINITY } else { value.abs() };
        // The bits of positive numbers have the same order as the numbers.
        let bin = u32::try_from(value.to_bits() >> BITS_LEFT_OUT).unwrap_or(u32::MAX);
        *self.bins.entry(bin).or_default() += 1;
        self.count += 1;
        self.largest = self.largest.max(value);
    }

    /// The value below which this share lies; the largest value is exact. NaN without values.
    pub(super) fn quantile(&self, share: f64) -> f64 {
        quantile_by(self.count, share, |rank| self.value_at(rank))
    }

    /// The value of this rank: the middle of its bin.
    fn value_at(&self, rank: usize) -> f64 {
        if rank + 1 == self.count {
            return self.largest;
        }
        let mut seen = 0;
        let bin = self.bins.iter().find(|(_, count)| {
            seen += **count as usize;
            seen > rank
        });
        let middle = |bin: &u32| f64::from_bits((2 * u64::from(*bin) + 1) << (BITS_LEFT_OUT - 1));
        bin.map_or(f64::NAN, |(bin, _)| middle(bin).min(self.largest))
    }
}

/// Errors, half-widths and coverage of one quantity over many scenes.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Spread {
    /// Magnitudes of the errors.
    pub errors: Magnitudes,
    /// Half-widths.
    pub half_widths: Magnitudes,
    /// Number of intervals that hold the truth.
    pub held: usize,
}

impl Spread {
    /// Counts one statement with its truth, if both exist; `relative`: in percent of the truth.
    fn add(&mut self, both: Option<(Stated, f64)>, relative: bool) {
        let Some((stated, truth)) = both else { return };
        let scale = if relative { 100.0 / truth.abs().max(f64::MIN_POSITIVE) } else { 1.0 };
        let off = (stated.value - truth).abs();
        self.held += usize::from(off <= stated.u95);
        self.errors.add(scale * off);
        self.half_widths.add(scale * stated.u95);
    }

    /// Number of statements.
    pub(super) fn count(&self) -> usize {
        self.errors.count
    }
}

/// Words that describe a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SceneWords {
    /// None where the recording was refused.
    pub verdict: Option<Verdict>,
    pub outcome: SceneOutcome,
    /// True if speed and k are stated.
    pub has_numbers: bool,
}

/// Some scenes of a campaign, counted.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct SceneGroup {
    counts: BTreeMap<SceneWords, usize>,
    /// Spread of each stated quantity, by its name.
    spreads: BTreeMap<&'static str, Spread>,
}

impl SceneGroup {
    /// Counts a scene and its quantities.
    fn add(&mut self, row: &CampaignRow) {
        let (outcome, has_numbers) = (outcome(row), row.has_numbers());
        let words = SceneWords { verdict: row.verdict, outcome, has_numbers };
        *self.counts.entry(words).or_default() += 1;
        for (name, _, relative, _) in QUANTITIES {
            self.spreads.entry(name).or_default().add(row.find_stated(name).zip(row.truth(name)), relative);
        }
    }

    /// Counts the scenes with a property.
    pub(super) fn count(&self, is_said: impl Fn(&SceneWords) -> bool) -> usize {
        self.counts.iter().filter(|(words, _)| is_said(words)).map(|(_, count)| count).sum()
    }

    /// Number of scenes.
    pub(super) fn len(&self) -> usize {
        self.count(|_| true)
    }

    /// Counts the scenes with this outcome.
    pub(super) fn count_outcome(&self, outcome: SceneOutcome) -> usize {
        self.count(|words| words.outcome == outcome)
    }

    /// Spread of a quantity.
    pub(super) fn spread(&self, name: &str) -> Spread {
        self.spreads.get(name).cloned().unwrap_or_default()
    }
}

/// Scenes that passed although they are wrong are listed up to this many.
const MOST_LISTED: usize = 1000;

/// A table that has a row for each of several classes of scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ClassTable {
    /// Undamaged drops: those that passed, then all.
    Undamaged,
    /// Drops without a fault, by kind, then all.
    SoundKinds,
    /// Sound scenes by cask, and by small, middle or large values of their numbers.
    SoundClasses,
    /// Drops with a fault, by kind, then all.
    DamagedKinds,
}

/// Scenes that are counted together: a row of a table.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct SceneClass {
    table: ClassTable,
    /// Row within the table.
    place: usize,
    words: String,
}

impl SceneClass {
    fn new(table: ClassTable, place: usize, words: &str) -> Self {
        Self { table, place, words: words.to_owned() }
    }
}

/// The row of all scenes of a table.
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
    }
    classes
}

/// The two kinds of bodies, with the names of classes and limits.
pub(in crate::lab) const BODIES: [&str; 2] = ["rigid bodies with modes", "elastic bodies"];

/// Body, cask, and small, middle or large numbers.
fn sound_classes(row: &CampaignRow) -> Vec<SceneClass> {
    let class = |place, words: &str| SceneClass::new(ClassTable::SoundClasses, place, words);
    let body = usize::from(row.facts.elastic);
    let casks = BUILDS.map(|build| build.name).into_iter().chain([DRAWN]);
    let cask = casks.zip(2..).find(|(name, _)| row.facts.cask.starts_with(name));
    let mut classes = vec![class(body, BODIES[body])];
    classes.extend(cask.map(|(name, i)| class(i, name)));
    // The limits separate small, middle and large values.
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

/// A campaign, counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    pub(super) request: CampaignRequest,
    groups: BTreeMap<SceneClass, SceneGroup>,
    /// The first scenes that passed although they are wrong.
    pub(super) missed: Vec<CampaignRow>,
    pub(super) missed_count: usize,
}

impl Tally {
    /// A tally without any scene.
    pub fn new(request: CampaignRequest) -> Self {
        Self { request, groups: BTreeMap::new(), missed: Vec::new(), missed_count: 0 }
    }

    /// Counts a scene.
    pub fn add(&mut self, row: &CampaignRow) {
        for class in classes(row) {
            self.groups.entry(class).or_default().add(row);
        }
        if outcome(row) == SceneOutcome::Missed {
            self.missed_count += 1;
            if self.missed.len() < MOST_LISTED {
                self.missed.push(row.clone());
            }
        }
    }

    /// The scenes of each row of a table, by its words.
    pub(super) fn groups(&self, table: ClassTable) -> Vec<(&str, &SceneGroup)> {
        let own = self.groups.iter().filter(|(class, _)| class.table == table);
        own.map(|(class, group)| (&class.words[..], group)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::robust::quantile;

    fn counted(values: impl IntoIterator<Item = f64>) -> Magnitudes {
        let mut all = Magnitudes::default();
        for value in values {
            all.add(value);
        }
        all
    }

    #[test]
    fn quantiles_lie_between_their_neighbours() {
        let values = [1.0, 2.0, 4.0];
        assert!((quantile(&values, 0.5) - 2.0).abs() < 1e-15);
        assert!((quantile(&values, 0.75) - 3.0).abs() < 1e-15);
        assert!((quantile(&values, 1.0) - 4.0).abs() < 1e-15);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn counted_quantiles_are_right_to_a_thousandth_whatever_the_order() {
        let values: Vec<f64> = (0..997).map(|i| f64::from(i * i % 997).powi(3) / 1e6).collect();
        let mut ascending = values.clone();
        ascending.sort_by(f64::total_cmp);
        let counted_values = counted(values.iter().copied());
        assert_eq!(counted_values, counted(values.iter().rev().copied()));
        for share in [0.05, 0.5, 0.95, 0.999] {
            let exact = quantile(&ascending, share);
            // Half a bin: 2^-10 of the value.
            assert!((counted_values.quantile(share) / exact - 1.0).abs() < 1e-3, "{share}");
        }
        assert_eq!(counted_values.quantile(1.0).to_bits(), ascending[996].to_bits());
        assert!(Magnitudes::default().quantile(0.5).is_nan());
        assert!(counted([f64::NAN, f64::INFINITY, 1.0]).quantile(0.9).is_infinite());
        assert!(counted([0.0, 0.0, 0.0]).quantile(0.5) < 1e-300);
    }
}
