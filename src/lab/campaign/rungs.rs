//! Drops of a campaign to tables of which rung of the reconstruction each scene takes, and what every other
//! would change.

use super::score::written;
use super::statistics::Spread;
use crate::data::ReconstructionRung;
use crate::lab::data::{CampaignRow, Stated};
use crate::report::document::ChapterPart;
use crate::report::rounding::optional_fixed;
use crate::report::table::ReportTable;
use std::collections::BTreeMap;

/// Whether a scene belongs to a class.
type Belongs = fn(&CampaignRow) -> bool;

/// What in a scene asks for a higher rung, or is none of the rungs' business.
const SCENES: [(&str, Belongs); 8] = [
    ("no mode", |row| row.facts.modes == 0),
    ("one mode", |row| row.facts.modes == 1),
    ("two modes", |row| row.facts.modes == 2),
    ("three modes", |row| row.facts.modes == 3),
    ("force plateau", |row| row.facts.yields),
    ("rest recorded", |row| row.facts.rest),
    ("contact above 10 ms", |row| {
        row.quantities.get("duration").and_then(|s| s.truth).is_some_and(|s| s > 0.01)
    }),
    ("all", |_| true),
];

/// Undamaged drops, counted by the rung taken.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct RungTally {
    /// By class of scenes and rung.
    counts: BTreeMap<(usize, ReconstructionRung), usize>,
    /// By the rung taken and another one.
    beside: BTreeMap<(ReconstructionRung, ReconstructionRung), RungBeside>,
}

/// What a rung says of the drops for which another was taken.
#[derive(Debug, Clone, Default, PartialEq)]
struct RungBeside {
    speed: Spread,
    k: Spread,
    /// By how many of the taken one's half-widths it would change the speed.
    changes: Spread,
}

impl RungTally {
    /// Counts a scene, where it is undamaged and has a motion.
    pub(super) fn add(&mut self, row: &CampaignRow) {
        let Some(taken) = row.rung.filter(|_| row.damage.is_none()) else { return };
        for (i, _) in SCENES.iter().enumerate().filter(|(_, (_, belongs))| belongs(row)) {
            *self.counts.entry((i, taken)).or_default() += 1;
        }
        let scored = |name: &str| row.quantities.get(name);
        let truth = |name: &str| scored(name).and_then(|scored| scored.truth);
        for said in &row.rungs {
            let beside = self.beside.entry((taken, said.rung)).or_default();
            beside.speed.add(said.speed.zip(truth("speed")), true);
            beside.k.add(said.k.zip(truth("k")), false);
            let stated = scored("speed").and_then(|scored| scored.stated);
            let change =
                stated.zip(said.speed).map(|(stated, said)| (said.value - stated.value) / stated.u95);
            beside.changes.add(change.map(|value| (Stated { value, u95: 0.0 }, 0.0)), false);
        }
    }

    /// A table of scenes by rung taken, and one of what every rung says of the drops that take one.
    pub(super) fn tables(&self) -> [ChapterPart; 2] {
        let count = |place, rung| self.counts.get(&(place, rung)).copied().unwrap_or(0);
        let is_drawn =
            |place: &usize| ReconstructionRung::ALL.into_iter().any(|rung| count(*place, rung) > 0);
        let drawn: Vec<usize> = (0..SCENES.len()).filter(is_drawn).collect();
        let mut scenes = ReportTable::of(&drawn).text("scene", |place| SCENES[*place].0);
        for rung in ReconstructionRung::ALL {
            scenes = scenes.number(written(rung), move |place| count(*place, rung).to_string());
        }
        let pairs: Vec<_> = self.beside.iter().filter(|(_, beside)| beside.k.count() > 0).collect();
        let beside = ReportTable::of(&pairs)
            .chosen(|((taken, said), _)| taken == said)
            .text("taken", |((taken, _), _)| written(taken))
            .text("rung", |((_, said), _)| written(said))
            .number("drops", |(_, beside)| beside.k.count().to_string())
            .number("speed: 95th, %", |(_, beside)| beside.speed.error(0.95, 2))
            .number("half-width, %", |(_, beside)| {
                optional_fixed(Some(beside.speed.half_widths.quantile(0.5)), 2)
            })
            .number("held", |(_, beside)| beside.speed.held())
            .number("k: 95th", |(_, beside)| beside.k.error(0.95, 4))
            .number("held", |(_, beside)| beside.k.held())
            .number("changes the speed by, half-widths: 95th", |((taken, said), beside)| {
                let change = (taken != said).then(|| beside.changes.errors.quantile(0.95));
                optional_fixed(change, 2)
            });
        [scenes.into(), beside.into()]
    }
}
