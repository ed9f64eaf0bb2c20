//! Predictions to CSV: one row each; what does not exist is an empty cell.

use super::super::ReportError;
use super::super::records::{number, records};
use crate::data::PredictionRow;
use rayon::prelude::*;

/// A head, and what makes a cell below it.
type CsvColumn = (&'static str, fn(&PredictionRow) -> String);

/// Its columns; scripts know the first fourteen, and what follows them may grow.
const COLUMNS: [CsvColumn; 20] = [
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
];

/// Rows that one core writes at a time: enough that handing them out costs nothing.
const CHUNK: usize = 2048;

/// The CSV of `predict`.
///
/// # Errors
/// [`ReportError::Csv`] where the writer fails.
pub fn csv(rows: &[PredictionRow]) -> Result<Vec<u8>, ReportError> {
    let lines = |rows: &[PredictionRow]| records(rows.iter().map(|row| COLUMNS.map(|(_, cell)| cell(row))));
    let chunks: Result<Vec<Vec<u8>>, ReportError> = rows.par_chunks(CHUNK).map(lines).collect();
    Ok([records([COLUMNS.map(|(head, _)| head)])?, chunks?.concat()].concat())
}

#[cfg(test)]
mod tests {
    use super::super::super::sample_study;
    use super::*;

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
    fn chunks_join_without_a_seam() {
        let row = sample_study::study().rows[0].clone();
        let rows: Vec<PredictionRow> = (0..CHUNK + 3)
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
