//! Files of a study: page, JSON, CSV and pictures; and the table of the terminal.

mod critical;
mod models;
mod rows;
mod study;
#[cfg(test)]
mod study_tests;

pub(super) use rows::prediction_columns;

use super::records::{number, records};
use super::{ReportError, as_html, as_text, pictures};
use crate::data::{PredictionRow, Study, StudyRequest};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{json, to_vec};

/// The names of the files that [`study_files`] makes for a study of this request, in its order.
pub fn study_file_names(request: &StudyRequest) -> Vec<String> {
    let own = ["prediction.html", "prediction.json", "prediction.csv"].map(str::to_owned);
    own.into_iter()
        .chain(pictures::study_names(request).into_iter().map(|name| format!("{name}.svg")))
        .collect()
}

/// The whole of a study for the terminal.
pub fn study_table(study: &Study, width: usize) -> String {
    as_text::text(&study::document(study), width)
}

/// Every file of a study by name, in the order for a reader.
///
/// # Errors
///
/// [`ReportError`] if one of them cannot be made; then none is returned.
pub fn study_files(study: &Study) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    let (pictures, (json, csv)) = rayon::join(
        || pictures::draw_study(study),
        || rayon::join(|| study_json(study), || csv(&study.rows)),
    );
    let page = as_html::page(&study::document(study), &pictures).into_bytes();
    let pictures = pictures.into_iter().map(|picture| picture.svg.into_bytes());
    let bytes = [page, json?, csv?].into_iter().chain(pictures);
    Ok(study_file_names(&study.request).into_iter().zip(bytes).collect())
}

/// Writes `prediction.json`.
///
/// # Errors
///
/// [`ReportError::Json`] if the writer fails.
pub fn study_json(study: &Study) -> Result<Vec<u8>, ReportError> {
    let file = &study.cask_file;
    let input = json!({"cask": file.path.display().to_string(), "cask_sha256": file.sha256});
    let members = [
        ("schema", to_vec("dropcheck.prediction/1")?),
        ("version", to_vec(env!("CARGO_PKG_VERSION"))?),
        ("predictions", entries(&study.rows)?),
        ("input", to_vec(&input)?),
        ("ladders", entries(&study.ladders)?),
        ("critical_angles", entries(&study.critical)?),
        ("monte_carlo", to_vec(&study.monte_carlo)?),
        ("advice", to_vec(&study.advice)?),
        ("plan", to_vec(&study.plan)?),
    ];
    let members = members.map(|(key, value)| [format!("  \"{key}\": ").as_bytes(), &value].concat());
    Ok([b"{\n", &members.join(&b",\n"[..])[..], b"\n}\n"].concat())
}

/// Writes a list, one entry per line; for seventy thousand predictions each core writes some.
fn entries<T: Serialize + Sync>(list: &[T]) -> Result<Vec<u8>, serde_json::Error> {
    let lines: Result<Vec<Vec<u8>>, serde_json::Error> = list.par_iter().map(to_vec).collect();
    let lines = lines?.join(&b",\n    "[..]);
    Ok(if lines.is_empty() { b"[]".into() } else { [b"[\n    ", &lines[..], b"\n  ]"].concat() })
}

/// Head of a column, and the function that makes its cells.
type CsvColumn = (&'static str, fn(&PredictionRow) -> String);

/// Columns of the table; scripts know the first fourteen, and more may follow them.
const COLUMNS: [CsvColumn; 24] = [
    ("angle_deg", |row| row.angle_deg.to_string()),
    ("model", |row| row.prediction.model.as_str().to_owned()),
    ("contact", |row| row.prediction.contact.to_string()),
    ("k", |row| row.prediction.k.to_string()),
    ("slap_down_speed_m_s", |row| number(row.prediction.slap_down_speed_m_s)),
    ("vertical_velocity_m_s", |row| number(row.prediction.vertical_velocity_m_s)),
    ("horizontal_velocity_m_s", |row| number(row.prediction.horizontal_velocity_m_s)),
    ("angular_velocity_rad_s", |row| number(Some(row.prediction.angular_velocity_rad_s))),
    ("flight_time_s", |row| number(row.prediction.flight_time_s)),
    ("energy_ratio", |row| number(row.prediction.energy_ratio)),
    ("slap_down_angle_deg", |row| number(row.prediction.slap_down_angle_deg)),
    ("first_end_impacts", |row| row.prediction.first_end_impacts.to_string()),
    ("impulse_ratio", |row| number(Some(row.prediction.impulse_ratio))),
    ("regime", |row| row.prediction.regime.to_string()),
    ("length_m", |row| row.length_m.to_string()),
    ("drop_height_m", |row| row.drop_height_m.to_string()),
    ("friction_to_stick", |row| number(Some(row.prediction.friction_to_stick))),
    ("sticks", |row| row.prediction.sticks.to_string()),
    ("closed_form_speed_m_s", |row| number(row.prediction.closed_form_speed_m_s)),
    ("turns_over", |row| row.turns_over.to_string()),
    ("cog_horizontal_after_impact_m_s", |row| number(Some(row.prediction.cog.horizontal_after_impact_m_s))),
    ("cog_vertical_after_impact_m_s", |row| number(Some(row.prediction.cog.vertical_after_impact_m_s))),
    ("cog_horizontal_at_slap_down_m_s", |row| number(row.prediction.cog.horizontal_at_slap_down_m_s)),
    ("cog_vertical_at_slap_down_m_s", |row| number(row.prediction.cog.vertical_at_slap_down_m_s)),
];

/// Writes the CSV of `predict`.
///
/// # Errors
///
/// [`ReportError::Csv`] if the writer fails.
fn csv(rows: &[PredictionRow]) -> Result<Vec<u8>, ReportError> {
    let head = COLUMNS.map(|(head, _)| head.to_owned());
    records(std::iter::once(head).chain(rows.iter().map(|row| COLUMNS.map(|(_, cell)| cell(row)))))
}

#[cfg(test)]
mod tests {
    use super::super::sample_study;
    use super::*;
    use serde_json::Value;

    #[test]
    fn the_files_are_those_that_the_request_names() {
        for study in [sample_study::study(), sample_study::sweep_study(), sample_study::without_slap_down()] {
            let files = study_files(&study).unwrap();
            let names = study_file_names(&study.request);
            assert!(files.iter().map(|(name, _)| name).eq(&names), "{names:?}");
            assert!(files.iter().all(|(_, bytes)| !bytes.is_empty()));
        }
    }

    #[test]
    fn the_same_study_gives_the_same_bytes() {
        let study = sample_study::sweep_study();
        assert_eq!(study_files(&study).unwrap(), study_files(&study).unwrap());
    }

    fn read(bytes: &[u8]) -> Value {
        serde_json::from_slice(bytes).unwrap()
    }

    #[test]
    fn it_holds_every_part_of_the_study() {
        let study = sample_study::study();
        let json = read(&study_json(&study).unwrap());
        assert_eq!(json["schema"], "dropcheck.prediction/1");
        assert_eq!(json["predictions"][0]["model"], "rod");
        assert_eq!(json["predictions"][0]["contact"], "rough");
        assert_eq!(json["predictions"][0]["angle_deg"], 15.0);
        assert_eq!(json["ladders"][0]["steps"][0]["rung"], "rod");
        assert_eq!(json["critical_angles"][0]["criterion"], "speed");
        assert_eq!(
            json["monte_carlo"]["quantiles"][0]["q50"].as_array().unwrap().len(),
            study.monte_carlo.angle_deg.len()
        );
    }

    #[test]
    fn what_is_not_a_number_is_null() {
        let mut study = sample_study::study();
        study.rows[1].prediction.slap_down_speed_m_s = None;
        study.monte_carlo.quantiles[0].q50[3] = f64::NAN;
        let json = read(&study_json(&study).unwrap());
        assert!(json["predictions"][1]["slap_down_speed_m_s"].is_null());
        assert!(json["monte_carlo"]["quantiles"][0]["q50"][3].is_null());
    }

    #[test]
    fn an_entry_stands_on_a_line() {
        let study = sample_study::study();
        let text = String::from_utf8(study_json(&study).unwrap()).unwrap();
        // The mark by which the command line knows a file as its own lies within the first 64 bytes.
        assert!(text[..64].contains("\"schema\": \"dropcheck."));
        let entries = text.lines().filter(|line| line.starts_with("    {\"angle_deg\":")).count();
        assert_eq!(entries, study.rows.len() + study.ladders.len(), "{text}");
    }

    #[test]
    fn no_predictions_are_an_empty_list() {
        let study = Study { rows: Vec::new(), ..sample_study::study() };
        assert_eq!(read(&study_json(&study).unwrap())["predictions"], Value::Array(Vec::new()));
    }

    #[test]
    fn there_is_a_row_a_prediction() {
        let study = sample_study::study();
        let text = String::from_utf8(csv(&study.rows).unwrap()).unwrap();
        assert_eq!(text.lines().count(), 1 + study.rows.len());
        let columns = |line: &str| line.split(',').count();
        assert!(text.lines().all(|line| columns(line) == COLUMNS.len()), "{text}");
        assert!(text.starts_with("angle_deg,model,contact,k,slap_down_speed_m_s,vertical_velocity_m_s,"));
        assert_eq!(COLUMNS[13].0, "regime");
    }

    #[test]
    fn what_does_not_exist_is_an_empty_cell() {
        let mut rows = sample_study::study().rows;
        rows[1].prediction.slap_down_speed_m_s = None;
        rows[1].prediction.vertical_velocity_m_s = Some(f64::NAN);
        let text = String::from_utf8(csv(&rows).unwrap()).unwrap();
        assert!(text.lines().nth(2).unwrap().starts_with("15,rod,rough,1,,,"), "{text}");
    }

    #[test]
    fn each_row_is_a_line_in_its_order() {
        let row = sample_study::study().rows[0].clone();
        let rows: Vec<PredictionRow> = (0..2051)
            .map(|i| PredictionRow { length_m: f64::from(u32::try_from(i).unwrap()), ..row.clone() })
            .collect();
        let text = String::from_utf8(csv(&rows).unwrap()).unwrap();
        assert_eq!(text.lines().count(), 1 + rows.len());
        assert!(
            text.lines()
                .skip(1)
                .enumerate()
                .all(|(i, line)| line.split(',').nth(14) == Some(&*i.to_string()))
        );
    }
}
