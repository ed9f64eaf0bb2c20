//! A scale model: the numbers of its prototype beside those that were measured.

use crate::command_line::{Bench, at_fault};
use crate::run::{analyze, dropcheck, fixture, number, words};
use serde_json::json;
use std::fs;

#[test]
fn a_model_tells_of_its_prototype() {
    let (bench, recording) = (Bench::new(), fixture("anf18-json.mcap"));
    let text = fs::read_to_string(fixture("anf18-json.toml")).expect("a cask file");
    let of_scale =
        |scale: &str| bench.put("cask.toml", text.replace("[cask]\n", &format!("[cask]\nscale = {scale}\n")));
    let result = analyze(&recording, &of_scale("0.5")).json();
    let prototype = &result["prototype"];
    assert_eq!((&prototype["scale"], &prototype["k"]), (&json!(0.5), &result["k"]));
    for (pointer, factor) in [
        ("/slap_down/speed/value", 1.0),
        ("/slap_down/flight_time/u95", 2.0),
        ("/first_impact/angular_velocity/value", 0.5),
        ("/impacts/0/crush/value", 2.0),
        ("/impacts/0/force_peak/value", 4.0),
        ("/impacts/0/energy_absorbed/value", 8.0),
        ("/impacts/0/rigid_body_deceleration/at_cog/value", 0.5),
    ] {
        let [model, full] = [&result, prototype].map(|of| number(of, pointer).expect("a number"));
        assert!((full / model - factor).abs() < 1e-12, "{pointer}: {model} to {full}");
    }
    let plain = analyze(&recording, &fixture("anf18-json.toml")).json();
    assert!(plain["prototype"].is_null() && plain["slap_down"] == result["slap_down"]);
    let full = dropcheck(words!["analyze", recording, "--cask", of_scale("0.5"), "--full"]);
    assert!(full.stdout.contains("Model and prototype"), "{}", full.stdout);
    assert!(full.stdout.contains("Not scaled: gravity"), "{}", full.stdout);
    at_fault(&analyze(&recording, &of_scale("2")), &["scale", "half-scale model"]);
}
