//! A failure map to its chart: error over stress, the limit drawn, and whether the program noticed.

use super::breaks;
use crate::lab::data::{TrialLine, TrialMap};
use crate::report::pictures::draw::{Picture, Plate};
use crate::report::pictures::panel::{ALARM, COLOURS, Curve, Dash, Panel, PanelAxis, PointShape, Points};
use crate::report::rounding;

/// Height of a panel of many lines, and of one of three at most.
const PANEL: u32 = 480;
const PANEL_OF_FEW: u32 = 320;
/// Decades that are drawn below the limit and above it.
const BELOW: i32 = 14;
const ABOVE: i32 = 3;

/// The name of the chart's file, without ".svg".
pub(super) fn file_name(map: &TrialMap) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    format!("map-{}", map.name.chars().map(plain).collect::<String>())
}

/// The chart.
pub(super) fn picture(map: &TrialMap) -> Picture {
    let broken: Vec<String> = map
        .lines
        .iter()
        .filter_map(|line| {
            let at = breaks::of(map, line).at?;
            Some(format!("{} at {}", line.method, rounding::plain(at, 2)))
        })
        .collect();
    let found = if broken.is_empty() {
        "None passes the limit.".to_owned()
    } else {
        format!("Passes the limit: {}.", broken.join("; "))
    };
    let tells = map.lines.iter().any(|line| line.noticed.iter().any(Option::is_some));
    let marks = if tells {
        " Large marks: the program said that something is wrong, or its interval holds the truth; small dots: it did not, or has no way to; \
         red crosses: beyond the limit and not said."
    } else {
        " No method of this map has a way to say that something is wrong."
    };
    let nothing = ("There is nothing to show: no stress was tried.", "No stress was tried.");
    let plate = Plate::new(&file_name(map), &map.title[..], format!("{found}{marks}"));
    plate.or(nothing).picture(&[panel(map)])
}

/// The error axis: what is given, within some decades of the limit.
fn error_range(map: &TrialMap) -> (f64, f64) {
    let given = map.lines.iter().flat_map(|line| line.errors.iter().flatten());
    let (low, high) = given
        .filter(|e| e.is_finite() && **e > 0.0)
        .fold((map.limit, map.limit), |(low, high), e| (low.min(*e), high.max(*e)));
    let limit = map.limit.max(f64::MIN_POSITIVE);
    let low = low.max(limit * 10_f64.powi(-BELOW)).log10().floor();
    let high = (1.5 * high).min(limit * 10_f64.powi(ABOVE)).log10().ceil();
    (10_f64.powf(low), 10_f64.powf(high.max(low + 1.0)))
}

/// The stresses with some air around them; none where none was tried.
fn stress_range(map: &TrialMap) -> Option<(f64, f64)> {
    let finite = map.stresses.iter().copied().filter(|s| s.is_finite() && (!map.is_log || *s > 0.0));
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)));
    if low > high {
        return None;
    }
    let (low, high) = if low < high { (low, high) } else { (0.9 * low - 0.1, 1.1 * high + 0.1) };
    let (factor, air) = ((high / low).powf(0.02), 0.02 * (high - low));
    Some(if map.is_log { (low / factor, high * factor) } else { (low - air, high + air) })
}

fn panel(map: &TrialMap) -> Panel {
    let x = PanelAxis::new(&map.stress[..]).over(stress_range(map));
    let mut panel = Panel {
        title: map.title.clone(),
        y: PanelAxis::new(&map.error[..]).logarithmic().over(Some(error_range(map))),
        height: if map.lines.len() > 3 { PANEL } else { PANEL_OF_FEW },
        ..Panel::default()
    };
    let Some((from, to)) = x.range else { return panel };
    panel.x = if map.is_log { x.logarithmic() } else { x };
    for (i, line) in map.lines.iter().enumerate() {
        add_line(&mut panel, map, line, i);
    }
    let limit = Curve { stroke: 3, ..Curve::new(ALARM, vec![(from, map.limit), (to, map.limit)]) };
    panel.lines.push(limit.broken(Dash::Dashed).named(format!("limit {}", rounding::plain(map.limit, 3))));
    panel
}

/// A line open where no number was given, its points in three looks by what the program said.
fn add_line(panel: &mut Panel, map: &TrialMap, line: &TrialLine, index: usize) {
    let colour = COLOURS[index % COLOURS.len()];
    let (low, high) = error_range(map);
    let place =
        |error: Option<f64>| error.map_or(f64::NAN, |e| if e.is_nan() { high } else { e.clamp(low, high) });
    let points: Vec<(f64, f64)> =
        map.stresses.iter().zip(&line.errors).map(|(stress, error)| (*stress, place(*error))).collect();
    let [mut said, mut unsaid, mut silent] = [(); 3].map(|()| Vec::new());
    let noticed = line.noticed.iter().copied().chain(std::iter::repeat(None));
    for ((at, error), noticed) in points.iter().zip(&line.errors).zip(noticed) {
        let is_beyond = error.is_some_and(|e| e.is_nan() || e > map.limit);
        match noticed {
            Some(true) => said.push(*at),
            Some(false) if is_beyond => unsaid.push(*at),
            _ => silent.push(*at),
        }
    }
    panel.lines.push(Curve::new(colour, points));
    panel.points.push(Points::new(colour, PointShape::of(index), said).named(&line.method[..]));
    panel.points.push(Points { radius: 6, ..Points::new(colour, PointShape::Dot, silent) });
    panel.points.push(Points { radius: 11, ..Points::new(ALARM, PointShape::Cross, unsaid) });
}
