//! The predictions of a sweep to one picture: speed over what was swept, a line a case.

use super::super::rounding::plain;
use super::super::text::distinct;
use super::super::words::{contact_words, variable_words};
use super::draw::{Picture, Plate};
use super::look::{Look, apart, body_words, pale_sentence, spread};
use super::panel::{COLOURS, Curve, Panel, PanelAxis};
use crate::data::{BodyModel, Contact, PredictionRow, Study, Sweep, SweepVariable};

const TITLE: &str = "Slap-down speed over the sweep";
const NOTHING: (&str, &str) = (
    "There is nothing to show: the second end never strikes.",
    "No prediction of this sweep has a slap-down.",
);
/// Values of a second variable that are drawn, each a line.
const MOST_LINES: usize = 7;
/// Panels of one picture: a page.
const MOST_PANELS: usize = 4;

/// The picture: the variable with the most values along the axis, the next a line each, further ones at their
/// middle value.
pub(super) fn picture(study: &Study, name: &str) -> Picture {
    let mut sweeps: Vec<&Sweep> = study.request.sweeps.iter().collect();
    // Stable: of equally many the one named first.
    sweeps.sort_by_key(|sweep| std::cmp::Reverse(sweep.values.len()));
    let Some((along, others)) = sweeps.split_first() else {
        return Plate::new(name, TITLE, String::new()).or(NOTHING).picture(&[]);
    };
    let held: Vec<(SweepVariable, f64)> = others
        .iter()
        .skip(1)
        .filter_map(|sweep| Some((sweep.variable, *sweep.values.get(sweep.values.len() / 2)?)))
        .collect();
    let rows: Vec<&PredictionRow> =
        study.rows.iter().filter(|row| held.iter().all(|(v, at)| is_at(row, *v, *at))).collect();
    let swept = |variable| sweeps.iter().any(|sweep| sweep.variable == variable);
    let [friction_swept, k_swept] = [SweepVariable::Friction, SweepVariable::K].map(swept);
    let cases = distinct(rows.iter().map(|row| SweepCase::of(row, friction_swept, k_swept)));
    let (panels, left_out) = match others.first() {
        None => curves(study, &rows, along, &cases),
        Some(second) => families(study, &rows, (along, second), cases),
    };
    let mut fixed: Vec<String> = held.iter().map(|(v, at)| value_words(*v, *at)).collect();
    if !swept(SweepVariable::Angle) {
        fixed.push(value_words(SweepVariable::Angle, study.request.angle_deg));
    }
    let fixed = if fixed.is_empty() { String::new() } else { format!(" Drawn at {}.", fixed.join(", ")) };
    let caption = format!(
        "Magnitude of the velocity of the second end just before it strikes. Where a line is broken off the second end never strikes; \
         where the first end strikes again before it, the line may jump.{}{fixed}{left_out}",
        pale_sentence(&panels)
    );
    Plate::new(name, TITLE, caption).or(NOTHING).picture(&panels)
}

/// What a line or a panel is for; what is swept is `None`.
#[derive(Clone, Copy, PartialEq)]
struct SweepCase {
    model: BodyModel,
    contact: Option<Contact>,
    k: Option<f64>,
}

impl SweepCase {
    fn of(row: &PredictionRow, friction_swept: bool, k_swept: bool) -> Self {
        let p = &row.prediction;
        Self { model: p.model, contact: (!friction_swept).then_some(p.contact), k: (!k_swept).then_some(p.k) }
    }

    /// "rough, k = 1", without what is swept.
    fn words(self) -> String {
        let contact = self.contact.map(contact_words);
        let k = self.k.map(|k| format!("k = {}", plain(k, 3)));
        contact.into_iter().chain(k).collect::<Vec<_>>().join(", ")
    }

    fn holds(self, row: &PredictionRow) -> bool {
        self == Self::of(row, self.contact.is_none(), self.k.is_none())
    }
}

/// One variable: a panel a body, a line a contact law and k.
fn curves(
    study: &Study,
    rows: &[&PredictionRow],
    along: &Sweep,
    cases: &[SweepCase],
) -> (Vec<Panel>, String) {
    let contacts = distinct(cases.iter().map(law));
    let ks: Vec<f64> = cases.iter().map(restitution).collect();
    let look = Look::of(&contacts, &ks);
    let panels = [BodyModel::Rod, BodyModel::Body].map(|model| {
        let mut panel = panel(along, body_words(model, &study.cask_file.cask, !length_swept(study)));
        let mut shown: Vec<&SweepCase> =
            cases.iter().filter(|c| c.model == model && look.shows(law(c), restitution(c))).collect();
        let place = |case: &SweepCase| contacts.iter().position(|c| *c == law(case));
        shown.sort_by(|a, b| place(a).cmp(&place(b)).then(restitution(b).total_cmp(&restitution(a))));
        for case in shown {
            let of_case = rows.iter().copied().filter(|row| case.holds(row));
            let (points, turns_over) = points(of_case, along.variable);
            let line = Curve {
                label: Some(case.words()).filter(|words| !words.is_empty()),
                dash: look.dash(restitution(case)),
                ..Curve::new(look.colour(law(case), restitution(case)), points)
            };
            panel.lines.extend(apart(line, &turns_over));
        }
        panel
    });
    (panels.into(), look.left_out())
}

/// The contact law of a case, or any one where friction is swept.
fn law(case: &SweepCase) -> Contact {
    case.contact.unwrap_or(Contact::Rough)
}

/// k of a case, or any one where k is swept.
fn restitution(case: &SweepCase) -> f64 {
    case.k.unwrap_or(0.0)
}

/// Two variables: a panel a case, a line a value of the second variable.
fn families(
    study: &Study,
    rows: &[&PredictionRow],
    (along, second): (&Sweep, &Sweep),
    mut cases: Vec<SweepCase>,
) -> (Vec<Panel>, String) {
    let all = cases.len();
    if all > MOST_PANELS && cases.iter().any(|case| case.model == BodyModel::Body) {
        cases.retain(|case| case.model == BodyModel::Body);
    }
    cases.truncate(MOST_PANELS);
    let values = spread(&second.values, MOST_LINES);
    let panels = cases.iter().map(|case| {
        let words = [body_words(case.model, &study.cask_file.cask, !length_swept(study)), case.words()];
        let title = words.into_iter().filter(|w| !w.is_empty()).collect::<Vec<_>>().join(", ");
        let mut panel = panel(along, title);
        for (i, value) in values.iter().enumerate() {
            let of_line =
                rows.iter().copied().filter(|row| case.holds(row) && is_at(row, second.variable, *value));
            let (points, turns_over) = points(of_line, along.variable);
            let line =
                Curve::new(COLOURS[i % COLOURS.len()], points).named(value_words(second.variable, *value));
            panel.lines.extend(apart(line, &turns_over));
        }
        panel
    });
    let panels: Vec<Panel> = panels.collect();
    let mut left_out = Vec::new();
    if values.len() < second.values.len() {
        let (all, what) = (second.values.len(), variable_words(second.variable));
        left_out.push(format!(" Of {all} values of \"{what}\" {} are drawn.", values.len()));
    }
    if cases.len() < all {
        left_out.push(format!(" Of {all} cases {} are drawn.", cases.len()));
    }
    (panels, left_out.concat())
}

fn panel(along: &Sweep, title: String) -> Panel {
    let ends = along.values.first().copied().zip(along.values.last().copied());
    Panel {
        title,
        x: PanelAxis::new(variable_words(along.variable)).over(ends.filter(|(from, to)| from < to)),
        y: PanelAxis::new("slap-down speed, m/s"),
        height: 380,
        ..Panel::default()
    }
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

fn length_swept(study: &Study) -> bool {
    study.request.sweeps.iter().any(|sweep| sweep.variable == SweepVariable::Length)
}

/// The value of what is swept; `None` where a row has none.
fn value_of(row: &PredictionRow, variable: SweepVariable) -> Option<f64> {
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

/// Whether a row was made at this value, but for round-off.
fn is_at(row: &PredictionRow, variable: SweepVariable, value: f64) -> bool {
    value_of(row, variable).is_some_and(|v| (v - value).abs() <= 1e-9 * value.abs().max(1.0))
}

/// Speed over the variable, ascending, NaN where the second end never strikes; and where the cask turns over.
fn points<'a>(
    rows: impl Iterator<Item = &'a PredictionRow>,
    along: SweepVariable,
) -> (Vec<(f64, f64)>, Vec<bool>) {
    let mut points: Vec<((f64, f64), bool)> = rows
        .filter_map(|row| {
            let speed_m_s = row.prediction.slap_down_speed_m_s.unwrap_or(f64::NAN);
            Some(((value_of(row, along)?, speed_m_s), row.prediction.turns_over()))
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
        let study = sample_study::swept();
        let picture = picture(&study, "sweep");
        // Two bodies with one contact law and one k; three lengths over the angle.
        for words in ["Thin rod, μ 0.3, k = 0.5", "section 0.792 m, μ 0.3, k = 0.5", "l = 4 m", "l = 6 m"] {
            assert!(picture.svg.contains(words), "{words}");
        }
        assert!(!picture.svg.contains("5.512"));
    }

    #[test]
    fn a_third_variable_is_held_at_its_middle() {
        let mut study = sample_study::swept();
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
