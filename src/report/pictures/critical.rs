//! Critical angles to one picture: a row a case, a bar for its band and a dot for where it is largest.

use super::super::rounding::{MISSING, plain};
use super::super::words::{case_words, criterion_value, criterion_words, degrees};
use super::draw::{Picture, Plate};
use super::look::{Look, angle_axis, angle_panel};
use super::panel::{COLOURS, Colour, Curve, Fill, Panel, PanelAxis, PointShape, Points, RowWords};
use crate::data::{Criterion, CriticalAngle, Study};

const NOTHING: (&str, &str) =
    ("There is nothing to show: no case has a slap-down.", "No case of this study has a critical angle.");

/// Height of a row.
const ROW: u32 = 46;

/// One row of the picture: a case, or the ranges of k and friction together; a heading has words alone.
struct CriticalRow {
    words: RowWords,
    colour: Colour,
    /// Lowest and highest critical angle, degrees; the same for one case.
    angle_deg: (f64, f64),
    bands_deg: Vec<(f64, f64)>,
    /// Where it is larger still, as the first end strikes again.
    larger_deg: Option<f64>,
}

/// The picture.
pub(super) fn picture(study: &Study, name: &str) -> Picture {
    let look = Look::of(&study.request.contacts, &study.request.ks);
    let rows = rows(study, &look);
    let is_empty = rows.is_empty() || angle_axis(&study.request).range.is_none();
    let panel = (!is_empty).then(|| panel(study, &rows));
    Plate::new(name, "Critical angles", caption(study, &look, &rows)).or(NOTHING).picture(panel.as_slice())
}

fn caption(study: &Study, look: &Look, rows: &[CriticalRow]) -> String {
    let rings = " Rings: angles at which the first end strikes again and the value is larger still; it jumps there from angle to angle.";
    let said = |is_so: bool, words| if is_so { words } else { "" };
    format!(
        "Dots: the drop angle at which each quantity is largest while the first end strikes once, with the value at the right. \
         Bars: the angles within {} % of it.{} Dashed: {}°.{}{}",
        plain(study.request.band_percent, 3),
        said(rows.iter().any(|row| row.larger_deg.is_some()), rings),
        plain(study.request.angle_deg, 4),
        look.left_out(),
        said(is_crowded(study, look), " Single cases of the body only.")
    )
}

fn rows(study: &Study, look: &Look) -> Vec<CriticalRow> {
    let is_crowded = is_crowded(study, look);
    let mut rows = Vec::new();
    for criterion in Criterion::ALL {
        let is_drawn = |c: &&CriticalAngle| {
            let is_of_body = !is_crowded || c.model == study.monte_carlo.model;
            c.criterion == criterion && look.shows(c.contact, c.k) && is_of_body
        };
        let cases = study.critical.iter().filter(is_drawn).map(|c| case(c, look));
        let group: Vec<CriticalRow> = cases.collect();
        if !group.is_empty() {
            let left = format!("Largest {}", criterion_words(criterion));
            let words = RowWords { left, right: String::new(), is_heading: true };
            let none = (f64::NAN, f64::NAN);
            let (colour, bands_deg) = (COLOURS[0], Vec::new());
            rows.push(CriticalRow { words, colour, angle_deg: none, bands_deg, larger_deg: None });
            rows.extend(group);
        }
    }
    rows
}

/// More cases than this, and the rod gives way to the body: the picture must fit a page.
const MOST_CASES: usize = 12;

fn is_crowded(study: &Study, look: &Look) -> bool {
    let speeds = study.critical.iter().filter(|c| c.criterion == Criterion::Speed);
    speeds.filter(|c| look.shows(c.contact, c.k)).count() > MOST_CASES
}

fn case(c: &CriticalAngle, look: &Look) -> CriticalRow {
    let left = format!("{}, {}", c.model.as_str(), case_words(c.contact, c.k));
    let right = value_words(c.criterion, c.largest, c.angle_deg);
    CriticalRow {
        words: RowWords { left, right, is_heading: false },
        colour: look.colour(c.contact, c.k),
        angle_deg: (c.angle_deg, c.angle_deg),
        bands_deg: c.bands_deg.clone(),
        larger_deg: c.further_impacts.map(|at| at.0),
    }
}

/// "25.04 m/s at 12.5°", or the dash where there is none.
fn value_words(criterion: Criterion, largest: f64, angle_deg: f64) -> String {
    if !(largest.is_finite() && angle_deg.is_finite()) {
        return MISSING.to_owned();
    }
    format!("{} at {}°", criterion_value(criterion, largest), degrees(angle_deg))
}

fn panel(study: &Study, rows: &[CriticalRow]) -> Panel {
    let y = PanelAxis::rows(rows.iter().map(|row| row.words.clone()).collect());
    let mut y_case = y.range.unwrap_or_default().1 - 0.5;
    let mut panel = Panel {
        y,
        height: ROW * u32::try_from(rows.len()).unwrap_or(1),
        sides: Some((400, 330)),
        ..angle_panel(&study.request, String::new(), "")
    };
    for row in rows {
        if !row.words.is_heading {
            add_case(&mut panel, row, y_case);
        }
        y_case -= 1.0;
    }
    panel
}

/// The band of a case as a bar, its critical angle as a dot, or as two joined by a line.
fn add_case(panel: &mut Panel, case: &CriticalRow, y: f64) {
    /// Half the height of a bar.
    const HALF: f64 = 0.24;
    let (first, last) = panel.x.range.unwrap_or_default();
    let cut = |band: &(f64, f64)| (band.0.clamp(first, last), band.1.clamp(first, last));
    let bands: Vec<(f64, f64)> = case.bands_deg.iter().map(cut).collect();
    let upright = |x: f64| Curve { stroke: 3, ..Curve::new(case.colour, vec![(x, y - HALF), (x, y + HALF)]) };
    panel.lines.extend(bands.iter().flat_map(|(from, to)| [*from, *to]).map(upright));
    let areas = bands.into_iter().map(|band| Fill::rectangle(band, (y - HALF, y + HALF))).collect();
    panel.fills.push(Fill::new(case.colour, 0.32, areas));
    let larger = case.larger_deg.map(|at| (at, y)).into_iter().collect();
    panel.points.push(Points {
        is_hollow: true,
        radius: 8,
        ..Points::new(case.colour, PointShape::Dot, larger)
    });
    let (low, high) = case.angle_deg;
    if low < high {
        panel.lines.push(Curve::new(case.colour, vec![(low, y), (high, y)]));
    }
    panel
        .points
        .push(Points { radius: 8, ..Points::new(case.colour, PointShape::Dot, vec![(low, y), (high, y)]) });
}
