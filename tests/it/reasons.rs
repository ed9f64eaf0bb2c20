//! Recordings with a harmless finding beside one that takes numbers away, to the reason that is shown.

use crate::run::{dropcheck, fixture, fixtures, read_json, words};
use dropcheck::data::{DropResult, ResultPart, Severity};
use dropcheck::{ingest, stages};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// An example and its cask file with another drop angle, the recording without its last bytes.
fn otherwise(folder: &Path, name: &str, angle_deg: f64, without: usize) -> [PathBuf; 2] {
    let recording = fixture(name);
    let stated = fs::read_to_string(recording.with_extension("toml")).expect("a cask file");
    let is_angle = |line: &&str| line.starts_with("angle_deg");
    let angle = stated.lines().find(is_angle).expect("an angle");
    let paths = [folder.join(name), folder.join(name).with_extension("toml")];
    let bytes = fs::read(&recording).expect("a recording");
    fs::write(&paths[0], &bytes[..bytes.len() - without]).expect("room");
    fs::write(&paths[1], stated.replacen(angle, &format!("angle_deg = {angle_deg}"), 1)).expect("room");
    paths
}

#[test]
fn a_wrong_angle_is_the_reason_whatever_harmless_warning_stands_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, angle_deg, without, harmless) in [
        ("damaged-zero-shift.h5", 21.0, 0, "zero_shift"),
        ("damaged-gap.mcap", 22.0, 0, "gap"),
        ("damaged-truncated.mcap", 27.0, 0, "truncated"),
        ("anf18-json.mcap", 20.0, 1500, "truncated"),
    ] {
        let [recording, cask] = otherwise(folder.path(), name, angle_deg, without);
        let out = folder.path().join("out");
        let answer =
            dropcheck(words!["analyze", recording, "--cask", cask, "--full", "--force", "--out", out]);
        assert_eq!(answer.status, 1, "{name}: {}", answer.stderr);
        let result = read_json(&out.join("result.json"));
        let quality = result["quality"].as_array().expect("findings");
        let with_code = |code: &str| quality.iter().find(|f| f["code"] == code && f["severity"] == "warning");
        let beside = with_code(harmless).unwrap_or_else(|| panic!("{name}: {result}"));
        assert_eq!(beside["takes"], Value::Array(Vec::new()), "{name}: {beside}");
        for place in ["k", "slap_down.speed", "first_impact.duration", "impacts[0].crush", "comparison"] {
            let missing = result["missing"].as_array().expect("a list");
            let own = missing.iter().find(|m| m["quantity"] == place).expect(place);
            let took = &result.pointer(&format!("/quality/{}", own["because"])).expect("a finding");
            assert_eq!((&took["code"], &took["takes"][0]), (&"geometry".into(), &"motion".into()), "{name}");
        }
        let one_line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let page = one_line(&fs::read_to_string(out.join("report.html")).expect("a page"));
        let words = |finding: &Value| one_line(&finding["message"].as_str().expect("words")[..30]);
        let screen = one_line(&answer.stdout.replace('−', "-"));
        let (harmless, page) = (words(beside), page.replace('−', "-"));
        assert!(
            screen.contains("Not determined: k and the slap-down speed. The second end would be"),
            "{screen}"
        );
        for said in [&screen, &page] {
            assert!(said.contains("not determined: the second end would be"), "{name}: {said}");
            assert!(!said.contains(&format!("determined: {harmless}")), "{name}: {said}");
        }
    }
}

/// Every quantity of the first impact, the slap-down and both impacts that is null, by its place.
fn nulls(value: &Value, place: &str, found: &mut Vec<String>) {
    match value {
        Value::Null => found.push(place.to_owned()),
        Value::Object(all) => {
            all.iter().for_each(|(key, part)| nulls(part, &format!("{place}.{key}"), found));
        }
        Value::Array(all) => {
            all.iter().enumerate().for_each(|(i, part)| nulls(part, &format!("{place}[{i}]"), found));
        }
        _ => {}
    }
}

/// Holds what is missing to the findings; returns the codes of what took a number beside what took none.
fn hold(result: &DropResult, name: &str) -> Vec<[String; 2]> {
    let json: Value = serde_json::to_value(result).expect("JSON");
    let mut found = Vec::new();
    for part in ["first_impact", "slap_down", "k", "amplification", "impacts", "comparison"] {
        nulls(&json[part], part, &mut found);
    }
    let mut named: Vec<&str> = result.missing.iter().map(|missing| &missing.quantity[..]).collect();
    named.sort_unstable();
    found.sort_unstable();
    assert_eq!(named, found, "{name}");
    let mut pairs = Vec::new();
    for missing in &result.missing {
        let Some(took) = missing.because.map(|place| &result.quality[place]) else {
            assert!(missing.reason.is_some(), "{name}: {missing:?}");
            continue;
        };
        assert!(!took.effect.parts().is_empty(), "{name}: {missing:?} by {took:?}");
        let code = |word: Value| word.as_str().expect("a code").to_owned();
        let beside =
            result.quality.iter().filter(|f| f.severity > Severity::Note && !f.removes(ResultPart::Motion));
        let pair = |other: &dropcheck::data::Finding| {
            [took, other].map(|f| code(serde_json::to_value(f.code).expect("a code")))
        };
        pairs.extend(beside.filter(|f| f.effect.parts().is_empty()).map(pair));
    }
    pairs
}

#[test]
fn whatever_an_example_lacks_has_the_finding_that_took_it_or_a_reason() {
    ingest::read_hdf5_with(Path::new(env!("CARGO_BIN_EXE_dropcheck")));
    let mut pairs = Vec::new();
    for cask in crate::run::files_below(&fixtures().join("examples"), "toml") {
        let recording =
            ["mcap", "h5", "csv"].map(|end| cask.with_extension(end)).into_iter().find(|p| p.exists());
        let Some(recording) = recording else { continue };
        for off_rad in [0.0, 0.1] {
            let mut file = ingest::cask_file(&cask).expect("a cask file");
            file.drop.angle_rad += off_rad;
            let read = dropcheck::read(&recording, &file, &|_| ()).expect("a recording");
            let mut result = stages::measure(&read, &file).result;
            result.find_missing();
            pairs.extend(hold(&result, &cask.display().to_string()));
        }
    }
    pairs.sort();
    pairs.dedup();
    for harmless in ["gap", "truncated", "zero_shift"] {
        assert!(pairs.contains(&["geometry".into(), harmless.into()]), "{harmless}: {pairs:?}");
    }
}
