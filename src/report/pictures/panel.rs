//! Content of a panel: axes, areas, lines, points and marked events, as data. Drawn at twice the size, so
//! that its whole-pixel coordinates stay fine.

use crate::numerics::{as_f64, extent};
use std::ops::Range;

/// Width of a picture in drawing units.
pub(crate) const WIDTH: f64 = 1800.0;

/// Red, green and blue, 0 to 255.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Colour(pub(crate) u8, pub(crate) u8, pub(crate) u8);

impl std::fmt::Display for Colour {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

pub(crate) const INK: Colour = Colour(38, 42, 48);
pub(crate) const GREY: Colour = Colour(110, 116, 124);
/// Colour of values beyond their limit.
pub(crate) const ALARM: Colour = Colour(179, 38, 30);

/// Colours that readers with a colour vision deficiency can distinguish too (Okabe & Ito 2008), darkest
/// first.
pub(crate) const COLOURS: [Colour; 7] = [
    Colour(0, 114, 178),
    Colour(213, 94, 0),
    Colour(0, 158, 115),
    Colour(204, 121, 167),
    Colour(230, 159, 0),
    Colour(86, 180, 233),
    Colour(90, 90, 90),
];

/// Dash of a line.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Dash {
    /// Solid.
    #[default]
    Solid,
    /// Into long pieces.
    Dashed,
    /// Into short ones.
    Dotted,
    /// Into short ones close to one another.
    Marked,
}

impl Dash {
    /// Lengths of dash and gap in drawing units; `None` for a solid line.
    pub(super) fn pieces(self) -> Option<[u32; 2]> {
        match self {
            Self::Solid => None,
            Self::Dashed => Some([16, 9]),
            Self::Dotted => Some([5, 8]),
            Self::Marked => Some([10, 8]),
        }
    }
}

/// Points from positions and values, each times its factor.
pub(crate) fn points(x: &[f64], y: &[f64], factors: [f64; 2]) -> Vec<(f64, f64)> {
    x.iter().zip(y).map(|(x, y)| (x * factors[0], y * factors[1])).collect()
}

/// One line.
#[derive(Clone)]
pub(crate) struct Curve {
    /// Name in the legend; `None` keeps it out.
    pub(crate) label: Option<String>,
    pub(crate) colour: Colour,
    /// 0 to 1.
    pub(crate) opacity: f64,
    /// Stroke in drawing units.
    pub(crate) stroke: u32,
    pub(crate) dash: Dash,
    pub(crate) points: Vec<(f64, f64)>,
    /// Distance of samples along x, if points were omitted; `None`: that of the points.
    pub(crate) step: Option<f64>,
}

impl Curve {
    /// A bold line that the legend does not name.
    pub(crate) fn new(colour: Colour, points: Vec<(f64, f64)>) -> Self {
        Self { label: None, colour, opacity: 1.0, stroke: 4, dash: Dash::Solid, points, step: None }
    }

    /// Sets the name in the legend.
    pub(crate) fn label(self, label: impl Into<String>) -> Self {
        Self { label: Some(label.into()), ..self }
    }

    /// Broken so.
    pub(crate) fn broken(self, dash: Dash) -> Self {
        Self { dash, ..self }
    }
}

/// Areas of one colour, under the lines.
pub(crate) struct Fill {
    /// Name in the legend; `None` keeps it out.
    pub(crate) label: Option<String>,
    pub(crate) colour: Colour,
    /// 0 to 1.
    pub(crate) opacity: f64,
    /// The corners of each area.
    pub(crate) areas: Vec<Vec<(f64, f64)>>,
}

impl Fill {
    /// Areas that the legend does not name.
    pub(crate) fn new(colour: Colour, opacity: f64, areas: Vec<Vec<(f64, f64)>>) -> Self {
        Self { label: None, colour, opacity, areas }
    }

    /// Sets the name in the legend.
    pub(crate) fn label(self, label: impl Into<String>) -> Self {
        Self { label: Some(label.into()), ..self }
    }

    /// The area between `low` and `high` over `x`, open where either is missing.
    pub(crate) fn band(x: &[f64], low: &[f64], high: &[f64]) -> Vec<Vec<(f64, f64)>> {
        let points: Vec<(f64, [f64; 2])> =
            x.iter().zip(low.iter().zip(high)).map(|(x, (low, high))| (*x, [*low, *high])).collect();
        let is_open = |(_, ends): &(f64, [f64; 2])| !ends.iter().all(|end| end.is_finite());
        let area = |run: &[(f64, [f64; 2])]| {
            let below = run.iter().map(|(x, [low, _])| (*x, *low));
            below.chain(run.iter().rev().map(|(x, [_, high])| (*x, *high))).collect()
        };
        points.split(is_open).filter(|run| run.len() > 1).map(area).collect()
    }

    /// The corners of a rectangle.
    pub(crate) fn rectangle(x: (f64, f64), y: (f64, f64)) -> Vec<(f64, f64)> {
        vec![(x.0, y.0), (x.0, y.1), (x.1, y.1), (x.1, y.0)]
    }
}

/// The shape of a point.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum PointShape {
    Dot,
    Square,
    /// Around another point.
    Ring,
}

impl PointShape {
    /// Shape for the points at this index.
    pub(crate) fn from_index(index: usize) -> Self {
        [Self::Dot, Self::Square][index % 2]
    }
}

/// Points of one look.
#[derive(Clone)]
pub(crate) struct Points {
    /// Name in the legend; `None` keeps it out.
    pub(crate) label: Option<String>,
    pub(crate) colour: Colour,
    pub(crate) shape: PointShape,
    /// Half the size in drawing units.
    pub(crate) radius: i32,
    pub(crate) is_hollow: bool,
    pub(crate) at: Vec<(f64, f64)>,
}

impl Points {
    /// Full points that the legend does not name.
    pub(crate) fn new(colour: Colour, shape: PointShape, at: Vec<(f64, f64)>) -> Self {
        Self { label: None, colour, shape, radius: 10, is_hollow: false, at }
    }

    /// Sets the name in the legend.
    pub(crate) fn label(self, label: impl Into<String>) -> Self {
        Self { label: Some(label.into()), ..self }
    }
}

/// A vertical line with a word at its head.
pub(crate) struct Mark {
    pub(crate) at: f64,
    pub(crate) label: String,
}

/// Words at either side of a row.
#[derive(Clone, Default, PartialEq)]
pub(crate) struct RowWords {
    pub(crate) left: String,
    pub(crate) right: String,
    pub(crate) is_heading: bool,
}

/// Scale of an axis.
#[derive(Clone, Default, PartialEq)]
pub(crate) enum AxisScale {
    #[default]
    Linear,
    Logarithmic,
    /// Rows below one another, one unit each, the last one from 0 to 1.
    Rows(Vec<RowWords>),
}

/// One axis.
#[derive(Clone, Default)]
pub(crate) struct PanelAxis {
    pub(crate) label: String,
    pub(crate) scale: AxisScale,
    /// Ends of the axis; `None`: as far as the lines reach.
    pub(crate) range: Option<(f64, f64)>,
}

impl PanelAxis {
    /// A linear axis that spans its values.
    pub(crate) fn new(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// Makes the axis logarithmic, with powers of ten.
    pub(crate) fn logarithmic(self) -> Self {
        Self { scale: AxisScale::Logarithmic, ..self }
    }

    /// Sets the ends.
    pub(crate) fn range(self, range: Option<(f64, f64)>) -> Self {
        Self { range, ..self }
    }

    /// The value as a place along the axis.
    pub(super) fn place(&self, value: f64) -> f64 {
        if self.scale == AxisScale::Logarithmic { value.log10() } else { value }
    }

    /// True if the axis has a place for the value.
    fn holds(&self, value: f64) -> bool {
        value.is_finite() && (value > 0.0 || self.scale != AxisScale::Logarithmic)
    }

    /// Smallest and largest of the values shown, with some air around them.
    fn value_range(&self, values: impl Iterator<Item = f64>, air: f64) -> Range<f64> {
        if let Some((from, to)) = self.range {
            return from..to;
        }
        let (low, high) = extent(values);
        if self.scale == AxisScale::Logarithmic {
            return low..high.max(low * 10.0) * 10f64.powf(air);
        }
        let span = if high > low { high - low } else { high.abs().max(1.0) };
        low - air * span..high + air * span
    }
}

/// One set of axes.
#[derive(Default)]
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) x: PanelAxis,
    pub(crate) y: PanelAxis,
    /// Height in drawing units, without head and axis.
    pub(crate) height: u32,
    /// Room for the words of rows at the left and the right; `None`: for ticks.
    pub(crate) sides: Option<(u32, u32)>,
    pub(crate) fills: Vec<Fill>,
    pub(crate) lines: Vec<Curve>,
    pub(crate) points: Vec<Points>,
    pub(crate) marks: Vec<Mark>,
}

impl<L: Into<String>> From<L> for PanelAxis {
    fn from(label: L) -> Self {
        Self::new(label)
    }
}

impl Panel {
    /// An empty panel with these axes.
    pub(crate) fn new(
        title: impl Into<String>,
        x: impl Into<PanelAxis>,
        y: impl Into<PanelAxis>,
        height: u32,
    ) -> Self {
        Self { title: title.into(), x: x.into(), y: y.into(), height, ..Self::default() }
    }

    /// An empty panel of rows of this height, with room for their words at the left and the right.
    pub(crate) fn from_rows(rows: Vec<RowWords>, row_height: u32, sides: (u32, u32)) -> Self {
        let count = u32::try_from(rows.len()).unwrap_or(1).max(1);
        let range = Some((0.0, count.into()));
        let y = PanelAxis { scale: AxisScale::Rows(rows), range, ..PanelAxis::default() };
        Self { y, height: row_height * count, sides: Some(sides), ..Self::default() }
    }

    /// The middle of a row, counted from the top one.
    pub(crate) fn row_middle(&self, row: usize) -> f64 {
        self.y_range().end - 0.5 - as_f64(row)
    }

    /// Leaves room beside the first and the last of the values: this share of the distance between them.
    pub(crate) fn with_air(mut self, share: f64) -> Self {
        let Range { start, end } = self.x_range();
        let air = share * (end - start).max(1.0);
        self.x.range = Some((start - air, end + air)).filter(|(from, to)| from.is_finite() && to.is_finite());
        self
    }

    /// Every point that can be drawn.
    pub(super) fn points(&self) -> impl Iterator<Item = &(f64, f64)> {
        let lines = self.lines.iter().flat_map(|line| &line.points);
        let areas = self.fills.iter().flat_map(|fill| fill.areas.iter().flatten());
        let points = self.points.iter().flat_map(|points| &points.at);
        lines.chain(areas).chain(points).filter(|(x, y)| self.x.holds(*x) && self.y.holds(*y))
    }

    /// Ends of the horizontal axis.
    pub(crate) fn x_range(&self) -> Range<f64> {
        self.x.value_range(self.points().map(|p| p.0), 0.0)
    }

    /// Ends of the vertical axis.
    pub(super) fn y_range(&self) -> Range<f64> {
        self.y.value_range(self.points().map(|p| p.1), 0.06)
    }
}
