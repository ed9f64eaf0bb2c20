//! From what a user does first, and forgets, to what the program says.

use crate::run::{dropcheck, fixture, words};
use std::fs;
use std::time::Duration;

/// No run of these takes a second; one that waits for itself waits for ever.
const PATIENCE: Duration = Duration::from_mins(1);

#[test]
fn one_message_names_every_blank_of_a_cask_file_and_the_last_one_has_an_example() {
    let folder = tempfile::tempdir().expect("a folder");
    let (recording, cask) = (fixture("anf18-json.mcap"), folder.path().join("cask.toml"));
    let mut form = dropcheck(words!["init", recording]).stdout;
    let refused = |form: &str| {
        fs::write(&cask, form).expect("a cask file");
        let answer = dropcheck(words!["analyze", recording, "--cask", cask]);
        assert_eq!(answer.status, 2, "{}", answer.stdout);
        answer.stderr.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
    };
    let line = |form: &str, open: &str, nth: usize| {
        let lines = form.lines().enumerate().filter(|(_, line)| line.starts_with(open));
        lines.map(|(i, _)| i + 1).nth(nth).expect(open)
    };
    let said = refused(&form);
    assert!(said.contains("11 values are still to be filled in: [cask] mass_kg"), "{said}");
    let blanks = [("mass_kg", 0), ("length_m", 0), ("height_m", 0), ("height_m", 1), ("angle_deg", 0)];
    let of_channels = ["end", "axis", "position_m"].into_iter().flat_map(|key| [(key, 0), (key, 1)]);
    for (key, nth) in blanks.into_iter().chain(of_channels) {
        let named = format!("{key} (line {})", line(&form, &format!("{key} = "), nth));
        assert!(said.contains(&named), "{named}: {said}");
    }
    // A key that is deleted is asked for like one that is open.
    assert!(refused(&form.replacen("mass_kg = nan", "", 1)).contains("mass_kg (missing)"));
    let answers = [
        ("mass_kg = nan", "mass_kg = 4466.0", ["is nan", "dropcheck init"]),
        ("end = \"FILL IN\"", "end = \"first\"", ["is still to be filled in", "write what it is, such as"]),
        ("length_m = nan", "length_m = 5.512", [""; 2]),
        ("height_m = nan", "height_m = 0.792", [""; 2]),
        ("height_m = nan", "height_m = 9.0", [""; 2]),
        ("angle_deg = nan", "angle_deg = 15.0", [""; 2]),
        ("axis = \"FILL IN\"", "axis = \"transverse\"", [""; 2]),
        ("position_m = nan", "position_m = 0.156", [""; 2]),
        ("end = \"FILL IN\"", "end = \"second\"", [""; 2]),
        ("axis = \"FILL IN\"", "axis = \"transverse\"", [""; 2]),
        ("position_m = nan", "position_m = 5.356", [""; 2]),
    ];
    form = answers.iter().fold(form, |form, (open, value, _)| form.replacen(open, value, 1));
    for (open, value, words) in answers.iter().take(2) {
        let (at, said) = (line(&form, value, 0), refused(&form.replacen(value, open, 1)));
        for word in [&format!("line {at}:")[..]].iter().chain(words) {
            assert!(said.contains(word), "{open}: {word}: {said}");
        }
    }
    fs::write(&cask, form).expect("a cask file");
    let answer = dropcheck(words!["analyze", recording, "--cask", cask]);
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
    let filled = form.replace("mass_kg = nan", "mass_kg = 100").replace("= nan ", "= 1 ");
    fs::write(&cask, filled).expect("a cask file");
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
