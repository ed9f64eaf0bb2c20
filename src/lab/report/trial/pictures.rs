//! Pictures of a trial: methods by speed and accuracy, and the map of the damages.

use crate::lab::data::{Trial, TrialFate, TrialMap, TrialPoint};
use crate::lab::methods::{ALL_CLASSES, READING, WAYS};
use crate::numerics::as_f64;
use crate::report::pictures::draw::{Figure, Picture};
use crate::report::pictures::panel::{
    ALARM, COLOURS, Colour, Curve, Dash, Fill, GREY, INK, Mark, Panel, PanelAxis, PointShape, Points,
    RowWords,
};
use crate::report::rounding;
use crate::report::text::json_word;

/// Height of a panel, and of a row of the map.
const PANEL: u32 = 520;
const ROW: u32 = 25;
/// Room for the words at either side of a row.
const SIDES: (u32, u32) = (760, 620);
/// An error is drawn up to this factor above and below the smallest that matters; others lie on the edge.
const SPAN: f64 = 200.0;

/// Limits an error to the range that is drawn.
fn drawn_point(point: &TrialPoint, error: f64) -> f64 {
    error.clamp(point.matters / SPAN, point.matters * SPAN)
}

/// Short unit for an axis: "%" of "% of the slap-down speed".
fn unit(point: &TrialPoint) -> &str {
    if point.error_unit.starts_with('%') { "%" } else { "as it is" }
}

/// Look of a method by its index.
fn point_look(index: usize, at: Vec<(f64, f64)>) -> Points {
    Points::new(COLOURS[index % COLOURS.len()], PointShape::from_index(index), at)
}

/// Whole powers of ten around times.
fn decades(times: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let (least, most) = (times.clone().fold(f64::INFINITY, f64::min), times.fold(0.0, f64::max));
    (10_f64.powf(least.log10().floor()), 10_f64.powf(most.log10().ceil()))
}

/// Picture of every method over all classes, with a bar from its best class to its worst.
pub(super) fn ways_picture(trial: &Trial) -> Picture {
    let caption = "Time from file to answer, each way timed whole on the same files; below and left is \
                   better. Mark: 95th percentile of the error over all classes of drops; ring: what the \
                   program takes. Bar: from the best class to the worst.";
    let families = WAYS.map(|family| pooled(trial, family).collect::<Vec<_>>());
    let panels: Vec<Panel> = families.iter().filter_map(|ways| ways_panel(trial, ways)).collect();
    Figure { columns: 2, ..Figure::new("speed", "Speed against accuracy", caption) }.picture(&panels)
}

/// Methods of a family with any answer, over all classes.
pub(super) fn pooled<'a>(trial: &'a Trial, family: &'a str) -> impl Iterator<Item = &'a TrialPoint> {
    trial.points.iter().filter(move |p| p.family == family && p.class == ALL_CLASSES && p.cases > 0)
}

/// The point for reading the files of a family.
pub(super) fn reading<'a>(trial: &'a Trial, family: &str) -> Option<&'a TrialPoint> {
    trial.points.iter().find(|p| p.family == family && p.class == ALL_CLASSES && p.method == READING)
}

/// Lines for the accuracy that a verdict needs and that the program promises.
fn levels(ways: &[&TrialPoint], ends: (f64, f64)) -> Vec<Curve> {
    let level = |error: f64, dash, words: &str| {
        Curve { stroke: 3, ..Curve::new(GREY, vec![(ends.0, error), (ends.1, error)]) }
            .broken(dash)
            .label(words)
    };
    let half_width = ways.iter().find_map(|p| p.promised.filter(|_| p.is_default));
    let needed = ways.first().map(|p| level(p.matters, Dash::Dashed, "what a verdict needs"));
    let promised = half_width.map(|half| level(half, Dash::Dotted, "median of what is promised"));
    needed.into_iter().chain(promised).collect()
}

fn ways_panel(trial: &Trial, ways: &[&TrialPoint]) -> Option<Panel> {
    let first = *ways.first()?;
    let of_family = || trial.points.iter().filter(|p| p.family == first.family);
    let reading = reading(trial, &first.family);
    let seconds = |p: &TrialPoint| 1e-9 * p.time_ns;
    let at = |p: &TrialPoint| (seconds(p), drawn_point(p, p.p95_error));
    let ends = decades(ways.iter().copied().chain(reading).map(seconds));
    let times = PanelAxis::new("seconds").logarithmic().range(Some(ends));
    let range = (0.8 * first.matters / SPAN, 1.25 * first.matters * SPAN);
    let errors = PanelAxis::new(format!("error, 95th percentile, {}", unit(first)));
    let errors = errors.logarithmic().range(Some(range));
    let bar = |(index, way): (usize, &&TrialPoint)| {
        let classes = of_family().filter(|p| p.method == way.method && p.class != ALL_CLASSES && p.cases > 0);
        let points = classes.map(|p| (seconds(way), drawn_point(way, p.p95_error))).collect();
        Curve { opacity: 0.4, ..Curve::new(point_look(index, Vec::new()).colour, points) }
    };
    let lines = ways.iter().enumerate().map(bar);
    let mark = |(index, way): (usize, &&TrialPoint)| point_look(index, vec![at(way)]).label(&way.method[..]);
    let taken = ways.iter().filter(|p| p.is_default).map(|p| at(p)).collect();
    let ring = Points { radius: 21, ..Points::new(INK, PointShape::Ring, taken) };
    Some(Panel {
        lines: lines.chain(levels(ways, ends)).collect(),
        points: ways.iter().enumerate().map(mark).chain([ring]).collect(),
        marks: reading.map(|p| Mark { at: seconds(p), label: READING.to_owned() }).into_iter().collect(),
        ..Panel::new(&first.family, times, errors, PANEL)
    })
}

/// Colour and words for each fate of a drop.
const FATES: [(TrialFate, Colour, &str); 4] = [
    (TrialFate::Inside, Colour(196, 226, 204), "inside its interval"),
    (TrialFate::Warned, Colour(240, 190, 70), "outside, and warned of"),
    (TrialFate::Refused, Colour(150, 156, 164), "a number refused"),
    (TrialFate::Silent, ALARM, "outside, and silent"),
];

/// A row per damage, from the harmless size to the gross one; in each size a stripe per drop. Silent damages
/// come first.
pub(super) fn failures(trial: &Trial) -> Picture {
    let drops = trial.maps.first().and_then(|map| map.sizes.first()).map_or(0, |size| size.drops.len());
    let caption = format!(
        "A row a damage with its least and greatest size, from harmless at the left to gross at the right, \
         in each size {drops} stripes, a drop each: whether speed and k lie inside their intervals. At the \
         right the size from which on some drop is silent, warned of or refused; then the largest error, in \
         half-widths of the interval."
    );
    let mut maps: Vec<&TrialMap> = trial.maps.iter().collect();
    let worst = |map: &TrialMap| map.sizes.iter().flat_map(|size| &size.drops).map(|drop| drop.fate).max();
    maps.sort_by_key(|map| std::cmp::Reverse(worst(map)));
    let words = |map: &&TrialMap| RowWords {
        left: sizes_words(map),
        right: format!("{}; {}", fate_words(map).trim_end_matches(&map.unit).trim_end(), largest_words(map)),
        is_heading: false,
    };
    let mut panel = Panel::from_rows(maps.iter().map(words).collect(), ROW, SIDES);
    panel.x = PanelAxis::default().range(Some((0.0, 1.0)));
    let fill = |(fate, colour, label): (TrialFate, Colour, &str)| {
        let middles = maps.iter().enumerate().map(|(row, map)| (panel.row_middle(row), map));
        let areas = middles.flat_map(|(middle, map)| stripes(map, fate, middle)).collect();
        Fill::new(colour, 1.0, areas).label(label)
    };
    panel.fills = FATES.map(fill).into();
    Figure::new("failures", "What becomes of damages", caption).picture(&[panel])
}

/// The stripes of one fate in the row with this middle.
fn stripes(map: &TrialMap, fate: TrialFate, middle: f64) -> Vec<Vec<(f64, f64)>> {
    let width = 1.0 / as_f64(map.sizes.len());
    let of_size = |(i, size): (usize, &crate::lab::data::TrialSize)| {
        let stripe = 0.94 * width / as_f64(size.drops.len());
        let from = width * (as_f64(i) + 0.03);
        let drops = size.drops.iter().enumerate().filter(|(_, drop)| drop.fate == fate);
        let area = |(n, _)| {
            let left = from + stripe * as_f64(n);
            Fill::rectangle((left, left + stripe), (middle - 0.42, middle + 0.42))
        };
        drops.map(area).collect::<Vec<_>>()
    };
    map.sizes.iter().enumerate().flat_map(of_size).collect()
}

/// Says from which size on some drops have each fate, the worst first.
pub(super) fn fate_words(map: &TrialMap) -> String {
    let from = |fate| {
        let word = if fate == TrialFate::Silent { "unnoticed".to_owned() } else { json_word(fate) };
        let size = rounding::plain(map.first(fate)?.size, 2);
        Some(if map.unit.is_empty() { word } else { format!("{word} from {size}") })
    };
    let gravest_first = [TrialFate::Silent, TrialFate::Warned, TrialFate::Refused];
    let words: Vec<String> = gravest_first.into_iter().filter_map(from).collect();
    if words.is_empty() { "inside".to_owned() } else { format!("{} {}", words.join(", "), map.unit) }
}

/// The largest error, in half-widths.
pub(super) fn largest_words(map: &TrialMap) -> String {
    let off = map.sizes.iter().flat_map(|size| &size.drops).filter_map(|drop| drop.half_widths_off);
    match off.reduce(f64::max) {
        Some(off) if off > 99.0 => "> 99".to_owned(),
        off => rounding::optional_fixed(off, 1),
    }
}

/// The damage with its sizes: "hum, 0.1 to 1000 g".
fn sizes_words(map: &TrialMap) -> String {
    let [first, last] = [map.sizes.first(), map.sizes.last()].map(|size| size.map_or(0.0, |size| size.size));
    if map.unit.is_empty() {
        return map.name.clone();
    }
    format!("{}, {} to {} {}", map.name, rounding::plain(first, 4), rounding::plain(last, 4), map.unit)
}
