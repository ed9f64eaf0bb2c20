//! Compares an analysis with its truth as a row, and derives the outcome of the scene from the row.

use crate::data::{Analysis, Estimate, Severity, Verdict};
use crate::lab::data::{
    CampaignRow, Damage, SceneFacts, SceneNumber, Scored, Stated, SyntheticRecording, Truth,
};
use crate::lab::drawn::DrawnDrop;
use crate::report::text::json_word;
use std::collections::BTreeMap;

/// An error above this many half-widths on a result that passed is a miss: the interval ends half its width,
/// which is one half-width, short of the truth.
const MISSED_BY: f64 = 2.0;

/// A scene, drawn, damaged and recorded.
pub(super) struct RecordedScene {
    pub drop: DrawnDrop,
    pub damage: Option<Damage>,
    pub recording: SyntheticRecording,
}

/// The row of a scene; without an analysis the recording was refused.
pub(super) fn row(scene: SceneNumber, recorded: RecordedScene, analysis: Option<&Analysis>) -> CampaignRow {
    let RecordedScene { drop, damage, recording } = recorded;
    let truth = drop.motion.truth;
    let first_contact_s = recording.first_contact_s;
    let slap_down_s = truth.slap_t.map(|t| first_contact_s + t * (1.0 + drop.scene.clock_error));
    let result = analysis.map(|a| &a.result);
    CampaignRow {
        scene,
        damage,
        verdict: result.map(|r| r.verdict),
        errors: codes(analysis, Severity::Error),
        warnings: codes(analysis, Severity::Warning),
        quantities: quantities(&truth, (first_contact_s, slap_down_s), analysis),
        rung: result.and_then(|r| Some(r.reconstruction.as_ref()?.rung)),
        facts: SceneFacts {
            cask: drop.scene.cask.name,
            angle_deg: truth.angle_deg,
            rate_hz: drop.scene.channels.first().map_or(0.0, |channel| channel.sample_rate_hz),
            elastic: drop.scene.elastic.is_some(),
        },
    }
}

/// Pairs each scored quantity with its name; the times of first contact and slap-down count from the first
/// sample, s.
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

/// Outcome of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SceneOutcome {
    /// Passed, and right.
    Right,
    /// Not passed, but its intervals hold the truth.
    Covered,
    /// Not passed, and without numbers or with wrong ones.
    Caught,
    /// Passed, and wrong.
    Missed,
}

impl SceneOutcome {
    /// All outcomes, from the best to the worst.
    pub(super) const ALL: [Self; 4] = [Self::Right, Self::Covered, Self::Caught, Self::Missed];

    /// "right", "covered" and so on.
    pub fn word(self) -> String {
        format!("{self:?}").to_lowercase()
    }
}

/// Outcome of the scene of this row, by speed and k.
pub fn outcome(row: &CampaignRow) -> SceneOutcome {
    let off = ["speed", "k"].map(|name| row.quantities.get(name).and_then(half_widths_off));
    let worst = off.iter().flatten().fold(0.0_f64, |worst, off| worst.max(*off));
    let has_both = off.iter().all(Option::is_some);
    match row.verdict {
        Some(Verdict::Pass) if worst > MISSED_BY => SceneOutcome::Missed,
        Some(Verdict::Pass) if has_both => SceneOutcome::Right,
        Some(_) if has_both && worst <= 1.0 => SceneOutcome::Covered,
        _ => SceneOutcome::Caught,
    }
}

/// True if the row passed although a number is wrong.
pub(in crate::lab) fn is_missed(row: &CampaignRow) -> bool {
    outcome(row) == SceneOutcome::Missed
}

/// Distance from the truth in half-widths, where both are known.
pub(in crate::lab) fn half_widths_off(scored: &Scored) -> Option<f64> {
    let (stated, truth) = scored.stated.zip(scored.truth)?;
    Some(half_widths_between(stated, truth))
}

/// Half-widths between a statement and the truth.
pub(in crate::lab) fn half_widths_between(stated: Stated, truth: f64) -> f64 {
    // No number at all is as far off as can be.
    let off = (stated.value - truth).abs() / stated.u95.max(f64::MIN_POSITIVE);
    if off.is_nan() { f64::INFINITY } else { off }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_statement_is_held_against_its_own_half_width() {
        let off = |value, u95| {
            let stated = Some(Stated { value, u95 });
            half_widths_off(&Scored { stated, truth: Some(0.5) }).expect("both known")
        };
        assert!((off(0.53, 0.02) - 1.5).abs() < 1e-9);
        assert!(off(f64::NAN, 0.02).is_infinite());
        assert!(off(0.5, 0.0).abs() < 1e-15);
        assert!(half_widths_off(&Scored { stated: None, truth: Some(0.5) }).is_none());
    }
}
