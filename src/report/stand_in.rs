//! Stand-in for the report of a study, dropped by the merge.

use super::ReportError;
use super::prediction::{PredictionRow, csv, json, table};
use crate::data::{Request, Study};

fn rows(study: &Study) -> Vec<PredictionRow> {
    let row = |r: &crate::data::PredictionRow| PredictionRow {
        angle_deg: r.angle_deg,
        prediction: r.prediction.clone(),
    };
    study.rows.iter().map(row).collect()
}

/// Stand-in.
#[must_use]
pub fn study_table(study: &Study) -> String {
    table(&rows(study), &study.cask_file)
}

/// Stand-in.
///
/// # Errors
/// Stand-in.
pub fn study_json(study: &Study) -> Result<Vec<u8>, ReportError> {
    json(&rows(study))
}

/// Stand-in.
#[must_use]
pub fn study_file_names(_: &Request) -> Vec<String> {
    ["prediction.html", "prediction.json", "prediction.csv"].map(str::to_owned).into()
}

/// Stand-in.
///
/// # Errors
/// Stand-in.
pub fn study_files(study: &Study) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    Ok(vec![
        ("prediction.html".into(), b"<html>".to_vec()),
        ("prediction.json".into(), study_json(study)?),
        ("prediction.csv".into(), csv(&rows(study))?),
    ])
}
