//! Columns of times as loggers and spreadsheets write them, to rates, starts or words.

use super::tests::{cask_file, read_bytes, told, values};
use super::*;
use crate::data::Severity;
use std::fmt::Write as _;

/// A table of so many rows, the time of each by its number.
pub(super) fn table(header: &str, rows: usize, mark: char, time: impl Fn(usize) -> String) -> String {
    let mut text = format!("{header}\n");
    for i in 0..rows {
        let _ = writeln!(text, "{}{mark}{i}{mark}{}", time(i), i % 7);
    }
    text
}

/// Whole units and a fraction of one of so many digits.
pub(super) fn decimal(count: usize, digits: usize, point: char) -> String {
    let unit = 10_usize.pow(u32::try_from(digits).unwrap());
    format!("{}{point}{:0digits$}", count / unit, count % unit)
}

#[test]
fn clock_times_are_read_with_any_delimiter() {
    // 20 kHz over midnight, or the full hour.
    let clock = |i: usize, point| {
        let count = (86_400 * 20_000 - 100 + i) % (86_400 * 20_000);
        let (s, rest) = (count / 20_000, count % 20_000);
        (format!("{:02}:{:02}", s / 3600, s / 60 % 60), format!("{:02}{point}{:06}", s % 60, rest * 50))
    };
    let of_day = |i, point| format!("{}:{}", clock(i, point).0, clock(i, point).1);
    let of_hour = |i, point| format!("{}:{}", &clock(i, point).0[3..], clock(i, point).1);
    let day = |i: usize| if i < 100 { 20 } else { 21 };
    let texts = [
        table("Time,A1,A2", 300, ',', |i| of_day(i, '.')),
        table("Uhrzeit;A1;A2", 300, ';', |i| of_day(i, ',')),
        table("Time\tA1\tA2", 300, '\t', |i| of_day(i, '.')),
        table("Time\tA1\tA2", 300, '\t', |i| of_day(i, ',')),
        table("Time A1 A2", 300, ' ', |i| of_day(i, '.')),
        table("when;A1;A2", 300, ';', |i| of_hour(i, ',')),
        table("Date,Time,A1,A2", 300, ',', |i| format!("2026-11-{},{}", day(i), of_day(i, '.'))),
        table("Datum;Uhrzeit;A1;A2", 300, ';', |i| format!("{}.11.2026;{}", day(i), of_day(i, ','))),
        table("Datum Zeit A1 A2", 300, ' ', |i| format!("{}.11.2026 {}", day(i), of_day(i, ','))),
        table("Zeit;A1;A2", 300, ';', |i| format!("{}.11.2026 {}", day(i), of_day(i, ','))),
        table("Zeit\tA1\tA2", 300, '\t', |i| format!("{}.11.2026 {}", day(i), of_day(i, ','))),
        table("Timestamp,A1,A2", 300, ',', |i| format!("11/{}/2026 {}", day(i), of_day(i, '.'))),
        table("Timestamp,A1,A2", 300, ',', |i| format!("\"2026/11/{} {}\"", day(i), of_day(i, '.'))),
        table("Zeit;A1;A2\nhh:mm:ss.000;g;g", 300, ';', |i| of_day(i, ',')),
    ];
    for text in texts {
        let shown = &text[..200];
        let recording = read_bytes(text.as_bytes(), &cask_file(&["A1", "A2"])).map_err(|e| told(&e));
        let recording = recording.unwrap_or_else(|error| panic!("{shown}\n{error}"));
        let a1 = &recording.channels[0].uniform;
        assert!((a1.sample_rate_hz - 20_000.0).abs() < 1e-3, "{shown}: {}", a1.sample_rate_hz);
        assert!(a1.start_s.abs() < 1e-9 && a1.issues.is_empty(), "{shown}: {:?}", a1.issues);
        let numbers = values(&recording, 0);
        assert!(numbers.len() == 300 && (numbers[299] - 299.0).abs() < 1e-12, "{shown}");
        assert_eq!(recording.zero_unix_ns, None);
    }
}

#[test]
fn a_clock_time_that_is_not_needed_is_no_obstacle() {
    let text = table("Time,t2,A1,A2", 100, ',', |i| format!("12:3x:{i},{}", decimal(i, 3, '.')));
    let mut by_rate = cask_file(&["A1"]);
    let message = told(&read_bytes(text.as_bytes(), &by_rate).unwrap_err());
    assert!(message.contains("\"Time\" holds \"12:3x:0\", which is no time known here"), "{message}");
    by_rate.channels[0].sample_rate_hz = Some(1000.0);
    assert_eq!(values(&read_bytes(text.as_bytes(), &by_rate).unwrap(), 0).len(), 100);
    let mut by_name = cask_file(&["A1"]);
    by_name.time = Some("t2".into());
    let recording = read_bytes(text.as_bytes(), &by_name).unwrap();
    assert!((recording.channels[0].uniform.sample_rate_hz - 1000.0).abs() < 1e-6);
    // Nor where the first rows hold no time and most do.
    let late = table("t,Clock,A1,A2", 100, ',', |i| {
        let clock = if i < 3 { "--:--:--".into() } else { format!("12:34:{}", decimal(i + 10_000, 3, '.')) };
        format!("{},{clock}", decimal(i, 3, '.'))
    });
    assert_eq!(values(&read_bytes(late.as_bytes(), &cask_file(&["A1"])).unwrap(), 0).len(), 100);
    // Named as the times, it is told where it goes wrong.
    let text = "Time,A1\n12:34:56.1,1\n12:34:56.2,1\n34:56.3,1\n12:34:56.4,1\n";
    let message = told(&read_bytes(text.as_bytes(), &cask_file(&["A1"])).unwrap_err());
    assert!(message.contains("line 4") && message.contains("\"34:56.3\", which is no time"), "{message}");
}

#[test]
fn stamps_beside_other_times_leave_their_unit_alone() {
    let text = table("Time,t [ms],A1,A2", 100, ',', |i| format!("12:34:{},{i}", decimal(i + 10_000, 3, '.')));
    let mut cask = cask_file(&["A1", "A2"]);
    cask.channels[1].time = Some("t [ms]".into());
    let recording = read_bytes(text.as_bytes(), &cask).unwrap();
    for channel in &recording.channels {
        assert!((channel.uniform.sample_rate_hz - 1000.0).abs() < 1e-6, "{}", channel.uniform.sample_rate_hz);
    }
}

#[test]
fn a_header_short_of_a_column_heads_none() {
    // A decimal comma between commas: "A1" would be the milliseconds.
    let text = table("Time,A1,A2", 100, ',', |i| format!("12:34:56,{i:03}"));
    let message = told(&read_bytes(text.as_bytes(), &cask_file(&["A1"])).unwrap_err());
    assert!(message.contains("no header of 4 cells"), "{message}");
}

#[test]
fn of_two_columns_of_times_the_finer_is_taken() {
    for header in ["Timestamp;t [s];A1;A2", "Timestamp;Zeit;A1;A2"] {
        let text = table(header, 3000, ';', |i| format!("12:34:{:02};{}", 10 + i / 1000, decimal(i, 3, ',')));
        let recording = read_bytes(text.as_bytes(), &cask_file(&["A1"])).unwrap();
        let a1 = &recording.channels[0].uniform;
        assert!(
            (a1.sample_rate_hz - 1000.0).abs() < 1e-6 && a1.issues.is_empty(),
            "{header}: {:?}",
            a1.issues
        );
    }
    // As good as one another: the first.
    let text = table("Timestamp;t [s];A1;A2", 300, ';', |i| {
        format!("12:34:{};{}", decimal(10_000 + 2 * i, 3, ','), decimal(2 * i + 5000, 3, ','))
    });
    let recording = read_bytes(text.as_bytes(), &cask_file(&["A1"])).unwrap();
    let a1 = &recording.channels[0].uniform;
    assert!((a1.sample_rate_hz - 500.0).abs() < 1e-6 && a1.start_s.abs() < 1e-12, "{}", a1.start_s);
    assert!(recording.issues.is_empty(), "{:?}", recording.issues);
}

#[test]
fn each_pair_of_times_and_samples_ends_for_itself() {
    use std::fmt::Write as _;
    let mut text = String::from("Time;A1;Time;A2\n");
    for i in 0..500 {
        let second = if i < 300 { format!("{};{i}", decimal(2 * i, 3, ',')) } else { ";".into() };
        let _ = writeln!(text, "{};{i};{second}", decimal(i, 3, ','));
    }
    for sources in [&["A1", "A2"], &["A2", "A1"]] {
        let recording =
            read_bytes(text.as_bytes(), &cask_file(sources)).unwrap_or_else(|e| panic!("{}", told(&e)));
        for (channel, source) in recording.channels.iter().zip(sources) {
            let (count, rate_hz) = if *source == "A1" { (500, 1000.0) } else { (300, 500.0) };
            assert_eq!(channel.uniform.samples.len(), count, "{source}");
            assert!((channel.uniform.sample_rate_hz / rate_hz - 1.0).abs() < 1e-9, "{source}");
            assert!(channel.uniform.issues.is_empty(), "{source}: {:?}", channel.uniform.issues);
        }
        assert!(recording.issues.is_empty(), "{:?}", recording.issues);
    }
    // Listed too, whichever is shorter.
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("r.csv");
    let swapped = text.lines().map(|line| {
        let cells: Vec<&str> = line.split(';').collect();
        format!("{};{};{};{}\n", cells[2], cells[3], cells[0], cells[1])
    });
    for text in [text.clone(), swapped.collect()] {
        std::fs::write(&path, text).unwrap();
        let listing = list(&path, Limits::default(), &|_| {}).unwrap_or_else(|e| panic!("{}", told(&e)));
        assert_eq!(listing.channels.len(), 3);
    }
    // A value without its time is at fault as ever.
    let text = text.replace("0,350;350;;", "0,350;350;;7");
    let message = told(&read_bytes(text.as_bytes(), &cask_file(&["A1", "A2"])).unwrap_err());
    assert!(message.contains("line 352") && message.contains("holds no time"), "{message}");
    // Pairs of other names that do not begin together, or run apart.
    for (from, step) in [(1000, 10), (0, 11)] {
        let text = table("Time 1 [s];B1;Time 2 [s];A1;A2", 2000, ';', |i| {
            format!("{};{i};{}", decimal(10 * i, 4, ','), decimal(from + step * i, 4, ','))
        });
        let mut cask = cask_file(&["B1", "A1"]);
        let message = read_bytes(text.as_bytes(), &cask).map_err(|e| told(&e)).err().unwrap_or_default();
        assert!(message.contains("\"Time 2 [s]\"") && message.contains("its own"), "{message}");
        cask.channels[0].time = Some("Time 1 [s]".into());
        cask.channels[1].time = Some("Time 2 [s]".into());
        assert!(read_bytes(text.as_bytes(), &cask).is_ok());
    }
}

/// 0.45 s at 20 kHz, the times in units of so many microseconds.
fn counted(header: &str, unit_us: usize, from: usize) -> String {
    table(&format!("{header};A1;A2"), 9000, ';', |i| {
        let (whole, rest) = (50 * i / unit_us, 50 * i % unit_us);
        format!("{},{:03}", whole + from, rest * 1000 / unit_us)
    })
}

#[test]
fn units_that_names_or_epochs_tell() {
    for (header, unit_us, from) in [
        ("Zeit in ms", 1000, 0),
        ("TimeMs", 1000, 0),
        ("time_ms", 1000, 0),
        ("Time (msec)", 1000, 0),
        ("t/ms", 1000, 0),
        ("t_us", 1, 0),
        ("Zeit [µs]", 1, 5_000_000),
        ("Time", 1000, 1_795_176_000_123),
        ("Time", 1, 1_795_176_000_123_000),
    ] {
        let recording =
            read_bytes(counted(header, unit_us, from).as_bytes(), &cask_file(&["A1"])).map_err(|e| told(&e));
        let recording = recording.unwrap_or_else(|error| panic!("{header}: {error}"));
        let a1 = &recording.channels[0].uniform;
        assert!((a1.sample_rate_hz / 20_000.0 - 1.0).abs() < 1e-4, "{header}: {}", a1.sample_rate_hz);
        assert!(recording.issues.is_empty(), "{header}: {:?}", recording.issues);
    }
    let nanoseconds = table("t;A1;A2", 9000, ';', |i| format!("{}", 1_795_176_000_123_000_000 + 50_000 * i));
    let recording = read_bytes(nanoseconds.as_bytes(), &cask_file(&["A1"])).unwrap();
    assert!((recording.channels[0].uniform.sample_rate_hz / 20_000.0 - 1.0).abs() < 1e-4);
}

#[test]
fn milliseconds_without_a_unit_are_asked_about() {
    for (unit_us, unit) in [(1000, "[ms]"), (1, "[µs]")] {
        let text = counted("Zeit", unit_us, 0);
        let mut cask = cask_file(&["A1"]);
        let message = told(&read_bytes(text.as_bytes(), &cask).unwrap_err());
        for part in ["\"Zeit\"", "line 2", unit, "20 kHz", "sample_rate_hz = 20000"] {
            assert!(message.contains(part), "{message}");
        }
        // A rate that agrees settles it.
        cask.channels[0].sample_rate_hz = Some(20_000.0);
        let recording = read_bytes(text.as_bytes(), &cask).unwrap();
        let a1 = &recording.channels[0].uniform;
        assert!(
            recording.issues.is_empty() && a1.issues.is_empty(),
            "{:?} {:?}",
            recording.issues,
            a1.issues
        );
        // One that agrees with no unit wins as ever, with a warning.
        cask.channels[0].sample_rate_hz = Some(31_000.0);
        let recording = read_bytes(text.as_bytes(), &cask).unwrap();
        assert_eq!(recording.channels[0].uniform.issues[0].severity, Severity::Warning);
    }
}

#[test]
fn a_name_that_contradicts_its_unit_is_asked_about() {
    for header in
        ["time_s;A1;A2\nms;g;g", "time_s [ms];A1;A2", "time_s;A1;A2\n[ms];[g];[g]", "t_ms (s);A1;A2"]
    {
        let text = table(header, 9000, ';', |i| decimal(50 * i, 3, ','));
        let mut cask = cask_file(&["A1"]);
        let message = told(&read_bytes(text.as_bytes(), &cask).unwrap_err());
        let unit = if header.contains("(s)") { "\"s\"" } else { "\"ms\"" };
        for part in ["by its name", unit, "sample_rate_hz"] {
            assert!(message.contains(part), "{message}");
        }
        // 0.05 in either: a rate tells which.
        for rate_hz in [20.0, 20_000.0] {
            cask.channels[0].sample_rate_hz = Some(rate_hz);
            let recording = read_bytes(text.as_bytes(), &cask).unwrap();
            let a1 = &recording.channels[0].uniform;
            assert!(
                (a1.sample_rate_hz / rate_hz - 1.0).abs() < 1e-9 && a1.issues.is_empty(),
                "{:?}",
                a1.issues
            );
        }
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("r.csv");
        std::fs::write(&path, &text).unwrap();
        let listing = list(&path, Limits::default(), &|_| {}).unwrap();
        assert!(listing.issues[0].message.contains("by its name"), "{:?}", listing.issues);
    }
    for header in ["time_ms;A1;A2\nms;g;g", "time_ms [msec];A1;A2", "Time [ms];A1;A2", "t;A1;A2\nms;g;g"] {
        let text = table(header, 9000, ';', |i| decimal(50 * i, 3, ','));
        let recording = read_bytes(text.as_bytes(), &cask_file(&["A1"])).unwrap();
        assert!((recording.channels[0].uniform.sample_rate_hz / 2e4 - 1.0).abs() < 1e-9, "{header}");
    }
}

#[test]
fn a_slow_sensor_is_read_with_a_question() {
    // An IMU at 400 Hz for 30 s: in milliseconds it would be 400 kHz.
    let text = |header: &str, rows| table(&format!("{header},A1,A2"), rows, ',', |i| decimal(25 * i, 4, '.'));
    let recording = read_bytes(text("Time", 12_000).as_bytes(), &cask_file(&["A1"])).unwrap();
    assert!((recording.channels[0].uniform.sample_rate_hz - 400.0).abs() < 1e-6);
    let [issue] = &recording.issues[..] else { panic!("{:?}", recording.issues) };
    assert!(
        issue.severity == Severity::Warning && issue.message.contains("400 Hz: are they in ms"),
        "{}",
        issue.message
    );
    // Where the unit is stated, or milliseconds would make no drop, there is nothing to ask.
    for (header, rows) in [("Time [s]", 12_000), ("time_s", 12_000), ("Time", 4000)] {
        let recording = read_bytes(text(header, rows).as_bytes(), &cask_file(&["A1"])).unwrap();
        assert!(recording.issues.is_empty(), "{header}: {:?}", recording.issues);
    }
    let epoch = table("Time,A1,A2", 3000, ',', |i| decimal(1_795_176_000_000 + 20 * i, 3, '.'));
    assert!(read_bytes(epoch.as_bytes(), &cask_file(&["A1"])).is_ok(), "50 Hz since 1970");
}

#[test]
fn a_listing_says_what_the_times_leave_open() {
    let listed = |text: &str| {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("r.csv");
        std::fs::write(&path, text).unwrap();
        list(&path, Limits::default(), &|_| {}).unwrap()
    };
    let listing = listed(&counted("Zeit", 1000, 0));
    assert!(listing.issues[0].message.contains("are they in ms"), "{:?}", listing.issues);
    let listing = listed(&table("Zeit;A1;A2", 3000, ';', |i| format!("12:34:{:02}", i / 2000)));
    assert!(listing.issues[0].message.contains("give sample_rate_hz"), "{:?}", listing.issues);
    assert_eq!(listing.channels[0].sample_rate_hz, None);
    let listing = listed(&table("Zeit;A1;A2", 9000, ';', |i| decimal(i / 2000, 1, ',')));
    assert!((listing.channels[0].sample_rate_hz.unwrap() / 20_000.0 - 1.0).abs() < 1e-3);
    assert!(listing.issues[0].message.contains("cut to 0.1 s"), "{:?}", listing.issues);
}

#[test]
fn rows_that_a_counter_misses_are_told_and_can_be_put_in_their_place() {
    let of_rows = |rows: &[usize]| {
        rows.iter().fold("Sample,A1\n".to_owned(), |text, row| format!("{text}{row},{}.5\n", row % 7))
    };
    let told = |rows: &[usize]| {
        let mut file = cask_file(&["A1"]);
        file.channels[0].sample_rate_hz = Some(1e4);
        let told = read_bytes(of_rows(rows).as_bytes(), &file).unwrap().issues;
        file.time = Some("Sample".into());
        let placed = read_bytes(of_rows(rows).as_bytes(), &file).unwrap();
        let uniform = &placed.channels[0].uniform;
        assert!((uniform.sample_rate_hz / 1e4 - 1.0).abs() < 1e-9, "{}", uniform.sample_rate_hz);
        (told, uniform.samples.len())
    };
    let all: Vec<usize> = (0..400).collect();
    assert_eq!(told(&all), (vec![], 400));
    let (issues, length) = told(&[&all[..300], &all[320..]].concat());
    assert!(matches!(&issues[..], [one] if one.severity == Severity::Warning), "{issues:?}");
    assert!(issues[0].message.contains("20 of them are missing, the first 20 behind row 300"), "{issues:?}");
    assert_eq!(length, 400);
    // One that begins anew tells nothing.
    let mut file = cask_file(&["A1"]);
    file.channels[0].sample_rate_hz = Some(1e4);
    let anew = read_bytes(of_rows(&[&all[..], &all[..]].concat()).as_bytes(), &file).unwrap();
    assert!(anew.issues.is_empty());
}
