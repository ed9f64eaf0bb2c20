//! From what a person asks of `predict` to rows, files, limits and messages.

use crate::command_line::{Bench, at_fault};
use crate::run::{Answer, analyze, dropcheck, fixture, number, words};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// ANF-18 of the paper: 15°, 9 m, a section of 0.792 m.
const ANF18: &str = "[cask]\nname = \"ANF-18\"\nmass_kg = 4466\nlength_m = 5.512\nheight_m = 0.792\n\
                     [drop]\nheight_m = 9.0\nangle_deg = 15\n";

/// Enough draws to have every file, few enough for a test.
const FEW: &str = "--draws 20";

/// `predict --cask CASK` with further words.
fn predict(cask: &str, words: &str) -> Answer {
    let bench = Bench::new();
    let path = bench.put("cask.toml", cask);
    let words = words.split_whitespace().map(std::ffi::OsStr::new);
    dropcheck(words!["predict", "--cask", path].into_iter().chain(words))
}

/// The rows of `--json -`.
#[track_caller]
fn rows(words: &str) -> Vec<Value> {
    let answer = predict(ANF18, &format!("{words} {FEW} --json -"));
    assert_eq!(answer.status, 0, "{words}: {}", answer.stderr);
    answer.json()["predictions"].as_array().cloned().expect("predictions")
}

fn of(row: &Value, key: &str) -> f64 {
    number(row, &format!("/{key}")).unwrap_or_else(|| panic!("no number {key} in {row}"))
}

fn bodies(rows: Vec<Value>, model: &str) -> Vec<Value> {
    rows.into_iter().filter(|row| row["model"] == model).collect()
}

#[test]
fn words_that_make_no_sense_are_told_what_would() {
    let cases: [(&str, &[&str]); 34] = [
        ("--k 2", &["--k", "between 0", "and 1"]),
        ("--k -0.1", &["--k", "between 0"]),
        ("--k nan", &["--k", "no finite number"]),
        ("--k half", &["--k", "half is no number"]),
        ("--angle 120", &["--angle", "between 0 (flat) and 90 (upright) degrees"]),
        ("--angle -5", &["--angle", "between 0"]),
        ("--angle inf", &["--angle", "no finite number"]),
        ("--angle 15°", &["--angle", "15° is no number", "without a unit"]),
        ("--angle 1.000,5", &["--angle", "decimal point"]),
        ("--contact -0.2", &["--contact", "not negative"]),
        ("--contact glatt", &["--contact", "rough, smooth"]),
        ("--contact nan", &["--contact"]),
        ("--sweep 5:45", &["--sweep", "FROM:TO:STEP"]),
        ("--sweep 0:90:0", &["STEP is 0", "above 0"]),
        ("--sweep 90:0:1", &["TO (0) lies below FROM (90)", "exchange"]),
        ("--sweep 0:120:1", &["TO is 120", "angle", "between 0 (flat) and 90"]),
        ("--sweep k=0:2:0.1", &["TO is 2", "k lies between 0 and 1"]),
        ("--sweep friction=-1:1:0.1", &["FROM is -1", "friction is 0 or more"]),
        ("--sweep length=0:6:1", &["FROM is 0", "length lies between 0.01", "metres"]),
        ("--sweep height=0:9:1", &["FROM is 0", "height lies between 0.001", "metres"]),
        ("--sweep lenght=4:6:1", &["no variable lenght", "angle, k, friction, length, height"]),
        ("--sweep mass=1:2:1", &["no variable mass", "angle, k, friction, length, height"]),
        ("--sweep 0:9:1 --sweep angle=0:9:1", &["twice", "one --sweep for each variable"]),
        ("--sweep 0:9:1 --angle 5", &["--angle and --sweep angle", "leave out"]),
        ("--sweep k=0:1:1 --k 0", &["--k and --sweep k", "leave out"]),
        ("--sweep friction=0:1:1 --contact rough", &["--contact and --sweep friction", "leave out"]),
        ("--sweep length=0.5:6:0.5", &["section of the cask is 0.792 m", "height_m", "cask.toml"]),
        ("--sweep 0:90:0.01 --sweep k=0:1:0.01", &["at most 200000", "larger STEP"]),
        ("--band 0", &["--band", "above 0 and at most 50"]),
        ("--band 51", &["--band", "at most 50"]),
        ("--k-range 0.7:0.3", &["--k-range", "below FROM"]),
        ("--friction-range 0.4", &["--friction-range", "FROM:TO"]),
        ("--angle-tolerance 45", &["--angle-tolerance", "between 0 and 20 degrees"]),
        ("--draws 2000000", &["--draws", "0 (no draws) to 1000000"]),
    ];
    for (words, parts) in cases {
        at_fault(&predict(ANF18, words), parts);
    }
}

#[test]
fn a_cask_that_cannot_be_is_told_its_key() {
    let cases: [(&str, &str, &[&str]); 13] = [
        ("mass_kg = 4466", "mass_kg = -4466", &["line 3", "mass_kg is -4466", "0.001 to 1000000"]),
        ("mass_kg = 4466", "mass_kg = nan", &["line 3", "mass_kg is nan"]),
        ("length_m = 5.512", "length_m = 0", &["line 4", "length_m is 0"]),
        ("height_m = 0.792", "height_m = 7.92", &["line 5", "section is longer than the cask", "exchanged"]),
        ("height_m = 0.792", "", &["[cask] has no height_m", "height_m = 0.8"]),
        ("height_m = 0.792", "height_m = -0.8", &["line 5", "height_m is -0.8"]),
        (
            "height_m = 0.792",
            "height_m = 0.792\ncog_m = 5.6",
            &["line 6", "outside the cask", "from the first end"],
        ),
        ("height_m = 0.792", "height_m = 0.792\ninertia_kg_m2 = -1", &["line 6", "inertia_kg_m2 is -1"]),
        // About an end instead of the centre of gravity: m l²/3.
        (
            "height_m = 0.792",
            "height_m = 0.792\ninertia_kg_m2 = 45229",
            &["line 6", "about the centre of gravity", "at most"],
        ),
        ("height_m = 9.0", "height_m = -9", &["line 7", "height_m is -9"]),
        ("angle_deg = 15", "angle_deg = 120", &["line 8", "outside 0 to 90"]),
        (
            "angle_deg = 15",
            "angle_deg = 15\n[contact]\nfriction = -0.4",
            &["line 10", "coefficient of friction"],
        ),
        ("angle_deg = 15", "angle_deg = 15\ngravity_m_s2 = inf", &["line 9", "gravity_m_s2", "finite"]),
    ];
    for (right, wrong, parts) in cases {
        assert!(ANF18.contains(right));
        at_fault(&predict(&ANF18.replacen(right, wrong, 1), ""), parts);
    }
}

#[test]
fn at_the_corners_of_what_a_drop_may_be_it_comes_to_an_end() {
    let begun = std::time::Instant::now();
    for (cask, drop) in [
        ("mass_kg = 1e6\nlength_m = 100\nheight_m = 0", "height_m = 2.6"),
        ("mass_kg = 1e-3\nlength_m = 0.01\nheight_m = 0.01", "impact_velocity_m_s = 20"),
        ("mass_kg = 4466\nlength_m = 5.5\nheight_m = 0.8\ncog_m = 0.56", "height_m = 0.14"),
        (
            "mass_kg = 4466\nlength_m = 5.5\nheight_m = 0\ninertia_kg_m2 = 113",
            "height_m = 0.14\ngravity_m_s2 = 1",
        ),
        ("mass_kg = 4466\nlength_m = 0.2\nheight_m = 0.2", "impact_velocity_m_s = 30\ngravity_m_s2 = 1"),
        (
            "mass_kg = 4466\nlength_m = 5.5\nheight_m = 0\ncog_m = 4.9",
            "impact_velocity_m_s = 200\ngravity_m_s2 = 3000",
        ),
    ] {
        let text = format!("[cask]\n{cask}\n[drop]\n{drop}\nangle_deg = 15\n[contact]\nfriction = 0.3\n");
        let answer = predict(&text, "--draws 50 --json -");
        assert_eq!(answer.status, 0, "{text}{}", answer.stderr);
    }
    // Each takes less than a second where nothing else runs and the program is made for speed.
    assert!(begun.elapsed() < std::time::Duration::from_mins(3));
}

#[test]
fn limits_of_angle_restitution_and_friction_are_predicted() {
    // Flat: both ends are at the target, R strikes at once; upright: nothing turns a thin rod.
    for (words, strikes) in [("--angle 0", true), ("--angle 90", false)] {
        for row in bodies(rows(words), "rod") {
            assert_eq!(row["slap_down_speed_m_s"].is_number(), strikes, "{words}: {row}");
        }
    }
    let speed = |words: &str| of(&bodies(rows(words), "rod")[0], "slap_down_speed_m_s");
    // [P] Table 3, by an independent program to four digits.
    assert!((speed("--k 1 --contact rough") - 25.0376).abs() < 5e-5);
    assert!(speed("--k 0 --contact rough") < speed("--k 1 --contact rough"));
    // μ = 0 is smooth, μ above what sticking needs (0.624 for the rod at 15°) is rough: the same numbers, bit
    // for bit.
    for (coefficient, law) in [("0", "smooth"), ("0.7", "rough")] {
        let by = |contact: &str| speed(&format!("--k 0.5 --contact {contact}")).to_bits();
        assert_eq!(by(coefficient), by(law), "{coefficient} {law}");
    }
}

#[test]
fn without_options_the_four_borderline_cases_of_rod_and_body() {
    let rows = rows("");
    let case = |r: &Value| format!("{} {} {}", r["model"], r["contact"], r["k"]).replace('"', "");
    let found: BTreeSet<String> = rows.iter().map(case).collect();
    let expected = ["rod", "body"].into_iter().flat_map(|model| {
        ["rough", "smooth"].into_iter().flat_map(move |c| ["0.0", "1.0"].map(|k| format!("{model} {c} {k}")))
    });
    assert_eq!(rows.len(), 8);
    assert_eq!(found, expected.collect());
    let keys = [
        "slap_down_speed_m_s",
        "vertical_velocity_m_s",
        "horizontal_velocity_m_s",
        "angular_velocity_rad_s",
        "flight_time_s",
        "energy_ratio",
        "angle_deg",
        "length_m",
        "drop_height_m",
        "friction_to_stick",
    ];
    for row in &rows {
        for key in keys {
            assert!(row[key].is_number(), "{key} in {row}");
        }
    }
}

#[test]
fn each_variable_is_swept() {
    let sorted = |rows: &[Value], key: &str| -> Vec<f64> { rows.iter().map(|row| of(row, key)).collect() };
    for (words, key, values) in [
        ("--sweep 10:20:5", "angle_deg", [10.0, 15.0, 20.0]),
        ("--sweep angle=10:20:5", "angle_deg", [10.0, 15.0, 20.0]),
        ("--sweep k=0,2:0,6:0,2", "k", [0.2, 0.4, 0.6]),
        ("--sweep length=4:6:1", "length_m", [4.0, 5.0, 6.0]),
        ("--sweep height=1:9:4", "drop_height_m", [1.0, 5.0, 9.0]),
    ] {
        let fixed = if key == "k" { "--contact rough" } else { "--contact rough --k 0.5" };
        let rows = bodies(rows(&format!("{words} {fixed}")), "body");
        assert_eq!(sorted(&rows, key), values, "{words}");
        let speeds = sorted(&rows, "slap_down_speed_m_s");
        // Rounding moves a speed by 1e-14 m/s, each of these steps by centimetres a second.
        let moves = speeds.windows(2).all(|pair| (pair[1] - pair[0]).abs() > 1e-3);
        assert!(moves, "{words} changes nothing: {speeds:?}");
    }
    // Section of ANF-18, 15°, k = 0.5, by an independent program to four digits.
    let rows = bodies(rows("--sweep friction=0:0.9:0.3 --k 0.5"), "body");
    let contacts: Vec<&str> = rows.iter().filter_map(|row| row["contact"].as_str()).collect();
    assert_eq!(contacts, ["0", "0.3", "0.6", "0.9"]);
    for (row, expected) in rows.iter().zip([23.67, 22.31]) {
        assert!((of(row, "slap_down_speed_m_s") - expected).abs() < 5e-3, "{row}");
    }
    assert!((of(&rows[3], "slap_down_speed_m_s") - 20.18).abs() < 5e-3, "0.9 sticks: {}", rows[3]);
}

#[test]
fn a_height_swept_overrides_an_impact_velocity_of_the_cask_file() {
    let cask = ANF18.replace("angle_deg = 15", "angle_deg = 15\nimpact_velocity_m_s = 13.3");
    let answer = predict(&cask, &format!("--sweep height=1:9:8 --k 0.5 {FEW} --json -"));
    let rows = answer.json()["predictions"].as_array().cloned().expect("predictions");
    let rows = bodies(rows, "rod");
    let ratio = of(&rows[1], "angular_velocity_rad_s") / of(&rows[0], "angular_velocity_rad_s");
    // ω goes with v0 = √(2 g h): √9 between 1 and 9 m, but for rounding.
    assert!((ratio - 3.0).abs() < 1e-12, "{ratio}");
}

#[test]
fn several_sweeps_make_every_combination_once() {
    let rows = rows("--sweep 10:40:10 --sweep k=0:1:0.5 --sweep height=3:9:3 --contact smooth");
    let point = |r: &Value| format!("{} {} {} {}", r["model"], r["angle_deg"], r["k"], r["drop_height_m"]);
    let points: BTreeSet<String> = rows.iter().map(point).collect();
    assert_eq!((rows.len(), points.len()), (4 * 3 * 3 * 2, 4 * 3 * 3 * 2));
}

#[test]
fn a_point_is_a_sweep_of_one() {
    assert_eq!(rows("--sweep 15:15:1 --k 0.5"), rows("--angle 15 --k 0.5"));
}

#[test]
fn every_file_is_written_and_standard_output_stays_clean() {
    let bench = Bench::new();
    let out = bench.0.path().join("prediction");
    let words = format!("--sweep 0:90:5 {FEW} --json - --out {}", out.display());
    let answer = predict(ANF18, &words);
    assert_eq!((answer.status, answer.stderr.as_str()), (0, ""));
    let document = answer.json();
    assert_eq!(document["schema"], "dropcheck.prediction/1");
    let files = names_in(&out);
    for name in ["prediction.html", "prediction.json", "prediction.csv"] {
        assert!(files.contains(name), "{files:?}");
    }
    assert!(files.iter().any(|name| is_picture(name)), "{files:?}");
    for name in &files {
        let text = fs::read_to_string(out.join(name)).expect("a text file");
        assert!(!text.is_empty(), "{name} is empty");
        assert!(!text.contains("NaN") && !text.contains(">inf"), "{name} holds what is no number");
        if is_picture(name) {
            assert!(text.trim_end().ends_with("</svg>"), "{name} is no whole picture");
        }
    }
    let page = fs::read_to_string(out.join("prediction.html")).expect("a page");
    for outside in ["src=\"http", "href=\"http", "url(http", "@import"] {
        assert!(!page.contains(outside), "the page reaches for the network: {outside}");
    }
    let csv = fs::read_to_string(out.join("prediction.csv")).expect("a table");
    let predictions = document["predictions"].as_array().map_or(0, Vec::len);
    assert_eq!((csv.lines().count(), predictions), (1 + predictions, 19 * 8));

    // A second run replaces the first; another program's file is left alone.
    assert_eq!(predict(ANF18, &words).status, 0);
    assert_eq!(names_in(&out), files);
    fs::write(out.join("prediction.json"), "{}").expect("a file");
    at_fault(&predict(ANF18, &words), &["was not written by dropcheck"]);
}

fn names_in(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
}

fn is_picture(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|ending| ending == "svg")
}

#[test]
fn a_fine_grid_of_angle_and_restitution_finishes_with_its_charts() {
    let bench = Bench::new();
    let out = bench.0.path().join("grid");
    let words = format!("--sweep 0:90:0.5 --sweep k=0:1:0.01 {FEW} --out {}", out.display());
    let answer = predict(ANF18, &words);
    assert_eq!(answer.status, 0, "{}", answer.stderr);
    let csv = fs::read_to_string(out.join("prediction.csv")).expect("a table");
    assert_eq!(csv.lines().count(), 1 + 181 * 101 * 2);
    assert!(answer.stdout.lines().count() < 200, "a table of {} lines", answer.stdout.lines().count());
}

#[test]
fn the_seed_alone_decides_what_is_drawn() {
    let drawn = |words: &str| predict(ANF18, &format!("{words} --json -")).json()["monte_carlo"].clone();
    let first = drawn("--draws 50 --seed 1");
    assert!(first["quantiles"][0]["largest"][2].is_number(), "{first}");
    assert!(first == drawn("--draws 50 --seed 1"), "the same seed gives other draws");
    assert!(first["quantiles"] != drawn("--draws 50 --seed 2")["quantiles"], "the seed changes nothing");
}

/// The first sentences, behind the line of the drop.
fn first_words(cask: &str, words: &str) -> String {
    let stdout = predict(cask, words).stdout;
    stdout.split_whitespace().skip_while(|word| *word != "m/s²").skip(1).collect::<Vec<_>>().join(" ")
}

#[test]
fn where_to_drop_is_said_first() {
    let known = "--k-range 0.3:0.7 --friction-range 0.2:0.6 --draws 120";
    for (words, begins) in [
        (format!("{known} --duration 0"), "Drop between 0.4° and "),
        (format!("{known} --duration 0 --angle-tolerance 2"), "Drop between 2° and "),
        // Both ends touch at once where a contact of 30 ms outlasts the fall of the second end.
        (known.to_owned(), "Drop between 5° and "),
        (
            "--band 0.1 --draws 60".to_owned(),
            "At no angle is the slap-down speed of 95 % of the draws within 0.1 % of that draw's largest: k, \
             friction and the contact's length are too uncertain.",
        ),
        ("--draws 0".to_owned(), "Predictions"),
    ] {
        let said = first_words(ANF18, &words);
        assert!(said.starts_with(begins), "{words}: {said}");
        let is_drawn = !words.ends_with("--draws 0");
        assert_eq!(said.contains(" Your 15° gives 2"), is_drawn, "{words}: {said}");
        assert_eq!(
            said.contains("° or flatter both ends may strike"),
            words.contains("--duration"),
            "{words}"
        );
    }
}

#[test]
fn the_sentence_has_the_numbers_of_the_advice() {
    let words = format!("{FEW} --angle 30");
    let advice = &predict(ANF18, &format!("{words} --json -")).json()["advice"];
    let said = first_words(ANF18, &words);
    let [own, low, high] = ["own_m_s", "own_range_m_s/0", "own_range_m_s/1"].map(|key| of(advice, key));
    let largest = of(advice, "largest_m_s");
    assert!(
        said.contains(&format!("Your 30° gives {own:.2} m/s (95 % of the draws: {low:.2} to {high:.2})"))
    );
    assert!(said.contains(&format!("The largest of the cask's body is {largest:.2} m/s")), "{said}");
    // An unknown friction is drawn from none: at 30° only a smooth first end lets the second down at 20 m/s.
    assert!(high > 20.0 && advice["drawn"]["friction"][0] == 0.0, "{advice}");
}

#[test]
fn no_headline_is_below_a_value_of_its_own_study() {
    let paper = ["anf10", "anf18", "esbb", "vhlw"].map(|name| {
        let path = crate::run::root().join("fixtures/paper").join(name).with_extension("toml");
        fs::read_to_string(path).expect("a cask file")
    });
    let lengths_s = [0.002, 0.004, 0.006, 0.008, 0.01, 0.012, 0.015, 0.02, 0.03, 0.04, 0.05];
    let of_paper =
        lengths_s.iter().enumerate().map(|(i, s)| (paper[i % 4].clone(), format!("--duration {s}")));
    // Length, section, centre of gravity, drop and angle; low falls among them.
    let drawn = [(1.2, 0.3, 0.55, 0.9, 29.0), (6.5, 0.4, 3.0, 0.4, 8.0), (2.4, 1.0, 1.2, 2.0, 60.0)];
    let drawn = drawn.map(|(length_m, height_m, cog_m, drop_m, angle_deg)| {
        let cask = format!("mass_kg = 900\nlength_m = {length_m}\nheight_m = {height_m}\ncog_m = {cog_m}");
        (format!("[cask]\n{cask}\n[drop]\nheight_m = {drop_m}\nangle_deg = {angle_deg}\n"), String::new())
    });
    for (cask, words) in of_paper.chain(drawn) {
        let study = predict(&cask, &format!("{words} {FEW} --sweep 0:90:3 --json -")).json();
        let advice = &study["advice"];
        let (largest, model) = (of(advice, "largest_m_s"), &study["monte_carlo"]["model"]);
        let list = |value: &Value| value.as_array().cloned().expect("a list");
        let is_single = |row: &&Value| row["first_end_impacts"] == 1 && row["turns_over"] == false;
        let rows = list(&study["predictions"]);
        let of_rows = rows.iter().filter(|row| row["model"] == *model).filter(is_single);
        let critical = list(&study["critical_angles"]);
        let of_cases = critical.iter().filter(|c| c["model"] == *model && c["criterion"] == "speed");
        let speeds = &study["monte_carlo"]["quantiles"][0];
        let of_draws = ["q025", "q50", "q975", "largest"].map(|key| list(&speeds[key])).concat();
        let all = of_rows.map(|row| &row["slap_down_speed_m_s"]).chain(of_cases.map(|c| &c["largest"]));
        let all: Vec<f64> =
            all.chain(&of_draws).chain([&advice["own_m_s"]]).filter_map(Value::as_f64).collect();
        let highest = all.iter().copied().fold(0.0, f64::max);
        assert!(all.len() > 100 && largest >= highest, "{words} {cask}: {largest} below {highest}");
        // Of each quantile, the largest of the draws is no smaller than the draws at any one angle.
        let (medians, none) = (list(&speeds["q50"]), list(&study["monte_carlo"]["no_slap_down"]));
        let whole = medians.iter().zip(&none).filter(|(_, none)| **none == 0.0);
        let median = whole.filter_map(|(median, _)| median.as_f64()).fold(0.0, f64::max);
        assert!(median > 0.0 && of(speeds, "largest/2") >= median, "{words} {cask}");
    }
}

#[test]
fn the_advised_band_is_safe_whatever_the_length_of_the_contact() {
    for known in ["--k 0.5 --contact 0.4", "--k 0.8 --contact rough"] {
        let advice = &predict(ANF18, &format!("{known} --draws 60 --json -")).json()["advice"];
        let [from_deg, to_deg] = ["band_deg/0", "band_deg/1"].map(|key| of(advice, key));
        for lasts in ["0.005", "0.01", "0.02", "0.03"] {
            let mut swept = bodies(rows(&format!("{known} --duration {lasts} --sweep 0:45:0.25")), "body");
            swept.retain(|row| row["slap_down_speed_m_s"].is_number());
            let speed = |row: &Value| of(row, "slap_down_speed_m_s");
            let largest = swept.iter().map(speed).fold(0.0, f64::max);
            let is_in_band = |row: &&Value| (from_deg..=to_deg).contains(&of(row, "angle_deg"));
            let least = swept.iter().filter(is_in_band).map(speed).fold(f64::INFINITY, f64::min);
            // A draw's largest value may lack 0.1 %.
            assert!(least >= (0.95 - 0.001) * largest, "{known} {lasts}: {least} {largest} {advice}");
        }
    }
}

#[test]
fn tolerances_of_the_cask_file_are_drawn() {
    let spread = |angle_deg: f64| {
        let stated = "height_m = 0.792\ncog_m = 2.756\ninertia_kg_m2 = 11540";
        let cask =
            ANF18.replace("height_m = 0.792", stated) + &format!("[tolerance]\nangle_deg = {angle_deg}\n");
        let words = "--k 0.5 --contact rough --duration 0 --draws 120 --angle 40 --json -";
        let advice = &predict(&cask, words).json()["advice"];
        assert!((of(advice, "drawn/angle_deg") - angle_deg).abs() < 1e-12, "{advice}");
        of(advice, "own_range_m_s/1") - of(advice, "own_range_m_s/0")
    };
    let (narrow, wide) = (spread(0.1), spread(3.0));
    assert!(wide > 2.0 * narrow, "{narrow} {wide}");
}

#[test]
fn neither_a_shoulder_nor_a_somersault_is_a_critical_angle() {
    let answer = predict(ANF18, &format!("{FEW} --sweep 60:80:1 --json -")).json();
    let over = |row: &Value| row["slap_down_angle_deg"].as_f64().is_some_and(|angle| angle.abs() >= 90.0);
    let rows = answer["predictions"].as_array().expect("predictions");
    assert!(rows.iter().any(over) && rows.iter().all(|row| row["turns_over"] == over(row)));
    // The energy ratio of the body, rough, k = 1, rises to a maximum at 78° that is too narrow to be hit: 75°
    // lies on its flank.
    let answer = predict(ANF18, &format!("{FEW} --json -")).json();
    let critical = answer["critical_angles"].as_array().expect("critical angles");
    let highest = |c: &Value| {
        let bands = c["bands_deg"].as_array().expect("bands").iter();
        bands.filter_map(|band| band[1].as_f64()).fold(of(c, "angle_deg"), f64::max)
    };
    assert!(critical.len() == 24 && critical.iter().all(|c| highest(c) < 60.0), "{critical:?}");
}

#[test]
fn the_plan_expects_the_intervals_that_the_drop_then_has() {
    for name in ["anf18-json", "anf10-protobuf", "esbb-imu"] {
        let [cask, recording] = [format!("{name}.toml"), format!("{name}.mcap")];
        let [cask, recording] = [cask.as_str(), recording.as_str()];
        let found = analyze(&fixture(recording), &fixture(cask)).json();
        let k = number(&found, "/k/value").expect("k").to_string();
        let plan = dropcheck(words!["predict", "-c", fixture(cask), "--k", k, "--draws", "0", "--json", "-"]);
        let plan = &plan.json()["plan"];
        let expected = plan["intervals"].as_array().expect("intervals");
        for (key, path) in [("slap_down_speed_u95_m_s", "/slap_down/speed/u95"), ("k_u95", "/k/u95")] {
            let ratios: Vec<f64> =
                expected.iter().map(|e| of(e, key) / number(&found, path).expect("an interval")).collect();
            // Noise, ringing and what the recording tests are its own.
            assert!((0.6..1.6).contains(&ratios[0]), "{cask}, {key}: {ratios:?}");
            assert!(ratios[1..].iter().all(|more| *more <= ratios[0] + 1e-9), "{cask}, {key}: {ratios:?}");
        }
        for channel in plan["channels"].as_array().expect("channels") {
            let peaks = channel["peaks"].as_array().expect("peaks");
            assert!(peaks.iter().all(|peak| (5.0..1500.0).contains(&of(peak, "peak_g"))), "{channel}");
        }
    }
}

#[test]
fn no_draws_are_no_monte_carlo() {
    let answer = predict(ANF18, "--draws 0");
    assert_eq!((answer.status, answer.stderr.as_str()), (0, ""));
    assert!(!answer.stdout.contains("NaN"), "{}", answer.stdout);
}

#[test]
fn tables_and_help_fit_the_terminal() {
    for words in ["", "--k 0.5 --contact 0.3", "--sweep 5:45:5", "--sweep k=0:1:0.25 --sweep 0:90:10"] {
        let table = predict(ANF18, &format!("{words} {FEW}"));
        let widest = table.stdout.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(80), "{words}: {}", table.stdout);
    }
    let help = dropcheck(["predict", "--help"]);
    assert!(help.stdout.lines().all(|line| line.chars().count() <= 100), "{}", help.stdout);
    for word in ["--band", "--k-range", "--draws", "length", "height", "Examples:"] {
        assert!(help.stdout.contains(word), "--help does not name {word}");
    }
}
