//! An analysis beside its truth to a row, and a row to a line of CSV.

use super::statistics;
use crate::data::{Analysis, Estimate, ReconstructionRung, Severity};
use crate::lab::chance::round;
use crate::lab::data::{
    CampaignRow, Damage, RungSaid, SceneFacts, SceneNumber, Scored, Stated, SyntheticRecording, Truth,
};
use crate::lab::drawn::DrawnDrop;
use crate::report::ReportError;
use crate::report::records::records;
use crate::report::text::json_word;
use std::collections::BTreeMap;

/// A scene, drawn, struck by its damage and recorded.
pub(super) struct RecordedScene {
    pub drop: DrawnDrop,
    pub damage: Option<Damage>,
    pub recording: SyntheticRecording,
}

/// The row of a scene; no analysis: the recording was refused.
pub(super) fn row(scene: SceneNumber, recorded: RecordedScene, analysis: Option<&Analysis>) -> CampaignRow {
    let RecordedScene { drop, damage, recording } = recorded;
    let truth = drop.motion.truth;
    let first_contact_s = recording.first_contact_s;
    let slap_down_s = truth.slap_t.map(|t| first_contact_s + t * (1.0 + drop.scene.clock_error));
    let result = analysis.map(|a| &a.result);
    let choice = result.and_then(|r| r.reconstruction.as_ref());
    let misses_u = choice.into_iter().flat_map(|c| &c.closures).map(crate::data::Closure::most_in_u);
    let rungs = choice.into_iter().flat_map(|choice| &choice.candidates).map(|c| RungSaid {
        rung: c.rung,
        consistent: c.consistent,
        speed: c.speed.map(Stated::from),
        k: c.k.map(Stated::from),
    });
    CampaignRow {
        scene,
        damage,
        verdict: result.map(|r| r.verdict),
        errors: codes(analysis, Severity::Error),
        warnings: codes(analysis, Severity::Warning),
        quantities: quantities(&truth, (first_contact_s, slap_down_s), analysis),
        rung: choice.map(|choice| choice.rung),
        rungs: rungs.collect(),
        largest_miss_u: misses_u.max_by(f64::total_cmp),
        facts: SceneFacts {
            cask: drop.scene.cask.name,
            angle_deg: truth.angle_deg,
            rate_hz: drop.scene.channels.first().map_or(0.0, |channel| channel.sample_rate_hz),
            modes: drop.scene.modes.len(),
            yields: drop.scene.first_end.yield_n.is_some(),
            rest: drop.scene.rest,
            stated_angle_deg: round(drop.stated.drop.angle_rad.to_degrees(), 9),
            stated_contact: drop.stated.contact.to_string(),
        },
    }
}

/// What is scored, by name; the times of first contact and slap-down count from the first sample, s.
fn quantities(
    truth: &Truth,
    times_s: (f64, Option<f64>),
    analysis: Option<&Analysis>,
) -> BTreeMap<String, Scored> {
    let result = analysis.map(|a| &a.result);
    let first_impact = result.map(|r| &r.first_impact);
    let slap_down = result.map(|r| &r.slap_down);
    let scored = |name: &str, stated: Option<Estimate>, truth| {
        (name.to_owned(), Scored { stated: stated.map(Stated::from), truth })
    };
    BTreeMap::from([
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
    ])
}

/// Codes of this severity, each once.
fn codes(analysis: Option<&Analysis>, severity: Severity) -> Vec<String> {
    let findings = analysis.into_iter().flat_map(|a| &a.result.quality);
    let mut names: Vec<String> =
        findings.filter(|f| f.severity == severity).map(|f| json_word(f.code)).collect();
    names.sort();
    names.dedup();
    names
}

/// The row as a line of CSV, below the line of its headers where that is wanted: they are the same for every
/// row.
///
/// # Errors
/// Where the writer fails.
pub fn csv(row: &CampaignRow, with_headers: bool) -> Result<Vec<u8>, ReportError> {
    let cells = cells(row);
    let (headers, cells): (Vec<String>, Vec<String>) = cells.into_iter().unzip();
    records(with_headers.then_some(headers).into_iter().chain([cells]))
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
fn pair(header: &str, stated: Option<Stated>) -> [Cell; 2] {
    [maybe(header, stated.map(|e| e.value)), maybe(&format!("{header}_u95"), stated.map(|e| e.u95))]
}

fn cells(row: &CampaignRow) -> Vec<Cell> {
    let (damage, facts) = (row.damage.as_ref(), &row.facts);
    let mut cells = vec![
        cell("scene", row.scene),
        cell("kind", damage.map_or("none", |damage| &damage.kind)),
        maybe("size", damage.map(|damage| damage.size)),
        cell("size_unit", damage.map_or("", |damage| &damage.unit)),
        cell("verdict", row.verdict.map_or_else(|| "refused".to_owned(), json_word)),
        cell("outcome", statistics::outcome(row).word()),
        cell("errors", row.errors.join(" ")),
        cell("warnings", row.warnings.join(" ")),
    ];
    for (name, ..) in statistics::QUANTITIES {
        let scored = row.quantities.get(name);
        cells.extend(pair(name, scored.and_then(|scored| scored.stated)));
        cells.push(maybe(&format!("{name}_true"), scored.and_then(|scored| scored.truth)));
        cells.push(maybe(&format!("{name}_off"), scored.and_then(statistics::half_widths_off)));
    }
    cells.push(cell("rung", row.rung.map_or_else(String::new, json_word)));
    for rung in ReconstructionRung::ALL {
        let said = row.rungs.iter().find(|said| said.rung == rung);
        let name = json_word(rung);
        cells.push(cell(
            &format!("{name}_consistent"),
            said.map_or("", |said| if said.consistent { "yes" } else { "no" }),
        ));
        cells.extend(pair(&format!("{name}_speed"), said.and_then(|said| said.speed)));
        cells.extend(pair(&format!("{name}_k"), said.and_then(|said| said.k)));
    }
    cells.extend([
        maybe("largest_miss_u", row.largest_miss_u),
        cell("cask", &facts.cask),
        cell("angle_true_deg", facts.angle_deg),
        cell("rate_hz", facts.rate_hz),
        cell("modes", facts.modes),
        cell("yields", facts.yields),
        cell("rest", facts.rest),
        cell("stated_angle_deg", facts.stated_angle_deg),
        cell("stated_contact", &facts.stated_contact),
    ]);
    cells
}
