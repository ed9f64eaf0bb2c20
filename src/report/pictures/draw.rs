//! Panels to the SVG text of a picture.

use super::super::ReportError;
use super::super::text::printable;
use super::axes;
use super::legend::{FONT, Failure};
use super::panel::{GREY, Panel, WIDTH};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// One picture.
pub(crate) struct Picture {
    /// The name of its file, without ".svg".
    pub(crate) name: String,
    /// Its heading.
    pub(crate) title: String,
    /// What it shows, for a reader who cannot see it.
    pub(crate) alt: String,
    /// What the reader should know beside it.
    pub(crate) caption: String,
    /// The drawing.
    pub(crate) svg: String,
}

/// What a picture is called, and what it says where it is empty.
pub(crate) struct Plate {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) caption: String,
    /// The sentence of the empty picture, and its caption.
    pub(crate) nothing: (&'static str, &'static str),
    /// Panels beside one another.
    pub(crate) columns: usize,
}

impl Plate {
    /// Of the panels one below the other.
    pub(crate) fn new(name: &str, title: impl Into<String>, caption: String) -> Self {
        let nothing =
            ("There is nothing to show: see the findings.", "The recording did not yield this picture.");
        Self { name: name.to_owned(), title: title.into(), caption, nothing, columns: 1 }
    }

    /// With another sentence and caption of the empty picture.
    pub(crate) fn or(self, nothing: (&'static str, &'static str)) -> Self {
        Self { nothing, ..self }
    }

    /// The picture of those panels that have something to show.
    ///
    /// # Errors
    /// [`ReportError::Picture`] where the plotter fails.
    pub(crate) fn picture(self, panels: &[Panel]) -> Result<Picture, ReportError> {
        let Self { name, title, caption, nothing, columns } = self;
        let panels: Vec<&Panel> = panels.iter().filter(|panel| panel.has_points()).collect();
        let failed = |e: Failure| ReportError::Picture { picture: name.clone(), reason: e.to_string() };
        if panels.is_empty() {
            let svg = empty(nothing.0).map_err(failed)?;
            let alt = format!("{title}: nothing to show.");
            return Ok(Picture { name, title, alt, caption: nothing.1.to_owned(), svg });
        }
        let svg = described(&draw(&panels, columns).map_err(failed)?, &title);
        let alt = format!("{title}. {caption}");
        Ok(Picture { name, title, alt, caption, svg })
    }
}

/// Panels in rows of `columns`, those without axes in rows of their own.
fn draw(panels: &[&Panel], columns: usize) -> Result<String, Failure> {
    let mut rows: Vec<Vec<&Panel>> = Vec::new();
    for panel in panels {
        match rows.last_mut().filter(|row| row.len() < columns && row[0].height > 0 && panel.height > 0) {
            Some(row) => row.push(panel),
            None => rows.push(vec![panel]),
        }
    }
    let parts = |row: &[&Panel]| if row[0].height == 0 { 1 } else { columns };
    let width = |row: &[&Panel]| WIDTH / u32::try_from(parts(row)).unwrap_or(1);
    let height = |row: &Vec<&Panel>| row.iter().map(|panel| panel.heights(width(row)).1).max().unwrap_or(0);
    let total = rows.iter().map(height).sum::<i32>().cast_unsigned();
    drawing(total, |root| {
        let mut rest = root.clone();
        for row in &rows {
            let (area, below) = rest.split_vertically(height(row));
            rest = below;
            for (panel, area) in row.iter().zip(area.split_evenly((1, parts(row)))) {
                axes::one(&area, panel)?;
            }
        }
        Ok(())
    })
}

/// A picture that only says a sentence.
fn empty(sentence: &str) -> Result<String, Failure> {
    drawing(160, |root| {
        let style =
            TextStyle::from((FONT, 34).into_font()).color(&GREY).pos(Pos::new(HPos::Center, VPos::Center));
        root.draw(&Text::new(sentence.to_owned(), (WIDTH.cast_signed() / 2, 80), style))
    })
}

/// What `paint` draws, at half its units on the page, as a picture to those who read the page aloud.
fn drawing(
    height: u32,
    paint: impl FnOnce(&super::legend::Area) -> Result<(), Failure>,
) -> Result<String, Failure> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        root.fill(&WHITE)?;
        paint(&root)?;
        root.present()?;
    }
    let drawn = format!("width=\"{WIDTH}\" height=\"{height}\"");
    let shown = format!("width=\"{}\" height=\"{}\" role=\"img\"", WIDTH / 2, height / 2);
    Ok(svg.replacen(&drawn, &shown, 1))
}

/// The drawing with `title` as its name.
fn described(svg: &str, title: &str) -> String {
    let title = printable(title).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    match svg.find('>') {
        Some(end) => format!("{}\n<title>{title}</title>{}", &svg[..=end], &svg[end + 1..]),
        None => svg.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::panel::{COLOURS, Line, PanelAxis};
    use super::*;

    #[test]
    fn a_logarithmic_axis_drops_what_it_cannot_show() {
        let points = vec![(0.0, 1.0), (10.0, 0.0), (10.0, 1.0), (1000.0, 0.1)];
        let panel = Panel {
            x: PanelAxis::new("frequency, Hz").logarithmic(),
            y: PanelAxis::new("magnitude").logarithmic(),
            height: 350,
            lines: vec![Line::new(COLOURS[0], points)],
            ..Panel::default()
        };
        let svg = draw(&[&panel], 1).unwrap();
        assert!(svg.contains("polyline") && !svg.contains("2147483"));
    }
}
