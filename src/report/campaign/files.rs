//! A campaign and its lines once more to `campaign.csv` and `campaign.json`, a line at a time, and to its
//! page with the pictures.

use super::columns;
use super::series::DropSeries;
use super::{Batch, BatchRow, MOST_SERIES, PredictedCurve, head, page};
use crate::data::Program;
use crate::report::json::{in_a_line, pretty};
use crate::report::records::{finished, text_cell};
use crate::report::{ReportError, as_html};
use serde_json::{Value, json};

/// A campaign all of whose lines are known, with what the model predicts for its casks.
pub struct CampaignFiles<'a> {
    batch: &'a Batch,
    series: Vec<DropSeries<'a>>,
}

impl<'a> CampaignFiles<'a> {
    /// Of a campaign; `predicted` gives the curves of the series that a row belongs to, over these k and
    /// angles.
    pub fn new(
        batch: &'a Batch,
        predicted: impl Fn(&BatchRow, [f64; 2], [f64; 2]) -> Vec<PredictedCurve>,
    ) -> Self {
        Self { batch, series: DropSeries::all(&batch.rows, predicted) }
    }

    /// A row of `campaign.csv`.
    ///
    /// # Errors
    /// [`ReportError::Csv`] where the writer fails.
    pub fn csv_row(&self, line: &Value) -> Result<Vec<u8>, ReportError> {
        let (row, own) = (BatchRow::of(line), columns::of(line));
        let head = head();
        let fixed = head.iter().map(|column| column.1(&row));
        record(
            fixed.chain(
                self.batch.columns.iter().map(|column| own.get(column).map_or_else(String::new, cell)),
            ),
        )
    }

    /// What `campaign.json` begins with; the rows follow, with commas between them, then [`Self::JSON_END`].
    ///
    /// # Errors
    /// [`ReportError::Json`] where the writer fails.
    pub fn json_head(&self) -> Result<Vec<u8>, ReportError> {
        let program = Program::this();
        let pools: Vec<Value> = self.series.iter().flat_map(DropSeries::records).collect();
        let head = json!({
            "cask": self.batch.source, "count": self.batch.rows.len(), "pools": pools,
            "program": program, "version": program.version,
        });
        let text = String::from_utf8_lossy(&pretty(&head)?).into_owned();
        let inner = text.trim_start_matches("{\n").trim_end().trim_end_matches("\n}");
        let schema = "  \"schema\": \"dropcheck.campaign/1\"";
        Ok(format!("{{\n{schema},\n{inner},\n  \"recordings\": [\n    ").into_bytes())
    }

    /// What stands between two rows of `campaign.json`, and behind the last.
    pub const JSON_BETWEEN: &'static str = ",\n    ";
    /// See above.
    pub const JSON_END: &'static str = "\n  ]\n}\n";

    /// A row of `campaign.json`.
    ///
    /// # Errors
    /// [`ReportError::Json`] where the writer fails.
    pub fn json_row(&self, line: &Value) -> Result<Vec<u8>, ReportError> {
        let mut row = serde_json::to_value(BatchRow::of(line))?;
        row["columns"] = columns::of(line).into_iter().map(|((_, name), value)| (name, value)).collect();
        Ok(in_a_line(&row)?.into_bytes())
    }

    /// `campaign.html` and its pictures.
    #[must_use]
    pub fn page(&self) -> Vec<(String, Vec<u8>)> {
        let drawn = self.series.iter().take(MOST_SERIES);
        let pictures: Vec<_> = drawn.enumerate().flat_map(|(i, series)| series.pictures(i + 1)).collect();
        let page = as_html::page(&page::document(self.batch, &self.series), &pictures);
        let drawn =
            pictures.into_iter().map(|picture| (format!("{}.svg", picture.name), picture.svg.into_bytes()));
        std::iter::once(("campaign.html".to_owned(), page.into_bytes())).chain(drawn).collect()
    }
}

impl Batch {
    /// The first line of `campaign.csv`.
    ///
    /// # Errors
    /// [`ReportError::Csv`] where the writer fails.
    pub fn csv_head(&self) -> Result<Vec<u8>, ReportError> {
        record(
            head()
                .iter()
                .map(|column| column.0.to_owned())
                .chain(self.columns.iter().map(|(_, name)| text_cell(name))),
        )
    }
}

fn record(cells: impl Iterator<Item = String>) -> Result<Vec<u8>, ReportError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(cells)?;
    finished(writer)
}

/// A value as a cell; a number that was carried as text stays one.
fn cell(value: &Value) -> String {
    match value.as_str() {
        Some(text) if text.parse::<f64>().is_ok() => text.to_owned(),
        Some(text) => text_cell(text),
        None => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{campaign, lines};
    use super::*;

    #[test]
    fn the_csv_has_a_row_a_recording_and_no_formula() {
        let (lines, campaign) = (lines(), campaign(&lines()));
        let files = CampaignFiles::new(&campaign, |_, _, _| Vec::new());
        let text = [
            campaign.csv_head().unwrap(),
            files.csv_row(&lines[0]).unwrap(),
            files.csv_row(&lines[1]).unwrap(),
        ]
        .concat();
        let mut reader = csv::Reader::from_reader(&text[..]);
        let heads = reader.headers().unwrap().clone();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let cell = |row: usize, name: &str| {
            rows[row][heads.iter().position(|head| head == name).expect(name)].to_owned()
        };
        assert!(Batch::begins(&text) && rows.len() == 2);
        assert_eq!(
            (cell(1, "recording"), cell(1, "verdict"), cell(1, "exit")),
            ("'=b.mcap".into(), "error".into(), "2".into())
        );
        assert_eq!((cell(0, "hall"), cell(0, "no")), ("'=3".into(), "-3".into()));
        for name in [
            "slap_down_flight_time_s",
            "slap_down_flight_time_u95_s",
            "first_impact_impact_velocity_m_s",
            "borderline_rod_rough_k1_m_s",
        ] {
            assert!(cell(0, name).parse::<f64>().is_ok(), "{name}");
        }
    }

    #[test]
    fn the_json_holds_all_rows() {
        let (lines, campaign) = (lines(), campaign(&lines()));
        let files = CampaignFiles::new(&campaign, |_, _, _| Vec::new());
        let between = CampaignFiles::JSON_BETWEEN.as_bytes();
        let rows = [files.json_row(&lines[0]).unwrap(), files.json_row(&lines[1]).unwrap()].join(between);
        let text = [files.json_head().unwrap(), rows, CampaignFiles::JSON_END.into()].concat();
        assert!(text.starts_with(b"{\n  \"schema\": \"dropcheck.campaign/1\""));
        let json: Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(json["recordings"][0]["verdict"], "review");
        assert!(json["recordings"][1]["verdict"].is_null() && json["recordings"][1]["error"].is_string());
        assert_eq!(json["recordings"][0]["columns"]["no"], "-3");
    }
}
