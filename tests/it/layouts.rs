//! From recordings laid out in other ways than the examples to their numbers, or to what is wrong with them.

use crate::run::{Answer, analyze, dropcheck, fixture, number, words};
use hdf5_metno::H5Type;
use hdf5_metno::types::VarLenUnicode;
use std::path::Path;
use std::{fs, iter};

fn init(path: &Path) -> Answer {
    dropcheck(words!["init", path])
}

/// The table of `rows` under a header, in a file of its own.
fn table(header: &str, rows: impl Fn(u32) -> String) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("drop.csv");
    let lines = iter::once(header.to_owned()).chain((0..400).map(rows));
    fs::write(&path, lines.collect::<Vec<_>>().join("\n") + "\n").expect("a temporary file");
    (folder, path)
}

#[test]
fn init_refuses_a_recording_that_no_cask_file_could_read() {
    for (header, word) in
        [("t [s];A1 [g];A2 [g]", "1.234,5"), ("t [s];A1;A2", "oops"), ("t [s];A1 [g];n", "1 234,0")]
    {
        let row = |i: u32| {
            format!(
                "{},{:04};{word};{}",
                i / 10_000,
                i % 10_000,
                if header.ends_with('n') { "7" } else { word }
            )
        };
        let (_folder, path) = table(header, row);
        let answer = init(&path);
        assert_eq!((answer.status, answer.stdout.as_str()), (2, ""), "{header}: {}", answer.stderr);
        let told = answer.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        for part in ["drop.csv", "A1", word, "inspect"] {
            assert!(told.contains(part), "{header}: {told} without {part:?}");
        }
    }
}

#[test]
fn init_names_what_it_leaves_out() {
    let cell = |i: u32| if i == 40 { "oops".into() } else { format!("{i},5") };
    let (_folder, path) = table("t [s];A1 [g];A2 [g]", |i| format!("0,{i:04};{};{i},25", cell(i)));
    let answer = init(&path);
    assert_eq!(answer.status, 0, "{}", answer.stderr);
    assert!(
        answer.stdout.contains("#   A1 [g]: 1 of 400 cells are no numbers, such as \"oops\""),
        "{}",
        answer.stdout
    );
    assert_eq!(answer.stdout.matches("\n[[channel]]\n").count(), 1, "{}", answer.stdout);
}

#[test]
fn a_stated_rate_that_contradicts_the_stamps_is_named_beside_what_comes_of_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cask = folder.path().join("cask.toml");
    let form = fs::read_to_string(fixture("anf18-json.toml")).expect("the cask file");
    for (rate_hz, has_impact) in [(4e6, false), (2e4, true)] {
        let stated = format!("[[channel]]\nsample_rate_hz = {rate_hz:.1}\n");
        fs::write(&cask, form.replace("[[channel]]\n", &stated)).expect("a cask file");
        let answer = analyze(&fixture("anf18-json.mcap"), &cask);
        let result = answer.json();
        assert_eq!(answer.status, 1, "{result}");
        let issues = result["quality"].as_array().expect("issues");
        let told = |code: &str| -> Vec<&str> {
            issues.iter().filter(|i| i["code"] == code).filter_map(|i| i["message"].as_str()).collect()
        };
        let contradictions = told("clock");
        assert!(contradictions.iter().any(|m| m.contains("the first was taken")), "{rate_hz}: {result}");
        assert!(told("gap").is_empty() && told("duplicate_blocks").is_empty(), "{rate_hz}: {result}");
        if has_impact {
            assert!(number(&result, "/first_impact/time/value").is_some(), "{rate_hz}: {result}");
        } else {
            let impact = told("no_impact");
            assert!(impact[0].contains("rate of A1 is in doubt"), "{impact:?}");
        }
    }
}

/// A record of a logger's table.
#[derive(H5Type, Clone)]
#[repr(C)]
struct Row {
    time_ms: f64,
    a1: f32,
    a2: f32,
}

/// The plain fixture as channels in rows, as records, and as scaled integers.
fn in_hdf5(path: &Path) -> hdf5_metno::Result<()> {
    let text = fs::read_to_string(fixture("anf10-plain.csv")).expect("the recording");
    let cells = |line: &str| -> Vec<f64> { line.split(',').filter_map(|cell| cell.parse().ok()).collect() };
    let rows: Vec<Vec<f64>> = text.lines().skip(1).map(cells).collect();
    #[allow(clippy::cast_possible_truncation, reason = "a few digits of g")]
    let single = |value: f64| value as f32;
    #[allow(clippy::cast_possible_truncation, reason = "hundredths of g")]
    let hundredths = |value: f64| (100.0 * value).round() as i32;
    let channel = |column: usize| rows.iter().map(move |row| row[column]);
    let file = hdf5_metno::File::create(path)?;
    let text = |name: &str, place: &hdf5_metno::Location, value: &str| {
        let value: VarLenUnicode = value.parse().expect("text");
        place.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&value)
    };
    let shape = (2, rows.len());
    let in_rows =
        file.new_dataset::<f32>().shuffle().deflate(4).chunk((1, 1000)).shape(shape).create("rows")?;
    in_rows.write_raw(&channel(1).chain(channel(2)).map(single).collect::<Vec<_>>())?;
    text("fs", &in_rows, "12.5 kHz")?;
    let scaled = file.new_dataset::<i32>().shape(shape).create("scaled")?;
    scaled.write_raw(&channel(1).chain(channel(2)).map(hundredths).collect::<Vec<_>>())?;
    scaled.new_attr::<f64>().create("dt")?.write_scalar(&8e-5)?;
    scaled.new_attr::<f64>().create("scale_factor")?.write_scalar(&0.01)?;
    let records: Vec<Row> = rows
        .iter()
        .map(|row| Row { time_ms: 1e3 * row[0], a1: single(row[1]), a2: single(row[2]) })
        .collect();
    file.new_dataset_builder().chunk(1000).with_data(&records).create("table")?;
    for name in ["rows", "scaled", "table"] {
        let dataset = file.dataset(name)?;
        text("units", &dataset, "g")?;
    }
    file.close()
}

#[test]
fn the_numbers_do_not_hang_on_the_layout() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (path, cask) = (folder.path().join("drop.h5"), folder.path().join("cask.toml"));
    in_hdf5(&path).expect("a recording");
    let plain = analyze(&fixture("anf10-plain.csv"), &fixture("anf10-plain.toml")).json();
    let form = fs::read_to_string(fixture("anf10-plain.toml")).expect("the cask file");
    for sources in [["/rows[0]", "/rows[1]"], ["/scaled[0]", "/scaled[1]"], ["/table.a1", "/table.a2"]] {
        let form = form.replace("unit = \"g\"\n", "");
        let form = form.replace("source = \"A1\"", &format!("source = {:?}", sources[0]));
        fs::write(&cask, form.replace("source = \"A2\"", &format!("source = {:?}", sources[1])))
            .expect("a cask file");
        let answer = analyze(&path, &cask);
        let result = answer.json();
        for pointer in ["/slap_down/speed/value", "/k/value", "/slap_down/flight_time/value"] {
            let (value, expected) =
                (number(&result, pointer).expect(pointer), number(&plain, pointer).expect(pointer));
            // Single precision, and times in another unit.
            assert!((value / expected - 1.0).abs() < 1e-4, "{sources:?} {pointer}: {value} for {expected}");
        }
        assert_eq!(result["verdict"], plain["verdict"], "{sources:?}");
    }
    let form = init(&path).stdout;
    for part in ["/rows[0]", "/scaled[1]", "/table.a2", "12500 Hz", "stored × 0.01"] {
        assert!(form.contains(part), "{part}: {form}");
    }
}
