//! A campaign to the tables that say how far off the analysis is, how often its intervals hold, and how often it says so.

use super::score::{code_name, rung_name};
use super::statistics::{Outcome, Spread, largest_miss_u, outcome, quantile, scored};
use super::table::{Table, number, share};
use crate::data::{Contact, Estimate, MISSED_U, ReconstructionRung, Severity, Verdict};
use crate::lab::data::{Campaign, CampaignRow, Damage};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The whole as Markdown.
#[must_use]
pub fn markdown(campaign: &Campaign) -> String {
    let (undamaged, damaged): (Vec<&CampaignRow>, Vec<&CampaignRow>) =
        campaign.rows.iter().partition(|row| row.damage.is_none());
    let request = &campaign.request;
    let mut text = format!(
        "{} undamaged and {} damaged scenes, seed {}{}; one analysis takes {} ms (median).\n",
        undamaged.len(),
        damaged.len(),
        request.seed,
        if request.exact { ", what is stated exactly true" } else { "" },
        number(1e3 * median(campaign.rows.iter().map(|row| row.analysis_s)), 1),
    );
    if !undamaged.is_empty() {
        section(&mut text, "Undamaged scenes", &verdicts(&undamaged));
        section(&mut text, "Errors and intervals", &intervals(&undamaged));
        section(&mut text, "What keeps undamaged scenes from passing", &codes(&undamaged));
        section(&mut text, "By class", &classes(&undamaged));
        section(&mut text, "Rungs of the reconstruction", &ladder(&undamaged));
        section(&mut text, "Drops drawn and left out", &redraws(&undamaged));
    }
    if !damaged.is_empty() {
        section(&mut text, "Damaged scenes, by kind", &damages(&damaged, false));
        section(&mut text, "Damaged scenes, by kind and size", &damages(&damaged, true));
    }
    if !undamaged.is_empty() && !damaged.is_empty() {
        section(&mut text, "What a stricter limit of the closures would do", &limits(&undamaged, &damaged));
    }
    section(&mut text, "Passed and wrong", &missed(&campaign.rows));
    text
}

fn section(text: &mut String, title: &str, table: &str) {
    // Writing to a string does not fail.
    let _ = write!(text, "\n### {title}\n\n{table}");
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.5)
}

fn of_verdict<'a>(rows: &[&'a CampaignRow], verdict: Verdict) -> Vec<&'a CampaignRow> {
    rows.iter().copied().filter(|row| row.verdict == Some(verdict)).collect()
}

fn verdicts(rows: &[&CampaignRow]) -> String {
    let mut table = Table::new(&["verdict", "scenes", "share", "speed and k right or held", "missed"]);
    for (name, verdict) in [("pass", Verdict::Pass), ("review", Verdict::Review), ("fail", Verdict::Fail)] {
        let of = of_verdict(rows, verdict);
        let count = |wanted: &[Outcome]| of.iter().filter(|row| wanted.contains(&outcome(row))).count();
        table.row([
            name.to_owned(),
            of.len().to_string(),
            share(of.len(), rows.len()),
            count(&[Outcome::Right, Outcome::Covered]).to_string(),
            count(&[Outcome::Missed]).to_string(),
        ]);
    }
    table.finish()
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

fn intervals(rows: &[&CampaignRow]) -> String {
    let mut table = Table::new(&[
        "scenes",
        "quantity",
        "stated",
        "error: median",
        "95th",
        "largest",
        "half-width: median",
        "holds the truth",
    ]);
    let passed = of_verdict(rows, Verdict::Pass);
    for (name, of) in [("passed", &passed[..]), ("all", rows)] {
        for (quantity, shown, relative, decimals) in QUANTITIES {
            let spread = Spread::of(pairs(of, quantity), relative);
            table.row([
                name.to_owned(),
                shown.to_owned(),
                spread.count().to_string(),
                number(quantile(&spread.errors, 0.5), decimals),
                number(quantile(&spread.errors, 0.95), decimals),
                number(quantile(&spread.errors, 1.0), decimals),
                number(quantile(&spread.half_widths, 0.5), decimals),
                share(spread.held, spread.count()),
            ]);
        }
    }
    table.finish()
}

fn codes(rows: &[&CampaignRow]) -> String {
    let mut counts: BTreeMap<(Severity, String), [usize; 3]> = BTreeMap::new();
    for row in rows {
        let mut codes: Vec<(Severity, String)> = row
            .findings
            .iter()
            .filter(|finding| finding.1 != Severity::Note)
            .map(|finding| (finding.1, code_name(finding.0)))
            .collect();
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
    let mut table = Table::new(&["finding", "severity", "scenes", "alone", "numbers hold all the same"]);
    for ((severity, code), [all, alone, held]) in counts {
        let severity = if severity == Severity::Error { "error" } else { "warning" };
        table.row([
            format!("`{code}`"),
            severity.to_owned(),
            all.to_string(),
            alone.to_string(),
            held.to_string(),
        ]);
    }
    table.finish()
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

fn classes(rows: &[&CampaignRow]) -> String {
    let mut table =
        Table::new(&["class", "scenes", "pass", "speed: 95th, %", "held", "k: 95th", "held", "missed"]);
    for (name, belongs) in CLASSES {
        let of: Vec<&CampaignRow> = rows.iter().copied().filter(|row| belongs(row)).collect();
        let speed = Spread::of(pairs(&of, "speed"), true);
        let k = Spread::of(pairs(&of, "k"), false);
        table.row([
            name.to_owned(),
            of.len().to_string(),
            share(of_verdict(&of, Verdict::Pass).len(), of.len()),
            number(quantile(&speed.errors, 0.95), 2),
            share(speed.held, speed.count()),
            number(quantile(&k.errors, 0.95), 4),
            share(k.held, k.count()),
            of.iter().filter(|row| outcome(row) == Outcome::Missed).count().to_string(),
        ]);
    }
    table.finish()
}

fn ladder(rows: &[&CampaignRow]) -> String {
    let mut table = Table::new(&[
        "rung",
        "taken",
        "had",
        "speed: median, %",
        "95th",
        "held",
        "k: median",
        "95th",
        "held",
    ]);
    for rung in ReconstructionRung::ALL {
        let had: Vec<_> = rows
            .iter()
            .filter_map(|row| row.candidates.iter().find(|c| c.rung == rung).map(|c| (row.truth, c)))
            .collect();
        let speed = Spread::of(had.iter().filter_map(|(truth, c)| c.speed.zip(truth.speed)), true);
        let k = Spread::of(had.iter().filter_map(|(truth, c)| c.k.zip(truth.k)), false);
        table.row([
            rung_name(rung).to_owned(),
            rows.iter().filter(|row| row.rung == Some(rung)).count().to_string(),
            had.len().to_string(),
            number(quantile(&speed.errors, 0.5), 2),
            number(quantile(&speed.errors, 0.95), 2),
            share(speed.held, speed.count()),
            number(quantile(&k.errors, 0.5), 4),
            number(quantile(&k.errors, 0.95), 4),
            share(k.held, k.count()),
        ]);
    }
    table.finish()
}

fn redraws(rows: &[&CampaignRow]) -> String {
    let mut counts: BTreeMap<&str, u32> = BTreeMap::new();
    for (reason, count) in rows.iter().flat_map(|row| &row.redraws) {
        *counts.entry(reason).or_default() += count;
    }
    let mut table = Table::new(&["reason", "draws"]);
    for (reason, count) in counts {
        table.row([reason.to_owned(), count.to_string()]);
    }
    table.finish()
}

/// The outcomes of every kind of damage, in the order of the kinds, and of every size of it.
fn damages(rows: &[&CampaignRow], by_size: bool) -> String {
    let mut table =
        Table::new(&["damage", "size", "scenes", "right", "covered", "caught", "missed", "missed per 200"]);
    let is = |row: &CampaignRow, kind: &str, size: Option<f64>| {
        row.damage.is_some_and(|d: Damage| {
            d.kind == kind && size.is_none_or(|size| d.size.to_bits() == size.to_bits())
        })
    };
    for (kind, sizes, unit) in super::kinds() {
        let wanted: Vec<Option<f64>> =
            if by_size { sizes.iter().map(|size| Some(*size)).collect() } else { vec![None] };
        for size in wanted {
            let of: Vec<&CampaignRow> = rows.iter().copied().filter(|row| is(row, kind, size)).collect();
            let shown = match size {
                Some(size) if !unit.is_empty() => format!("{size} {unit}"),
                None if !unit.is_empty() => {
                    format!("{} to {} {unit}", sizes[0], sizes.last().copied().unwrap_or_default())
                }
                _ => String::new(),
            };
            if !of.is_empty() {
                table.row(outcomes(kind, shown, &of));
            }
        }
    }
    if !by_size {
        table.row(outcomes("all", String::new(), rows));
    }
    table.finish()
}

#[allow(clippy::cast_precision_loss, reason = "counts of scenes")]
fn outcomes(kind: &str, size: String, rows: &[&CampaignRow]) -> Vec<String> {
    let count = |wanted| rows.iter().filter(|row| outcome(row) == wanted).count();
    let missed = count(Outcome::Missed);
    vec![
        kind.to_owned(),
        size,
        rows.len().to_string(),
        count(Outcome::Right).to_string(),
        count(Outcome::Covered).to_string(),
        count(Outcome::Caught).to_string(),
        missed.to_string(),
        number(200.0 * missed as f64 / rows.len() as f64, 1),
    ]
}

/// Limits of what a closure may be missed by, in standard uncertainties.
const LIMITS_U: [f64; 5] = [MISSED_U, 3.0, 2.5, 2.0, 1.5];

/// What each limit would have kept from passing: of sound drops, and of damaged ones that passed and are wrong.
fn limits(undamaged: &[&CampaignRow], damaged: &[&CampaignRow]) -> String {
    let passed = of_verdict(undamaged, Verdict::Pass);
    let missed: Vec<&CampaignRow> =
        damaged.iter().copied().filter(|row| outcome(row) == Outcome::Missed).collect();
    let mut table = Table::new(&["limit, u", "sound drops that pass", "damaged ones missed"]);
    for limit_u in LIMITS_U {
        let within = |rows: &[&CampaignRow]| {
            rows.iter().filter(|row| largest_miss_u(row).is_none_or(|miss| miss <= limit_u)).count()
        };
        table.row([number(limit_u, 1), share(within(&passed), undamaged.len()), within(&missed).to_string()]);
    }
    table.finish()
}

/// Every scene that passed and is wrong.
fn missed(rows: &[CampaignRow]) -> String {
    let mut table = Table::new(&["scene", "damage", "speed", "true", "k", "true"]);
    let mut any = false;
    for row in rows.iter().filter(|row| outcome(row) == Outcome::Missed) {
        any = true;
        let damage = row.damage.map_or_else(
            || "none".to_owned(),
            |d| {
                format!(
                    "{} {} {}",
                    d.kind,
                    if d.unit.is_empty() { String::new() } else { d.size.to_string() },
                    d.unit
                )
            },
        );
        let shown = |name: &str, decimals| {
            let scored = scored(row, name);
            let stated = scored.and_then(|s| s.stated).map_or_else(
                || "–".to_owned(),
                |e| format!("{} ± {}", number(e.value, decimals), number(e.u95, decimals)),
            );
            [stated, number(scored.and_then(|s| s.truth).unwrap_or(f64::NAN), decimals)]
        };
        let (speed, k) = (shown("speed", 3), shown("k", 4));
        table.row([row.number.to_string(), damage.trim().to_owned()].into_iter().chain(speed).chain(k));
    }
    if any { table.finish() } else { "None.\n".to_owned() }
}
