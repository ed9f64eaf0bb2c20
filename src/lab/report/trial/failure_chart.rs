//! A failure map to its chart: error over stress, the limit drawn, and whether the program noticed.

use super::breaks;
use super::shapes::{Failure, ROW, colour, mark, rows, tick, word};
use crate::lab::data::TrialMap;
use crate::report::pictures::Picture;
use crate::report::pictures::panel::{self, Area, FONT, GREY, INK, WIDTH};
use crate::report::text::printable;
use crate::report::{ReportError, rounding};
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;
use std::ops::Range;

/// Height of a panel of many lines, and of one of three at most.
const PANEL: u32 = 600;
const PANEL_OF_FEW: u32 = 440;
/// Decades that are drawn below the limit and above it.
const BELOW: i32 = 14;
const ABOVE: i32 = 3;
const ALARM: RGBColor = RGBColor(179, 38, 30);

/// The name of the chart's file, without ".svg".
pub(super) fn file_name(map: &TrialMap) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    format!("map-{}", map.name.chars().map(plain).collect::<String>())
}

/// The chart.
pub(super) fn picture(map: &TrialMap) -> Result<Picture, ReportError> {
    let name = file_name(map);
    let failed = |reason| ReportError::Picture { picture: name.clone(), reason };
    let svg = draw(map).map_err(failed)?;
    let broken: Vec<String> = map
        .lines
        .iter()
        .filter_map(|line| {
            let at = breaks::of(map, line).at?;
            Some(format!("{} at {}", printable(&line.method), rounding::plain(at, 2)))
        })
        .collect();
    let found = if broken.is_empty() {
        "None passes the limit.".to_owned()
    } else {
        format!("Passes the limit: {}.", broken.join("; "))
    };
    let tells = map.lines.iter().any(|line| line.noticed.iter().any(Option::is_some));
    let marks = if tells {
        " Large marks: the program said that something is wrong, or its interval holds the truth; small dots: it did not, or has no way to; \
         red crosses: beyond the limit and not said."
    } else {
        " No method of this map has a way to say that something is wrong."
    };
    let title = printable(&map.title);
    let caption = format!("{found}{marks}");
    let alt = format!("{title}. {caption}");
    let svg = panel::described(&svg, &title);
    Ok(Picture { name, title, alt, caption, svg })
}

/// The error axis: what is given, within some decades of the limit.
fn error_axis(map: &TrialMap) -> Range<f64> {
    let given = map.lines.iter().flat_map(|line| line.errors.iter().flatten());
    let (low, high) = given
        .filter(|e| e.is_finite() && **e > 0.0)
        .fold((map.limit, map.limit), |(low, high), e| (low.min(*e), high.max(*e)));
    let limit = map.limit.max(f64::MIN_POSITIVE);
    let low = low.max(limit * 10_f64.powi(-BELOW)).log10().floor();
    let high = (1.5 * high).min(limit * 10_f64.powi(ABOVE)).log10().ceil();
    10_f64.powf(low)..10_f64.powf(high.max(low + 1.0))
}

fn draw(map: &TrialMap) -> Result<String, String> {
    let words: Vec<String> = map.lines.iter().map(|line| printable(&line.method)).collect();
    let (places, legend_rows) = rows(&words, 66);
    let head = u32::try_from(70 + ROW * legend_rows).map_err(|e| e.to_string())?;
    let height = head + if map.lines.len() > 3 { PANEL } else { PANEL_OF_FEW };
    let finite = || map.stresses.iter().copied().filter(|s| s.is_finite() && (!map.is_log || *s > 0.0));
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)));
    if low > high {
        return panel::nothing("There is nothing to show: no stress was tried.");
    }
    let (low, high) = if low < high { (low, high) } else { (0.9 * low - 0.1, 1.1 * high + 0.1) };
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        let failed = |e: Failure| e.to_string();
        root.fill(&WHITE).map_err(failed)?;
        let (legend, area) = root.split_vertically(head);
        word(&legend, &map.title, (30, 30), 34).map_err(failed)?;
        for (i, (text, (left, top))) in words.iter().zip(&places).enumerate() {
            let y = top + 80;
            let sample = vec![(*left, y), (left + 54, y)];
            legend.draw(&PathElement::new(sample, colour(i).stroke_width(4))).map_err(failed)?;
            mark(&legend, i, (left + 27, y), false).map_err(failed)?;
            word(&legend, text, (left + 66, y + 1), 30).map_err(failed)?;
        }
        if map.is_log {
            let air = (high / low).powf(0.02);
            one(&area, map, (low / air..high * air).log_scale()).map_err(failed)?;
        } else {
            let air = 0.02 * (high - low);
            one(&area, map, low - air..high + air).map_err(failed)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(panel::sized(&svg, height))
}

fn one<X>(area: &Area, map: &TrialMap, x: X) -> Result<(), Failure>
where
    X: AsRangedCoord<Value = f64>,
    X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let y = error_axis(map);
    let mut chart = ChartBuilder::on(area)
        .margin_top(14)
        .margin_right(40)
        .margin_bottom(20)
        .x_label_area_size(86)
        .y_label_area_size(130)
        .build_cartesian_2d(x, y.clone().log_scale())?;
    chart
        .configure_mesh()
        .x_desc(printable(&map.stress))
        .y_desc(printable(&map.error))
        .axis_desc_style((FONT, 31, &INK))
        .label_style((FONT, 29, &INK))
        .axis_style(GREY)
        .bold_line_style(GREY.mix(0.28))
        .light_line_style(GREY.mix(0.06))
        .x_labels(10)
        .y_labels(9)
        .x_label_formatter(&|v| if map.is_log { tick(*v) } else { rounding::plain(*v, 3) })
        .y_label_formatter(&|v| tick(*v))
        .draw()?;
    let range = chart.x_range();
    let limit = vec![(range.start, map.limit), (range.end, map.limit)];
    chart.draw_series(DashedLineSeries::new(limit, 14, 9, ALARM.stroke_width(3)))?;
    let base = area.get_base_pixel();
    let pixel = |at: (f64, f64)| {
        let (x, y) = chart.backend_coord(&at);
        (x - base.0, y - base.1)
    };
    let (left, top) = pixel((range.start, map.limit));
    word(area, &format!("limit {}", tick(map.limit)), (left + 12, top - 18), 28)?;
    for (i, line) in map.lines.iter().enumerate() {
        let place = |(stress, error): (&f64, &Option<f64>)| {
            let error = (*error)?;
            let error = if error.is_nan() { y.end } else { error.clamp(y.start, y.end) };
            (!map.is_log || *stress > 0.0).then(|| pixel((*stress, error)))
        };
        let places: Vec<Option<(i32, i32)>> = map.stresses.iter().zip(&line.errors).map(place).collect();
        for run in places.split(Option::is_none).filter(|run| run.len() > 1) {
            let run: Vec<(i32, i32)> = run.iter().copied().flatten().collect();
            area.draw(&PathElement::new(run, colour(i).stroke_width(4)))?;
        }
        let noticed = line.noticed.iter().copied().chain(std::iter::repeat(None));
        for ((at, error), noticed) in places.into_iter().zip(&line.errors).zip(noticed) {
            let Some(at) = at else { continue };
            let beyond = error.is_some_and(|e| e.is_nan() || e > map.limit);
            match noticed {
                Some(true) => mark(area, i, at, false)?,
                Some(false) if beyond => cross(area, at)?,
                _ => area.draw(&Circle::new(at, 6, colour(i).filled()))?,
            }
        }
    }
    Ok(())
}

fn cross(area: &Area, (x, y): (i32, i32)) -> Result<(), Failure> {
    for (dx, dy) in [(11, 11), (11, -11)] {
        let stroke = vec![(x - dx, y - dy), (x + dx, y + dy)];
        area.draw(&PathElement::new(stroke, ALARM.stroke_width(6)))?;
    }
    Ok(())
}
