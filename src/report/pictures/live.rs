//! Panels to the numbers that a page's own script draws again, to be zoomed and copied.

use super::super::text::printable;
use super::decimate::thinned;
use super::panel::{Curve, Panel};
use crate::numerics::{as_count, as_f64, single};
use base64::prelude::{BASE64_STANDARD as STANDARD, Engine};
use serde_json::{Value, json};

/// Values of a picture that has every sample, in single precision as in the files of curves, and of one that
/// is thinned: a page of two channels stays below 750 kB at any rate.
pub(super) const MOST_VALUES: usize = 25_000;
const THINNED_VALUES: usize = 12_000;

/// What stands beside a picture of which nothing was left out.
pub(super) const EVERY_SAMPLE: &str = "Drag to zoom: every sample is here.";

/// The panels with lines on linear axes, as JSON, the lines being those of the picture `of` where it has a
/// name; empty where there is none. `thinned` says what was left out before, where anything was.
pub(super) fn numbers(panels: &[&Panel], of: &str, thinned: Option<&str>) -> String {
    let drawn = || panels.iter().filter(|panel| !panel.lines.is_empty());
    let count: usize = drawn().flat_map(|panel| &panel.lines).map(|line| line.points.len()).sum();
    if count == 0 {
        return String::new();
    }
    // Of each so many samples the lowest and the highest are drawn; of one it is all.
    let is_whole = thinned.is_some() || count <= MOST_VALUES;
    let each = if is_whole { 1 } else { (2 * count).div_ceil(THINNED_VALUES) };
    let note = match thinned {
        Some(left_out) => left_out.to_owned(),
        None if is_whole => EVERY_SAMPLE.to_owned(),
        None => format!(
            "Drawn and copied: the lowest and the highest of each {each} samples; curves.csv has all."
        ),
    };
    let all: Vec<Value> = drawn().map(|panel| of_panel(panel, each, of)).collect();
    json!({"note": note, "of": of, "panels": all}).to_string().replace('<', "\\u003c")
}

fn of_panel(panel: &Panel, each: usize, of: &str) -> Value {
    let own = panel.lines.iter().filter(|_| of.is_empty());
    let lines: Vec<Value> = own.map(|line| of_line(line, each)).collect();
    let marks: Vec<Value> = panel.marks.iter().map(|mark| json!([mark.at, mark.label])).collect();
    let range = panel.x_range();
    json!({
        "title": panel.title, "x": panel.x.label, "y": panel.y.label, "height": panel.height, "lines": lines,
        "marks": marks, "from": range.start, "to": range.end
    })
}

/// The values, and not a number between runs, where samples are missing; their places, in steps of `dx` from
/// `x0` on, as the numbers of samples between them, where these are not all one.
fn of_line(line: &Curve, each: usize) -> Value {
    let ends = line.points.first().zip(line.points.last());
    let (x0, last) = ends.map_or((0.0, 0.0), |(first, last)| (first.0, last.0));
    let dx = line.step.unwrap_or((last - x0) / as_f64(line.points.len().max(2) - 1));
    let place = |i: usize, x: f64| line.step.map_or(i, |step| as_count(((x - x0) / step).round()));
    let places = line.points.iter().enumerate().map(|(i, p)| (place(i, p.0), p.1));
    let (mut steps, mut bytes, mut at) = (Vec::new(), Vec::new(), 0);
    for (place, value) in thinned(places, each) {
        steps.push(place - at);
        bytes.extend_from_slice(&single(value).to_le_bytes());
        at = place;
    }
    let is_even = steps.iter().enumerate().all(|(i, step)| *step == usize::from(i > 0));
    json!({
        "label": line.label.as_deref().map(printable), "color": line.colour.to_string(),
        "opacity": line.opacity, "dash": line.dash.pieces(), "stroke": line.stroke,
        "x0": x0, "dx": dx, "steps": (!is_even).then_some(steps), "y": STANDARD.encode(bytes)
    })
}
