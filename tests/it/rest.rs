//! From a recording cut into the rest and the drop to the numbers of the whole, and from files that are no
//! rest of it to one message.

use crate::run::{Answer, analyze, dropcheck, number, words};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A drop from rest of which no correction is exact: calibrations, offsets and an axial channel.
const SCENE: &str = "\
name = \"cut\"
seed = 5
[cask]
mass_kg = 4466.0
length_m = 5.512
height_m = 0.792
[drop]
height_m = 9.0
angle_deg = 15.0
[contact]
friction = \"rough\"
[recording]
rest = true
before_s = 2.6
[[channel]]
name = \"A1\"
end = \"first\"
axis = \"transverse\"
sample_rate_hz = 10000
offset_g = 0.2
scale = 1.006
[[channel]]
name = \"A2\"
end = \"second\"
axis = \"transverse\"
sample_rate_hz = 10000
offset_g = -0.15
scale = 0.995
[[channel]]
name = \"B1\"
end = \"first\"
axis = \"axial\"
sample_rate_hz = 10000
";

/// A drop as CSV: whole, its rest and its last part, each with the cask file `drop.toml` beside it.
struct CutDrop {
    folder: tempfile::TempDir,
}

impl CutDrop {
    fn new() -> Self {
        let cut = Self { folder: tempfile::tempdir().expect("a temporary folder") };
        fs::write(cut.path("scene.toml"), SCENE).expect("a temporary file");
        let answer = dropcheck(words!["synth", cut.path("scene.toml"), "--out", cut.path("drop.csv")]);
        assert_eq!(answer.status, 0, "{}", answer.stderr);
        let whole = fs::read_to_string(cut.path("drop.csv")).expect("a table");
        let lines: Vec<&str> = whole.lines().collect();
        let first = lines.iter().position(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        let (head, rows) = lines.split_at(first.expect("a row"));
        // The fall of 1.355 s begins 1.245 s after the first sample.
        cut.write("rest.csv", &[head, &rows[..11_000]].concat());
        // Nearly all of the fall: another part of it has other noise.
        cut.write("late.csv", &[head, &rows[13_000..]].concat());
        cut
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, lines: &[&str]) {
        fs::write(self.path(name), lines.join("\n") + "\n").expect("a temporary file");
    }

    fn analyze(&self, recording: &str, rest: Option<&Path>) -> Answer {
        let mut words = vec![self.path(recording), "--cask".into(), self.path("drop.toml")];
        words.extend(rest.into_iter().flat_map(|rest| ["--rest".into(), rest.to_owned()]));
        dropcheck([PathBuf::from("analyze")].into_iter().chain(words).chain(["--json".into(), "-".into()]))
    }
}

fn untested(result: &Value) -> Vec<&str> {
    result["untested"].as_array().into_iter().flatten().filter_map(|row| row["key"].as_str()).collect()
}

#[test]
fn a_rest_of_its_own_gives_what_rest_in_the_recording_gives() {
    let cut = CutDrop::new();
    let whole = cut.analyze("drop.csv", None).json();
    let without = cut.analyze("late.csv", None).json();
    let with = cut.analyze("late.csv", Some(&cut.path("rest.csv"))).json();
    for quantity in ["/k", "/slap_down/speed"] {
        let get =
            |result: &Value, part: &str| number(result, &format!("{quantity}/{part}")).expect("a number");
        let apart = (get(&with, "value") - get(&whole, "value")) / get(&whole, "u95");
        assert!(apart.abs() < 0.1, "{quantity}: {apart} half-widths apart");
        // The length of the fall, too, is in the whole recording alone.
        let ratio = get(&with, "u95") / get(&whole, "u95");
        assert!((0.95..1.2).contains(&ratio), "{quantity}: {ratio}");
        assert!(get(&without, "u95") > 1.05 * get(&whole, "u95"), "{quantity}: rest tells nothing");
    }
    let calibration = "channel.A1.calibration_percent";
    assert!(untested(&without).contains(&calibration), "{:?}", untested(&without));
    assert!(!untested(&with).contains(&calibration), "{:?}", untested(&with));
    assert!(with["input"]["rest"].as_str().is_some_and(|path| path.ends_with("rest.csv")));
    assert_eq!(with["input"]["rest_sha256"].as_str().map(str::len), Some(64));
    assert_eq!(whole["input"].get("rest"), None);
}

#[test]
fn the_cask_file_names_the_rest_beside_it_and_the_run_can_be_repeated() {
    let cut = CutDrop::new();
    let by_option = cut.analyze("late.csv", Some(&cut.path("rest.csv"))).json();
    let cask = fs::read_to_string(cut.path("drop.toml")).expect("the cask file");
    fs::write(cut.path("drop.toml"), format!("[recording]\nrest = \"rest.csv\"\n{cask}")).expect("a file");
    let by_key = analyze(&cut.path("late.csv"), &cut.path("drop.toml"));
    assert_eq!(by_key.json()["k"], by_option["k"]);
    fs::write(cut.path("result.json"), &by_key.stdout).expect("a temporary file");
    let again = dropcheck(words!["analyze", cut.path("late.csv"), "--from", cut.path("result.json")]);
    assert!(again.stdout.contains("every number within 1e-9"), "{}{}", again.stdout, again.stderr);
}

#[test]
fn a_file_that_is_no_rest_of_these_sensors_is_refused() {
    let cut = CutDrop::new();
    let rest = fs::read_to_string(cut.path("rest.csv")).expect("a table");
    let lines: Vec<&str> = rest.lines().collect();
    // The fall itself, which moves by 1 g in its middle; a tenth of the rows; a twentieth of a second.
    let whole = fs::read_to_string(cut.path("drop.csv")).expect("a table");
    let fall: Vec<&str> = whole.lines().take(25_000).collect();
    cut.write("moves.csv", &fall);
    let head = lines.len() - 11_000;
    let slow: Vec<&str> = lines[..head].iter().chain(lines[head..].iter().step_by(10)).copied().collect();
    cut.write("slow.csv", &slow);
    cut.write("short.csv", &lines[..head + 500]);
    for (file, words) in [
        ("moves.csv", "does not rest"),
        ("slow.csv", "1000 Hz in this file"),
        ("short.csv", "shorter than 0.1 s"),
        ("none.csv", "No such file"),
    ] {
        let answer = cut.analyze("late.csv", Some(&cut.path(file)));
        assert_eq!(answer.status, 2, "{file}: {}", answer.stderr);
        assert!(answer.stderr.contains(words) && answer.stderr.contains(file), "{file}: {}", answer.stderr);
    }
}
