//! From times as loggers write them (clocks, coarse steps, milliseconds) to the numbers that plain seconds
//! give, or to a question.

use crate::run::{Answer, analyze, dropcheck, fixture, number, words};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

const RATE_HZ: u32 = 25_000;

/// A sound drop as a table of seconds, and its cask file.
struct Drop {
    folder: tempfile::TempDir,
    /// Each row's number and what follows its time.
    rows: Vec<(u32, String)>,
    rate_hz: u32,
}

impl Drop {
    /// The example scene at a rate, of so many seconds before first contact.
    fn of(rate_hz: u32, before_s: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let scene = fs::read_to_string(fixture("scene-anf18.toml")).expect("the example scene");
        let scene = scene
            .replace("before_s = 0.1 ", &format!("before_s = {before_s} "))
            .replace("sample_rate_hz = 25000", &format!("sample_rate_hz = {rate_hz}"))
            .replace("anti_alias_hz = 8000.0", &format!("anti_alias_hz = {}", rate_hz / 3));
        let path = folder.path().join("scene.toml");
        fs::write(&path, scene).expect("a temporary file");
        let out = folder.path().join("seconds.csv");
        let words = words!["synth", path, "--out", out];
        let answer = dropcheck(words);
        assert_eq!(answer.status, 0, "{}", answer.stderr);
        let table = fs::read_to_string(&out).expect("the recording");
        let cells = table.lines().skip(1).filter_map(|line| line.split_once(',')).map(|row| row.1.to_owned());
        let rows = (0..).zip(cells).collect();
        // As for a recording whose times are found by themselves.
        let cask = fs::read_to_string(out.with_extension("toml")).expect("the cask file");
        fs::write(folder.path().join("cask.toml"), cask.replace("time = \"time_s\"\n", ""))
            .expect("a cask file");
        Self { folder, rows, rate_hz }
    }

    /// The table with these times, `mark` between its cells and decimal commas beside semicolons.
    fn table(&self, header: &str, mark: char, time: impl Fn(u32) -> String) -> PathBuf {
        let mut text = format!("{header}{mark}A1 [g]{mark}A2 [g]\n");
        for (i, cells) in &self.rows {
            let cells = cells.replace(',', "\t");
            let cells = if mark == ';' { cells.replace('.', ",") } else { cells };
            let _ = writeln!(text, "{}{mark}{}", time(*i), cells.replace('\t', &mark.to_string()));
        }
        let path = self.folder.path().join("drop.csv");
        fs::write(&path, text).expect("a temporary file");
        path
    }

    fn analyzed(&self, recording: &Path) -> Answer {
        analyze(recording, &self.folder.path().join("cask.toml"))
    }

    /// The cask file states the rate.
    fn state_rate(&self) {
        let path = self.folder.path().join("cask.toml");
        let cask = fs::read_to_string(&path).expect("the cask file");
        let stated = format!("[[channel]]\nsample_rate_hz = {}\n", self.rate_hz);
        fs::write(&path, cask.replace("[[channel]]\n", &stated)).expect("a cask file");
    }

    /// Row `i` on a clock that began so many microseconds after midnight: hours to minutes, and seconds.
    fn clock(&self, from_us: u64, i: u32, point: char) -> (String, String) {
        let at_us = (from_us + u64::from(i) * 1_000_000 / u64::from(self.rate_hz)) % 86_400_000_000;
        let s = at_us / 1_000_000;
        (
            format!("{:02}:{:02}", s / 3600, s / 60 % 60),
            format!("{:02}{point}{:06}", s % 60, at_us % 1_000_000),
        )
    }

    /// Row `i` in seconds, begun at `from_us` and cut to steps of so many microseconds.
    fn cut(&self, from_us: u32, step_us: u32, i: u32) -> String {
        let at_us = from_us + i * (1_000_000 / self.rate_hz);
        let cut_us = at_us / step_us * step_us;
        format!("{}.{:06}", cut_us / 1_000_000, cut_us % 1_000_000)
    }
}

const NUMBERS: [&str; 5] = [
    "/slap_down/speed/value",
    "/slap_down/flight_time/value",
    "/k/value",
    "/first_impact/duration/value",
    "/first_impact/angular_velocity/value",
];

/// The result of a sound drop: the same numbers as of seconds to `part` of themselves.
#[track_caller]
fn agrees(what: &str, answer: &Answer, plain: &Value, part: f64) {
    let result = answer.json();
    assert_eq!(answer.status, 0, "{what}: {result}");
    for pointer in NUMBERS {
        let (value, expected) =
            (number(&result, pointer).expect(pointer), number(plain, pointer).expect(pointer));
        assert!((value / expected - 1.0).abs() <= part, "{what}: {pointer} {value} for {expected}");
    }
}

#[track_caller]
fn plain(drop: &Drop) -> Value {
    let answer = drop.analyzed(&drop.table("time_s", ',', |i| drop.cut(0, 1, i)));
    assert_eq!(answer.status, 0, "{}{}", answer.stdout, answer.stderr);
    answer.json()
}

#[test]
fn clock_times_give_the_numbers_of_seconds() {
    let drop = Drop::of(RATE_HZ, "0.1");
    let plain = plain(&drop);
    // Midnight falls into the flight.
    let from_us = 86_400_000_000 - 120_000;
    let of_day = |i, point| {
        let (minutes, seconds) = drop.clock(from_us, i, point);
        format!("{minutes}:{seconds}")
    };
    let day = |i: u32| if i < RATE_HZ * 12 / 100 { "30.11.2026" } else { "01.12.2026" };
    for (what, mark, header, time) in [
        ("HH:MM:SS,ffffff", ';', "Zeit", &(|i: u32| of_day(i, ',')) as &dyn Fn(u32) -> String),
        ("Date, Time", '\t', "Datum\tUhrzeit", &|i| format!("{}\t{}", day(i), of_day(i, '.'))),
        ("dd.mm.yyyy HH:MM:SS,f", ';', "Zeit", &|i| format!("{} {}", day(i), of_day(i, ','))),
    ] {
        let path = drop.table(header, mark, time);
        // A clock of microseconds: 1e-6 s over the shortest time, the contact of 6 ms, halved by its many
        // samples.
        agrees(what, &drop.analyzed(&path), &plain, 1e-4);
        let form = dropcheck(words!["init", path]);
        assert_eq!(form.status, 0, "{what}: {}", form.stderr);
        assert!(
            form.stdout.contains("25000 Hz") && form.stdout.contains("A2 [g]"),
            "{what}: {}",
            form.stdout
        );
    }
}

#[test]
fn coarse_times_never_pass_with_a_wrong_speed() {
    let drop = Drop::of(RATE_HZ, "0.36");
    let plain = plain(&drop);
    let mut passed = 0;
    for (step_us, from_us) in [
        (1_000, 400),
        (10_000, 0),
        (100_000, 0),
        (100_000, 30_000),
        (100_000, 70_000),
        (1_000_000, 300_000),
        (1_000_000, 800_000),
    ] {
        let what = format!("steps of {step_us} µs from {from_us} µs");
        let answer = drop.analyzed(&drop.table("Time [s]", ',', |i| drop.cut(from_us, step_us, i)));
        match answer.status {
            0 => agrees(&what, &answer, &plain, 1e-3),
            1 => assert!(answer.stdout.contains("give sample_rate_hz"), "{what}: {}", answer.stdout),
            _ => assert!(answer.stderr.contains("give sample_rate_hz"), "{what}: {}", answer.stderr),
        }
        passed += usize::from(answer.status == 0);
    }
    assert!(passed >= 4, "{passed} of those that tell their rate pass");
    drop.state_rate();
    for (step_us, from_us) in [(100_000, 30_000), (1_000_000, 800_000), (1_000_000, 0)] {
        let answer = drop.analyzed(&drop.table("Time [s]", ',', |i| drop.cut(from_us, step_us, i)));
        agrees(&format!("{step_us} µs and a stated rate"), &answer, &plain, 1e-4);
    }
}

#[test]
fn samples_lost_between_coarse_times_are_not_passed_over() {
    let mut drop = Drop::of(RATE_HZ, "0.36");
    // 15 of the 25 samples of a millisecond, in the middle of the free fall.
    drop.rows.drain(5000..5015);
    let path = drop.table("Time [s]", ',', |i| drop.cut(0, 1000, i));
    let answer = drop.analyzed(&path);
    assert_eq!(answer.status, 1, "{}", answer.stderr);
    assert!(answer.stdout.contains("15 sample(s) are missing: the times are cut"), "{}", answer.stdout);
}

#[test]
fn the_finer_of_two_columns_of_times_is_taken() {
    let drop = Drop::of(RATE_HZ, "0.1");
    let plain = plain(&drop);
    let second = |i| drop.clock(43_200_900_000, i, '.');
    let both = |i| format!("{}:{},{}", second(i).0, &second(i).1[..2], drop.cut(0, 1, i));
    agrees("Timestamp, t [s]", &drop.analyzed(&drop.table("Timestamp,t [s]", ',', both)), &plain, 1e-6);
}

#[test]
fn milliseconds_are_understood_or_asked_about() {
    let drop = Drop::of(RATE_HZ, "0.1");
    let plain = plain(&drop);
    let milliseconds = |i: u32| format!("{},{:02}", i / 25, i % 25 * 4);
    for header in ["Zeit in ms", "TimeMs", "time_ms", "Time (msec)", "t/ms", "Zeit [ms]"] {
        agrees(header, &drop.analyzed(&drop.table(header, ';', milliseconds)), &plain, 1e-6);
    }
    let since_1970 = |i: u32| format!("{},{:02}", 1_795_176_000_123_u64 + u64::from(i / 25), i % 25 * 4);
    agrees("since 1970", &drop.analyzed(&drop.table("Time", ';', since_1970)), &plain, 1e-4);
    let bare = drop.table("Zeit", ';', milliseconds);
    let answer = drop.analyzed(&bare);
    assert_eq!(answer.status, 2, "{}", answer.stdout);
    for word in ["25 Hz", "in ms", "[ms]", "sample_rate_hz = 25000"] {
        assert!(
            answer.stderr.split_whitespace().collect::<Vec<_>>().join(" ").contains(word),
            "{word}: {}",
            answer.stderr
        );
    }
    drop.state_rate();
    agrees("a stated rate", &drop.analyzed(&bare), &plain, 1e-6);
}

#[test]
fn a_slow_recording_without_a_unit_is_asked_about() {
    let drop = Drop::of(500, "25.0");
    let answer = drop.analyzed(&drop.table("Time", ',', |i| drop.cut(0, 1, i)));
    assert_eq!(answer.status, 2, "{}", answer.stdout);
    let told = answer.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains("500 Hz") && told.contains("with [s] if they are seconds"), "{told}");
    let answer = drop.analyzed(&drop.table("Time [s]", ',', |i| drop.cut(0, 1, i)));
    assert_eq!(answer.status, 1, "{}", answer.stderr);
    assert!(number(&answer.json(), "/slap_down/time/value").is_some(), "{}", answer.stdout);
}

#[test]
fn a_time_step_that_changes_on_the_way_asks_for_a_look() {
    const CHANGED: f64 = 0.0141;
    let table = fs::read_to_string(fixture("anf18-german.csv")).expect("the recording");
    let mut text = String::new();
    for line in table.lines() {
        let (time, cells) = line.split_once(';').unwrap_or((line, ""));
        match time.replace(',', ".").parse::<f64>() {
            Ok(at_s) if at_s > CHANGED => {
                let late = format!("{:.7}", at_s + 0.02 * (at_s - CHANGED)).replace('.', ",");
                let _ = writeln!(text, "{late};{cells}");
            }
            _ => text = text + line + "\n",
        }
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("drop.csv");
    fs::write(&path, text).expect("a temporary file");
    let answer = analyze(&path, &fixture("anf18-german.toml"));
    assert_eq!(answer.status, 1, "{}{}", answer.stdout, answer.stderr);
    let result = answer.json();
    let issues = result["quality"].as_array().expect("issues");
    let asked = issues.iter().find(|i| i["code"] == "clock" && i["severity"] == "warning");
    let said = asked.expect("a warning")["message"].as_str().expect("words");
    assert!(said.contains("at 9803.9215") && said.contains("at 10000.0000"), "{said}");
}
