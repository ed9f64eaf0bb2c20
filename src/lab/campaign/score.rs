//! An analysis beside its truth to a row, and rows to CSV.

use super::draw::Redraws;
use super::statistics;
use crate::data::{Analysis, Estimate, ReconstructionRung, Severity};
use crate::lab::chance::round;
use crate::lab::data::{Campaign, CampaignRow, Damage, SceneNumber, Scored, SyntheticRecording, Truth};
use crate::lab::drawn::DrawnDrop;

/// A scene, drawn, struck by its damage and recorded.
pub(super) struct RecordedScene {
    pub drop: DrawnDrop,
    pub redraws: Redraws,
    pub damage: Option<Damage>,
    pub recording: SyntheticRecording,
}

/// The row of a scene, without the time that its analysis took; no analysis: the recording was refused.
pub(super) fn row(number: SceneNumber, scene: RecordedScene, analysis: Option<&Analysis>) -> CampaignRow {
    let RecordedScene { drop, redraws, damage, recording } = scene;
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
        redraws,
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
pub fn csv(campaign: &Campaign) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (i, row) in campaign.rows.iter().enumerate() {
        let cells = cells(campaign.request.seed, row);
        if i == 0 {
            writer.write_record(cells.iter().map(|cell| cell.0.as_str()))?;
        }
        writer.write_record(cells.iter().map(|cell| cell.1.as_str()))?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
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
        cells.push(cell(&format!("{name}_consistent"), candidate.map_or("", |c| yes(c.consistent))));
        cells.extend(estimate(&format!("{name}_speed"), candidate.and_then(|c| c.speed)));
        cells.extend(estimate(&format!("{name}_k"), candidate.and_then(|c| c.k)));
    }
    cells.push(maybe("largest_miss_u", statistics::largest_miss_u(row)));
    cells.extend(scene_cells(row));
    cells
}

/// The parameters of the scene, as they are and as they are stated.
fn scene_cells(row: &CampaignRow) -> Vec<Cell> {
    let (scene, stated, truth) = (&row.scene, &row.stated, &row.truth);
    let mut cells = vec![
        cell("cask", &scene.cask.name),
        cell("mass_kg", scene.cask.mass_kg),
        cell("length_m", scene.cask.length_m),
        cell("height_m", scene.cask.height_m),
        cell("cog_m", scene.cask.cog_m),
        cell("stated_cog_m", stated.cask.cog_m),
        cell("inertia_kg_m2", scene.cask.inertia_kg_m2),
        cell("stated_inertia_kg_m2", stated.cask.inertia_kg_m2),
        cell("drop_height_m", scene.drop.height_m),
        cell("stated_drop_height_m", stated.drop.height_m),
        cell("angle_deg", truth.angle_deg),
        cell("stated_angle_deg", round(stated.drop.angle_rad.to_degrees(), 9)),
        cell("contact", scene.contact),
        cell("stated_contact", stated.contact),
        maybe("contact_s", truth.contact_s),
        cell("yields", yes(scene.first_end.yield_n.is_some())),
        cell("modes", scene.modes.len()),
    ];
    for order in 0..3 {
        let mode = scene.modes.get(order);
        cells.push(maybe(&format!("mode_{}_hz", order + 1), mode.map(|m| m.frequency_hz)));
        cells.push(maybe(&format!("mode_{}_damping", order + 1), mode.map(|m| m.damping)));
        cells.push(maybe(&format!("mode_{}_strength", order + 1), mode.map(|m| m.strength)));
    }
    cells.extend([
        cell("relands", truth.relands),
        cell("rest", yes(scene.rest)),
        cell("before_s", scene.before_s),
        cell("after_s", scene.after_s),
        cell("clock_error_ppm", scene.clock_error * 1e6),
        cell("channels", scene.channels.len()),
    ]);
    for i in 0..2 {
        let (channel, spec) = (scene.channels.get(i), stated.channels.get(i));
        let of = |name: &str| format!("a{}_{name}", i + 1);
        cells.push(maybe(&of("rate_hz"), channel.map(|c| c.sample_rate_hz)));
        cells.push(maybe(&of("position_m"), channel.map(|c| c.position_m)));
        cells.push(maybe(&of("stated_position_m"), spec.map(|s| s.position_m)));
        cells.push(maybe(&of("offset_m"), channel.map(|c| c.offset_m)));
        cells.push(maybe(&of("scale"), channel.map(|c| c.chain.scale)));
        cells.push(maybe(&of("cross_axis"), channel.map(|c| c.chain.cross_axis)));
        cells.push(maybe(&of("anti_alias_hz"), channel.and_then(|c| c.chain.anti_alias_hz)));
        cells.push(maybe(&of("resonance_hz"), channel.and_then(|c| c.chain.resonance).map(|r| r.0)));
        cells.push(maybe(&of("white_noise_m_s2"), channel.map(|c| c.chain.white_noise_m_s2)));
        cells.push(maybe(&of("pink_noise_m_s2"), channel.map(|c| c.chain.pink_noise_m_s2)));
        cells.push(maybe(&of("full_scale_m_s2"), channel.and_then(|c| c.chain.full_scale_m_s2)));
        cells.push(maybe(&of("stated_full_scale"), spec.and_then(|s| s.full_scale)));
        cells.push(maybe(&of("bits"), channel.and_then(|c| c.chain.bits).map(f64::from)));
    }
    let axial = scene.channels.iter().any(|c| c.axis == crate::data::Axis::Axial);
    cells.push(cell("axial_channel", yes(axial)));
    cells
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
pub(super) fn written(word: impl serde::Serialize) -> String {
    // An enum without data is a JSON string.
    serde_json::to_string(&word).unwrap_or_default().trim_matches('"').to_owned()
}

fn yes(is: bool) -> &'static str {
    if is { "yes" } else { "no" }
}
