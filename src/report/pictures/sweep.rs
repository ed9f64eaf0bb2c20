//! Picture of a sweep's predictions: speed over the swept variable, a line per case.

use super::super::rounding::plain;
use super::super::text::dedup;
use super::super::words::{contact_words, variable_words};
use super::draw::{Figure, Picture};
use super::look::{Look, NO_SLAP_DOWN, body_words, line_sentences, pick_evenly, split_turnovers};
use super::panel::{COLOURS, Curve, Panel, PanelAxis};
use crate::data::{BodyModel, Contact, PredictionRow, Study, Sweep, SweepVariable};

const TITLE: &str = "Slap-down speed over the sweep";
/// Most values of a second variable that are drawn, one line each.
const MOST_LINES: usize = 7;
/// Panels of one picture: a page.
const MOST_PANELS: usize = 4;

/// Draws the picture: the variable with the most values along the axis, the next one as lines, further ones
/// at their middle value.
pub(super) fn picture(study: &Study, name: &str) -> Picture {
    let mut sweeps: Vec<&Sweep> = study.request.sweeps.iter().collect();
    // The sort is stable: among equal numbers of values the variable named first wins.
    sweeps.sort_by_key(|sweep| std::cmp::Reverse(sweep.values.len()));
    let Some((along, others)) = sweeps.split_first() else {
        return Figure::new(name, TITLE, "").empty(NO_SLAP_DOWN).picture(&[]);
    };
    let held: Vec<(SweepVariable, f64)> = others
        .iter()
        .skip(1)
        .filter_map(|sweep| Some((sweep.variable, *sweep.values.get(sweep.values.len() / 2)?)))
        .collect();
    let cases = cases(study, &held);
    let (panels, left_out) = match others.first() {
        None => curves(study, along, cases),
        Some(second) => families(study, (along, second), cases),
    };
    let mut fixed: Vec<String> = held.iter().map(|(v, at)| value_words(*v, *at)).collect();
    if !is_swept(study, SweepVariable::Angle) {
        fixed.push(value_words(SweepVariable::Angle, study.request.angle_deg));
    }
    let fixed = if fixed.is_empty() { String::new() } else { format!(" Drawn at {}.", fixed.join(", ")) };
    let caption = format!(
        "Magnitude of the velocity of the second end just before it strikes. {}{fixed}{left_out}",
        line_sentences(&panels)
    );
    Figure::new(name, TITLE, caption).empty(NO_SLAP_DOWN).picture(&panels)
}

fn is_swept(study: &Study, variable: SweepVariable) -> bool {
    study.request.sweeps.iter().any(|sweep| sweep.variable == variable)
}

/// Case of a line or a panel: a body, a contact law and k; any, if friction or k is swept.
struct SweepCase<'a> {
    model: BodyModel,
    contact: Contact,
    k: f64,
    /// Words such as "rough, k = 1", without the swept variable.
    words: String,
    rows: Vec<&'a PredictionRow>,
}

/// Cases of the rows at the fixed values, each with its rows.
fn cases<'a>(study: &'a Study, held: &[(SweepVariable, f64)]) -> Vec<SweepCase<'a>> {
    let friction_swept = is_swept(study, SweepVariable::Friction);
    let k_swept = is_swept(study, SweepVariable::K);
    let mut cases: Vec<SweepCase> = Vec::new();
    for row in study.rows.iter().filter(|row| held.iter().all(|(v, at)| has_value(row, *v, *at))) {
        let p = &row.prediction;
        let (contact, k) =
            (if friction_swept { Contact::Rough } else { p.contact }, if k_swept { 0.0 } else { p.k });
        let is_its = |case: &&mut SweepCase| {
            case.model == p.model && case.contact == contact && case.k.to_bits() == k.to_bits()
        };
        if let Some(case) = cases.iter_mut().find(is_its) {
            case.rows.push(row);
            continue;
        }
        let words = [
            (!friction_swept).then(|| contact_words(contact)),
            (!k_swept).then(|| format!("k = {}", plain(k, 3))),
        ];
        let words = words.into_iter().flatten().collect::<Vec<_>>().join(", ");
        cases.push(SweepCase { model: p.model, contact, k, words, rows: vec![row] });
    }
    cases
}

/// Picture of one variable: a panel per body, a line per contact law and k.
fn curves(study: &Study, along: &Sweep, mut cases: Vec<SweepCase>) -> (Vec<Panel>, String) {
    let contacts = dedup(cases.iter().map(|case| case.contact));
    let look = Look::new(&contacts, &cases.iter().map(|case| case.k).collect::<Vec<f64>>());
    cases.retain(|case| look.shows(case.contact, case.k));
    cases.sort_by_key(|case| look.place(case.contact, case.k));
    let panels = [BodyModel::Rod, BodyModel::Body].map(|model| {
        let lines = cases.iter().filter(|case| case.model == model).flat_map(|case| {
            let (points, turns_over) = points(case.rows.iter().copied(), along.variable);
            let line = look.line(case.contact, case.k, points);
            let label = Some(case.words.clone()).filter(|words| !words.is_empty());
            split_turnovers(Curve { label, ..line }, &turns_over)
        });
        panel(study, along, model, "", lines.collect())
    });
    (panels.into(), look.left_out_sentence())
}

/// Picture of two variables: a panel per case, a line per value of the second variable.
fn families(
    study: &Study,
    (along, second): (&Sweep, &Sweep),
    mut cases: Vec<SweepCase>,
) -> (Vec<Panel>, String) {
    let all = cases.len();
    if all > MOST_PANELS && cases.iter().any(|case| case.model == BodyModel::Body) {
        cases.retain(|case| case.model == BodyModel::Body);
    }
    cases.truncate(MOST_PANELS);
    let values = pick_evenly(&second.values, MOST_LINES);
    let panels = cases.iter().map(|case| {
        let lines = values.iter().enumerate().flat_map(|(i, value)| {
            let of_line = case.rows.iter().copied().filter(|row| has_value(row, second.variable, *value));
            let (points, turns_over) = points(of_line, along.variable);
            let line = Curve::new(COLOURS[i % COLOURS.len()], points);
            split_turnovers(line.label(value_words(second.variable, *value)), &turns_over)
        });
        panel(study, along, case.model, &case.words, lines.collect())
    });
    let panels = panels.collect();
    let left_out = |all: usize, shown: usize, what: &str| {
        if shown < all { format!(" Of {all} {what} {shown} are drawn.") } else { String::new() }
    };
    let of_second = format!("values of \"{}\"", variable_words(second.variable));
    let of_values = left_out(second.values.len(), values.len(), &of_second);
    (panels, of_values + &left_out(all, cases.len(), "cases"))
}

fn panel(study: &Study, along: &Sweep, model: BodyModel, case: &str, lines: Vec<Curve>) -> Panel {
    let body = body_words(model, &study.cask_file.cask, !is_swept(study, SweepVariable::Length));
    let ends = along.values.first().copied().zip(along.values.last().copied());
    let x = PanelAxis::new(variable_words(along.variable)).range(ends.filter(|(from, to)| from < to));
    let title = if case.is_empty() { body } else { format!("{body}, {case}") };
    Panel { lines, ..Panel::new(title, x, "slap-down speed, m/s", 380) }
}

/// A value with the symbol and the unit of its variable.
fn value_words(variable: SweepVariable, value: f64) -> String {
    let value = plain(value, 4);
    match variable {
        SweepVariable::Angle => format!("{value}°"),
        SweepVariable::K => format!("k = {value}"),
        SweepVariable::Friction => format!("μ {value}"),
        SweepVariable::Length => format!("l = {value} m"),
        SweepVariable::DropHeight => format!("drop {value} m"),
    }
}

/// The value of the swept variable; `None` if a row has none.
fn swept_value(row: &PredictionRow, variable: SweepVariable) -> Option<f64> {
    match variable {
        SweepVariable::Angle => Some(row.angle_deg),
        SweepVariable::K => Some(row.prediction.k),
        SweepVariable::Friction => match row.prediction.contact {
            Contact::Coulomb(coefficient) => Some(coefficient),
            Contact::Smooth => Some(0.0),
            Contact::Rough | Contact::Unknown => None,
        },
        SweepVariable::Length => Some(row.length_m),
        SweepVariable::DropHeight => Some(row.drop_height_m),
    }
}

/// True if a row was made at this value, except for round-off.
fn has_value(row: &PredictionRow, variable: SweepVariable, value: f64) -> bool {
    swept_value(row, variable).is_some_and(|v| (v - value).abs() <= 1e-9 * value.abs().max(1.0))
}

/// Speed over the variable, ascending, NaN if the second end never strikes; and true where the cask turns
/// over.
fn points<'a>(
    rows: impl Iterator<Item = &'a PredictionRow>,
    along: SweepVariable,
) -> (Vec<(f64, f64)>, Vec<bool>) {
    let mut points: Vec<((f64, f64), bool)> = rows
        .filter_map(|row| {
            let speed_m_s = row.prediction.slap_down_speed_m_s.unwrap_or(f64::NAN);
            Some(((swept_value(row, along)?, speed_m_s), row.prediction.turns_over()))
        })
        .collect();
    points.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
    points.into_iter().unzip()
}

#[cfg(test)]
mod tests {
    use super::super::super::sample_study;
    use super::*;

    #[test]
    fn a_panel_a_case_and_a_line_a_value() {
        let study = sample_study::sweep_study();
        let picture = picture(&study, "sweep");
        // Two bodies with one contact law and one k; three lengths over the angle.
        for words in ["Thin rod, μ 0.3, k = 0.5", "section 0.792 m, μ 0.3, k = 0.5", "l = 4 m", "l = 6 m"] {
            assert!(picture.svg.contains(words), "{words}");
        }
        assert!(!picture.svg.contains("5.512"));
    }

    #[test]
    fn a_third_variable_is_held_at_its_middle() {
        let mut study = sample_study::sweep_study();
        study.request.sweeps.push(Sweep { variable: SweepVariable::DropHeight, values: vec![8.0, 9.0] });
        let picture = picture(&study, "sweep");
        assert!(picture.caption.contains("Drawn at drop 9 m"), "{}", picture.caption);
    }

    #[test]
    fn friction_takes_the_place_of_the_contact_law() {
        let mut study = sample_study::study();
        let values: Vec<f64> = (0..9).map(|i| f64::from(i) * 0.1).collect();
        let row = study.rows[1].clone();
        study.rows = values
            .iter()
            .map(|mu| {
                let mut row = row.clone();
                row.prediction.contact = Contact::Coulomb(*mu);
                row
            })
            .collect();
        study.request.sweeps = vec![Sweep { variable: SweepVariable::Friction, values }];
        let picture = picture(&study, "sweep");
        assert!(picture.svg.contains("friction coefficient μ") && picture.svg.contains("k = 1"));
        assert!(!picture.svg.contains("rough"));
        assert!(picture.caption.contains("Drawn at 15°"));
    }
}
