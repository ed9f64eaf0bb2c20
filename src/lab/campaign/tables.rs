//! A campaign to the document that says how far off the analysis is, how often its intervals hold, and how often it says so.

use super::score::{code_name, rung_name};
use super::statistics::{Outcome, Spread, largest_miss_u, outcome, quantile, scored};
use crate::data::{Contact, Estimate, MISSED_U, ReconstructionRung, Severity, Verdict};
use crate::lab::data::{Campaign, CampaignRow};
use crate::report::as_markdown;
use crate::report::document::{Chapter, ChapterPart, ReportDocument};
use crate::report::rounding::optional_fixed;
use crate::report::table::ReportTable;
use std::collections::BTreeMap;

/// The whole as Markdown.
#[must_use]
pub fn markdown(campaign: &Campaign) -> String {
    as_markdown::markdown(&document(campaign), None)
}

fn document(campaign: &Campaign) -> ReportDocument {
    let (undamaged, damaged): (Vec<&CampaignRow>, Vec<&CampaignRow>) =
        campaign.rows.iter().partition(|row| row.damage.is_none());
    let request = &campaign.request;
    let summary = format!(
        "{} undamaged and {} damaged scenes, seed {}{}; one analysis takes {} ms (median).",
        undamaged.len(),
        damaged.len(),
        request.seed,
        if request.exact { ", what is stated exactly true" } else { "" },
        number(1e3 * median(campaign.rows.iter().map(|row| row.analysis_s)), 1),
    );
    let mut chapters = vec![Chapter::new("").with(ChapterPart::text(summary))];
    let mut chapter = |heading: &str, table| chapters.push(Chapter::new(heading).with(table));
    if !undamaged.is_empty() {
        chapter("Undamaged scenes", verdicts(&undamaged));
        chapter("Errors and intervals", intervals(&undamaged));
        chapter("What keeps undamaged scenes from passing", codes(&undamaged));
        chapter("By class", classes(&undamaged));
        chapter("Rungs of the reconstruction", ladder(&undamaged));
        chapter("Drops drawn and left out", redraws(&undamaged));
    }
    if !damaged.is_empty() {
        chapter("Damaged scenes, by kind", damages(&damaged, false));
        chapter("Damaged scenes, by kind and size", damages(&damaged, true));
    }
    if !undamaged.is_empty() && !damaged.is_empty() {
        chapter("What a stricter limit of the closures would do", limits(&undamaged, &damaged));
    }
    chapter("Passed and wrong", missed(&campaign.rows));
    ReportDocument { chapters, ..ReportDocument::default() }
}

/// A number with this many decimals; a dash where there is none.
fn number(value: f64, decimals: usize) -> String {
    optional_fixed(Some(value), decimals)
}

/// A share in percent.
#[allow(clippy::cast_precision_loss, reason = "counts of scenes")]
fn share(part: usize, of: usize) -> String {
    if of == 0 { "–".to_owned() } else { format!("{:.1} %", 100.0 * part as f64 / of as f64) }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.5)
}

fn of_verdict<'a>(rows: &[&'a CampaignRow], verdict: Verdict) -> Vec<&'a CampaignRow> {
    rows.iter().copied().filter(|row| row.verdict == Some(verdict)).collect()
}

fn count(rows: &[&CampaignRow], wanted: &[Outcome]) -> usize {
    rows.iter().filter(|row| wanted.contains(&outcome(row))).count()
}

fn verdicts(rows: &[&CampaignRow]) -> ChapterPart {
    let of = [("pass", Verdict::Pass), ("review", Verdict::Review), ("fail", Verdict::Fail)]
        .map(|(name, verdict)| (name, of_verdict(rows, verdict)));
    ReportTable::of(&of)
        .text("verdict", |(name, _)| *name)
        .number("scenes", |(_, of)| of.len().to_string())
        .number("share", |(_, of)| share(of.len(), rows.len()))
        .number("speed and k right or held", |(_, of)| {
            count(of, &[Outcome::Right, Outcome::Covered]).to_string()
        })
        .number("missed", |(_, of)| count(of, &[Outcome::Missed]).to_string())
        .into()
}

/// Statement and truth of one quantity over the scenes that have both.
fn pairs<'a>(rows: &'a [&CampaignRow], name: &'a str) -> impl Iterator<Item = (Estimate, f64)> + 'a {
    rows.iter().filter_map(move |row| scored(row, name).and_then(|s| s.stated.zip(s.truth)))
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

fn intervals(rows: &[&CampaignRow]) -> ChapterPart {
    let passed = of_verdict(rows, Verdict::Pass);
    let spreads: Vec<_> = [("passed", &passed[..]), ("all", rows)]
        .into_iter()
        .flat_map(|(name, of)| {
            QUANTITIES.map(|(quantity, shown, relative, decimals)| {
                (name, shown, decimals, Spread::of(pairs(of, quantity), relative))
            })
        })
        .collect();
    ReportTable::of(&spreads)
        .text("scenes", |(name, ..)| *name)
        .text("quantity", |(_, shown, ..)| *shown)
        .number("stated", |(.., spread)| spread.count().to_string())
        .number("error: median", |(_, _, decimals, spread)| number(quantile(&spread.errors, 0.5), *decimals))
        .number("95th", |(_, _, decimals, spread)| number(quantile(&spread.errors, 0.95), *decimals))
        .number("largest", |(_, _, decimals, spread)| number(quantile(&spread.errors, 1.0), *decimals))
        .number("half-width: median", |(_, _, decimals, spread)| {
            number(quantile(&spread.half_widths, 0.5), *decimals)
        })
        .number("holds the truth", |(.., spread)| share(spread.held, spread.count()))
        .into()
}

fn codes(rows: &[&CampaignRow]) -> ChapterPart {
    let mut counts: BTreeMap<(Severity, String), [usize; 3]> = BTreeMap::new();
    for row in rows {
        let grave = row.findings.iter().filter(|finding| finding.1 != Severity::Note);
        let mut codes: Vec<(Severity, String)> =
            grave.map(|finding| (finding.1, code_name(finding.0))).collect();
        codes.sort();
        codes.dedup();
        let is_alone = codes.len() == 1;
        let is_held = matches!(outcome(row), Outcome::Covered);
        for code in codes {
            let count = counts.entry(code).or_default();
            count[0] += 1;
            count[1] += usize::from(is_alone);
            count[2] += usize::from(is_held);
        }
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(count[0]));
    ReportTable::of(&counts)
        .code("finding", |((_, code), _)| &code[..])
        .text("severity", |((severity, _), _)| if *severity == Severity::Error { "error" } else { "warning" })
        .number("scenes", |(_, [all, ..])| all.to_string())
        .number("alone", |(_, [_, alone, _])| alone.to_string())
        .number("numbers hold all the same", |(_, [.., held])| held.to_string())
        .into()
}

/// Whether a scene belongs to a class.
type Belongs = fn(&CampaignRow) -> bool;

fn angle_deg(row: &CampaignRow) -> f64 {
    row.truth.angle_deg
}

fn contact_ms(row: &CampaignRow) -> f64 {
    row.truth.contact_s.map_or(f64::NAN, |s| 1e3 * s)
}

fn flight_ms(row: &CampaignRow) -> f64 {
    row.truth.flight_s.map_or(f64::NAN, |s| 1e3 * s)
}

fn rate_hz(row: &CampaignRow) -> f64 {
    row.scene.channels.first().map_or(f64::NAN, |channel| channel.sample_rate_hz)
}

fn restitution(row: &CampaignRow) -> f64 {
    row.truth.k.unwrap_or(f64::NAN)
}

const CLASSES: [(&str, Belongs); 27] = [
    ("angle below 5°", |row| angle_deg(row) < 5.0),
    ("angle 5 to 30°", |row| (5.0..=30.0).contains(&angle_deg(row))),
    ("angle above 30°", |row| angle_deg(row) > 30.0),
    ("contact below 3 ms", |row| contact_ms(row) < 3.0),
    ("contact 3 to 10 ms", |row| (3.0..=10.0).contains(&contact_ms(row))),
    ("contact above 10 ms", |row| contact_ms(row) > 10.0),
    ("flight below 30 ms", |row| flight_ms(row) < 30.0),
    ("flight 30 to 100 ms", |row| (30.0..=100.0).contains(&flight_ms(row))),
    ("flight above 100 ms", |row| flight_ms(row) > 100.0),
    ("k below 0.1", |row| restitution(row) < 0.1),
    ("k 0.1 to 0.8", |row| (0.1..=0.8).contains(&restitution(row))),
    ("k above 0.8", |row| restitution(row) > 0.8),
    ("rate below 10 kHz", |row| rate_hz(row) < 10e3),
    ("rate 10 to 50 kHz", |row| (10e3..=50e3).contains(&rate_hz(row))),
    ("rate above 50 kHz", |row| rate_hz(row) > 50e3),
    ("one mode", |row| row.scene.modes.len() == 1),
    ("two modes", |row| row.scene.modes.len() == 2),
    ("three modes", |row| row.scene.modes.len() == 3),
    ("drop of 9 m and more", |row| row.stated.drop.height_m >= 9.0),
    ("drop of 3 to 9 m", |row| (3.0..9.0).contains(&row.stated.drop.height_m)),
    ("drop below 3 m", |row| row.stated.drop.height_m < 3.0),
    ("rough", |row| row.stated.contact == Contact::Rough),
    ("smooth", |row| row.stated.contact == Contact::Smooth),
    ("Coulomb", |row| matches!(row.stated.contact, Contact::Coulomb(_))),
    ("with an axial channel", |row| row.scene.channels.iter().any(|c| c.axis == crate::data::Axis::Axial)),
    ("force plateau", |row| row.scene.first_end.yield_n.is_some()),
    ("rest recorded", |row| row.scene.rest),
];

/// Errors of speed and k, and how often their intervals hold.
struct Both {
    speed: Spread,
    k: Spread,
}

fn classes(rows: &[&CampaignRow]) -> ChapterPart {
    let classes = CLASSES.map(|(name, belongs)| {
        let of: Vec<&CampaignRow> = rows.iter().copied().filter(|row| belongs(row)).collect();
        let (speed, k) = (Spread::of(pairs(&of, "speed"), true), Spread::of(pairs(&of, "k"), false));
        (name, Both { speed, k }, of)
    });
    ReportTable::of(&classes)
        .text("class", |(name, ..)| *name)
        .number("scenes", |(.., of)| of.len().to_string())
        .number("pass", |(.., of)| share(of_verdict(of, Verdict::Pass).len(), of.len()))
        .number("speed: 95th, %", |(_, both, _)| number(quantile(&both.speed.errors, 0.95), 2))
        .number("held", |(_, both, _)| share(both.speed.held, both.speed.count()))
        .number("k: 95th", |(_, both, _)| number(quantile(&both.k.errors, 0.95), 4))
        .number("held", |(_, both, _)| share(both.k.held, both.k.count()))
        .number("missed", |(.., of)| count(of, &[Outcome::Missed]).to_string())
        .into()
}

fn ladder(rows: &[&CampaignRow]) -> ChapterPart {
    let rungs = ReconstructionRung::ALL.map(|rung| {
        let had: Vec<_> = rows
            .iter()
            .filter_map(|row| row.candidates.iter().find(|c| c.rung == rung).map(|c| (row.truth, c)))
            .collect();
        let speed = Spread::of(had.iter().filter_map(|(truth, c)| c.speed.zip(truth.speed)), true);
        let k = Spread::of(had.iter().filter_map(|(truth, c)| c.k.zip(truth.k)), false);
        (rung, had.len(), Both { speed, k })
    });
    ReportTable::of(&rungs)
        .text("rung", |(rung, ..)| rung_name(*rung))
        .number("taken", |(rung, ..)| rows.iter().filter(|row| row.rung == Some(*rung)).count().to_string())
        .number("had", |(_, had, _)| had.to_string())
        .number("speed: median, %", |(.., both)| number(quantile(&both.speed.errors, 0.5), 2))
        .number("95th", |(.., both)| number(quantile(&both.speed.errors, 0.95), 2))
        .number("held", |(.., both)| share(both.speed.held, both.speed.count()))
        .number("k: median", |(.., both)| number(quantile(&both.k.errors, 0.5), 4))
        .number("95th", |(.., both)| number(quantile(&both.k.errors, 0.95), 4))
        .number("held", |(.., both)| share(both.k.held, both.k.count()))
        .into()
}

fn redraws(rows: &[&CampaignRow]) -> ChapterPart {
    let mut counts: BTreeMap<&str, u32> = BTreeMap::new();
    for (reason, count) in rows.iter().flat_map(|row| &row.redraws) {
        *counts.entry(reason).or_default() += count;
    }
    let counts: Vec<_> = counts.into_iter().collect();
    ReportTable::of(&counts)
        .text("reason", |(reason, _)| *reason)
        .number("draws", |(_, count)| count.to_string())
        .into()
}

/// The outcomes of every kind of damage, in the order of the kinds, or of every size of it.
#[allow(clippy::cast_precision_loss, reason = "counts of scenes")]
fn damages(rows: &[&CampaignRow], by_size: bool) -> ChapterPart {
    let mut groups: Vec<(&str, String, Vec<&CampaignRow>)> = Vec::new();
    for (kind, sizes, unit) in super::kinds() {
        let of_kind = rows.iter().copied().filter(|row| row.damage.is_some_and(|d| d.kind == kind));
        if by_size {
            for size in sizes {
                let is_size =
                    |row: &&CampaignRow| row.damage.is_some_and(|d| d.size.to_bits() == size.to_bits());
                let shown = if unit.is_empty() { String::new() } else { format!("{size} {unit}") };
                groups.push((kind, shown, of_kind.clone().filter(is_size).collect()));
            }
        } else {
            let largest = sizes.last().copied().unwrap_or_default();
            let shown =
                if unit.is_empty() { String::new() } else { format!("{} to {largest} {unit}", sizes[0]) };
            groups.push((kind, shown, of_kind.collect()));
        }
    }
    groups.retain(|(.., of)| !of.is_empty());
    if !by_size {
        groups.push(("all", String::new(), rows.to_vec()));
    }
    ReportTable::of(&groups)
        .text("damage", |(kind, ..)| *kind)
        .number("size", |(_, size, _)| &size[..])
        .number("scenes", |(.., of)| of.len().to_string())
        .number("right", |(.., of)| count(of, &[Outcome::Right]).to_string())
        .number("covered", |(.., of)| count(of, &[Outcome::Covered]).to_string())
        .number("caught", |(.., of)| count(of, &[Outcome::Caught]).to_string())
        .number("missed", |(.., of)| count(of, &[Outcome::Missed]).to_string())
        .number("missed per 200", |(.., of)| {
            number(200.0 * count(of, &[Outcome::Missed]) as f64 / of.len() as f64, 1)
        })
        .into()
}

/// Limits of what a closure may be missed by, in standard uncertainties.
const LIMITS_U: [f64; 5] = [MISSED_U, 3.0, 2.5, 2.0, 1.5];

/// What each limit would have kept from passing: of sound drops, and of damaged ones that passed and are wrong.
fn limits(undamaged: &[&CampaignRow], damaged: &[&CampaignRow]) -> ChapterPart {
    let passed = of_verdict(undamaged, Verdict::Pass);
    let missed: Vec<&CampaignRow> =
        damaged.iter().copied().filter(|row| outcome(row) == Outcome::Missed).collect();
    let within = |rows: &[&CampaignRow], limit_u: f64| {
        rows.iter().filter(|row| largest_miss_u(row).is_none_or(|miss| miss <= limit_u)).count()
    };
    ReportTable::of(&LIMITS_U)
        .number("limit, u", |limit_u| number(*limit_u, 1))
        .number("sound drops that pass", |limit_u| share(within(&passed, *limit_u), undamaged.len()))
        .number("damaged ones missed", |limit_u| within(&missed, *limit_u).to_string())
        .into()
}

/// Every scene that passed and is wrong.
fn missed(rows: &[CampaignRow]) -> ChapterPart {
    let missed: Vec<&CampaignRow> = rows.iter().filter(|row| outcome(row) == Outcome::Missed).collect();
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
