//! Curves over the drop angle to pictures: components (Figs. 4 and 5), magnitudes (Fig. 7), energy (Fig. 8),
//! sections (Fig. 9).

use super::super::rounding::plain;
use super::super::words::{case_words, contact_words};
use super::draw::{Picture, Plate};
use super::look::{Look, angle_panel, apart, body_words, from_zero, pale_sentence};
use super::panel::{COLOURS, Colour, Curve, Dash, Panel};
use crate::data::{AngleCurve, BodyModel, Contact, Study};

const SPEED_LABEL: &str = "slap-down speed, m/s";
const NOTHING: (&str, &str) =
    ("There is nothing to show: the second end never strikes.", "No case of this study has a slap-down.");
const OPEN: &str = "Where a line is broken off the second end never strikes; where the first end strikes again before it, the line may jump.";

/// Stroke of the closed forms: they alone are that fine.
const HELD_STROKE: u32 = 3;
/// How the closed form for k = 0 is named in every legend.
const HELD: &str = "held on the target";
const HELD_SENTENCE: &str =
    "Dotted: the closed form for k = 0 ([P] Table 2), the first end held on the target whatever the force.";

/// |vx|, |vz| and the magnitude over the angle for one contact law, lowest and highest k.
pub(super) fn components(study: &Study, contact: Contact, name: &str) -> Picture {
    let ks = ends(&Look::of(&[contact], &study.request.ks).ks);
    let panels = panels(study, "speed, m/s", |curve| {
        let Some(place) = ks.iter().position(|k| k.to_bits() == curve.k.to_bits()) else { return Vec::new() };
        if curve.contact != contact {
            return Vec::new();
        }
        let dash = if place == 0 { Dash::Solid } else { Dash::Dashed };
        let parts: [(&str, &[f64]); 3] = [
            ("magnitude", &curve.speed_m_s),
            ("|vertical|", &curve.vertical_velocity_m_s),
            ("|horizontal|", &curve.horizontal_velocity_m_s),
        ];
        let line = |(i, (words, values)): (usize, (&str, &[f64]))| {
            let label = format!("{words}, k = {}", plain(curve.k, 3));
            // Broad under the others: at small angles the magnitude all but coincides with the vertical part.
            let stroke = if i == 0 { 8 } else { 4 };
            Curve { stroke, ..line_of(curve, label, COLOURS[i], dash, values) }
        };
        let mut lines: Vec<Curve> =
            parts.into_iter().enumerate().flat_map(|part| apart(line(part), &curve.turns_over)).collect();
        lines.extend(held_line(curve, COLOURS[0], format!("magnitude, {HELD}")));
        lines
    });
    let figure = match contact {
        Contact::Smooth => " ([P] Fig. 4)",
        Contact::Rough => " ([P] Fig. 5)",
        Contact::Coulomb(_) | Contact::Unknown => "",
    };
    let contact = contact_words(contact);
    let many =
        if ks.len() < study.request.ks.len() { " Only the lowest and the highest k are drawn." } else { "" };
    let caption = format!(
        "Velocity of the second end just before it strikes, {contact}: absolute values of its components and its magnitude over \
         the drop angle{figure}. {OPEN}{}{}{many}",
        held_sentence(&panels),
        pale_sentence(&panels)
    );
    Plate::new(name, format!("Components of the slap-down velocity, {contact}"), caption)
        .or(NOTHING)
        .picture(&panels)
}

/// Magnitudes of every case.
pub(super) fn speeds(study: &Study, name: &str) -> Picture {
    let look = Look::of(&study.request.contacts, &study.request.ks);
    let panels = panels(study, SPEED_LABEL, |curve| {
        let Some(line) = case_line(&look, curve, &curve.speed_m_s) else { return Vec::new() };
        // The third k is dotted itself.
        let held = (look.ks.len() <= 2)
            .then(|| held_line(curve, line.colour, format!("{}, {HELD}", contact_words(curve.contact))));
        apart(line, &curve.turns_over).into_iter().chain(held.flatten()).collect()
    });
    let (title, figure) = if name == "smooth-rough" {
        ("Slap-down speed, smooth against rough", " ([P] Fig. 7)")
    } else {
        ("Slap-down speed", "")
    };
    let caption = format!(
        "Magnitude of the velocity of the second end just before it strikes, over the drop angle{figure}. {OPEN}{}{}{}",
        held_sentence(&panels),
        pale_sentence(&panels),
        look.left_out()
    );
    Plate::new(name, title, caption).or(NOTHING).picture(&panels)
}

/// Ratio of kinetic energies of every case.
pub(super) fn energies(study: &Study, name: &str) -> Picture {
    let look = Look::of(&study.request.contacts, &study.request.ks);
    let panels = panels(study, "kinetic energy ratio", |curve| {
        let line = case_line(&look, curve, &curve.energy_ratio);
        line.map_or_else(Vec::new, |line| apart(line, &curve.turns_over))
    });
    let caption = format!(
        "Kinetic energy just before the slap-down over that just before the first impact ([P] Fig. 8). Above 1 the fall of the mass \
         centre between the impacts adds more than the first impact took. {OPEN}{}{}",
        pale_sentence(&panels),
        look.left_out()
    );
    Plate::new(name, "Energy left for the second impact", caption).or(NOTHING).picture(&panels)
}

/// The cask's length with different sections, smooth and elastic.
pub(super) fn sections(study: &Study, name: &str) -> Picture {
    let title = "Smooth, k = 1".to_owned();
    let own_m = study.cask_file.cask.height_m;
    let mut panel = angle_panel(&study.request, title, SPEED_LABEL);
    for (i, curve) in study.sections.iter().enumerate() {
        let section = format!("{} mm", plain(curve.height_m * 1e3, 4));
        // The last one is the cask's own, with its centre of gravity and inertia.
        let own = i > 0 && i + 1 == study.sections.len() && (curve.height_m - own_m).abs() < 1e-9;
        let label = match (curve.height_m > 0.0, own) {
            (_, true) => format!("the cask's own {section}"),
            (false, false) => "thin rod".to_owned(),
            (true, false) => section,
        };
        // The thin rod and 10 mm all but coincide: the one is wide and pale under the other.
        let (stroke, opacity) = if i == 0 { (14, 0.35) } else { (4, 1.0) };
        let dash = if i == 1 { Dash::Dashed } else { Dash::Solid };
        let colour = COLOURS[if i < 2 { i } else { i % COLOURS.len() }];
        let line = Curve { opacity, stroke, ..line_of(curve, label, colour, dash, &curve.speed_m_s) };
        panel.lines.extend(apart(line, &curve.turns_over));
    }
    panel.height = 520;
    let caption = format!(
        "Slap-down speed over the drop angle for {} m of length and different sections in the plane of the drop, perfectly elastic smooth \
         impact ([P] Fig. 9). {OPEN}{}",
        plain(study.cask_file.cask.length_m, 4),
        pale_sentence(std::slice::from_ref(&panel))
    );
    Plate::new(name, "The section of the cask against the thin rod", caption).or(NOTHING).picture(&[panel])
}

/// One panel a body with the lines that `lines` makes of its curves.
fn panels(study: &Study, y_label: &'static str, lines: impl Fn(&AngleCurve) -> Vec<Curve>) -> Vec<Panel> {
    [BodyModel::Rod, BodyModel::Body]
        .into_iter()
        .filter(|model| study.curves.iter().any(|curve| curve.model == *model))
        .map(|model| {
            let mut panel =
                angle_panel(&study.request, body_words(model, &study.cask_file.cask, true), y_label);
            panel.lines = ordered(study, model).into_iter().flat_map(&lines).collect();
            // Closed forms last, so that the legend names the cases first.
            panel.lines.sort_by_key(|line| line.stroke == HELD_STROKE);
            panel.y.range = from_zero(&panel);
            panel
        })
        .collect()
}

/// The curves of a body: by contact law as asked for, the highest k first.
fn ordered(study: &Study, model: BodyModel) -> Vec<&AngleCurve> {
    let mut curves: Vec<&AngleCurve> = study.curves.iter().filter(|c| c.model == model).collect();
    let place = |curve: &AngleCurve| study.request.contacts.iter().position(|c| *c == curve.contact);
    curves.sort_by(|a, b| place(a).cmp(&place(b)).then(b.k.total_cmp(&a.k)));
    curves
}

fn case_line(look: &Look, curve: &AngleCurve, values: &[f64]) -> Option<Curve> {
    let (contact, k) = (curve.contact, curve.k);
    look.shows(contact, k)
        .then(|| line_of(curve, case_words(contact, k), look.colour(contact, k), look.dash(k), values))
}

fn line_of(curve: &AngleCurve, label: String, colour: Colour, dash: Dash, values: &[f64]) -> Curve {
    let points = curve.angle_deg.iter().copied().zip(values.iter().map(|v| v.abs())).collect();
    Curve::new(colour, points).named(label).broken(dash)
}

/// The closed form, where the curve has one.
fn held_line(curve: &AngleCurve, colour: Colour, label: String) -> Option<Curve> {
    let any = curve.closed_form_speed_m_s.iter().any(|v| v.is_finite());
    any.then(|| Curve {
        stroke: HELD_STROKE,
        ..line_of(curve, label, colour, Dash::Dotted, &curve.closed_form_speed_m_s)
    })
}

fn held_sentence(panels: &[Panel]) -> String {
    let any = panels.iter().flat_map(|panel| &panel.lines).any(|line| line.stroke == HELD_STROKE);
    if any { format!(" {HELD_SENTENCE}") } else { String::new() }
}

/// The highest and the lowest, in this order.
fn ends(ascending: &[f64]) -> Vec<f64> {
    let mut ends: Vec<f64> = ascending.last().into_iter().chain(ascending.first()).copied().collect();
    ends.dedup();
    ends
}
