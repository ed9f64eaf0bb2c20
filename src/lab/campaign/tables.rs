//! A campaign to the document that says how far off the analysis is, how often its intervals hold, and how often it says so.

use super::DamageKind;
use super::rungs::rungs;
use super::statistics::{SceneOutcome, Spread, outcome, quantile, scored};
use crate::data::Verdict;
use crate::lab::data::{Campaign, CampaignRow};
use crate::lab::drawn::BUILDS;
use crate::numerics::{as_f64, robust};
use crate::report::as_markdown;
use crate::report::document::{Chapter, ChapterPart, ReportDocument};
use crate::report::rounding::optional_fixed;
use crate::report::table::ReportTable;

/// The whole as Markdown.
#[must_use]
pub fn markdown(campaign: &Campaign) -> String {
    as_markdown::markdown(&document(campaign), None)
}

fn document(campaign: &Campaign) -> ReportDocument {
    let all = Scenes(campaign.rows.iter().collect());
    let undamaged = all.that(|row| row.damage.is_none());
    let [sound, damaged] = [true, false].map(|is_sound| all.that(|row| is_sound_drop(row) == is_sound));
    let request = &campaign.request;
    let mut times_s: Vec<f64> = campaign.rows.iter().map(|row| row.analysis_s).collect();
    let summary = format!(
        "{} undamaged scenes, {} of sound kinds and {} damaged ones, seed {}{}; one analysis takes {} ms (median).",
        undamaged.0.len(),
        sound.0.len() - undamaged.0.len(),
        damaged.0.len(),
        request.seed,
        if request.exact { ", what is stated exactly true" } else { "" },
        number(1e3 * robust::median(&mut times_s), 1),
    );
    let mut chapters = vec![Chapter::new("").with(ChapterPart::text(summary))];
    let mut chapter = |heading: &str, table| chapters.push(Chapter::new(heading).with(table));
    if !undamaged.0.is_empty() {
        chapter("Undamaged scenes", verdicts(&undamaged));
        chapter("Errors and intervals", intervals(&undamaged));
        let [taken, beside] = rungs(campaign);
        chapter("Rungs of the reconstruction", taken);
        chapter("What other rungs would change", beside);
    }
    if !sound.0.is_empty() {
        chapter("Sound drops, by kind", coverage(&sound_kinds(&sound)));
        chapter("Sound drops, by class", coverage(&classes(&sound)));
    }
    if !damaged.0.is_empty() {
        chapter("Damaged scenes, by kind", damages(&damaged));
    }
    chapter("Passed and wrong", missed(&all));
    ReportDocument { chapters, ..ReportDocument::default() }
}

/// Whether nothing is wrong with the drop of this row.
fn is_sound_drop(row: &CampaignRow) -> bool {
    row.damage.is_none_or(|damage| super::kinds().any(|kind| kind.name == damage.kind && kind.is_sound()))
}

/// Some scenes of a campaign.
struct Scenes<'a>(Vec<&'a CampaignRow>);

impl Scenes<'_> {
    fn that(&self, is_wanted: impl Fn(&CampaignRow) -> bool) -> Self {
        Self(self.0.iter().copied().filter(|row| is_wanted(row)).collect())
    }

    fn of(&self, verdict: Verdict) -> Self {
        self.that(|row| row.verdict == Some(verdict))
    }

    fn count(&self, wanted: SceneOutcome) -> usize {
        self.0.iter().filter(|row| outcome(row) == wanted).count()
    }

    /// Statement and truth of one quantity over the scenes that have both; `relative`: in percent of the truth.
    fn spread(&self, name: &str, relative: bool) -> Spread {
        Spread::of(
            self.0.iter().filter_map(|row| scored(row, name).and_then(|s| s.stated.zip(s.truth))),
            relative,
        )
    }
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
    fn error(&self, share: f64, decimals: usize) -> String {
        number(quantile(&self.errors, share), decimals)
    }

    /// How many of the intervals hold the truth.
    pub(super) fn held(&self) -> String {
        share(self.held, self.count())
    }
}

fn verdicts(scenes: &Scenes) -> ChapterPart {
    let of = [("pass", Verdict::Pass), ("review", Verdict::Review), ("fail", Verdict::Fail)]
        .map(|(name, verdict)| (name, scenes.of(verdict)));
    let right = |of: &Scenes| of.count(SceneOutcome::Right) + of.count(SceneOutcome::Covered);
    ReportTable::of(&of)
        .text("verdict", |(name, _)| *name)
        .number("scenes", |(_, of)| of.0.len().to_string())
        .number("share", |(_, of)| share(of.0.len(), scenes.0.len()))
        .number("speed and k right or held", |(_, of)| right(of).to_string())
        .number("missed", |(_, of)| of.count(SceneOutcome::Missed).to_string())
        .into()
}

/// Names, as they are scored and as they are shown; whether in percent of the truth; decimals.
const QUANTITIES: [(&str, &str, bool, usize); 10] = [
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

fn intervals(scenes: &Scenes) -> ChapterPart {
    let passed = scenes.of(Verdict::Pass);
    let of_scenes = |(name, of): (&'static str, &Scenes)| {
        QUANTITIES.map(|(quantity, shown, relative, decimals)| {
            (name, shown, decimals, of.spread(quantity, relative))
        })
    };
    let spreads: Vec<_> = [("passed", &passed), ("all", scenes)].into_iter().flat_map(of_scenes).collect();
    ReportTable::of(&spreads)
        .text("scenes", |(name, ..)| *name)
        .text("quantity", |(_, shown, ..)| *shown)
        .number("stated", |(.., spread)| spread.count().to_string())
        .number("error: median", |(_, _, decimals, spread)| spread.error(0.5, *decimals))
        .number("95th", |(_, _, decimals, spread)| spread.error(0.95, *decimals))
        .number("largest", |(_, _, decimals, spread)| spread.error(1.0, *decimals))
        .number("half-width: median", |(_, _, decimals, spread)| {
            number(quantile(&spread.half_widths, 0.5), *decimals)
        })
        .number("holds the truth", |(.., spread)| spread.held())
        .into()
}

/// A number of a scene.
type Number = fn(&CampaignRow) -> f64;

/// What scenes are classed by, its unit, where the middle class begins and ends, and the number of a scene.
const NUMBERS: [(&str, &str, [f64; 2], Number); 4] = [
    ("angle", "°", [5.0, 30.0], |row| row.truth.angle_deg),
    ("contact", " ms", [3.0, 10.0], |row| row.truth.contact_s.map_or(f64::NAN, |s| 1e3 * s)),
    ("k", "", [0.1, 0.8], |row| row.truth.k.unwrap_or(f64::NAN)),
    ("rate", " kHz", [10.0, 50.0], |row| {
        row.scene.channels.first().map_or(f64::NAN, |c| c.sample_rate_hz / 1e3)
    }),
];

/// The sound drops of each cask, and those with a small, middle and large number.
fn classes<'a>(sound: &Scenes<'a>) -> Vec<(String, Scenes<'a>)> {
    let is_of = |name: &str| sound.that(|row| row.scene.cask.name.starts_with(name));
    let casks = BUILDS.map(|build| (build.name.to_owned(), is_of(build.name)));
    let numbers = NUMBERS.iter().flat_map(|&(name, unit, [low, high], number)| {
        [
            (format!("{name} below {low}{unit}"), sound.that(|row| number(row) < low)),
            (format!("{name} {low} to {high}{unit}"), sound.that(|row| (low..=high).contains(&number(row)))),
            (format!("{name} above {high}{unit}"), sound.that(|row| number(row) > high)),
        ]
    });
    casks.into_iter().chain(numbers).collect()
}

/// The undamaged drops, those of each sound kind, and all of them.
fn sound_kinds<'a>(sound: &Scenes<'a>) -> Vec<(String, Scenes<'a>)> {
    let of = |kind: Option<&'static str>| sound.that(|row| row.damage.map(|damage| damage.kind) == kind);
    let named = super::kinds().filter(|kind| kind.is_sound());
    let named = named.map(|kind| (kind.name.to_owned(), of(Some(kind.name))));
    let all = ("all".to_owned(), sound.that(|_| true));
    std::iter::once(("undamaged".to_owned(), of(None))).chain(named).chain([all]).collect()
}

/// How many of each group pass, how far off they are, and how often each interval holds.
fn coverage(groups: &[(String, Scenes)]) -> ChapterPart {
    let held = |of: &Scenes, name| of.spread(name, false).held();
    let groups: Vec<_> = groups.iter().filter(|(_, of)| !of.0.is_empty()).collect();
    ReportTable::of(&groups)
        .text("drops", |(name, _)| &name[..])
        .number("scenes", |(_, of)| of.0.len().to_string())
        .number("pass", |(_, of)| share(of.of(Verdict::Pass).0.len(), of.0.len()))
        .number("covered", |(_, of)| share(of.count(SceneOutcome::Covered), of.0.len()))
        .number("speed: 95th, %", |(_, of)| of.spread("speed", true).error(0.95, 2))
        .number("k: 95th", |(_, of)| of.spread("k", false).error(0.95, 4))
        .number("held: speed", |(_, of)| held(of, "speed"))
        .number("k", |(_, of)| held(of, "k"))
        .number("ω", |(_, of)| held(of, "omega"))
        .number("v_z", |(_, of)| held(of, "vertical"))
        .number("v_x", |(_, of)| held(of, "horizontal"))
        .number("missed", |(_, of)| of.count(SceneOutcome::Missed).to_string())
        .into()
}

/// The outcomes of every kind of damage, in the order of the kinds.
fn damages(scenes: &Scenes) -> ChapterPart {
    let of = |kind: &DamageKind| scenes.that(|row| row.damage.is_some_and(|damage| damage.kind == kind.name));
    let mut groups: Vec<(&str, Scenes)> = super::kinds().map(|kind| (kind.name, of(kind))).collect();
    groups.retain(|(_, of)| !of.0.is_empty());
    groups.push(("all", scenes.that(|_| true)));
    ReportTable::of(&groups)
        .text("damage", |(kind, _)| *kind)
        .number("scenes", |(.., of)| of.0.len().to_string())
        .number("right", |(.., of)| of.count(SceneOutcome::Right).to_string())
        .number("covered", |(.., of)| of.count(SceneOutcome::Covered).to_string())
        .number("caught", |(.., of)| of.count(SceneOutcome::Caught).to_string())
        .number("missed", |(.., of)| of.count(SceneOutcome::Missed).to_string())
        .number("missed per 200", |(.., of)| {
            number(200.0 * as_f64(of.count(SceneOutcome::Missed)) / as_f64(of.0.len()), 1)
        })
        .into()
}

/// Every scene that passed and is wrong.
fn missed(scenes: &Scenes) -> ChapterPart {
    let missed = scenes.that(|row| outcome(row) == SceneOutcome::Missed).0;
    if missed.is_empty() {
        return ChapterPart::text("None.");
    }
    let damage = |row: &CampaignRow| match row.damage {
        None => "none".to_owned(),
        Some(d) if d.unit.is_empty() => d.kind.to_owned(),
        Some(d) => format!("{} {} {}", d.kind, d.size, d.unit),
    };
    let stated = |row: &CampaignRow, name, decimals| {
        scored(row, name).and_then(|s| s.stated).map_or_else(
            || "–".to_owned(),
            |e| format!("{} ± {}", number(e.value, decimals), number(e.u95, decimals)),
        )
    };
    let truth =
        |row: &CampaignRow, name, decimals| optional_fixed(scored(row, name).and_then(|s| s.truth), decimals);
    ReportTable::of(&missed)
        .text("scene", |row| row.number.to_string())
        .text("damage", |row| damage(row))
        .number("speed", |row| stated(row, "speed", 3))
        .number("true", |row| truth(row, "speed", 3))
        .number("k", |row| stated(row, "k", 4))
        .number("true", |row| truth(row, "k", 4))
        .into()
}
