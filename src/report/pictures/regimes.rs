//! The regimes over angle and k to one picture: a map a contact law, with k = 0 as a strip of its own.

use super::super::ReportError;
use super::super::prediction::contact_words;
use super::super::rounding::plain;
use super::look::{MOST_CONTACTS, body_words};
use super::panel::{self, Area, BOTTOM, FONT, INK, LEFT, RIGHT, WIDTH};
use super::{Picture, assemble_or};
use crate::data::{Regime, RegimeMap, Study};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

const TITLE: &str = "Where the closed forms end";
const HEAD: i32 = 62;
const MAP: u32 = 420;
/// Height of the strip for k = 0, and of the air above it.
const STRIP: u32 = 44;
const AIR: u32 = 16;
const LEGEND: u32 = 66;
const GAP: u32 = 22;
const TOTAL: u32 = HEAD.cast_unsigned() + MAP + AIR + STRIP + BOTTOM + GAP;

type Failure = DrawingAreaErrorKind<std::io::Error>;

/// The colour of a regime; from light to dark, so that they are told apart without colour too.
fn colour(regime: Regime) -> RGBColor {
    match regime {
        Regime::ClosedForm => RGBColor(226, 238, 247),
        Regime::LiftOff => RGBColor(240, 178, 60),
        Regime::FurtherImpacts => RGBColor(60, 132, 190),
        Regime::NoSlapDown => RGBColor(60, 60, 66),
    }
}

fn words(regime: Regime) -> &'static str {
    match regime {
        Regime::ClosedForm => "closed form holds",
        Regime::LiftOff => "lifts off (k = 0)",
        Regime::FurtherImpacts => "first end strikes again",
        Regime::NoSlapDown => "no slap-down",
    }
}

/// The picture.
pub(super) fn picture(study: &Study, name: &str) -> Result<Picture, ReportError> {
    let drawable = |map: &&RegimeMap| map.angle_deg.len() > 1 && map.k.len() > 1;
    let maps: Vec<&RegimeMap> = study.maps.iter().filter(drawable).take(MOST_CONTACTS).collect();
    if maps.is_empty() {
        let nothing = ("There is nothing to show: no map was made.", "No map was made.");
        return assemble_or(name, TITLE, String::new(), &[], nothing);
    }
    let failed = |reason| ReportError::Picture { picture: name.to_owned(), reason };
    let svg = draw(study, &maps).map_err(failed)?;
    let left_out =
        if maps.len() < study.maps.len() { " Not every contact law asked for is drawn." } else { "" };
    let caption = format!(
        "Over the drop angle and k: where one flight without another contact leads to the slap-down, so that the paper's closed forms \
         hold; where the first end strikes again before; and where the second end never strikes. The strip below is k = 0: there the \
         first end stays on the target where the contact would push, and lifts off where it would have to pull.{left_out}"
    );
    let alt = format!("{TITLE}. {caption} {}", spoken(&maps));
    let svg = panel::described(&svg, TITLE);
    Ok(Picture { name: name.to_owned(), title: TITLE.to_owned(), alt, caption, svg })
}

/// The share of each regime on each map.
fn spoken(maps: &[&RegimeMap]) -> String {
    let one = |map: &&RegimeMap| {
        let cells = map.regimes.iter().flatten().count().max(1);
        let shares: Vec<String> = Regime::ALL
            .into_iter()
            .map(|regime| {
                let count = map.regimes.iter().flatten().filter(|r| **r == regime).count();
                format!("{} {} %", words(regime), (200 * count + cells) / (2 * cells))
            })
            .collect();
        format!("{}: {}.", contact_words(map.contact), shares.join(", "))
    };
    maps.iter().map(one).collect::<Vec<_>>().join(" ")
}

fn draw(study: &Study, maps: &[&RegimeMap]) -> Result<String, String> {
    let height = LEGEND + TOTAL * u32::try_from(maps.len()).map_err(|e| e.to_string())?;
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        let failed = |e: Failure| e.to_string();
        root.fill(&WHITE).map_err(failed)?;
        let (head, mut rest) = root.split_vertically(LEGEND);
        legend(&head).map_err(failed)?;
        for map in maps {
            let (area, below) = rest.split_vertically(TOTAL);
            rest = below;
            one(&area, study, map).map_err(failed)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(panel::sized(&svg, height))
}

fn legend(area: &Area) -> Result<(), Failure> {
    let mut left = LEFT.cast_signed();
    let style = TextStyle::from((FONT, 31).into_font()).color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
    for regime in Regime::ALL {
        let corners = [(left, 18), (left + 44, 48)];
        area.draw(&Rectangle::new(corners, colour(regime).filled()))?;
        area.draw(&Rectangle::new(corners, INK.mix(0.6)))?;
        area.draw(&Text::new(words(regime), (left + 56, 34), style.clone()))?;
        // A letter is about 15.5 units wide.
        left += 56 + 16 * i32::try_from(words(regime).chars().count()).unwrap_or(0) + 40;
    }
    Ok(())
}

fn one(area: &Area, study: &Study, map: &RegimeMap) -> Result<(), Failure> {
    let title =
        format!("{}, {}", body_words(map.model, &study.cask_file.cask, true), contact_words(map.contact));
    let style = TextStyle::from((FONT, 36).into_font().style(FontStyle::Bold)).color(&INK);
    area.draw(&Text::new(title, (LEFT.cast_signed(), 14), style))?;
    let x_edges = edges(&map.angle_deg);
    let x = x_edges[0]..x_edges[x_edges.len() - 1];
    // k = 0 is a strip of its own: lift-off exists there only.
    let first = usize::from(map.k[0] <= 0.0);
    let k_edges = edges(&map.k[first..]);
    let (upper, lower) = area.split_vertically(HEAD.cast_unsigned() + MAP + AIR);
    if let (Some(from), Some(to)) = (k_edges.first(), k_edges.last()) {
        let mut chart = ChartBuilder::on(&upper)
            .margin_top(HEAD)
            .margin_right(RIGHT)
            .margin_bottom(AIR)
            .y_label_area_size(LEFT)
            .build_cartesian_2d(x.clone(), *from..*to)?;
        cells(&upper, &chart, &runs(&map.regimes[first..]), (&x_edges, &k_edges))?;
        mesh(&mut chart, "k", 6, study.request.angle_deg)?;
    }
    let mut chart = ChartBuilder::on(&lower)
        .margin_right(RIGHT)
        .margin_bottom(GAP)
        .x_label_area_size(BOTTOM)
        .y_label_area_size(LEFT)
        .build_cartesian_2d(x, 0.0..1.0)?;
    cells(&lower, &chart, &runs(&map.regimes[..first]), (&x_edges, &[0.0, 1.0]))?;
    mesh(&mut chart, "", 0, study.request.angle_deg)?;
    let at = chart.backend_coord(&(x_edges[0], 0.5));
    let base = area.get_base_pixel();
    let style = TextStyle::from((FONT, 30).into_font()).color(&INK).pos(Pos::new(HPos::Right, VPos::Center));
    area.draw(&Text::new("k = 0", (at.0 - base.0 - 14, at.1 - base.1), style))
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Axes over the cells, and the angle asked for.
fn mesh(chart: &mut Chart, y_label: &str, y_labels: usize, asked_deg: f64) -> Result<(), Failure> {
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc(if y_label.is_empty() { "drop angle, °" } else { "" })
        .y_desc(y_label)
        .axis_desc_style((FONT, 32, &INK))
        .label_style((FONT, 30, &INK))
        .axis_style(INK.mix(0.5))
        .x_labels(12)
        .y_labels(y_labels)
        .x_label_formatter(&|x| plain(*x, 4))
        .y_label_formatter(&|y| plain(*y, 3))
        .draw()?;
    let y = chart.y_range();
    if chart.x_range().contains(&asked_deg) {
        let line = vec![(asked_deg, y.start), (asked_deg, y.end)];
        chart.draw_series([PathElement::new(line.clone(), WHITE.mix(0.8).stroke_width(5))])?;
        chart.draw_series(DashedLineSeries::new(line, 10, 8, INK.stroke_width(2)))?;
    }
    Ok(())
}

fn cells(area: &Area, chart: &Chart, runs: &[Run], (x, y): (&[f64], &[f64])) -> Result<(), Failure> {
    let base = area.get_base_pixel();
    let pixel = |column: usize, row: usize| {
        let at = chart.backend_coord(&(x[column], y[row]));
        (at.0 - base.0, at.1 - base.1)
    };
    for run in runs {
        let low = pixel(run.columns.start, run.rows.start);
        let high = pixel(run.columns.end, run.rows.end);
        // One unit over the neighbour: no hairline is left between them when the picture is scaled.
        let over = i32::from(run.rows.start > 0);
        let corners = [(low.0, high.1), (high.0, low.1 + over)];
        area.draw(&Rectangle::new(corners, colour(run.regime).filled()))?;
    }
    Ok(())
}

/// The borders of cells around `centres`: half way between them, the outer ones on the outer centres.
fn edges(centres: &[f64]) -> Vec<f64> {
    let inner = centres.windows(2).map(|w| f64::midpoint(w[0], w[1]));
    centres.first().copied().into_iter().chain(inner).chain(centres.last().copied()).collect()
}

/// Cells of one regime in a rectangle.
#[derive(Debug, PartialEq)]
struct Run {
    regime: Regime,
    columns: Range<usize>,
    rows: Range<usize>,
}

/// Equal neighbours in a row as one, and equal ones in rows above each other again as one: some hundred rectangles instead of
/// eighteen thousand cells.
fn runs(regimes: &[Vec<Regime>]) -> Vec<Run> {
    let mut done: Vec<Run> = Vec::new();
    let mut open: Vec<Run> = Vec::new();
    for (i, row) in regimes.iter().enumerate() {
        let mut grown = Vec::new();
        let mut from = 0;
        for cells in row.chunk_by(|a, b| a == b) {
            let columns = from..from + cells.len();
            from = columns.end;
            let same = |run: &Run| run.regime == cells[0] && run.columns == columns;
            let start = open.iter().position(same).map_or(i, |at| open.swap_remove(at).rows.start);
            grown.push(Run { regime: cells[0], columns, rows: start..i + 1 });
        }
        done.append(&mut open);
        open = grown;
    }
    done.append(&mut open);
    done
}

#[cfg(test)]
mod tests {
    use super::*;
    use Regime::{ClosedForm as C, FurtherImpacts as F, NoSlapDown as N};

    #[test]
    fn runs_cover_every_cell_once() {
        let map = vec![vec![C, C, F, F, N], vec![C, C, F, F, N], vec![C, F, F, F, N], vec![C, C, F, F, N]];
        let runs = runs(&map);
        // Columns 4 in one piece; F twice, the middle row apart; likewise C.
        assert_eq!(runs.len(), 7);
        let mut seen = vec![vec![None; 5]; 4];
        for run in &runs {
            for i in run.rows.clone() {
                for j in run.columns.clone() {
                    assert_eq!(seen[i][j].replace(run.regime), None);
                }
            }
        }
        let seen: Vec<Vec<Regime>> =
            seen.into_iter().map(|row| row.into_iter().flatten().collect()).collect();
        assert_eq!(seen, map);
    }

    #[test]
    fn borders_lie_between_the_cells() {
        assert_eq!(edges(&[0.0, 1.0, 3.0]), [0.0, 0.5, 2.0, 3.0]);
    }
}
