//! Writes a campaign as `campaign.csv` and `campaign.json`, a line at a time, and as its page with the
//! pictures.

use super::columns::{self, Columns};
use super::series::{DropSeries, PooledQuantity, RowPlace};
use super::{Batch, BatchRow, MOST_SERIES, PredictedCurve, page};
use crate::data::Program;
use crate::report::json::{pretty, to_line};
use crate::report::records::{records, text_cell};
use crate::report::text::json_word;
use crate::report::{ReportError, as_html};
use serde_json::{Value, json};
use std::collections::HashMap;

/// A complete campaign, with the predictions of the model for its casks.
pub struct CampaignFiles<'a> {
    batch: &'a Batch,
    series: Vec<DropSeries<'a>>,
    places: HashMap<u32, RowPlace>,
}

impl<'a> CampaignFiles<'a> {
    /// Starts the files of a campaign; `predicted` gives the curves of the series to which a row belongs,
    /// over these k and angles.
    pub fn new(
        batch: &'a Batch,
        predicted: impl Fn(&BatchRow, [f64; 2], [f64; 2]) -> Vec<PredictedCurve>,
    ) -> Self {
        let series = DropSeries::from_rows(&batch.rows, predicted);
        Self { batch, places: DropSeries::places(&series), series }
    }

    /// A row of `campaign.csv`.
    ///
    /// # Errors
    ///
    /// [`ReportError::Csv`] if the writer fails.
    pub fn csv_row(&self, line: &Value) -> Result<Vec<u8>, ReportError> {
        let own = self.columns(line);
        let carried = self.batch.carried.iter().map(String::as_str);
        let names = columns::names().chain(carried);
        records([names.map(|name| own.get(name).map_or_else(String::new, cell))])
    }

    /// Every column of a line.
    fn columns(&self, line: &Value) -> Columns {
        let mut columns = columns::line_columns(line);
        let Some(row) = self.row(line) else { return columns };
        let place = self.places.get(&row.at.number).copied().unwrap_or_default();
        let [of_k, of_speed] = [PooledQuantity::K, PooledQuantity::Speed].map(|q| place.e_n[q as usize]);
        let untested = line["untested"].as_array().into_iter().flatten();
        let untested: Vec<&str> = untested.filter_map(|input| input["key"].as_str()).collect();
        let own = json!({
            "untested": untested.join(" "), "other_channels": extremes(line), "exit": row.exit,
            "verdict": row.verdict.map_or_else(|| "error".into(), json_word),
            "report": row.report, "findings": row.findings, "codes": row.codes.join(" "),
            "note_codes": row.note_codes.join(" "), "same_recording_as": row.same_recording_as,
            "outlier": of_k.or(of_speed).map(|_| place.is_out), "k_e_n": of_k,
            "slap_down_speed_e_n": of_speed,
        });
        let own = own.as_object().cloned().unwrap_or_default();
        columns.extend(own.into_iter().filter(|(_, value)| !value.is_null()));
        columns
    }

    /// The row of a line.
    fn row(&self, line: &Value) -> Option<&BatchRow> {
        let number = line["campaign"]["number"].as_u64()?;
        self.batch.rows.get(usize::try_from(number).ok()?)
    }

    /// Beginning of `campaign.json`; the rows follow, with commas between them, then [`Self::JSON_END`].
    ///
    /// # Errors
    ///
    /// [`ReportError::Json`] if the writer fails.
    pub fn json_head(&self) -> Result<Vec<u8>, ReportError> {
        let program = Program::current();
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

    /// Text between two rows of `campaign.json`, and after the last.
    pub const JSON_BETWEEN: &'static str = ",\n    ";
    /// See above.
    pub const JSON_END: &'static str = "\n  ]\n}\n";

    /// A row of `campaign.json`.
    ///
    /// # Errors
    ///
    /// [`ReportError::Json`] if the writer fails.
    pub fn json_row(&self, line: &Value) -> Result<Vec<u8>, ReportError> {
        let mut row = serde_json::to_value(self.row(line))?;
        row["columns"] = self.columns(line).into_iter().collect();
        Ok(to_line(&row)?.into_bytes())
    }

    /// `campaign.html` and its pictures.
    pub fn page(&self) -> Vec<(String, Vec<u8>)> {
        let drawn = self.series.iter().take(MOST_SERIES);
        let pictures: Vec<_> = drawn.enumerate().flat_map(|(i, series)| series.pictures(i + 1)).collect();
        let page = as_html::page(&page::document(self.batch, &self.series), &pictures);
        let drawn =
            pictures.into_iter().map(|picture| (format!("{}.svg", picture.name), picture.svg.into_bytes()));
        std::iter::once(("campaign.html".to_owned(), page.into_bytes())).chain(drawn).collect()
    }
}

/// The smallest and the largest value of each channel that takes no part in the motion, as JSON in a cell;
/// null if there are none.
fn extremes(line: &Value) -> Option<String> {
    let reason_of = |other: &Value| {
        let [smallest, largest] = ["smallest", "largest"].map(|key| &other[key]["value"]);
        json!({"name": other["name"], "unit": other["unit"], "smallest": smallest, "largest": largest})
    };
    Some(line["other_channels"].as_array()?.iter().map(reason_of).collect::<Value>().to_string())
}

impl Batch {
    /// The first line of `campaign.csv`.
    ///
    /// # Errors
    ///
    /// [`ReportError::Csv`] if the writer fails.
    pub fn csv_head(&self) -> Result<Vec<u8>, ReportError> {
        let carried = self.carried.iter().map(|name| text_cell(name));
        records([columns::names().map(str::to_owned).chain(carried)])
    }
}

/// Formats a value as a cell; a number that the manifest carried as text stays a number.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) if text.parse::<f64>().is_ok() => text.to_owned(),
        Value::String(text) => text_cell(text),
        other => other.to_string(),
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
