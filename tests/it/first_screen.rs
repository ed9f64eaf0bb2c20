//! The first screen, and what it says that nothing in the recording tests.

use crate::run::root;
use serde_json::Value;
use std::process::{Command, Output};

fn analyze(recording: &str, cask: &str, more: &[&str]) -> Output {
    let examples = root().join("fixtures/examples");
    Command::new(env!("CARGO_BIN_EXE_dropcheck"))
        .env("NO_COLOR", "1")
        .arg("analyze")
        .arg(examples.join(recording))
        .arg("--cask")
        .arg(examples.join(cask))
        .args(more)
        .output()
        .expect("the program runs")
}

fn untested(recording: &str, cask: &str) -> Vec<String> {
    let output = analyze(recording, cask, &["--json", "-"]);
    let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let all = result["untested"].as_array().expect("a list");
    all.iter().map(|input| input["key"].as_str().expect("a key").to_owned()).collect()
}

#[test]
fn every_example_has_its_word_and_its_numbers_on_ten_lines() {
    let folder = root().join("fixtures/examples");
    let mut seen = 0;
    for entry in std::fs::read_dir(&folder).expect("the examples") {
        let path = entry.expect("an entry").path();
        let cask = path.with_extension("toml");
        let is_recording = path.extension().is_some_and(|e| e == "mcap" || e == "h5" || e == "csv");
        if !is_recording || !cask.exists() {
            continue;
        }
        let name = |path: &std::path::Path| path.file_name().expect("a name").to_string_lossy().into_owned();
        let output = analyze(&name(&path), &name(&cask), &[]);
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        let lines: Vec<&str> = text.lines().collect();
        assert!((5..=10).contains(&lines.len()) && !text.contains('…'), "{}: {text}", path.display());
        assert!(lines.iter().all(|line| line.chars().count() <= 80), "{text}");
        assert!(
            ["DATA SOUND", "REVIEW", "PARTLY USABLE", "NOT TO BE USED"]
                .iter()
                .any(|word| lines[0].starts_with(word))
        );
        for row in ["Slap-down speed ", "Restitution k "] {
            assert!(lines.iter().any(|line| line.starts_with(row)), "{row}: {text}");
        }
        // No line ends between a number and its unit.
        let ends = |line: &&str| line.ends_with('±') || line.ends_with(|c: char| c.is_ascii_digit());
        let begins =
            |line: &str| ["%", "±", "m/s", "g ", "mm", "ms"].iter().any(|unit| line.starts_with(unit));
        for pair in lines.windows(2) {
            assert!(!(ends(&pair[0]) && begins(pair[1].trim_start())), "{text}");
        }
        seen += 1;
    }
    assert!(seen >= 10, "{seen}");
}

#[test]
fn two_channels_without_rest_leave_their_scales_places_and_the_height_untested() {
    let found = untested("anf18-json.mcap", "anf18-json.toml");
    for key in [
        "channel.A1.calibration_percent",
        "channel.A1.position_m",
        // Linearity up to the peak.
        "channel.A1.full_scale",
        "drop.height_m",
        "cask.length_m",
    ] {
        assert!(found.iter().any(|k| k == key), "{key}: {found:?}");
    }
    let strict = analyze("anf18-json.mcap", "anf18-json.toml", &["--strict"]);
    assert_eq!(strict.status.code(), Some(1));
    let said = String::from_utf8_lossy(&strict.stderr).into_owned();
    assert!(said.contains("--strict: ") && said.contains("untested inputs"), "{said}");
}

#[test]
fn a_recorded_rest_tests_the_height_and_the_clock() {
    let found = untested("vhlw-rest.h5", "vhlw-rest.toml");
    for key in ["drop.height_m", "tolerance.clock_percent"] {
        assert!(found.iter().all(|k| k != key), "{key}: {found:?}");
    }
}
