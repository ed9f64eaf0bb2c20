//! Tables with delimiters at the end of some lines, headers of LabVIEW and DIAdem, and cells for what was not measured.

use super::tests::{cask_file, read_bytes, told, values};
use super::*;
use crate::data::{IssueCode, Severity};

#[track_caller]
fn read_as(text: &str, sources: &[&str]) -> RawRecording {
    read_bytes(text.as_bytes(), &cask_file(sources))
        .unwrap_or_else(|error| panic!("{text}\n{}", told(&error)))
}

/// Rows of `A1` 1.5, 2.5, … and `A2` -1, -2, … behind times of 0.1 s.
const ROWS: &str = "0.0\t1.5\t-1\n0.1\t2.5\t-2\n0.2\t3.5\t-3\n0.3\t4.5\t-4\n0.4\t5.5\t-5\n";

#[track_caller]
fn holds_rows(text: &str) {
    let recording = read_as(text, &["A1", "A2"]);
    assert_eq!(values(&recording, 0), [1.5, 2.5, 3.5, 4.5, 5.5], "{text}");
    assert_eq!(values(&recording, 1), [-1.0, -2.0, -3.0, -4.0, -5.0], "{text}");
    assert!((recording.channels[0].uniform.sample_rate_hz - 10.0).abs() < 1e-9, "{text}");
    assert!(recording.issues.is_empty(), "{text}: {:?}", recording.issues);
}

#[test]
fn a_delimiter_at_the_end_of_header_or_rows_is_none_between_columns() {
    for end in ["", "\t", "\t\t"] {
        holds_rows(&format!("t\tA1\tA2{end}\n{ROWS}"));
        holds_rows(&format!("t\tA1\tA2{end}\ns\tg\tg{end}\n{ROWS}"));
        holds_rows(&format!("t\tA1\tA2\n{}", ROWS.replace('\n', &format!("{end}\n"))));
        holds_rows(&format!("t\tA1\tA2\ns\tg\tg{end}\n{}", ROWS.replace('\n', &format!("{end}\n"))));
    }
}

#[test]
fn times_are_found_by_the_names_that_loggers_give_them() {
    for name in [
        "X-Achse [s]",
        "Relative Zeit [s]",
        "Abtastzeit [s]",
        "Time axis",
        "X_Value",
        "Elapsed",
        "X-Axis (s)",
    ] {
        holds_rows(&format!("{name}\tA1\tA2\n{ROWS}"));
    }
    // One axis of an accelerometer.
    let axes = "X-Achse [m/s²]\tY-Achse [m/s²]\n1.5\t2\n2.5\t3\n";
    let message = told(&read_bytes(axes.as_bytes(), &cask_file(&["Y-Achse"])).unwrap_err());
    assert!(message.contains("no column of times"), "{message}");
}

#[test]
fn rows_below_the_units_are_no_samples() {
    for extra in [
        "Minimum\t1.5\t-5\nMaximum\t5.5\t-1\n",
        "Kommentar\t\t\n",
        "0.0\t1.5\t-5\n0.4\t5.5\t-1\n",
        "0.0\t1.5\t-5\n0.4\t5.5\t-1\n0.2\t3.5\t-3\n",
        "min\t\t\nmax\t\t\nvon Hand gesetzt\t\t\n",
    ] {
        holds_rows(&format!("Zeit\tA1\tA2\ns\tg\tg\n{extra}{ROWS}"));
    }
    holds_rows(&format!("Lauf 7\nZeit [s]\tA1 [g]\tA2 [g]\nKommentar: von Hand\n{ROWS}"));
    holds_rows(&format!("Zeit [s]\tA1 [g]\tA2 [g]\nMinimum:\t1.5\t-5\n{ROWS}"));
    let units = format!("Zeit\tA1\tA2\ns\tg\tg\nMinimum\t1.5\t-5\n{ROWS}");
    assert_eq!(read_as(&units, &["A1"]).channels[0].unit.as_deref(), Some("g"));
}

const LVM: &str = "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tNo\n\
    X_Columns\tOne\nTime_Pref\tRelative\nDate\t2026/11/20\nTime\t12:34:56.789\n***End_of_Header***\t\n\t\n\
    Channels\t2\t\t\nSamples\t5\t5\t\nDate\t2026/11/20\t2026/11/20\t\nTime\t12:34:56.789\t12:34:56.789\t\n\
    X_Dimension\tTime\tTime\t\nX0\t0.0000000000000000E+0\t0.0000000000000000E+0\t\nDelta_X\t0.100000\t0.100000\t\n\
    ***End_of_Header***\t\t\t\n";

#[test]
fn measurement_files_of_labview_are_read_with_and_without_times() {
    holds_rows(&format!("{LVM}X_Value\tA1\tA2\tComment\n{ROWS}"));
    holds_rows(&format!("{LVM}X_Value\tA1\tA2\tComment\n{}", ROWS.replace('\n', "\t\n")));
    let each = ROWS.lines().map(|row| {
        let (time, cells) = row.split_once('\t').unwrap();
        row.replace(cells, &cells.replace('\t', &format!("\t{time}\t"))) + "\n"
    });
    holds_rows(&format!("{LVM}X_Value\tA1\tX_Value\tA2\tComment\n{}", each.collect::<String>()));
    let none = ROWS.lines().map(|row| &row[3..]).collect::<Vec<_>>().join("\n") + "\n";
    holds_rows(&format!("{LVM}X_Value\tA1\tA2\tComment\n{none}"));
    for without in
        [LVM.replace("Delta_X", "Other"), LVM.replace("Dimension\tTime\tTime", "Dimension\tForce\tForce")]
    {
        let text = format!("{without}X_Value\tA1\tA2\tComment\n{none}");
        let message = told(&read_bytes(text.as_bytes(), &cask_file(&["A1"])).unwrap_err());
        assert!(message.contains("no column of times") && message.contains("sample_rate_hz"), "{message}");
    }
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("r.lvm");
    std::fs::write(&path, format!("{LVM}X_Value\tA1\tA2\tComment\n{none}")).unwrap();
    let listing = list(&path, Limits::default(), &|_| {}).unwrap();
    let a1 = listing.channels.iter().find(|channel| channel.source == "A1").unwrap();
    assert_eq!((a1.sample_rate_hz, a1.samples), (Some(10.0), Some(5)));
    assert_eq!(listing.facts["time column"], "none found; Delta_X states 10 Hz");
}

#[test]
fn a_delta_x_that_contradicts_times_or_cask_file_is_told() {
    use std::fmt::Write as _;
    let text = |delta: &str, period_us: u32, has_times: bool| {
        let header =
            LVM.replace("0.100000", delta).replace(".\nMulti", ",\nMulti").replace("0.0000", "0,0000");
        let mut text = format!("{header}X_Value\tA1\tA2\tComment\n");
        for i in 0..4000 {
            let time_us = i * period_us;
            let time = format!("{},{:06}", time_us / 1_000_000, time_us % 1_000_000);
            let time = if has_times { time } else { String::new() };
            let _ = writeln!(text, "{time}\t{},5\t{},5", i % 9, i % 7);
        }
        text
    };
    let issues = |text: &str, cask: &CaskFile| {
        let recording = read_bytes(text.as_bytes(), cask).map_err(|error| told(&error))?;
        Ok::<_, String>(recording.channels[0].uniform.issues.clone())
    };
    let plain = cask_file(&["A1"]);
    let mut stated = cask_file(&["A1"]);
    stated.channels[0].sample_rate_hz = Some(10_000.0);
    let mut named = cask_file(&["A1"]);
    named.time = Some("X_Value".into());
    // Rounded to what the file shows, or as clocks are apart.
    for (delta, period_us) in [("0,000100", 100), ("1,0E-4", 100), ("0,00010005", 100), ("0,000020", 20)] {
        assert_eq!(issues(&text(delta, period_us, true), &plain), Ok(Vec::new()), "{delta}");
    }
    assert_eq!(issues(&text("0,000100", 100, false), &stated), Ok(Vec::new()));
    for (text, cask, rate_hz) in [
        (text("0,0001005", 100, true), &plain, "9950.249 Hz"),
        (text("0,000105", 100, true), &stated, "9523.81 Hz"),
        (text("0,000105", 100, true), &named, "9523.81 Hz"),
        (text("0,000105", 100, false), &stated, "9523.81 Hz"),
    ] {
        let issues = issues(&text, cask).unwrap();
        let [issue] = &issues[..] else { panic!("{issues:?}") };
        assert_eq!((issue.code, issue.severity), (IssueCode::Clock, Severity::Warning));
        assert!(issue.message.contains(rate_hz) && issue.message.contains("10000 Hz"), "{}", issue.message);
    }
    let message = issues(&text("0,000105", 100, true), &plain).unwrap_err();
    for part in ["Delta_X = 0,000105", "9523.81 Hz", "sample_rate_hz = 9523.81 or sample_rate_hz = 10000"] {
        assert!(message.contains(part), "{message}");
    }
    // Without LabVIEW's end of the header too.
    let preamble = text("0,000105", 100, true).replace("***End_of_Header***", "");
    assert!(issues(&preamble, &plain).is_err());
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("r.lvm");
    std::fs::write(&path, text("0,000105", 100, true)).unwrap();
    let listing = list(&path, Limits::default(), &|_| {}).unwrap();
    assert!(listing.issues.iter().any(|issue| issue.message.contains("Delta_X")), "{:?}", listing.issues);
}

#[test]
fn a_channel_keeps_to_the_times_on_its_left() {
    let text = "t\tA1\tt\tA2\n0.0\t1\t0.00\t5\n0.1\t2\t0.05\t6\n0.2\t3\t0.10\t7\n";
    let recording = read_as(text, &["A1", "A2"]);
    let rates_hz = [0, 1].map(|channel: usize| recording.channels[channel].uniform.sample_rate_hz);
    assert!((rates_hz[0] - 10.0).abs() < 1e-9 && (rates_hz[1] - 20.0).abs() < 1e-9, "{rates_hz:?}");
}

#[test]
fn a_cell_over_the_range_or_without_value_is_missing() {
    for word in [
        "#NV",
        "#VALUE!",
        "#DIV/0!",
        "#WERT!",
        "OL",
        "-OL",
        "OVER",
        "#OVERFLOW",
        "OVL",
        "OVLD",
        "-OVL",
        "∞",
        "-∞",
        "1.#QNAN",
        "1.#IND",
        "-1.#IND",
        "NoValue",
        "---",
        "NaN",
    ] {
        let text = format!("t\tA1\tA2\n{}", ROWS.replace("3.5", word));
        let recording = read_as(&text, &["A1", "A2"]);
        assert!(values(&recording, 0)[2].is_nan(), "{word}");
        assert_eq!(values(&recording, 1)[2..3], [-3.0], "{word}");
        assert_eq!(recording.channels[0].uniform.issues[0].code, IssueCode::NonFinite, "{word}");
        // Without times the place of the others hangs on it.
        let mut cask = cask_file(&["A1"]);
        cask.channels[0].sample_rate_hz = Some(10.0);
        for text in [format!("A1\n1.5\n{word}\n3.5\n4.5\n"), format!("n;A1\n1;1,5\n2;{word}\n3;3,5\n4;4,5\n")]
        {
            let recording = read_bytes(text.as_bytes(), &cask).unwrap();
            assert_eq!((values(&recording, 0).len(), values(&recording, 0)[2]), (4, 3.5), "{text}");
        }
    }
    let mut cask = cask_file(&["A1"]);
    cask.channels[0].sample_rate_hz = Some(10.0);
    let recording = read_bytes(b"A1;A2\n1;2\n;3\n3;4\n;\n;\n", &cask).unwrap();
    assert_eq!(values(&recording, 0).len(), 3, "empty lines at the end are none");
}

#[test]
fn thousands_in_quotes_are_no_decimal_fractions() {
    let rows = "0.000,\"1,683\",5\n0.001,12,6\n0.002,\"-1,200\",7\n0.003,\"-1,416\",8\n";
    let message = told(&read_bytes(format!("t,A1,A2\n{rows}").as_bytes(), &cask_file(&["A1"])).unwrap_err());
    assert!(message.contains("line 2") && message.contains("1,683") && message.contains("'.'"), "{message}");
}

#[test]
fn line_ends_minus_signs_bars_and_wide_letters_are_read() {
    holds_rows(&format!("t|A1|A2\n{}", ROWS.replace('\t', "|")));
    holds_rows(&format!(
        "| t | A1 | A2 |\n{}",
        ROWS.replace('\t', " | ").replace('\n', " |\n").replace("0.", "| 0.")
    ));
    holds_rows(&format!("t\tA1\tA2\n{}", ROWS.replace("\t-", "\t−")));
    holds_rows(&format!("t\tA1\tA2\n{ROWS}").replace('\n', "\r"));
    let text = format!("Zeit [s]\tA1 [m/s²]\tA2\n{ROWS}");
    for text in
        [text.clone(), text.replace('\n', "\r\n"), text.replace('\n', "\r"), format!("\u{feff}{text}")]
    {
        for is_low_first in [true, false] {
            let bytes = |unit: u16| if is_low_first { unit.to_le_bytes() } else { unit.to_be_bytes() };
            let wide: Vec<u8> = text.encode_utf16().flat_map(bytes).collect();
            let recording =
                read_bytes(&wide, &cask_file(&["A1", "A2"])).unwrap_or_else(|e| panic!("{}", told(&e)));
            assert_eq!(values(&recording, 1), [-1.0, -2.0, -3.0, -4.0, -5.0], "{text}");
            assert_eq!(recording.channels[0].unit.as_deref(), Some("m/s²"));
        }
    }
    // Longer than what is looked at first.
    let numbers: Vec<String> = (0..20_000).map(|i: u32| format!("1;{i}")).collect();
    let rows = format!("A1;A2\r{}\r", numbers.join("\r"));
    let mut cask = cask_file(&["A2"]);
    cask.channels[0].sample_rate_hz = Some(10.0);
    assert_eq!(values(&read_bytes(rows.as_bytes(), &cask).unwrap(), 0).len(), 20_000);
}

#[test]
fn zero_bytes_behind_the_rows_are_told_as_such() {
    for zeros in ["\0\0\0\0", "\0\0\0\n\0\0"] {
        let recording = read_as(&format!("t\tA1\tA2\n{ROWS}{zeros}"), &["A1"]);
        assert_eq!(values(&recording, 0).len(), 5);
        let [issue] = &recording.issues[..] else { panic!("{:?}", recording.issues) };
        assert!(issue.message.contains("from line 7 on stand zero bytes"), "{}", issue.message);
    }
    let recording = read_as(&format!("t\tA1\tA2\n{ROWS}0.5\t\0\0\0"), &["A1"]);
    assert!(recording.issues[0].message.contains("ends in the middle"), "{:?}", recording.issues);
    // In a row, in a column that is read and in one that is not: rows behind are lost with it.
    for zeros in ["0.5\t6.5\0\0\0\n", "0.5\t6.5\t-6\0\0\0\n", "0.5\t\0.5\t-6\n", "\0\0\0\n"] {
        for sources in [&["A1"][..], &["A2"]] {
            let recording = read_as(&format!("t\tA1\tA2\n{ROWS}{zeros}{ROWS}"), sources);
            assert_eq!(values(&recording, 0).len(), 5, "{zeros:?}");
            let [issue] = &recording.issues[..] else { panic!("{:?}", recording.issues) };
            let says = "line 7 holds zero bytes";
            assert!(
                issue.message.contains(says) && issue.message.contains("the 5 lines behind"),
                "{}",
                issue.message
            );
        }
    }
}

#[test]
fn carriage_returns_alone_amid_line_breaks_end_lines_too() {
    let (first, rest) = ROWS.split_at(ROWS.match_indices('\n').nth(1).unwrap().0);
    for text in [
        format!("t\tA1\tA2\n{first}{}\n", rest.trim_end().replace('\n', "\r")),
        format!("t\tA1\tA2\n{first}{}", rest.trim_end().replace('\n', "\r")),
        format!("t\tA1\tA2\n{}{rest}", first.replace('\n', "\r")),
        format!("t\tA1\tA2\r{}{rest}", first.replace('\n', "\r")),
        format!("t\tA1\tA2\r\n{first}{}", rest.replace('\n', "\r\r\n")),
        format!("t\tA1\tA2\n\r{first}{}", rest.replace('\n', "\n\r")),
    ] {
        holds_rows(&text);
        let recording = read_as(&text, &["A1"]);
        assert_eq!(values(&recording, 0).len(), 5, "{text:?}");
        assert_eq!(recording.issues, [], "{text:?}");
    }
}

#[test]
fn a_counter_headed_time_is_asked_about() {
    use std::fmt::Write as _;
    let mut text = String::from("Time;A1\n");
    for i in (1..9000).filter(|i| !(4000..4010).contains(i)) {
        let _ = writeln!(text, "{i};{},5", i % 9);
    }
    let mut cask = cask_file(&["A1"]);
    let message = told(&read_bytes(text.as_bytes(), &cask).unwrap_err());
    assert!(message.contains("do they count the samples? Then write sample_rate_hz"), "{message}");
    cask.channels[0].sample_rate_hz = Some(51_200.0);
    let a1 = &read_bytes(text.as_bytes(), &cask).unwrap().channels[0].uniform;
    assert!((a1.sample_rate_hz / 51_200.0 - 1.0).abs() < 1e-9 && a1.samples.len() == 8999);
    assert!(
        a1.gaps.len() == 1 && a1.issues.len() == 1 && a1.issues[0].code == IssueCode::Gap,
        "{:?}",
        a1.issues
    );
}

#[test]
fn a_line_without_values_keeps_its_place_where_no_times_tell() {
    let mut cask = cask_file(&["A1"]);
    cask.channels[0].sample_rate_hz = Some(10.0);
    for empty in [",", "\"\",\"\"", "", " , ", "\r"] {
        let rows = format!("A1,A2\n1,2\n3,4\n5,6\n7,8\n{empty}\n9,10\n11,12\n\n\n");
        let read = read_bytes(rows.as_bytes(), &cask).unwrap();
        let samples = &read.channels[0].uniform.samples;
        assert_eq!(samples.len(), 7, "{empty:?}");
        assert!(samples.get(4).is_nan() && (samples.get(6) - 11.0).abs() < 1e-12, "{empty:?}");
    }
    // Doubled line breaks are none.
    let read = read_bytes(b"A1,A2\n\n1,2\n\n3,4\n\n5,6\n\n7,8\n\n", &cask).unwrap();
    assert_eq!(read.channels[0].uniform.samples.len(), 4);
}
