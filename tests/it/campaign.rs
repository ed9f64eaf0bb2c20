//! From a small campaign to tables, lines and scenes that say the same again, in parts too, and to what
//! counts as missed.

use crate::run::{analyze, dropcheck, number};
use dropcheck::data::Verdict;
use dropcheck::lab::campaign::{self, DamageKind, Tally};
use dropcheck::lab::data::{CampaignRequest, CampaignRow, Damage, SceneNumber, Scored, Stated};
use std::fs;
use std::path::Path;

/// Cheap kinds: they make no longer records.
const KINDS: [&str; 3] = ["gap_flight", "polarity_first", "stated_angle"];

fn request(scenes: u32, seed: u64, exact: bool) -> CampaignRequest {
    let kinds = ["undamaged"].into_iter().chain(KINDS).map(str::to_owned).collect();
    CampaignRequest { scenes, seed, kinds, exact }
}

fn run(scenes: u32, seed: u64, exact: bool) -> Vec<CampaignRow> {
    campaign::run(&request(scenes, seed, exact), &|_| {})
}

/// All rows as they are written.
fn lines(campaign: &[CampaignRow]) -> String {
    serde_json::to_string(campaign).expect("the rows are written")
}

#[test]
fn a_seed_gives_the_same_campaign_and_another_seed_another() {
    let campaign = run(3, 7, false);
    let numbers: Vec<String> = campaign.iter().map(|row| row.scene.to_string()).collect();
    assert_eq!(numbers[..3], ["U0", "U1", "U2"]);
    assert!(campaign[3..].iter().all(|row| matches!(row.scene, SceneNumber::Damaged(_))));
    assert_eq!(lines(&campaign), lines(&run(3, 7, false)));
    assert_ne!(lines(&campaign), lines(&run(3, 8, false)));
}

#[test]
fn what_is_stated_differs_from_what_is_by_the_tolerances_and_with_exact_not_at_all() {
    for exact in [false, true] {
        let (file, _) = campaign::scene(3, SceneNumber::Undamaged(0), exact);
        let (scene, stated) = (&file.scene, &file.stated);
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
    assert_eq!(campaign[2].damage.as_ref().map(|damage| &damage.kind[..]), Some("gap_flight"));
    for row in &campaign {
        let out = folder.path().join(row.scene.to_string());
        let words = ["validate", "--seed", "5", "--scene", &row.scene.to_string(), "--out"];
        let answer = dropcheck(words.iter().map(Into::into).chain([out.as_os_str().to_owned()]));
        assert_eq!(answer.status, 0, "{}", answer.stderr);
        let file = |ending| out.join(format!("{}.{ending}", row.scene));
        let result = analyze(&file("mcap"), &file("toml")).json();
        assert_eq!(result["verdict"], format!("{:?}", row.verdict.expect("read")).to_lowercase());
        for (pointer, name) in [("/slap_down/speed/value", "speed"), ("/k/value", "k")] {
            let stated = row.quantities[name].stated.map(|e| e.value);
            let Some((from_file, in_memory)) = number(&result, pointer).zip(stated) else {
                assert_eq!((number(&result, pointer), stated), (None, None), "{} {pointer}", row.scene);
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
    for (name, off) in [("speed", off.map(|o| o.0)), ("k", off.map(|o| o.1))] {
        let scored: &mut Scored = row.quantities.get_mut(name).expect("scored");
        let truth = scored.truth.expect("every undamaged scene has a truth");
        scored.stated = off.map(|off| Stated { value: truth + 0.25 * off, u95: 0.25 });
    }
    row
}

#[test]
fn a_pass_whose_interval_ends_half_its_width_short_of_the_truth_is_missed() {
    let campaign = run(1, 2, true);
    let row = &campaign[0];
    for (verdict, off, wanted) in [
        (Verdict::Pass, Some((0.2, -1.9)), "right"),
        (Verdict::Pass, Some((2.1, 0.0)), "missed"),
        (Verdict::Pass, Some((0.0, -2.1)), "missed"),
        (Verdict::Review, Some((0.9, 0.9)), "covered"),
        (Verdict::Review, Some((0.9, 1.1)), "caught"),
        (Verdict::Fail, None, "caught"),
    ] {
        let outcome = campaign::outcome(&judged(row, verdict, off)).word();
        assert_eq!(outcome, wanted, "{verdict:?} {off:?}");
    }
}

#[test]
fn the_tables_have_every_kind_and_count_what_is_missed() {
    let campaign = run(1, 2, true);
    let sound = campaign[0].clone();
    let mut tally = Tally::new(request(1, 2, true));
    for &DamageKind { name: kind, ref sizes, unit, .. } in campaign::kinds() {
        for &size in sizes {
            let mut row = judged(&sound, Verdict::Pass, Some((if kind == "skew" { 2.5 } else { 0.0 }, 0.0)));
            row.damage = Some(Damage { kind: kind.to_owned(), size, unit: unit.to_owned() });
            tally.add(&row);
        }
    }
    let mut reviewed = judged(&sound, Verdict::Review, Some((0.0, 0.0)));
    let truth = sound.quantities["vertical"].truth.expect("a truth");
    for u95 in [0.01, 0.03] {
        let scored = reviewed.quantities.get_mut("vertical").expect("scored");
        scored.stated = Some(Stated { value: truth + 0.02, u95 });
        tally.add(&reviewed);
    }
    let tables = campaign::markdown(&tally);
    for &DamageKind { name: kind, ref sizes, .. } in campaign::kinds() {
        let n = sizes.len();
        let outcome = if kind == "skew" {
            format!("0 | 0 | 0 | {n} | 200.0")
        } else {
            format!("{n} | 0 | 0 | 0 | 0.0")
        };
        let of_damaged = format!("| {kind} | {n} | {outcome} |");
        let of_sound = format!("| {kind} | {n} | 100.0 % | 0.0 % |");
        assert!(tables.contains(&of_damaged) || tables.contains(&of_sound), "no {kind:?} in\n{tables}");
    }
    assert!(tables.contains("| undamaged | 2 | 0.0 % | 0.0 % | 100.0 % |"), "{tables}");
    // Both are off by 0.02; one interval of two holds that.
    let vertical = "| all | vertical velocity, m/s | 2 | 0.020 | 0.020 | 0.020 | 0.020 | 50.0 % |";
    assert!(tables.contains(vertical), "{tables}");
}

#[test]
fn a_stretched_cask_is_among_those_of_its_name() {
    let campaign = run(1, 2, true);
    let mut tally = Tally::new(request(1, 2, true));
    for cask in ["ESBB", "ESBB-var", "VHLW-var"] {
        let mut row = campaign[0].clone();
        row.facts.cask = cask.to_owned();
        tally.add(&row);
    }
    let tables = campaign::markdown(&tally);
    assert!(tables.contains("| ESBB | 2 |") && tables.contains("| VHLW | 1 |"), "{tables}");
}

/// `validate --campaign` of the cheap kinds with these words, in a folder.
fn validate(folder: &Path, words: &[&str]) -> crate::run::Answer {
    let kinds = format!("undamaged,{}", KINDS.join(","));
    let usual = ["validate", "--campaign", "3", "--seed", "9", "--kinds", &kinds];
    let paths = words.iter().map(|word| match word.strip_prefix('@') {
        Some(name) => folder.join(name).into_os_string(),
        None => (*word).into(),
    });
    dropcheck(usual.iter().map(Into::into).chain(paths))
}

/// `merge` of these files into the folder "merged".
fn merge(folder: &Path, names: &[&str]) -> crate::run::Answer {
    let paths = names.iter().map(|name| folder.join(name).into_os_string());
    dropcheck(["merge".into()].into_iter().chain(paths).chain(["--out".into(), folder.join("merged").into()]))
}

/// The campaign's tables.
fn tables(folder: &Path) -> Vec<u8> {
    fs::read(folder.join("campaign.md")).expect("the tables")
}

#[test]
fn shards_merged_are_one_run_and_a_shard_that_is_none_is_named() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let folder = place.path();
    assert_eq!(validate(folder, &["--out", "@whole", "--jsonl", "@whole.jsonl"]).status, 0);
    for i in 0..3 {
        let answer = validate(folder, &["--shard", &format!("{i}/3"), "--jsonl", &format!("@{i}.jsonl")]);
        assert_eq!(
            (answer.status, answer.stdout.contains(&format!("Shard {i}/3"))),
            (0, true),
            "{}",
            answer.stderr
        );
    }
    let text = fs::read_to_string(folder.join("1.jsonl")).expect("a shard");
    assert_eq!(text.lines().count(), 2);
    let other = |name: &str, text: &str| fs::write(folder.join(name), text).expect("a temporary file");
    other("cut.jsonl", &text[..text.len() - 20]);
    other("short.jsonl", &text[..=text.find('\n').expect("a line")]);
    other("long.jsonl", &format!("{text}{}\n", text.lines().next().expect("a line")));
    other("swapped.jsonl", &(text.lines().rev().collect::<Vec<_>>().join("\n") + "\n"));
    // In any order.
    for names in [["2.jsonl", "0.jsonl", "1.jsonl"], ["swapped.jsonl", "2.jsonl", "0.jsonl"]] {
        let merged = merge(folder, &names);
        assert_eq!(merged.status, 0, "{}", merged.stderr);
        assert!(tables(&folder.join("merged")) == tables(&folder.join("whole")));
    }
    other("foreign.jsonl", &text.replace("\"seed\":9", "\"seed\":8"));
    other("version.jsonl", &text.replace("\"version\":\"", "\"version\":\"9"));
    other("empty.jsonl", "");
    for (file, wanted) in [
        (None, "shard 1/3 is missing"),
        (Some("0.jsonl"), "repeats U0 of shard 0/3"),
        (Some("cut.jsonl"), "cut.jsonl, line 2: no whole line"),
        (Some("short.jsonl"), "short.jsonl is cut: 1 of the 2 lines of shard 1/3"),
        (Some("long.jsonl"), "long.jsonl repeats U1 of shard 1/3"),
        (Some("foreign.jsonl"), "is of another campaign"),
        (Some("version.jsonl"), "is of another version"),
        (Some("empty.jsonl"), "empty.jsonl is no shard"),
        (Some("whole/campaign.md"), "campaign.md is no shard"),
    ] {
        let answer = merge(folder, &["0.jsonl", "2.jsonl"].into_iter().chain(file).collect::<Vec<_>>());
        let words = answer.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(answer.status, 2, "{file:?}");
        assert!(words.contains(wanted), "{file:?}: {words}");
        assert!(
            tables(&folder.join("merged")) == tables(&folder.join("whole")),
            "what was there is unchanged"
        );
    }
}

#[test]
fn a_campaign_that_was_stopped_goes_on() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let folder = place.path();
    assert_eq!(validate(folder, &["--out", "@whole", "--jsonl", "@whole.jsonl"]).status, 0);
    let text = fs::read_to_string(folder.join("whole.jsonl")).expect("lines");
    assert!(text.lines().all(|line| line.starts_with("{\"campaign\":{\"schema\":\"dropcheck.scenes/1\"")));
    for end in [0, 100, text.find('\n').expect("a line") + 1, text.len() / 2, text.len()] {
        fs::write(folder.join("on.jsonl"), &text[..end]).expect("a temporary file");
        let answer = validate(folder, &["--out", "@on", "--jsonl", "@on.jsonl", "--resume"]);
        assert_eq!(answer.status, 0, "{}", answer.stderr);
        assert_eq!(fs::read_to_string(folder.join("on.jsonl")).expect("lines"), text);
        assert!(tables(&folder.join("on")) == tables(&folder.join("whole")));
    }
    let answer = validate(folder, &["--jsonl", "@on.jsonl", "--resume", "--exact"]);
    assert_eq!((answer.status, answer.stderr.contains("another campaign")), (2, true), "{}", answer.stderr);
    assert_eq!(fs::read_to_string(folder.join("on.jsonl")).expect("lines"), text);
    // Lines of another shard of it are not gone on with either.
    let other = |shard: &str, resume: &[&str]| {
        validate(folder, &[&["--shard", shard, "--jsonl", "@shard.jsonl"], resume].concat())
    };
    assert_eq!(other("1/3", &[]).status, 0);
    let answer = other("0/3", &["--resume"]);
    assert_eq!((answer.status, answer.stderr.contains("another shard")), (2, true), "{}", answer.stderr);
    let to_standard_output = validate(folder, &["--jsonl", "-"]);
    assert_eq!((to_standard_output.status, to_standard_output.stdout), (0, text));
}

#[test]
fn words_that_name_nothing_are_refused_with_what_there_is() {
    for (words, wanted) in [
        (&["validate", "--quick", "--campaign", "1"][..], "--campaign"),
        (&["validate", "--campaign", "1", "--kinds", "rust"], "clip_first"),
        (&["validate", "--campaign", "0"], "1..=1000000"),
        (&["validate", "--scene", "17", "--out", "x"], "D and a number"),
        (&["validate", "--scene", "D1"], "--out"),
        (&["validate", "--campaign", "1", "--shard", "0/2"], "--jsonl"),
        (&["validate", "--campaign", "1", "--shard", "2/2", "--jsonl", "-"], "0/3, 1/3"),
        (&["validate", "--shard", "0/2", "--jsonl", "-"], "--campaign"),
    ] {
        let answer = dropcheck(words);
        assert_eq!(answer.status, 2, "{words:?}");
        assert!(answer.stderr.contains(wanted), "{words:?}: {}", answer.stderr);
    }
}
