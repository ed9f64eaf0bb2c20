//! Draws one panel: axes, areas, lines, points and marks.

use super::legend::{self, LEFT, RIGHT, point, text_width};
use super::live::runs;
use super::panel::{AxisScale, Curve, Dash, GREY, INK, Mark, Panel, PanelAxis, WIDTH};
use super::svg::{Anchor, Svg};
use crate::numerics::as_f64;
use std::ops::Range;

/// Width of the columns in which a line keeps its lowest and highest point, in units: a pixel and a half of
/// the page, 0.3 mm of paper.
const COLUMN: f64 = 3.0;
/// Height of a row of the marks' words.
const MARK_ROW: f64 = 34.0;
/// Room for the ticks and the label below the axes.
const BOTTOM: f64 = 88.0;
/// Air below a panel.
const GAP: f64 = 26.0;

/// Height of a panel in a picture, or in a part of it, this wide.
pub(super) fn height(panel: &Panel, width: f64) -> f64 {
    head(panel, width) + f64::from(panel.height) + bottom(panel) + GAP
}

/// Height of the parts above the axes.
fn head(panel: &Panel, width: f64) -> f64 {
    let rows = mark_places(panel, width).iter().map(|(_, row)| row + 1).max().unwrap_or(0);
    legend::height(panel, width) + MARK_ROW * as_f64(rows)
}

fn bottom(panel: &Panel) -> f64 {
    if panel.x.label.is_empty() { 0.0 } else { BOTTOM }
}

/// Room at the left and the right of the axes.
fn sides(panel: &Panel) -> (f64, f64) {
    panel.sides.map_or((LEFT, RIGHT), |(left, right)| (left.into(), right.into()))
}

/// Positions of the marks' words along the axis, clear of the numbers beside it, and their rows, so that none
/// covers its neighbour.
fn mark_places(panel: &Panel, width: f64) -> Vec<(f64, usize)> {
    let mut ends: Vec<f64> = Vec::new();
    let along = position_on(&panel.x, &panel.x_range());
    let (left, right) = sides(panel);
    let place = |mark: &Mark| {
        let half = text_width(&mark.label, 7.0) + 8.0;
        let at = along(mark.at) * (width - left - right);
        let middle = at.min(width - left - half).max(half - 8.0);
        let row = ends.iter().position(|end| middle - half > *end).unwrap_or(ends.len());
        ends.resize(ends.len().max(row + 1), 0.0);
        ends[row] = middle + half;
        (middle, row)
    };
    panel.marks.iter().map(place).collect()
}

/// Maps a value to its position along its axis, 0 to 1; not finite if the axis has no place for it.
fn position_on<'a>(axis: &'a PanelAxis, range: &Range<f64>) -> impl Fn(f64) -> f64 + use<'a> {
    let (from, to) = (axis.place(range.start), axis.place(range.end));
    move |value| (axis.place(value) - from) / (to - from)
}

/// The rectangle between the axes, its corner at (0, 0).
struct PlotFrame<'a> {
    panel: &'a Panel,
    x: Range<f64>,
    y: Range<f64>,
    width: f64,
    height: f64,
}

/// Draws `panel` in a picture, or in a part of it, this wide.
pub(super) fn draw(svg: &mut Svg, panel: &Panel, width: f64) {
    legend::draw(svg, panel, width);
    let (left, right) = sides(panel);
    let (x, y) = (panel.x_range(), panel.y_range());
    let frame = PlotFrame { panel, x, y, width: width - left - right, height: panel.height.into() };
    svg.from((left, head(panel, width)), |svg| {
        frame.grid(svg);
        svg.clip_to((frame.width, frame.height), |svg| frame.curves(svg));
        for points in &panel.points {
            let places = points.at.iter().copied().map(frame.place());
            places.filter(|(x, y)| x.is_finite() && y.is_finite()).for_each(|at| point(svg, points, at));
        }
        frame.rows(svg, left);
        for (mark, place) in panel.marks.iter().zip(mark_places(panel, width)) {
            frame.mark(svg, mark, place);
        }
        let size = "font-size=\"26\"";
        svg.words(&panel.x.label, (frame.width / 2.0, frame.height + BOTTOM - 18.0), Anchor::Middle, size);
        svg.from((16.0 - left, frame.height / 2.0), |svg| {
            let turned = format!("{size} transform=\"rotate(270)\"");
            svg.words(&panel.y.label, (0.0, 0.0), Anchor::Middle, &turned);
        });
    });
}

impl PlotFrame<'_> {
    /// Maps a point to its place in the rectangle.
    fn place(&self) -> impl Fn((f64, f64)) -> (f64, f64) {
        let (along_x, along_y) = (position_on(&self.panel.x, &self.x), position_on(&self.panel.y, &self.y));
        move |(x, y)| (along_x(x) * self.width, (1.0 - along_y(y)) * self.height)
    }

    /// The lines at the ticks, their numbers, and the axes.
    fn grid(&self, svg: &mut Svg) {
        let (width, height, panel) = (self.width, self.height, self.panel);
        let line = |opacity, points| Curve { opacity, stroke: 1, ..Curve::new(GREY, points) };
        let most = if width < WIDTH / 2.0 { 8 } else { 14 };
        let x = ticks(&panel.x, &self.x, most);
        let y = ticks(&panel.y, &self.y, 8);
        let (along_x, along_y) = (position_on(&panel.x, &self.x), position_on(&panel.y, &self.y));
        let across = |value: f64| (along_x(value) * width).round();
        let up = |value: f64| ((1.0 - along_y(value)) * height).round();
        let upright = |value: f64| vec![(across(value), 0.0), (across(value), height)];
        let level = |value: f64| vec![(0.0, up(value)), (width, up(value))];
        for (ticks, ends) in [(&x, &upright as &dyn Fn(f64) -> Vec<(f64, f64)>), (&y, &level)] {
            ticks.fine.iter().for_each(|value| svg.line(&line(0.10, ends(*value))));
            ticks.bold.iter().for_each(|value| svg.line(&line(0.28, ends(*value))));
        }
        svg.line(&line(1.0, vec![(0.0, 0.0), (0.0, height), (width, height)]));
        for value in x.bold.iter().filter(|_| !panel.x.label.is_empty()) {
            let at = across(*value);
            svg.line(&line(1.0, vec![(at, height), (at, height + 5.0)]));
            let number = tick(*value, &panel.x);
            // The last number ends within the picture.
            let most = width + sides(panel).1 - text_width(&number, 7.0);
            svg.word(&number, (at.min(most), height + 22.0), Anchor::Middle);
        }
        for value in &y.bold {
            svg.line(&line(1.0, vec![(-5.0, up(*value)), (0.0, up(*value))]));
            svg.word(&tick(*value, &panel.y), (-10.0, up(*value)), Anchor::End);
        }
    }

    /// Draws areas, and lines over them; faint lines lie under bold ones.
    fn curves(&self, svg: &mut Svg) {
        for fill in &self.panel.fills {
            for area in &fill.areas {
                let corners: Vec<(f64, f64)> = area.iter().copied().map(self.place()).collect();
                svg.area(&corners, fill.colour, fill.opacity);
            }
        }
        let (faint, bold): (Vec<&Curve>, Vec<&Curve>) =
            self.panel.lines.iter().partition(|line| line.opacity < 0.5);
        for line in faint.into_iter().chain(bold) {
            let narrow = line.points.iter().copied().map(self.place()).map(|(x, y)| (x / COLUMN, y));
            for run in runs(narrow) {
                let points = run.into_iter().map(|(x, y)| (x * COLUMN, y)).collect();
                svg.line(&Curve { points, label: None, ..*line });
            }
        }
    }

    /// The words of the rows, at the left of the axes and at their right.
    fn rows(&self, svg: &mut Svg, left: f64) {
        let AxisScale::Rows(rows) = &self.panel.y.scale else { return };
        let mut row_y = self.y.end - 0.5;
        for row in rows {
            let (_, y) = self.place()((self.x.start, row_y));
            if row.is_heading {
                let bold = "font-size=\"24\" font-weight=\"bold\"";
                svg.words(&row.left, (20.0 - left, y), Anchor::Start, bold);
            } else {
                svg.word(&row.left, (-16.0, y), Anchor::End);
                svg.word(&row.right, (self.width + 18.0, y), Anchor::Start);
            }
            row_y -= 1.0;
        }
    }

    fn mark(&self, svg: &mut Svg, mark: &Mark, (middle, row): (f64, usize)) {
        if !(self.x.start..=self.x.end).contains(&mark.at) {
            return;
        }
        let (x, _) = self.place()((mark.at, self.y.end));
        let top = -MARK_ROW * as_f64(row);
        let dashed = Curve { opacity: 0.55, stroke: 2, ..Curve::new(INK, vec![(x, top), (x, self.height)]) };
        svg.line(&dashed.broken(Dash::Marked));
        svg.word(&mark.label, (middle, top - 20.0), Anchor::Middle);
    }
}

/// Positions of numbers and of lines on an axis.
#[derive(Default)]
struct Ticks {
    bold: Vec<f64>,
    fine: Vec<f64>,
}

/// Ticks at round numbers, `most` of them or one more; for powers of ten each one or every second, third …,
/// and the steps between in fine lines.
#[allow(clippy::cast_possible_truncation, reason = "whole steps, cut to a few hundred")]
fn ticks(axis: &PanelAxis, range: &Range<f64>, most: i32) -> Ticks {
    let (from, to) = (axis.place(range.start), axis.place(range.end));
    let steps = |step: f64| -> Vec<i32> {
        let [first, last] = [(from / step - 1e-9).ceil(), (to / step + 1e-9).floor()];
        (first as i32..=(last as i32).min((first as i32).saturating_add(300))).collect()
    };
    match axis.scale {
        AxisScale::Rows(_) => Ticks::default(),
        AxisScale::Linear => {
            let least = (to - from) / f64::from(most);
            let power = 10_f64.powf(least.log10().floor());
            let step =
                [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= least * 0.999);
            let step = step.unwrap_or(least);
            Ticks { bold: steps(step).into_iter().map(|i| f64::from(i) * step).collect(), fine: Vec::new() }
        }
        AxisScale::Logarithmic => {
            let decades = steps(1.0);
            let each = decades.len().div_ceil(usize::try_from(most).unwrap_or(8)).max(1);
            let bold = decades.iter().step_by(each).map(|power| 10_f64.powi(*power)).collect();
            let all = (from.floor() as i32..=to.floor() as i32)
                .flat_map(|power| (2..10).map(move |digit| f64::from(digit) * 10_f64.powi(power)));
            let is_within = |v: &f64| decades.len() <= 12 && (range.start..=range.end).contains(v);
            Ticks { bold, fine: all.filter(is_within).collect() }
        }
    }
}

/// A tick's number: as short as possible, powers of ten on a logarithmic axis.
fn tick(value: f64, axis: &PanelAxis) -> String {
    if axis.scale == AxisScale::Logarithmic && !(1e-4..1e5).contains(&value) {
        return format!("{value:.0e}").replace('-', "−");
    }
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded }).replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_marks_are_set_in_rows_of_their_own() {
        let marks = [("first contact", 0.0), ("separation", 6.0), ("slap-down", 60.0)];
        let marks = marks.map(|(label, at)| Mark { at, label: label.into() }).into();
        let panel =
            Panel { x: PanelAxis::new("time, ms").range(Some((-10.0, 100.0))), marks, ..Panel::default() };
        let places = mark_places(&panel, WIDTH);
        assert!(places.iter().map(|(_, row)| *row).eq([0, 1, 0]), "{places:?}");
        // A word at the left edge begins at the axis, and so beside the numbers of the other one.
        let at_edge = Panel { x: panel.x.range(Some((0.0, 100.0))), ..panel };
        let (middle, _) = mark_places(&at_edge, WIDTH)[0];
        assert!(middle - text_width("first contact", 7.0) >= 0.0, "{middle}");
    }

    #[test]
    fn ticks_read_well() {
        let (linear, logarithmic) = (PanelAxis::new("x"), PanelAxis::new("f").logarithmic());
        assert_eq!(tick(-0.000_000_01, &linear), "0");
        assert_eq!(tick(-12.5, &linear), "−12.5");
        assert_eq!(tick(1e-5, &logarithmic), "1e−5");
        assert_eq!([tick(1e-3, &logarithmic), tick(0.01, &logarithmic)], ["0.001", "0.01"]);
        assert_eq!(tick(100.0, &logarithmic), "100");
    }

    #[test]
    fn ticks_stand_at_round_numbers_within_the_axis() {
        let linear = PanelAxis::new("x");
        assert_eq!(ticks(&linear, &(-3.0..41.0), 8).bold, [0.0, 10.0, 20.0, 30.0, 40.0]);
        assert_eq!(ticks(&linear, &(0.0..1.0), 5).bold.len(), 6);
        let logarithmic = PanelAxis::new("f").logarithmic();
        let found = ticks(&logarithmic, &(5.0..2000.0), 8);
        assert_eq!(found.bold, [10.0, 100.0, 1000.0]);
        assert_eq!((found.fine.first(), found.fine.last()), (Some(&5.0), Some(&2000.0)));
        assert!(ticks(&logarithmic, &(1e-17..1e3), 8).bold.len() <= 8);
        assert!(ticks(&Panel::from_rows(Vec::new(), 1, (0, 0)).y, &(0.0..1.0), 8).bold.is_empty());
    }
}
