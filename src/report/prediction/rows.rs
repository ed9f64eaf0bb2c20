//! Table of predictions: the columns that every report of them shares, and those of a sweep.

use super::super::document::{ChapterPart, Medium, ReportTable, TableRows, TableShape, Words};
use super::super::rounding::{fixed, optional_fixed, plain, significant};
use super::super::words::{OVER_SENTENCE, REGIME_SENTENCE, TURNOVER_MARK, contact_words, regime_mark};
use crate::data::{BodyModel, CaskFile, Contact, Prediction, PredictionRow};

/// More rows than this are not shown on a terminal: three screens.
const MOST_ROWS: usize = 400;

/// Rows shown at either end of a table that is too long for a terminal.
const ENDS: usize = 12;

/// Rows on a page; the CSV has them all.
pub(super) const MOST_ON_PAGE: usize = 200;

/// Mark of a prediction whose first end strikes again.
const AGAIN_MARK: &str = "‡";

/// Adds the columns of a prediction; `None` is a row that replaces the omitted ones. On a terminal the heads
/// of a study take two lines, so that further columns have room.
pub(in super::super) fn prediction_columns<'a, R>(
    rows: TableRows<'a, R>,
    prediction: impl Fn(&'a R) -> Option<&'a Prediction> + Copy,
    in_study: bool,
) -> TableRows<'a, R> {
    let cell = |words: fn(&Prediction) -> String| {
        move |row: &'a R| prediction(row).map_or_else(|| "…".to_owned(), words)
    };
    let contact = move |row: &'a R| {
        let Some(p) = prediction(row) else { return "…".into() };
        let over = if p.turns_over() { TURNOVER_MARK } else { "" };
        let words = format!("{}{}{over}", contact_words(p.contact), regime_mark(p.regime));
        let again = if in_study && p.first_end_impacts > 1 { AGAIN_MARK } else { "" };
        Words::with_short(&words, format!("{words}{again}"))
    };
    let head = |full: &str, short: &str| {
        Words::with_short(full, if in_study { short.into() } else { short.replace('\n', " ") })
    };
    rows.text(head("Model", "model"), cell(|p| p.model.as_str().to_owned()))
        .line(head("Contact", "contact"), contact)
        .number(head("k", "k"), cell(|p| plain(p.k, 3)))
        .number(head("Speed, m/s", "v\nm/s"), cell(|p| optional_fixed(p.slap_down_speed_m_s, 2)))
        .number(head("Vertical, m/s", "vz\nm/s"), cell(|p| optional_fixed(p.vertical_velocity_m_s, 2)))
        .number(head("Horizontal, m/s", "vx\nm/s"), cell(|p| optional_fixed(p.horizontal_velocity_m_s, 2)))
        .number(head("ω, rad/s", "ω\nrad/s"), cell(|p| fixed(p.angular_velocity_rad_s, 2)))
        .number(
            head("Flight, ms", "flight\nms"),
            cell(|p| optional_fixed(p.flight_time_s.map(|t| t * 1e3), 1)),
        )
        .number(head("Energy", "energy"), cell(|p| optional_fixed(p.energy_ratio, 3)))
}

fn metres(value_m: f64) -> Words {
    Words::with_short(plain(value_m, 5), plain(value_m, 4))
}

/// Columns that the rows of a study need beside those of every prediction.
struct Varying {
    lengths: bool,
    heights: bool,
    held: bool,
}

impl Varying {
    fn from_rows(rows: &[PredictionRow]) -> Self {
        let varies = |value: fn(&PredictionRow) -> f64| {
            rows.iter().any(|row| value(row).to_bits() != value(&rows[0]).to_bits())
        };
        let held = rows.iter().any(|row| row.prediction.closed_form_speed_m_s.is_some());
        Self { lengths: varies(|row| row.length_m), heights: varies(|row| row.drop_height_m), held }
    }

    /// True if the closed form fits: with two more columns a terminal has no room for it; the CSV has it.
    fn has_room_on(&self, medium: Medium) -> bool {
        self.held && !(self.lengths && self.heights && medium == Medium::Terminal)
    }
}

/// The predictions of a study for this medium, and the meaning of their marks.
pub(super) fn predictions(all: &[PredictionRow], medium: Medium) -> Vec<ChapterPart> {
    let varying = Varying::from_rows(all);
    // The row in between replaces the omitted ones.
    let rows: Vec<Option<&PredictionRow>> = if medium != Medium::Terminal {
        all.iter().take(MOST_ON_PAGE).map(Some).collect()
    } else if all.len() > MOST_ROWS {
        let [first, last] = [&all[..ENDS], &all[all.len() - ENDS..]].map(|end| end.iter().map(Some));
        first.chain([None]).chain(last).collect()
    } else {
        all.iter().map(Some).collect()
    };
    let cell =
        |words: fn(&PredictionRow) -> Words| move |row: &Option<_>| row.map_or_else(|| "…".into(), words);
    let caption = "Velocity of the second end just before it strikes. Energy: kinetic, before the slap-down \
                   over before the first impact.";
    let table = ReportTable::from_rows(&rows)
        .class("many")
        .shape(TableShape::Fitting)
        .caption(caption)
        .number(Words::with_short("φ0, °", "φ0\n°"), cell(|row| plain(row.angle_deg, 6).into()))
        .number(Words::with_short("Length, m", "l\nm"), cell(|row| metres(row.length_m)))
        .show_if(varying.lengths)
        .number(Words::with_short("Drop, m", "drop\nm"), cell(|row| metres(row.drop_height_m)))
        .show_if(varying.heights);
    let table = prediction_columns(table, |row| row.map(|row| &row.prediction), true)
        .number("Friction to stick", cell(|row| significant(row.prediction.friction_to_stick, 3).into()))
        .only_on(Medium::Page)
        .number("Impacts of first end", cell(|row| row.prediction.first_end_impacts.to_string().into()))
        .only_on(Medium::Page)
        .number(
            Words::with_short("Closed form, m/s", "held\nm/s"),
            cell(|row| {
                row.prediction.closed_form_speed_m_s.map_or("".into(), |speed| fixed(speed, 2).into())
            }),
        )
        .show_if(varying.has_room_on(medium));
    let notes = notes(all, medium, varying.has_room_on(medium));
    let notes = notes.into_iter().map(ChapterPart::note);
    [table.into()].into_iter().chain(notes).map(|passage| passage.only_on(medium)).collect()
}

/// Title: the specimen, the height, and the impact speed.
pub(super) fn title(rows: &[PredictionRow], file: &CaskFile) -> String {
    let drop = if Varying::from_rows(rows).heights {
        String::new() // each row has its own
    } else {
        let (height, velocity) = (plain(file.drop.height_m, 5), plain(file.drop.impact_velocity_m_s, 5));
        format!("drop {height} m, impact velocity {velocity} m/s · ")
    };
    let lasts = match file.drop.contact_duration_s {
        lasts_s if lasts_s > 0.0 => format!(" · first impact {} ms", plain(lasts_s * 1e3, 4)),
        _ => String::new(),
    };
    format!("{} · {drop}g {} m/s²{lasts}", file.cask.name, plain(file.drop.gravity_m_s2, 6))
}

/// Notes on the marks and the dash, each once.
fn notes(rows: &[PredictionRow], medium: Medium, held: bool) -> Vec<String> {
    let on_terminal = medium == Medium::Terminal;
    let any = |wanted: &dyn Fn(&Prediction) -> bool| rows.iter().any(|row| wanted(&row.prediction));
    let left_out = if on_terminal {
        let shown = if rows.len() > MOST_ROWS { 2 * ENDS } else { rows.len() };
        let words = format!(
            "… {} of {} rows are left out here: --out and --json hold them all.",
            rows.len() - shown,
            rows.len()
        );
        (shown < rows.len()).then_some(words)
    } else {
        let more = rows.len().saturating_sub(MOST_ON_PAGE);
        (more > 0).then(|| format!("… and {more} more: prediction.csv and prediction.json hold them all."))
    };
    let notes = [
        left_out,
        any(&|p| p.slap_down_speed_m_s.is_none())
            .then(|| "– the second end never strikes by this impact alone.".to_owned()),
        any(&|p| !regime_mark(p.regime).is_empty()).then(|| REGIME_SENTENCE.to_owned()),
        any(&Prediction::turns_over).then(|| OVER_SENTENCE.to_owned()),
        (on_terminal && any(&|p| p.first_end_impacts > 1))
            .then(|| format!("{AGAIN_MARK} the first end strikes again before the second does.")),
        held.then(|| {
            let name = if on_terminal { "held: closed" } else { "Closed" };
            format!(
                "{name} form for k = 0 ([P] Table 2), the first end held on the target whatever the force."
            )
        }),
        friction_note(rows).filter(|_| on_terminal),
    ];
    notes.into_iter().flatten().collect()
}

/// Note on the friction that sticking needs, if all rows of a body share it.
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
