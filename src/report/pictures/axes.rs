//! One panel to its axes, areas, lines, points and marks.

use super::super::text::printable;
use super::decimate::runs;
use super::legend::heading;
use super::panel::{
    Area, BOTTOM, FONT, Fill, GAP, GREY, INK, LEFT, Line, MARK_ROW, Mark, Panel, RIGHT, WIDTH,
};
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Draws `panel` into `area`, its axes below `head` units.
pub(super) fn one<X, Y>(area: &Area, panel: &Panel, head: i32, axes: (X, Y)) -> Result<(), String>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let fail = |e: DrawingAreaErrorKind<_>| e.to_string();
    let mut chart = ChartBuilder::on(area)
        .margin_top(head)
        .margin_right(RIGHT)
        .margin_bottom(GAP)
        .x_label_area_size(BOTTOM)
        .y_label_area_size(LEFT)
        .build_cartesian_2d(axes.0, axes.1)
        .map_err(fail)?;
    chart
        .configure_mesh()
        .x_desc(panel.x_label)
        .y_desc(panel.y_label)
        .axis_desc_style((FONT, 32, &INK))
        .label_style((FONT, 30, &INK))
        .axis_style(GREY)
        .bold_line_style(GREY.mix(0.28))
        .light_line_style(GREY.mix(if panel.logarithmic { 0.10 } else { 0.0 }))
        .x_labels(12)
        .y_labels(8)
        .x_label_formatter(&|x| tick(*x, panel.logarithmic))
        .y_label_formatter(&|y| tick(*y, panel.logarithmic))
        .draw()
        .map_err(fail)?;
    let bounds = (chart.x_range(), chart.y_range());
    for fill in &panel.fills {
        draw_fill(&mut chart, fill)?;
    }
    // What is faint lies under what is bold.
    let (faint, bold): (Vec<_>, Vec<_>) = panel.lines.iter().partition(|line| line.opacity < 0.5);
    for line in faint.into_iter().chain(bold) {
        draw_line(&mut chart, panel, line, &bounds.0)?;
    }
    for dot in &panel.dots {
        let rim = Circle::new(dot.at, 13, WHITE.filled());
        chart.draw_series([rim, Circle::new(dot.at, 10, dot.colour.filled())]).map_err(fail)?;
    }
    heading(area, panel)?;
    let rows = panel.mark_rows(&bounds.0);
    for (mark, row) in panel.marks.iter().zip(rows) {
        if !(bounds.0.start..=bounds.0.end).contains(&mark.at) {
            continue;
        }
        let top = chart.backend_coord(&(mark.at, bounds.1.end));
        let bottom = chart.backend_coord(&(mark.at, bounds.1.start));
        draw_mark(area, mark, row, top, bottom)?;
    }
    Ok(())
}

fn draw_line<X, Y>(
    chart: &mut ChartContext<SVGBackend, Cartesian2d<X, Y>>,
    panel: &Panel,
    line: &Line,
    x: &std::ops::Range<f64>,
) -> Result<(), String>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let style = line.colour.mix(line.opacity).stroke_width(line.stroke);
    let place = |v: f64| if panel.logarithmic { v.log10() } else { v };
    let missing = (f64::NAN, f64::NAN);
    let points: Vec<(f64, f64)> = line
        .points
        .iter()
        .map(|&(x, y)| if panel.drawable((x, y)) { (place(x), y) } else { missing })
        .collect();
    for run in runs(&points, place(x.start), place(x.end), WIDTH as usize) {
        let run: Vec<(f64, f64)> =
            run.into_iter().map(|(x, y)| (if panel.logarithmic { 10f64.powf(x) } else { x }, y)).collect();
        match line.dash.pieces() {
            Some((piece, gap)) => chart.draw_series(DashedLineSeries::new(run, piece, gap, style)).map(drop),
            None => chart.draw_series(LineSeries::new(run, style)).map(drop),
        }
        .map_err(|e| e.to_string())?;
    }
    Ok(())
}

fn draw_fill<X, Y>(chart: &mut ChartContext<SVGBackend, Cartesian2d<X, Y>>, fill: &Fill) -> Result<(), String>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let areas = fill.areas.iter().map(|area| Polygon::new(area.clone(), fill.colour.mix(fill.opacity)));
    chart.draw_series(areas).map(drop).map_err(|e| e.to_string())
}

fn draw_mark(
    area: &Area,
    mark: &Mark,
    row: usize,
    top: (i32, i32),
    bottom: (i32, i32),
) -> Result<(), String> {
    let fail = |e: DrawingAreaErrorKind<_>| e.to_string();
    let base = area.get_base_pixel();
    let (top, bottom) = ((top.0 - base.0, top.1 - base.1), (bottom.0 - base.0, bottom.1 - base.1));
    let lift = MARK_ROW * i32::try_from(row).unwrap_or(0);
    let mut y = top.1 - lift;
    while y < bottom.1 {
        let end = (y + 10).min(bottom.1);
        area.draw(&PathElement::new(vec![(top.0, y), (top.0, end)], INK.mix(0.55).stroke_width(2)))
            .map_err(fail)?;
        y += 18;
    }
    let half = i32::try_from(mark.label.chars().count()).unwrap_or(0) * 7;
    let x = top.0.clamp(LEFT.cast_signed() + half - 20, WIDTH.cast_signed() - half - 8);
    let style = TextStyle::from((FONT, 30).into_font()).color(&INK).pos(Pos::new(HPos::Center, VPos::Bottom));
    area.draw(&Text::new(printable(&mark.label), (x, top.1 - lift - 4), style)).map_err(fail)
}

/// A tick's number: as short as it reads well, powers of ten where the axis is logarithmic.
fn tick(value: f64, logarithmic: bool) -> String {
    if logarithmic && !(1e-2..1e5).contains(&value) {
        return format!("{value:.0e}").replace('-', "−");
    }
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded }).replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_read_well() {
        assert_eq!(tick(-0.000_000_01, false), "0");
        assert_eq!(tick(-12.5, false), "−12.5");
        assert_eq!(tick(1e-5, true), "1e−5");
        assert_eq!(tick(100.0, true), "100");
    }
}
