//! The regimes over angle and k to one picture: a map a contact law, with k = 0 as a strip of its own.

use super::super::ReportError;
use super::super::words::contact_words;
use super::draw::{Picture, Plate};
use super::look::{MOST_CONTACTS, angle_axis, angle_panel, body_words};
use super::panel::{Fill, Panel, PanelAxis, RowWords};
use crate::data::{Regime, RegimeMap, Study};
use plotters::style::RGBColor;
use std::ops::Range;

const TITLE: &str = "Where the closed forms end";
/// Heights of a map and of its strip for k = 0.
const MAP: u32 = 420;
const STRIP: u32 = 44;

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
    let left_out =
        if maps.len() < study.maps.len() { " Not every contact law asked for is drawn." } else { "" };
    let caption = format!(
        "Over the drop angle and k: where one flight without another contact leads to the slap-down, so that the paper's closed forms \
         hold; where the first end strikes again before; and where the second end never strikes. The strip below is k = 0: there the \
         first end stays on the target where the contact would push, and lifts off where it would have to pull.{left_out}"
    );
    let nothing = ("There is nothing to show: no map was made.", "No map was made.");
    let mut panels: Vec<Panel> = maps.iter().flat_map(|map| panels(study, map)).collect();
    if !panels.is_empty() {
        panels.insert(0, legend());
    }
    let mut picture = Plate::new(name, TITLE, caption).or(nothing).picture(&panels)?;
    if !maps.is_empty() {
        picture.alt = format!("{} {}", picture.alt, spoken(&maps));
    }
    Ok(picture)
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

/// The map of a contact law over its strip for k = 0: lift-off exists there only.
fn panels(study: &Study, map: &RegimeMap) -> [Panel; 2] {
    let title =
        format!("{}, {}", body_words(map.model, &study.cask_file.cask, true), contact_words(map.contact));
    let angles = edges(&map.angle_deg);
    let first = usize::from(map.k[0] <= 0.0);
    let ks = edges(&map.k[first..]);
    let ends = |edges: &[f64]| edges.first().copied().zip(edges.last().copied());
    let upper = Panel {
        title,
        x: PanelAxis::default().over(ends(&angles)),
        y: PanelAxis::new("k").over(ends(&ks)),
        height: MAP,
        fills: fills(&map.regimes[first..], (&angles, &ks)),
        ..angle_panel(&study.request, String::new(), "")
    };
    let strip = RowWords { left: "k = 0".into(), ..RowWords::default() };
    let lower = Panel {
        x: angle_axis(&study.request).over(ends(&angles)),
        y: PanelAxis::rows(vec![strip]),
        height: STRIP,
        fills: fills(&map.regimes[..first], (&angles, &[0.0, 1.0])),
        ..Panel::default()
    };
    [upper, lower]
}

/// A fill a regime over the cells between these borders.
fn fills(regimes: &[Vec<Regime>], (x, y): (&[f64], &[f64])) -> Vec<Fill> {
    let runs = runs(regimes);
    // A little over the neighbour below: no hairline is left between them when the picture is scaled.
    let over = y.first().zip(y.last()).map_or(0.0, |(from, to)| (to - from) / f64::from(MAP));
    let area = |run: &RegimeRun| {
        let low = if run.rows.start > 0 { y[run.rows.start] - over } else { y[0] };
        Fill::rectangle((x[run.columns.start], x[run.columns.end]), (low, y[run.rows.end]))
    };
    let fill = |regime| {
        let areas = runs.iter().filter(|run| run.regime == regime).map(area).collect();
        Fill { label: None, colour: colour(regime), opacity: 1.0, areas }
    };
    Regime::ALL.map(fill).into()
}

/// What each colour stands for.
fn legend() -> Panel {
    let fill = |regime| Fill {
        label: Some(words(regime).to_owned()),
        colour: colour(regime),
        opacity: 1.0,
        areas: Vec::new(),
    };
    Panel { fills: Regime::ALL.map(fill).into(), ..Panel::default() }
}

/// The borders of cells around `centres`: half way between them, the outer ones on the outer centres.
fn edges(centres: &[f64]) -> Vec<f64> {
    let inner = centres.windows(2).map(|w| f64::midpoint(w[0], w[1]));
    centres.first().copied().into_iter().chain(inner).chain(centres.last().copied()).collect()
}

/// Cells of one regime in a rectangle.
#[derive(Debug, PartialEq)]
struct RegimeRun {
    regime: Regime,
    columns: Range<usize>,
    rows: Range<usize>,
}

/// Equal neighbours in a row as one, and equal ones in rows above each other again as one: some hundred rectangles instead of
/// eighteen thousand cells.
fn runs(regimes: &[Vec<Regime>]) -> Vec<RegimeRun> {
    let mut done: Vec<RegimeRun> = Vec::new();
    let mut open: Vec<RegimeRun> = Vec::new();
    for (i, row) in regimes.iter().enumerate() {
        let mut grown = Vec::new();
        let mut from = 0;
        for cells in row.chunk_by(|a, b| a == b) {
            let columns = from..from + cells.len();
            from = columns.end;
            let same = |run: &RegimeRun| run.regime == cells[0] && run.columns == columns;
            let start = open.iter().position(same).map_or(i, |at| open.swap_remove(at).rows.start);
            grown.push(RegimeRun { regime: cells[0], columns, rows: start..i + 1 });
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
