//! A campaign to the document of its page: what falls out first, then a chapter a cask, then every recording
//! with a link to its report.

use super::series::{DropSeries, Pool, PooledQuantity, RowPlace, scatter_words};
use super::{Batch, BatchRow, MOST_ROWS, MOST_SERIES, compared};
use crate::data::{Program, STANDARD_GRAVITY_M_S2, Verdict};
use crate::report::document::{Chapter, ChapterPart, Frame, PartContent, ReportDocument, Tone};
use crate::report::json::in_a_line;
use crate::report::rounding::{
    MISSING, fixed, interval, optional, optional_fixed, pair, percent, plain, significant,
};
use crate::report::table::{ReportTable, TableCell};
use crate::report::text::{Style, verdict_word};
use std::collections::{BTreeSet, HashMap};

const REPEATS: &str = "Mean of the repeats that do not fall out, weighted with 1/u². Its interval is that of \
                       one drop: repeats share what is \
                       stated of cask, angle and sensors, and no mean makes that smaller. Scatter: the \
                       standard deviation. χ² of the \
                       stated intervals says whether it is as large as they say; where repeats share most of \
                       what is uncertain it is smaller.";

/// The page.
pub(super) fn document(batch: &Batch, series: &[DropSeries]) -> ReportDocument {
    let count = |verdict| batch.rows.iter().filter(|row| row.verdict == verdict).count();
    let (pass, review, fail) =
        (count(Some(Verdict::Pass)), count(Some(Verdict::Review)), count(Some(Verdict::Fail)));
    let failed = count(None);
    let angles =
        series.iter().flat_map(|series| &series.pools).filter_map(|pool| pool.angle_deg.map(f64::to_bits));
    let angles = angles.collect::<BTreeSet<u64>>().len();
    let worst = match (fail + failed, review) {
        (0, 0) => Style::Green,
        (0, _) => Style::Yellow,
        _ => Style::Red,
    };
    let banner = Tone(worst, format!("{pass} of {}", batch.rows.len()));
    let words =
        format!("sound; {review} to look at, {fail} not to be used, {failed} that could not be analysed.");
    let mut chapters = vec![Chapter::new("").with(PartContent::Banner(banner, words)), apart(series)];
    chapters.extend(both(batch));
    chapters.extend(series.iter().take(MOST_SERIES).enumerate().map(|(i, series)| of_series(series, i + 1)));
    let more =
        format!("The first {MOST_SERIES} of {} casks: campaign.json has the pools of all.", series.len());
    chapters.extend((series.len() > MOST_SERIES).then(|| Chapter::new("").with(ChapterPart::note(more))));
    chapters.push(recordings(batch, series));
    ReportDocument {
        page: Frame {
            title: format!("Campaign {}", batch.source),
            product: "Campaign of drop tests",
            version: Program::this().version.to_owned(),
            heading: batch.source.clone(),
            about: format!("{} recordings · {} casks · {angles} angles", batch.rows.len(), series.len()),
            footer: "campaign.csv and campaign.json hold every input and result of every recording as \
                     numbers; each recording has its own report.",
            style: include_str!("../live/campaign.css"),
            script: include_str!("../live/campaign.js"),
            data: data(batch),
            ..Frame::default()
        },
        chapters,
    }
}

/// The quantities of all rows for the script that compares two of them.
fn data(batch: &Batch) -> String {
    let quantities = |row: &BatchRow| -> Vec<serde_json::Value> {
        let numbers = row.quantities.iter().map(|quantity| (&quantity.name, quantity.estimate));
        numbers.map(|(name, e)| serde_json::json!([name, e.value, e.u95, e.unit])).collect()
    };
    let rows: Vec<_> = batch.rows.iter().take(MOST_ROWS).map(quantities).collect();
    in_a_line(&rows).unwrap_or_default().replace('<', "\\u003c")
}

/// Where just two gave a result: what they differ by.
fn both(batch: &Batch) -> Option<Chapter> {
    let usable: Vec<&BatchRow> = batch.rows.iter().filter(|row| row.verdict.is_some()).collect();
    let [a, b] = usable[..] else { return None };
    Some(Chapter::new("What the two differ by").with(compared::table(a, b)))
}

/// A row that does not fit, and why.
struct Oddity<'a> {
    row: &'a BatchRow,
    size: f64,
    why: String,
}

/// Points that fall out of their repeats, or lie outside both intervals of measurement and prediction.
fn apart(series: &[DropSeries]) -> Chapter {
    let mut found: Vec<Oddity> = Vec::new();
    for (series, pool) in series.iter().flat_map(|series| series.pools.iter().map(move |pool| (series, pool)))
    {
        for member in pool.members.iter().filter(|member| member.is_out && pool.angle_deg.is_some()) {
            let e_n = member.e_n.unwrap_or_default();
            let (name, own) =
                (quantity_words(pool.quantity), interval(pool.quantity.of(member.row).as_ref()));
            let place = format!("{} at {}°", series.name, plain(pool.angle_deg.unwrap_or_default(), 4));
            let against = match pool.members.len() {
                2 => "contradicts the other repeat".to_owned(),
                count => format!("falls out of the {} other repeats", count - 1),
            };
            let why = format!("{name} {own} {against} of {place}, E_n = {}", fixed(e_n, 1));
            found.push(Oddity { row: member.row, size: e_n.abs(), why });
        }
    }
    let disagree =
        series.iter().flat_map(|series| &series.rows).filter(|row| row.comparison.is_some_and(|c| !c.agrees));
    for row in disagree {
        let by = percent(row.comparison.map(|c| c.difference_percent));
        let why = format!("measured over predicted {by}: outside both intervals");
        found.push(Oddity { row, size: 0.0, why });
    }
    found.sort_by(|a, b| b.size.total_cmp(&a.size));
    let table = ReportTable::of(&found)
        .caption("The largest E_n first. One in twenty sound drops lies outside a 95 % interval by chance.")
        .head("test", |odd| linked(odd.row))
        .text("why", |odd| odd.why.clone())
        .text("findings", |odd| odd.row.codes.join(", "))
        .most(MOST_ROWS, 50, "the column E_n of the recordings");
    let chapter = Chapter::new("Points that fall out");
    if found.is_empty() { chapter.with(ChapterPart::text("None.")) } else { chapter.with(table) }
}

fn of_series(series: &DropSeries, number: usize) -> Chapter {
    let pool = |pool: &Pool| {
        let angle = pool.angle_deg.map_or_else(|| "all".to_owned(), |angle| format!("{}°", plain(angle, 4)));
        format!("{} at {angle}", quantity_words(pool.quantity))
    };
    let unit = |pool: &Pool| if pool.quantity == PooledQuantity::K { "" } else { " m/s" };
    let word = |pool: &Pool| pool.pooled.word().map_or(MISSING, scatter_words);
    let repeats = ReportTable::of(&series.pools)
        .caption("Repeats")
        .head("quantity", pool)
        .number("drops", |pool| match pool.members.len() - pool.pooled.count {
            0 => pool.pooled.count.to_string(),
            _ => format!("{} of {}", pool.pooled.count, pool.members.len()),
        })
        .number("mean", |pool| pair(pool.pooled.mean, pool.pooled.u95, "1") + unit(pool))
        .number("scatter", |pool| {
            significant(pool.pooled.scatter, 2) + if pool.pooled.count > 1 { unit(pool) } else { "" }
        })
        .number("stated u", |pool| significant(pool.pooled.u95 / 1.96, 2) + unit(pool))
        .number("χ² (degrees)", |pool| match pool.pooled.count {
            1 => MISSING.to_owned(),
            count => format!("{} ({})", significant(pool.pooled.chi_square, 2), count - 1),
        })
        .text("scatter is", word);
    Chapter::new(series.name.clone())
        .with_all(["speed", "k"].map(|what| ChapterPart::picture(&DropSeries::name_of(number, what), "")))
        .with(repeats)
        .with(ChapterPart::note(REPEATS))
}

fn quantity_words(quantity: PooledQuantity) -> &'static str {
    match quantity {
        PooledQuantity::K => "k",
        PooledQuantity::Speed => "slap-down speed",
    }
}

/// A row's name, leading to its report.
fn linked(row: &BatchRow) -> TableCell {
    TableCell::linked(row.id.clone(), row.report.as_deref().map(encoded).unwrap_or_default())
}

/// A path as a relative address.
fn encoded(path: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
    path.bytes()
        .map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") })
        .collect()
}

fn recordings(batch: &Batch, series: &[DropSeries]) -> Chapter {
    let places: HashMap<u32, RowPlace> =
        series.iter().flat_map(|s| s.rows.iter().map(|row| (row.at.number, s.place(row)))).collect();
    let e_n = |row: &BatchRow, quantity: PooledQuantity| {
        let e_n = places.get(&row.at.number).and_then(|place| place.e_n[quantity as usize]);
        optional_fixed(e_n, 2)
    };
    let both = |values: [Option<f64>; 2], factor: f64| {
        values.map(|value| optional(value.map(|value| value / factor), 3)).join(" · ")
    };
    let tag = |row: &BatchRow| {
        let (style, word) = match row.verdict {
            Some(Verdict::Pass) => (Style::Green, "sound"),
            Some(verdict @ Verdict::Review) => (Style::Yellow, verdict_word(verdict)),
            Some(verdict @ Verdict::Fail) => (Style::Red, verdict_word(verdict)),
            None => (Style::Red, "error"),
        };
        TableCell::toned(style, word.to_lowercase())
    };
    let shown = &batch.rows[..batch.rows.len().min(MOST_ROWS)];
    let table = ReportTable::of(shown)
        .class("many sortable")
        .head("test", linked)
        .text("verdict", tag)
        .soft("cask", |row| row.at.cask.clone())
        .number("angle °", |row| {
            row.at.angle_deg.map_or_else(|| MISSING.to_owned(), |angle| plain(angle, 4))
        })
        .soft("date", |row| row.at.date.as_deref().map_or("", |date| date.get(..10).unwrap_or(date)))
        .number("speed m/s", |row| interval(row.slap_down_speed.as_ref()).replace(" m/s", ""))
        .number("k", |row| interval(row.k.as_ref()))
        .number("measured / predicted", |row| percent(row.comparison.map(|c| c.difference_percent)))
        .number("E_n of k", |row| e_n(row, PooledQuantity::K))
        .number("E_n of speed", |row| e_n(row, PooledQuantity::Speed))
        .number("peaks g", |row| both(row.at.peaks_m_s2, STANDARD_GRAVITY_M_S2))
        .number("energies kJ", |row| both(row.at.energies_j, 1e3))
        .text("findings", |row| row.error.clone().unwrap_or_else(|| row.codes.join(", ")));
    let more = (shown.len() < batch.rows.len())
        .then(|| ChapterPart::note(format!("The first {MOST_ROWS}: campaign.csv has all of them.")));
    Chapter::new("Recordings").with_all(more).with(table).with(ChapterPart::note(
        "E_n against the other repeats at the angle; within ±1 they agree. Peaks: largest deceleration \
             of the struck end of the rigid \
             body, and energies absorbed, in the first and the second impact.",
    ))
}
