//! The title of a panel and the names of its lines, areas and points, above the axes.

use super::super::text::sanitize;
use super::panel::{Colour, Curve, Fill, Panel, PointShape, Points};
use super::svg::{Anchor, Svg};
use crate::numerics::as_f64;

/// Height of the title's row.
const HEAD: f64 = 62.0;
/// Ends of title and legend, and of the axes of a panel without rows.
pub(super) const LEFT: f64 = 130.0;
pub(super) const RIGHT: f64 = 28.0;
/// Height of each further row of the legend.
const LEGEND_ROW: f64 = 40.0;
/// Width of the sample of a line before its words.
const SAMPLE: f64 = 58.0;
/// Least opacity of a sample, so that it is visible on paper and in the dark, however faint its line is.
const FAINTEST: f64 = 0.6;
const WHITE: Colour = Colour(255, 255, 255);

/// Symbol of an entry in a legend.
#[derive(Clone, Copy)]
enum LegendKey<'a> {
    Curve(&'a Curve),
    Fill(&'a Fill),
    Points(&'a Points),
}

/// One entry of a legend: its symbol, words, and beginning.
struct Entry<'a> {
    key: LegendKey<'a>,
    label: String,
    takes: f64,
    left: f64,
}

/// Approximate width of words with letters of this width.
pub(super) fn text_width(words: &str, letter: f64) -> f64 {
    as_f64(words.chars().count()) * letter
}

/// The rows of the legend in reading order, right-aligned; the first leaves room for the title.
fn rows(panel: &Panel, width: f64) -> Vec<Vec<Entry<'_>>> {
    let limit = width - RIGHT;
    let mut left_over = limit - LEFT - text_width(&panel.title, 19.0) - 40.0;
    let mut rows: Vec<Vec<Entry>> = vec![Vec::new()];
    let lines = panel.lines.iter().map(|line| (LegendKey::Curve(line), line.label.as_deref()));
    let fills = panel.fills.iter().map(|fill| (LegendKey::Fill(fill), fill.label.as_deref()));
    let points = panel.points.iter().map(|points| (LegendKey::Points(points), points.label.as_deref()));
    for (key, label) in lines.chain(fills).chain(points) {
        let Some(label) = label.map(sanitize) else { continue };
        let takes = SAMPLE + text_width(&label, 13.0) + 26.0;
        if takes > left_over {
            rows.push(Vec::new());
            left_over = limit - LEFT;
        }
        left_over -= takes;
        if let Some(row) = rows.last_mut() {
            row.push(Entry { key, label, takes, left: 0.0 });
        }
    }
    for row in &mut rows {
        let mut left = limit + 26.0 - row.iter().map(|entry| entry.takes).sum::<f64>();
        for entry in row {
            entry.left = left;
            left += entry.takes;
        }
    }
    rows
}

/// Height of title and legend in a picture or a part of it this wide.
pub(super) fn height(panel: &Panel, width: f64) -> f64 {
    let rows = rows(panel, width);
    if panel.title.is_empty() && rows.iter().all(Vec::is_empty) {
        return 14.0;
    }
    HEAD + LEGEND_ROW * as_f64(rows.len() - 1)
}

/// The panel's title at the left, its legend at the right of one line.
pub(super) fn draw(svg: &mut Svg, panel: &Panel, width: f64) {
    if !panel.title.is_empty() {
        svg.words(&panel.title, (LEFT, 29.0), Anchor::Start, "font-size=\"29\" font-weight=\"bold\"");
    }
    let mut y = 29.0;
    for row in rows(panel, width) {
        for Entry { key, label, left, .. } in row {
            svg.words(&label, (left + SAMPLE, y), Anchor::Start, "font-size=\"25\"");
            match key {
                LegendKey::Fill(fill) => {
                    let corners = Fill::rectangle((left, left + 48.0), (y - 11.0, y + 11.0));
                    svg.area(&corners, fill.colour, fill.opacity);
                }
                LegendKey::Curve(line) => {
                    let points = vec![(left, y), (left + 48.0, y)];
                    let (stroke, opacity) = (line.stroke.max(3), line.opacity.max(FAINTEST));
                    svg.line(&Curve { opacity, stroke, points, ..line.clone() });
                }
                LegendKey::Points(points) => point(svg, points, (left + 36.0, y)),
            }
        }
        y += LEGEND_ROW;
    }
}

/// Draws one point in its shape.
pub(super) fn point(svg: &mut Svg, points: &Points, (x, y): (f64, f64)) {
    let (r, colour) = (points.radius, points.colour);
    match points.shape {
        PointShape::Square => {
            let corners = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0), (-9.0, -9.0)];
            svg.area(&corners.map(|(dx, dy)| (x + dx, y + dy)), colour, 1.0);
        }
        PointShape::Ring => svg.circle((x, y), r, colour, Some(4)),
        PointShape::Dot => {
            svg.circle((x, y), r + 2, WHITE, None);
            svg.circle((x, y), r, colour, points.is_hollow.then_some(4));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::panel::{COLOURS, WIDTH};
    use super::*;

    #[test]
    fn a_long_legend_takes_more_rows_within_the_width() {
        let line = |i: usize| {
            Curve::new(COLOURS[i % COLOURS.len()], vec![]).label(format!("channel number {i} unfiltered"))
        };
        let lines = (0..16).map(line).collect();
        let panel = Panel { title: "First end".into(), lines, ..Panel::default() };
        let rows = rows(&panel, WIDTH);
        assert_eq!(rows.iter().flatten().count(), 16);
        assert!(rows.len() > 1 && height(&panel, WIDTH) > HEAD);
        assert!(rows.iter().flatten().all(|e| e.left >= LEFT && e.left < WIDTH));
        assert!(rows.iter().all(|row| row.windows(2).all(|w| w[0].left < w[1].left)));
    }
}
