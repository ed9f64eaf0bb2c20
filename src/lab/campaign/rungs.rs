//! Drops of a campaign to tables of which rung of the reconstruction each scene takes, and what every other would change.

use super::score::written;
use super::statistics::{Spread, quantile, scored};
use crate::data::ReconstructionRung;
use crate::lab::data::{Campaign, CampaignRow};
use crate::report::document::ChapterPart;
use crate::report::rounding::optional_fixed;
use crate::report::table::ReportTable;

/// Whether a scene belongs to a class.
type Belongs = fn(&CampaignRow) -> bool;

/// What in a scene asks for a higher rung, or is none of the rungs' business.
const SCENES: [(&str, Belongs); 8] = [
    ("no mode", |row| row.scene.modes.is_empty()),
    ("one mode", |row| row.scene.modes.len() == 1),
    ("two modes", |row| row.scene.modes.len() == 2),
    ("three modes", |row| row.scene.modes.len() == 3),
    ("force plateau", |row| row.scene.first_end.yield_n.is_some()),
    ("rest recorded", |row| row.scene.rest),
    ("contact above 10 ms", |row| row.truth.contact_s.is_some_and(|s| s > 0.01)),
    ("all", |_| true),
];

/// A table of scenes by rung taken, and one of what every rung says of the drops that take one.
pub(in crate::lab) fn rungs(campaign: &Campaign) -> [ChapterPart; 2] {
    let rows: Vec<&CampaignRow> =
        campaign.rows.iter().filter(|row| row.damage.is_none() && row.rung.is_some()).collect();
    let count =
        |belongs: Belongs, rung| rows.iter().filter(|row| belongs(row) && row.rung == Some(rung)).count();
    let drawn: Vec<_> =
        SCENES.into_iter().filter(|(_, belongs)| rows.iter().any(|row| belongs(row))).collect();
    let mut scenes = ReportTable::of(&drawn).text("scene", |(name, _)| *name);
    for rung in ReconstructionRung::ALL {
        scenes = scenes.number(written(rung), move |(_, belongs)| count(*belongs, rung).to_string());
    }
    let all = || ReconstructionRung::ALL.into_iter();
    let pairs: Vec<_> = all()
        .flat_map(|taken| all().map(move |said| (taken, said)))
        .map(|(taken, said)| RungBeside::of(taken, said, &rows))
        .filter(|beside| beside.k.count() > 0)
        .collect();
    let beside = ReportTable::of(&pairs)
        .chosen(|pair| pair.taken == pair.said)
        .text("taken", |pair| written(pair.taken))
        .text("rung", |pair| written(pair.said))
        .number("drops", |pair| pair.k.count().to_string())
        .number("speed: 95th, %", |pair| optional_fixed(Some(quantile(&pair.speed.errors, 0.95)), 2))
        .number("half-width, %", |pair| optional_fixed(Some(quantile(&pair.speed.half_widths, 0.5)), 2))
        .number("held", |pair| pair.speed.held())
        .number("k: 95th", |pair| optional_fixed(Some(quantile(&pair.k.errors, 0.95)), 4))
        .number("held", |pair| pair.k.held())
        .number("changes the speed by, half-widths: 95th", |pair| {
            optional_fixed((pair.taken != pair.said).then(|| quantile(&pair.changes, 0.95)), 2)
        });
    [scenes.into(), beside.into()]
}

/// What a rung says of the drops for which another was taken.
struct RungBeside {
    taken: ReconstructionRung,
    said: ReconstructionRung,
    speed: Spread,
    k: Spread,
    /// By how many of the taken one's half-widths it would change the speed, ascending.
    changes: Vec<f64>,
}

impl RungBeside {
    fn of(taken: ReconstructionRung, said: ReconstructionRung, rows: &[&CampaignRow]) -> Self {
        let of = |row: &CampaignRow| row.candidates.iter().find(|c| c.rung == said).cloned();
        let had: Vec<_> = rows
            .iter()
            .filter(|row| row.rung == Some(taken))
            .filter_map(|row| Some((*row, of(row)?)))
            .collect();
        let change = |(row, candidate): &(&CampaignRow, _)| {
            let candidate: &crate::data::ReconstructionCandidate = candidate;
            let (stated, said) = scored(row, "speed")?.stated.zip(candidate.speed)?;
            Some((said.value - stated.value).abs() / stated.u95)
        };
        let mut changes: Vec<f64> = had.iter().filter_map(change).collect();
        changes.sort_by(f64::total_cmp);
        Self {
            taken,
            said,
            speed: Spread::of(had.iter().filter_map(|(row, c)| c.speed.zip(row.truth.speed)), true),
            k: Spread::of(had.iter().filter_map(|(row, c)| c.k.zip(row.truth.k)), false),
            changes,
        }
    }
}
