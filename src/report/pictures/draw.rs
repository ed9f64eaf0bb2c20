//! Draws panels as the SVG text of a picture.

use super::panel::{AxisScale, Panel, WIDTH};
use super::svg::{Anchor, Svg};
use super::{axes, live};
use crate::numerics::as_f64;

/// One picture.
pub(crate) struct Picture {
    /// The name of its file, without ".svg".
    pub(crate) name: String,
    /// Heading of the picture.
    pub(crate) title: String,
    /// Description for a reader who cannot see the picture.
    pub(crate) alt: String,
    /// Caption below the picture.
    pub(crate) caption: String,
    /// The drawing.
    pub(crate) svg: String,
    /// Numbers as JSON, for pages that redraw the picture when zooming; empty if they do not.
    pub(crate) live: String,
}

/// Name and title of a picture, and its sentence if it is empty.
pub(crate) struct Figure {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) caption: String,
    /// Sentence and caption of the empty picture.
    pub(crate) nothing: (&'static str, &'static str),
    /// Panels beside one another.
    pub(crate) columns: usize,
    /// The picture whose lines a page redraws for zooming; "" for its own, `None` for none.
    pub(crate) live_of: Option<&'static str>,
    /// Sentence of a page on samples that were omitted before; `None` if none were.
    pub(crate) thinned: Option<String>,
}

impl Figure {
    /// Specifies a picture of panels one below the other.
    pub(crate) fn new(name: &str, title: impl Into<String>, caption: impl Into<String>) -> Self {
        let nothing =
            ("There is nothing to show: see the findings.", "The recording did not yield this picture.");
        Self {
            name: name.to_owned(),
            title: title.into(),
            caption: caption.into(),
            nothing,
            columns: 1,
            live_of: None,
            thinned: None,
        }
    }

    /// Replaces sentence and caption of the empty picture.
    pub(crate) fn empty(self, nothing: (&'static str, &'static str)) -> Self {
        Self { nothing, ..self }
    }

    /// Lets a page zoom the picture.
    pub(crate) fn zoomable(self) -> Self {
        self.zoomable_with("")
    }

    /// Lets a page zoom the picture with the lines of another one, which include its own.
    pub(crate) fn zoomable_with(self, picture: &'static str) -> Self {
        Self { live_of: Some(picture), ..self }
    }

    /// Draws those panels that have content.
    pub(crate) fn picture(mut self, panels: &[Panel]) -> Picture {
        let panels: Vec<&Panel> = panels.iter().filter(|panel| panel.points().next().is_some()).collect();
        if panels.is_empty() {
            let mut svg = Svg::default();
            svg.words(self.nothing.0, (WIDTH / 2.0, 80.0), Anchor::Middle, "font-size=\"27\"");
            self.nothing.1.clone_into(&mut self.caption);
            return self.into_picture(svg, 160.0, "nothing to show.");
        }
        let (svg, height) = drawing(&panels, self.columns);
        let rows: Vec<String> = panels.iter().flat_map(|panel| alt_text(panel)).collect();
        let shown = if rows.is_empty() { self.caption.clone() } else { rows.join("; ") };
        let live =
            self.live_of.map_or_else(String::new, |of| live::numbers(&panels, of, self.thinned.as_deref()));
        let alt = format!("{}. {shown}", self.title);
        Picture { alt, live, ..self.into_picture(svg, height, "") }
    }

    /// Makes a picture of this height from a separate drawing; `shown` describes it for a reader who cannot
    /// see it.
    pub(super) fn into_picture(self, svg: Svg, height: f64, shown: &str) -> Picture {
        let Self { name, title, caption, .. } = self;
        let (svg, alt) = (svg.finish((WIDTH, height), &title), format!("{title}: {shown}"));
        Picture { name, title, alt, caption, svg, live: String::new() }
    }
}

/// Text of a panel's rows and marks for a reader who cannot see them.
fn alt_text(panel: &Panel) -> Vec<String> {
    let AxisScale::Rows(rows) = &panel.y.scale else { return Vec::new() };
    let marked = panel.marks.iter().map(|mark| mark.label.clone());
    let rows = rows.iter().filter(|row| row.is_heading || !row.right.is_empty());
    marked.chain(rows.map(|row| format!("{}: {}", row.left, row.right))).collect()
}

/// Draws panels in rows of `columns`, each row as wide as the picture; returns the height of the drawing.
fn drawing(panels: &[&Panel], columns: usize) -> (Svg, f64) {
    let mut rows: Vec<Vec<&Panel>> = Vec::new();
    for panel in panels {
        match rows.last_mut().filter(|row| row.len() < columns) {
            Some(row) => row.push(panel),
            None => rows.push(vec![panel]),
        }
    }
    let mut svg = Svg::default();
    let mut top = 0.0;
    for row in &rows {
        let width = WIDTH / as_f64(row.len());
        let mut left = 0.0;
        for panel in row {
            svg.from((left, top), |svg| axes::draw(svg, panel, width));
            left += width;
        }
        top += row.iter().map(|panel| axes::height(panel, width)).fold(0.0, f64::max);
    }
    (svg, top)
}

#[cfg(test)]
mod tests {
    use super::super::panel::{COLOURS, Curve, PanelAxis};
    use super::*;

    #[test]
    fn a_logarithmic_axis_drops_what_it_cannot_show() {
        let points = vec![(0.0, 1.0), (10.0, 0.0), (10.0, 1.0), (1000.0, 0.1)];
        let [x, y] = ["frequency, Hz", "magnitude"].map(|label| PanelAxis::new(label).logarithmic());
        let panel = Panel { lines: vec![Curve::new(COLOURS[0], points)], ..Panel::new("", x, y, 350) };
        let svg = Figure::new("", "", "").picture(&[panel]).svg;
        assert!(svg.contains("polyline") && !svg.contains("NaN") && !svg.contains("inf"));
    }
}
