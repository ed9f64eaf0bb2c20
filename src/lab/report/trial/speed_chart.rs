//! A family of methods to its chart: error over time, a panel for each class, the front drawn.

use super::families::Family;
use super::shapes::{Failure, ROW, colour, mark, rows, tick, word};
use crate::lab::data::TrialPoint;
use crate::report::ReportError;
use crate::report::pictures::Picture;
use crate::report::pictures::panel::{self, Area, FONT, GREY, INK, WIDTH};
use crate::report::text::printable;
use plotters::prelude::*;
use std::ops::Range;

/// Panels beside each other, and the height of one.
const COLUMNS: usize = 2;
const PANEL: u32 = 560;
/// An error below this is drawn at it: less than a rounding of the peak.
const LEAST_ERROR: f64 = 1e-17;
/// An error above this is drawn at it: the method diverged.
const MOST_ERROR: f64 = 1e3;
const MOST_DECADES: i32 = 12;

/// The chart.
pub(super) fn picture(family: &Family) -> Result<Picture, ReportError> {
    let name = family.file_name();
    let title = format!("Speed against accuracy: {}", printable(family.name));
    let failed = |reason| ReportError::Picture { picture: name.clone(), reason };
    let svg = draw(family).map_err(failed)?;
    let caption = format!(
        "Error ({}, median; the line upwards ends at the 95th percentile) over the time of a {} (median and quartiles). Below and left is better. \
         Grey line: the front, what no other beats in both. Ring: what the program takes. Hollow: programs of others, which take no part in the front.",
        printable(family.error_unit),
        printable(family.time_per)
    );
    let alt = format!("{title}. {caption}");
    let svg = panel::described(&svg, &title);
    Ok(Picture { name, title, alt, caption, svg })
}

fn drawn_error(error: f64) -> f64 {
    if error.is_nan() { MOST_ERROR } else { error.clamp(LEAST_ERROR, MOST_ERROR) }
}

/// Whole decades around the values; one and a half at least.
fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values
        .filter(|v| v.is_finite() && *v > 0.0)
        .fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return 1e-1..1e1;
    }
    let (low, high) = ((0.5 * low).log10().floor(), (2.0 * high).log10().ceil());
    10_f64.powf(low)..10_f64.powf(high.max(low + 1.0))
}

fn draw(family: &Family) -> Result<String, String> {
    let methods = family.methods();
    let words: Vec<String> = methods.iter().map(|m| printable(m)).collect();
    let (places, legend_rows) = rows(&words, 34);
    let head = u32::try_from(20 + ROW * legend_rows).map_err(|e| e.to_string())?;
    let classes = family.classes();
    let panel_rows = u32::try_from(classes.len().div_ceil(COLUMNS)).map_err(|e| e.to_string())?;
    let height = head + PANEL * panel_rows;
    let x =
        decades(family.points.iter().flat_map(|(p, _)| p.time_quartiles_ns.into_iter().chain([p.time_ns])));
    let mut y =
        decades(family.points.iter().flat_map(|(p, _)| [p.median_error, p.p95_error].map(drawn_error)));
    // Beyond that many decades below the top nothing differs to an engineer; roundings stay in sight.
    y.start = y.start.max(y.end * 10_f64.powi(-MOST_DECADES - 8));
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        let failed = |e: Failure| e.to_string();
        root.fill(&WHITE).map_err(failed)?;
        let (legend, panels) = root.split_vertically(head);
        for (i, (text, (left, top))) in words.iter().zip(&places).enumerate() {
            mark(&legend, i, (left + 12, top + 30), family.is_peer(methods[i])).map_err(failed)?;
            word(&legend, text, (left + 34, top + 31), 30).map_err(failed)?;
        }
        for (class, area) in classes.iter().zip(panels.split_evenly((panel_rows as usize, COLUMNS))) {
            one(&area, family, &methods, class, (x.clone(), y.clone())).map_err(failed)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(panel::sized(&svg, height))
}

/// The panel of one class.
fn one(
    area: &Area,
    family: &Family,
    methods: &[&str],
    class: &str,
    (x, y): (Range<f64>, Range<f64>),
) -> Result<(), Failure> {
    word(area, class, (120, 26), 31)?;
    let mut chart = ChartBuilder::on(area)
        .margin_top(50)
        .margin_right(30)
        .margin_bottom(18)
        .x_label_area_size(82)
        .y_label_area_size(118)
        .build_cartesian_2d(x.log_scale(), y.clone().log_scale())?;
    let y_label = format!("error, {}", family.error_unit);
    chart
        .configure_mesh()
        .x_desc(format!("ns a {}", family.time_per))
        .y_desc(printable(&y_label))
        .axis_desc_style((FONT, 29, &INK))
        .label_style((FONT, 27, &INK))
        .axis_style(GREY)
        .bold_line_style(GREY.mix(0.28))
        .light_line_style(GREY.mix(0.08))
        .x_labels(8)
        .y_labels(9)
        .x_label_formatter(&|v| tick(*v))
        .y_label_formatter(&|v| tick(*v))
        .draw()?;
    let points = family.of_class(class);
    let mut front: Vec<(f64, f64)> = points.iter().filter(|(_, on)| *on).map(|(p, _)| place(p, &y)).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    chart.draw_series([PathElement::new(steps(&front), GREY.mix(0.7).stroke_width(4))])?;
    let base = area.get_base_pixel();
    let pixel = |at: (f64, f64)| {
        let (x, y) = chart.backend_coord(&at);
        (x - base.0, y - base.1)
    };
    for (point, _) in points {
        let index = methods.iter().position(|m| *m == point.method).unwrap_or(0);
        let at = place(point, &y);
        let high = drawn_error(point.p95_error).max(y.start);
        let [low_ns, high_ns] = point.time_quartiles_ns.map(|t| t.max(f64::MIN_POSITIVE));
        let whiskers = [[at, (at.0, high)], [(low_ns, at.1), (high_ns, at.1)]];
        for [from, to] in whiskers {
            area.draw(&PathElement::new(vec![pixel(from), pixel(to)], colour(index).stroke_width(3)))?;
        }
        if point.is_default {
            area.draw(&Circle::new(pixel(at), 21, INK.stroke_width(4)))?;
        }
        mark(area, index, pixel(at), point.is_peer())?;
    }
    Ok(())
}

fn place(point: &TrialPoint, y: &Range<f64>) -> (f64, f64) {
    (point.time_ns.max(f64::MIN_POSITIVE), drawn_error(point.median_error).max(y.start))
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
