//! The gradient of the speed over the drop angle to one picture, with the angles at which the speed does not tell k.

use super::super::text::distinct;
use super::super::words::{angles_words, case_words};
use super::draw::{Picture, Plate};
use super::look::{Look, angle_panel};
use super::panel::{Curve, Dash, Fill, GREY, Panel, PointShape, Points};
use crate::data::{Sensitivity, Study};

const NOTHING: (&str, &str) =
    ("There is nothing to show: the second end never strikes.", "No case of this study has a slap-down.");

/// The picture.
pub(super) fn picture(study: &Study, name: &str) -> Picture {
    let contacts = distinct(study.sensitivities.iter().map(|s| s.contact));
    let ks: Vec<f64> = study.sensitivities.iter().map(|s| s.k).collect();
    let look = Look::of(&contacts, &ks);
    let shown: Vec<&Sensitivity> =
        study.sensitivities.iter().filter(|s| look.shows(s.contact, s.k)).collect();
    let mut panels = [by_k(study, &shown, &look), by_angle(study, &shown, &look)];
    let cut = panels.each_mut().map(clip).contains(&true);
    let cut = if cut {
        " Where the first end strikes again the gradient is steep and runs off the picture."
    } else {
        ""
    };
    let blind: Vec<String> = shown
        .iter()
        .filter(|s| !s.blind_angles_deg.is_empty())
        .map(|s| {
            let angles = angles_words(&s.blind_angles_deg, usize::MAX);
            format!("{} at {angles}°", case_words(s.contact, s.k))
        })
        .collect();
    let blind = if blind.is_empty() { String::new() } else { format!(" Blind: {}.", blind.join("; ")) };
    let model = shown.first().map_or("", |s| s.model.as_str());
    let caption = format!(
        "How the slap-down speed of the {model} answers to the coefficient of restitution and to the drop angle. Dots: ∂v/∂k is nil and k \
         cannot be told from the speed. Wide and pale: 1 % of the speed is more than 0.1 in k; there k must come from the rebound, the \
         rotation or the flight time.{cut}{blind}{}",
        look.left_out()
    );
    Plate::new(name, "Sensitivity of the slap-down speed", caption).or(NOTHING).picture(&panels)
}

fn by_k(study: &Study, shown: &[&Sensitivity], look: &Look) -> Panel {
    let mut panel = angle_panel(&study.request, "To the restitution".into(), "∂v/∂k, m/s");
    panel.height = 440;
    panel.lines.extend(zero(study, shown));
    for s in shown {
        let line = line(s, &s.by_k_m_s, look);
        let inside = |angle: f64| s.blind_bands_deg.iter().any(|&(from, to)| (from..=to).contains(&angle));
        let poorly = line.points.iter().map(|&(x, y)| if inside(x) { (x, y) } else { (x, f64::NAN) });
        panel.lines.push(Curve {
            label: None,
            stroke: 20,
            opacity: 0.25,
            dash: Dash::Solid,
            points: poorly.collect(),
            ..line
        });
        let blind = s.blind_angles_deg.iter().map(|angle| (*angle, 0.0)).collect();
        panel.points.push(Points::new(line.colour, PointShape::Dot, blind));
        panel.lines.push(line);
    }
    if shown.iter().any(|s| !s.blind_bands_deg.is_empty()) {
        panel.fills.push(Fill::new(GREY, 0.35, Vec::new()).named("k poorly told"));
    }
    panel
}

fn by_angle(study: &Study, shown: &[&Sensitivity], look: &Look) -> Panel {
    let mut panel = angle_panel(&study.request, "To the drop angle".into(), "∂v/∂φ, m/s per °");
    panel.lines.extend(zero(study, shown));
    panel.lines.extend(shown.iter().map(|s| line(s, &s.by_angle_m_s_deg, look)));
    panel
}

/// The line on which nothing changes, where there is anything to hold against it.
fn zero(study: &Study, shown: &[&Sensitivity]) -> Option<Curve> {
    let angles = &study.request.angles_deg;
    let any = shown.iter().any(|s| s.by_k_m_s.iter().any(|v| v.is_finite()));
    let ends = angles.first().into_iter().chain(angles.last()).map(|x| (*x, 0.0)).collect();
    any.then(|| Curve { opacity: 0.8, stroke: 2, ..Curve::new(GREY, ends) })
}

/// Share of the values that the axis leaves out at either end: the few steep places would flatten all others.
const OFF_THE_AXIS: f64 = 0.06;

/// Ends the axis where most of the values end; whether any lies beyond.
fn clip(panel: &mut Panel) -> bool {
    let labelled = panel.lines.iter().filter(|line| line.label.is_some());
    let mut values: Vec<f64> =
        labelled.flat_map(|line| &line.points).map(|p| p.1).filter(|y| y.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let (Some(&least), Some(&most)) = (values.first(), values.last()) else { return false };
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of a short list's length"
    )]
    let off = (values.len() as f64 * OFF_THE_AXIS) as usize;
    let (low, high) = (values[off].min(0.0), values[values.len() - 1 - off].max(0.0));
    let span = (high - low).max(f64::MIN_POSITIVE);
    let (low, high) = ((low - 0.5 * span).max(least.min(0.0)), (high + 0.5 * span).min(most.max(0.0)));
    let air = 0.06 * (high - low).max(f64::MIN_POSITIVE);
    let (low, high) = (low - air, high + air);
    panel.y.range = Some((low, high));
    least < low || most > high
}

fn line(s: &Sensitivity, values: &[f64], look: &Look) -> Curve {
    let points = s.angle_deg.iter().copied().zip(values.iter().copied()).collect();
    Curve::new(look.colour(s.contact, s.k), points).named(case_words(s.contact, s.k)).broken(look.dash(s.k))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_does_not_flatten_the_rest() {
        let points: Vec<(f64, f64)> =
            (0..100_i32).map(|i| (f64::from(i), if i == 50 { 1e4 } else { f64::from(i % 7) })).collect();
        let line = Curve::new(GREY, points).named("case");
        let mut panel = Panel { lines: vec![line], ..Panel::default() };
        assert!(clip(&mut panel));
        assert!(panel.y.range.is_some_and(|(low, high)| low <= 0.0 && (6.0..20.0).contains(&high)));
    }
}
