//! A campaign to the table of the terminal, what was found below it, and its sum.

use super::series::DropSeries;
use super::summary::{MOST_LINES, few, oddities};
use super::{Batch, BatchRow};
use crate::report::document::{Chapter, ChapterPart, ReportDocument, ReportTable, TableShape};
use crate::report::rounding::{MISSING, interval, percent, plain};
use crate::report::text::{tail, verdict_word};
use std::path::Path;

/// Columns of a terminal with room for cask and angle, and what these take.
const WIDE: usize = 100;
const CASK_AND_ANGLE: usize = 32;

impl Batch {
    /// The table, `width` columns wide; below it what was found, reasons of failures, and the sum.
    pub fn table(&self, width: usize) -> String {
        crate::report::as_text::text(&self.document(width), width)
    }

    fn document(&self, columns: usize) -> ReportDocument {
        let series = DropSeries::all(&self.rows, |_, _, _| Vec::new());
        let places = DropSeries::places(&series);
        let is_out = |row: &BatchRow| places.get(&row.at.number).is_some_and(|place| place.is_out);
        let is_wide = columns >= WIDE;
        // A recording's name leaves room for the other columns.
        let room = columns - 52 - if is_wide { CASK_AND_ANGLE } else { 0 };
        let folder = self.common_folder();
        let name = |row: &BatchRow, width: usize| {
            let own = folder.and_then(|folder| Path::new(&row.recording).strip_prefix(folder).ok());
            tail(&own.map_or_else(|| row.recording.clone(), |own| own.display().to_string()), width)
        };
        let angle =
            |row: &BatchRow| row.at.angle_deg.map_or_else(|| MISSING.to_owned(), |angle| plain(angle, 4));
        let table = ReportTable::of(&self.rows)
            .head("recording", |row| name(row, room))
            .text("cask", |row| tail(&row.at.cask, 12))
            .if_any(is_wide)
            .number("angle °", angle)
            .if_any(is_wide)
            .text("verdict", |row| row.verdict.map_or("ERROR", verdict_word))
            .text("speed m/s", |row| interval(row.slap_down_speed.as_ref()).replace(" m/s", ""))
            .text("k", |row| interval(row.k.as_ref()))
            .number("meas/pred", |row| percent(row.comparison.map(|c| c.difference_percent)))
            .text("", |row| if is_out(row) { "outlier" } else { "" })
            .if_any(is_wide && self.rows.iter().any(is_out))
            .shape(TableShape::Fitting)
            .most(MOST_LINES, MOST_LINES, "campaign.csv has all of them");
        let names = |rows: &[&BatchRow]| few(rows.iter().map(|row| name(row, columns - 10))).into();
        let place = folder
            .map(|folder| format!("recordings in {}", tail(&folder.display().to_string(), columns - 14)));
        let chapter = Chapter::new("")
            .with(ChapterPart::title(&self.source[..]))
            .with_all(place.map(ChapterPart::line))
            .with(table)
            .with(self.reasons(names));
        let sum = Chapter::new("In all").with(ChapterPart::text(self.sum(&oddities(&series))));
        ReportDocument { chapters: vec![chapter, sum], ..ReportDocument::default() }
    }

    /// The folder in which all recordings are, where they are in one.
    fn common_folder(&self) -> Option<&Path> {
        let mut folders = self.rows.iter().map(|row| Path::new(&row.recording).parent());
        let first = folders.next()??;
        let is_one = !first.as_os_str().is_empty() && folders.all(|folder| folder == Some(first));
        is_one.then_some(first)
    }
}
