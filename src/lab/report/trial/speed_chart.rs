//! A family of methods to its chart: error over time, a panel for each class, the front drawn.

use super::families::Family;
use crate::lab::data::TrialPoint;
use crate::report::pictures::draw::{Picture, Plate};
use crate::report::pictures::panel::{COLOURS, Curve, GREY, INK, Panel, PanelAxis, PointShape, Points};

/// Height of a panel.
const PANEL: u32 = 410;
/// An error below this is drawn at it: less than a rounding of the peak.
const LEAST_ERROR: f64 = 1e-17;
/// An error above this is drawn at it: the method diverged.
const MOST_ERROR: f64 = 1e3;
/// Decades below the largest error: beyond them nothing differs to an engineer; roundings stay in sight.
const MOST_DECADES: i32 = 20;

/// The chart.
pub(super) fn picture(family: &Family) -> Picture {
    let caption = format!(
        "Error ({}, median; the line upwards ends at the 95th percentile) over the time of a {} (median and quartiles). Below and left is better. \
         Grey line: the front, what no other beats in both. Ring: what the program takes. Hollow: programs of others, which take no part in the front.",
        family.error_unit, family.time_per
    );
    let title = format!("Speed against accuracy: {}", family.name);
    let methods = family.methods();
    let look = |(i, method): (usize, &&str)| Points {
        is_hollow: family.is_peer(method),
        ..Points::new(COLOURS[i % COLOURS.len()], PointShape::of(i), Vec::new()).named(*method)
    };
    let looks: Vec<Points> = methods.iter().enumerate().map(look).collect();
    let axes = axes(family);
    let classes = family.classes();
    let class_panels = classes.iter().map(|class| panel(&axes, class, &family.of_class(class), &looks));
    let legend = Panel { points: looks.clone(), ..Panel::default() };
    let panels: Vec<Panel> = [legend].into_iter().chain(class_panels).collect();
    Plate { columns: 2, ..Plate::new(&family.file_name(), title, caption) }.picture(&panels)
}

fn drawn_error(error: f64) -> f64 {
    if error.is_nan() { MOST_ERROR } else { error.clamp(LEAST_ERROR, MOST_ERROR) }
}

/// Whole decades around the values; one and a half at least.
fn decades(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite() && *v > 0.0)
        .fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return (1e-1, 1e1);
    }
    let (low, high) = ((0.5 * low).log10().floor(), (2.0 * high).log10().ceil());
    (10_f64.powf(low), 10_f64.powf(high.max(low + 1.0)))
}

/// Time and error, the same for every class.
fn axes(family: &Family) -> [PanelAxis; 2] {
    let points = || family.points.iter().map(|(p, _)| p);
    let times = decades(points().flat_map(|p| p.time_quartiles_ns.into_iter().chain([p.time_ns])));
    let (least, most) = decades(points().flat_map(|p| [p.median_error, p.p95_error].map(drawn_error)));
    let errors = (least.max(most * 10_f64.powi(-MOST_DECADES)), most);
    [
        PanelAxis::new(format!("ns a {}", family.time_per)).logarithmic().over(Some(times)),
        PanelAxis::new(format!("error, {}", family.error_unit)).logarithmic().over(Some(errors)),
    ]
}

/// The panel of one class.
fn panel(axes: &[PanelAxis; 2], class: &str, points: &[(&TrialPoint, bool)], looks: &[Points]) -> Panel {
    let [x, y] = axes.clone();
    let least = y.range.map_or(LEAST_ERROR, |(least, _)| least);
    let height = |error| drawn_error(error).max(least);
    let place = |p: &TrialPoint| (p.time_ns.max(f64::MIN_POSITIVE), height(p.median_error));
    let mut front: Vec<(f64, f64)> = points.iter().filter(|(_, on)| *on).map(|(p, _)| place(p)).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut panel = Panel {
        title: class.to_owned(),
        x,
        y,
        height: PANEL,
        // A line a step: a longer one would lose the order of its points where two stand above one another.
        lines: steps(&front).windows(2).map(|step| Curve::new(GREY, step.to_vec())).collect(),
        ..Panel::default()
    };
    for (point, _) in points {
        let Some(look) = looks.iter().find(|look| look.label.as_ref() == Some(&point.method)) else {
            continue;
        };
        let at = place(point);
        let [low_ns, high_ns] = point.time_quartiles_ns.map(|t| t.max(f64::MIN_POSITIVE));
        for ends in [[at, (at.0, height(point.p95_error))], [(low_ns, at.1), (high_ns, at.1)]] {
            panel.lines.push(Curve { stroke: 3, ..Curve::new(look.colour, ends.into()) });
        }
        if point.is_default {
            panel.points.push(Points { radius: 21, ..Points::new(INK, PointShape::Ring, vec![at]) });
        }
        panel.points.push(Points { at: vec![at], label: None, ..look.clone() });
    }
    panel
}

/// A staircase: from one point on until the next is better.
fn steps(front: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut stairs = Vec::new();
    for (i, at) in front.iter().enumerate() {
        if let Some(before) = i.checked_sub(1).map(|before| front[before]) {
            stairs.push((at.0, before.1));
        }
        stairs.push(*at);
    }
    stairs
}
