//! Tables as they come from loggers and spreadsheets.

use super::*;
use crate::data::{Cask, ChannelSpec, Contact, Drop, End, IssueCode, Listing, RowsOf};
use crate::ingest::{Limits, ReadRequest};

pub(in super::super) fn cask_file(sources: &[&str]) -> CaskFile {
    let channel = |source: &&str| ChannelSpec::new(source, End::First, source, 0.0);
    let cask = Cask { inertia_kg_m2: 1.0, ..Cask::block("box", 1.0, 1.0, 0.0) };
    let drop = Drop { impact_velocity_m_s: 4.4, ..Drop::from_height(1.0, 0.1) };
    CaskFile {
        path: "box.toml".into(),
        channels: sources.iter().map(channel).collect(),
        ..CaskFile::new(cask, drop, Contact::Rough)
    }
}

pub(super) fn read_bytes(content: &[u8], cask_file: &CaskFile) -> Result<RawRecording, IngestError> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("r.csv");
    std::fs::write(&path, content).unwrap();
    read(ReadRequest::silent(&path, Limits::default()), cask_file)
}

fn list_bytes(content: &[u8]) -> Listing {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("r.csv");
    std::fs::write(&path, content).unwrap();
    list(ReadRequest::silent(&path, Limits::default())).unwrap()
}

pub(super) fn values(recording: &RawRecording, channel: usize) -> Vec<f64> {
    let samples = &recording.channels[channel].uniform.samples;
    (0..samples.len()).map(|i| samples.get(i)).collect()
}

pub(super) fn told(error: &IngestError) -> String {
    let help = miette::Diagnostic::help(error).map(|help| help.to_string()).unwrap_or_default();
    format!("{error} | {help}")
}

#[test]
fn every_dialect_gives_the_same_numbers() {
    let texts: [&[u8]; 14] = [
        b"time_s,A1,A2\n0.0,1.5,-2\n0.1,2.5,-3\n0.2,3.5,-4\n",
        b"time_s;A1;A2\r\n0,0;1,5;-2\r\n0,1;2,5;-3\r\n0,2;3,5;-4\r\n",
        b"time_s\tA1\tA2\n0.0\t1.5\t-2\n0.1\t2.5\t-3\n0.2\t3.5\t-4\n",
        b"t\tA1\tA2\n0,0\t1,5\t-2\n0,1\t2,5\t-3\n0,2\t3,5\t-4\n",
        b"\xEF\xBB\xBFtime_s,A1,A2\n0.0,1.5,-2\n0.1,2.5,-3\n0.2,3.5,-4",
        b"Logger 7\nDatum;20.11.2026\nRate;10\n\nZeit;A1;A2\ns;g;g\n0,0;1,5;-2\n0,1;2,5;-3\n0,2;3,5;-4\n",
        b"\"Time [ms]\",\"A1 [g]\",\"A2 (m/s^2)\"\n0,1.5,-2\n100,2.5,-3\n200,3.5,-4\n",
        b"\"Time (s)\",\"A1\",\"A2\"\n\"0\",\"1.5\",\"-2\"\n\"0.1\",\"2.5\",\"-3\"\n\"0.2\",\"3.5\",\"-4\"\n",
        b"Time,A1,A2\n\"0,0\",\"1,5\",\"-2\"\n\"0,1\",\"2,5\",\"-3\"\n\"0,2\",\"3,5\",\"-4\"\n",
        b"  time_s   A1   A2\n  0.0  1.5  -2\n  0.1  2.5  -3\n  0.2  3.5  -4\n",
        b"time_s;A1;A2;\n0,0;1,5;-2;\n0,1;2,5;-3;\n0,2;3,5;-4;\n",
        b"# time_s, A1, A2\n0.0, 15e-1, -2.0E0\n1e-1, 2.5, -3\n.2, 3.5, -4.\n",
        b"when,note,A1,A2\n2026-11-20T12:00:00.0Z,\"a,b\",1.5,-2\n\
        2026-11-20T12:00:00.1Z,c,2.5,-3\n2026-11-20T12:00:00.2Z,,3.5,-4\n",
        b"Beh\xE4lter \xB5\nZeit [\xB5s];A1;A2\n0;1,5;-2\n100000;2,5;-3\n200000;3,5;-4\n",
    ];
    for text in texts {
        let shown = String::from_utf8_lossy(text);
        let recording = read_bytes(text, &cask_file(&["A1", "A2"])).map_err(|e| told(&e));
        let recording = recording.unwrap_or_else(|error| panic!("{shown}\n{error}"));
        assert_eq!(values(&recording, 0), [1.5, 2.5, 3.5], "{shown}");
        assert_eq!(values(&recording, 1), [-2.0, -3.0, -4.0], "{shown}");
        assert!((recording.channels[0].uniform.sample_rate_hz - 10.0).abs() < 1e-6, "{shown}");
        assert!(recording.issues.is_empty(), "{shown}: {:?}", recording.issues);
    }
}

#[test]
fn utf16_is_read() {
    let text = "\u{FEFF}Zeit;A1 [m/s²]\n0,0;1,5\n0,1;2,5\n";
    let bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let recording = read_bytes(&bytes, &cask_file(&["A1"])).unwrap();
    assert_eq!(values(&recording, 0), [1.5, 2.5]);
    assert_eq!(recording.channels[0].unit.as_deref(), Some("m/s²"));
}

#[test]
fn units_come_from_the_header_or_the_row_below() {
    let recording = read_bytes(b"t;A1 [g];A2\n0;1;2\n1;1;2\n", &cask_file(&["A1 [g]", "A2"])).unwrap();
    assert_eq!(recording.channels[0].unit.as_deref(), Some("g"));
    assert_eq!(recording.channels[1].unit, None);
    let recording = read_bytes(b"t;A1;A2\n[s];[g];[mV]\n0;1;2\n1;1;2\n", &cask_file(&["A1", "A2"])).unwrap();
    assert_eq!(recording.channels[1].unit.as_deref(), Some("mV"));
    // A header of names with units is none of units, whatever stands above it.
    let text = "Messung;Fall;12\nZeit [s];A1 [g];A2 (mV)\n0;1;2\n1;1;2\n";
    let recording = read_bytes(text.as_bytes(), &cask_file(&["A1", "A2"])).unwrap();
    assert_eq!(recording.channels[1].unit.as_deref(), Some("mV"));
    let recording = read_bytes(b"time[0];A1[1]\n0;1\n1;1\n", &cask_file(&["A1[1]"])).unwrap();
    assert_eq!(recording.channels[0].unit, None, "a number counts columns");
}

#[test]
fn columns_without_header_count_from_one() {
    let text = b"-0.2\t5.5\n-0.1\t6.5\n0.0\t7.5\n";
    let recording = read_bytes(text, &cask_file(&["2"])).unwrap();
    assert_eq!(values(&recording, 0), [5.5, 6.5, 7.5]);
    assert!((recording.channels[0].uniform.start_s + 0.2).abs() < 1e-12);
    let message = told(&read_bytes(text, &cask_file(&["A1"])).unwrap_err());
    assert!(message.contains("no header") && message.contains("1, 2"), "{message}");
}

#[test]
fn a_rate_stands_in_for_times() {
    let mut cask_file = cask_file(&["A1"]);
    let message = told(&read_bytes(b"A1,A2\n1,2\n2,3\n3,1\n", &cask_file).unwrap_err());
    assert!(message.contains("no column of times") && message.contains("sample_rate_hz"), "{message}");
    cask_file.channels[0].sample_rate_hz = Some(500.0);
    let recording = read_bytes(b"A1,A2\n1,2\n2,3\n3,1\n", &cask_file).unwrap();
    assert!((recording.channels[0].uniform.sample_rate_hz - 500.0).abs() < 1e-9);
    let mut named = self::cask_file(&["A1"]);
    named.time = Some("stamp".into());
    let recording = read_bytes(b"stamp,A1\n1,2\n2,3\n3,1\n", &named).unwrap();
    assert!((recording.channels[0].uniform.sample_rate_hz - 1.0).abs() < 1e-9);
}

#[test]
fn empty_cells_are_missing_and_a_cut_line_is_dropped() {
    let recording = read_bytes(b"t,A1\n0,1\n1,\n2,NaN\n3,4\n4,5\n5", &cask_file(&["A1"])).unwrap();
    let values = values(&recording, 0);
    assert_eq!(values.len(), 5);
    assert!(values[1].is_nan() && values[2].is_nan());
    assert_eq!(recording.channels[0].uniform.issues[0].code, IssueCode::NonFinite);
    assert_eq!(recording.issues[0].code, IssueCode::Truncated);
    assert!(recording.issues[0].message.contains("line 7"), "{}", recording.issues[0].message);
    let cut = read_bytes(b"t,A1\n0,1\n1,2\n2,3e", &cask_file(&["A1"])).unwrap();
    assert_eq!((cut.channels[0].uniform.samples.len(), cut.issues.len()), (2, 1));
    let zeros = read_bytes(b"t,A1\n0,1\n1,2\n\0\0\0\0\n", &cask_file(&["A1"])).unwrap();
    assert_eq!((zeros.channels[0].uniform.samples.len(), zeros.issues.len()), (2, 1));
}

#[test]
fn what_is_wrong_is_said_with_line_and_column() {
    let cases: [(&str, &str, &[&str]); 8] = [
        ("t,A1\n0,1\n1,oops\n2,3\n3,4\n", "A1", &["line 3", "\"A1\" holds \"oops\"", "empty"]),
        ("t,A1\n0,1\n1,2\n,3\n3,4\n", "A1", &["line 4", "\"t\" holds no time"]),
        ("t;A1\n0;1,5\n1;1.234,5\n2;3\n", "A1", &["line 3", "1.234,5", "without thousands separators"]),
        ("t,A1\n0,1\n1,2\n", "a1", &["headed \"a1\"", "did you mean A1"]),
        ("t,A1,A1\n0,1,1\n1,2,1\n", "A1", &["2 columns are headed \"A1\""]),
        ("t,A1\n0,1\n0,1\n", "A1", &["all times are 0 s"]),
        ("t [furlong],A1\n0,1\n1,1\n", "A1", &["\"t [furlong]\"", "none of time known here"]),
        ("words only\nand more\n", "A1", &["no rows of numbers"]),
    ];
    for (text, source, expected) in cases {
        let message = told(&read_bytes(text.as_bytes(), &cask_file(&[source])).unwrap_err());
        for part in expected {
            assert!(message.contains(part), "{text:?} gives {message:?} without {part:?}");
        }
    }
}

#[test]
fn a_line_without_end_is_refused() {
    let mut text = b"t,A1\n0,1\n1,2\n".to_vec();
    text.resize(3 << 20, b'1');
    let message = told(&read_bytes(&text, &cask_file(&["A1"])).unwrap_err());
    assert!(message.contains("line 4") && message.contains("1 MiB"), "{message}");
}

#[test]
fn rows_across_chunks_are_whole() {
    use std::fmt::Write as _;
    let mut text = String::from("t;A1;A2\n");
    for i in 0..120_000 {
        let _ = writeln!(text, "{},{:04};{i},25;-{i}", i / 10_000, i % 10_000);
    }
    let recording = read_bytes(text.as_bytes(), &cask_file(&["A2", "A1"])).unwrap();
    let (second, first) = (values(&recording, 0), values(&recording, 1));
    assert_eq!(second.len(), 120_000);
    for i in [0, 1, 60_000, 119_999] {
        let expected = f64::from(u32::try_from(i).unwrap());
        assert!((second[i] + expected).abs() < 1e-12 && (first[i] - expected - 0.25).abs() < 1e-9, "{i}");
    }
}

#[test]
fn a_table_is_listed() {
    let listing =
        list_bytes(b"Lauf 3\nZeit [ms];A1 [g];Notiz;leer\n0;1,5;ok;\n1;-2,5;ok;\n3;7;;\n4;1;;\n5;1;;\n");
    assert_eq!(
        (listing.counts["rows"], listing.counts["columns"], listing.counts["preamble_lines"]),
        (5, 4, 1)
    );
    assert_eq!(listing.facts["delimiter"], "semicolon");
    assert_eq!(listing.facts["decimal mark"], "comma");
    let a1 = &listing.channels[0];
    assert_eq!((a1.source.as_str(), a1.unit.as_deref(), a1.range), ("A1 [g]", Some("g"), Some((-2.5, 7.0))));
    assert!((a1.sample_rate_hz.unwrap() - 1000.0).abs() < 1e-6, "{:?}", a1.sample_rate_hz);
    assert_eq!((a1.gaps, a1.duration_s), (Some(1), Some(0.005)));
    assert!(listing.channels[1].unreadable.is_some() && listing.channels[2].unreadable.is_some());
}

/// A table of so many rows: the lines of a header, and what stands in row `i`.
fn table(header: &str, rows: u32, row: impl Fn(u32) -> String) -> Vec<u8> {
    (header.to_owned() + &(0..rows).map(row).collect::<String>()).into_bytes()
}

/// `cask_file` for one source, of the sensor that `is` in a column.
fn of_sensor(source: &str, column: &str, is: &str) -> CaskFile {
    let mut cask_file = cask_file(&[source]);
    cask_file.channels[0].rows = Some(RowsOf { column: column.into(), is: is.into() });
    cask_file
}

#[test]
fn rows_of_several_sensors_are_never_one_signal() {
    for (header, words) in [
        ("t,Sensor,A1\n", ["left", "right"]),
        ("t,Device ID,A1\n", ["17", "4"]),
        ("t,remark,A1\n", ["oben", "unten"]),
    ] {
        let row = |i: u32| format!("{},{},{}\n", f64::from(i / 2) / 8000.0, words[i as usize % 2], i % 2 + 5);
        let text = table(header, 80, row);
        let column = header.split(',').nth(1).unwrap();
        let message = told(&read_bytes(&text, &cask_file(&["A1"])).unwrap_err());
        let line = format!("where = {{ column = {column:?}, is = {:?} }}", words[0]);
        assert!(message.contains("of several sensors") && message.contains(&line), "{message}");
        for (place, is) in words.iter().enumerate() {
            let read = read_bytes(&text, &of_sensor("A1", column, is)).unwrap();
            assert_eq!(values(&read, 0), vec![if place == 0 { 5.0 } else { 6.0 }; 40], "{is}");
            assert!((read.channels[0].uniform.sample_rate_hz - 8000.0).abs() < 1e-6);
            assert!(read.channels[0].uniform.issues.is_empty());
        }
        let message = told(&read_bytes(&text, &of_sensor("A1", column, "none of them")).unwrap_err());
        assert!(message.contains(&format!("which holds {}, {}", words[0], words[1])), "{message}");
    }
}

#[test]
fn rows_that_a_counter_misses_are_listed_as_missing() {
    let row = |i: u32| format!("{},{}\n", if i < 40 { i } else { i + 3 }, i % 7);
    for (header, times) in [("Sample,A1\n", false), ("Sample,A1,t_s\n", true)] {
        let timed = |i: u32| format!("{},{}\n", row(i).trim(), f64::from(i) / 1e3);
        let row = |i: u32| if times { timed(i) } else { row(i) };
        let listing = list_bytes(&table(header, 80, row));
        let [found] = &listing.issues[..] else { panic!("{:?}", listing.issues) };
        assert!(found.message.contains("\"Sample\""), "{found:?}");
        assert_eq!(listing.channels[1].samples, Some(80));
    }
}

#[test]
fn states_constants_and_counters_name_no_sensor() {
    let state = |i: u32| if (30..50).contains(&i) { "TRIG" } else { "OK" };
    let row = |i: u32| format!("{},{},{i},7,box,{i}\n", f64::from(i) / 8000.0, state(i));
    let text = table("t,state,id,node,name,A1\n", 80, row);
    assert_eq!(values(&read_bytes(&text, &cask_file(&["A1"])).unwrap(), 0).len(), 80);
}

#[test]
fn a_second_column_that_still_mixes_rows_is_told() {
    let row = |i: u32| format!("{},{},{},{i}\n", f64::from(i / 4), ["a", "b"][i as usize % 2], i / 2 % 2);
    let text = table("t,device,channel,A1\n", 80, row);
    let message = told(&read_bytes(&text, &of_sensor("A1", "device", "a")).unwrap_err());
    assert!(message.contains("\"channel\" holds 0, 1") && message.contains("a file of its own"), "{message}");
}

#[test]
fn rows_of_other_topics_are_no_samples() {
    for (phase, decimal) in [(0.5, "."), (0.1, "."), (0.9, ",")] {
        let row = |i: u32| {
            let time = format!("{:.6}", (f64::from(i / 2) + phase * f64::from(i % 2)) / 8000.0);
            let cells = if i.is_multiple_of(2) { format!("{i};") } else { format!(";{i}") };
            format!("{};{cells}\n", time.replace('.', decimal))
        };
        let text = table("__time;/a/x;/b/x\n", 100, row);
        let read = read_bytes(&text, &cask_file(&["/a/x", "/b/x"])).unwrap();
        let listed = list_bytes(&text).channels;
        for (channel, listed) in read.channels.iter().zip(listed) {
            let uniform = &channel.uniform;
            assert_eq!((listed.sample_rate_hz, listed.samples), (Some(uniform.sample_rate_hz), Some(50)));
            assert!(
                (uniform.sample_rate_hz - 8000.0).abs() < 1.0 && uniform.samples.len() == 50,
                "{uniform:?}"
            );
            assert!(uniform.issues.is_empty(), "{uniform:?}");
        }
    }
    // A few empty cells, and a channel that ends early, are samples that are missing.
    let row = |i: u32| {
        format!(
            "{};{};{}\n",
            f64::from(i) / 1e3,
            if i.is_multiple_of(9) && i < 90 { "" } else { "1" },
            if i < 60 { "2" } else { "" }
        )
    };
    let read = read_bytes(&table("t;A1;A2\n", 200, row), &cask_file(&["A1", "A2"])).unwrap();
    let missing = |channel: usize| values(&read, channel).iter().filter(|value| value.is_nan()).count();
    assert_eq!((missing(0), missing(1), values(&read, 1).len()), (10, 140, 200));
}

#[test]
fn what_is_no_time_is_none() {
    let noise = |i: u32| 20.0 + f64::from(i * 7919 % 13);
    for (header, why) in [("A1,T\n", "\"T\" does not rise"), ("A1,T [degC]\n", "is in degC")] {
        let text = table(header, 60, |i| format!("{i},{}\n", noise(i)));
        let message = told(&read_bytes(&text, &cask_file(&["A1"])).unwrap_err());
        assert!(message.contains(why) && message.contains("sample_rate_hz"), "{message}");
        let mut stated = cask_file(&["A1"]);
        stated.channels[0].sample_rate_hz = Some(8000.0);
        let read = read_bytes(&text, &stated).unwrap();
        assert!(values(&read, 0).windows(2).all(|pair| pair[0] < pair[1]) && read.issues.is_empty());
    }
}

#[test]
fn the_stamp_of_the_sensor_goes_before_the_time_of_receipt() {
    let at = |i: u32| 1_700_000_000_000_000_000_u64 + 125_000 * u64::from(i);
    for (header, cells) in [
        (
            "%time,field.header.stamp,A1\n",
            (|received, ns| format!("{received},{ns}")) as fn(u64, u64) -> String,
        ),
        ("rosbag_timestamp,header.stamp.secs,header.stamp.nsecs,A1\n", |received, ns| {
            format!("{received},{},{}", ns / 1_000_000_000, ns % 1_000_000_000)
        }),
        ("sec,nanosec,A1\n", |_, ns| format!("{},{}", ns / 1_000_000_000, ns % 1_000_000_000)),
    ] {
        let row = |i: u32| {
            format!("{},{i}\n", cells(at(i) + 40_000 * u64::from(i * 7919 % 13), at(i) + 999_990_000))
        };
        let read =
            read_bytes(&table(header, 200, row), &cask_file(&["A1"])).map_err(|error| told(&error)).unwrap();
        let uniform = &read.channels[0].uniform;
        assert!((uniform.sample_rate_hz - 8000.0).abs() < 1.0, "{header}: {uniform:?}");
    }
}

#[test]
fn facts_of_oscilloscopes_stand_above_the_rows() {
    let texts = [
        "\"Model Name\",\"S1\"\n\"TraceName\",\"A1\",\"A2\"\n\"BlockSize\",60,60\n\
         \"VUnit\",\"g\",\"g\"\n\"HResolution\",1.25E-04,1.25E-04\n\n",
        "X,A1,A2,Start,Increment,\nSequence,g,g,-5.0e-02,1.25e-04\n",
        "Zeit,A1,A2\nEngineering Unit,g,g\nISO Channel Code,11,12\n",
    ];
    for (place, header) in texts.into_iter().enumerate() {
        let row = |i: u32| match place {
            0 => format!(",{i},-{i}\n"),
            1 => format!("{i},{i},-{i},\n"),
            _ => format!("{},{i},-{i}\n", f64::from(i) / 8000.0),
        };
        let read = read_bytes(&table(header, 60, row), &cask_file(&["A1", "A2"]))
            .map_err(|error| told(&error))
            .unwrap();
        assert_eq!((values(&read, 0)[7], values(&read, 1)[7]), (7.0, -7.0), "{header}");
        for channel in &read.channels {
            assert_eq!(channel.unit.as_deref(), Some("g"), "{header}");
            assert!((channel.uniform.sample_rate_hz - 8000.0).abs() < 1e-6, "{header}");
        }
    }
}

#[test]
fn remarks_and_sums_are_no_rows() {
    let rows = |i: u32| format!("{},{i}\n", f64::from(i) / 8000.0);
    for (header, end) in [
        (";Title, logger\n;Headers, time,A1\n", ";shutdown: switched off\n"),
        ("time,A1\n", "# the end"),
        ("time,A1\n", "Sum,1770\n"),
        ("time,A1\n", "\u{1a}"),
        (",A1\n", "Mittelwert,29.5\n"),
    ] {
        let mut text = table(header, 60, rows);
        text.extend_from_slice(end.as_bytes());
        let read = read_bytes(&text, &cask_file(&["A1"])).map_err(|error| told(&error)).unwrap();
        assert_eq!((values(&read, 0).len(), read.issues.len()), (60, 0), "{end:?}: {:?}", read.issues);
    }
    let mut numbered = cask_file(&["A1"]);
    numbered.time = Some("1".into());
    assert_eq!(values(&read_bytes(&table(",A1\n", 60, rows), &numbered).unwrap(), 0).len(), 60);
}

#[test]
fn rows_that_were_never_filled_are_no_samples() {
    let mut text = table("time,A1\n", 60, |i| format!("{},{i}\n", f64::from(i) / 8000.0));
    text.extend_from_slice("0.0000,0.00\n".repeat(20).as_bytes());
    let read = read_bytes(&text, &cask_file(&["A1"])).map_err(|error| told(&error)).unwrap();
    assert_eq!(values(&read, 0).len(), 60);
    assert!(read.channels[0].uniform.issues[0].message.contains("20 rows at the end"));
}

#[test]
fn windows_counts_100_ns_from_1601() {
    let text =
        table("Time,A1\n", 600, |i| format!("{},{i}\n", 133_494_000_000_000_000 + 1000 * u64::from(i)));
    let read = read_bytes(&text, &cask_file(&["A1"])).map_err(|error| told(&error)).unwrap();
    assert!((read.channels[0].uniform.sample_rate_hz - 1e4).abs() < 1.0);
}

#[test]
fn a_second_table_a_rate_with_thousands_and_times_that_fall_are_named() {
    let mut two = table("Time,A1\n", 60, |i| format!("{},{i}\n", f64::from(i) / 8000.0));
    two.extend_from_slice(b"Frequency,Amplitude\n0,1\n100,2\n200,1\n");
    let rate = table("Sample rate: 10,000 Hz\n\nA1;A2\n", 60, |i| format!("{i}.5;1\n"));
    let falling = table("Time,A1\n", 60, |i| format!("{},{i}\n", f64::from(60 - i) / 8000.0));
    let mut named = cask_file(&["A1"]);
    named.time = Some("Time".into());
    for (text, file, part) in [
        (two, &cask_file(&["A1"]), "another table"),
        (rate, &cask_file(&["A1"]), "sample_rate_hz"),
        (falling, &named, "fall from row to row"),
    ] {
        let message = told(&read_bytes(&text, file).unwrap_err());
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn tables_that_cannot_be_read_say_why() {
    for (text, parts) in [
        ("\"t;A1\"\n\"0;1,5\"\n\"1;2,5\"\n", &["no quotes around a whole row"][..]),
        (
            "t,A1\n0,00,1,25\n0,01,1,75\n0,02,1,50\n",
            &["line 1 has 2 cells, the rows 4", "comma is the decimal mark too"],
        ),
        ("t;A1\n0.1;39\n0.2;15,892\n0.3;1.5\n0.4;1.25\n", &["15,892", "thousands"]),
        ("t [ms],A1\n\"999.5\",1.5\n\"1,000.0\",2.5\n\"1,000.5\",1.5\n", &["1,000.0", "thousands"]),
        ("t;A1;A2\n0.1;-3,5;1,5\n0.2;2,5;1,5\n", &["\"t\" holds \"0.1\"", "decimal mark"]),
        ("t,A1\n45234.50000000,1\n45234.50000001,2\n45234.50000002,1\n", &["are they in days", "[days]"]),
    ] {
        let message = told(&read_bytes(text.as_bytes(), &cask_file(&["A1"])).unwrap_err());
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    }
}

#[test]
fn a_long_table_is_listed_by_sensor() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("r.csv");
    // The right one is sampled half as often.
    let row = |i: u32| {
        let right =
            if i.is_multiple_of(2) { format!("{},right,-{i}\n", f64::from(i) / 1e3) } else { String::new() };
        format!("{},left,{i}\n{right}", f64::from(i) / 1e3)
    };
    std::fs::write(&path, table("t,Sensor,A1\n", 61, row)).unwrap();
    let listing = list(ReadRequest::silent(&path, Limits::default())).unwrap();
    let told: Vec<_> = listing.channels[1..]
        .iter()
        .map(|it| (it.rows.as_ref().unwrap().is.as_str(), it.samples, it.range))
        .collect();
    assert_eq!(told, [("left", Some(61), Some((0.0, 60.0))), ("right", Some(31), Some((-60.0, 0.0)))]);
    let rates: Vec<f64> = listing.channels[1..].iter().filter_map(|it| it.sample_rate_hz).collect();
    assert!((rates[0] - 1000.0).abs() < 1e-6 && (rates[1] - 500.0).abs() < 1e-6, "{rates:?}");
    assert!(listing.channels[0].unreadable.is_some());
}
