//! From a recording without a cask file to the page that shows it.

use crate::command_line::{Bench, at_fault};
use crate::run::{dropcheck, fixture, in_a_browser, number, truth, words};
use base64::prelude::{BASE64_STANDARD, Engine};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// What the charts of a page draw, one after the other.
fn charts(page: &str) -> Vec<Value> {
    let scripts = page.split("<script type=\"application/json\">").skip(1);
    scripts
        .map(|rest| serde_json::from_str(rest.split("</script>").next().expect("an end")).expect("JSON"))
        .collect()
}

/// The samples of a chart.
fn samples(chart: &Value) -> Vec<f32> {
    let bytes = BASE64_STANDARD.decode(chart["panels"][0]["lines"][0]["y"].as_str().expect("values"));
    let bytes = bytes.expect("base64");
    bytes.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().expect("four"))).collect()
}

/// The page that `inspect --out` writes of an example, and what it lists.
fn looked_at(name: &str, out: &Path) -> (String, Value) {
    let answer = dropcheck(words!["inspect", fixture(name), "--out", out]);
    assert_eq!(answer.status, 0, "{}", answer.stderr);
    assert!(answer.stdout.contains("recording.html"), "{}", answer.stdout);
    let page = fs::read_to_string(out.join("recording.html")).expect("a page");
    let listing = fs::read_to_string(out.join("recording.json")).expect("a listing");
    let mut names: Vec<_> =
        fs::read_dir(out).expect("a folder").map(|file| file.expect("a file").file_name()).collect();
    names.sort();
    assert_eq!(names, ["recording.html", "recording.json"]);
    (page, serde_json::from_str(&listing).expect("JSON"))
}

#[test]
fn every_source_of_every_format_is_shown_with_every_sample() {
    let bench = Bench::new();
    for name in ["anf18-json.mcap", "vhlw-rest.h5", "anf10-plain.csv"] {
        let out = bench.0.path().join(name);
        let (page, listing) = looked_at(name, &out);
        assert!(page.len() < 3_000_000 && !page.contains("src=\"http"), "{name}");
        let (charts, sources) = (charts(&page), listing["channels"].as_array().expect("sources"));
        assert_eq!(charts.len(), sources.len(), "{name}");
        for (chart, source) in charts.iter().zip(sources) {
            let samples = samples(chart);
            assert_eq!(samples.len() as u64, source["samples"].as_u64().expect("a count"), "{name}");
            assert_eq!(chart["note"], "Drag to zoom: every sample is here.");
            let peak = samples.iter().fold(f32::NEG_INFINITY, |peak, sample| peak.max(*sample));
            let most = source["range"][1].as_f64().expect("a range");
            assert!((f64::from(peak) - most).abs() <= 1e-6 * most.abs(), "{name}: {peak} {most}");
            assert!(page.contains(source["source"].as_str().expect("a name")));
        }
        assert_eq!(page.contains("unit not stated"), name.ends_with("csv"), "{name}");
        let again = looked_at(name, &out).0;
        assert!(again == page, "{name}: not to the byte");
    }
}

#[test]
fn a_fall_and_an_impact_are_marked_as_what_they_look_like() {
    let bench = Bench::new();
    let (page, _) = looked_at("vhlw-rest.h5", &bench.0.path().join("look"));
    let impact_ms = 1e3 * number(&truth("vhlw-rest"), "/t_impact").expect("a time");
    let marks = &charts(&page)[0]["panels"][0]["marks"];
    let at = |label: &str| {
        let found = marks.as_array().expect("marks").iter().find(|mark| mark[1] == label);
        found.unwrap_or_else(|| panic!("no {label:?} in {marks}"))[0].as_f64().expect("a time")
    };
    // The first tenth of the pulse passes within a millisecond.
    assert!((at("looks like an impact") - impact_ms).abs() < 2.0, "{marks} {impact_ms}");
    // 9 m take 1.3546 s.
    assert!((at("looks like a fall") - (impact_ms - 1354.6)).abs() < 10.0, "{marks}");
    assert!(page.contains("nothing here is a result"));
}

#[test]
fn the_page_of_another_recording_and_what_is_not_ours_stay() {
    let bench = Bench::new();
    let out = bench.0.path().join("look");
    looked_at("anf18-json.mcap", &out);
    let before = fs::read(out.join("recording.html")).expect("a page");
    let recording = fixture("vhlw-rest.h5");
    let other = |more: &[&str]| {
        let words = words!["inspect", recording, "--out", out];
        dropcheck(words.into_iter().chain(more.iter().map(std::ffi::OsStr::new)))
    };
    at_fault(&other(&[]), &["another recording", "anf18-json.mcap", "--force"]);
    assert!(fs::read(out.join("recording.html")).is_ok_and(|kept| kept == before), "nothing is lost");
    assert_eq!(other(&["--force"]).status, 0);
    let theirs = bench.put("recording.html", "theirs");
    let answer = dropcheck(words!["inspect", recording, "--out", bench.0.path()]);
    at_fault(&answer, &["recording.html", "not written by dropcheck"]);
    assert!(fs::read(theirs).is_ok_and(|kept| kept == b"theirs"));
}

#[test]
fn the_page_works_in_a_browser() {
    let bench = Bench::new();
    for name in ["anf18-json.mcap", "vhlw-rest.h5", "anf10-plain.csv"] {
        let out = bench.0.path().join(name);
        looked_at(name, &out);
        in_a_browser("recording.py", &out.join("recording.html"));
    }
}
