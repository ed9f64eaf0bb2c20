//! From a scene file to a recording, its cask file and its truth, and through `analyze` back to the truth.

use crate::run::{Answer, analyze, dropcheck, fixture, number, read_json};
use std::fs;
use std::path::{Path, PathBuf};

fn synth(scene: &Path, out: &Path, more: &[&str]) -> Answer {
    let words = [Path::new("synth"), scene, Path::new("--out"), out].map(|p| p.as_os_str().to_owned());
    dropcheck(words.into_iter().chain(more.iter().map(Into::into)))
}

#[track_caller]
fn made(scene: &Path, out: &Path, more: &[&str]) {
    let answer = synth(scene, out, more);
    assert_eq!(answer.status, 0, "{}", answer.stderr);
}

fn example() -> PathBuf {
    fixture("scene-anf18.toml")
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// The example with `from` replaced by `to`, in `folder`.
#[track_caller]
fn example_with(folder: &Path, from: &str, to: &str) -> PathBuf {
    let text = fs::read_to_string(example()).expect("the example scene");
    assert!(text.contains(from), "the example has no {from:?}");
    let path = folder.join("scene.toml");
    fs::write(&path, text.replacen(from, to, 1)).expect("a temporary file");
    path
}

/// `analyze` gives the truth beside the recording, and says so.
#[track_caller]
fn holds(out: &Path) -> serde_json::Value {
    let answer = analyze(out, &out.with_extension("toml"));
    let result = answer.json();
    let truth = read_json(&out.with_extension("truth.json"));
    let value = |pointer| number(&result, pointer).unwrap_or_else(|| panic!("no {pointer}: {result}"));
    let true_value = |pointer| number(&truth, pointer).unwrap_or_else(|| panic!("no {pointer}: {truth}"));
    let speed = value("/slap_down/speed/value") / true_value("/speed");
    assert!((speed - 1.0).abs() < 0.01, "{}: speed off by {:.2} %", out.display(), 100.0 * (speed - 1.0));
    let k = value("/k/value") - true_value("/k");
    assert!(k.abs() < 0.03, "{}: k off by {k}", out.display());
    let contact_s = value("/first_impact/time/value") - true_value("/t_impact");
    // A tenth of a millisecond is two to three samples.
    assert!(contact_s.abs() < 1e-4, "{}: first contact off by {contact_s} s", out.display());
    result
}

/// A force that stays at the corner, and one that moves inward by as much as the target cuts into the cask,
/// are both well within the stated interval.
#[test]
fn a_force_may_move_inward_as_a_corner_crushes() {
    let folder = folder();
    for footprint in ["0.0", "1.8"] {
        let end = format!("pulse_ms = 25.0\nk = 0.3\nfootprint = {footprint}");
        let scene = example_with(folder.path(), "pulse_ms = 5.0\nk = 0.55", &end);
        let text = fs::read_to_string(&scene).expect("the scene");
        fs::write(&scene, text.replace("\"rough\"", "0.4")).expect("a temporary file");
        let out = folder.path().join(format!("moves-{}.mcap", footprint.replace('.', "-")));
        made(&scene, &out, &[]);
        let cask = out.with_extension("toml");
        let text = fs::read_to_string(&cask).expect("the cask file");
        fs::write(&cask, text.replace("friction = 0.4", "friction = \"unknown\"")).expect("a temporary file");
        let result = analyze(&out, &cask).json();
        let value =
            |of: &str| number(&result, &format!("/slap_down/horizontal_velocity/{of}")).expect("stated");
        let truth = number(&read_json(&out.with_extension("truth.json")), "/vx").expect("a truth");
        let off = (value("value") - truth) / value("u95");
        // By the corner alone it is 0.7 of the half-width off where the force moves.
        assert!(off.abs() < 0.5, "{footprint}: {off} half-widths off");
    }
}

#[test]
fn the_example_comes_back_from_every_format() {
    let folder = folder();
    for (name, more) in [
        ("json.mcap", &[][..]),
        ("protobuf.mcap", &["--encoding", "protobuf"]),
        ("set.h5", &[]),
        ("table.csv", &[]),
    ] {
        let out = folder.path().join(name);
        made(&example(), &out, more);
        let result = holds(&out);
        assert_eq!(result["verdict"], "pass", "{name}: {}", result["quality"]);
    }
}

#[test]
fn an_ac_coupled_channel_is_not_asked_for_rest_and_fall() {
    let folder = folder();
    let scene = example_with(folder.path(), "before_s = 0.1", "before_s = 2.0\nrest = true");
    let text = fs::read_to_string(&scene).expect("the scene");
    let coupled = "name = \"A1\"\ncoupling = \"ac\"\ntime_constant_s = 0.318";
    fs::write(&scene, text.replacen("name = \"A1\"", coupled, 1)).expect("a temporary file");
    let out = folder.path().join("ac.mcap");
    made(&scene, &out, &[]);
    let result = holds(&out);
    let codes: Vec<&str> = result["quality"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|issue| issue["code"].as_str())
        .collect();
    assert!(!codes.contains(&"scale") && !codes.contains(&"geometry"), "{}", result["quality"]);
}

#[test]
fn six_lines_are_a_scene_that_comes_back() {
    let folder = folder();
    let scene = folder.path().join("short.toml");
    let text = "[cask]\nmass_kg = 1429\nlength_m = 4.725\n[drop]\nheight_m = 9\nangle_deg = 20\n";
    fs::write(&scene, text).expect("a temporary file");
    let answer = dropcheck([Path::new("synth").as_os_str(), scene.as_os_str()]);
    assert_eq!(answer.status, 0, "{}", answer.stderr);
    assert!(answer.stdout.contains("short-synth.truth.json"), "{}", answer.stdout);
    assert_eq!(fs::read_to_string(&scene).expect("the scene"), text);
    holds(&folder.path().join("short-synth.mcap"));
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_others() {
    let folder = folder();
    for (ending, more) in [("mcap", &[][..]), ("mcap", &["--encoding", "protobuf"]), ("csv", &[])] {
        let out = folder.path().join(format!("drop.{ending}"));
        let bytes = |seed: &str| {
            made(&example(), &out, &[more, &["--seed", seed]].concat());
            fs::read(&out).expect("the recording")
        };
        assert!(bytes("5") == bytes("5"), "{ending}");
        assert!(bytes("5") != bytes("6"), "{ending}");
    }
}

#[test]
fn polarity_unit_and_skew_are_read_as_they_are_stated() {
    let folder = folder();
    let scene = example_with(
        folder.path(),
        "full_scale = 2000.0     # g",
        "full_scale = 19613.3\nunit = \"m/s^2\"\npolarity = -1\nskew_ms = 0.2",
    );
    for name in ["a.mcap", "a.h5", "a.csv"] {
        let out = folder.path().join(name);
        made(&scene, &out, &[]);
        let truth = read_json(&out.with_extension("truth.json"));
        let result = analyze(&out, &out.with_extension("toml")).json();
        let speed = number(&result, "/slap_down/speed/value").expect("a speed");
        assert!((speed / number(&truth, "/speed").expect("a truth") - 1.0).abs() < 0.01, "{name}: {speed}");
        // A1 says when L touches, and it is stamped 0.2 ms late.
        let late_s = number(&result, "/first_impact/time/value").expect("a time")
            - number(&truth, "/t_impact").expect("a time");
        assert!((late_s - 2e-4).abs() < 1e-4, "{name}: {late_s} s");
    }
}

#[test]
fn a_gap_is_found_in_every_format() {
    let folder = folder();
    let scene = example_with(folder.path(), "offset_g = -0.15", "gaps_s = [[0.13, 0.135]]");
    for name in ["a.mcap", "a.h5", "a.csv"] {
        let out = folder.path().join(name);
        made(&scene, &out, &[]);
        let result = analyze(&out, &out.with_extension("toml")).json();
        let quality = result["quality"].as_array().expect("a list");
        let found = quality.iter().any(|issue| {
            ["gap", "non_finite"].iter().any(|code| issue["code"] == *code) && issue["channel"] == "A2"
        });
        assert!(found, "{name}: {quality:?}");
    }
}

#[test]
fn what_the_cask_file_states_wrongly_is_stated() {
    let folder = folder();
    let scene = example_with(folder.path(), "angle_deg = 15.0", "angle_deg = 15.0\nstated_angle_deg = 25.0");
    let out = folder.path().join("a.mcap");
    made(&scene, &out, &[]);
    let cask = fs::read_to_string(out.with_extension("toml")).expect("the cask file");
    assert!(cask.contains("angle_deg = 25\n"), "{cask}");
    assert_ne!(analyze(&out, &out.with_extension("toml")).json()["verdict"], "pass");
}

/// Exit 2, nothing on standard output, one message with `word`.
#[track_caller]
fn at_fault(answer: &Answer, word: &str) {
    assert_eq!(answer.status, 2, "{}", answer.stderr);
    assert!(answer.stdout.is_empty() && !answer.stderr.contains("panicked"), "{}", answer.stderr);
    assert_eq!(answer.stderr.matches("error:").count(), 1, "{}", answer.stderr);
    assert!(answer.stderr.contains(word), "no {word:?} in {}", answer.stderr);
}

#[test]
fn nonsense_is_told_with_its_key() {
    let folder = folder();
    let out = folder.path().join("a.mcap");
    for (from, to, word) in [
        ("pulse_ms = 5.0", "pulse_ms = -5.0", "pulse_ms"),
        ("k = 0.55", "k = 1.5", "k is 1.5"),
        ("bits = 16", "bit = 16", "did you mean bits?"),
        ("end = \"first\"", "end = \"third\"", "end cannot be"),
        ("sample_rate_hz = 25000", "sample_rate_hz = nan", "sample_rate_hz"),
        ("seed = 18", "seed = \"x\"", "seed"),
    ] {
        at_fault(&synth(&example_with(folder.path(), from, to), &out, &[]), word);
        assert!(!out.exists());
    }
    at_fault(&synth(Path::new("no-such-scene.toml"), &out, &[]), "the scene file cannot be read");
}

#[test]
fn nothing_foreign_is_written_over() {
    let folder = folder();
    let (out, cask) = (folder.path().join("a.mcap"), folder.path().join("a.toml"));
    fs::write(&cask, "mine").expect("a temporary file");
    at_fault(&synth(&example(), &out, &[]), "was not written by dropcheck");
    assert_eq!(fs::read_to_string(&cask).expect("the file"), "mine");
    let scene = example_with(folder.path(), "seed = 18", "seed = 19");
    at_fault(&synth(&scene, &folder.path().join("scene.mcap"), &[]), "overwrite");
    at_fault(&synth(&example(), &folder.path().join("b.xlsx"), &[]), "names no format");
    at_fault(
        &synth(&example(), &folder.path().join("b.csv"), &["--encoding", "json"]),
        "--encoding is for MCAP",
    );
    let rates = example_with(folder.path(), "sample_rate_hz = 25000", "sample_rate_hz = 20000");
    at_fault(&synth(&rates, &folder.path().join("b.csv"), &[]), "one sample rate");
    assert!(!folder.path().join("b.csv").exists());
}
