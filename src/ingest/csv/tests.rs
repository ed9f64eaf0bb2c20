//! Tables as they come from loggers and spreadsheets.

use super::*;
use crate::data::{Axis, Cask, ChannelSpec, Contact, Coupling, Drop, End, FilterChoice, IssueCode, Source};

pub(in super::super) fn cask_file(sources: &[&str]) -> CaskFile {
    let channels = sources.iter().map(|source| ChannelSpec {
        name: (*source).into(),
        end: End::First,
        axis: Axis::Transverse,
        source: Source::Path((*source).into()),
        unit: None,
        position_m: 0.0,
        offset_m: 0.0,
        polarity: 1.0,
        full_scale: None,
        sample_rate_hz: None,
        time: None,
        coupling: Coupling::Dc,
        calibration: None,
        reference: None,
        lateral_m: 0.0,
    });
    CaskFile {
        path: "box.toml".into(),
        sha256: String::new(),
        text: String::new(),
        cask: Cask {
            name: "box".into(),
            mass_kg: 1.0,
            length_m: 1.0,
            height_m: 0.0,
            width_m: None,
            cog_m: 0.5,
            inertia_kg_m2: 1.0,
            is_body: false,
        },
        drop: Drop { impact_velocity_m_s: 4.4, ..Drop::of_height(1.0, 0.1) },
        contact: Contact::Rough,
        filter: FilterChoice::Auto,
        tolerances: crate::data::Tolerances::default(),
        corrections: crate::data::Corrections::default(),
        time: None,
        channels: channels.collect(),
        defaults: Vec::new(),
    }
}

pub(super) fn read_bytes(content: &[u8], cask_file: &CaskFile) -> Result<RawRecording, IngestError> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("r.csv");
    std::fs::write(&path, content).unwrap();
    read(&path, cask_file, Limits::default(), &|_| {})
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
        b"when,note,A1,A2\n2026-11-20T12:00:00.0Z,\"a,b\",1.5,-2\n2026-11-20T12:00:00.1Z,c,2.5,-3\n2026-11-20T12:00:00.2Z,,3.5,-4\n",
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
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("r.csv");
    std::fs::write(
        &path,
        "Lauf 3\nZeit [ms];A1 [g];Notiz;leer\n0;1,5;ok;\n1;-2,5;ok;\n3;7;;\n4;1;;\n5;1;;\n",
    )
    .unwrap();
    let listing = list(&path, Limits::default(), &|_| {}).unwrap();
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
