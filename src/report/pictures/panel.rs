//! Lines with axes, legend and marked events to SVG; drawn at twice the size so that its whole-pixel coordinates stay fine.

use super::super::text::printable;
use super::decimate::runs;
use super::legend::heading;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Width of a picture in drawing units.
pub(super) const WIDTH: u32 = 1800;
pub(super) const FONT: &str = "Helvetica, Arial, sans-serif";
const MARK_ROW: i32 = 34;
pub(super) const LEFT: u32 = 130;
const BOTTOM: u32 = 88;
/// Air below a panel.
const GAP: i32 = 26;
pub(super) const RIGHT: i32 = 28;
pub(super) const INK: RGBColor = RGBColor(38, 42, 48);
const GREY: RGBColor = RGBColor(110, 116, 124);

/// Colours that also readers with a colour vision deficiency tell apart (Okabe & Ito 2008), darkest first.
pub(super) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];

/// One line.
pub(super) struct Line {
    /// Its name in the legend; `None` keeps it out.
    pub(super) label: Option<String>,
    pub(super) colour: RGBColor,
    /// 0 to 1.
    pub(super) opacity: f64,
    /// Stroke in drawing units.
    pub(super) stroke: u32,
    pub(super) dashed: bool,
    pub(super) points: Vec<(f64, f64)>,
}

/// A vertical line with a word at its head.
pub(super) struct Mark {
    pub(super) at: f64,
    pub(super) label: String,
}

/// One set of axes.
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) x_label: &'static str,
    pub(super) y_label: &'static str,
    pub(super) logarithmic: bool,
    /// Height in drawing units, without head and axis.
    pub(super) height: u32,
    pub(super) lines: Vec<Line>,
    pub(super) marks: Vec<Mark>,
}

impl Panel {
    /// Whether any line has a point to draw.
    pub(super) fn has_points(&self) -> bool {
        self.lines.iter().any(|line| line.points.iter().any(|p| self.drawable(*p)))
    }

    fn drawable(&self, (x, y): (f64, f64)) -> bool {
        x.is_finite() && y.is_finite() && (!self.logarithmic || (x > 0.0 && y > 0.0))
    }

    /// Smallest and largest of one coordinate over what can be drawn, with some air around it.
    fn range(&self, coordinate: impl Fn(&(f64, f64)) -> f64, air: f64) -> std::ops::Range<f64> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in self.lines.iter().flat_map(|line| &line.points).filter(|p| self.drawable(**p)) {
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
    fn mark_rows(&self, x: &std::ops::Range<f64>) -> Vec<usize> {
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
            let rows = panel.mark_rows(&panel.range(|p| p.0, 0.0)).iter().max().map_or(0, |row| row + 1);
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
            let (x, y) = (panel.range(|p| p.0, 0.0), panel.range(|p| p.1, 0.06));
            if panel.logarithmic {
                one(&area, panel, *head, (x.log_scale(), y.log_scale()))?;
            } else {
                one(&area, panel, *head, (x, y))?;
            }
        }
        root.present().map_err(|e| e.to_string())?;
    }
    Ok(sized(&svg, total))
}

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn one<X, Y>(area: &Area, panel: &Panel, head: i32, axes: (X, Y)) -> Result<(), String>
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
    // What is faint lies under what is bold.
    let (faint, bold): (Vec<_>, Vec<_>) = panel.lines.iter().partition(|line| line.opacity < 0.5);
    for line in faint.into_iter().chain(bold) {
        draw_line(&mut chart, panel, line, &bounds.0)?;
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
        if line.dashed {
            chart.draw_series(DashedLineSeries::new(run, 16, 9, style)).map_err(|e| e.to_string())?;
        } else {
            chart.draw_series(LineSeries::new(run, style)).map_err(|e| e.to_string())?;
        }
    }
    Ok(())
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

/// A picture that only says a sentence.
pub(super) fn nothing(sentence: &str) -> Result<String, String> {
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
pub(super) fn sized(svg: &str, height: u32) -> String {
    let drawn = format!("width=\"{WIDTH}\" height=\"{height}\"");
    let shown = format!("width=\"{}\" height=\"{}\" role=\"img\"", WIDTH / 2, height / 2);
    svg.replacen(&drawn, &shown, 1)
}

/// The drawing with `title` as its name.
pub(super) fn described(svg: &str, title: &str) -> String {
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
            dashed: false,
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

    #[test]
    fn ticks_read_well() {
        assert_eq!(tick(-0.000_000_01, false), "0");
        assert_eq!(tick(-12.5, false), "−12.5");
        assert_eq!(tick(1e-5, true), "1e−5");
        assert_eq!(tick(100.0, true), "100");
    }
}
