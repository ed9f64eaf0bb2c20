//! From what a user does first, and forgets, to what the program says.

use crate::run::{dropcheck, fixture, words};
use std::fs;
use std::time::Duration;

/// No run of these takes a second; one that waits for itself waits for ever.
const PATIENCE: Duration = Duration::from_mins(1);

#[test]
fn a_form_that_is_not_filled_in_is_refused_by_its_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let (recording, cask) = (fixture("anf18-json.mcap"), folder.path().join("cask.toml"));
    let analyze = || dropcheck(words!["analyze", recording, "--cask", cask]);
    let mut form = dropcheck(words!["init", recording]).stdout;
    let words = ["is still to be filled in", "write what it is, such as"];
    let (number, word) = (("nan", ["is nan", "dropcheck init"]), ("\"FILL IN\"", words));
    let answers = [
        ("mass_kg", "4466.0", number),
        ("length_m", "5.512", number),
        ("height_m", "9.0", number),
        ("angle_deg", "15.0", number),
        ("end", "\"first\"", word),
        ("axis", "\"transverse\"", word),
        ("position_m", "0.156", number),
        ("end", "\"second\"", word),
        ("axis", "\"transverse\"", word),
        ("position_m", "5.356", number),
    ];
    for (key, value, (left, words)) in answers {
        fs::write(&cask, &form).expect("a cask file");
        let answer = analyze();
        let open = format!("{key} = {left}");
        let line = 1 + form.lines().position(|l| l.starts_with(&open)).expect(key);
        assert_eq!(answer.status, 2, "{key}: {}", answer.stdout);
        for word in [format!("line {line}:"), key.to_owned()].into_iter().chain(words.map(str::to_owned)) {
            assert!(answer.stderr.contains(&word), "{word}: {}", answer.stderr);
        }
        form = form.replacen(&open, &format!("{key} = {value}"), 1);
    }
    fs::write(&cask, form).expect("a cask file");
    let answer = analyze();
    assert!(answer.status <= 1, "{}", answer.stderr);
}

#[test]
fn a_unit_that_nobody_says_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let (recording, cask) = (folder.path().join("raw.csv"), folder.path().join("cask.toml"));
    let rows: Vec<String> = (0..400).map(|i| format!("0.{i:04},{},7", i % 9)).collect();
    let table = format!("time_s,first_transverse,n\n{}\n", rows.join("\n"));
    fs::write(&recording, table).expect("a recording");
    let form = dropcheck(words!["init", recording]).stdout;
    assert!(form.contains("unit = \"FILL IN\"") && form.contains("end = \"first\""), "{form}");
    fs::write(&cask, form.replace("= nan ", "= 1 ")).expect("a cask file");
    let answer = dropcheck(words!["analyze", recording, "--cask", cask]);
    let told = answer.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in ["unit is \"FILL IN\"", "is still to be filled in", "unit = \"g\", \"m/s^2\""] {
        assert!(told.contains(part), "{part}: {told}");
    }
    assert_eq!(answer.status, 2);
}

#[test]
fn a_report_goes_into_the_folder_that_one_stands_in() {
    for out in [".", "./", "../here"] {
        let folder = tempfile::tempdir().expect("a folder");
        let here = folder.path().join("here");
        fs::create_dir(&here).expect("a folder");
        let assert = assert_cmd::Command::new(env!("CARGO_BIN_EXE_dropcheck"))
            .args(["predict", "--out", out, "--cask"])
            .arg(fixture("anf18-json.toml"))
            .current_dir(&here)
            .timeout(PATIENCE)
            .assert();
        assert.success();
        assert!(here.join("prediction.json").is_file(), "{out}");
    }
}

#[test]
fn a_campaign_into_the_folder_it_reads_can_be_repeated() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::copy(fixture("anf18-json.mcap"), folder.path().join("drop.mcap")).expect("a recording");
    let cask = fixture("anf18-json.toml");
    for _ in 0..2 {
        let answer = dropcheck(words!["batch", folder.path(), "--cask", cask, "--out", folder.path()]);
        assert!(answer.status <= 1, "{}{}", answer.stdout, answer.stderr);
    }
    let table = fs::read_to_string(folder.path().join("campaign.csv")).expect("a table");
    assert_eq!(table.lines().count(), 2, "one recording: {table}");
}
