//! One panel to its axes, areas, lines, points and marks.

use super::super::text::printable;
use super::decimate::runs;
use super::legend::{Area, FONT, Failure, heading, point, word};
use super::panel::{Fill, GREY, INK, Line, Mark, Panel, PanelAxis, Scale, WIDTH};
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use std::ops::Range;

/// Height of a row of the marks' words.
const MARK_ROW: i32 = 34;
/// Room for the ticks and the label of the axes.
const LEFT: u32 = 130;
const BOTTOM: u32 = 88;
const RIGHT: u32 = 28;
/// Air below a panel.
const GAP: i32 = 26;

/// An axis as the plotter takes it.
enum Coordinate {
    Linear(RangedCoordf64),
    Logarithmic(LogCoord<f64>),
    /// Without ticks: its rows are named by words.
    Rows(Range<f64>),
}

impl Coordinate {
    fn of(axis: &PanelAxis, range: Range<f64>) -> Self {
        match axis.scale {
            Scale::Linear => Self::Linear(range.into()),
            Scale::Logarithmic => Self::Logarithmic(range.log_scale().into()),
            Scale::Rows(_) => Self::Rows(range),
        }
    }
}

impl Ranged for Coordinate {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    #[allow(clippy::cast_possible_truncation, reason = "a pixel place lies within the limits given")]
    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        match self {
            Self::Linear(axis) => axis.map(value, limit),
            Self::Logarithmic(axis) => axis.map(value, limit),
            Self::Rows(rows) => {
                let share = (value - rows.start) / (rows.end - rows.start);
                limit.0 + (share * f64::from(limit.1 - limit.0)).round() as i32
            }
        }
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match self {
            Self::Linear(axis) => axis.key_points(hint),
            Self::Logarithmic(axis) => axis.key_points(hint),
            Self::Rows(_) => Vec::new(),
        }
    }

    fn range(&self) -> Range<f64> {
        match self {
            Self::Linear(axis) => axis.range(),
            Self::Logarithmic(axis) => axis.range(),
            Self::Rows(rows) => rows.clone(),
        }
    }
}

type PanelChart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Coordinate, Coordinate>>;

impl Panel {
    /// Heights of what stands above the axes, and of the whole panel, in a picture or a part of it this wide.
    pub(super) fn heights(&self, width: u32) -> (i32, i32) {
        let rows = self.mark_rows(width).iter().max().map_or(0, |row| row + 1);
        let head = self.head(width) + MARK_ROW * i32::try_from(rows).unwrap_or(0);
        if self.height == 0 {
            return (head, head);
        }
        (head, head + GAP + (self.height + self.bottom()).cast_signed())
    }

    fn bottom(&self) -> u32 {
        if self.x.label.is_empty() { 0 } else { BOTTOM }
    }

    /// Rows that the words of the marks take, so that none writes over its neighbour.
    fn mark_rows(&self, width: u32) -> Vec<usize> {
        let mut ends: Vec<f64> = Vec::new();
        let x = self.x_range();
        let (from, to) = (self.x.place(x.start), self.x.place(x.end));
        let place = |at: f64| (self.x.place(at) - from) / (to - from) * f64::from(width - LEFT);
        self.marks
            .iter()
            .map(|mark| {
                // Half the width of a word: 0.28 em a letter at 24 units.
                let half = f64::from(u32::try_from(mark.label.chars().count()).unwrap_or(0)) * 7.0 + 8.0;
                let at = place(mark.at);
                let row = ends.iter().position(|end| at - half > *end).unwrap_or(ends.len());
                if row == ends.len() {
                    ends.push(at + half);
                } else {
                    ends[row] = at + half;
                }
                row
            })
            .collect()
    }
}

/// Draws `panel` into `area`.
pub(super) fn one(area: &Area, panel: &Panel) -> Result<(), Failure> {
    heading(area, panel)?;
    if panel.height == 0 {
        return Ok(());
    }
    let width = area.dim_in_pixel().0;
    let (left, right) = panel.sides.unwrap_or((LEFT, RIGHT));
    let mut chart = ChartBuilder::on(area)
        .margin_top(panel.heights(width).0)
        .margin_right(right)
        .margin_bottom(GAP)
        .x_label_area_size(panel.bottom())
        .y_label_area_size(left)
        .build_cartesian_2d(
            Coordinate::of(&panel.x, panel.x_range()),
            Coordinate::of(&panel.y, panel.y_range()),
        )?;
    let is_fine = panel.x.is_logarithmic() || panel.y.is_logarithmic();
    chart
        .configure_mesh()
        .x_desc(printable(&panel.x.label))
        .y_desc(printable(&panel.y.label))
        .axis_desc_style((FONT, 32, &INK))
        .label_style((FONT, 30, &INK))
        .axis_style(GREY)
        .bold_line_style(GREY.mix(0.28))
        .light_line_style(GREY.mix(if is_fine { 0.10 } else { 0.0 }))
        .x_labels(if width < WIDTH { 8 } else { 12 })
        .y_labels(8)
        .x_label_formatter(&|x| tick(*x, panel.x.is_logarithmic()))
        .y_label_formatter(&|y| tick(*y, panel.y.is_logarithmic()))
        .draw()?;
    for fill in &panel.fills {
        draw_fill(&mut chart, fill)?;
    }
    // What is faint lies under what is bold.
    let (faint, bold): (Vec<_>, Vec<_>) = panel.lines.iter().partition(|line| line.opacity < 0.5);
    for line in faint.into_iter().chain(bold) {
        draw_line(&mut chart, panel, line)?;
    }
    draw_points(area, panel, &chart)?;
    draw_rows(area, panel, &chart)?;
    let bounds = (chart.x_range(), chart.y_range());
    for (mark, row) in panel.marks.iter().zip(panel.mark_rows(width)) {
        if (bounds.0.start..=bounds.0.end).contains(&mark.at) {
            let ends = [bounds.1.end, bounds.1.start].map(|y| place(area, &chart, (mark.at, y)));
            draw_mark(area, mark, row, ends)?;
        }
    }
    Ok(())
}

/// The place in the area of a point on the axes.
fn place(area: &Area, chart: &PanelChart, at: (f64, f64)) -> (i32, i32) {
    let (base, at) = (area.get_base_pixel(), chart.backend_coord(&at));
    (at.0 - base.0, at.1 - base.1)
}

fn draw_line(chart: &mut PanelChart, panel: &Panel, line: &Line) -> Result<(), Failure> {
    let style = line.colour.mix(line.opacity).stroke_width(line.stroke);
    let x = chart.x_range();
    let along = |v: f64| panel.x.place(v);
    let missing = (f64::NAN, f64::NAN);
    let points: Vec<(f64, f64)> = line
        .points
        .iter()
        .map(|&(x, y)| if panel.drawable((x, y)) { (along(x), y) } else { missing })
        .collect();
    for run in runs(&points, along(x.start), along(x.end), WIDTH as usize) {
        let value = |x: f64| if panel.x.is_logarithmic() { 10f64.powf(x) } else { x };
        let run: Vec<(f64, f64)> = run.into_iter().map(|(x, y)| (value(x), y)).collect();
        match line.dash.pieces() {
            Some((piece, gap)) => chart.draw_series(DashedLineSeries::new(run, piece, gap, style)).map(drop),
            None => chart.draw_series(LineSeries::new(run, style)).map(drop),
        }?;
    }
    Ok(())
}

fn draw_fill(chart: &mut PanelChart, fill: &Fill) -> Result<(), Failure> {
    let areas = fill.areas.iter().map(|area| Polygon::new(area.clone(), fill.colour.mix(fill.opacity)));
    chart.draw_series(areas).map(drop)
}

fn draw_points(area: &Area, panel: &Panel, chart: &PanelChart) -> Result<(), Failure> {
    for points in &panel.points {
        for at in points.at.iter().filter(|at| panel.drawable(**at)) {
            point(area, points, place(area, chart, *at))?;
        }
    }
    Ok(())
}

/// The words of the rows, at the left of the axes and at their right.
fn draw_rows(area: &Area, panel: &Panel, chart: &PanelChart) -> Result<(), Failure> {
    let Scale::Rows(rows) = &panel.y.scale else { return Ok(()) };
    let x = chart.x_range();
    let mut y = chart.y_range().end - 0.5;
    for row in rows {
        let (left, right) = (place(area, chart, (x.start, y)), place(area, chart, (x.end, y)));
        let font = (FONT, 30).into_font();
        if row.is_heading {
            word(area, &row.left, (20, left.1), HPos::Left, font.style(FontStyle::Bold))?;
        } else {
            word(area, &row.left, (left.0 - 16, left.1), HPos::Right, font.clone())?;
            word(area, &row.right, (right.0 + 18, right.1), HPos::Left, font)?;
        }
        y -= 1.0;
    }
    Ok(())
}

fn draw_mark(area: &Area, mark: &Mark, row: usize, ends: [(i32, i32); 2]) -> Result<(), Failure> {
    let [top, bottom] = ends;
    let lift = MARK_ROW * i32::try_from(row).unwrap_or(0);
    let mut y = top.1 - lift;
    while y < bottom.1 {
        let end = (y + 10).min(bottom.1);
        area.draw(&PathElement::new(vec![(top.0, y), (top.0, end)], INK.mix(0.55).stroke_width(2)))?;
        y += 18;
    }
    let half = i32::try_from(mark.label.chars().count()).unwrap_or(0) * 7;
    let width = area.dim_in_pixel().0.cast_signed();
    let x = top.0.clamp(LEFT.cast_signed() + half - 20, width - half - 8);
    word(area, &mark.label, (x, top.1 - lift - 20), HPos::Center, (FONT, 30).into_font())
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
    use super::super::panel::Mark;
    use super::*;

    #[test]
    fn near_marks_are_set_in_rows_of_their_own() {
        let marks = [("first contact", 0.0), ("separation", 6.0), ("slap-down", 60.0)];
        let marks = marks.map(|(label, at)| Mark { at, label: label.into() }).into();
        let panel =
            Panel { x: PanelAxis::new("time, ms").over(Some((-10.0, 100.0))), marks, ..Panel::default() };
        assert_eq!(panel.mark_rows(WIDTH), [0, 1, 0]);
    }

    #[test]
    fn ticks_read_well() {
        assert_eq!(tick(-0.000_000_01, false), "0");
        assert_eq!(tick(-12.5, false), "−12.5");
        assert_eq!(tick(1e-5, true), "1e−5");
        assert_eq!(tick(100.0, true), "100");
    }
}
