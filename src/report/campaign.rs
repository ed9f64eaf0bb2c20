//! A campaign of recordings to one table, CSV and JSON; a recording that failed is a row with its reason.

use super::ReportError;
use super::document::{Chapter, ChapterPart, ReportDocument};
use super::records::{CsvColumn, number, records, text_cell};
use super::rounding::{MISSING, interval, percent};
use super::table::{ReportTable, TableCell, TableShape};
use super::text::{Style, distinct, json_word, tail, verdict_word};
use crate::data::{Comparison, DropResult, Estimate, Finding, IssueCode, Severity, Verdict};
use serde::Serialize;
use std::path::Path;

/// One recording of a campaign.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct BatchRow {
    /// The recording, as given.
    pub recording: String,
    /// The folder of its report under `--out`.
    pub report: Option<String>,
    /// The overall word; none where it could not be analysed.
    pub verdict: Option<Verdict>,
    /// Slap-down speed, m/s.
    pub slap_down_speed: Option<Estimate>,
    /// Coefficient of restitution.
    pub k: Option<Estimate>,
    /// The model taken.
    pub model: Option<&'static str>,
    /// Measured beside predicted.
    pub comparison: Option<Comparison>,
    /// Warnings and errors among the findings.
    pub findings: usize,
    /// Their codes, each once, errors first.
    pub codes: Vec<IssueCode>,
    /// Why it could not be analysed.
    pub error: Option<String>,
}

impl BatchRow {
    /// The row of a result.
    #[must_use]
    pub fn of(result: &DropResult) -> Self {
        let mut grave: Vec<&Finding> =
            result.quality.iter().filter(|issue| issue.severity != Severity::Note).collect();
        grave.sort_by_key(|issue| std::cmp::Reverse(issue.severity));
        let codes = distinct(grave.iter().map(|issue| issue.code));
        Self {
            recording: result.input.recording.clone(),
            verdict: Some(result.verdict),
            slap_down_speed: result.slap_down.speed,
            k: result.k,
            model: result.model.as_ref().map(|m| m.name.as_str()),
            comparison: result.comparison,
            findings: grave.len(),
            codes,
            ..Self::default()
        }
    }

    /// The row of a recording that could not be analysed.
    #[must_use]
    pub fn failed(recording: String, error: String) -> Self {
        Self { recording, error: Some(error), ..Self::default() }
    }

    fn code_words(&self) -> Vec<String> {
        self.codes.iter().copied().map(json_word).collect()
    }
}

/// A campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Batch {
    /// "dropcheck.campaign/1".
    pub schema: &'static str,
    /// The program's version.
    pub version: &'static str,
    /// The cask file.
    pub cask: String,
    /// One a recording, in the order given.
    pub recordings: Vec<BatchRow>,
}

/// The columns of `campaign.csv`.
fn columns<'a>() -> [CsvColumn<&'a BatchRow>; 13] {
    [
        ("recording", |row| text_cell(&row.recording)),
        ("verdict", |row| row.verdict.map_or_else(|| "error".into(), json_word)),
        ("slap_down_speed_m_s", |row| number(row.slap_down_speed.map(|e| e.value))),
        ("slap_down_speed_u95_m_s", |row| number(row.slap_down_speed.map(|e| e.u95))),
        ("k", |row| number(row.k.map(|e| e.value))),
        ("k_u95", |row| number(row.k.map(|e| e.u95))),
        ("model", |row| row.model.unwrap_or_default().to_owned()),
        ("predicted_m_s", |row| number(row.comparison.map(|c| c.predicted))),
        ("difference_percent", |row| number(row.comparison.map(|c| c.difference_percent))),
        ("agrees", |row| row.comparison.map_or_else(String::new, |c| c.agrees.to_string())),
        ("findings", |row| row.findings.to_string()),
        ("codes", |row| row.code_words().join(" ")),
        ("error", |row| text_cell(row.error.as_deref().unwrap_or_default())),
    ]
}

impl Batch {
    /// A campaign of `rows` with one cask file.
    #[must_use]
    pub fn new(cask: String, recordings: Vec<BatchRow>) -> Self {
        Self { schema: "dropcheck.campaign/1", version: env!("CARGO_PKG_VERSION"), cask, recordings }
    }

    /// The table, `width` columns wide; below it what was found, and reasons of failures.
    #[must_use]
    pub fn table(&self, width: usize) -> String {
        super::as_text::text(&self.document(width), width)
    }

    fn document(&self, columns: usize) -> ReportDocument {
        // A recording's name leaves room for the other columns.
        let room = columns - 52;
        let folder = self.common_folder();
        let name = |row: &BatchRow, width: usize| {
            let own = folder.and_then(|folder| Path::new(&row.recording).strip_prefix(folder).ok());
            tail(&own.map_or_else(|| row.recording.clone(), |own| own.display().to_string()), width)
        };
        let word = |row: &BatchRow| row.verdict.map_or("ERROR", verdict_word);
        let table = ReportTable::of(&self.recordings)
            .head("recording", |row| name(row, room))
            .text("verdict", word)
            .text("speed m/s", |row| interval(row.slap_down_speed.as_ref()).replace(" m/s", ""))
            .text("k", |row| interval(row.k.as_ref()))
            .number("meas/pred", |row| {
                row.comparison.map_or(MISSING.into(), |c| percent(c.difference_percent))
            });
        let grave: Vec<&BatchRow> =
            self.recordings.iter().filter(|row| row.error.is_some() || !row.codes.is_empty()).collect();
        let style = |row: &BatchRow| match row.verdict {
            Some(Verdict::Pass | Verdict::Review) if row.error.is_none() => Style::Yellow,
            _ => Style::Red,
        };
        let why = |row: &BatchRow| row.error.clone().unwrap_or_else(|| row.code_words().join(", "));
        let reasons = ReportTable::of(&grave)
            .shape(TableShape::ApartItems)
            .tag("verdict", |row| TableCell::toned(style(row), word(row).to_lowercase()))
            .head("recording", |row| name(row, columns - 10))
            .text("why", |row| why(row));
        let place = folder
            .map(|folder| format!("recordings in {}", tail(&folder.display().to_string(), columns - 14)));
        let chapter = Chapter::new("")
            .with(ChapterPart::title(&self.cask[..]))
            .with_all(place.map(ChapterPart::line))
            .with(table)
            .with(reasons);
        ReportDocument { chapters: vec![chapter], ..ReportDocument::default() }
    }

    /// The folder in which all recordings are, where they are in one.
    fn common_folder(&self) -> Option<&Path> {
        let mut folders = self.recordings.iter().map(|row| Path::new(&row.recording).parent());
        let first = folders.next()??;
        let is_one = !first.as_os_str().is_empty() && folders.all(|folder| folder == Some(first));
        is_one.then_some(first)
    }

    /// `campaign.json`.
    ///
    /// # Errors
    /// [`ReportError::Json`] where the writer fails.
    pub fn json(&self) -> Result<Vec<u8>, ReportError> {
        super::json::pretty(self)
    }

    /// Whether a file that begins so is a `campaign.csv` of this program.
    #[must_use]
    pub fn begins(head: &[u8]) -> bool {
        head.starts_with(columns().map(|column| column.0).join(",").as_bytes())
    }

    /// `campaign.csv`.
    ///
    /// # Errors
    /// [`ReportError::Csv`] where the writer fails.
    pub fn csv(&self) -> Result<Vec<u8>, ReportError> {
        records(&columns(), &self.recordings)
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::super::text::WIDTH;
    use super::*;

    fn campaign() -> Batch {
        let rows = vec![
            BatchRow::of(&sample::analysis().result),
            BatchRow::failed("=b.mcap".into(), "b.mcap is empty; record it again".into()),
        ];
        Batch::new("anf18.toml".into(), rows)
    }

    #[test]
    fn a_failed_recording_is_a_row_with_its_reason() {
        let text = anstream::adapter::strip_str(&campaign().table(WIDTH)).to_string();
        assert!(text.contains("ERROR") && text.contains("record it again"));
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
    }

    #[test]
    fn the_table_shows_names_whole_and_what_was_found() {
        let mut rows = campaign().recordings;
        rows[0].recording = "of/a/test site/damaged-truncated.mcap".into();
        rows[0].codes = vec![IssueCode::EndsEarly, IssueCode::Gap];
        rows[1].recording = "of/a/test site/b.mcap".into();
        let text = |rows: &[BatchRow]| {
            let table = Batch::new("anf18.toml".into(), rows.to_vec()).table(WIDTH);
            anstream::adapter::strip_str(&table).to_string()
        };
        let together = text(&rows);
        assert!(together.contains("recordings in of/a/test site\n"), "{together}");
        assert!(together.contains("\n  damaged-truncated.mcap  LOOK AT"), "{together}");
        assert!(together.contains("look at  damaged-truncated.mcap\n      ends_early, gap\n"), "{together}");
        rows[1].recording = "b.mcap".into();
        assert!(!text(&rows).contains("recordings in"));
    }

    #[test]
    fn the_csv_has_a_row_a_recording_and_no_formula() {
        let text = String::from_utf8(campaign().csv().unwrap()).unwrap();
        assert_eq!(text.lines().count(), 3);
        assert!(text.lines().nth(2).unwrap().starts_with("'=b.mcap,error,"));
    }

    #[test]
    fn the_json_holds_both() {
        let json: serde_json::Value = serde_json::from_slice(&campaign().json().unwrap()).unwrap();
        assert_eq!(json["recordings"][0]["verdict"], "review");
        assert!(json["recordings"][1]["verdict"].is_null());
    }
}
