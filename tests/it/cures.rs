//! From refusals to the cures that they print, each tried once: the analysis goes on.

use crate::run::{analyze, fixture};
use std::fs;
use std::path::Path;
use std::process::Command;

/// What is wrong with a recording or its cask file, what the refusal prints, and both as it says.
struct Cure {
    table: String,
    cask: String,
    printed: &'static str,
    cured_table: String,
    cured_cask: String,
}

impl Cure {
    /// By lines in the cask file.
    fn by_cask(table: &str, cask: &str, printed: &'static str, cured_cask: &str) -> Self {
        let [table, cask, cured_table, cured_cask] = [table, cask, table, cured_cask].map(str::to_owned);
        Self { table, cask, printed, cured_table, cured_cask }
    }

    /// By another table.
    fn by_table(table: &str, cask: &str, printed: &'static str, cured_table: &str) -> Self {
        let [table, cask, cured_table, cured_cask] = [table, cask, cured_table, cask].map(str::to_owned);
        Self { table, cask, printed, cured_table, cured_cask }
    }

    fn try_out(&self, folder: &Path) {
        let [recording, cask_file] = ["drop.csv", "drop.toml"].map(|name| folder.join(name));
        let answer = |table: &str, cask: &str| {
            fs::write(&recording, table).expect("a table");
            fs::write(&cask_file, cask).expect("a cask file");
            analyze(&recording, &cask_file)
        };
        let refused = answer(&self.table, &self.cask);
        let is_printed = refused.stderr.split_once("help: ").is_some_and(|(_, help)| {
            help.split_whitespace().collect::<Vec<_>>().join(" ").contains(self.printed)
        });
        assert!(refused.status == 2 && is_printed, "{}: {}", self.printed, refused.stderr);
        let cured = answer(&self.cured_table, &self.cured_cask);
        assert_ne!(cured.status, 2, "{}: {}", self.printed, cured.stderr);
    }
}

/// The rows of a sound drop at 12.5 kHz.
fn rows() -> Vec<[f64; 3]> {
    let text = fs::read_to_string(fixture("anf10-plain.csv")).expect("the example");
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        [cells[0], cells[1], cells[2]]
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn a_cure_that_is_printed_for_a_table_leads_on() {
    let rows = rows();
    let table = |head: &str, row: &dyn Fn(usize, [f64; 3]) -> String| {
        rows.iter().enumerate().fold(format!("{head}\n"), |text, (at, own)| text + &row(at, *own) + "\n")
    };
    let plain = |_: usize, [t, a, b]: [f64; 3]| format!("{t:.5},{a},{b}");
    let untimed = |_: usize, [_, a, b]: [f64; 3]| format!("{a},{b}");
    let whole = |_: usize, [t, a, b]: [f64; 3]| format!("{t:.5},{:.0},{:.0}", a / 0.9, b / 0.9);
    let sound = table("Time [s],A1,A2", &plain);
    let cask = fs::read_to_string(fixture("anf10-plain.toml")).expect("the example");
    let each = |line: &str| cask.replace("[[channel]]", &format!("[[channel]]\n{line}"));
    let recording = |line: &str| format!("[recording]\n{line}\n{cask}");
    let rate = each("sample_rate_hz = 12500");
    let without_unit = cask.replace("unit = \"g\"\n", "");
    let unit = |lines: &str| without_unit.replace("[[channel]]", &format!("[[channel]]\n{lines}"));
    let clk = table("clk,A1,A2", &plain);
    let none = table("A1,A2", &untimed);
    let furlong = table("Time [furlong],A1,A2", &plain);
    let micro = |head: &str| table(head, &|_, [t, a, b]| format!("{:.0},{a},{b}", t * 1e6));
    let sensors = table("Time,I,A1,A2", &|at, [t, a, b]| format!("{t:.5},{},{a},{b}", at % 2));
    let counts = format!("factor,0.9\n{}", table("Time [s],A1,A2", &whole));
    let coarse = table("Time [s],A1,A2", &|_, [t, a, b]| format!("{t:.1},{a},{b}"));
    let twice = table("Time [s],A1,A2", &|at, [_, a, b]| format!("{:.5},{a},{b}", rows[at / 2][0]));
    let lost = table("n,Time [s],A1,A2", &|at, own| {
        format!("{},{}", at + 4 * usize::from(at > 600), plain(at, own))
    });
    let blank = none.replace('\n', "\n\n");
    let fallen =
        rows.iter().rev().fold("Time [s],A1,A2\n".to_owned(), |text, own| text + &plain(0, *own) + "\n");
    let bad_cell = sound.replacen(&format!(",{},", rows[50][1]), ",oops,", 1);
    let no_time = sound.replacen(&format!("\n{:.5},", rows[50][0]), "\nnan,", 1);
    let commas = table("Time,A1,A2", &|at, own| plain(at, own).replace(',', ";").replace('.', ","));
    let no_end = cask.replacen("source = \"A2\"", "source = \"A22\"", 1);
    for cure in [
        Cure::by_cask(&clk, &cask, "time = \"…\"", &recording("time = \"clk\"")),
        Cure::by_cask(&none, &cask, "give this channel sample_rate_hz", &rate),
        Cure::by_cask(&furlong, &cask, "give this channel sample_rate_hz", &rate),
        Cure::by_table(&furlong, &cask, "correct it in a copy", &sound),
        Cure::by_table(&micro("Time,A1,A2"), &cask, "head the column with [µs]", &micro("Time [µs],A1,A2")),
        Cure::by_cask(&micro("Time,A1,A2"), &cask, "sample_rate_hz = 12500", &rate),
        Cure::by_cask(
            &sensors,
            &cask,
            "where = { column = \"I\", is = \"0\" }",
            &each("where = { column = \"I\", is = \"0\" }"),
        ),
        Cure::by_cask(
            &sensors,
            &each("where = { column = \"I\", is = \"7\" }"),
            "as where = { column = \"I\", is = \"0\" }",
            &each("where = { column = \"I\", is = \"0\" }"),
        ),
        Cure::by_cask(&counts, &cask, "scale = 0.9", &each("scale = 0.9")),
        Cure::by_cask(&counts, &cask, "scale = 1", &each("scale = 1")),
        Cure::by_cask(&sound, &without_unit, "`unit = \"g\"`", &cask),
        Cure::by_cask(&sound, &without_unit, "`sensitivity`", &unit("unit = \"mV\"\nsensitivity = 1.0")),
        Cure::by_cask(
            &sound.replace("A1,A2", "A1 [mV],A2 [mV]"),
            &without_unit,
            "`unit = \"mV\"` and `sensitivity`",
            &unit("unit = \"mV\"\nsensitivity = 1.0"),
        ),
        Cure::by_cask(&sound.replace("A1,A2", "A1 [bar],A2 [bar]"), &without_unit, "`unit = \"g\"`", &cask),
        Cure::by_cask(&coarse, &cask, "give sample_rate_hz", &rate),
        Cure::by_cask(&twice, &cask, "sample_rate_hz = 25000", &each("sample_rate_hz = 25000")),
        Cure::by_cask(&lost, &cask, "write time = \"Time [s]\"", &recording("time = \"Time [s]\"")),
        Cure::by_cask(
            &lost,
            &cask,
            "write time = \"n\" under [recording] of the cask file and sample_rate_hz",
            &format!("[recording]\ntime = \"n\"\n{rate}"),
        ),
        Cure::by_table(&blank, &rate, "delete the empty lines", &none),
        Cure::by_table(&fallen, &recording("time = \"Time [s]\""), "sort the rows", &sound),
        Cure::by_table(&bad_cell, &cask, "or empty it", &bad_cell.replace("oops", "")),
        Cure::by_table(
            &no_time,
            &cask,
            "fill the time in",
            &no_time.replace("\nnan,", &format!("\n{:.5},", rows[50][0])),
        ),
        Cure::by_table(&commas.replace(';', ","), &cask, "`dropcheck inspect", &commas.replacen(',', ";", 2)),
        Cure::by_cask(&sound, &no_end, "did you mean A2?", &cask),
        Cure::by_cask(
            &sound,
            &cask.replace("source = \"A1\"", "source = { topic = \"/a\", field = \"b\" }"),
            "source = \"A1\"",
            &cask,
        ),
    ] {
        cure.try_out(tempfile::tempdir().expect("a temporary folder").path());
    }
}

#[test]
fn a_cure_that_is_printed_for_messages_or_datasets_leads_on() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cask_file = folder.path().join("drop.toml");
    for (stem, from, to, printed) in [
        ("anf18-json.mcap", "/daq/a1.samples", "/daq/a1", "`source = \"/daq/a1.FIELD\"`"),
        ("anf18-json.mcap", "/daq/a1.samples", "/daq/a11.samples", "did you mean /daq/a1"),
        ("anf18-json.mcap", "[[channel]]", "[[channel]]\ntime = \"clock\"", "take `time` out"),
        ("vhlw-rest.h5", "\"/daq/A1\"", "\"/daq\"", "name one of the datasets in it"),
        ("vhlw-rest.h5", "\"/daq/A1\"", "\"/daq/A\"", "/daq/A1"),
        (
            "vhlw-rest.h5",
            "source = \"/daq/A1\"",
            "source = { topic = \"/a\", field = \"b\" }",
            "source = \"/daq/a1\"",
        ),
        ("vhlw-rest.h5", "[[channel]]", "[recording]\ntime = \"/daq/t\"\n[[channel]]", "there is"),
    ] {
        let recording = fixture(stem);
        let cask = fs::read_to_string(recording.with_extension("toml")).expect("the example");
        let wrong = cask.replacen(from, to, 1);
        assert_ne!(wrong, cask, "{stem}: {from}");
        fs::write(&cask_file, wrong).expect("a cask file");
        let refused = analyze(&recording, &cask_file);
        let help = refused.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(refused.status == 2 && help.contains(printed), "{printed}: {}", refused.stderr);
        fs::write(&cask_file, cask).expect("a cask file");
        assert_ne!(analyze(&recording, &cask_file).status, 2, "{printed}");
    }
}

/// The options that refusals print for tools of others are theirs, where these are installed.
#[test]
fn options_of_other_tools_are_spelt_as_these_spell_them() {
    for (tool, asks, options) in [
        ("h5repack", &["--help"][..], &["-f", "GZIP=", "--merge"][..]),
        ("h5clear", &["--help"], &["-s"]),
        ("h5dump", &["--help"], &["-H"]),
        ("mcap", &["convert", "--help"], &["mcap convert"]),
        ("mcap", &["recover", "--help"], &["mcap recover"]),
        ("ros2", &["bag", "convert", "--help"], &["ros2 bag convert"]),
        ("nccopy", &["-h"], &["-k"]),
    ] {
        let Ok(said) = Command::new(tool).args(asks).output() else {
            println!("skipped: {tool} is not installed");
            continue;
        };
        let said =
            [said.stdout, said.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
        assert!(options.iter().all(|option| said.contains(option)), "{tool}: {said}");
    }
}
