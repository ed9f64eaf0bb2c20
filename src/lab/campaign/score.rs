//! An analysis beside its truth to a row.

use crate::data::{Analysis, Estimate, Severity};
use crate::lab::chance::round;
use crate::lab::data::{
    CampaignRow, Damage, RungSaid, SceneFacts, SceneNumber, Scored, Stated, SyntheticRecording, Truth,
};
use crate::lab::drawn::DrawnDrop;
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
            elastic: drop.scene.elastic.is_some(),
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
