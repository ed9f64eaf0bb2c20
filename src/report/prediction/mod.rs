//! Predictions to a table, JSON and CSV.

use super::ReportError;
use super::columns::columns;
use super::rounding::{optional_fixed, plain};
use super::text::{Style, WIDTH, styled_lines, wrap};
use crate::data::{CaskFile, Contact, FlightRegime, Prediction};
use serde::Serialize;

/// A prediction at its angle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictionRow {
    /// Inclination at first contact, degrees.
    pub angle_deg: f64,
    /// What the model says.
    #[serde(flatten)]
    pub prediction: Prediction,
}

/// Heads of the columns of [`cells`].
pub(super) const HEADER: [&str; 9] =
    ["model", "contact", "k", "v m/s", "vz m/s", "vx m/s", "ω rad/s", "flight ms", "energy"];

/// Columns of [`HEADER`] that are numbers.
pub(super) const RIGHT: [usize; 7] = [2, 3, 4, 5, 6, 7, 8];

/// One prediction as the cells under [`HEADER`].
pub(super) fn cells(p: &Prediction) -> Vec<String> {
    vec![
        p.model.as_str().to_owned(),
        format!("{}{}", contact_words(p.contact), kept_mark(p.regime)),
        plain(p.k, 3),
        optional_fixed(p.slap_down_speed_m_s, 2),
        optional_fixed(p.vertical_velocity_m_s, 2),
        optional_fixed(p.horizontal_velocity_m_s, 2),
        optional_fixed(Some(p.angular_velocity_rad_s), 2),
        optional_fixed(p.flight_time_s.map(|t| t * 1e3), 1),
        optional_fixed(p.energy_ratio, 3),
    ]
}

/// What marks a prediction whose first end stays on the target.
const KEPT_MARK: &str = "†";

/// What the mark means.
pub(super) const KEPT_SENTENCE: &str =
    "† the first end stays on the target until the second strikes; in all other cases it flies.";

/// The mark, where it applies.
pub(super) fn kept_mark(regime: FlightRegime) -> &'static str {
    match regime {
        FlightRegime::Free => "",
        FlightRegime::Contact | FlightRegime::Mixed => KEPT_MARK,
    }
}

/// "rough", "smooth" or "μ 0.4".
pub(super) fn contact_words(contact: Contact) -> String {
    match contact {
        Contact::Coulomb(coefficient) => format!("μ {}", plain(coefficient, 3)),
        contact => contact.to_string(),
    }
}

/// The table of `predict`, 80 columns wide.
#[must_use]
pub fn table(rows: &[PredictionRow], file: &CaskFile) -> String {
    let what = format!(
        "{} · drop {} m, impact velocity {} m/s · g {} m/s²",
        file.cask.name,
        plain(file.drop.height_m, 5),
        plain(file.drop.impact_velocity_m_s, 5),
        plain(file.drop.gravity_m_s2, 6)
    );
    let mut header = vec!["φ0 °"];
    header.extend(HEADER);
    let right: Vec<usize> = std::iter::once(0).chain(RIGHT.iter().map(|i| i + 1)).collect();
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            let mut line = vec![plain(row.angle_deg, 6)];
            line.extend(cells(&row.prediction));
            line
        })
        .collect();
    let title = styled_lines(Style::Bold, &wrap(&what, WIDTH, 0));
    let mut out = format!("{title}\n{}", columns(&header, &cells, &right));
    if rows.iter().any(|row| row.prediction.slap_down_speed_m_s.is_none()) {
        out.push_str(&wrap("– the second end never strikes by this impact alone.", WIDTH, 2));
    }
    if rows.iter().any(|row| row.prediction.regime == FlightRegime::Contact) {
        out.push_str(&wrap(KEPT_SENTENCE, WIDTH, 2));
    }
    if rows.iter().any(|row| row.prediction.first_end_impacts > 1) {
        let text = "The first end touches the target again before the second strikes in some of these cases.";
        out.push_str(&wrap(text, WIDTH, 2));
    }
    out
}

/// The JSON of `predict`.
///
/// # Errors
/// [`ReportError::Json`] where the writer fails.
pub fn json(rows: &[PredictionRow]) -> Result<Vec<u8>, ReportError> {
    #[derive(Serialize)]
    struct Document<'a> {
        schema: &'static str,
        version: &'static str,
        predictions: &'a [PredictionRow],
    }
    super::json::pretty(&Document {
        schema: "dropcheck.prediction/1",
        version: env!("CARGO_PKG_VERSION"),
        predictions: rows,
    })
}

/// The CSV of `predict`; what does not exist is an empty cell.
///
/// # Errors
/// [`ReportError::Csv`] where the writer fails.
pub fn csv(rows: &[PredictionRow]) -> Result<Vec<u8>, ReportError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
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
    ])?;
    let cell =
        |value: Option<f64>| value.filter(|v| v.is_finite()).map_or_else(String::new, |v| v.to_string());
    for PredictionRow { angle_deg, prediction: p } in rows {
        writer.write_record([
            angle_deg.to_string(),
            p.model.as_str().to_owned(),
            p.contact.to_string(),
            p.k.to_string(),
            cell(p.slap_down_speed_m_s),
            cell(p.vertical_velocity_m_s),
            cell(p.horizontal_velocity_m_s),
            cell(Some(p.angular_velocity_rad_s)),
            cell(p.flight_time_s),
            cell(p.energy_ratio),
            cell(p.slap_down_angle_deg),
            p.first_end_impacts.to_string(),
            cell(Some(p.impulse_ratio)),
            p.regime.to_string(),
        ])?;
    }
    writer.into_inner().map_err(|error| ReportError::Csv(csv::Error::from(error.into_error())))
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    fn rows() -> Vec<PredictionRow> {
        let mut rows: Vec<PredictionRow> = sample::analysis()
            .result
            .predictions
            .into_iter()
            .map(|prediction| PredictionRow { angle_deg: 15.0, prediction })
            .collect();
        rows[1].prediction.slap_down_speed_m_s = None;
        rows
    }

    #[test]
    fn the_json_is_the_contracts() {
        let json: serde_json::Value = serde_json::from_slice(&json(&rows()).unwrap()).unwrap();
        assert_eq!(json["schema"], "dropcheck.prediction/1");
        assert_eq!(json["predictions"][0]["model"], "rod");
        assert_eq!(json["predictions"][0]["angle_deg"], 15.0);
        assert!(json["predictions"][1]["slap_down_speed_m_s"].is_null());
    }

    #[test]
    fn the_table_fits_and_says_what_the_dash_means() {
        let text = table(&rows(), &sample::analysis().cask_file);
        let text = anstream::adapter::strip_str(&text).to_string();
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(text.contains("never strikes"));
    }

    #[test]
    fn the_csv_has_a_row_a_prediction() {
        let text = String::from_utf8(csv(&rows()).unwrap()).unwrap();
        assert_eq!(text.lines().count(), 9);
        assert!(text.lines().nth(2).unwrap().starts_with("15,rod,rough,1,,"));
    }
}
