//! The document of a campaign: errors of the analysis, coverage of its intervals, and its warnings.

use super::score::SceneOutcome;
use super::tally::{ClassTable, QUANTITIES, SceneGroup, Spread, Tally};
use crate::data::Verdict;
use crate::lab::data::{CampaignRow, Stated};
use crate::numerics::as_f64;
use crate::report::as_markdown;
use crate::report::document::{Chapter, ChapterPart, ReportDocument, ReportTable};
use crate::report::rounding::optional_fixed;

/// The document as Markdown.
pub fn markdown(tally: &Tally) -> String {
    as_markdown::markdown(&document(tally))
}

/// The scenes of a class with its words.
type NamedGroup<'a> = (&'a str, &'a SceneGroup);

fn document(tally: &Tally) -> ReportDocument {
    let [undamaged, sound, damaged] =
        [ClassTable::Undamaged, ClassTable::SoundKinds, ClassTable::DamagedKinds].map(|t| tally.groups(t));
    let all = |groups: &[NamedGroup]| groups.last().map_or(0, |(_, all)| all.len());
    let summary = format!(
        "{} undamaged scenes, {} of sound kinds and {} damaged ones, seed {}{}.",
        all(&undamaged),
        all(&sound) - all(&undamaged),
        all(&damaged),
        tally.request.seed,
        if tally.request.exact { ", what is stated exactly true" } else { "" },
    );
    let mut chapters = vec![Chapter::new("").then(ChapterPart::text(summary))];
    let mut chapter = |heading: &str, table| chapters.push(Chapter::new(heading).then(table));
    if !undamaged.is_empty() {
        chapter("Errors and intervals", intervals(&undamaged));
    }
    if !sound.is_empty() {
        chapter("Sound drops, by kind", coverage(&sound));
        chapter("Sound drops, by class", coverage(&tally.groups(ClassTable::SoundClasses)));
    }
    if !damaged.is_empty() {
        chapter("Damaged scenes, by kind", damages(&damaged));
    }
    chapters.push(Chapter::new("Passed and wrong").with_all(list_missed(tally)));
    ReportDocument { chapters, ..ReportDocument::default() }
}

/// Formats a number with this many decimals; a dash if it is not finite.
fn number(value: f64, decimals: usize) -> String {
    optional_fixed(Some(value), decimals)
}

/// A share in percent.
fn share(part: usize, of: usize) -> String {
    if of == 0 { "–".to_owned() } else { format!("{:.1} %", 100.0 * as_f64(part) / as_f64(of)) }
}

impl Spread {
    /// The error that this share of the scenes does not exceed.
    pub(super) fn error(&self, share: f64, decimals: usize) -> String {
        number(self.errors.quantile(share), decimals)
    }

    /// The half-width that half of the scenes do not exceed.
    pub(super) fn half_width(&self, decimals: usize) -> String {
        number(self.half_widths.quantile(0.5), decimals)
    }

    /// Says how many of the intervals hold the truth.
    pub(super) fn count_held(&self) -> String {
        share(self.held, self.count())
    }
}

fn intervals<'a>(groups: &[NamedGroup<'a>]) -> ChapterPart {
    let of_group = |&(name, of): &NamedGroup<'a>| {
        QUANTITIES.map(|(quantity, shown, _, decimals)| (name, shown, decimals, of.spread(quantity)))
    };
    let spreads: Vec<_> = groups.iter().flat_map(of_group).collect();
    ReportTable::from_rows(&spreads)
        .text("scenes", |(name, ..)| *name)
        .text("quantity", |(_, shown, ..)| *shown)
        .number("stated", |(.., spread)| spread.count().to_string())
        .number("error: median", |(_, _, decimals, spread)| spread.error(0.5, *decimals))
        .number("95th", |(_, _, decimals, spread)| spread.error(0.95, *decimals))
        .number("largest", |(_, _, decimals, spread)| spread.error(1.0, *decimals))
        .number("half-width: median", |(_, _, decimals, spread)| spread.half_width(*decimals))
        .number("holds the truth", |(.., spread)| spread.count_held())
        .into()
}

/// Table of the groups: how many scenes pass, their errors, and the coverage of the intervals.
fn coverage(groups: &[NamedGroup]) -> ChapterPart {
    let held = |scenes: &SceneGroup, name| scenes.spread(name).count_held();
    ReportTable::from_rows(groups)
        .text("drops", |(words, _)| *words)
        .number("scenes", |(_, scenes)| scenes.len().to_string())
        .number("pass", |(_, scenes)| share(scenes.count(|s| s.verdict == Some(Verdict::Pass)), scenes.len()))
        .number("no numbers", |(_, scenes)| share(scenes.count(|s| !s.has_numbers), scenes.len()))
        .number("covered", |(_, scenes)| share(scenes.count_outcome(SceneOutcome::Covered), scenes.len()))
        .number("speed: 95th, %", |(_, scenes)| scenes.spread("speed").error(0.95, 2))
        .number("k: 95th", |(_, scenes)| scenes.spread("k").error(0.95, 4))
        .number("held: speed", |(_, scenes)| held(scenes, "speed"))
        .number("k", |(_, scenes)| held(scenes, "k"))
        .number("ω", |(_, scenes)| held(scenes, "omega"))
        .number("v_z", |(_, scenes)| held(scenes, "vertical"))
        .number("v_x", |(_, scenes)| held(scenes, "horizontal"))
        .number("missed", |(_, scenes)| scenes.count_outcome(SceneOutcome::Missed).to_string())
        .into()
}

/// The outcomes of every kind of damage.
fn damages(groups: &[NamedGroup]) -> ChapterPart {
    let mut table = ReportTable::from_rows(groups)
        .text("damage", |(kind, _)| *kind)
        .number("scenes", |(_, scenes)| scenes.len().to_string());
    for outcome in SceneOutcome::ALL {
        table = table.number(outcome.word(), |(_, scenes)| scenes.count_outcome(outcome).to_string());
    }
    let missed_per_200 = |scenes: &SceneGroup| {
        200.0 * as_f64(scenes.count_outcome(SceneOutcome::Missed)) / as_f64(scenes.len())
    };
    table.number("missed per 200", |(_, scenes)| number(missed_per_200(scenes), 1)).into()
}

/// Lists the scenes that passed although they are wrong, up to a limit.
fn list_missed(tally: &Tally) -> Vec<ChapterPart> {
    if tally.missed.is_empty() {
        return vec![ChapterPart::text("None.")];
    }
    let damage = |row: &CampaignRow| match &row.damage {
        None => "none".to_owned(),
        Some(d) if d.unit.is_empty() => d.kind.clone(),
        Some(d) => format!("{} {} {}", d.kind, d.size, d.unit),
    };
    let stated = |row: &CampaignRow, name, decimals| {
        let words = |e: Stated| format!("{} ± {}", number(e.value, decimals), number(e.u95, decimals));
        row.find_stated(name).map_or_else(|| "–".to_owned(), words)
    };
    let truth = |row: &CampaignRow, name, decimals| optional_fixed(row.truth(name), decimals);
    let table = ReportTable::from_rows(&tally.missed)
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
