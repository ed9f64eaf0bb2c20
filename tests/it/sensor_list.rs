//! Sensors of the skin, in tables and in lists, and of two recorders, to the same numbers.

use crate::command_line::{Bench, at_fault};
use crate::run::{analyze, dropcheck, findings, fixture, number, read_json, words};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

/// A drop with sensors on the skin, half-way between the lowest line and the side of a round cask of 0.8 m.
const SCENE: &str = "\
seed = 7
[cask]
mass_kg = 4466.0
length_m = 5.512
height_m = 0.8
[drop]
height_m = 9.0
angle_deg = 15.0
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
offset_m = -0.282842712
[[channel]]
name = \"A2\"
end = \"second\"
sample_rate_hz = 10000
offset_m = -0.282842712
";

const HEAD: &str = "name,source,end,plane_m,around_deg,direction,unit,full_scale,polarity,serial,certificate,\
                    calibrated,file";
const PLACES: [[&str; 2]; 2] = [["A1", "0.15"], ["A2", "5.362"]];

/// The drop, its samples in g, and the tables of the cask file that are no channels.
struct SkinDrop {
    bench: Bench,
    cask: String,
    /// Time, first end, second end.
    rows: Vec<[f64; 3]>,
}

impl SkinDrop {
    fn new() -> Self {
        let bench = Bench::new();
        let made = bench.synth("drop", SCENE);
        let cask = fs::read_to_string(made.with_extension("toml")).expect("a cask file");
        let cask = cask.split("[[channel]]").next().expect("its beginning").to_owned();
        let text = fs::read_to_string(made).expect("a recording");
        let row = |line: &str| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            [cells[0], cells[1], cells[2]]
        };
        let rows = text.lines().skip(1).map(row).collect();
        Self { bench, cask, rows }
    }

    /// The impact as the simulation has it, s.
    fn impact_s(&self) -> f64 {
        let truth = read_json(&self.bench.0.path().join("drop.truth.json"));
        number(&truth, "/t_impact").expect("a time")
    }

    /// A recording of these columns, each of time, first and second end; it begins `late_s` late.
    fn record(
        &self,
        name: &str,
        heads: &[&str],
        late_s: f64,
        columns: &[&dyn Fn([f64; 3]) -> f64],
    ) -> PathBuf {
        let mut text = format!(
            "time_s,{}\n",
            heads.iter().map(|head| format!("{head} [g]")).collect::<Vec<_>>().join(",")
        );
        for row in &self.rows {
            let cells: Vec<String> = columns.iter().map(|column| format!("{:.6}", column(*row))).collect();
            let _ = writeln!(text, "{:.6},{}", row[0] - late_s, cells.join(","));
        }
        self.bench.put(name, text)
    }

    /// What radial and tangential sensors at 45° read, where the cask is pushed across the plane by so many g
    /// for 10 ms at the impact.
    fn record_pairs(&self, name: &str, across_g: f64) -> PathBuf {
        let impact_s = self.impact_s();
        let is_pushed = move |at_s: f64| (impact_s..impact_s + 0.01).contains(&at_s);
        let across = move |row: [f64; 3]| if is_pushed(row[0]) { across_g } else { 0.0 };
        let share = 0.5_f64.sqrt();
        let radial = move |row: [f64; 3], end: usize| share * (across(row) - row[end]);
        let tangential = move |row: [f64; 3], end: usize| share * (across(row) + row[end]);
        self.record(
            name,
            &["A1", "A1 side", "A2", "A2 side"],
            0.0,
            &[&|row| radial(row, 1), &|row| tangential(row, 1), &|row| radial(row, 2), &|row| {
                tangential(row, 2)
            }],
        )
    }

    fn put_cask(&self, name: &str, channels: &str) -> PathBuf {
        self.bench.put(name, format!("{}{channels}", self.cask))
    }

    /// The cask file with a list.
    fn put_list(&self, list: &str) -> PathBuf {
        self.bench.put("list.csv", list);
        self.bench.put("listed.toml", format!("sensors = \"list.csv\"\n{}", self.cask))
    }
}

/// Tables of transverse channels at the sensors' places.
fn tables(more: [&str; 2]) -> String {
    let table = |(i, [name, place]): (usize, [&str; 2])| {
        let end = ["first", "second"][i];
        format!(
            "[[channel]]\nname = \"{name}\"\nend = \"{end}\"\naxis = \"transverse\"\n\
             source = \"{name}\"\nposition_m = {place}\n\
             offset_m = -0.282842712\nlateral_m = 0.282842712\n{}\n",
            more[i]
        )
    };
    PLACES.into_iter().enumerate().map(table).collect()
}

/// Rows of a list with the pairs at 45°.
fn pairs() -> String {
    let row = |name: &str, place: &str, way: &str| {
        format!("{name},{name},,{place},45,{way},,,1,S-1,K-2,2026-03-02,\n")
    };
    let rows = PLACES
        .map(|[name, place]| row(name, place, "radial") + &row(&format!("{name} side"), place, "tangential"));
    format!("{HEAD}\n{}", rows.concat())
}

/// How far two results lie apart in speed and k, in half-widths.
#[track_caller]
fn apart(one: &Value, other: &Value) -> f64 {
    let in_half_widths = |quantity: &str| {
        let part = |result: &Value, part: &str| {
            number(result, &format!("{quantity}/{part}")).unwrap_or_else(|| panic!("{}", result["quality"]))
        };
        (part(one, "value") - part(other, "value")).abs() / part(one, "u95")
    };
    in_half_widths("/slap_down/speed").max(in_half_widths("/k"))
}

#[test]
fn a_list_and_tables_give_one_number_turned_by_45_degrees_too() {
    let drop = SkinDrop::new();
    let stated =
        analyze(&drop.bench.0.path().join("drop.csv"), &drop.put_cask("stated.toml", &tables(["", ""])))
            .json();
    assert_eq!(stated["verdict"], "pass", "{}", findings(&stated));
    let recording = drop.record_pairs("pairs.csv", 0.0);
    for list in [pairs(), pairs().replace('.', "§").replace(',', ";").replace('§', ",")] {
        let listed = analyze(&recording, &drop.put_list(&list)).json();
        assert_eq!(listed["verdict"], "pass", "{}", findings(&listed));
        assert!(apart(&stated, &listed) < 0.1, "{}", apart(&stated, &listed));
        // What made the result is in it, without the list.
        let channels = listed["settings"]["channel"].as_array().expect("a list");
        assert_eq!((channels.len(), &channels[3]["end"]["value"]), (4, &"second".into()));
    }
    let result = drop.bench.0.path().join("result.json");
    let list = drop.put_list(&pairs());
    dropcheck(words!["analyze", recording, "--cask", list, "--json", result]);
    fs::remove_file(drop.bench.0.path().join("list.csv")).expect("it is there");
    let again = dropcheck(words!["analyze", recording, "--from", result, "--json", "-"]);
    assert!(apart(&read_json(&result), &again.json()) < 1e-9, "{}", again.stderr);
}

#[test]
fn a_motion_across_the_plane_is_named_and_a_sensor_alone_says_what_it_assumes() {
    let drop = SkinDrop::new();
    let list = drop.put_list(&pairs());
    let still = analyze(&drop.record_pairs("still.csv", 0.0), &list).json();
    // 4 g over 10 ms are 0.4 m/s.
    let pushed = analyze(&drop.record_pairs("pushed.csv", 4.0), &list).json();
    assert!(apart(&still, &pushed) < 0.01, "it takes nothing from the motion in the plane");
    assert!(!findings(&still).contains("not_planar"), "{}", findings(&still));
    let said = findings(&pushed);
    assert_eq!((said.matches("not_planar").count(), &pushed["verdict"]), (2, &"review".into()), "{said}");
    assert!(said.contains("+0.39"), "{said}");
    // The radial sensors alone.
    let alone: String = pairs().split_inclusive('\n').filter(|line| !line.contains("side")).collect();
    let alone = analyze(&drop.bench.0.path().join("still.csv"), &drop.put_list(&alone)).json();
    assert!(apart(&still, &alone) < 0.3, "{}", apart(&still, &alone));
    assert!(findings(&alone).contains("as if the cask did not move across it"), "{}", findings(&alone));
}

#[test]
fn what_is_wrong_in_a_list_is_named_by_file_line_and_column() {
    let drop = SkinDrop::new();
    let recording = drop.record_pairs("pairs.csv", 0.0);
    for (from, to, said) in [
        ("0.15", "7.5", ["line 2", "column plane_m", "outside the cask"]),
        ("0.15", "left", ["line 2", "column plane_m", "left"]),
        ("tangential", "tangent", ["line 3", "column direction", "tangential"]),
        (",45,", ",450,", ["line 2", "column around_deg", "-180 to 360"]),
        (",45,", ",,", ["line 2", "column direction", "around_deg"]),
        ("2026-03-02", "2.3.2026", ["line 2", "column calibrated", "2.3.2026"]),
        (",1,S-1", ",2,S-1", ["line 2", "column polarity", "1 or -1"]),
        ("A1 side,A1 side", "A1,A1 side", ["line 3", "column name", "two channels are named \"A1\""]),
        ("A1 side,A1 side", "A1 side,A1", ["line 3", "column source", "same source"]),
        ("A1 side,A1 side", "A1 side,", ["line 3", "source", "list.csv"]),
        ("full_scale", "range", ["line 1", "no column \"range\"", "full_scale"]),
        ("unit,full_scale", "unit,unit", ["line 1", "two columns", "unit"]),
        ("name,", "label,", ["line 1", "label", "name"]),
        (",2026-03-02,\n", ",2026-03-02,,,\n", ["line 2", "15 cells", "13 columns"]),
    ] {
        let list = pairs();
        assert!(list.contains(from), "{from}");
        let answer = analyze(&recording, &drop.put_list(&list.replacen(from, to, 1)));
        at_fault(&answer, &[&said[..], &["list.csv"]].concat());
    }
    let both = drop.put_list(&pairs());
    let text = fs::read_to_string(&both).expect("it") + &tables(["", ""]).replace("\"A1\"", "\"A9\"");
    at_fault(&analyze(&recording, &drop.bench.put("both.toml", text)), &["A2", "two channels are named"]);
    let elsewhere = drop.bench.put("elsewhere.toml", format!("sensors = \"../list.csv\"\n{}", drop.cask));
    at_fault(
        &analyze(&recording, &elsewhere),
        &["elsewhere.toml", "sensors", "in the folder of the cask file"],
    );
    let missing = drop.bench.put("missing.toml", format!("sensors = \"no.csv\"\n{}", drop.cask));
    at_fault(&analyze(&recording, &missing), &["no.csv", "cannot be read"]);
}

#[test]
fn an_axial_sensor_of_a_list_needs_no_angle() {
    let bench = Bench::new();
    let stated = fs::read_to_string(fixture("vhlw-rest.toml")).expect("a cask file");
    let (cask, _) = stated.split_once("[[channel]]").expect("channels");
    let cask = bench.put("cask.toml", format!("sensors = \"list.csv\"\n{cask}"));
    let list = "name,source,plane_m,around_deg,direction,unit\nA1,/daq/A1,0.15,90,tangential,g\n\
                A2,/daq/A2,4.336,90,tangential,g\nA3,/daq/A3,0.15,,axial,g\n";
    bench.put("list.csv", list);
    let result = analyze(&fixture("vhlw-rest.h5"), &cask).json();
    assert_eq!(result["channels"][2]["axis"], "axial", "{result}");
}

#[test]
fn two_recorders_are_joined_at_the_first_contact() {
    let drop = SkinDrop::new();
    let whole =
        analyze(&drop.bench.0.path().join("drop.csv"), &drop.put_cask("one.toml", &tables(["", ""]))).json();
    // The first recorder may begin earlier or later than the second one.
    for (late_s, skipped) in [(0.137, 0), (-0.137, 900)] {
        let first = drop.record("first.csv", &["A1"], 0.0, &[&|row| row[1]]);
        let text = fs::read_to_string(&first).expect("a recording");
        let kept = text.split_inclusive('\n').enumerate().filter(|(i, _)| *i == 0 || *i > skipped);
        fs::write(&first, kept.map(|(_, line)| line).collect::<String>()).expect("written");
        drop.record("second.csv", &["A2"], late_s, &[&|row| row[2]]);
        let cask = drop.put_cask("two.toml", &tables(["", "file = \"second.csv\""]));
        let result = analyze(&first, &cask).json();
        assert!(apart(&whole, &result) < 0.1, "{}", apart(&whole, &result));
        let text = result.to_string();
        let (_, said) = text.split_once("shift of the times of second.csv").expect("it is stated");
        let shift_ms: f64 = said
            .split_once("value\":\"")
            .and_then(|(_, v)| v.split_once(' '))
            .expect("a value")
            .0
            .parse()
            .expect("ms");
        assert!((shift_ms - 1e3 * late_s).abs() < 0.05, "{shift_ms}");
        assert!(findings(&result).contains("second.csv is of another recorder"), "{}", findings(&result));
    }
    let same = drop.put_cask(
        "same.toml",
        &tables(["", "file = \"first.csv\""]).replace("source = \"A2\"", "source = \"A1\""),
    );
    at_fault(&analyze(&drop.bench.0.path().join("first.csv"), &same), &["first.csv", "delete `file`"]);
    let missing = drop.put_cask("missing.toml", &tables(["", "file = \"no.csv\""]));
    at_fault(&analyze(&drop.bench.0.path().join("first.csv"), &missing), &["no.csv"]);
}

#[test]
fn fifty_one_channels_take_a_list_and_twelve_lines() {
    let drop = SkinDrop::new();
    let heads: Vec<String> =
        ["A1", "A2"].into_iter().map(str::to_owned).chain((3..=51).map(|i| format!("S{i}"))).collect();
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let strains: Vec<_> = (3..=51_u32).map(|i| move |row: [f64; 3]| 0.01 * f64::from(i) * row[1]).collect();
    let ends: [&dyn Fn([f64; 3]) -> f64; 2] = [&|row| row[1], &|row| row[2]];
    let columns: Vec<&dyn Fn([f64; 3]) -> f64> =
        ends.into_iter().chain(strains.iter().map(|strain| strain as &dyn Fn([f64; 3]) -> f64)).collect();
    let recording = drop.record("many.csv", &heads, 0.0, &columns);
    let list = drop.bench.0.path().join("list.csv");
    let made = dropcheck(words!["init", recording, "--sensors", list]);
    assert_eq!(made.status, 0, "{}", made.stderr);
    let lines = made.stdout.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    assert!(lines.count() <= 12, "{}", made.stdout);
    let rows = fs::read_to_string(&list).expect("a list");
    assert_eq!((rows.lines().count(), rows.lines().next()), (52, Some(HEAD)));
    assert!(rows.contains("\nA1,A1 [g],") && rows.contains("\nS51,S51 [g],"), "{rows}");
    at_fault(&dropcheck(words!["init", recording, "--sensors", list]), &["list.csv", "filled in already"]);
    // Filled in as a person does: two planes of accelerometers, all else without an end.
    let filled = rows
        .replace("\nA1,A1 [g],,,,", "\nA1,A1 [g],,0.15,0,radial")
        .replace("\nA2,A2 [g],,,,", "\nA2,A2 [g],,5.362,0,radial");
    fs::write(&list, filled.replace("radial,,,", "radial,,,-1")).expect("written");
    let cask = drop.bench.put("many.toml", format!("sensors = \"list.csv\"\n{}", drop.cask));
    let answer = analyze(&recording, &cask);
    let listed = answer.json();
    let places = tables(["", ""]).replace("-0.282842712", "-0.4").replace("lateral_m = 0.282842712\n", "");
    let stated =
        analyze(&drop.bench.0.path().join("drop.csv"), &drop.put_cask("stated.toml", &places)).json();
    assert!(apart(&stated, &listed) < 0.1, "{}", apart(&stated, &listed));
    assert_eq!(listed["other_channels"].as_array().map(Vec::len), Some(49));
}

/// The axial sensor reads half of what the cask does away from the target, the others a share √½ each.
#[test]
fn a_mounting_block_of_three_has_the_shock_of_its_vector() {
    let drop = SkinDrop::new();
    let share = 0.5_f64.sqrt();
    let recording = drop.record(
        "blocks.csv",
        &["A1", "A1 side", "A1 along", "A2"],
        0.0,
        &[&|row| -share * row[1], &|row| share * row[1], &|row| 0.5 * row[1], &|row| -share * row[2]],
    );
    let table = |name: &str, end: &str, place: &str, direction: &str| {
        format!(
            "[[channel]]\nname = \"{name}\"\nend = \"{end}\"\nsource = \"{name}\"\nposition_m = {place}\n\
             around_deg = 45\ndirection = \"{direction}\"\n"
        )
    };
    let [first, side, along] = [("A1", "radial"), ("A1 side", "tangential"), ("A1 along", "axial")]
        .map(|(name, direction)| table(name, "first", "0.15", direction));
    let cask = drop
        .put_cask("blocks.toml", &[first, side, along, table("A2", "second", "5.362", "radial")].concat());
    let result = analyze(&recording, &cask).json();
    let shocks = result["shocks"].as_array().expect("shocks");
    let first = |name: &str| {
        let of_first = |row: &&Value| row["channel"] == name && row["event"] == "first";
        shocks.iter().find(of_first).unwrap_or_else(|| panic!("{name}: {shocks:?}"))
    };
    let resultant = first("resultant of A1, A1 side, A1 along");
    assert_eq!(resultant["components"], serde_json::json!(["A1", "A1 side", "A1 along"]));
    for key in ["/peak", "/peak_unfiltered", "/velocity_change_m_s", "/displacement_m"] {
        let size = |row: &Value| number(row, key).unwrap_or_else(|| panic!("{key}: {row}")).abs();
        for (name, part) in [("A1", share), ("A1 side", share), ("A1 along", 0.5)] {
            // The feet of the pulse differ by the noise.
            let off = size(first(name)) / size(resultant) / part * 1.25_f64.sqrt() - 1.0;
            assert!(off.abs() < 0.02, "{key} of {name}: {off}: {resultant}");
        }
    }
    let names = shocks.iter().filter_map(|row| row["channel"].as_str());
    assert_eq!(names.filter(|name| name.contains("A2")).count(), 2, "no block of one sensor: {shocks:?}");
}
