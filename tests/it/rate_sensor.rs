//! An angular-rate sensor beside the accelerometers: the rotation at first contact that nobody states, and
//! what is said of a sensor that cannot be right.

use crate::command_line::{Bench, at_fault};
use crate::run::{analyze, findings, number, read_json};
use serde_json::{Value, json};
use std::fs;

/// A cask that turns at 5°/s as it strikes, from rest on, with an angular-rate sensor.
const SCENE: &str = "\
seed = 7
[cask]
mass_kg = 4466.0
length_m = 5.512
height_m = 0.792
[drop]
height_m = 9.0
angle_deg = 15.0
angular_velocity_deg_s = 5.0
[contact]
friction = \"rough\"
[[mode]]
frequency_hz = 62.0
damping = 0.03
[recording]
rest = true
[[channel]]
name = \"A1\"
end = \"first\"
sample_rate_hz = 10000
[[channel]]
name = \"A2\"
end = \"second\"
sample_rate_hz = 10000
[[channel]]
name = \"W1\"
end = \"second\"
axis = \"rate\"
sample_rate_hz = 10000
scale = 1.003
offset_deg_s = -1.5
";

/// The drop as CSV with its cask file, of which lines are changed: each `from`, to the end of its line.
struct TurningDrop {
    bench: Bench,
    cask: String,
}

impl TurningDrop {
    fn new() -> Self {
        let bench = Bench::new();
        let made = bench.synth("drop", SCENE);
        let cask = fs::read_to_string(made.with_extension("toml")).expect("a cask file");
        assert!(cask.contains("axis = \"rate\"\nsource = \"W1\"\nunit = \"deg/s\""), "{cask}");
        Self { bench, cask }
    }

    fn put(&self, changes: &[[&str; 2]]) -> std::path::PathBuf {
        let mut cask = self.cask.clone();
        for [from, to] in changes {
            assert!(cask.contains(from), "no {from} in {cask}");
            cask = cask.replacen(from, to, 1);
        }
        self.bench.put("changed.toml", cask)
    }

    fn analysed(&self, changes: &[[&str; 2]]) -> Value {
        analyze(&self.bench.0.path().join("drop.csv"), &self.put(changes)).json()
    }

    /// How far speed and k are off, in half-widths.
    fn off(&self, result: &Value) -> [f64; 2] {
        let truth = read_json(&self.bench.0.path().join("drop.truth.json"));
        [("/slap_down/speed", "/speed"), ("/k", "/k")].map(|(of, is)| {
            let [value, u95] = ["value", "u95"].map(|part| number(result, &format!("{of}/{part}")));
            let off = |(value, u95): (f64, f64)| (value - number(&truth, is).expect("true")).abs() / u95;
            value.zip(u95).map_or(f64::INFINITY, off)
        })
    }
}

/// Stated nowhere.
const UNSTATED: [&str; 2] = ["angular_velocity_deg_s = 5\n", ""];

fn tests_rotation(result: &Value) -> bool {
    let untested = result["untested"].as_array().expect("a list");
    untested.iter().all(|input| input["key"] != "drop.angular_velocity_deg_s")
}

#[test]
fn a_rotation_that_nobody_states_is_measured() {
    let drop = TurningDrop::new();
    let result = drop.analysed(&[UNSTATED]);
    assert_eq!(result["verdict"], "pass", "{}", findings(&result));
    assert!(drop.off(&result).iter().all(|off| *off < 1.5), "{:?}", drop.off(&result));
    let turns = &result["settings"]["drop"]["angular_velocity_deg_s"];
    assert_eq!(turns["from"], "recording");
    // 0.3 % of scale, and noise of 0.1°/s in 25,000 samples.
    assert!((turns["value"].as_f64().expect("a number") - 5.0).abs() < 0.03, "{turns}");
    assert!(tests_rotation(&result), "{}", result["untested"]);
    let kinds: Vec<&Value> =
        result["reconstruction"]["closures"].as_array().expect("some").iter().map(|c| &c["kind"]).collect();
    assert!(kinds.contains(&&json!("rate_before")) && kinds.contains(&&json!("rate_gained")), "{kinds:?}");
    let other = &result["other_channels"][0];
    assert_eq!((&other["name"], &other["unit"]), (&json!("W1"), &json!("deg/s")));
    assert!((other["rest"].as_f64().expect("a level") + 1.5).abs() < 0.1);
    // Without the sensor nothing tells it, and the numbers are off.
    let at = drop.cask.find("\n[[channel]]\nname = \"W1\"").expect("its table");
    let without = drop.analysed(&[UNSTATED, [&drop.cask[at..], ""]]);
    assert!(drop.off(&without).iter().any(|off| *off > 1.5), "{:?}", drop.off(&without));
}

#[test]
fn a_rotation_that_is_stated_is_tested() {
    let drop = TurningDrop::new();
    let right = drop.analysed(&[]);
    assert_eq!((&right["verdict"], tests_rotation(&right)), (&json!("pass"), true), "{}", findings(&right));
    let wrong = drop.analysed(&[["angular_velocity_deg_s = 5\n", "angular_velocity_deg_s = 0\n"]]);
    let said = findings(&wrong);
    assert!(wrong["verdict"] != "pass" && said.contains("`angular_velocity_deg_s`"), "{said}");
}

#[test]
fn a_sensor_that_cannot_be_right_is_named_and_left_out() {
    let drop = TurningDrop::new();
    let plain = "unit = \"deg/s\"\n";
    for (to, code, words) in
        [("unit = \"deg/s\"\npolarity = -1\n", "polarity", "-1 times"), ("unit = \"rad/s\"\n", "scale", "57")]
    {
        let result = drop.analysed(&[[plain, to]]);
        let found = result["quality"].as_array().expect("findings");
        let own = found.iter().find(|f| f["channel"] == "W1" && f["severity"] == "warning");
        let own = own.unwrap_or_else(|| panic!("{}", findings(&result)));
        let said = own["message"].as_str().expect("words").replace('−', "-");
        assert!(own["code"] == code && said.contains(words), "{own}");
        // The rotation is stated as it is, so that the numbers stand without it.
        assert!(drop.off(&result).iter().all(|off| *off < 1.5), "{:?}", drop.off(&result));
        // It is named, too, where nobody states the rotation and no number stands.
        let unstated = findings(&drop.analysed(&[UNSTATED, [plain, to]])).replace('−', "-");
        assert!(unstated.contains(words), "{unstated}");
    }
}

#[test]
fn a_sensor_at_its_limit_in_the_flight_is_left_out() {
    let drop = TurningDrop::new();
    let table = fs::read_to_string(drop.bench.0.path().join("drop.csv")).expect("a table");
    let limited = |line: &str| {
        let Some((before, rate)) = line.rsplit_once(',') else { return format!("{line}\n") };
        let cut = rate.parse::<f64>().map_or_else(|_| rate.to_owned(), |rate| rate.min(200.0).to_string());
        format!("{before},{cut}\n")
    };
    drop.bench.put("drop.csv", table.lines().map(limited).collect::<String>());
    let result = drop.analysed(&[]);
    let said = findings(&result);
    assert!(said.contains("\"clipped\"") && said.contains("W1 stands at its limit"), "{said}");
    assert!(drop.off(&result).iter().all(|off| *off < 1.5), "{:?}", drop.off(&result));
}

#[test]
fn a_key_that_no_rate_sensor_has_is_refused() {
    let drop = TurningDrop::new();
    let plain = "unit = \"deg/s\"\n";
    let recording = drop.bench.0.path().join("drop.csv");
    for (to, words) in [
        ("unit = \"g\"\n", ["no unit of a rate of turn", "rad/s"]),
        ("unit = \"deg/s\"\ncoupling = \"ac\"\n", ["coupling has no meaning", "delete coupling"]),
    ] {
        at_fault(&analyze(&recording, &drop.put(&[[plain, to]])), &words);
    }
}
