//! An analysis beside its truth to a row, and rows to CSV.

use super::statistics;
use crate::data::{Analysis, Estimate, ReconstructionRung, Severity};
use crate::lab::chance::round;
use crate::lab::data::{Campaign, CampaignRow, Damage, SceneNumber, Scored, SyntheticRecording, Truth};
use crate::lab::drawn::DrawnDrop;
use crate::report::ReportError;
use crate::report::records::finished;
use std::collections::{BTreeMap, BTreeSet};

/// A scene, drawn, struck by its damage and recorded.
pub(super) struct RecordedScene {
    pub drop: DrawnDrop,
    pub damage: Option<Damage>,
    pub recording: SyntheticRecording,
}

/// The row of a scene, without the time that its analysis took; no analysis: the recording was refused.
pub(super) fn row(number: SceneNumber, scene: RecordedScene, analysis: Option<&Analysis>) -> CampaignRow {
    let RecordedScene { drop, damage, recording } = scene;
    let truth = drop.motion.truth;
    let first_contact_s = recording.first_contact_s;
    let slap_down_s = truth.slap_t.map(|t| first_contact_s + t * (1.0 + drop.scene.clock_error));
    let result = analysis.map(|a| &a.result);
    let choice = result.and_then(|r| r.reconstruction.as_ref());
    CampaignRow {
        number,
        damage,
        verdict: result.map(|r| r.verdict),
        findings: result.into_iter().flat_map(|r| &r.quality).map(|i| (i.code, i.severity)).collect(),
        quantities: quantities(&truth, (first_contact_s, slap_down_s), analysis),
        rung: choice.map(|choice| choice.rung),
        candidates: choice.map_or_else(Vec::new, |choice| choice.candidates.clone()),
        misses_u: choice.into_iter().flat_map(|c| &c.closures).map(|c| c.miss_in_u).collect(),
        truth,
        scene: drop.scene,
        stated: drop.stated,
        analysis_s: 0.0,
    }
}

/// What is scored, in this order; the times of first contact and slap-down count from the first sample, s.
fn quantities(truth: &Truth, times_s: (f64, Option<f64>), analysis: Option<&Analysis>) -> Vec<Scored> {
    let result = analysis.map(|a| &a.result);
    let first_impact = result.map(|r| &r.first_impact);
    let slap_down = result.map(|r| &r.slap_down);
    let scored = |name, stated: Option<Estimate>, truth| Scored { name, stated, truth };
    vec![
        scored("speed", slap_down.and_then(|s| s.speed), truth.speed),
        scored("k", result.and_then(|r| r.k), truth.k),
        scored("vertical", slap_down.and_then(|s| s.vertical_velocity), truth.vz),
        scored("horizontal", slap_down.and_then(|s| s.horizontal_velocity), truth.vx),
        scored("omega", first_impact.and_then(|f| f.angular_velocity), truth.omega_rebound),
        scored("flight", slap_down.and_then(|s| s.flight_time), truth.flight_s),
        scored("angle", slap_down.and_then(|s| s.angle), truth.angle_hit_deg),
        scored("duration", first_impact.and_then(|f| f.duration), truth.contact_s),
        scored("contact_time", first_impact.and_then(|f| f.time), Some(times_s.0)),
        scored("slap_down_time", slap_down.and_then(|s| s.time), times_s.1),
    ]
}

/// The rows as CSV, one a scene; times of the analysis are left out, so that the same campaign gives the same bytes.
///
/// # Errors
/// Where the writer fails.
pub fn csv(campaign: &Campaign) -> Result<Vec<u8>, ReportError> {
    let rows: Vec<Vec<Cell>> = campaign.rows.iter().map(|row| cells(campaign.request.seed, row)).collect();
    // Not every scene has as many modes and channels: a header for each that any has.
    let mut headers: Vec<&String> = Vec::new();
    let mut known = BTreeSet::new();
    headers.extend(rows.iter().flatten().map(|cell| &cell.0).filter(|header| known.insert(*header)));
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&headers)?;
    for row in &rows {
        let row: BTreeMap<&String, &String> = row.iter().map(|cell| (&cell.0, &cell.1)).collect();
        writer.write_record(headers.iter().map(|header| row.get(header).map_or("", |cell| cell)))?;
    }
    finished(writer)
}

/// A cell under its header.
type Cell = (String, String);

fn cell(header: &str, value: impl std::fmt::Display) -> Cell {
    (header.to_owned(), value.to_string())
}

fn maybe(header: &str, value: Option<f64>) -> Cell {
    (header.to_owned(), value.map(|value| value.to_string()).unwrap_or_default())
}

/// A value and its half-width.
fn estimate(header: &str, estimate: Option<Estimate>) -> [Cell; 2] {
    [maybe(header, estimate.map(|e| e.value)), maybe(&format!("{header}_u95"), estimate.map(|e| e.u95))]
}

fn cells(seed: u64, row: &CampaignRow) -> Vec<Cell> {
    let mut cells = vec![
        cell("scene", row.number),
        cell("seed", seed),
        cell("kind", row.damage.map_or("none", |damage| damage.kind)),
        maybe("size", row.damage.map(|damage| damage.size)),
        cell("size_unit", row.damage.map_or("", |damage| damage.unit)),
        cell("verdict", row.verdict.map_or_else(|| "refused".to_owned(), written)),
        cell("outcome", format!("{:?}", statistics::outcome(row)).to_lowercase()),
        cell("errors", codes(row, Severity::Error)),
        cell("warnings", codes(row, Severity::Warning)),
    ];
    for scored in &row.quantities {
        cells.extend(estimate(scored.name, scored.stated));
        cells.push(maybe(&format!("{}_true", scored.name), scored.truth));
        cells.push(maybe(&format!("{}_off", scored.name), statistics::half_widths_off(scored)));
    }
    cells.push(cell("rung", row.rung.map_or_else(String::new, written)));
    for rung in ReconstructionRung::ALL {
        let candidate = row.candidates.iter().find(|candidate| candidate.rung == rung);
        let name = written(rung);
        cells.push(cell(
            &format!("{name}_consistent"),
            candidate.map_or("", |c| if c.consistent { "yes" } else { "no" }),
        ));
        cells.extend(estimate(&format!("{name}_speed"), candidate.and_then(|c| c.speed)));
        cells.extend(estimate(&format!("{name}_k"), candidate.and_then(|c| c.k)));
    }
    cells.push(maybe("largest_miss_u", statistics::largest_miss_u(row)));
    cells.push(maybe("stated_angle_deg", Some(round(row.stated.drop.angle_rad.to_degrees(), 9))));
    cells.push(cell("stated_contact", row.stated.contact));
    let truth = serde_json::to_value(row.truth).unwrap_or_default();
    let scene = serde_json::to_value(&row.scene).unwrap_or_default();
    flatten("true", &truth, &mut cells);
    flatten("scene", &scene, &mut cells);
    cells
}

/// A cell for each number and word of a value, under its way there: "scene.modes.0.frequency_hz".
fn flatten(header: &str, value: &serde_json::Value, cells: &mut Vec<Cell>) {
    let below = |key: &dyn std::fmt::Display| format!("{header}.{key}");
    match value {
        serde_json::Value::Object(of) => {
            of.iter().for_each(|(key, value)| flatten(&below(key), value, cells));
        }
        serde_json::Value::Array(of) => {
            of.iter().enumerate().for_each(|(i, value)| flatten(&below(&i), value, cells));
        }
        serde_json::Value::String(word) => cells.push(cell(header, word)),
        serde_json::Value::Null => cells.push(cell(header, "")),
        value => cells.push(cell(header, value)),
    }
}

/// Codes of this severity, each once.
fn codes(row: &CampaignRow, severity: Severity) -> String {
    let mut names: Vec<String> =
        row.findings.iter().filter(|f| f.1 == severity).map(|f| written(f.0)).collect();
    names.sort();
    names.dedup();
    names.join(" ")
}

/// A code, a rung or a verdict as the result writes it.
pub(in crate::lab) fn written(word: impl serde::Serialize) -> String {
    // An enum without data is a JSON string.
    serde_json::to_string(&word).unwrap_or_default().trim_matches('"').to_owned()
}
