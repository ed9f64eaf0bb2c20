//! Panels to the numbers that a page's own script draws again, to be zoomed.

use super::super::text::printable;
use super::decimate::runs;
use super::panel::{Curve, Panel};
use crate::data::shown::to_digits;
use serde_json::{Value, json};

/// Columns of which the lowest and the highest point are kept: as many as a screen shows.
const COLUMNS: f64 = 800.0;
/// Places are counted in parts of a column.
const PARTS: f64 = 64.0;

/// The panels with lines on linear axes, as JSON; empty where there is none.
pub(super) fn numbers(panels: &[&Panel]) -> String {
    let all: Vec<Value> =
        panels.iter().filter(|panel| !panel.lines.is_empty()).map(|panel| of_panel(panel)).collect();
    if all.is_empty() { String::new() } else { Value::from(all).to_string().replace('<', "\\u003c") }
}

fn of_panel(panel: &Panel) -> Value {
    let range = panel.x_range();
    let column = (range.end - range.start) / COLUMNS;
    let lines: Vec<Value> = panel.lines.iter().map(|line| of_line(line, range.start, column)).collect();
    let marks: Vec<Value> = panel.marks.iter().map(|mark| json!([mark.at, mark.label])).collect();
    json!({"title": panel.title, "x": panel.x.label, "y": panel.y.label, "lines": lines, "marks": marks})
}

/// Values, and their places as steps from `x0` on in units of `dx`; null between runs, where samples are
/// missing.
fn of_line(line: &Curve, from: f64, column: f64) -> Value {
    let (mut steps, mut y, mut at) = (Vec::new(), Vec::new(), 0.0);
    let mut put = |x: f64, value: Value| {
        let place = (x * PARTS).round();
        steps.push(json!(whole(place - at)));
        y.push(value);
        at = place;
    };
    for (i, run) in runs(line.points.iter().map(|p| ((p.0 - from) / column, p.1))).iter().enumerate() {
        if let Some((begins, _)) = run.first().filter(|_| i > 0) {
            put(begins - 0.5, Value::Null);
        }
        for p in run {
            put(p.0, json!(to_digits(p.1, 4)));
        }
    }
    let (pieces, label) = (line.dash.pieces(), line.label.as_deref().map(printable));
    json!({
        "label": label, "color": line.colour.to_string(), "opacity": line.opacity, "dash": pieces,
        "width": f64::from(line.stroke) / 2.0, "x0": from, "dx": column / PARTS, "x": steps, "y": y
    })
}

/// Without the decimals that a number of JSON would show.
#[allow(clippy::cast_possible_truncation, reason = "a panel has a few thousand columns")]
fn whole(value: f64) -> i64 {
    value as i64
}
