//! Numbers of panels for the script of a page, which draws them again for zooming and copying; a long curve
//! is reduced to the lowest and highest point of each column, broken where samples are missing.

use super::panel::{Curve, Panel};
use crate::numerics::{as_count, as_f64, to_f32};
use crate::report::text::sanitize;
use base64::prelude::{BASE64_STANDARD as STANDARD, Engine};
use serde_json::{Value, json};

/// Most values of a picture that has every sample, in single precision as in the files of curves, and of one
/// that is thinned: a page of two channels stays below 750 kB at any rate.
pub(super) const MOST_VALUES: usize = 25_000;
const THINNED_VALUES: usize = 12_000;

/// Remark beside a picture that shows every sample.
pub(super) const EVERY_SAMPLE: &str = "Drag to zoom: every sample is here.";

/// Panels with lines on linear axes, as JSON, with the lines of the picture `of` if it has a name; empty if
/// there are none. `thinned` says which samples were omitted before, if any were.
pub(super) fn numbers(panels: &[&Panel], of: &str, thinned: Option<&str>) -> String {
    let drawn = || panels.iter().filter(|panel| !panel.lines.is_empty());
    let count: usize = drawn().flat_map(|panel| &panel.lines).map(|line| line.points.len()).sum();
    if count == 0 {
        return String::new();
    }
    // The lowest and the highest of each group of samples are drawn; for a group of one that is every sample.
    let is_whole = thinned.is_some() || count <= MOST_VALUES;
    let each = if is_whole { 1 } else { (2 * count).div_ceil(THINNED_VALUES) };
    let note = match thinned {
        Some(left_out) => left_out.to_owned(),
        None if is_whole => EVERY_SAMPLE.to_owned(),
        None => format!(
            "Drawn and copied: the lowest and the highest of each {each} samples; curves.csv has all."
        ),
    };
    let all: Vec<Value> = drawn().map(|panel| panel_json(panel, each, of)).collect();
    json!({"note": note, "of": of, "panels": all}).to_string().replace('<', "\\u003c")
}

fn panel_json(panel: &Panel, each: usize, of: &str) -> Value {
    let own = panel.lines.iter().filter(|_| of.is_empty());
    let lines: Vec<Value> = own.map(|line| line_json(line, each)).collect();
    let marks: Vec<Value> = panel.marks.iter().map(|mark| json!([mark.at, mark.label])).collect();
    let range = panel.x_range();
    json!({
        "title": panel.title, "x": panel.x.label, "y": panel.y.label, "height": panel.height, "lines": lines,
        "marks": marks, "from": range.start, "to": range.end
    })
}

/// Values, with NaN between runs, where samples are missing; positions, in steps of `dx` from `x0` on, as the
/// numbers of samples between them, if these are not all one.
fn line_json(line: &Curve, each: usize) -> Value {
    let ends = line.points.first().zip(line.points.last());
    let (x0, last) = ends.map_or((0.0, 0.0), |(first, last)| (first.0, last.0));
    let dx = line.step.unwrap_or((last - x0) / as_f64(line.points.len().max(2) - 1));
    let place = |i: usize, x: f64| line.step.map_or(i, |step| as_count(((x - x0) / step).round()));
    let places = line.points.iter().enumerate().map(|(i, p)| (place(i, p.0), p.1));
    let (mut steps, mut bytes, mut at) = (Vec::new(), Vec::new(), 0);
    for (place, value) in thin(places, each) {
        steps.push(place - at);
        bytes.extend_from_slice(&to_f32(value).to_le_bytes());
        at = place;
    }
    let is_even = steps.iter().enumerate().all(|(i, step)| *step == usize::from(i > 0));
    json!({
        "label": line.label.as_deref().map(sanitize), "color": line.colour.to_string(),
        "opacity": line.opacity, "dash": line.dash.pieces(), "stroke": line.stroke,
        "x0": x0, "dx": dx, "steps": (!is_even).then_some(steps), "y": STANDARD.encode(bytes)
    })
}

/// Unbroken runs of points, at most two in each unit of x, in order.
pub(super) fn runs(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<PixelColumn>> = vec![Vec::new()];
    for (x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            runs.push(Vec::new());
        } else if let Some(run) = runs.last_mut() {
            match run.last_mut().filter(|column| column.index.total_cmp(&x.floor()).is_eq()) {
                Some(column) => column.include((x, y)),
                None => run.push(PixelColumn { index: x.floor(), low: (x, y), high: (x, y) }),
            }
        }
    }
    runs.retain(|run| !run.is_empty());
    runs.into_iter().map(|run| run.into_iter().flat_map(PixelColumn::points).collect()).collect()
}

/// Keeps the lowest and the highest of values in each `each` numbered places, and NaN between runs, if values
/// are missing.
pub(super) fn thin(values: impl IntoIterator<Item = (usize, f64)>, each: usize) -> Vec<(usize, f64)> {
    let mut kept = Vec::new();
    let places = values.into_iter().map(|(place, value)| (as_f64(place) / as_f64(each), value));
    for (i, run) in runs(places).into_iter().enumerate() {
        let place = |x: f64| as_count((x * as_f64(each)).round());
        kept.extend(run.first().filter(|_| i > 0).map(|(begins, _)| (place(*begins) - 1, f64::NAN)));
        kept.extend(run.into_iter().map(|(x, value)| (place(x), value)));
    }
    kept
}

/// Points in one unit of x.
struct PixelColumn {
    index: f64,
    low: (f64, f64),
    high: (f64, f64),
}

impl PixelColumn {
    fn include(&mut self, at: (f64, f64)) {
        if at.1 < self.low.1 {
            self.low = at;
        }
        if at.1 > self.high.1 {
            self.high = at;
        }
    }

    fn points(self) -> Vec<(f64, f64)> {
        let (first, second) =
            if self.low.0 <= self.high.0 { (self.low, self.high) } else { (self.high, self.low) };
        if first == second { vec![first] } else { vec![first, second] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_survive_and_points_stay_few() {
        let mut points: Vec<(f64, f64)> =
            (0..100_000).map(|i| (f64::from(i) * 5e-3, (f64::from(i) * 0.01).sin())).collect();
        points[61_803].1 = 9.0;
        points[31_415].1 = -7.0;
        let runs = runs(points);
        assert_eq!(runs.len(), 1);
        assert!(runs[0].len() <= 1002);
        assert!(runs[0].iter().any(|p| p.1 > 8.9) && runs[0].iter().any(|p| p.1 < -6.9));
        assert!(runs[0].windows(2).all(|w| w[0].0 <= w[1].0));
    }

    #[test]
    fn a_missing_stretch_breaks_the_curve() {
        let points = [(0.0, 1.0), (10.0, f64::NAN), (20.0, 2.0), (30.0, 3.0)];
        assert_eq!(runs(points), [vec![(0.0, 1.0)], vec![(20.0, 2.0), (30.0, 3.0)]]);
        assert!(runs([]).is_empty());
    }
}
