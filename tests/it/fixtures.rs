//! From each fixture to how far its analysis lies from the truth, and to what it says of damage.

use crate::run::{Answer, analyze, fixture, fixtures, number, truth};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Largest error of speed of an undamaged recording, relative: what a person may rely on, by the aims of this
/// project. The simulated scenes leave 0.4 % with the ringing fitted; the rest of the 1 % is for the pulse's
/// own length.
const SPEED: f64 = 0.01;

/// Largest error of k: a rod's speed at small angles changes by v0/2 per unit of k, so 0.03 is 0.2 m/s, 1 %
/// of the speed.
const RESTITUTION: f64 = 0.03;

/// How far beyond its 95 % interval a value may lie, in half-widths: 1.5 is 3 standard uncertainties.
const BEYOND: f64 = 1.5;

/// A fixture's answer, its result and its truth.
fn run(stem: &str) -> (Answer, Value, Value) {
    let truth = truth(stem);
    let recording = truth["recording"].as_str().expect("the recording's name");
    let answer = analyze(&fixture(recording), &fixture(&format!("{stem}.toml")));
    let result = answer.json();
    (answer, result, truth)
}

/// Codes of the issues in a result that weigh more than a note.
fn codes(result: &Value) -> Vec<&str> {
    let issues = result["quality"].as_array().map_or(&[][..], Vec::as_slice);
    let weighty = issues.iter().filter(|issue| issue["severity"] != "note");
    weighty.filter_map(|issue| issue["code"].as_str()).collect()
}

/// Asserts that a quantity is there and lies within `tolerance` of the truth and within its own interval.
#[track_caller]
fn near(result: &Value, pointer: &str, expected: f64, tolerance: f64) {
    let value = number(result, &format!("{pointer}/value"));
    let u95 = number(result, &format!("{pointer}/u95"));
    let (Some(value), Some(u95)) = (value, u95) else { panic!("no {pointer}: {:?}", codes(result)) };
    let error = value - expected;
    assert!(error.abs() <= tolerance, "{pointer}: {value} ± {u95} for {expected}");
    assert!(error.abs() <= BEYOND * u95, "{pointer}: {value} ± {u95} does not hold {expected}");
}

/// An undamaged fixture passes, with every number near its truth.
#[track_caller]
fn sound(stem: &str) {
    let (answer, result, truth) = run(stem);
    let known = |key: &str| number(&truth, &format!("/{key}")).expect(key);
    let (speed, v0) = (known("speed"), known("v0"));
    near(&result, "/slap_down/speed", speed, SPEED * speed);
    near(&result, "/slap_down/vertical_velocity", known("vz"), SPEED * speed);
    near(&result, "/k", known("k"), RESTITUTION);
    near(&result, "/first_impact/rebound_velocity", known("rebound_velocity"), RESTITUTION * v0);
    near(&result, "/first_impact/impact_velocity", v0, SPEED * v0);
    // Speed of R relative to S is ω times at most the length.
    near(&result, "/first_impact/angular_velocity", known("omega_rebound"), SPEED * known("omega_rebound"));
    // A tenth of the contact: the separation is where the force fades out.
    near(&result, "/first_impact/time", known("t_impact"), 0.1 * known("contact_s"));
    near(&result, "/slap_down/time", known("t_impact") + known("slap_t"), 0.2 * known("contact_s"));
    assert_eq!(result["verdict"], "pass", "{stem}: {:?}", codes(&result));
    assert_eq!(answer.status, 0);
}

/// A damaged fixture: any number that is given holds the truth, or the verdict is not "pass"; the damage is
/// named.
#[track_caller]
fn damaged(stem: &str, named: &[&str]) -> Value {
    let (answer, result, truth) = run(stem);
    let given = codes(&result);
    assert!(named.iter().any(|code| given.contains(code)), "{stem}: {given:?} names none of {named:?}");
    assert_eq!(
        answer.status,
        i32::from(result["verdict"] != "pass"),
        "{stem}: exit status and verdict differ"
    );
    if result["verdict"] == "pass" {
        for (pointer, key) in [("/slap_down/speed", "speed"), ("/k", "k")] {
            near(&result, pointer, number(&truth, &format!("/{key}")).expect(key), f64::INFINITY);
        }
    }
    result
}

#[test]
fn mcap_of_json_blocks() {
    sound("anf18-json");
}

#[test]
fn mcap_of_protobuf_blocks_doubled_and_out_of_order() {
    sound("anf10-protobuf");
}

#[test]
fn mcap_of_ros2_messages() {
    sound("esbb-imu");
}

#[test]
fn hdf5_with_rest_and_an_axial_channel() {
    sound("vhlw-rest");
}

#[test]
fn csv_as_a_german_logger_writes_it() {
    sound("anf18-german");
}

#[test]
fn csv_plain() {
    sound("anf10-plain");
}

#[test]
fn a_clipped_channel_is_named_and_does_not_pass() {
    let result = damaged("damaged-clipped", &["clipped"]);
    assert_ne!(result["verdict"], "pass");
    let issues = result["quality"].as_array().expect("issues");
    assert!(issues.iter().any(|issue| issue["code"] == "clipped" && issue["channel"] == "A1"));
    // The flight is clipped too: nothing tells what the first impact was.
    assert!(result["k"].is_null() && result["slap_down"]["speed"].is_null());
}

#[test]
fn a_gap_in_the_flight_is_named() {
    let truth = truth("damaged-gap");
    let result = damaged("damaged-gap", &["gap"]);
    // The impact itself is whole: where a speed is given, it holds the truth.
    if number(&result, "/slap_down/speed/value").is_some() {
        near(&result, "/slap_down/speed", number(&truth, "/speed").expect("speed"), f64::INFINITY);
    }
}

#[test]
fn a_zero_shift_is_named_and_does_not_bend_the_result() {
    let truth = truth("damaged-zero-shift");
    let result = damaged("damaged-zero-shift", &["zero_shift"]);
    near(&result, "/slap_down/speed", number(&truth, "/speed").expect("speed"), f64::INFINITY);
}

#[test]
fn a_truncated_file_yields_its_whole_messages() {
    let result = damaged("damaged-truncated", &["truncated"]);
    assert_ne!(result["verdict"], "pass");
    let truth = truth("damaged-truncated");
    let speed = number(&truth, "/speed").expect("speed");
    near(&result, "/slap_down/speed", speed, SPEED * speed);
}

#[test]
fn a_record_that_ends_in_the_flight_has_no_slap_down() {
    let result = damaged("damaged-ends-early", &["ends_early", "no_slap_down"]);
    assert_ne!(result["verdict"], "pass");
    assert!(result["slap_down"]["time"].is_null(), "a slap-down was read from a record that has none");
}

#[test]
fn every_fixture_is_tested() {
    let source = include_str!("fixtures.rs");
    let folder = fixtures().join("reference");
    for entry in std::fs::read_dir(&folder).expect("fixtures").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if let Some(stem) = name.strip_suffix(".truth.json") {
            assert!(source.contains(&format!("\"{stem}\"")), "{stem} is analysed by no test");
        }
    }
}

/// The fixture's cask file with one of its two channels, in a folder.
fn with_channel(stem: &str, which: usize, folder: &Path) -> PathBuf {
    let cask = folder.join("one-end.toml");
    let whole = std::fs::read_to_string(fixture(&format!("{stem}.toml"))).expect("a cask file");
    let parts: Vec<&str> = whole.split("[[channel]]").collect();
    assert_eq!(parts.len(), 3, "two channels");
    std::fs::write(
        &cask,
        [&format!("{}[contact]\nfriction = \"rough\"\n", parts[0]), parts[1 + which]].join("[[channel]]"),
    )
    .expect("a cask file");
    cask
}

#[test]
fn one_end_alone_gives_the_first_impact_and_its_restitution() {
    let truth = truth("anf18-json");
    let folder = tempfile::tempdir().expect("a folder");
    let answer = analyze(&fixture("anf18-json.mcap"), &with_channel("anf18-json", 0, folder.path()));
    let result = answer.json();
    let known = |key: &str| number(&truth, &format!("/{key}")).expect(key);
    near(&result, "/k", known("k"), RESTITUTION);
    near(&result, "/first_impact/angular_velocity", known("omega_rebound"), 0.05 * known("omega_rebound"));
    // A tenth of the contact: the separation is where the force fades out.
    near(&result, "/first_impact/duration", known("contact_s"), 0.1 * known("contact_s"));
    assert!(result["slap_down"]["speed"].is_null() && result["slap_down"]["time"].is_null());
    assert_eq!(codes(&result), ["missing_channel"]);
    assert_eq!((result["verdict"].as_str(), answer.status), (Some("fail"), 1));
}

#[test]
fn the_second_end_alone_gives_the_slap_down_too() {
    let truth = truth("anf18-json");
    let folder = tempfile::tempdir().expect("a folder");
    let answer = analyze(&fixture("anf18-json.mcap"), &with_channel("anf18-json", 1, folder.path()));
    let result = answer.json();
    let held = [
        ("/k", "k", 0.18),
        ("/slap_down/speed", "speed", 0.8),
        ("/slap_down/angle", "angle_hit_deg", 5.0),
        ("/first_impact/angular_velocity", "omega_rebound", 0.6),
        ("/first_impact/duration", "contact_s", 4e-3),
    ];
    for (pointer, key, widest) in held {
        let stated = &result.pointer(pointer).expect(pointer);
        let (value, u95) =
            (number(stated, "/value").expect("a value"), number(stated, "/u95").expect("an interval"));
        let off = (value - number(&truth, &format!("/{key}")).expect(key)).abs();
        assert!(off <= u95 && u95 <= widest, "{key}: {value} ± {u95}, off by {off}");
    }
    assert_eq!(codes(&result), ["missing_channel"]);
    assert_eq!((result["verdict"].as_str(), answer.status), (Some("fail"), 1));
}
