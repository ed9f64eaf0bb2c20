//! Picture of measured and predicted slap-down speed: a row per prediction, a band for the measurement.

use super::super::rounding::{fixed, interval, pair, plain};
use super::super::words::contact_words;
use super::draw::{Figure, Picture};
use super::panel::{COLOURS, Curve, Fill, Mark, Panel, PanelAxis, PointShape, Points, RowWords};
use crate::data::{Analysis, Estimate, Prediction};

/// Height of a row.
const ROW: u32 = 52;

/// One row: its words, speed, half-width and true if it is made with the measured k.
struct ComparedRow {
    words: RowWords,
    speed_m_s: f64,
    u95_m_s: Option<f64>,
    own_k: bool,
}

/// The picture.
pub(super) fn picture(analysis: &Analysis) -> Picture {
    let panel = panel(&rows(analysis), analysis.result.slap_down.speed.filter(|e| e.value.is_finite()));
    let caption = "Speed of the second end just before it strikes. Dots: the analytical models with the \
                   borderline k; squares: with the measured k, with their 95 % intervals where known. Dashed \
                   line and band: the measurement and its 95 % interval.";
    Figure::new("comparison", "Measured beside predicted", caption).picture(&[panel])
}

fn rows(analysis: &Analysis) -> Vec<ComparedRow> {
    let result = &analysis.result;
    let measured_k = result.k.map(|k| k.value);
    let row = |p: &Prediction| {
        let speed_m_s = p.slap_down_speed_m_s.filter(|v| v.is_finite())?;
        let own_k = measured_k.is_some_and(|k| (k - p.k).abs() < 1e-9);
        let u95_m_s = result
            .model
            .iter()
            .flat_map(|m| &m.candidates)
            .find(|c| own_k && c.predicted.is_some_and(|own_m_s| (own_m_s - speed_m_s).abs() < 1e-9))
            .and_then(|c| c.u95)
            .filter(|u| u.is_finite());
        let k = if own_k { format!("{} (measured)", fixed(p.k, 3)) } else { plain(p.k, 3) };
        let left = format!("{}, {}, k = {k}", p.model.as_str(), contact_words(p.contact));
        let value = |u95| pair(speed_m_s, u95, "m/s").replace(" m/s", "");
        let right = u95_m_s.map_or_else(|| format!("{speed_m_s:.2}"), value);
        let words = RowWords { left, right, is_heading: false };
        Some(ComparedRow { words, speed_m_s, u95_m_s, own_k })
    };
    result.predictions.iter().filter_map(row).collect()
}

fn panel(rows: &[ComparedRow], measured: Option<Estimate>) -> Panel {
    let words = rows.iter().map(|row| row.words.clone()).collect();
    let mut panel = Panel::from_rows(words, ROW, (560, 230));
    panel.x = PanelAxis::new("slap-down speed, m/s");
    if let Some(speed) = measured {
        let u95 = if speed.u95.is_finite() { speed.u95 } else { 0.0 };
        let area = Fill::rectangle((speed.value - u95, speed.value + u95), panel.y.range.unwrap_or_default());
        panel.fills.push(Fill::new(COLOURS[2], 0.22, vec![area]));
        panel.marks.push(Mark { at: speed.value, label: format!("measured {}", interval(Some(&speed))) });
    }
    for (i, row) in rows.iter().enumerate() {
        let y = panel.row_middle(i);
        let look = usize::from(row.own_k);
        let (colour, shape) = (COLOURS[look], PointShape::from_index(look));
        if let Some(u95) = row.u95_m_s {
            let (low, high) = (row.speed_m_s - u95, row.speed_m_s + u95);
            let ends = [low, high].map(|x| vec![(x, y - 0.21), (x, y + 0.21)]);
            let interval = ends.into_iter().chain([vec![(low, y), (high, y)]]);
            panel.lines.extend(interval.map(|points| Curve::new(colour, points)));
        }
        panel.points.push(Points::new(colour, shape, vec![(row.speed_m_s, y)]));
    }
    panel.with_air(0.08)
}
