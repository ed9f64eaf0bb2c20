//! From a small campaign to tables and scenes that say the same again, and to what counts as missed.

use crate::run::{analyze, dropcheck, number};
use dropcheck::data::{Estimate, IssueCode, ReconstructionCandidate, ReconstructionRung, Severity, Verdict};
use dropcheck::lab::campaign::{self, DamageKind};
use dropcheck::lab::data::{Campaign, CampaignRequest, CampaignRow, Damage, SceneNumber};
use std::collections::BTreeMap;

/// Cheap kinds: they make no longer records.
const KINDS: [&str; 3] = ["gap_flight", "polarity_first", "stated_angle"];

fn run(scenes: u32, seed: u64, exact: bool) -> Campaign {
    let request = CampaignRequest { scenes, seed, undamaged: true, kinds: KINDS.to_vec(), exact };
    campaign::run(&request, &|_| {})
}

/// The cells of the CSV, a map a scene.
fn cells(campaign: &Campaign) -> Vec<BTreeMap<String, String>> {
    let bytes = campaign::csv(campaign).expect("the CSV is written");
    csv::Reader::from_reader(&bytes[..]).deserialize().map(|row| row.expect("a whole row")).collect()
}

#[test]
fn a_seed_gives_the_same_campaign_and_another_seed_another() {
    let campaign = run(3, 7, false);
    let numbers: Vec<String> = campaign.rows.iter().map(|row| row.number.to_string()).collect();
    assert_eq!(numbers[..3], ["U0", "U1", "U2"]);
    assert!(campaign.rows[3..].iter().all(|row| matches!(row.number, SceneNumber::Damaged(_))));
    let csv = |campaign: &Campaign| campaign::csv(campaign).expect("the CSV is written");
    assert_eq!(csv(&campaign), csv(&run(3, 7, false)));
    assert_ne!(csv(&campaign), csv(&run(3, 8, false)));
}

#[test]
fn what_is_stated_differs_from_what_is_by_the_tolerances_and_with_exact_not_at_all() {
    for (exact, row) in [(false, &run(1, 3, false).rows[0]), (true, &run(1, 3, true).rows[0])] {
        let (scene, stated) = (&row.scene, &row.stated);
        let tolerances = stated.tolerances;
        let off = [
            (scene.drop.angle_rad - stated.drop.angle_rad) / tolerances.angle_rad,
            (scene.drop.impact_velocity_m_s / stated.drop.impact_velocity_m_s - 1.0)
                / tolerances.impact_velocity,
            (scene.cask.cog_m - stated.cask.cog_m) / tolerances.cog_m,
            (scene.cask.inertia_kg_m2 / stated.cask.inertia_kg_m2 - 1.0) / tolerances.inertia,
            (scene.channels[0].position_m - stated.channels[0].position_m) / tolerances.position_m,
            (scene.channels[1].chain.scale - 1.0) / tolerances.calibration,
            scene.channels[1].chain.cross_axis / tolerances.cross_axis,
        ];
        for off in off {
            // Five standard deviations are two and a half half-widths; equal but for rounding where exact.
            assert!(off.abs() < if exact { 1e-9 } else { 2.5 }, "{exact}: {off}");
            assert!(exact || off.abs() > 1e-9, "{off}");
        }
    }
}

#[test]
fn a_scene_in_files_gives_what_the_campaign_has_of_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let campaign = run(2, 5, false);
    assert_eq!(campaign.rows[2].damage.map(|damage| damage.kind), Some("gap_flight"));
    for row in &campaign.rows {
        let out = folder.path().join(row.number.to_string());
        let words = ["validate", "--seed", "5", "--scene", &row.number.to_string(), "--out"];
        let answer = dropcheck(words.iter().map(Into::into).chain([out.as_os_str().to_owned()]));
        assert_eq!(answer.status, 0, "{}", answer.stderr);
        let file = |ending| out.join(format!("{}.{ending}", row.number));
        let result = analyze(&file("mcap"), &file("toml")).json();
        assert_eq!(result["verdict"], format!("{:?}", row.verdict.expect("read")).to_lowercase());
        for (pointer, i) in [("/slap_down/speed/value", 0), ("/k/value", 1)] {
            let stated = row.quantities[i].stated.map(|e| e.value);
            let Some((from_file, in_memory)) = number(&result, pointer).zip(stated) else {
                assert_eq!((number(&result, pointer), stated), (None, None), "{} {pointer}", row.number);
                continue;
            };
            // Stamps in whole nanoseconds, angles in nine decimals of a degree, written and read.
            assert!((from_file / in_memory - 1.0).abs() < 1e-4, "{pointer}: {from_file}, not {in_memory}");
        }
    }
}

/// The row with other words on speed and k: verdict, error of either in half-widths.
fn judged(row: &CampaignRow, verdict: Verdict, off: Option<(f64, f64)>) -> CampaignRow {
    let mut row = row.clone();
    row.verdict = Some(verdict);
    for (i, off) in [off.map(|o| o.0), off.map(|o| o.1)].into_iter().enumerate() {
        let scored = &mut row.quantities[i];
        let truth = scored.truth.expect("every undamaged scene has a truth");
        scored.stated = off.map(|off| Estimate::new(truth + 0.25 * off, 0.25, "1"));
    }
    row
}

#[test]
fn a_pass_whose_interval_ends_half_its_width_short_of_the_truth_is_missed() {
    let campaign = run(1, 2, true);
    let row = &campaign.rows[0];
    for (verdict, off, wanted) in [
        (Verdict::Pass, Some((0.2, -1.9)), "right"),
        (Verdict::Pass, Some((2.1, 0.0)), "missed"),
        (Verdict::Pass, Some((0.0, -2.1)), "missed"),
        (Verdict::Review, Some((0.9, 0.9)), "covered"),
        (Verdict::Review, Some((0.9, 1.1)), "caught"),
        (Verdict::Fail, None, "caught"),
    ] {
        let rows = vec![judged(row, verdict, off)];
        let outcome = &cells(&Campaign { request: campaign.request.clone(), rows })[0]["outcome"];
        assert_eq!(outcome, wanted, "{verdict:?} {off:?}");
    }
}

fn candidate(rung: ReconstructionRung, k: Option<Estimate>) -> ReconstructionCandidate {
    ReconstructionCandidate { rung, speed: None, k, consistent: true, residual: String::new() }
}

#[test]
fn the_tables_have_every_kind_and_size_and_count_what_is_missed() {
    let mut campaign = run(1, 2, true);
    let sound = campaign.rows[0].clone();
    campaign.rows.clear();
    for &DamageKind { name: kind, ref sizes, unit, .. } in campaign::kinds() {
        for &size in sizes {
            let mut row = judged(&sound, Verdict::Pass, Some((if kind == "skew" { 2.5 } else { 0.0 }, 0.0)));
            row.damage = Some(Damage { kind, size, unit });
            campaign.rows.push(row);
        }
    }
    let mut reviewed = judged(&sound, Verdict::Review, Some((0.0, 0.0)));
    reviewed.findings = vec![(IssueCode::Geometry, Severity::Warning)];
    let says = |u95| Some(Estimate::new(sound.truth.k.expect("a truth") + 0.02, u95, "1"));
    reviewed.candidates = vec![candidate(ReconstructionRung::Planar, says(0.01))];
    reviewed.rung = Some(ReconstructionRung::Planar);
    campaign.rows.push(reviewed.clone());
    reviewed.candidates = vec![candidate(ReconstructionRung::Planar, says(0.03))];
    campaign.rows.push(reviewed);
    let tables = campaign::markdown(&campaign);
    for &DamageKind { name: kind, ref sizes, unit, .. } in campaign::kinds() {
        let outcome = if kind == "skew" { "0 | 0 | 0 | 1 | 200.0" } else { "1 | 0 | 0 | 0 | 0.0" };
        for size in sizes {
            let size = if unit.is_empty() { String::new() } else { format!("{size} {unit}") };
            let line = format!("| {kind} | {size} | 1 | {outcome} |");
            assert!(tables.contains(&line), "no {line:?} in\n{tables}");
        }
    }
    assert!(tables.contains("| `geometry` | warning | 2 | 2 | 2 |"), "{tables}");
    // Both are off by 0.02; one interval of two holds that.
    assert!(tables.contains("| planar | planar | 2 | – | – | – | 0.0200 | 50.0 % | – |"), "{tables}");
}

#[test]
fn words_that_name_nothing_are_refused_with_what_there_is() {
    for (words, wanted) in [
        (&["validate", "--quick", "--campaign", "1"][..], "--campaign"),
        (&["validate", "--campaign", "1", "--kinds", "rust"], "clip_first"),
        (&["validate", "--campaign", "0"], "1..=1000000"),
        (&["validate", "--scene", "17", "--out", "x"], "D and a number"),
        (&["validate", "--scene", "D1"], "--out"),
    ] {
        let answer = dropcheck(words);
        assert_eq!(answer.status, 2, "{words:?}");
        assert!(answer.stderr.contains(wanted), "{words:?}: {}", answer.stderr);
    }
}
