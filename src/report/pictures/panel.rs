//! Lines with axes, legend and marked events to SVG; drawn at twice the size so that its whole-pixel coordinates stay fine.

use super::super::text::printable;
use super::axes;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Width of a picture in drawing units.
pub(crate) const WIDTH: u32 = 1800;
pub(crate) const FONT: &str = "Helvetica, Arial, sans-serif";
pub(super) const MARK_ROW: i32 = 34;
pub(super) const LEFT: u32 = 130;
pub(super) const BOTTOM: u32 = 88;
/// Air below a panel.
pub(super) const GAP: i32 = 26;
pub(crate) const RIGHT: i32 = 28;
pub(crate) const INK: RGBColor = RGBColor(38, 42, 48);
pub(crate) const GREY: RGBColor = RGBColor(110, 116, 124);

/// Colours that also readers with a colour vision deficiency tell apart (Okabe & Ito 2008), darkest first.
pub(crate) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];

/// How a line is broken.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Dash {
    /// Not at all.
    #[default]
    Solid,
    /// Into long pieces.
    Dashed,
    /// Into short ones.
    Dotted,
}

impl Dash {
    /// Lengths of piece and gap in drawing units; `None` where it is not broken.
    pub(super) fn pieces(self) -> Option<(u32, u32)> {
        match self {
            Self::Solid => None,
            Self::Dashed => Some((16, 9)),
            Self::Dotted => Some((5, 8)),
        }
    }
}

/// One line.
pub(super) struct Line {
    /// Its name in the legend; `None` keeps it out.
    pub(super) label: Option<String>,
    pub(super) colour: RGBColor,
    /// 0 to 1.
    pub(super) opacity: f64,
    /// Stroke in drawing units.
    pub(super) stroke: u32,
    pub(super) dash: Dash,
    pub(super) points: Vec<(f64, f64)>,
}

/// Areas of one colour, under the lines.
pub(super) struct Fill {
    /// Its name in the legend; `None` keeps it out.
    pub(super) label: Option<String>,
    pub(super) colour: RGBColor,
    /// 0 to 1.
    pub(super) opacity: f64,
    /// The corners of each area.
    pub(super) areas: Vec<Vec<(f64, f64)>>,
}

impl Fill {
    /// The area between `low` and `high` over `x`, open where either is missing.
    pub(super) fn between(x: &[f64], low: &[f64], high: &[f64]) -> Vec<Vec<(f64, f64)>> {
        let mut areas = Vec::new();
        let mut run: Vec<(f64, f64, f64)> = Vec::new();
        let mut close = |run: &mut Vec<(f64, f64, f64)>| {
            if run.len() > 1 {
                let below = run.iter().map(|p| (p.0, p.1));
                areas.push(below.chain(run.iter().rev().map(|p| (p.0, p.2))).collect());
            }
            run.clear();
        };
        for ((x, low), high) in x.iter().zip(low).zip(high) {
            if low.is_finite() && high.is_finite() {
                run.push((*x, *low, *high));
            } else {
                close(&mut run);
            }
        }
        close(&mut run);
        areas
    }
}

/// A point.
pub(super) struct Dot {
    pub(super) at: (f64, f64),
    pub(super) colour: RGBColor,
}

/// A vertical line with a word at its head.
pub(super) struct Mark {
    pub(super) at: f64,
    pub(super) label: String,
}

/// One set of axes.
#[derive(Default)]
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) x_label: &'static str,
    pub(super) y_label: &'static str,
    pub(super) logarithmic: bool,
    /// Height in drawing units, without head and axis.
    pub(super) height: u32,
    /// Ends of the axes; `None`: as far as the lines reach.
    pub(super) x_range: Option<(f64, f64)>,
    pub(super) y_range: Option<(f64, f64)>,
    pub(super) fills: Vec<Fill>,
    pub(super) lines: Vec<Line>,
    pub(super) dots: Vec<Dot>,
    pub(super) marks: Vec<Mark>,
}

impl Panel {
    /// Whether any line has a point to draw.
    pub(super) fn has_points(&self) -> bool {
        self.points().next().is_some()
    }

    /// Every point that can be drawn.
    fn points(&self) -> impl Iterator<Item = &(f64, f64)> {
        let lines = self.lines.iter().flat_map(|line| &line.points);
        let areas = self.fills.iter().flat_map(|fill| fill.areas.iter().flatten());
        lines.chain(areas).filter(|p| self.drawable(**p))
    }

    fn x_axis(&self) -> std::ops::Range<f64> {
        self.x_range.map_or_else(|| self.range(|p| p.0, 0.0), |(from, to)| from..to)
    }

    fn y_axis(&self) -> std::ops::Range<f64> {
        self.y_range.map_or_else(|| self.range(|p| p.1, 0.06), |(from, to)| from..to)
    }

    pub(super) fn drawable(&self, (x, y): (f64, f64)) -> bool {
        x.is_finite() && y.is_finite() && (!self.logarithmic || (x > 0.0 && y > 0.0))
    }

    /// Smallest and largest of one coordinate over what can be drawn, with some air around it.
    fn range(&self, coordinate: impl Fn(&(f64, f64)) -> f64, air: f64) -> std::ops::Range<f64> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in self.points() {
            low = low.min(coordinate(point));
            high = high.max(coordinate(point));
        }
        if self.logarithmic {
            let high = high.max(low * 10.0);
            return low..high * 10f64.powf(air);
        }
        let span = if high > low { high - low } else { high.abs().max(1.0) };
        low - air * span..high + air * span
    }

    /// Rows that the words of the marks take, so that none writes over its neighbour.
    pub(super) fn mark_rows(&self, x: &std::ops::Range<f64>) -> Vec<usize> {
        let mut ends: Vec<f64> = Vec::new();
        let place = |at: f64| {
            let (at, from, to) = if self.logarithmic {
                (at.log10(), x.start.log10(), x.end.log10())
            } else {
                (at, x.start, x.end)
            };
            (at - from) / (to - from) * f64::from(WIDTH - LEFT)
        };
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

/// Panels one below the other.
pub(super) fn draw(panels: &[&Panel]) -> Result<String, String> {
    let heads: Vec<i32> = panels
        .iter()
        .map(|panel| {
            let rows = panel.mark_rows(&panel.x_axis()).iter().max().map_or(0, |row| row + 1);
            panel.head() + MARK_ROW * i32::try_from(rows).unwrap_or(0)
        })
        .collect();
    let heights: Vec<i32> = panels
        .iter()
        .zip(&heads)
        .map(|(panel, head)| head + GAP + i32::try_from(panel.height + BOTTOM).unwrap_or(0))
        .collect();
    let total = u32::try_from(heights.iter().sum::<i32>()).map_err(|e| e.to_string())?;
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, total)).into_drawing_area();
        root.fill(&WHITE).map_err(|e| e.to_string())?;
        let mut rest = root.clone();
        for ((panel, head), height) in panels.iter().zip(&heads).zip(&heights) {
            let (area, below) = rest.split_vertically(*height);
            rest = below;
            let (x, y) = (panel.x_axis(), panel.y_axis());
            if panel.logarithmic {
                axes::one(&area, panel, *head, (x.log_scale(), y.log_scale()))?;
            } else {
                axes::one(&area, panel, *head, (x, y))?;
            }
        }
        root.present().map_err(|e| e.to_string())?;
    }
    Ok(sized(&svg, total))
}

pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// A picture that only says a sentence.
pub(crate) fn nothing(sentence: &str) -> Result<String, String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, 160)).into_drawing_area();
        root.fill(&WHITE).map_err(|e| e.to_string())?;
        let style =
            TextStyle::from((FONT, 34).into_font()).color(&GREY).pos(Pos::new(HPos::Center, VPos::Center));
        root.draw(&Text::new(sentence.to_owned(), (WIDTH.cast_signed() / 2, 80), style))
            .map_err(|e| e.to_string())?;
        root.present().map_err(|e| e.to_string())?;
    }
    Ok(sized(&svg, 160))
}

/// The drawing at half its units on the page, as a picture to those who read the page aloud.
pub(crate) fn sized(svg: &str, height: u32) -> String {
    let drawn = format!("width=\"{WIDTH}\" height=\"{height}\"");
    let shown = format!("width=\"{}\" height=\"{}\" role=\"img\"", WIDTH / 2, height / 2);
    svg.replacen(&drawn, &shown, 1)
}

/// The drawing with `title` as its name.
pub(crate) fn described(svg: &str, title: &str) -> String {
    match svg.find('>') {
        Some(end) => format!("{}\n<title>{}</title>{}", &svg[..=end], escaped(title), &svg[end + 1..]),
        None => svg.to_owned(),
    }
}

fn escaped(text: &str) -> String {
    printable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) fn panel(channels: usize) -> Panel {
        let line = |i: usize| Line {
            label: Some(format!("channel number {i} unfiltered")),
            colour: COLOURS[i % COLOURS.len()],
            opacity: 1.0,
            stroke: 3,
            dash: Dash::Solid,
            points: vec![(0.0, 0.0), (100.0, 1.0)],
        };
        Panel {
            title: "First end".into(),
            x_label: "time, ms",
            y_label: "deceleration, g",
            logarithmic: false,
            height: 350,
            lines: (0..channels).map(line).collect(),
            marks: [("first contact", 0.0), ("separation", 6.0), ("slap-down", 60.0)]
                .map(|(label, at)| Mark { at, label: label.into() })
                .into(),
            ..Panel::default()
        }
    }

    #[test]
    fn near_marks_are_set_in_rows_of_their_own() {
        assert_eq!(panel(1).mark_rows(&(-10.0..100.0)), [0, 1, 0]);
    }

    #[test]
    fn a_logarithmic_axis_drops_what_it_cannot_show() {
        let mut panel = panel(1);
        panel.logarithmic = true;
        panel.marks.clear();
        panel.lines[0].points = vec![(0.0, 1.0), (10.0, 0.0), (10.0, 1.0), (1000.0, 0.1)];
        let svg = draw(&[&panel]).unwrap();
        assert!(svg.contains("polyline") && !svg.contains("2147483"));
    }
}
