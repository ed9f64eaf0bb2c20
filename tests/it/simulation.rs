//! A calculation beside the test, made of the true curve: laid over the recording, rated, or refused.

use crate::command_line::{Bench, at_fault};
use crate::run::{analyze, dropcheck, fixture, words};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

/// A drop, and what its sensors read without noise and filters.
struct Drop {
    bench: Bench,
    recording: PathBuf,
    cask: String,
    /// Time, A1 and A2, s and g.
    truth: Vec<[f64; 3]>,
}

/// What a calculation makes of the truth.
#[derive(Clone, Copy)]
struct Changes {
    scale: f64,
    late_s: f64,
    level_g: f64,
    /// Every so many of its values.
    each: usize,
}

const NONE: Changes = Changes { scale: 1.0, late_s: 0.0, level_g: 0.0, each: 1 };

impl Drop {
    fn new() -> Self {
        let bench = Bench::new();
        let scene = fs::read_to_string(fixture("scene-anf18.toml")).expect("the example scene");
        let is_chain = |line: &&str| {
            let chain = ["full_scale", "bits", "anti_alias", "resonance", "offset", "pink", "cross", "clock"];
            !chain.iter().any(|key| line.starts_with(key))
        };
        let ideal = scene.lines().filter(is_chain).collect::<Vec<_>>().join("\n");
        let ideal = ideal.replace("white_noise_g = 0.1", "white_noise_g = 0.0");
        let [recording, pure] =
            [("drop", scene), ("ideal", ideal)].map(|(name, scene)| bench.synth(name, scene));
        let cask = fs::read_to_string(recording.with_extension("toml")).expect("a cask file");
        let row = |line: &str| {
            let cells: Vec<f64> = line.split(',').map_while(|cell| cell.parse().ok()).collect();
            <[f64; 3]>::try_from(cells).ok()
        };
        let truth: Vec<_> = fs::read_to_string(pure).expect("a table").lines().filter_map(row).collect();
        assert!(truth.len() > 1000);
        Self { bench, recording, cask, truth }
    }

    /// What `analyze` says where the cask file ends so.
    fn with(&self, simulation: &str) -> crate::run::Answer {
        let cask = self.bench.put("cask.toml", format!("{}\n{simulation}\n", self.cask));
        analyze(&self.recording, &cask)
    }

    /// Writes a calculation of A1 and A2, from ten milliseconds before anything moves on.
    fn calculate(&self, name: &str, changes: Changes) {
        let mut table = "t_s;N1_az;N2_az\n".to_owned();
        let begins = self.truth.iter().position(|row| row[1].abs() > 1.0).expect("an impact") - 250;
        for [time_s, first, second] in self.truth[begins..].iter().step_by(changes.each) {
            let time_s = time_s - self.truth[begins][0] + changes.late_s;
            let [first, second] = [first, second].map(|g| changes.level_g + changes.scale * g);
            writeln!(table, "{time_s:.6};{first:.5};{second:.5}").expect("a text");
        }
        self.bench.put(name, table);
    }

    fn calculated(&self, changes: Changes) -> Value {
        self.calculate("fe.csv", changes);
        self.with(BOTH).json()
    }
}

const BOTH: &str = "[simulation]\nfile = \"fe.csv\"\ntime = \"t_s\"\nunit = \"g\"\n\
                    channels = { A1 = \"N1_az\", A2 = \"N2_az\" }";

/// The rows of the result: of A1 acceleration and velocity, then of A2.
fn rows(result: &Value) -> [&Value; 4] {
    let rows: Vec<&Value> = result["simulation"].as_array().expect("rows").iter().collect();
    rows.try_into().unwrap_or_else(|_| panic!("{} {}", result["simulation"], result["quality"]))
}

fn at(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key} of {row}"))
}

#[test]
fn the_true_curve_is_rated_near_one_and_a_wrong_one_lower() {
    let drop = Drop::new();
    let truth = drop.calculated(NONE);
    let plain = drop.with("").json();
    for key in ["k", "slap_down", "impacts", "verdict", "flight"] {
        assert_eq!(plain[key], truth[key], "a calculation moves no number: {key}");
    }
    assert_eq!(plain["simulation"], serde_json::json!([]));
    assert_eq!(truth["input"]["simulation_sha256"].as_str().map(str::len), Some(64));
    let contact_s = at(&truth["events"], "first_contact_s");
    for row in rows(&truth) {
        assert!(at(row, "rating") > 0.97, "{row}");
        assert!(at(row, "peak_difference").abs() < 0.02, "{row}");
        // The file begins ten milliseconds before A1 moves.
        assert!((at(row, "shift_s") + 0.01 - contact_s).abs() < 5e-4, "{row}, contact at {contact_s}");
    }
    let names: Vec<_> = rows(&truth).map(|row| [&row["channel"], &row["quantity"]]).to_vec();
    let both = |channel: &str| ["acceleration", "velocity"].map(|what| [Value::from(channel), what.into()]);
    assert_eq!(names, [both("A1"), both("A2")].concat().iter().map(|[a, b]| [a, b]).collect::<Vec<_>>());

    // Another zero of its times and a level before contact are no fault of a calculation.
    let other = drop.calculated(Changes { late_s: 0.3, level_g: -1.0, ..NONE });
    for (row, alike) in rows(&truth).into_iter().zip(rows(&other)) {
        assert!((at(row, "rating") - at(alike, "rating")).abs() < 0.005, "{row} {alike}");
    }

    let scaled = drop.calculated(Changes { scale: 1.3, ..NONE });
    for (row, lower) in rows(&truth).into_iter().zip(rows(&scaled)) {
        assert!(at(lower, "rating") < at(row, "rating") - 0.1, "{row} {lower}");
        assert!(at(lower, "magnitude") < at(row, "magnitude") - 0.1, "{row} {lower}");
    }
    for row in [0, 2].map(|place| rows(&scaled)[place]) {
        assert!((at(row, "peak_difference") - 0.3).abs() < 0.03, "{row}");
    }
}

#[test]
fn a_slower_calculation_loses_phase_and_slope() {
    let mut drop = Drop::new();
    let truth = drop.calculated(NONE);
    // Everything after the beginning takes a tenth longer.
    let begins_s = drop.truth[0][0];
    drop.truth.iter_mut().for_each(|row| row[0] = begins_s + 1.1 * (row[0] - begins_s));
    let slow = drop.calculated(NONE);
    for (row, lower) in rows(&truth).into_iter().zip(rows(&slow)) {
        assert!(at(lower, "rating") < at(row, "rating") - 0.1, "{row} {lower}");
        assert!(at(lower, "phase") < 1.0 && at(lower, "slope") < at(row, "slope"), "{row} {lower}");
    }
}

#[test]
fn the_report_draws_the_calculated_curve_and_tabulates_both() {
    let drop = Drop::new();
    drop.calculate("fe.csv", Changes { scale: 1.1, ..NONE });
    let cask = drop.bench.put("cask.toml", format!("{}\n{BOTH}\n", drop.cask));
    let out = drop.bench.0.path().join("report");
    let answer = dropcheck(words!["analyze", drop.recording, "--cask", cask, "--out", out, "--full"]);
    assert!(answer.status < 2, "{}", answer.stderr);
    for words in ["Calculation beside the test", "are shifted by", "A2, second impact: peak"] {
        assert!(answer.stdout.contains(words), "{words}: {}", answer.stdout);
    }
    for picture in ["accelerations.svg", "impacts.svg", "velocities.svg"] {
        let svg = fs::read_to_string(out.join(picture)).expect("a picture");
        assert!(["A1 calculated", "A2 calculated"].iter().all(|name| svg.contains(name)), "{picture}");
    }
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(
        ["Ratings by ISO/TS 18571 of", "SHA-256 of the calculation"].iter().all(|said| page.contains(said))
    );
}

#[test]
fn a_calculation_that_cannot_be_laid_over_is_not_rated_and_says_why() {
    let drop = Drop::new();
    let said = |result: &Value| {
        assert_eq!(result["simulation"], serde_json::json!([]));
        let all = result["quality"].as_array().expect("findings");
        let own = all.iter().find(|finding| finding["code"] == "simulation").expect("a finding");
        own["message"].as_str().expect("a sentence").to_owned()
    };
    let tiny = said(&drop.calculated(Changes { scale: 0.001, ..NONE }));
    assert!(tiny.contains("never reaches a tenth of the first peak measured"), "{tiny}");
    let coarse = said(&drop.calculated(Changes { each: 50, ..NONE }));
    assert!(coarse.contains("do not carry the low-pass"), "{coarse}");
    let level = said(&drop.calculated(Changes { level_g: 500.0, ..NONE }));
    assert!(level.contains("begins within its first impact"), "{level}");
}

#[test]
fn a_wrong_key_of_a_calculation_is_one_message_that_names_what_there_is() {
    let drop = Drop::new();
    drop.calculate("fe.csv", NONE);
    for (from, to, said) in [
        ("fe.csv", "of.csv", &["of.csv", "no such file"][..]),
        ("N2_az", "N3_az", &["fe.csv", "A2", "N3_az", "N1_az", "N2_az"]),
        ("\"t_s\"", "\"time\"", &["fe.csv", "time", "t_s"]),
        ("\"g\"", "\"mm\"", &["unit cannot be", "m/s^2"]),
        ("A2 =", "A9 =", &["channels names A9", "there is: A1, A2"]),
        ("N2_az", "N1_az", &["same column as A1"]),
        ("{ A1 = \"N1_az\", A2 = \"N2_az\" }", "\"N1_az\"", &["channels is", "channels = { A2"]),
        ("file = \"fe.csv\"", "", &["[simulation] has no file"]),
        ("unit = \"g\"", "", &["[simulation] has no unit", "unit = \"m/s^2\""]),
        ("file =", "path =", &["[simulation] knows no key path", "file, time, unit, channels"]),
    ] {
        assert!(BOTH.contains(from), "{from}");
        at_fault(&drop.with(&BOTH.replace(from, to)), said);
    }
}

#[test]
fn the_curves_of_another_test_are_laid_over_this_one() {
    let drop = Drop::new();
    let (cask, out) = (drop.bench.put("first.toml", &drop.cask), drop.bench.0.path().join("first"));
    assert_eq!(dropcheck(words!["analyze", drop.recording, "--cask", cask, "--out", out]).status, 0);
    for (file, unit, columns) in [
        ("curves.csv", "g", ["A1_raw_g", "A2_raw_g"]),
        ("curves.h5", "m/s^2", ["/channels/A1/raw", "/channels/A2/raw"]),
    ] {
        let [first, second] = columns;
        let result = drop.with(&format!(
            "[simulation]\nfile = \"first/{file}\"\nunit = \"{unit}\"\n\
             channels = {{ A1 = \"{first}\", A2 = \"{second}\" }}"
        ));
        assert!(rows(&result.json()).into_iter().all(|row| at(row, "rating") > 0.99), "{file}");
    }
}
