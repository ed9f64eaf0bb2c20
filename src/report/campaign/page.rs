//! Page of a campaign: outliers and unusable results first, then a chapter per cask, then every recording
//! with a link to its report.

use super::columns::NamedQuantity;
use super::series::{DropSeries, Pool, PooledQuantity, RowPlace, is_usable, scatter_words};
use super::summary::{Oddity, first_five, oddities, tag};
use super::{Batch, BatchRow, MOST_ROWS, MOST_SERIES};
use crate::data::{STANDARD_GRAVITY_M_S2, Verdict};
use crate::report::document::{
    Chapter, ChapterPart, Frame, PartContent, ReportDocument, ReportTable, TableCell, Tone,
};
use crate::report::json::to_line;
use crate::report::rounding::{
    MISSING, interval, optional, optional_fixed, pair, percent, plain, significant,
};
use crate::report::text::{Style, plural};
use serde_json::{Value, json};
use std::collections::{BTreeSet, HashMap};

const REPEATS: &str = "Drops at angles within their tolerance of each other are repeats; k holds for one \
                       angle. Mean of the repeats without outliers, weighted with 1/u². Its interval is that \
                       of one drop: repeats share what is stated of cask, angle and sensors, and no mean \
                       makes that smaller. Scatter: the standard deviation. χ² of the stated intervals says \
                       whether it is as large as they say; where repeats share most of what is uncertain it \
                       is smaller.";

/// The page.
pub(super) fn document(batch: &Batch, series: &[DropSeries]) -> ReportDocument {
    let count = |verdict| batch.rows.iter().filter(|row| row.verdict == verdict).count();
    let (pass, review) = (count(Some(Verdict::Pass)), count(Some(Verdict::Review)));
    let odd = oddities(series);
    let count = batch.rows.len();
    let exceeded = batch.rows.iter().filter(|row| !row.exceeded.is_empty()).count();
    let worst = match (count - pass - review + exceeded, review + odd.len()) {
        (0, 0) => Style::Green,
        (0, _) => Style::Yellow,
        _ => Style::Red,
    };
    let banner = Tone(worst, format!("{pass} of {count} sound"));
    let angles = series.iter().flat_map(|series| &series.pools).map(|pool| pool.angles_deg[0].to_bits());
    let angles = angles.collect::<BTreeSet<u64>>().len();
    let heading = format!("Drop tests: {}", first_five(series.iter().map(|series| series.name.clone())));
    let banner = Chapter::new("").then(PartContent::Banner(banner, batch.sum(&odd)));
    let mut chapters = vec![banner, outliers(&odd)];
    chapters.extend(reasons(batch));
    chapters.extend(series.iter().take(MOST_SERIES).enumerate().map(|(i, series)| describe(series, i + 1)));
    let more =
        format!("The first {MOST_SERIES} of {} casks: campaign.json has the pools of all.", series.len());
    chapters.extend((series.len() > MOST_SERIES).then(|| Chapter::new("").then(ChapterPart::note(more))));
    let places = DropSeries::places(series);
    let rows = in_order(batch, &places);
    chapters.push(recordings(batch, &rows, &places));
    ReportDocument {
        page: Frame {
            title: format!("{heading} · {}", batch.source),
            product: "Campaign of drop tests",
            heading,
            about: [
                batch.source.clone(),
                plural(count, "recording"),
                plural(series.len(), "cask"),
                plural(angles, "angle"),
            ]
            .join(" · "),
            footer: "campaign.csv and campaign.json have the results and settings of every recording as \
                     numbers; each recording has its own report.",
            style: include_str!("../live/campaign.css"),
            script: include_str!("../live/campaign.js"),
            data: data(&rows),
            ..Frame::default()
        },
        chapters,
    }
}

/// Rows in the order of the list: the farthest outlier first, then recordings without a result, then the
/// others.
fn in_order<'a>(batch: &'a Batch, places: &HashMap<u32, RowPlace>) -> Vec<&'a BatchRow> {
    let key = |row: &BatchRow| match places.get(&row.at.number) {
        Some(place) if place.is_out => -place.e_n.into_iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs())),
        Some(_) if is_usable(row) => 3.0,
        Some(_) => 2.0,
        None => 1.0,
    };
    let mut rows: Vec<&BatchRow> = batch.rows.iter().collect();
    rows.sort_by(|a, b| key(a).total_cmp(&key(b)));
    rows.truncate(MOST_ROWS);
    rows
}

/// Quantities and curves of the rows for the script that compares two of them.
fn data(rows: &[&BatchRow]) -> String {
    let row = |row: &&BatchRow| {
        let numbers = row
            .quantities
            .iter()
            .map(|NamedQuantity { name, estimate: e }| json!([name, e.value, e.u95, e.unit]));
        json!({"numbers": numbers.collect::<Vec<_>>(), "curves": row.curves})
    };
    let rows: Vec<_> = rows.iter().map(row).collect();
    to_line(&rows).unwrap_or_default().replace('<', "\\u003c")
}

/// The day of a test.
fn date(row: &BatchRow) -> Option<&str> {
    row.at.date.as_deref().map(|date| date.get(..10).unwrap_or(date))
}

/// Drops that disagree with their repeats, or lie outside both intervals of measurement and prediction.
fn outliers(odd: &[Oddity]) -> Chapter {
    let table = ReportTable::from_rows(odd)
        .caption("The largest E_n first. One in twenty sound drops lies outside a 95 % interval by chance.")
        .head("test", |odd| link_cell(odd.row))
        .text("why", |odd| format!("{}: {}", odd.what, odd.against))
        .text("findings", |odd| odd.row.codes.join(", "))
        .show_if(odd.iter().any(|odd| !odd.row.codes.is_empty()))
        .limit_rows(MOST_ROWS, 50, "the column E_n of the recordings");
    let chapter = Chapter::new("Outliers");
    if odd.is_empty() { chapter.then(ChapterPart::text("None.")) } else { chapter.then(table) }
}

/// Chapter on recordings without a result, and on findings in the others, grouped by reason.
fn reasons(batch: &Batch) -> Option<Chapter> {
    let name = |rows: &[&BatchRow]| match rows {
        [row] => link_cell(row),
        rows => first_five(rows.iter().map(|row| row.id.clone())).into(),
    };
    let any = batch.rows.iter().any(|row| !row.reason().is_empty());
    any.then(|| Chapter::new("Not analysed, or with findings").then(batch.reasons(name)))
}

fn describe(series: &DropSeries, number: usize) -> Chapter {
    let pool = |pool: &Pool| format!("{} at {}", pool.quantity.words()[2], pool.angle_words());
    let unit = |pool: &Pool| if pool.quantity == PooledQuantity::K { "" } else { " m/s" };
    let word = |pool: &Pool| match pool.pooled.word() {
        _ if pool.is_contradictory() => "that of drops which contradict each other",
        word => word.map_or(MISSING, scatter_words),
    };
    let repeats = ReportTable::from_rows(&series.pools)
        .caption("Repeats")
        .head("quantity", pool)
        .number("drops", |pool| match pool.members.len() - pool.pooled.count {
            0 => pool.pooled.count.to_string(),
            _ => format!("{} of {}", pool.pooled.count, pool.members.len()),
        })
        .number("mean", |pool| {
            if pool.is_contradictory() {
                return MISSING.to_owned();
            }
            pair(pool.pooled.mean, pool.pooled.u95, "1") + unit(pool)
        })
        .number("scatter", |pool| {
            significant(pool.pooled.scatter, 2) + if pool.pooled.count > 1 { unit(pool) } else { "" }
        })
        .number("stated u", |pool| significant(pool.pooled.u95 / 1.96, 2) + unit(pool))
        .number("χ² (degrees)", |pool| match pool.pooled.count {
            1 => MISSING.to_owned(),
            count => format!("{} ({})", significant(pool.pooled.chi_square, 2), count - 1),
        })
        .text("scatter is", word);
    let chapter = Chapter::new(series.name.clone());
    if series.pools.is_empty() {
        return chapter.then(ChapterPart::text("No recording of this cask gave a number."));
    }
    let name = |quantity| ChapterPart::picture(&DropSeries::picture_name(number, quantity), "");
    chapter.with_all(series.drawn_quantities().map(name)).then(repeats)
}

/// A row's name, leading to its report.
fn link_cell(row: &BatchRow) -> TableCell {
    let link = row.report.as_deref().map(encode_path).unwrap_or_default();
    TableCell { link, ..row.id.clone().into() }
}

/// A path as a relative address.
fn encode_path(path: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
    path.bytes()
        .map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") })
        .collect()
}

fn recordings(batch: &Batch, rows: &[&BatchRow], places: &HashMap<u32, RowPlace>) -> Chapter {
    let place = |row: &BatchRow| places.get(&row.at.number).copied().unwrap_or_default();
    let e_n = |row: &BatchRow, quantity: PooledQuantity| optional_fixed(place(row).e_n[quantity as usize], 2);
    let scaled = |values: [Option<f64>; 2], factor: f64| {
        values.map(|value| optional(value.map(|value| value / factor), 3)).join(" · ")
    };
    let table = ReportTable::from_rows(rows)
        .class("many sortable")
        .mark_chosen(|row| place(row).is_out)
        .head("test", |row| TableCell {
            mark: ["", "outlier"][usize::from(place(row).is_out)],
            ..link_cell(row)
        })
        .line("recording", |row| row.recording.rsplit('/').next().unwrap_or_default())
        .show_if(batch.has_ids())
        .tag("verdict", |row| tag(row))
        .line("cask", |row| row.at.cask.clone())
        .number("angle °", |row| {
            row.at.angle_deg.map_or_else(|| MISSING.to_owned(), |angle| plain(angle, 4))
        })
        .line("date", |row| date(row).unwrap_or_default())
        .number("speed m/s", |row| interval(row.slap_down_speed.as_ref()).replace(" m/s", ""))
        .number("k", |row| interval(row.k.as_ref()))
        .number("measured / predicted", |row| percent(row.comparison.map(|c| c.difference_percent)))
        .number("E_n of k", |row| e_n(row, PooledQuantity::K))
        .number("E_n of speed", |row| e_n(row, PooledQuantity::Speed))
        .number("peaks g", |row| scaled(row.at.peaks_m_s2, STANDARD_GRAVITY_M_S2))
        .number("energies kJ", |row| scaled(row.at.energies_j, 1e3))
        .text("findings", |row| row.codes.join(", "))
        .show_if(rows.iter().any(|row| !row.codes.is_empty()));
    let table = batch.carried.iter().fold(table, |table, name| {
        table.line(&name[..], |row| row.carried.get(name).and_then(Value::as_str).unwrap_or_default())
    });
    let more = (rows.len() < batch.rows.len())
        .then(|| ChapterPart::note(format!("The first {MOST_ROWS}: campaign.csv has all of them.")));
    let columns = "Outliers first, then those with errors. E_n against the other repeats at the angle; \
                   within ±1 they agree. Peaks: largest deceleration of the struck end of the rigid body, \
                   and energies absorbed, in the first and the second impact.";
    let notes = [REPEATS, columns].map(ChapterPart::note);
    Chapter::new("Recordings").with_all(more).then(table).with_all(notes)
}
