//! From the figures of the paper to what is printed of them beside what the program says.

use super::super::hold;
use super::{CASES, PAGE, fixed, predicted, ran, row, table};
use crate::moved::is_renewed;
use crate::run::{fixtures, root};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::ops::RangeInclusive;
use std::path::Path;

/// What a case's column holds at these angles, where the second end strikes.
fn series(
    rows: &[BTreeMap<String, String>],
    case: [&str; 3],
    column: &str,
    angles: RangeInclusive<i32>,
) -> Vec<f64> {
    let is_case = |row: &BTreeMap<String, String>| {
        ["model", "contact", "k"].iter().zip(case).all(|(key, is)| row[*key] == is)
    };
    let is_within = |row: &BTreeMap<String, String>| {
        let angle_deg: f64 = row["angle_deg"].parse().expect("an angle");
        (f64::from(*angles.start())..=f64::from(*angles.end())).contains(&angle_deg)
    };
    let of_case = rows.iter().filter(|row| is_case(row) && is_within(row));
    of_case.filter_map(|row| row[column].parse().ok()).collect()
}

/// "1.00 to 1.05".
fn range(numbers: &[f64], decimals: usize) -> String {
    let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let most = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!("{least:.decimals$} to {most:.decimals$}")
}

/// Copies pictures to the page's folder where they are to be renewed; they are there.
fn pictures(from: &Path, names: &[String]) {
    let folder = root().join("docs/measured/paper");
    for name in names {
        let picture = fs::read(from.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        if is_renewed() {
            fs::create_dir_all(&folder).expect("a folder");
            fs::write(folder.join(name), picture).expect("a picture can be written");
        }
        assert!(folder.join(name).exists(), "docs/measured/paper/{name}: write it with BLESS=1");
    }
}

/// The figures of `prediction.csv`: number, what the paper says, what is here, picture.
fn figures(rows: &[BTreeMap<String, String>]) -> [[String; 4]; 6] {
    let rod = |contact, k, column, angles| series(rows, ["rod", contact, k], column, angles);
    let speed = |contact, k, angles| {
        // The paper holds the first end on the target for k = 0.
        let column = if k == "0" { "closed_form_speed_m_s" } else { "slap_down_speed_m_s" };
        rod(contact, k, column, angles)
    };
    let at = |contact, k| {
        [5, 25, 45].map(|angle| format!("{:.1}", speed(contact, k, angle..=angle)[0])).join(", ")
    };
    let sideways = |contact| fixed(rod(contact, "1", "cog_horizontal_after_impact_m_s", 15..=15)[0]);
    let energy = |contact, k, to| range(&rod(contact, k, "energy_ratio", 1..=to), 2);
    let cases = CASES.map(|(contact, _, k)| (contact, if k > 0.0 { "1" } else { "0" }));
    let largest = cases.map(|(contact, k)| speed(contact, k, 1..=60).into_iter().fold(0.0, f64::max));
    assert!(largest.iter().all(|other| *other <= largest[3]), "{largest:?}");
    let largest = [0, 1, 2, 3].map(|i| format!("{}, k = {}: {:.1}", cases[i].0, cases[i].1, largest[i]));
    let section = |angle: i32| {
        let speed_of = |model| series(rows, [model, "smooth", "1"], "slap_down_speed_m_s", angle..=angle)[0];
        format!("{:.1}, {:.1}", speed_of("rod"), speed_of("body"))
    };
    let row = |number: &str, printed: &str, here: String, picture: &str| {
        [number.to_owned(), printed.to_owned(), here, picture.to_owned()]
    };
    [
        row(
            "2, 3",
            "smooth: S moves only vertically; rough: L does not slide in the impact",
            format!("ẋ_S2 for k = 1, m/s: smooth {}, rough {}", sideways("smooth"), sideways("rough")),
            "positions",
        ),
        row(
            "4",
            "smooth: between 5° and 45° the speed \"isn't much changing\", above 13.3 m/s",
            format!(
                "k = 0: {}; k = 1: {} m/s",
                range(&speed("smooth", "0", 5..=45), 1),
                range(&speed("smooth", "1", 5..=45), 1)
            ),
            "components-smooth",
        ),
        row(
            "5",
            "rough: k = 1 declines sharply with the angle; k = 0 slightly up to 25°, then significantly",
            format!("at 5°, 25°, 45°: k = 0: {}; k = 1: {} m/s", at("rough", "0"), at("rough", "1")),
            "components-rough",
        ),
        row(
            "7",
            "smooth, k = 1 yields the highest velocity",
            format!("largest, m/s: {}", largest.join("; ")),
            "smooth-rough",
        ),
        row(
            "8",
            "k = 1, up to nearly 40°: 1 to 1.05; k = 0, up to 30°: 0.7 to 0.8",
            format!(
                "k = 1, up to 38°: rough {}, smooth {}; k = 0, up to 30°: rough {}, smooth {}",
                energy("rough", "1", 38),
                energy("smooth", "1", 38),
                energy("rough", "0", 30),
                energy("smooth", "0", 30)
            ),
            "energy-ratio",
        ),
        row(
            "9",
            "smooth, k = 1: 500 mm × 600 mm differs little up to 40°, beyond it decreases more",
            format!("rod, body at 15°, 40°, 55°: {} m/s", [15, 40, 55].map(section).join("; ")),
            "section",
        ),
    ]
}

#[test]
fn figures_2_to_9_stand_beside_what_is_read_off_them() {
    let (folder, rows) = predicted("rod.toml", " --sweep 1:60:1");
    let mut table = "| figure | in the paper | here | picture |\n|---|---|---|---|\n".to_owned();
    let mut names = Vec::new();
    for [number, printed, here, picture] in figures(&rows) {
        table += &row(&number, [printed, here, format!("![Fig. {number}](measured/paper/{picture}.svg)")]);
        names.push(format!("{picture}.svg"));
    }
    hold(PAGE, "figures", &table);
    pictures(&folder.path().join("p"), &names);
}

#[test]
fn figures_12_and_13_stand_beside_a_drop_of_that_shape() {
    let folder = tempfile::tempdir().expect("a folder");
    let [drop, cask, out] = ["drop.mcap", "drop.toml", "r"].map(|name| folder.path().join(name));
    let scene = fixtures().join("reference/paper-scene.toml");
    ran("synth SCENE --out DROP", &[("SCENE", &scene), ("DROP", &drop)]);
    ran("analyze DROP --cask CASK --out OUT", &[("DROP", &drop), ("CASK", &cask), ("OUT", &out)]);
    let result: Value =
        serde_json::from_slice(&fs::read(out.join("result.json")).expect("a result")).expect("JSON");
    assert_eq!(result["verdict"], "pass", "{}", result["quality"]);
    let truth: Value =
        serde_json::from_slice(&fs::read(folder.path().join("drop.truth.json")).expect("a truth"))
            .expect("JSON");
    let stated = |pointer: &str, decimals: usize| {
        let quantity = &result.pointer(pointer).unwrap_or_else(|| panic!("no {pointer}"));
        let [value, u95] = ["value", "u95"]
            .map(|key| quantity[key].as_f64().unwrap_or_else(|| panic!("{pointer}: {quantity}")));
        format!("{value:.decimals$} ± {u95:.decimals$}")
    };
    let known = |key: &str, factor: f64, decimals: usize| {
        format!("{:.decimals$}", factor * truth[key].as_f64().expect(key))
    };
    let time_s = |event: &str| result[event]["time"]["value"].as_f64().expect("a time");
    let mut table = "| Figs. 12, 13 | in the paper | analysed | true |\n|---|---|---|---|\n".to_owned();
    table += &row(
        "both ends before the first impact, m/s",
        ["13".to_owned(), stated("/first_impact/impact_velocity", 2), known("v0", 1.0, 2)],
    );
    table += &row(
        "second end 10 ms after first contact, m/s",
        ["21".to_owned(), format!("{:.1}", second_end_after_10_ms(&out, &result)), "–".to_owned()],
    );
    table += &row(
        "first impact, ms",
        [
            "\"a few\", 10 for the second end".to_owned(),
            format!("{:.1}", 1e3 * result["first_impact"]["duration"]["value"].as_f64().expect("a duration")),
            known("contact_s", 1e3, 1),
        ],
    );
    table += &row(
        "slap-down speed, m/s",
        ["\"nearly 24\"".to_owned(), stated("/slap_down/speed", 2), known("speed", 1.0, 2)],
    );
    table += &row(
        "from first to second impact, ms",
        [
            "60 to 70".to_owned(),
            format!("{:.1}", 1e3 * (time_s("slap_down") - time_s("first_impact"))),
            known("slap_t", 1e3, 1),
        ],
    );
    hold(PAGE, "drop", &table);
    pictures(&out, &["accelerations.svg", "velocities.svg"].map(str::to_owned));
}

/// How fast the second end of the rigid cask falls 10 ms after first contact, m/s.
fn second_end_after_10_ms(folder: &Path, result: &Value) -> f64 {
    let began_s = result["first_impact"]["time"]["value"].as_f64().expect("a time");
    let curves = table(&folder.join("curves.csv"));
    let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().expect("a number");
    let row = curves.iter().find(|row| number(row, "time_s") >= began_s + 0.01).expect("a row");
    -number(row, "vertical_velocity_second_m_s")
}
