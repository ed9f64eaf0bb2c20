//! Critical angles to one picture: a row a case, a bar for its band and a dot for where it is largest.

use super::super::ReportError;
use super::super::rounding::{MISSING, plain};
use super::super::words::{bands_words, case_words, criterion_value, criterion_words, degrees, has_ranges};
use super::draw::{Picture, Plate};
use super::look::{Look, angle_axis, angle_panel};
use super::panel::{COLOURS, Fill, Line, Panel, PanelAxis, PointShape, Points, RowWords};
use crate::data::{Criterion, CriticalAngle, CriticalRange, Study};
use plotters::style::RGBColor;

const TITLE: &str = "Critical angles";

/// Height of a row.
const ROW: u32 = 46;

/// One row of the picture.
enum CriticalRow {
    /// What the rows below it are about.
    Heading(String),
    /// One case, or the ranges of k and friction together.
    Case(CriticalCase),
}

struct CriticalCase {
    label: String,
    colour: RGBColor,
    /// Lowest and highest critical angle, degrees; the same for one case.
    angle_deg: (f64, f64),
    bands_deg: Vec<(f64, f64)>,
    /// Where it is larger still, as the first end strikes again.
    larger_deg: Option<f64>,
    words: String,
}

/// The picture.
pub(super) fn picture(study: &Study, name: &str) -> Result<Picture, ReportError> {
    let rows = rows(study);
    let nothing =
        ("There is nothing to show: no case has a slap-down.", "No case of this study has a critical angle.");
    let is_empty = rows.is_empty() || angle_axis(&study.request).range.is_none();
    let panels = if is_empty { vec![] } else { vec![panel(study, &rows)] };
    let mut picture = Plate::new(name, TITLE, caption(study, &rows)).or(nothing).picture(&panels)?;
    if !panels.is_empty() {
        picture.alt = format!("{TITLE}. {}", spoken(&rows));
    }
    Ok(picture)
}

fn caption(study: &Study, rows: &[CriticalRow]) -> String {
    let look = Look::of(&study.request.contacts, &study.request.ks);
    let rings = rows.iter().any(|row| matches!(row, CriticalRow::Case(case) if case.larger_deg.is_some()));
    let mut caption = vec![format!(
        "Dots: the drop angle at which each quantity is largest while the first end strikes once, with the value at the right. \
         Bars: the angles within {} % of it.",
        plain(study.request.band_percent, 3)
    )];
    if has_ranges(&study.request) {
        let text = " Grey: over the ranges of k and friction; the line joins the lowest and the highest critical angle, the bar is what \
                    lies in every band.";
        caption.push(text.to_owned());
    }
    if rings {
        let text = " Rings: angles at which the first end strikes again and the value is larger still; it jumps there from angle to angle.";
        caption.push(text.to_owned());
    }
    caption.push(format!(" Dashed: {}°.{}", plain(study.request.angle_deg, 4), look.left_out()));
    if crowded(study, &look) {
        caption.push(" Single cases of the body only.".to_owned());
    }
    caption.concat()
}

fn spoken(rows: &[CriticalRow]) -> String {
    let rows: Vec<String> = rows
        .iter()
        .map(|row| match row {
            CriticalRow::Heading(words) => format!("{words}:"),
            CriticalRow::Case(case) => {
                format!("{}: {}, band {}°;", case.label, case.words, bands_words(&case.bands_deg))
            }
        })
        .collect();
    rows.join(" ")
}

fn rows(study: &Study) -> Vec<CriticalRow> {
    let look = Look::of(&study.request.contacts, &study.request.ks);
    let crowded = crowded(study, &look);
    let mut rows = Vec::new();
    for criterion in Criterion::ALL {
        let drawn = |c: &&CriticalAngle| c.criterion == criterion && look.shows(c.contact, c.k);
        let cases =
            study.critical.iter().filter(drawn).filter(|c| !crowded || c.model == study.monte_carlo.model);
        let mut group: Vec<CriticalRow> = cases.map(|c| CriticalRow::Case(case(c, &look))).collect();
        let wide = has_ranges(&study.request);
        let ranges = study.ranges.iter().filter(|range| wide && range.criterion == criterion);
        group.extend(ranges.map(|range| CriticalRow::Case(range_case(range))));
        if !group.is_empty() {
            rows.push(CriticalRow::Heading(format!("Largest {}", criterion_words(criterion))));
            rows.extend(group);
        }
    }
    rows
}

/// More cases than this, and the rod gives way to the body: the picture must fit a page.
const MOST_CASES: usize = 12;

fn crowded(study: &Study, look: &Look) -> bool {
    let speeds = study.critical.iter().filter(|c| c.criterion == Criterion::Speed);
    speeds.filter(|c| look.shows(c.contact, c.k)).count() > MOST_CASES
}

fn case(c: &CriticalAngle, look: &Look) -> CriticalCase {
    CriticalCase {
        label: format!("{}, {}", c.model.as_str(), case_words(c.contact, c.k)),
        colour: look.colour(c.contact, c.k),
        angle_deg: (c.angle_deg, c.angle_deg),
        bands_deg: c.bands_deg.clone(),
        larger_deg: c.further_impacts.map(|at| at.0),
        words: value_words(c.criterion, c.largest, c.angle_deg),
    }
}

/// "25.04 m/s at 12.5°", or the dash where there is none.
fn value_words(criterion: Criterion, largest: f64, angle_deg: f64) -> String {
    if !(largest.is_finite() && angle_deg.is_finite()) {
        return MISSING.to_owned();
    }
    format!("{} at {}°", criterion_value(criterion, largest), degrees(angle_deg))
}

fn range_case(r: &CriticalRange) -> CriticalCase {
    CriticalCase {
        label: format!("{}, all k and friction", r.model.as_str()),
        colour: COLOURS[6],
        angle_deg: r.angle_deg,
        bands_deg: r.common_bands_deg.clone(),
        larger_deg: r.further_impacts.map(|at| at.0),
        words: value_words(r.criterion, r.largest, r.worst.angle_deg),
    }
}

fn panel(study: &Study, rows: &[CriticalRow]) -> Panel {
    let words = |row: &CriticalRow| match row {
        CriticalRow::Heading(words) => {
            RowWords { left: words.clone(), is_heading: true, ..RowWords::default() }
        }
        CriticalRow::Case(case) => {
            RowWords { left: case.label.clone(), right: case.words.clone(), ..RowWords::default() }
        }
    };
    let y = PanelAxis::rows(rows.iter().map(words).collect());
    let mut y_case = y.range.unwrap_or_default().1 - 0.5;
    let mut panel = Panel {
        x: angle_axis(&study.request),
        y,
        height: ROW * u32::try_from(rows.len()).unwrap_or(1),
        sides: Some((400, 330)),
        ..angle_panel(&study.request, String::new(), "")
    };
    for row in rows {
        if let CriticalRow::Case(case) = row {
            add_case(&mut panel, case, y_case);
        }
        y_case -= 1.0;
    }
    panel
}

/// The band of a case as a bar, its critical angle as a dot, or as two joined by a line.
fn add_case(panel: &mut Panel, case: &CriticalCase, y: f64) {
    /// Half the height of a bar.
    const HALF: f64 = 0.24;
    let (first, last) = panel.x.range.unwrap_or_default();
    let cut = |band: &(f64, f64)| (band.0.clamp(first, last), band.1.clamp(first, last));
    let bands: Vec<(f64, f64)> = case.bands_deg.iter().map(cut).collect();
    let upright = |x: f64| Line { stroke: 3, ..Line::new(case.colour, vec![(x, y - HALF), (x, y + HALF)]) };
    panel.lines.extend(bands.iter().flat_map(|(from, to)| [*from, *to]).map(upright));
    let areas = bands.into_iter().map(|band| Fill::rectangle(band, (y - HALF, y + HALF))).collect();
    panel.fills.push(Fill { label: None, colour: case.colour, opacity: 0.32, areas });
    let larger = case.larger_deg.map(|at| (at, y)).into_iter().collect();
    panel.points.push(Points {
        is_hollow: true,
        radius: 8,
        ..Points::new(case.colour, PointShape::Dot, larger)
    });
    let (low, high) = case.angle_deg;
    if low < high {
        panel.lines.push(Line::new(case.colour, vec![(low, y), (high, y)]));
    }
    panel
        .points
        .push(Points { radius: 8, ..Points::new(case.colour, PointShape::Dot, vec![(low, y), (high, y)]) });
}
