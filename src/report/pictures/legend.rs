//! The title of a panel and the names of its lines, areas and points, above the axes.

use super::super::text::printable;
use super::panel::{Dash, Fill, INK, Line, Panel, PointShape, Points};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub(super) const FONT: &str = "Helvetica, Arial, sans-serif";

/// Where a picture is drawn.
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
pub(super) type Failure = DrawingAreaErrorKind<std::io::Error>;

/// Height of the title's row.
const HEAD: i32 = 62;
/// Where title and legend begin and end.
const LEFT: i32 = 130;
const RIGHT: i32 = 28;
/// Height of each further row of the legend.
const LEGEND_ROW: i32 = 40;
/// Width of the sample of a line before its words.
const SAMPLE: i32 = 58;

/// What an entry of a legend stands for.
#[derive(Clone, Copy)]
enum LegendKey<'a> {
    Line(&'a Line),
    Fill(&'a Fill),
    Points(&'a Points),
}

/// One entry of a legend: what it stands for, its words, its row and where it begins.
struct Entry<'a> {
    key: LegendKey<'a>,
    label: String,
    row: usize,
    left: i32,
}

impl Panel {
    /// The legend in reading order, each row set to the right; the first leaves room for the title.
    fn legend(&self, width: u32) -> Vec<Entry<'_>> {
        // The width of a letter is about 0.52 em: 13 at 25 units, 19 for the bold title.
        let letters = |label: &str, letter: i32| i32::try_from(label.chars().count()).unwrap_or(0) * letter;
        let limit = width.cast_signed() - RIGHT;
        let room = limit - LEFT;
        let mut left_over = room - letters(&self.title, 19) - 40;
        let mut rows: Vec<Vec<(LegendKey, String, i32)>> = vec![Vec::new()];
        let lines = self.lines.iter().map(|line| (LegendKey::Line(line), line.label.as_deref()));
        let fills = self.fills.iter().map(|fill| (LegendKey::Fill(fill), fill.label.as_deref()));
        let points = self.points.iter().map(|points| (LegendKey::Points(points), points.label.as_deref()));
        for (key, label) in lines.chain(fills).chain(points) {
            let Some(label) = label.map(printable) else { continue };
            let takes = SAMPLE + letters(&label, 13) + 26;
            if takes > left_over && !(rows.len() > 1 && rows.last().is_some_and(Vec::is_empty)) {
                rows.push(Vec::new());
                left_over = room;
            }
            left_over -= takes;
            if let Some(row) = rows.last_mut() {
                row.push((key, label, takes));
            }
        }
        let mut entries = Vec::new();
        for (row, members) in rows.into_iter().enumerate() {
            let mut left = limit + 26 - members.iter().map(|(_, _, takes)| takes).sum::<i32>();
            for (key, label, takes) in members {
                entries.push(Entry { key, label, row, left });
                left += takes;
            }
        }
        entries
    }

    /// Height of title and legend.
    pub(super) fn head(&self, width: u32) -> i32 {
        let last = self.legend(width).last().map(|entry| entry.row);
        match last {
            None if self.title.is_empty() => 14,
            row => HEAD + LEGEND_ROW * i32::try_from(row.unwrap_or(0)).unwrap_or(0),
        }
    }
}

/// The panel's title at the left, its legend at the right of one line.
pub(super) fn heading(area: &Area, panel: &Panel) -> Result<(), Failure> {
    let title = TextStyle::from((FONT, 36).into_font().style(FontStyle::Bold)).color(&INK);
    area.draw(&Text::new(printable(&panel.title), (LEFT, 14), title))?;
    let entry = TextStyle::from((FONT, 31).into_font()).color(&INK);
    for Entry { key, label, row, left } in panel.legend(area.dim_in_pixel().0) {
        let drop = LEGEND_ROW * i32::try_from(row).unwrap_or(0);
        area.draw(&Text::new(label, (left + SAMPLE, 17 + drop), entry.clone()))?;
        match key {
            LegendKey::Fill(fill) => {
                let corners = [(left, 18 + drop), (left + 48, 40 + drop)];
                area.draw(&Rectangle::new(corners, fill.colour.mix(fill.opacity).filled()))?;
            }
            LegendKey::Line(line) => {
                let style = line.colour.mix(line.opacity).stroke_width(line.stroke.max(3));
                for &(from, to) in sample(line.dash) {
                    let stroke = vec![(left + from, 29 + drop), (left + to, 29 + drop)];
                    area.draw(&PathElement::new(stroke, style))?;
                }
            }
            LegendKey::Points(points) => point(area, points, (left + 36, 29 + drop))?,
        }
    }
    Ok(())
}

/// Words at their middle height.
pub(super) fn word(
    area: &Area,
    text: &str,
    at: (i32, i32),
    side: HPos,
    font: FontDesc,
) -> Result<(), Failure> {
    let style = TextStyle::from(font).color(&INK).pos(Pos::new(side, VPos::Center));
    area.draw(&Text::new(printable(text), at, style))
}

/// One point in its shape.
pub(super) fn point(area: &Area, points: &Points, (x, y): (i32, i32)) -> Result<(), Failure> {
    let (r, colour) = (points.radius, points.colour);
    let corners: &[(i32, i32)] = match points.shape {
        PointShape::Square => &[(-9, -9), (9, -9), (9, 9), (-9, 9), (-9, -9)],
        PointShape::Triangle => &[(0, -12), (12, 9), (-12, 9), (0, -12)],
        PointShape::Diamond => &[(0, -13), (13, 0), (0, 13), (-13, 0), (0, -13)],
        PointShape::Tip => &[(0, 12), (12, -9), (-12, -9), (0, 12)],
        PointShape::Cross => {
            for side in [r, -r] {
                let stroke = vec![(x - r, y - side), (x + r, y + side)];
                area.draw(&PathElement::new(stroke, colour.stroke_width(6)))?;
            }
            return Ok(());
        }
        PointShape::Ring => return area.draw(&Circle::new((x, y), r, colour.stroke_width(4))),
        PointShape::Dot => {
            area.draw(&Circle::new((x, y), r + 2, WHITE.filled()))?;
            let style = if points.is_hollow { colour.stroke_width(4) } else { colour.filled() };
            return area.draw(&Circle::new((x, y), r, style));
        }
    };
    let corners: Vec<(i32, i32)> = corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
    if points.is_hollow {
        area.draw(&Polygon::new(corners.clone(), WHITE.filled()))?;
        return area.draw(&PathElement::new(corners, colour.stroke_width(4)));
    }
    area.draw(&Polygon::new(corners, colour.filled()))
}

/// From where to where the pieces of a line's sample reach.
fn sample(dash: Dash) -> &'static [(i32, i32)] {
    match dash {
        Dash::Solid => &[(0, 48)],
        Dash::Dashed => &[(0, 20), (28, 48)],
        Dash::Dotted => &[(0, 6), (14, 20), (28, 34), (42, 48)],
    }
}

#[cfg(test)]
mod tests {
    use super::super::panel::{COLOURS, WIDTH};
    use super::*;

    #[test]
    fn a_long_legend_takes_more_rows_within_the_width() {
        let line = |i: usize| {
            Line::new(COLOURS[i % COLOURS.len()], vec![]).named(format!("channel number {i} unfiltered"))
        };
        let lines = (0..16).map(line).collect();
        let panel = Panel { title: "First end".into(), lines, ..Panel::default() };
        let entries = panel.legend(WIDTH);
        assert_eq!(entries.len(), 16);
        assert!(entries.iter().all(|e| e.left >= LEFT && e.left < WIDTH.cast_signed()));
        assert!(entries.iter().any(|e| e.row > 0));
        assert!(entries.windows(2).all(|w| w[0].row < w[1].row || w[0].left < w[1].left));
    }
}
