//! Channels that take no part in the motion: shown and judged, and no number of the motion moves by them.

use crate::command_line::{Bench, at_fault, scene_with_axial_channels};
use crate::run::{analyze, dropcheck, number, words};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A drop with four accelerometers, a strain gauge and a thermometer in one table, with and without the last
/// two.
struct Drop {
    bench: Bench,
    plain: Value,
    recording: PathBuf,
    cask: PathBuf,
}

const STRAIN: &str = "\n[[channel]]\nname = \"S1\"\nend = \"none\"\nsource = \"S1\"\nserial = \"G-7\"\n";
const TEMPERATURE: &str = "\n[[channel]]\nname = \"T1\"\nend = \"none\"\nsource = \"T1\"\n";

impl Drop {
    /// Whose strain gauge reads no more than `limit`, in µm/m, and comes off where `lost`.
    fn new(limit: f64, lost: bool) -> Self {
        let bench = Bench::new();
        let made = bench.synth("drop", scene_with_axial_channels());
        let cask = made.with_extension("toml");
        let plain = analyze(&made, &cask).json();
        let contact_s = number(&plain, "/first_impact/time/value").expect("a first contact");
        let half_sine = |x: f64| if (0.0..1.0).contains(&x) { (std::f64::consts::PI * x).sin() } else { 0.0 };
        let table = fs::read_to_string(&made).expect("a table");
        let widened = table.lines().enumerate().map(|(row, line)| {
            let Some(time_s) = line.split(',').next().and_then(|cell| cell.parse::<f64>().ok()) else {
                return format!("{line},S1 [µm/m],T1 [°C]\n");
            };
            // Noise of two to either side, as whole numbers scatter it.
            let noise = f64::from(u32::try_from(row * 7919 % 5).expect("small")) - 2.0;
            let strain = (900.0 * half_sine((time_s - contact_s) / 0.01)).min(limit) - 12.0 + noise;
            let strain = if lost && (0.0..0.004).contains(&(time_s - contact_s)) {
                String::new()
            } else {
                format!("{strain:.1}")
            };
            let temperature = if row % 100 == 1 { "21.5" } else { "" };
            format!("{line},{strain},{temperature}\n")
        });
        let recording = bench.put("wide.csv", widened.collect::<String>());
        let text = fs::read_to_string(&cask).expect("a cask file") + STRAIN + TEMPERATURE;
        let cask = bench.put("wide.toml", text);
        Self { bench, plain, recording, cask }
    }

    /// The result with both; all of the motion is to the bit what it is without them.
    #[track_caller]
    fn analysed(&self) -> Value {
        let result = analyze(&self.recording, &self.cask).json();
        let own = ["input", "command", "settings", "cask_text", "quality", "verdict", "shocks", "missing"];
        for (key, value) in self.plain.as_object().expect("a result") {
            assert!(own.contains(&key.as_str()) || result[key] == *value, "{key} moved");
        }
        let found = |result: &Value| result["quality"].as_array().expect("findings").clone();
        let is_other = |finding: &Value| finding["channel"] == "S1" || finding["channel"] == "T1";
        let of_motion: Vec<Value> = found(&result).into_iter().filter(|f| !is_other(f)).collect();
        assert_eq!(of_motion, found(&self.plain));
        let shocks = result["shocks"].as_array().expect("shocks");
        let (others, of_motion): (Vec<_>, Vec<_>) =
            shocks.iter().cloned().partition(|row| row["channel"] == "S1" || row["channel"] == "T1");
        assert_eq!(Value::from(of_motion), self.plain["shocks"]);
        assert_eq!(others.len(), 4, "two channels in two impacts");
        let missing = |result: &Value| result["missing"].as_array().expect("a list").clone();
        let is_other = |row: &Value| row["quantity"].as_str().is_some_and(|at| at.starts_with("shocks["));
        let of_motion: Vec<Value> = missing(&result).into_iter().filter(|row| !is_other(row)).collect();
        let plain: Vec<Value> = missing(&self.plain).into_iter().filter(|row| !is_other(row)).collect();
        assert_eq!(of_motion, plain);
        result
    }
}

#[test]
fn other_channels_are_told_beside_the_motion() {
    let drop = Drop::new(f64::INFINITY, false);
    let result = drop.analysed();
    assert_eq!((&result["verdict"], &drop.plain["verdict"]), (&"pass".into(), &"pass".into()));
    let [strain, temperature] = &result["other_channels"].as_array().expect("a list")[..] else { panic!() };
    assert_eq!(
        (&strain["name"], &strain["unit"], &strain["serial"]),
        (&"S1".into(), &"µm/m".into(), &"G-7".into())
    );
    let value = |pointer: &str| number(strain, pointer).unwrap_or_else(|| panic!("{pointer}: {strain}"));
    let contact_s = number(&result, "/first_impact/time/value").expect("a first contact");
    assert!((value("/rest") + 12.0).abs() < 0.5 && value("/noise") < 3.0);
    assert!((value("/largest/value") - 888.0).abs() < 3.0);
    assert!((value("/largest/time_s") - contact_s - 0.005).abs() < 5e-4);
    assert!((value("/smallest/value") + 14.0).abs() < 0.5);
    assert_eq!(strain["findings"], serde_json::json!([]));
    // The strain's shock is its change from the rest, at the report's low-pass.
    let shocks = result["shocks"].as_array().expect("shocks");
    let shock = shocks.iter().find(|row| row["channel"] == "S1").expect("a shock");
    assert!((number(shock, "/peak").expect("a peak") - 900.0).abs() < 9.0, "{shock}");
    assert!(shock["velocity_change_m_s"].is_null() && shock["unit"] == "µm/m", "{shock}");
    // A slow quantity stays as it is, which is worth a note.
    assert_eq!(temperature["unit"], "°C");
    assert_eq!(temperature["findings"], serde_json::json!(["dead_channel"]));
    assert!((number(temperature, "/sample_rate_hz").expect("a rate") - 250.0).abs() < 1.0);
    assert_eq!(result["settings"]["channel"][4]["unit"]["value"], "µm/m");
    assert!(result["settings"]["channel"][4]["polarity"]["value"].is_null());
}

#[test]
fn a_gauge_that_clips_or_comes_off_asks_for_a_look_and_moves_nothing() {
    for (limit, lost, code) in [(500.0, false, "clipped"), (f64::INFINITY, true, "non_finite")] {
        let drop = Drop::new(limit, lost);
        let result = drop.analysed();
        assert_eq!(result["verdict"], "review", "{code}");
        let first = &result["quality"][0];
        assert_eq!((&first["channel"], &first["severity"]), (&"S1".into(), &"warning".into()));
        let codes = result["other_channels"][0]["findings"].as_array().expect("codes");
        assert!(codes.contains(&code.into()), "{codes:?}");
    }
}

#[test]
fn the_report_and_the_campaign_hold_them() {
    let drop = Drop::new(f64::INFINITY, false);
    let out = drop.bench.0.path().join("out");
    assert_eq!(dropcheck(words!["analyze", drop.recording, "--cask", drop.cask, "--out", out]).status, 0);
    let text =
        |name: &str| fs::read_to_string(out.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let table = text("curves.csv");
    let mut lines = table.lines();
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let column = head.iter().position(|name| *name == "S1_raw_µm/m").expect("the strain");
    assert!(head.contains(&"T1_raw_°C"));
    let values = lines.filter_map(|line| line.split(',').nth(column)?.parse::<f64>().ok());
    assert!((values.fold(f64::MIN, f64::max) - 888.0).abs() < 3.0);
    let listed = |name: &str, source: &str| {
        let listing = dropcheck(words!["inspect", out.join(name), "--json", "-"]).json();
        let channels = listing["channels"].as_array().expect("channels").clone();
        channels
            .into_iter()
            .find(|channel| channel["source"] == source)
            .unwrap_or_else(|| panic!("{listing}"))
    };
    assert_eq!(listed("curves.h5", "/other_channels/S1/raw")["unit"], "µm/m");
    assert!(listed("curves.mcap", "/dropcheck/S1.value")["samples"].as_u64() > Some(1000));
    let page = text("report.html");
    assert!(page.contains(">Other channels<") && page.contains("href=\"other_channels.svg\""));
    let picture = text("other_channels.svg");
    for word in ["S1", "µm/m", "°C", "first contact", "slap-down", "magnitude, µm/m s"] {
        assert!(picture.contains(word), "no {word}");
    }
    let campaign = drop.bench.0.path().join("campaign");
    let batch = words!["batch", drop.recording, "--cask", drop.cask, "--out", campaign];
    assert_eq!(dropcheck(batch).status, 0);
    let rows = fs::read_to_string(campaign.join("campaign.csv")).expect("a table");
    let mut rows = csv::Reader::from_reader(rows.as_bytes());
    let at =
        rows.headers().expect("a head").iter().position(|name| name == "other_channels").expect("a column");
    let row = rows.records().next().expect("a row").expect("cells");
    let cell: Value = serde_json::from_str(&row[at]).expect("JSON");
    assert_eq!((&cell[1]["name"], &cell[1]["largest"]), (&"T1".into(), &21.5.into()));
}

#[test]
fn what_makes_no_sense_beside_none_is_refused_by_name() {
    let drop = Drop::new(f64::INFINITY, false);
    let text = fs::read_to_string(&drop.cask).expect("a cask file");
    let refused = |from: &str, to: &str, words: &[&str]| {
        assert!(text.contains(from), "{from}");
        at_fault(&analyze(&drop.recording, &drop.bench.put("odd.toml", text.replace(from, to))), words);
    };
    for key in
        ["position_m = 0.1", "axis = \"axial\"", "polarity = 1", "coupling = \"dc\"", "sensitivity = 1.0"]
    {
        let name = key.split(' ').next().expect("a key");
        refused("serial = \"G-7\"", key, &[name, "no meaning beside end = \"none\"", "odd.toml", "delete"]);
    }
    refused("source = \"T1\"", "source = \"S1\"", &["T1 reads the same source as S1"]);
    refused("name = \"T1\"", "name = \"A1\"", &["two channels are named \"A1\""]);
    refused("end = \"first\"", "end = \"low\"", &["\"first\" or \"second\" or \"none\""]);
    // Nothing states the unit of a column without one.
    let table = fs::read_to_string(&drop.recording).expect("a table").replace(" [µm/m]", "");
    let bare = drop.bench.put("bare.csv", table);
    at_fault(&analyze(&bare, &drop.cask), &["bare.csv", "\"S1\"", "says the unit", "any text will do"]);
    let only_others = text.split("[[channel]]").next().expect("a head").to_owned() + STRAIN;
    at_fault(&analyze(&drop.recording, &drop.bench.put("odd.toml", only_others)), &["of an accelerometer"]);
}

#[test]
fn the_form_has_them_behind_marks() {
    let drop = Drop::new(f64::INFINITY, false);
    let form = dropcheck(words!["init", Path::new(&drop.recording)]).stdout;
    let (_, others) = form.split_once("beside the motion.\n").unwrap_or_else(|| panic!("{form}"));
    let unmarked: String =
        others.lines().map(|line| line.trim_start_matches("# ")).collect::<Vec<_>>().join("\n");
    let others: toml::Table = unmarked.parse().unwrap_or_else(|e| panic!("{e}\n{unmarked}"));
    assert!(others["channel"].as_array().is_some_and(|all| {
        all.iter().any(|one| one["name"].as_str().is_some_and(|name| name.starts_with("T1")))
    }));
}
