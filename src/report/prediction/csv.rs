//! Predictions to CSV: one row each; what does not exist is an empty cell.

use super::super::ReportError;
use super::super::records::finished;
use crate::data::PredictionRow;
use rayon::prelude::*;
use std::fmt::Display;
use std::io::Write;

/// Heads of the columns.
const HEADER: [&str; 19] = [
    "angle_deg",
    "model",
    "contact",
    "k",
    "slap_down_speed_m_s",
    "vertical_velocity_m_s",
    "horizontal_velocity_m_s",
    "angular_velocity_rad_s",
    "flight_time_s",
    "energy_ratio",
    "slap_down_angle_deg",
    "first_end_impacts",
    "impulse_ratio",
    "regime",
    "length_m",
    "drop_height_m",
    "friction_to_stick",
    "sticks",
    "closed_form_speed_m_s",
];

/// Rows that one core writes at a time: enough that handing them out costs nothing.
pub(super) const CHUNK: usize = 2048;

/// The CSV of `predict`.
///
/// # Errors
/// [`ReportError::Csv`] where the writer fails.
pub fn csv(rows: &[PredictionRow]) -> Result<Vec<u8>, ReportError> {
    let chunks: Result<Vec<Vec<u8>>, ReportError> = rows.par_chunks(CHUNK).map(lines).collect();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(HEADER)?;
    let mut bytes = finished(writer)?;
    for chunk in chunks? {
        bytes.extend(chunk);
    }
    Ok(bytes)
}

fn lines(rows: &[PredictionRow]) -> Result<Vec<u8>, ReportError> {
    let mut out = Cells {
        writer: csv::Writer::from_writer(Vec::with_capacity(rows.len() * 256)),
        text: Vec::with_capacity(32),
    };
    for PredictionRow { angle_deg, length_m, drop_height_m, prediction: p } in rows {
        out.put(angle_deg)?;
        out.put(p.model.as_str())?;
        out.put(p.contact)?;
        out.put(p.k)?;
        out.number(p.slap_down_speed_m_s)?;
        out.number(p.vertical_velocity_m_s)?;
        out.number(p.horizontal_velocity_m_s)?;
        out.number(Some(p.angular_velocity_rad_s))?;
        out.number(p.flight_time_s)?;
        out.number(p.energy_ratio)?;
        out.number(p.slap_down_angle_deg)?;
        out.put(p.first_end_impacts)?;
        out.number(Some(p.impulse_ratio))?;
        out.put(p.regime)?;
        out.put(length_m)?;
        out.put(drop_height_m)?;
        out.number(Some(p.friction_to_stick))?;
        out.put(p.sticks)?;
        out.number(p.closed_form_speed_m_s)?;
        out.writer.write_record(None::<&[u8]>)?;
    }
    finished(out.writer)
}

/// The cells of a row, each set in the same buffer: 75 000 rows have over a million.
struct Cells {
    writer: csv::Writer<Vec<u8>>,
    text: Vec<u8>,
}

impl Cells {
    fn put(&mut self, value: impl Display) -> csv::Result<()> {
        self.text.clear();
        write!(self.text, "{value}")?;
        self.writer.write_field(&self.text)
    }

    fn number(&mut self, value: Option<f64>) -> csv::Result<()> {
        match value.filter(|v| v.is_finite()) {
            Some(value) => self.put(value),
            None => self.writer.write_field(""),
        }
    }
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
        assert!(text.lines().all(|line| columns(line) == HEADER.len()), "{text}");
        // The first fourteen columns are those that scripts know; what follows them may grow.
        assert!(text.starts_with("angle_deg,model,contact,k,slap_down_speed_m_s,vertical_velocity_m_s,"));
        assert_eq!(HEADER[13], "regime");
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
