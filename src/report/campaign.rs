//! A campaign of recordings to one table, CSV and JSON; a recording that failed is a row with its reason.

use super::ReportError;
use super::columns::columns;
use super::curves_csv::text_cell;
use super::rounding::{MISSING, interval, percent};
use super::text::{Style, WIDTH, line, printable, styled, tail, verdict_word, wrap};
use crate::data::{Comparison, DropResult, Estimate, Verdict};
use serde::Serialize;

/// One recording of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CampaignRow {
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
    /// Why it could not be analysed.
    pub error: Option<String>,
}

impl CampaignRow {
    /// The row of a result.
    #[must_use]
    pub fn of(result: &DropResult) -> Self {
        let finite = |e: &Estimate| e.value.is_finite() && e.u95.is_finite();
        Self {
            recording: result.input.recording.clone(),
            report: None,
            verdict: Some(result.verdict),
            slap_down_speed: result.slap_down.speed.filter(finite),
            k: result.k.filter(finite),
            model: result.model.as_ref().map(|m| m.name.as_str()),
            comparison: result.comparison,
            findings: result.quality.iter().filter(|i| i.severity != crate::data::Severity::Note).count(),
            error: None,
        }
    }

    /// The row of a recording that could not be analysed.
    #[must_use]
    pub fn failed(recording: String, error: String) -> Self {
        Self {
            recording,
            report: None,
            verdict: None,
            slap_down_speed: None,
            k: None,
            model: None,
            comparison: None,
            findings: 0,
            error: Some(error),
        }
    }
}

/// A campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Campaign {
    /// "dropcheck.campaign/1".
    pub schema: &'static str,
    /// The program's version.
    pub version: &'static str,
    /// The cask file.
    pub cask: String,
    /// One a recording, in the order given.
    pub recordings: Vec<CampaignRow>,
}

impl Campaign {
    /// A campaign of `rows` with one cask file.
    #[must_use]
    pub fn new(cask: String, recordings: Vec<CampaignRow>) -> Self {
        Self { schema: "dropcheck.campaign/1", version: env!("CARGO_PKG_VERSION"), cask, recordings }
    }

    /// The table, 80 columns wide; reasons of failures stand below it.
    #[must_use]
    pub fn table(&self) -> String {
        let rows: Vec<Vec<String>> = self
            .recordings
            .iter()
            .map(|row| {
                vec![
                    tail(&row.recording, 24),
                    row.verdict.map_or("ERROR", verdict_word).to_owned(),
                    interval(row.slap_down_speed.as_ref()).replace(" m/s", ""),
                    interval(row.k.as_ref()),
                    row.comparison.map_or_else(|| MISSING.to_owned(), |c| percent(c.difference_percent)),
                    row.findings.to_string(),
                ]
            })
            .collect();
        let header = ["recording", "verdict", "speed m/s", "k", "meas/pred", "findings"];
        let mut out = format!("{}\n", styled(Style::Bold, &printable(&self.cask)));
        out.push_str(&columns(&header, &rows, &[4, 5]));
        for row in &self.recordings {
            if let Some(error) = &row.error {
                line(
                    &mut out,
                    format_args!("\n  {}  {}", styled(Style::Red, "error"), tail(&row.recording, 60)),
                );
                out.push_str(&wrap(error, WIDTH, 6));
            }
        }
        out
    }

    /// `campaign.json`.
    ///
    /// # Errors
    /// [`ReportError::Json`] where the writer fails.
    pub fn json(&self) -> Result<Vec<u8>, ReportError> {
        super::json::pretty(self)
    }

    /// `campaign.csv`.
    ///
    /// # Errors
    /// [`ReportError::Csv`] where the writer fails.
    pub fn csv(&self) -> Result<Vec<u8>, ReportError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record([
            "recording",
            "verdict",
            "slap_down_speed_m_s",
            "slap_down_speed_u95_m_s",
            "k",
            "k_u95",
            "model",
            "predicted_m_s",
            "difference_percent",
            "agrees",
            "findings",
            "error",
        ])?;
        let number = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
        for row in &self.recordings {
            writer.write_record([
                text_cell(&row.recording),
                row.verdict.map_or_else(|| "error".into(), |v| verdict_word(v).to_lowercase()),
                number(row.slap_down_speed.map(|e| e.value)),
                number(row.slap_down_speed.map(|e| e.u95)),
                number(row.k.map(|e| e.value)),
                number(row.k.map(|e| e.u95)),
                row.model.unwrap_or_default().to_owned(),
                number(row.comparison.map(|c| c.predicted)),
                number(row.comparison.map(|c| c.difference_percent)),
                row.comparison.map_or_else(String::new, |c| c.agrees.to_string()),
                row.findings.to_string(),
                text_cell(row.error.as_deref().unwrap_or_default()),
            ])?;
        }
        writer.into_inner().map_err(|error| ReportError::Csv(csv::Error::from(error.into_error())))
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    fn campaign() -> Campaign {
        let rows = vec![
            CampaignRow::of(&sample::analysis().result),
            CampaignRow::failed("=b.mcap".into(), "b.mcap is empty; record it again".into()),
        ];
        Campaign::new("anf18.toml".into(), rows)
    }

    #[test]
    fn a_failed_recording_is_a_row_with_its_reason() {
        let text = anstream::adapter::strip_str(&campaign().table()).to_string();
        assert!(text.contains("ERROR") && text.contains("record it again"));
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
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
