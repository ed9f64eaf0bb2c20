//! The regimes over angle and k to one picture: a map a contact law, with k = 0 as a strip of its own.

use super::super::words::contact_words;
use super::draw::{Picture, Plate};
use super::look::{MOST_CONTACTS, angle_axis, angle_panel, body_words, edges};
use super::panel::{Colour, Fill, Panel, PanelAxis, RowWords};
use crate::data::{Regime, RegimeMap, Study};

const TITLE: &str = "Where the closed forms end";
/// Heights of a map and of its strip for k = 0.
const MAP: u32 = 420;
const STRIP: u32 = 44;

/// The colour of a regime; from light to dark, so that they are told apart without colour too.
fn colour(regime: Regime) -> Colour {
    match regime {
        Regime::ClosedForm => Colour(226, 238, 247),
        Regime::LiftOff => Colour(240, 178, 60),
        Regime::FurtherImpacts => Colour(60, 132, 190),
        Regime::NoSlapDown => Colour(60, 60, 66),
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
pub(super) fn picture(study: &Study, name: &str) -> Picture {
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
    let panels: Vec<Panel> = maps.iter().flat_map(|map| panels(study, map)).collect();
    let picture = Plate::new(name, TITLE, caption.clone()).or(nothing).picture(&panels);
    if maps.is_empty() {
        picture
    } else {
        Picture { alt: format!("{TITLE}. {caption} {}", spoken(&maps)), ..picture }
    }
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
    let named = |(fill, regime): (Fill, Regime)| fill.named(words(regime));
    let fills = |rows, ks: &[f64]| self::fills(rows, &angles, ks);
    let upper = Panel {
        title,
        x: PanelAxis::default().over(ends(&angles)),
        y: PanelAxis::new("k").over(ends(&ks)),
        height: MAP,
        fills: fills(&map.regimes[first..], &ks).into_iter().zip(Regime::ALL).map(named).collect(),
        ..angle_panel(&study.request, String::new(), "")
    };
    let strip = RowWords { left: "k = 0".into(), ..RowWords::default() };
    let lower = Panel {
        x: angle_axis(&study.request).over(ends(&angles)),
        y: PanelAxis::rows(vec![strip]),
        height: STRIP,
        fills: fills(&map.regimes[..first], &[0.0, 1.0]),
        ..Panel::default()
    };
    [upper, lower]
}

/// A fill a regime over the cells between these borders, equal neighbours in a row as one.
fn fills(regimes: &[Vec<Regime>], x: &[f64], y: &[f64]) -> Vec<Fill> {
    // A little over the neighbour below: no hairline is left between them when the picture is scaled.
    let over = y.first().zip(y.last()).map_or(0.0, |(from, to)| (to - from) / f64::from(MAP));
    let fill = |regime| {
        let mut areas = Vec::new();
        for (i, row) in regimes.iter().enumerate() {
            let low = if i > 0 { y[i] - over } else { y[0] };
            let mut from = 0;
            for cells in row.chunk_by(|a, b| a == b) {
                let to = from + cells.len();
                if cells[0] == regime {
                    areas.push(Fill::rectangle((x[from], x[to]), (low, y[i + 1])));
                }
                from = to;
            }
        }
        Fill::new(colour(regime), 1.0, areas)
    };
    Regime::ALL.map(fill).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use Regime::{ClosedForm as C, FurtherImpacts as F, NoSlapDown as N};

    #[test]
    fn fills_cover_every_cell_once() {
        let map = [vec![C, C, F, F, N], vec![C, F, F, F, N]];
        let borders: Vec<f64> = (0..6).map(f64::from).collect();
        let fills = fills(&map, &borders, &borders[..3]);
        let area =
            |corners: &Vec<(f64, f64)>| (corners[2].0 - corners[0].0) * (corners[1].1 - corners[0].1).round();
        let of = |fill: &Fill| fill.areas.iter().map(area).sum::<f64>();
        let areas: Vec<f64> = fills.iter().map(of).collect();
        assert_eq!(areas, [3.0, 0.0, 5.0, 2.0]);
    }
}
