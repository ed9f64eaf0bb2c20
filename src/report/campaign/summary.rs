//! Summary of a campaign and its table on the terminal: numbers of recordings by verdict, drops that do not
//! fit, and findings.

use super::series::DropSeries;
use super::{Batch, BatchRow};
use crate::data::{Estimate, Verdict};
use crate::report::document::{Chapter, ChapterPart, ReportDocument, ReportTable, TableCell, TableShape};
use crate::report::rounding::{MISSING, fixed, interval, percent, plain};
use crate::report::text::{Style, plural, tail, verdict_style, verdict_word};
use std::cmp::Reverse;
use std::collections::HashSet;
use std::path::Path;

/// Most rows on a terminal: a program must read more.
pub(super) const MOST_LINES: usize = 200;

/// A drop that does not fit.
pub(super) struct Oddity<'a> {
    pub(super) row: &'a BatchRow,
    /// |E_n| against the other repeats; 0 for a drop that only disagrees with its prediction.
    size: f64,
    /// The quantity, and the value with which it disagrees.
    pub(super) what: String,
    pub(super) against: String,
}

/// Drops that disagree with their repeats, the largest E_n first, then those that lie outside both intervals
/// of measurement and prediction.
pub(super) fn oddities<'a>(series: &[DropSeries<'a>]) -> Vec<Oddity<'a>> {
    let mut found: Vec<Oddity> = Vec::new();
    for (series, pool) in series.iter().flat_map(|series| series.pools.iter().map(move |pool| (series, pool)))
    {
        for member in pool.members.iter().filter(|member| member.is_out) {
            let e_n = member.e_n.unwrap_or_default();
            let (name, own) = (pool.quantity.words()[2], interval(pool.quantity.value(member.row).as_ref()));
            let place = format!("{} at {}", series.name, pool.angle_words());
            let others = match pool.members.len() {
                2 => "the other repeat".to_owned(),
                count => format!("the {} other repeats", count - 1),
            };
            let words = format!("{name} {own}, E_n {}", fixed(e_n, 2));
            let against = format!("disagrees with {others} of {place}");
            found.push(Oddity { row: member.row, size: e_n.abs(), what: words, against });
        }
    }
    let disagree =
        series.iter().flat_map(|series| &series.rows).filter(|row| row.comparison.is_some_and(|c| !c.agrees));
    for row in disagree {
        let by = percent(row.comparison.map(|c| c.difference_percent));
        let (what, against) = (format!("measured over predicted {by}"), "outside both intervals".to_owned());
        found.push(Oddity { row, size: 0.0, what, against });
    }
    found.sort_by(|a, b| b.size.total_cmp(&a.size));
    found
}

/// Lists the first five of these, and the number of further ones.
pub(super) fn first_five(names: impl Iterator<Item = String>) -> String {
    let names: Vec<String> = names.collect();
    let shown = names[..names.len().min(5)].join(", ");
    if names.len() <= 5 { shown } else { format!("{shown} and {} more", names.len() - 5) }
}

/// A number that the row has.
fn number(row: &BatchRow) -> Option<Estimate> {
    row.k.or(row.slap_down_speed)
}

/// The verdict on a row.
pub(super) fn tag(row: &BatchRow) -> TableCell {
    let (style, word) = match row.verdict {
        Some(Verdict::Pass) => (Style::Green, "sound"),
        Some(verdict) => (verdict_style(verdict), verdict_word(verdict, number(row))),
        None => (Style::Red, "error"),
    };
    TableCell::tone(style, word.to_lowercase())
}

impl Batch {
    /// Counts recordings by verdict and beyond a limit, outliers, and recordings that are listed twice.
    pub(super) fn sum(&self, odd: &[Oddity]) -> String {
        let count = |verdict| self.rows.iter().filter(|row| row.verdict == verdict).count();
        let [sound, review, fail] = [Verdict::Pass, Verdict::Review, Verdict::Fail].map(|v| count(Some(v)));
        // The worst number of each is listed.
        let mut listed = HashSet::new();
        let outliers = odd.iter().filter(|odd| odd.size > 0.0 && listed.insert(odd.row.at.number));
        let outliers = first_five(outliers.map(|odd| format!("{} ({})", odd.row.id, odd.what)));
        let outliers = if outliers.is_empty() { "none" } else { &outliers };
        let named = |row: &BatchRow| Some(format!("{} is {}", row.id, row.same_recording_as.as_ref()?));
        let again = first_five(self.rows.iter().filter_map(named));
        let again = if again.is_empty() { again } else { format!(" Listed twice, counted once: {again}.") };
        let exceeded = self.rows.iter().filter(|row| !row.exceeded.is_empty()).count();
        let (all, failed) = (plural(self.rows.len(), "recording"), count(None));
        format!(
            "{all}: {sound} sound, {review} for review, {fail} partly or not usable, {failed} not \
             analysed, {exceeded} beyond a limit. Outliers: {outliers}.{again}"
        )
    }

    /// Rows with an error or warning, the most severe first, grouped by verdict and reason.
    pub(super) fn reasons(&self, name: impl Fn(&[&BatchRow]) -> TableCell) -> ReportTable {
        let mut found: Vec<&BatchRow> = self.rows.iter().filter(|row| !row.reason().is_empty()).collect();
        found.sort_by_cached_key(|row| (row.verdict.map(Reverse), row.reason()));
        let alike = found.chunk_by(|a, b| a.verdict == b.verdict && a.reason() == b.reason());
        let alike: Vec<&[&BatchRow]> = alike.collect();
        ReportTable::from_rows(&alike)
            .shape(TableShape::ApartItems)
            .tag("verdict", |rows| tag(rows[0]))
            .head("recording", |rows| name(rows))
            .text("why", |rows| rows[0].reason())
            .limit_rows(MOST_LINES, 50, "campaign.csv has all of them")
            .into()
    }
}

/// Width of a terminal with room for cask and angle, and their columns.
const WIDE: usize = 100;
const CASK_AND_ANGLE: usize = 32;
/// Longest name of a test in the table.
const LONGEST_ID: usize = 14;

impl Batch {
    /// The table, `width` columns wide; below it findings, reasons of failures, and the totals.
    pub fn table(&self, width: usize) -> String {
        crate::report::as_text::text(&self.document(width), width)
    }

    fn document(&self, columns: usize) -> ReportDocument {
        let series = DropSeries::from_rows(&self.rows, |_, _, _| Vec::new());
        let places = DropSeries::places(&series);
        let is_out = |row: &BatchRow| places.get(&row.at.number).is_some_and(|place| place.is_out);
        let is_wide = columns >= WIDE;
        let longest = self.rows.iter().map(|row| row.id.chars().count() + 2).max().unwrap_or_default();
        let ids = if self.has_ids() { longest.min(LONGEST_ID) } else { 0 };
        // The name of a recording must leave room for the other columns.
        let room = columns - 52 - ids - if is_wide { CASK_AND_ANGLE } else { 0 };
        let folder = self.common_folder();
        let name = |row: &BatchRow, width: usize| {
            let own = folder.and_then(|folder| Path::new(&row.recording).strip_prefix(folder).ok());
            tail(&own.map_or_else(|| row.recording.clone(), |own| own.display().to_string()), width)
        };
        let angle =
            |row: &BatchRow| row.at.angle_deg.map_or_else(|| MISSING.to_owned(), |angle| plain(angle, 4));
        let table = ReportTable::from_rows(&self.rows)
            .head("id", |row| tail(&row.id, ids.saturating_sub(2)))
            .show_if(ids > 0)
            .head("recording", |row| name(row, room))
            .text("cask", |row| tail(&row.at.cask, 12))
            .show_if(is_wide)
            .number("angle °", angle)
            .show_if(is_wide)
            .text("verdict", |row| row.verdict.map_or("ERROR", |it| verdict_word(it, number(row))))
            .text("speed m/s", |row| interval(row.slap_down_speed.as_ref()).replace(" m/s", ""))
            .text("k", |row| interval(row.k.as_ref()))
            .number("meas/pred", |row| percent(row.comparison.map(|c| c.difference_percent)))
            .text("", |row| if is_out(row) { "outlier" } else { "" })
            .show_if(is_wide && self.rows.iter().any(is_out))
            .shape(TableShape::Fitting)
            .limit_rows(MOST_LINES, MOST_LINES, "campaign.csv has all of them");
        let place = |row: &&BatchRow| if ids > 0 { row.id.clone() } else { name(row, columns - 10) };
        let names = |rows: &[&BatchRow]| first_five(rows.iter().map(place)).into();
        let place = folder
            .map(|folder| format!("recordings in {}", tail(&folder.display().to_string(), columns - 14)));
        let chapter = Chapter::new("")
            .then(ChapterPart::title(&self.source[..]))
            .with_all(place.map(ChapterPart::line))
            .then(table)
            .then(self.reasons(names));
        let sum = Chapter::new("In all").then(ChapterPart::text(self.sum(&oddities(&series))));
        ReportDocument { chapters: vec![chapter, sum], ..ReportDocument::default() }
    }

    /// The folder of all recordings, if they share one.
    fn common_folder(&self) -> Option<&Path> {
        let mut folders = self.rows.iter().map(|row| Path::new(&row.recording).parent());
        let first = folders.next()??;
        let is_one = !first.as_os_str().is_empty() && folders.all(|folder| folder == Some(first));
        is_one.then_some(first)
    }
}
