//! A campaign to the document that says how far off the analysis is, how often its intervals hold, and how
//! often it says so.

use super::statistics::{QUANTITIES, SceneGroup, SceneOutcome, Spread};
use super::tally::{GroupKey, NUMBERS, Tally};
use crate::data::Verdict;
use crate::lab::data::{Campaign, CampaignRow};
use crate::lab::drawn::BUILDS;
use crate::numerics::as_f64;
use crate::report::as_markdown;
use crate::report::document::{Chapter, ChapterPart, ReportDocument};
use crate::report::rounding::optional_fixed;
use crate::report::table::ReportTable;

/// The whole as Markdown.
#[must_use]
pub fn markdown(tally: &Tally) -> String {
    as_markdown::markdown(&document(tally), None)
}

/// A table of scenes by the rung of the reconstruction taken, and one of what every rung says of the drops
/// that take one.
pub(in crate::lab) fn rungs(campaign: &Campaign) -> [ChapterPart; 2] {
    let mut tally = Tally::new(campaign.request.clone());
    for row in &campaign.rows {
        tally.add(row);
    }
    tally.rungs.tables()
}

fn document(tally: &Tally) -> ReportDocument {
    let [undamaged, sound, damaged] =
        [GroupKey::Undamaged, GroupKey::Sound, GroupKey::Damaged].map(|key| tally.group(&key));
    let summary = format!(
        "{} undamaged scenes, {} of sound kinds and {} damaged ones, seed {}{}.",
        undamaged.len(),
        sound.len() - undamaged.len(),
        damaged.len(),
        tally.request.seed,
        if tally.request.exact { ", what is stated exactly true" } else { "" },
    );
    let mut chapters = vec![Chapter::new("").with(ChapterPart::text(summary))];
    let mut chapter = |heading: &str, table| chapters.push(Chapter::new(heading).with(table));
    if undamaged.len() > 0 {
        chapter("Undamaged scenes", verdicts(&undamaged));
        chapter("Errors and intervals", intervals(&tally.group(&GroupKey::Passed), &undamaged));
        let [taken, beside] = tally.rungs.tables();
        chapter("Rungs of the reconstruction", taken);
        chapter("What other rungs would change", beside);
    }
    if sound.len() > 0 {
        chapter("Sound drops, by kind", coverage(&sound_kinds(tally)));
        chapter("Sound drops, by class", coverage(&classes(tally)));
    }
    if damaged.len() > 0 {
        chapter("Damaged scenes, by kind", damages(tally));
    }
    chapters.push(Chapter::new("Passed and wrong").with_all(missed(tally)));
    ReportDocument { chapters, ..ReportDocument::default() }
}

/// A number with this many decimals; a dash where there is none.
fn number(value: f64, decimals: usize) -> String {
    optional_fixed(Some(value), decimals)
}

/// A share in percent.
fn share(part: usize, of: usize) -> String {
    if of == 0 { "–".to_owned() } else { format!("{:.1} %", 100.0 * as_f64(part) / as_f64(of)) }
}

impl Spread {
    /// The error that this share of the scenes stays below.
    pub(super) fn error(&self, share: f64, decimals: usize) -> String {
        number(self.errors.quantile(share), decimals)
    }

    /// How many of the intervals hold the truth.
    pub(super) fn held(&self) -> String {
        share(self.held, self.count())
    }
}

fn verdicts(scenes: &SceneGroup) -> ChapterPart {
    let of = [("pass", Verdict::Pass), ("review", Verdict::Review), ("fail", Verdict::Fail)]
        .map(|(name, verdict)| (name, scenes.of(verdict)));
    let right = |of: &SceneGroup| of.count(SceneOutcome::Right) + of.count(SceneOutcome::Covered);
    ReportTable::of(&of)
        .text("verdict", |(name, _)| *name)
        .number("scenes", |(_, of)| of.len().to_string())
        .number("share", |(_, of)| share(of.len(), scenes.len()))
        .number("speed and k right or held", |(_, of)| right(of).to_string())
        .number("missed", |(_, of)| of.count(SceneOutcome::Missed).to_string())
        .into()
}

fn intervals(passed: &SceneGroup, all: &SceneGroup) -> ChapterPart {
    let of_scenes = |(name, of): (&'static str, &SceneGroup)| {
        QUANTITIES.map(|(quantity, shown, _, decimals)| (name, shown, decimals, of.spread(quantity)))
    };
    let spreads: Vec<_> = [("passed", passed), ("all", all)].into_iter().flat_map(of_scenes).collect();
    ReportTable::of(&spreads)
        .text("scenes", |(name, ..)| *name)
        .text("quantity", |(_, shown, ..)| *shown)
        .number("stated", |(.., spread)| spread.count().to_string())
        .number("error: median", |(_, _, decimals, spread)| spread.error(0.5, *decimals))
        .number("95th", |(_, _, decimals, spread)| spread.error(0.95, *decimals))
        .number("largest", |(_, _, decimals, spread)| spread.error(1.0, *decimals))
        .number("half-width: median", |(_, _, decimals, spread)| {
            number(spread.half_widths.quantile(0.5), *decimals)
        })
        .number("holds the truth", |(.., spread)| spread.held())
        .into()
}

/// The sound drops of each cask, and those with a small, middle and large number.
fn classes(tally: &Tally) -> Vec<(String, SceneGroup)> {
    let casks = BUILDS.map(|build| (build.name.to_owned(), tally.group(&GroupKey::Cask(build.name))));
    let numbers = NUMBERS.iter().flat_map(|&(name, unit, [low, high], _)| {
        let between = [format!("below {low}"), format!("{low} to {high}"), format!("above {high}")];
        let named = between.map(|between| format!("{name} {between}{unit}"));
        named.into_iter().enumerate().map(move |(class, named)| (named, GroupKey::Class(name, class)))
    });
    casks.into_iter().chain(numbers.map(|(words, key)| (words, tally.group(&key)))).collect()
}

/// The undamaged drops, those of each sound kind, and all of them.
fn sound_kinds(tally: &Tally) -> Vec<(String, SceneGroup)> {
    let named = super::kinds().filter(|kind| kind.is_sound()).map(|kind| kind.name);
    let of = |name: &str| (name.to_owned(), tally.group(&GroupKey::SoundKind(name.to_owned())));
    let all = ("all".to_owned(), tally.group(&GroupKey::Sound));
    std::iter::once("undamaged").chain(named).map(of).chain([all]).collect()
}

/// How many of each group pass, how far off they are, and how often each interval holds.
fn coverage(groups: &[(String, SceneGroup)]) -> ChapterPart {
    let held = |of: &SceneGroup, name| of.spread(name).held();
    let groups: Vec<_> = groups.iter().filter(|(_, of)| of.len() > 0).collect();
    ReportTable::of(&groups)
        .text("drops", |(name, _)| &name[..])
        .number("scenes", |(_, of)| of.len().to_string())
        .number("pass", |(_, of)| share(of.of(Verdict::Pass).len(), of.len()))
        .number("covered", |(_, of)| share(of.count(SceneOutcome::Covered), of.len()))
        .number("speed: 95th, %", |(_, of)| of.spread("speed").error(0.95, 2))
        .number("k: 95th", |(_, of)| of.spread("k").error(0.95, 4))
        .number("held: speed", |(_, of)| held(of, "speed"))
        .number("k", |(_, of)| held(of, "k"))
        .number("ω", |(_, of)| held(of, "omega"))
        .number("v_z", |(_, of)| held(of, "vertical"))
        .number("v_x", |(_, of)| held(of, "horizontal"))
        .number("missed", |(_, of)| of.count(SceneOutcome::Missed).to_string())
        .into()
}

/// The outcomes of every kind of damage, in the order of the kinds.
fn damages(tally: &Tally) -> ChapterPart {
    let of = |name: &'static str| (name, tally.group(&GroupKey::DamagedKind(name.to_owned())));
    let mut groups: Vec<(&str, SceneGroup)> = super::kinds().map(|kind| of(kind.name)).collect();
    groups.retain(|(_, of)| of.len() > 0);
    groups.push(("all", tally.group(&GroupKey::Damaged)));
    ReportTable::of(&groups)
        .text("damage", |(kind, _)| *kind)
        .number("scenes", |(.., of)| of.len().to_string())
        .number("right", |(.., of)| of.count(SceneOutcome::Right).to_string())
        .number("covered", |(.., of)| of.count(SceneOutcome::Covered).to_string())
        .number("caught", |(.., of)| of.count(SceneOutcome::Caught).to_string())
        .number("missed", |(.., of)| of.count(SceneOutcome::Missed).to_string())
        .number("missed per 200", |(.., of)| {
            number(200.0 * as_f64(of.count(SceneOutcome::Missed)) / as_f64(of.len()), 1)
        })
        .into()
}

/// The scenes that passed and are wrong, as many as are listed.
fn missed(tally: &Tally) -> Vec<ChapterPart> {
    if tally.missed.is_empty() {
        return vec![ChapterPart::text("None.")];
    }
    let damage = |row: &CampaignRow| match &row.damage {
        None => "none".to_owned(),
        Some(d) if d.unit.is_empty() => d.kind.clone(),
        Some(d) => format!("{} {} {}", d.kind, d.size, d.unit),
    };
    let scored = |row: &CampaignRow, name| row.quantities.get(name).copied();
    let stated = |row: &CampaignRow, name, decimals| {
        scored(row, name).and_then(|s| s.stated).map_or_else(
            || "–".to_owned(),
            |e| format!("{} ± {}", number(e.value, decimals), number(e.u95, decimals)),
        )
    };
    let truth =
        |row: &CampaignRow, name, decimals| optional_fixed(scored(row, name).and_then(|s| s.truth), decimals);
    let table = ReportTable::of(&tally.missed)
        .text("scene", |row| row.scene.to_string())
        .text("damage", damage)
        .number("speed", |row| stated(row, "speed", 3))
        .number("true", |row| truth(row, "speed", 3))
        .number("k", |row| stated(row, "k", 4))
        .number("true", |row| truth(row, "k", 4))
        .into();
    let further = tally.missed_count - tally.missed.len();
    let words = (further > 0).then(|| ChapterPart::text(format!("And {further} more.")));
    std::iter::once(table).chain(words).collect()
}
