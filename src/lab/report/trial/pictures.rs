//! A trial to one picture of speed against accuracy, and one map of where the program fails.

use super::failing;
use crate::lab::data::{Trial, TrialMap, TrialPoint, TrialSize};
use crate::numerics::as_f64;
use crate::report::pictures::draw::{Picture, Plate};
use crate::report::pictures::panel::{
    ALARM, COLOURS, Colour, Fill, INK, Panel, PanelAxis, PointShape, Points, RowWords,
};
use crate::report::rounding;

/// Height of a family's panel, and of a row of the map.
const PANEL: u32 = 410;
const ROW: u32 = 34;
/// Room for the words at either side of a row.
const SIDES: (u32, u32) = (330, 560);
/// Errors are drawn within these: a rounding of the peak, and a method that diverged.
const ERRORS: (f64, f64) = (1e-17, 1e3);

/// A panel a family: each method on each class.
pub(super) fn speed(trial: &Trial) -> Picture {
    let caption = "Median error over the median time of a sample or a call, each method on each class of scenes. Below and left is better. Ring: \
                   what the program takes."
        .to_owned();
    let families = trial.points.chunk_by(|a, b| a.family == b.family);
    let panels: Vec<Panel> = families.map(family_panel).collect();
    let nothing = ("There is nothing to show: no method was tried.", "No method was tried.");
    Plate { columns: 2, ..Plate::new("speed", "Speed against accuracy", caption).or(nothing) }
        .picture(&panels)
}

fn family_panel(points: &[TrialPoint]) -> Panel {
    let at = |p: &TrialPoint| (p.time_ns.max(f64::MIN_POSITIVE), p.median_error.clamp(ERRORS.0, ERRORS.1));
    let mut drawn: Vec<Points> = Vec::new();
    for point in points {
        let index = drawn.iter().position(|of| of.label.as_ref() == Some(&point.method));
        let index = index.unwrap_or_else(|| {
            let i = drawn.len();
            let look = Points::new(COLOURS[i % COLOURS.len()], PointShape::of(i), Vec::new());
            drawn.push(look.named(&point.method[..]));
            i
        });
        drawn[index].at.push(at(point));
    }
    let taken = points.iter().filter(|p| p.is_default).map(at).collect();
    drawn.push(Points { radius: 21, ..Points::new(INK, PointShape::Ring, taken) });
    let TrialPoint { family, time_per, error_unit, .. } = &points[0];
    Panel {
        title: family.clone(),
        x: PanelAxis::new(format!("ns a {time_per}")).logarithmic(),
        y: PanelAxis::new(format!("error, {error_unit}")).logarithmic(),
        height: PANEL,
        points: drawn,
        ..Panel::default()
    }
}

/// What becomes of the drops of one size: colour and words.
const FATES: [(Colour, &str); 3] = [
    (Colour(226, 238, 247), "every drop within the limit"),
    (Colour(60, 132, 190), "beyond it or without a number, and the program says so"),
    (ALARM, "beyond it, and the program says nothing"),
];

/// Which of [`FATES`].
fn fate(map: &TrialMap, at: &TrialSize) -> usize {
    match at.worst_error {
        Some(error) if error <= map.limit => 0,
        _ if at.is_noticed => 1,
        _ => 2,
    }
}

/// A row a damage, from the harmless size to the gross one.
pub(super) fn failures(trial: &Trial) -> Picture {
    let caption =
        "A row a damage or a drop that is hard to tell, its size from harmless at the left to gross at the right; at the right of it the size \
         from which on a drop is off by more than the limit or gives no number."
            .to_owned();
    let words = |map: &TrialMap| RowWords {
        left: map.name.clone(),
        right: failing(map).next().map_or_else(|| "holds".to_owned(), |at| from_words(map, at)),
        is_heading: false,
    };
    let count = trial.maps.len();
    let fill = |which: usize| {
        let cells = |(row, map): (usize, &TrialMap)| -> Vec<Vec<(f64, f64)>> {
            let top = as_f64(count - row);
            let width = 1.0 / as_f64(map.sizes.len().max(1));
            let of_fate = map.sizes.iter().enumerate().filter(|(_, at)| fate(map, at) == which);
            let cell = |(i, _): (usize, &TrialSize)| {
                Fill::rectangle((width * as_f64(i), width * as_f64(i + 1)), (top - 0.9, top - 0.1))
            };
            of_fate.map(cell).collect()
        };
        let (colour, label) = FATES[which];
        let areas = trial.maps.iter().enumerate().flat_map(cells).collect();
        Fill { label: Some(label.to_owned()), colour, opacity: 1.0, areas }
    };
    let panel = Panel {
        x: PanelAxis::default().over(Some((0.0, 1.0))),
        y: PanelAxis::rows(trial.maps.iter().map(words).collect()),
        height: ROW * u32::try_from(count).unwrap_or(0),
        sides: Some(SIDES),
        fills: [0, 1, 2].map(fill).into(),
        ..Panel::default()
    };
    let nothing = ("There is nothing to show: no damage was tried.", "No damage was tried.");
    let panels: &[Panel] = if count == 0 { &[] } else { &[panel] };
    Plate::new("failures", "Where the program fails", caption).or(nothing).picture(panels)
}

/// A size in its unit.
pub(super) fn from_words(map: &TrialMap, at: &TrialSize) -> String {
    format!("{} {}", rounding::plain(at.size, 2), map.unit)
}
