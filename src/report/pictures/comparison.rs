//! Measured beside predicted slap-down speed to one picture: a row a prediction, a band for the measurement.

use super::super::ReportError;
use super::super::rounding;
use super::super::text::printable;
use super::panel::{self, COLOURS, FONT, INK, WIDTH};
use super::rows::Rows;
use super::{Picture, assemble};
use crate::data::{Analysis, Contact, Estimate, Prediction};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const LEFT: u32 = 560;
const RIGHT: u32 = 230;
const ROW: u32 = 52;
const NAME: &str = "comparison";
const TITLE: &str = "Measured beside predicted";

/// One row: its words, speed, half-width and whether it is made with the measured k.
struct Row {
    label: String,
    speed_m_s: f64,
    u95_m_s: Option<f64>,
    own_k: bool,
}

/// The picture.
pub(super) fn picture(analysis: &Analysis) -> Result<Picture, ReportError> {
    let rows = rows(analysis);
    let measured = analysis.result.slap_down.speed.filter(|e| e.value.is_finite());
    let failed = |reason| ReportError::Picture { picture: NAME.to_owned(), reason };
    if rows.is_empty() && measured.is_none() {
        return assemble(NAME, TITLE, String::new(), &[]);
    }
    let svg = draw(&rows, measured.as_ref()).map_err(failed)?;
    let caption = "Speed of the second end just before it strikes. Dots: the analytical models with the borderline k; squares: with the \
                   measured k, with their 95 % intervals where known. Line and band: the measurement and its 95 % interval."
        .to_owned();
    let alt = match &measured {
        Some(speed) => format!("{TITLE}. Measured {}. {}", rounding::interval(Some(speed)), spoken(&rows)),
        None => format!("{TITLE}. No measured speed. {}", spoken(&rows)),
    };
    Ok(Picture { name: NAME.into(), title: TITLE.into(), alt, caption, svg: panel::described(&svg, TITLE) })
}

fn spoken(rows: &[Row]) -> String {
    let rows: Vec<String> =
        rows.iter().map(|row| format!("{}: {:.2} m/s", row.label, row.speed_m_s)).collect();
    rows.join("; ")
}

fn rows(analysis: &Analysis) -> Vec<Row> {
    let result = &analysis.result;
    let measured_k = result.k.map(|k| k.value);
    let row = |p: &Prediction| {
        let speed_m_s = p.slap_down_speed_m_s.filter(|v| v.is_finite())?;
        let own_k = measured_k.is_some_and(|k| (k - p.k).abs() < 1e-9);
        let with_contact = own_k && p.contact == analysis.cask_file.contact;
        let u95_m_s = result
            .model
            .iter()
            .flat_map(|m| m.candidates.iter().rev())
            .find(|c| with_contact && c.model == p.model)
            .and_then(|c| c.u95)
            .filter(|u| u.is_finite());
        let contact = match p.contact {
            Contact::Coulomb(coefficient) => format!("friction {coefficient}"),
            contact => contact.to_string(),
        };
        let k = if own_k {
            format!("k = {} (measured)", rounding::fixed(p.k, 3))
        } else {
            format!("k = {}", rounding::plain(p.k, 3))
        };
        Some(Row { label: format!("{}, {contact}, {k}", p.model.as_str()), speed_m_s, u95_m_s, own_k })
    };
    result.predictions.iter().filter_map(row).collect()
}

fn draw(rows: &[Row], measured: Option<&Estimate>) -> Result<String, String> {
    let count = u32::try_from(rows.len()).map_err(|e| e.to_string())?;
    let height = 70 + ROW * count.max(1) + 88;
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        paint(&root, rows, measured).map_err(|e| e.to_string())?;
    }
    Ok(panel::sized(&svg, height))
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Failure = DrawingAreaErrorKind<std::io::Error>;

fn paint(root: &Area, rows: &[Row], measured: Option<&Estimate>) -> Result<(), Failure> {
    root.fill(&WHITE)?;
    let x = speed_range(rows, measured);
    #[allow(clippy::cast_precision_loss, reason = "rows are few")]
    let count = rows.len().max(1) as f64;
    let mut chart = ChartBuilder::on(root)
        .margin_top(70)
        .margin_right(RIGHT)
        .x_label_area_size(88)
        .y_label_area_size(LEFT)
        .build_cartesian_2d(x.clone(), Rows(0.0..count))?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .x_desc("slap-down speed, m/s")
        .axis_desc_style((FONT, 32, &INK))
        .label_style((FONT, 30, &INK))
        .axis_style(INK.mix(0.5))
        .bold_line_style(INK.mix(0.15))
        .light_line_style(INK.mix(0.0))
        .x_labels(10)
        .draw()?;
    if let Some(speed) = measured {
        let u95 = if speed.u95.is_finite() { speed.u95 } else { 0.0 };
        let band = [(speed.value - u95, 0.0), (speed.value + u95, count)];
        chart.draw_series([Rectangle::new(band, COLOURS[2].mix(0.22).filled())])?;
        let line = vec![(speed.value, 0.0), (speed.value, count)];
        chart.draw_series([PathElement::new(line, COLOURS[2].stroke_width(4))])?;
        let words = format!("measured {}", rounding::interval(Some(speed)));
        let style = TextStyle::from((FONT, 34).into_font().style(FontStyle::Bold))
            .color(&COLOURS[2])
            .pos(Pos::new(HPos::Center, VPos::Bottom));
        let at = chart.backend_coord(&(speed.value, count));
        root.draw(&Text::new(words, (at.0, at.1 - 12), style))?;
    }
    #[allow(clippy::cast_precision_loss, reason = "rows are few")]
    for (i, row) in rows.iter().enumerate() {
        let y = count - 0.5 - i as f64;
        let centre = chart.backend_coord(&(row.speed_m_s, y));
        let low = chart.backend_coord(&(row.speed_m_s - row.u95_m_s.unwrap_or(0.0), y)).0;
        let high = chart.backend_coord(&(row.speed_m_s + row.u95_m_s.unwrap_or(0.0), y)).0;
        paint_row(root, row, centre, (low, high))?;
    }
    root.present()
}

fn paint_row(root: &Area, row: &Row, centre: (i32, i32), ends: (i32, i32)) -> Result<(), Failure> {
    let (x, y) = centre;
    let colour = if row.own_k { COLOURS[1] } else { COLOURS[0] };
    let label = TextStyle::from((FONT, 30).into_font()).color(&INK).pos(Pos::new(HPos::Right, VPos::Center));
    root.draw(&Text::new(printable(&row.label), (LEFT.cast_signed() - 18, y), label))?;
    if row.own_k {
        if ends.1 > ends.0 {
            root.draw(&PathElement::new(vec![(ends.0, y), (ends.1, y)], colour.stroke_width(5)))?;
            for end in [ends.0, ends.1] {
                root.draw(&PathElement::new(vec![(end, y - 11), (end, y + 11)], colour.stroke_width(4)))?;
            }
        }
        root.draw(&Rectangle::new([(x - 9, y - 9), (x + 9, y + 9)], colour.filled()))?;
    } else {
        root.draw(&Circle::new((x, y), 9, colour.filled()))?;
    }
    let value = TextStyle::from((FONT, 30).into_font()).color(&INK).pos(Pos::new(HPos::Right, VPos::Center));
    let words = row.u95_m_s.map_or_else(
        || format!("{:.2}", row.speed_m_s),
        |u95| rounding::pair(row.speed_m_s, u95, "m/s").replace(" m/s", ""),
    );
    root.draw(&Text::new(words, (WIDTH.cast_signed() - 20, y), value))
}

fn speed_range(rows: &[Row], measured: Option<&Estimate>) -> std::ops::Range<f64> {
    let mut low = f64::INFINITY;
    let mut high = f64::NEG_INFINITY;
    let ends = rows.iter().map(|r| (r.speed_m_s, r.u95_m_s.unwrap_or(0.0)));
    let own = measured.map(|e| (e.value, if e.u95.is_finite() { e.u95 } else { 0.0 }));
    for (value, u95) in ends.chain(own) {
        low = low.min(value - u95);
        high = high.max(value + u95);
    }
    let span = (high - low).max(1.0);
    low - 0.08 * span..high + 0.08 * span
}
