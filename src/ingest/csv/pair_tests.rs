//! Two columns of times in one table to what they say of each other.

use super::tests::{cask_file, read_bytes, told};
use super::time_tests::{decimal, table};
use super::*;
use crate::data::{IssueCode, Severity};

/// Two columns of times in one table, 4000 rows at 10 kHz by the first.
fn twofold(headers: &str, other: impl Fn(usize) -> String) -> String {
    let clock = |i| format!("{};{}", decimal(i, 4, ','), other(i));
    table(&format!("{headers};A1;A2"), 4000, ';', clock)
}

#[test]
fn columns_of_times_that_contradict_each_other_are_told() {
    let read = |text: &str, cask: &CaskFile| read_bytes(text.as_bytes(), cask).map_err(|error| told(&error));
    let cask = cask_file(&["A1", "A2"]);
    // As rounding, other starts, clocks of loggers, whole seconds and counters have it.
    for text in [
        twofold("time_s;time_ms", |i| decimal(i, 1, ',')),
        twofold("time_s;time_ms", |i| (i / 10).to_string()),
        twofold("time_s;time_ms", |i| decimal(i * 10_005 / 10_000 + 77, 1, ',')),
        twofold("time_s;Timestamp", |i| format!("12:34:{}", decimal(10_000 + i / 160 * 16, 3, ','))),
        twofold("time_s;Timestamp", |i| format!("12:34:{:02}", 10 + i / 3000)),
        twofold("t;Time", |i| (i + 1).to_string()),
        twofold("t;Timestamp", |i| (1_795_176_000_000_000 + 100 * i).to_string()),
        twofold("t;Timestamp", |i| (4000 * i).to_string()),
        twofold("t;time_ms", |_| "5".into()),
        twofold("t;time_ms", |i| (i % 10).to_string()),
        twofold("t;Timestamp", |i| {
            if i % 3 == 0 { "--:--:--".into() } else { format!("12:34:{}", decimal(10_000 + i / 10, 3, ',')) }
        }),
    ] {
        let recording = read(&text, &cask).unwrap_or_else(|error| panic!("{}\n{error}", &text[..90]));
        assert!(recording.issues.is_empty(), "{}: {:?}", &text[..90], recording.issues);
        assert!((recording.channels[0].uniform.sample_rate_hz / 1e4 - 1.0).abs() < 1e-6, "{}", &text[..90]);
    }
    // By 0.5 %: a warning; where one stepped on the way too.
    for (text, says) in [
        (twofold("time_s;time_ms", |i| decimal(i * 1005, 4, ',')), "0.3999 s and 0.4019 s"),
        (twofold("t;Zeit", |i| decimal(i * 1005, 7, ',')), "0.3999 s and 0.4019 s"),
        (
            twofold("t;time_ms", |i| {
                let ahead = if i < 1000 { 0 } else { 50 - i.saturating_sub(3000) / 20 };
                decimal(i + ahead, 1, ',')
            }),
            "they are 0.005 s apart",
        ),
    ] {
        let recording = read(&text, &cask).unwrap();
        let [issue] = &recording.issues[..] else { panic!("{:?}", recording.issues) };
        assert!(issue.severity == Severity::Warning && issue.message.contains(says), "{}", issue.message);
    }
    // By 5 %, or by a unit: an error that names both, until the cask file says which.
    for (text, other) in [
        (twofold("time_s;time_ms", |i| decimal(i * 105, 3, ',')), "time_ms"),
        (twofold("time_s;time_ms", |i| decimal(i, 4, ',')), "time_ms"),
        (twofold("time_s;Clock", |i| format!("12:34:{}", decimal(100_000 + 2 * i, 4, ','))), "Clock"),
        (twofold("t;t", |i| decimal(i * 105, 6, ',')), "t"),
    ] {
        let message = read(&text, &cask).err().unwrap_or_default();
        for part in ["contradict each other", &format!("time = {other:?}"), "sample_rate_hz", "0.3999 s"] {
            assert!(message.contains(part), "{message} without {part}");
        }
        let mut stated = cask.clone();
        stated.channels.iter_mut().for_each(|spec| spec.sample_rate_hz = Some(1e4));
        let recording = read(&text, &stated).unwrap();
        assert_eq!(recording.issues[0].severity, Severity::Warning);
        assert!((recording.channels[0].uniform.sample_rate_hz - 1e4).abs() < 1e-6);
    }
}

/// What is said of two columns of times, 9000 rows at 20 kHz by the first.
fn said(other: impl Fn(usize) -> String) -> Result<Vec<String>, String> {
    let text = table("t;Timestamp;A1;A2", 9000, ';', |i| format!("{};{}", decimal(5 * i, 5, ','), other(i)));
    let recording = read_bytes(text.as_bytes(), &cask_file(&["A1"])).map_err(|error| told(&error))?;
    assert!(recording.issues.iter().all(|issue| issue.severity == Severity::Warning));
    Ok(recording.issues.into_iter().map(|issue| issue.message).collect())
}

#[test]
fn a_step_amid_a_tick_of_a_rounded_clock_is_told() {
    // The change that the lost rows make lies between; the ticks are a row early or late.
    let clock = |i: usize| {
        let at = 5 * if i < 3100 { i } else { i + 15 } + i / 20 % 2 * 5 + 50;
        cut(at, 100)
    };
    let [message] = &said(clock).unwrap()[..] else { panic!("nothing said") };
    assert!(message.contains("at row 3101 of the table the second steps by 0.00075 s"), "{message}");
}

/// The time of a row in 10 µs, cut to a step of so many.
fn cut(count: usize, step: usize) -> String {
    decimal(count / step * step, 5, ',')
}

#[test]
fn rows_lost_between_two_clocks_are_told_to_the_coarser_ones_resolution() {
    let lost = |row: usize, count: usize| move |i: usize| if i < row { 5 * i } else { 5 * (i + count) };
    // Ten microseconds, one and ten milliseconds; the least that each can tell is a few rows.
    for (step, least) in [(1, 3), (100, 4), (1000, 7)] {
        for row in [1000, 3105, 7000] {
            for count in [least, 8] {
                let at = lost(row, count);
                let [message] = &said(|i| cut(at(i), step)).unwrap()[..] else {
                    panic!("{step} {row} {count}")
                };
                assert!(message.contains("the second steps by"), "{message}");
                let place: usize =
                    message.split("at row ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
                assert!((row..=row + 1 + step / 5).contains(&(place - 1)), "{row}: {message}");
            }
        }
    }
}

#[test]
fn a_rate_that_a_coarse_clock_contradicts_is_told() {
    // Tenths of a second, four of them.
    let cut_tenths = |part: f64| {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "small counts"
        )]
        move |i: usize| cut((5.0 * i as f64 * part) as usize, 10_000)
    };
    for part in [1.0, 1.0008, 0.9992] {
        assert_eq!(said(cut_tenths(part)).unwrap(), [""; 0], "{part}");
    }
    for part in [0.996, 0.998, 1.002] {
        let [message] = &said(cut_tenths(part)).unwrap()[..] else { panic!("{part}") };
        assert!(message.contains("contradict each other"), "{message}");
    }
    for part in [0.95, 1.05] {
        assert!(said(cut_tenths(part)).unwrap_err().contains("contradict each other"), "{part}");
    }
}

#[test]
fn stamps_that_jitter_saw_or_come_late_contradict_nothing() {
    type Stamp = Box<dyn Fn(usize) -> usize>;
    let wave = |i: usize, least: usize| (i * 7919 + i / 7 * 104_729) % least;
    let stamps: [(&str, Stamp); 6] = [
        ("blocks of 512, stamped to 1 ms", Box::new(|i| i / 512 * 512 * 5 / 100 * 100)),
        ("ticks of 15.6 ms in whole ms", Box::new(|i| (i * 5 * 10 / 15_625 * 15_625 / 10) / 100 * 100)),
        ("jitter of 2 ms, to 1 ms", Box::new(move |i| (5 * (i / 20 * 20) + wave(i / 20, 200)) / 100 * 100)),
        (
            "one block late by 1.2 ms",
            Box::new(|i| 5 * if (4000..4024).contains(&i) { 4024 } else { i } / 100 * 100),
        ),
        ("a clock off by 0.05 %", Box::new(|i| (10_005 * i / 2000) / 100 * 100)),
        ("whole ms, rounded", Box::new(|i| (5 * i + 50) / 100 * 100)),
    ];
    for (what, stamp) in stamps {
        let mut last = 0;
        let rising: Vec<usize> = (0..9000)
            .map(|i| {
                last = last.max(stamp(i));
                last
            })
            .collect();
        assert_eq!(said(|i| decimal(rising[i], 5, ',')).unwrap(), [""; 0], "{what}");
    }
}

#[test]
fn a_counter_tells_rows_lost_that_the_times_beside_it_hide() {
    // From row 100 on `lost` rows are missing, of which the times show so many; cut to steps of 50 µs.
    let gaps = |header: &str, lost: usize, shown: usize, step: usize| {
        let text = table(&format!("{header};A1;A2"), 2000, ';', |i| {
            let behind = |rows| if i < 100 { i } else { i + rows };
            format!("{};{}", behind(lost), cut(5 * behind(shown) / step * step, 1))
        });
        let recording =
            read_bytes(text.as_bytes(), &cask_file(&["A1"])).map_err(|error| told(&error)).unwrap();
        recording.issues.into_iter().map(|issue| (issue.code, issue.message)).collect::<Vec<_>>()
    };
    for (lost, shown, step) in [(1, 0, 5), (20, 0, 5), (20, 10, 5), (200, 150, 5), (12, 12, 100), (3, 0, 100)]
    {
        let [(code, message)] = &gaps("Sample;t", lost, shown, step)[..] else {
            panic!("{lost} {shown} {step}")
        };
        assert_eq!(*code, IssueCode::Gap);
        assert!(message.contains(&format!("{lost} of them are missing")), "{message}");
        assert!(message.contains("the times in \"t\" do not show that"), "{message}");
    }
    for (header, lost, shown, step) in [
        ("Sample;t", 0, 0, 5),
        ("Sample;t", 20, 20, 5),
        ("Sample;t", 1, 1, 5),
        ("Speed;t", 20, 0, 5),
        ("n;t", 0, 0, 100),
    ] {
        assert_eq!(gaps(header, lost, shown, step), [], "{header} {lost} {shown} {step}");
    }
}
