//! From what a person types, and from files that are at fault, to exit status, messages and a clean standard
//! output.

use crate::run::{Answer, analyze, dropcheck, fixture, words};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder of files at fault, gone when it is dropped.
pub struct Bench(pub tempfile::TempDir);

impl Bench {
    /// An empty one.
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// Puts a file in it.
    pub fn put(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, content).expect("a temporary file");
        path
    }

    /// What `synth` makes of a scene: NAME.csv, with its cask file and its truth beside it.
    #[track_caller]
    pub fn synth(&self, name: &str, scene: impl AsRef<[u8]>) -> PathBuf {
        let made = self.0.path().join(format!("{name}.csv"));
        let scene = self.put(&format!("{name}-scene.toml"), scene);
        let answer = dropcheck(words!["synth", scene, "--out", made]);
        assert_eq!(answer.status, 0, "{}", answer.stderr);
        made
    }
}

/// The example scene with an axial channel on each end.
pub fn scene_with_axial_channels() -> String {
    let axial = |(name, end, position_m): (&str, &str, f64)| {
        format!(
            "[[channel]]\nname = \"{name}\"\nend = \"{end}\"\naxis = \"axial\"\n\
             position_m = {position_m}\nsample_rate_hz = 25000\nwhite_noise_g = 0.1\n"
        )
    };
    let scene = fs::read_to_string(fixture("scene-anf18.toml")).expect("the example scene");
    scene + "\n" + &[("B1", "first", 0.15), ("B2", "second", 5.362)].map(axial).concat()
}

/// A cask file of the fixtures with `from` replaced by `to`.
fn cask_with(bench: &Bench, stem: &str, from: &str, to: &str) -> PathBuf {
    let text = fs::read_to_string(fixture(&format!("{stem}.toml"))).expect("a cask file");
    assert!(text.contains(from), "{stem}.toml has no {from:?}");
    bench.put("cask.toml", text.replace(from, to))
}

#[test]
fn colours_and_silence_are_as_asked_for() {
    let with = |more: &[&str]| {
        let (recording, cask) = (fixture("anf18-json.mcap"), fixture("anf18-json.toml"));
        let words = words!["analyze", recording, "--cask", cask];
        dropcheck(words.into_iter().chain(more.iter().map(std::ffi::OsStr::new)))
    };
    assert!(with(&["--color", "always"]).stdout.contains("\u{1b}[1;32mDATA SOUND"));
    assert!(!with(&["--color", "never"]).stdout.contains('\u{1b}'));
    let quiet = with(&["--quiet"]);
    assert_eq!((quiet.status, &quiet.stdout[..], &quiet.stderr[..]), (0, "", ""));
    assert!(with(&["--quiet", "--json", "-"]).stdout.starts_with("{\n"));
}

#[test]
fn a_recording_that_is_none_by_its_name_is_refused_with_the_line_that_mends_it() {
    let (recording, cask) = (fixture("anf18-json.mcap"), fixture("anf18-json.toml"));
    let exchanged = dropcheck(words!["analyze", cask, "--cask", recording]);
    at_fault(&exchanged, &["anf18-json.toml is a cask file", "anf18-json.mcap --cask "]);
    at_fault(&dropcheck(words!["analyze", "-", "--cask", cask]), &["standard input", "into a file"]);
}

/// One message on standard error that holds every one of `words`; exit 2, nothing on standard output, nobody
/// panicked.
#[track_caller]
pub fn at_fault(answer: &Answer, words: &[&str]) {
    let Answer { status, stdout, stderr } = answer;
    assert_eq!(*status, 2, "stdout: {stdout}\nstderr: {stderr}");
    assert!(stdout.is_empty(), "standard output is not empty: {stdout}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    // Messages may be wrapped at the terminal's width.
    let flat: String = stderr.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
    for word in words {
        assert!(flat.to_lowercase().contains(&word.to_lowercase()), "no {word:?} in: {stderr}");
    }
    let messages = stderr.lines().filter(|line| line.trim_start().starts_with(['×', '✖'])).count();
    assert!(messages <= 1, "more than one message: {stderr}");
    assert!(!stderr.trim().is_empty(), "no message");
    assert!(stderr.lines().count() <= 25, "a message, not a book: {stderr}");
}

fn plain() -> (PathBuf, PathBuf) {
    (fixture("anf10-plain.csv"), fixture("anf10-plain.toml"))
}

#[test]
fn an_empty_recording() {
    let bench = Bench::new();
    at_fault(&analyze(&bench.put("empty.mcap", ""), &plain().1), &["empty.mcap", "empty"]);
}

#[test]
fn a_folder_for_a_recording() {
    let bench = Bench::new();
    at_fault(&analyze(bench.0.path(), &plain().1), &["director"]);
}

#[test]
fn a_recording_that_is_not_there() {
    at_fault(&analyze(Path::new("no-such-file.mcap"), &plain().1), &["no-such-file.mcap"]);
}

#[test]
fn a_text_file_called_mcap() {
    let bench = Bench::new();
    let text = bench.put("letter.mcap", "Dear colleague,\n\nplease find the recording attached.\n");
    at_fault(&analyze(&text, &plain().1), &["letter.mcap"]);
}

#[test]
fn random_bytes() {
    let bench = Bench::new();
    let bytes: Vec<u8> = (0_u32..4096).map(|i| i.wrapping_mul(2_654_435_761).to_be_bytes()[1]).collect();
    at_fault(&analyze(&bench.put("noise.h5", bytes), &plain().1), &["noise.h5"]);
}

#[test]
fn an_empty_cask_file_and_one_that_is_not_there() {
    let bench = Bench::new();
    at_fault(&analyze(&plain().0, &bench.put("empty.toml", "")), &["empty.toml", "cask"]);
    at_fault(&analyze(&plain().0, Path::new("no-such-cask.toml")), &["no-such-cask.toml"]);
}

#[test]
fn a_cask_file_without_channels() {
    let bench = Bench::new();
    let text = fs::read_to_string(plain().1).expect("a cask file");
    let cask = bench.put("cask.toml", text.split("[[channel]]").next().expect("a head"));
    at_fault(&analyze(&plain().0, &cask), &["cask.toml", "channel"]);
}

#[test]
fn a_key_that_is_misspelt_and_a_value_out_of_range() {
    let bench = Bench::new();
    let cask = cask_with(&bench, "anf10-plain", "length_m", "lenght_m");
    at_fault(&analyze(&plain().0, &cask), &["cask.toml", "lenght_m", "length_m"]);
    let cask = cask_with(&bench, "anf10-plain", "mass_kg = 1429.0", "mass_kg = -1429.0");
    at_fault(&analyze(&plain().0, &cask), &["cask.toml", "mass_kg"]);
    let cask = cask_with(&bench, "anf10-plain", "angle_deg = 25.0", "angle_deg = \"25°\"");
    at_fault(&analyze(&plain().0, &cask), &["cask.toml", "angle_deg"]);
}

#[test]
fn a_nan_in_the_cask_file() {
    let bench = Bench::new();
    for nan in ["nan", "inf"] {
        let cask = cask_with(&bench, "anf10-plain", "mass_kg = 1429.0", &format!("mass_kg = {nan}"));
        at_fault(&analyze(&plain().0, &cask), &["cask.toml", "mass_kg"]);
    }
}

#[test]
fn a_nan_among_the_samples_is_an_issue_and_no_crash() {
    let bench = Bench::new();
    let text = fs::read_to_string(plain().0).expect("a recording");
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let time = lines[300].split(',').next().expect("a time").to_owned();
    lines[300] = format!("{time},NaN,0.1");
    let answer = analyze(&bench.put("nan.csv", lines.join("\n")), &plain().1);
    assert!(answer.status <= 1, "{}", answer.stderr);
    let result = answer.json();
    let issues = result["quality"].as_array().expect("issues");
    assert!(issues.iter().any(|i| i["code"] == "non_finite" || i["code"] == "gap"), "{issues:?}");
}

#[test]
fn a_topic_that_is_not_there_names_the_nearest() {
    let bench = Bench::new();
    let cask = cask_with(&bench, "anf18-json", "/daq/a2.samples", "/daq/b2.samples");
    let recording = fixture("anf18-json.mcap");
    at_fault(&analyze(&recording, &cask), &["/daq/b2", "/daq/a2"]);
    let cask = cask_with(&bench, "anf18-json", "/daq/a2.samples", "/daq/a2.sample");
    at_fault(&analyze(&recording, &cask), &["sample", "samples"]);
}

#[test]
fn a_dataset_and_a_column_that_are_not_there_name_the_nearest() {
    let bench = Bench::new();
    let cask = cask_with(&bench, "vhlw-rest", "/daq/A2", "/daq/A4");
    at_fault(&analyze(&fixture("vhlw-rest.h5"), &cask), &["/daq/A4", "/daq/A"]);
    let cask = cask_with(&bench, "anf10-plain", "source = \"A2\"", "source = \"B2\"");
    at_fault(&analyze(&plain().0, &cask), &["B2", "A2"]);
}

#[test]
fn a_column_of_words() {
    let bench = Bench::new();
    let text = fs::read_to_string(plain().0).expect("a recording");
    let rows = text.lines().enumerate().map(|(i, line)| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if i > 0 {
            cells[2] = "broken";
        }
        cells.join(",")
    });
    let words = bench.put("words.csv", rows.collect::<Vec<_>>().join("\n"));
    at_fault(&analyze(&words, &plain().1), &["words.csv", "A2", "broken"]);
}

#[test]
fn a_sample_rate_of_zero() {
    let bench = Bench::new();
    let cask =
        cask_with(&bench, "vhlw-rest", "source = \"/daq/A1\"", "source = \"/daq/A1\"\nsample_rate_hz = 0.0");
    at_fault(&analyze(&fixture("vhlw-rest.h5"), &cask), &["sample_rate_hz"]);

    let recording = bench.0.path().join("rate.mcap");
    let mut writer = mcap::Writer::new(fs::File::create(&recording).expect("a file")).expect("a writer");
    for (id, topic) in [(0_u32, "/daq/a1"), (1, "/daq/a2")] {
        let channel =
            writer.add_channel(0, topic, "json", &std::collections::BTreeMap::new()).expect("a channel");
        let data =
            br#"{"timestamp":{"sec":1,"nsec":0},"sample_rate_hz":0.0,"unit":"g","samples":[0.1,0.2,0.3]}"#;
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: id, log_time: 5, publish_time: 5 };
        writer.write_to_known_channel(&header, data).expect("a message");
    }
    writer.finish().expect("a whole file");
    at_fault(&analyze(&recording, &fixture("anf18-json.toml")), &["rate"]);
}

#[test]
fn a_folder_that_cannot_be_written() {
    let bench = Bench::new();
    let blocked = bench.put("occupied", "a file where a folder is wanted").join("out");
    let (recording, cask) = plain();
    let answer = dropcheck(words!["analyze", recording, "--cask", cask, "--out", blocked]);
    at_fault(&answer, &["occupied"]);
}

#[test]
fn words_that_are_no_command() {
    assert_eq!(dropcheck(["analyse"]).status, 2);
    assert_eq!(dropcheck(["analyze"]).status, 2);
    assert_eq!(dropcheck(["analyze", "x.mcap", "--cask"]).status, 2);
    let help = dropcheck(["--help"]);
    assert_eq!(help.status, 0);
    for command in ["analyze", "predict", "inspect", "init"] {
        assert!(help.stdout.contains(command), "--help does not name {command}");
    }
}

#[test]
fn standard_output_holds_json_alone() {
    let (recording, cask) = plain();
    let answer = analyze(&recording, &cask);
    assert_eq!(answer.json()["schema"], "dropcheck.result/1", "{}", answer.stderr);
    let inspected = dropcheck(words!["inspect", recording, "--json", "-"]);
    assert!(inspected.json()["channels"].is_array());
    let predicted = dropcheck(words!["predict", "--cask", cask, "--json", "-"]);
    let predicted = predicted.json();
    assert_eq!(predicted["schema"], "dropcheck.prediction/1");
    // Rough and smooth, k = 0 and 1, of the rod and of the body that the file describes.
    assert_eq!(predicted["predictions"].as_array().map(Vec::len), Some(8));
}

#[test]
fn the_result_has_the_keys_of_the_contract() {
    let (recording, cask) = (fixture("anf18-german.csv"), fixture("anf18-german.toml"));
    let result = analyze(&recording, &cask).json();
    let keys = [
        "/version",
        "/input/recording",
        "/input/recording_sha256",
        "/input/cask",
        "/input/cask_sha256",
        "/first_impact/time",
        "/first_impact/impact_velocity",
        "/first_impact/duration",
        "/first_impact/rebound_velocity",
        "/first_impact/angular_velocity",
        "/slap_down/time",
        "/slap_down/flight_time",
        "/slap_down/speed",
        "/slap_down/vertical_velocity",
        "/slap_down/horizontal_velocity",
        "/slap_down/angle",
        "/k",
        "/model/name",
        "/model/reason",
        "/model/candidates",
        "/predictions/0/slap_down_speed_m_s",
        "/predictions/0/vertical_velocity_m_s",
        "/predictions/0/horizontal_velocity_m_s",
        "/predictions/0/angular_velocity_rad_s",
        "/predictions/0/flight_time_s",
        "/predictions/0/energy_ratio",
        "/comparison/predicted",
        "/comparison/measured",
        "/comparison/difference_percent",
        "/comparison/agrees",
        "/quality",
        "/verdict",
    ];
    for key in keys {
        assert!(result.pointer(key).is_some(), "no {key} in the result");
    }
    for (key, unit) in [
        ("/slap_down/speed", "m/s"),
        ("/k", "1"),
        ("/slap_down/angle", "deg"),
        ("/first_impact/angular_velocity", "rad/s"),
    ] {
        assert_eq!(result.pointer(&format!("{key}/unit")).and_then(|v| v.as_str()), Some(unit), "{key}");
    }
}

#[test]
fn the_recording_is_never_altered() {
    let bench = Bench::new();
    for name in ["anf18-json.mcap", "vhlw-rest.h5", "anf18-german.csv", "damaged-truncated.mcap"] {
        let before = fs::read(fixture(name)).expect("a fixture");
        let copy = bench.put(name, &before);
        let stamp = fs::metadata(&copy).and_then(|m| m.modified()).expect("a time");
        let stem = name.split('.').next().expect("a stem");
        let cask = fixture(&format!("{stem}.toml"));
        let out = bench.0.path().join("out");
        dropcheck(words!["analyze", copy, "--cask", cask, "--out", out, "--force"]);
        dropcheck(words!["inspect", copy]);
        dropcheck(words!["init", copy]);
        assert!(fs::read(&copy).expect("the copy") == before, "{name} was altered");
        assert_eq!(
            fs::metadata(&copy).and_then(|m| m.modified()).expect("a time"),
            stamp,
            "{name} was written"
        );
    }
}

#[test]
fn init_writes_a_cask_file_that_can_be_read_as_toml() {
    for name in ["anf18-json.mcap", "vhlw-rest.h5", "anf18-german.csv", "esbb-imu.mcap"] {
        let answer = dropcheck(words!["init", fixture(name)]);
        assert_eq!(answer.status, 0, "{name}: {}", answer.stderr);
        let text = answer.stdout;
        let parsed: Result<toml::Table, _> = toml::from_str(&text);
        assert!(parsed.is_ok(), "{name}: {parsed:?}\n{text}");
        assert!(text.contains("[[channel]]"), "{name}: {text}");
    }
}

#[test]
fn every_output_of_a_run_is_there() {
    let bench = Bench::new();
    let (recording, cask) = plain();
    let out = bench.0.path().join("report");
    let answer = dropcheck(words!["analyze", recording, "--cask", cask, "--out", out]);
    assert!(answer.status <= 1, "{}", answer.stderr);
    for name in ["report.html", "result.json", "curves.csv", "curves.h5", "curves.mcap"] {
        let bytes = fs::read(out.join(name)).unwrap_or_default();
        assert!(!bytes.is_empty(), "{name} is missing or empty");
    }
    let html = fs::read_to_string(out.join("report.html")).expect("a page");
    for outside in ["src=\"http", "href=\"http", "url(http", "@import"] {
        assert!(!html.contains(outside), "the report reaches for the network: {outside}");
    }
}

#[test]
fn a_correction_switched_off_is_said_in_the_result() {
    let (recording, cask) = (fixture("anf18-json.mcap"), fixture("anf18-json.toml"));
    let with = |more: &[&str]| {
        let words = words!["analyze", recording, "--cask", cask, "--json"];
        dropcheck(words.into_iter().chain(words!["-"]).chain(more.iter().map(AsRef::as_ref)))
    };
    let off = |answer: &Answer| -> Vec<String> {
        let result = answer.json();
        let settings = result["processing"].as_array().expect("a list").clone();
        let off = settings.iter().filter(|s| s["origin"] == "command line, --without");
        off.map(|s| s["name"].as_str().expect("a name").to_owned()).collect()
    };
    assert!(off(&with(&[])).is_empty());
    let answer = with(&["--without", "hum,offset", "--without", "offset"]);
    assert_eq!(off(&answer), ["correction offset", "correction hum"]);
    assert_eq!(answer.json()["settings"]["corrections"]["hum"]["from"], "command line");
    assert_eq!(answer.json()["settings"]["corrections"]["skew"]["from"], "default");
    // What is not taken off shows as an offset of nothing.
    assert_eq!(answer.json()["channels"][0]["offset_m_s2"], 0.0);
    assert!(with(&[]).json()["channels"][0]["offset_m_s2"] != 0.0);
    at_fault(&with(&["--without", "noise"]), &["noise", "offset, zero_shift, skew, hum"]);
}
