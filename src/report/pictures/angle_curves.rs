//! Pictures of curves over the drop angle: components (Figs. 4 and 5), magnitudes (Fig. 7), energy (Fig. 8),
//! sections (Fig. 9).

use super::super::rounding::plain;
use super::super::words::{case_words, contact_words};
use super::draw::{Figure, Picture};
use super::look::{
    DASHES, HELD_STROKE, Look, NO_SLAP_DOWN, angle_panel, body_words, line_sentences, range_from_zero,
    split_turnovers,
};
use super::panel::{COLOURS, Curve, Dash, Panel};
use crate::data::{AngleCurve, BodyModel, Contact, Study};

const SPEED_LABEL: &str = "slap-down speed, m/s";

/// Name of the closed form for k = 0 in every legend.
const HELD: &str = "held on the target";

/// |vx|, |vz| and the magnitude over the angle for one contact law, lowest and highest k.
pub(super) fn components(study: &Study, contact: Contact, name: &str) -> Picture {
    let look = Look::new(&[contact], &study.request.ks).with_ends();
    let panels = panels(study, &look, "speed, m/s", |curve| {
        let dash = DASHES[look.place(curve.contact, curve.k).unwrap_or_default()[1]];
        let parts: [(&str, &[f64]); 3] = [
            ("magnitude", &curve.speed_m_s),
            ("|vertical|", &curve.vertical_velocity_m_s),
            ("|horizontal|", &curve.horizontal_velocity_m_s),
        ];
        let line = |(i, (words, values)): (usize, (&str, &[f64]))| {
            let label = format!("{words}, k = {}", plain(curve.k, 3));
            // The magnitude is broad under the others: at small angles it all but coincides with the vertical
            // part.
            let stroke = if i == 0 { 8 } else { 4 };
            let line = Curve { stroke, ..Curve::new(COLOURS[i], points_over_angle(curve, values)) };
            split_turnovers(line.label(label).broken(dash), &curve.turns_over)
        };
        let held = held_line(curve, Curve::new(COLOURS[0], Vec::new()), "magnitude");
        parts.into_iter().enumerate().flat_map(line).chain(held).collect()
    });
    let figure = match contact {
        Contact::Smooth => " ([P] Fig. 4)",
        Contact::Rough => " ([P] Fig. 5)",
        Contact::Coulomb(_) | Contact::Unknown => "",
    };
    let contact = contact_words(contact);
    let left_out = look.ks.len() < study.request.ks.len();
    let caption = format!(
        "Velocity of the second end just before it strikes, {contact}: absolute values of its components and \
         its magnitude over the drop angle{figure}. {}{}",
        line_sentences(&panels),
        if left_out { " Only the lowest and the highest k are drawn." } else { "" }
    );
    Figure::new(name, format!("Components of the slap-down velocity, {contact}"), caption)
        .empty(NO_SLAP_DOWN)
        .picture(&panels)
}

/// Picture of the magnitudes of every case.
pub(super) fn speeds(study: &Study, name: &str) -> Picture {
    let look = Look::new(&study.request.contacts, &study.request.ks);
    let panels = panels(study, &look, SPEED_LABEL, |curve| {
        let line = case_line(&look, curve, &curve.speed_m_s);
        // The third k is dotted itself.
        let held = (look.ks.len() <= 2)
            .then(|| held_line(curve, line.clone(), &contact_words(curve.contact)))
            .flatten();
        split_turnovers(line, &curve.turns_over).into_iter().chain(held).collect()
    });
    let (title, figure) = if name == "smooth-rough" {
        ("Slap-down speed, smooth against rough", " ([P] Fig. 7)")
    } else {
        ("Slap-down speed", "")
    };
    let caption = format!(
        "Magnitude of the velocity of the second end just before it strikes, over the drop angle{figure}. \
         {}{}",
        line_sentences(&panels),
        look.left_out_sentence()
    );
    Figure::new(name, title, caption).empty(NO_SLAP_DOWN).picture(&panels)
}

/// Picture of the ratio of kinetic energies of every case.
pub(super) fn energies(study: &Study, name: &str) -> Picture {
    let look = Look::new(&study.request.contacts, &study.request.ks);
    let panels = panels(study, &look, "kinetic energy ratio", |curve| {
        split_turnovers(case_line(&look, curve, &curve.energy_ratio), &curve.turns_over)
    });
    let caption = format!(
        "Kinetic energy just before the slap-down over that just before the first impact ([P] Fig. 8). Above \
         1 the fall of the mass centre between the impacts adds more than the first impact took. {}{}",
        line_sentences(&panels),
        look.left_out_sentence()
    );
    Figure::new(name, "Energy left for the second impact", caption).empty(NO_SLAP_DOWN).picture(&panels)
}

/// Picture of the cask's length with different sections, smooth and elastic.
pub(super) fn sections(study: &Study, name: &str) -> Picture {
    let own_m = study.cask_file.cask.height_m;
    let mut panel = angle_panel(&study.request, "Smooth, k = 1", SPEED_LABEL);
    panel.height = 520;
    for (i, curve) in study.sections.iter().enumerate() {
        let section = format!("{} mm", plain(curve.height_m * 1e3, 4));
        // The last one is the cask itself, with its centre of gravity and inertia.
        let own = i > 0 && i + 1 == study.sections.len() && (curve.height_m - own_m).abs() < 1e-9;
        let label = match (curve.height_m > 0.0, own) {
            (_, true) => format!("the cask's own {section}"),
            (false, false) => "thin rod".to_owned(),
            (true, false) => section,
        };
        // The thin rod and 10 mm all but coincide: one is wide and pale under the other.
        let (stroke, opacity) = if i == 0 { (14, 0.35) } else { (4, 1.0) };
        let dash = if i == 1 { Dash::Dashed } else { Dash::Solid };
        let line = Curve::new(COLOURS[i % COLOURS.len()], points_over_angle(curve, &curve.speed_m_s));
        let line = Curve { opacity, stroke, ..line.label(label).broken(dash) };
        panel.lines.extend(split_turnovers(line, &curve.turns_over));
    }
    let caption = format!(
        "Slap-down speed over the drop angle for {} m of length and different sections in the plane of the \
         drop, perfectly elastic smooth impact ([P] Fig. 9). {}",
        plain(study.cask_file.cask.length_m, 4),
        line_sentences(std::slice::from_ref(&panel))
    );
    Figure::new(name, "The section of the cask against the thin rod", caption)
        .empty(NO_SLAP_DOWN)
        .picture(&[panel])
}

/// A panel for each body with the lines that `lines` makes of each of its curves: by contact law as
/// requested, the highest k first.
fn panels(
    study: &Study,
    look: &Look,
    y_label: &'static str,
    lines: impl Fn(&AngleCurve) -> Vec<Curve>,
) -> Vec<Panel> {
    let panel = |model| {
        let title = body_words(model, &study.cask_file.cask, true);
        let mut panel = angle_panel(&study.request, title, y_label);
        let place = |curve: &&AngleCurve| look.place(curve.contact, curve.k);
        let is_shown = |curve: &&AngleCurve| curve.model == model && place(curve).is_some();
        let mut curves: Vec<&AngleCurve> = study.curves.iter().filter(is_shown).collect();
        curves.sort_by_key(place);
        panel.lines = curves.into_iter().flat_map(&lines).collect();
        // Closed forms come last, so that the legend names the cases first.
        panel.lines.sort_by_key(|line| line.stroke == HELD_STROKE);
        panel.y.range = range_from_zero(&panel);
        panel
    };
    [BodyModel::Rod, BodyModel::Body].map(panel).into()
}

/// The line of a case in its look.
fn case_line(look: &Look, curve: &AngleCurve, values: &[f64]) -> Curve {
    let (contact, k) = (curve.contact, curve.k);
    look.line(contact, k, points_over_angle(curve, values)).label(case_words(contact, k))
}

/// The closed form in the colour of `like`, where the curve has one.
fn held_line(curve: &AngleCurve, like: Curve, what: &str) -> Option<Curve> {
    let any = curve.closed_form_speed_m_s.iter().any(|v| v.is_finite());
    let points = points_over_angle(curve, &curve.closed_form_speed_m_s);
    let held = Curve { stroke: HELD_STROKE, points, dash: Dash::Dotted, ..like };
    any.then(|| held.label(format!("{what}, {HELD}")))
}

/// Magnitudes of the values over the angle.
fn points_over_angle(curve: &AngleCurve, values: &[f64]) -> Vec<(f64, f64)> {
    curve.angle_deg.iter().copied().zip(values.iter().map(|v| v.abs())).collect()
}
