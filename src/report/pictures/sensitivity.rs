//! The slope of the speed over k to one picture over the drop angle, with the angles at which the speed does not tell k.

use super::super::text::distinct;
use super::super::words::case_words;
use super::draw::{Picture, Plate};
use super::look::{Look, angle_panel};
use super::panel::{Curve, PointShape, Points};
use crate::data::Study;

const NOTHING: (&str, &str) =
    ("There is nothing to show: the second end never strikes.", "No case of this study has a slap-down.");

/// The picture.
pub(super) fn picture(study: &Study, name: &str) -> Picture {
    let contacts = distinct(study.sensitivities.iter().map(|s| s.contact));
    let ks: Vec<f64> = study.sensitivities.iter().map(|s| s.k).collect();
    let look = Look::of(&contacts, &ks);
    let mut panel = angle_panel(&study.request, String::new(), "∂v/∂k, m/s");
    // Twice as much as any gradient of one flight: the few steep places behind further impacts would flatten all others.
    let impact_m_s = study.cask_file.drop.impact_velocity_m_s;
    panel.y.range = Some((-impact_m_s, impact_m_s));
    for s in study.sensitivities.iter().filter(|s| look.shows(s.contact, s.k)) {
        let colour = look.colour(s.contact, s.k);
        let points = s.angle_deg.iter().copied().zip(s.by_k_m_s.iter().copied()).collect();
        let line = Curve::new(colour, points).named(case_words(s.contact, s.k)).broken(look.dash(s.k));
        let bar = |&(from, to): &(f64, f64)| Curve::new(colour, vec![(from, 0.0), (to, 0.0)]);
        let bars = s.blind_bands_deg.iter().map(bar);
        panel.lines.extend(bars.map(|bar| Curve { stroke: 20, opacity: 0.25, ..bar }).chain([line]));
        let blind = s.blind_angles_deg.iter().map(|angle_deg| (*angle_deg, 0.0)).collect();
        panel.points.push(Points::new(colour, PointShape::Dot, blind));
    }
    let caption = format!(
        "How the slap-down speed of the {} answers to the coefficient of restitution. Dots: ∂v/∂k is nil and k cannot be told from the \
         speed. Bars: 1 % of the speed is more than 0.1 in k; there k must come from the rebound, the rotation or the flight time. \
         Where the first end strikes again the gradient is steep and runs off the picture.{}",
        study.monte_carlo.model.as_str(),
        look.left_out()
    );
    Plate::new(name, "Sensitivity of the slap-down speed to k", caption).or(NOTHING).picture(&[panel])
}
