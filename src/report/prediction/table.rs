//! Predictions to the table that the terminal shows, 80 columns wide.

use super::super::columns::{columns, fitting_columns};
use super::super::rounding::{optional_fixed, plain};
use super::super::text::{Style, WIDTH, styled_lines, wrap};
use super::summary;
use super::words::{KEPT_SENTENCE, contact_words, kept_mark};
use crate::data::{BodyModel, CaskFile, Contact, FlightRegime, Prediction, PredictionRow, Study};

/// Heads of the columns of [`cells`].
pub(in super::super) const HEADER: [&str; 9] =
    ["model", "contact", "k", "v m/s", "vz m/s", "vx m/s", "ω rad/s", "flight ms", "energy"];

/// Columns of [`HEADER`] that are numbers.
pub(in super::super) const RIGHT: [usize; 7] = [2, 3, 4, 5, 6, 7, 8];

/// The same heads on two lines, so that a tenth column has room.
const NARROW: [&str; 9] =
    ["model", "contact", "k", "v\nm/s", "vz\nm/s", "vx\nm/s", "ω\nrad/s", "flight\nms", "energy"];

/// More rows than this are not shown: three screens.
const MOST_ROWS: usize = 400;

/// Rows shown at either end of a table that is too long.
const ENDS: usize = 12;

/// What marks a prediction whose first end strikes again.
const AGAIN_MARK: &str = "‡";

/// One prediction as the cells under [`HEADER`].
pub(in super::super) fn cells(p: &Prediction) -> Vec<String> {
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

/// The whole of a study for the terminal: the predictions, then what else was found, each in a block of its own.
#[must_use]
pub fn study_table(study: &Study) -> String {
    format!("{}{}", table(&study.rows, &study.cask_file), summary::blocks(study))
}

/// The table of predictions alone.
#[must_use]
pub fn table(rows: &[PredictionRow], file: &CaskFile) -> String {
    let varies = |value: fn(&PredictionRow) -> f64| {
        rows.iter().any(|row| value(row).to_bits() != value(&rows[0]).to_bits())
    };
    let (lengths, heights) = (varies(|row| row.length_m), varies(|row| row.drop_height_m));
    let mut out = title(file, heights);
    // With two more columns the closed form has no room left; the CSV has it.
    let held = !(lengths && heights) && rows.iter().any(|row| row.prediction.closed_form_speed_m_s.is_some());
    let mut header = vec!["φ0\n°"];
    header.extend(lengths.then_some("l\nm"));
    header.extend(heights.then_some("drop\nm"));
    let leading = header.len();
    header.extend(NARROW);
    header.extend(held.then_some("held\nm/s"));
    let line = |row: &PredictionRow| {
        let mut line = vec![plain(row.angle_deg, 6)];
        line.extend(lengths.then(|| plain(row.length_m, 4)));
        line.extend(heights.then(|| plain(row.drop_height_m, 4)));
        line.extend(cells(&row.prediction));
        if row.prediction.first_end_impacts > 1 {
            line[leading + 1].push_str(AGAIN_MARK);
        }
        line.extend(held.then(|| {
            row.prediction.closed_form_speed_m_s.map_or_else(String::new, |v| optional_fixed(Some(v), 2))
        }));
        line
    };
    let body: Vec<Vec<String>> = if rows.len() > MOST_ROWS {
        let dots = std::iter::once(vec!["…".to_owned(); header.len()]);
        rows[..ENDS].iter().map(line).chain(dots).chain(rows[rows.len() - ENDS..].iter().map(line)).collect()
    } else {
        rows.iter().map(line).collect()
    };
    let right: Vec<usize> = (0..header.len()).filter(|i| *i != leading && *i != leading + 1).collect();
    out.push_str(&fitting_columns(&header, &body, &right));
    out.push_str(&notes(rows, held));
    out
}

fn title(file: &CaskFile, heights: bool) -> String {
    let drop = if heights {
        String::new() // each row has its own
    } else {
        let (height, velocity) = (plain(file.drop.height_m, 5), plain(file.drop.impact_velocity_m_s, 5));
        format!("drop {height} m, impact velocity {velocity} m/s · ")
    };
    let what = format!("{} · {drop}g {} m/s²", file.cask.name, plain(file.drop.gravity_m_s2, 6));
    styled_lines(Style::Bold, &wrap(&what, WIDTH, 0))
}

/// What the marks and the dash mean, each once.
fn notes(rows: &[PredictionRow], held: bool) -> String {
    let any = |wanted: &dyn Fn(&Prediction) -> bool| rows.iter().any(|row| wanted(&row.prediction));
    let mut notes: Vec<String> = Vec::new();
    if rows.len() > MOST_ROWS {
        notes.push(format!(
            "… {} of {} rows are left out here: --out and --json hold them all.",
            rows.len() - 2 * ENDS,
            rows.len()
        ));
    }
    if any(&|p| p.slap_down_speed_m_s.is_none()) {
        notes.push("– the second end never strikes by this impact alone.".into());
    }
    if any(&|p| !kept_mark(p.regime).is_empty()) {
        notes.push(KEPT_SENTENCE.into());
    }
    if any(&|p| p.first_end_impacts > 1) {
        notes.push(format!("{AGAIN_MARK} the first end strikes again before the second does."));
    }
    if held {
        notes.push(
            "held: closed form for k = 0 ([P] Table 2), the first end held on the target whatever the force."
                .into(),
        );
    }
    notes.extend(friction_note(rows));
    notes.iter().map(|note| wrap(note, WIDTH, 2)).collect()
}

/// The friction that sticking needs, where all rows of a body share it.
fn friction_note(rows: &[PredictionRow]) -> Option<String> {
    let needed = |model: BodyModel| {
        let mut of_model = rows.iter().map(|row| &row.prediction).filter(|p| p.model == model);
        let first = of_model.next()?.friction_to_stick;
        let same = of_model.all(|p| (p.friction_to_stick - first).abs() < 5e-4);
        (same && first.is_finite()).then(|| format!("{} ({})", plain(first, 3), model.as_str()))
    };
    let models = [BodyModel::Rod, BodyModel::Body];
    let words: Vec<String> = models.into_iter().filter_map(needed).collect();
    let present = models.iter().filter(|m| rows.iter().any(|row| row.prediction.model == **m)).count();
    if words.is_empty() || words.len() < present {
        return None;
    }
    let slides = rows
        .iter()
        .any(|row| matches!(row.prediction.contact, Contact::Coulomb(_)) && !row.prediction.sticks);
    let end = if slides { ": with less it slides" } else { "" };
    Some(format!("The first end sticks where the friction is at least {}{end}.", words.join(", ")))
}

/// The predictions of an analysis, at one angle.
pub(in super::super) fn at_one_angle(predictions: &[Prediction]) -> String {
    let rows: Vec<Vec<String>> = predictions.iter().map(cells).collect();
    let mut out = columns(&HEADER, &rows, &RIGHT);
    if predictions.iter().any(|p| p.regime == FlightRegime::Contact) {
        out.push_str(&wrap(KEPT_SENTENCE, WIDTH, 2));
    }
    out
}
