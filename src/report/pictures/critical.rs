//! Critical angles to one picture: a row a case, a bar for its band and a dot for where it is largest.

use super::super::ReportError;
use super::super::prediction::{bands_words, case_words, criterion_value, criterion_words, degrees};
use super::super::rounding::{MISSING, plain};
use super::super::text::printable;
use super::look::Look;
use super::panel::{self, Area, COLOURS, FONT, INK, WIDTH};
use super::rows::Rows;
use super::{Picture, assemble_or};
use crate::data::{Criterion, CriticalAngle, CriticalRange, Study};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const TITLE: &str = "Critical angles";
const LEFT: u32 = 400;
const RIGHT: u32 = 330;
const ROW: u32 = 46;
const BOTTOM: u32 = 88;
const TOP: u32 = 14;

/// One row of the picture.
enum Row {
    /// What the rows below it are about.
    Heading(String),
    /// One case, or the ranges of k and friction together.
    Case(Case),
}

struct Case {
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
    let angles = &study.request.angles_deg;
    let ends = angles.first().copied().zip(angles.last().copied()).filter(|(from, to)| from < to);
    let (Some((from, to)), false) = (ends, rows.is_empty()) else {
        let nothing = (
            "There is nothing to show: no case has a slap-down.",
            "No case of this study has a critical angle.",
        );
        return assemble_or(name, TITLE, String::new(), &[], nothing);
    };
    let failed = |reason| ReportError::Picture { picture: name.to_owned(), reason };
    let svg = draw(&rows, from..to, study.request.angle_deg).map_err(failed)?;
    let look = Look::of(&study.request.contacts, &study.request.ks);
    let caption = format!(
        "Dots: the drop angle at which each quantity is largest while the first end strikes once, with the value at the right. Bars: the angles within {} % of it. \
         Grey: over the ranges of k and friction; the line joins the lowest and the highest critical angle, the bar is what lies in \
         every band. Rings: angles at which the first end strikes again and the value is larger still; it jumps there from angle to angle. \
         Dashed: {}°.{}{}",
        plain(study.request.band_percent, 3),
        plain(study.request.angle_deg, 4),
        look.left_out(),
        if crowded(study, &look) { " Single cases of the body only." } else { "" }
    );
    let alt = format!("{TITLE}. {}", spoken(&rows));
    let svg = panel::described(&svg, TITLE);
    Ok(Picture { name: name.to_owned(), title: TITLE.to_owned(), alt, caption, svg })
}

fn spoken(rows: &[Row]) -> String {
    let rows: Vec<String> = rows
        .iter()
        .map(|row| match row {
            Row::Heading(words) => format!("{words}:"),
            Row::Case(case) => {
                format!("{}: {}, band {}°;", case.label, case.words, bands_words(&case.bands_deg))
            }
        })
        .collect();
    rows.join(" ")
}

fn rows(study: &Study) -> Vec<Row> {
    let look = Look::of(&study.request.contacts, &study.request.ks);
    let crowded = crowded(study, &look);
    let mut rows = Vec::new();
    for criterion in Criterion::ALL {
        let drawn = |c: &&CriticalAngle| c.criterion == criterion && look.shows(c.contact, c.k);
        let cases =
            study.critical.iter().filter(drawn).filter(|c| !crowded || c.model == study.monte_carlo.model);
        let mut group: Vec<Row> = cases.map(|c| Row::Case(case(c, &look))).collect();
        let ranges = study.ranges.iter().filter(|range| range.criterion == criterion);
        group.extend(ranges.map(|range| Row::Case(range_case(range))));
        if !group.is_empty() {
            rows.push(Row::Heading(format!("Largest {}", criterion_words(criterion))));
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

fn case(c: &CriticalAngle, look: &Look) -> Case {
    Case {
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

fn range_case(r: &CriticalRange) -> Case {
    Case {
        label: format!("{}, all k and friction", r.model.as_str()),
        colour: COLOURS[6],
        angle_deg: r.angle_deg,
        bands_deg: r.common_bands_deg.clone(),
        larger_deg: r.further_impacts.map(|at| at.0),
        words: value_words(r.criterion, r.largest, r.worst.0),
    }
}

fn draw(rows: &[Row], x: std::ops::Range<f64>, asked_deg: f64) -> Result<String, String> {
    let count = u32::try_from(rows.len()).map_err(|e| e.to_string())?;
    let height = TOP + ROW * count + BOTTOM;
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        paint(&root, rows, x, asked_deg).map_err(|e| e.to_string())?;
    }
    Ok(panel::sized(&svg, height))
}

type Failure = DrawingAreaErrorKind<std::io::Error>;

fn paint(root: &Area, rows: &[Row], x: std::ops::Range<f64>, asked_deg: f64) -> Result<(), Failure> {
    root.fill(&WHITE)?;
    #[allow(clippy::cast_precision_loss, reason = "rows are few")]
    let count = rows.len() as f64;
    let mut chart = ChartBuilder::on(root)
        .margin_top(TOP)
        .margin_right(RIGHT)
        .x_label_area_size(BOTTOM)
        .y_label_area_size(LEFT)
        .build_cartesian_2d(x.clone(), Rows(0.0..count))?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .x_desc("drop angle, °")
        .axis_desc_style((FONT, 32, &INK))
        .label_style((FONT, 30, &INK))
        .axis_style(INK.mix(0.5))
        .bold_line_style(INK.mix(0.15))
        .light_line_style(INK.mix(0.0))
        .x_labels(10)
        .x_label_formatter(&|x| plain(*x, 4))
        .draw()?;
    if x.contains(&asked_deg) {
        let line = vec![(asked_deg, 0.0), (asked_deg, count)];
        chart.draw_series(DashedLineSeries::new(line, 10, 8, INK.mix(0.55).stroke_width(2)))?;
    }
    let mut y = count - 0.5;
    for row in rows {
        match row {
            Row::Heading(words) => {
                let at = chart.backend_coord(&(x.start, y)).1;
                let style = TextStyle::from((FONT, 32).into_font().style(FontStyle::Bold)).color(&INK);
                root.draw(&Text::new(
                    words.clone(),
                    (20, at),
                    style.pos(Pos::new(HPos::Left, VPos::Center)),
                ))?;
            }
            Row::Case(case) => {
                let place = |angle_deg: f64| chart.backend_coord(&(angle_deg.clamp(x.start, x.end), y));
                paint_case(root, case, place)?;
            }
        }
        y -= 1.0;
    }
    root.present()
}

fn paint_case(root: &Area, case: &Case, place: impl Fn(f64) -> (i32, i32)) -> Result<(), Failure> {
    let y = place(0.0).1;
    let words = |text: String, x: i32, side: HPos| {
        let style = TextStyle::from((FONT, 29).into_font()).color(&INK).pos(Pos::new(side, VPos::Center));
        root.draw(&Text::new(printable(&text), (x, y), style))
    };
    words(case.label.clone(), LEFT.cast_signed() - 16, HPos::Right)?;
    words(case.words.clone(), WIDTH.cast_signed() - RIGHT.cast_signed() + 18, HPos::Left)?;
    for band in &case.bands_deg {
        let (from, to) = (place(band.0).0, place(band.1).0);
        let corners = [(from, y - 11), (to.max(from + 2), y + 11)];
        root.draw(&Rectangle::new(corners, case.colour.mix(0.32).filled()))?;
        for x in [from, to] {
            root.draw(&PathElement::new(vec![(x, y - 11), (x, y + 11)], case.colour.stroke_width(3)))?;
        }
    }
    if let Some(larger_deg) = case.larger_deg {
        root.draw(&Circle::new(place(larger_deg), 8, WHITE.filled()))?;
        root.draw(&Circle::new(place(larger_deg), 8, case.colour.stroke_width(3)))?;
    }
    let (low, high) = case.angle_deg;
    if !(low.is_finite() && high.is_finite()) {
        return Ok(());
    }
    if low < high {
        root.draw(&PathElement::new(vec![place(low), place(high)], case.colour.stroke_width(4)))?;
    }
    for angle_deg in [low, high] {
        root.draw(&Circle::new(place(angle_deg), 10, WHITE.filled()))?;
        root.draw(&Circle::new(place(angle_deg), 8, case.colour.filled()))?;
    }
    Ok(())
}
