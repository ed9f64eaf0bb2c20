//! From tables that say in a stranger's words what their numbers are to the numbers of a sound drop, or to
//! none.

use crate::run::{Answer, analyze, fixture, number};
use std::fmt::Write as _;
use std::fs;

/// The number in a row, as a recorder writes it.
type RowCounter = fn(usize) -> String;

/// 12.5 kHz.
const STEP_S: f64 = 8e-5;

/// A1 and A2 of a sound drop, g.
fn sound() -> Vec<[f64; 2]> {
    let text = fs::read_to_string(fixture("anf10-plain.csv")).expect("the example");
    let number = |cell: &str| cell.parse().expect("a number");
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(number).collect();
        [cells[1], cells[2]]
    };
    text.lines().skip(1).map(row).collect()
}

/// The row in the middle of the first impact.
fn impact(rows: &[[f64; 2]]) -> usize {
    let first = rows.iter().position(|row| row[0].abs() > 20.0).expect("an impact");
    first + 30
}

/// What the analysis of a table says; `has_rate` where its cask file states that.
fn analyzed(table: &str, has_rate: bool) -> Answer {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [recording, cask] = ["drop.csv", "drop.toml"].map(|name| folder.path().join(name));
    fs::write(&recording, table).expect("a table");
    let text = fs::read_to_string(fixture("anf10-plain.toml")).expect("the example");
    let rate = if has_rate { "[[channel]]\nsample_rate_hz = 12500" } else { "[[channel]]" };
    fs::write(&cask, text.replace("[[channel]]", rate)).expect("a cask file");
    analyze(&recording, &cask)
}

/// Refused, or without k.
fn gives_no_k(what: &str, answer: &Answer) {
    let is_refused = answer.status == 2;
    assert!(is_refused || number(&answer.json(), "/k/value").is_none(), "{what}: {}", answer.stdout);
}

fn table(head: &str, rows: impl Iterator<Item = String>) -> String {
    rows.fold(format!("{head}\n"), |mut text, row| {
        let _ = writeln!(text, "{row}");
        text
    })
}

fn timed(at: usize) -> f64 {
    STEP_S * f64::from(u32::try_from(at).expect("few rows"))
}

#[test]
fn rows_of_several_sensors_in_any_order_give_no_k() {
    let rows = sound();
    for scales in [&[1.0, 0.8][..], &[1.0, 1.0, 0.8, 0.8], &[1.0, 0.8, 1.1], &[1.0, 0.8, 0.9, 1.1, 0.85]] {
        let row = |(at, [a, b]): (usize, &[f64; 2])| {
            let scale = scales[at % scales.len()];
            format!("{:.5},{:.3},{:.3}", timed(at), a * scale, b * scale)
        };
        let answer = analyzed(&table("Time,A1,A2", rows.iter().enumerate().map(row)), false);
        gives_no_k(&format!("{scales:?}"), &answer);
        assert!(answer.stdout.contains("sensors by turns"), "{}", answer.stdout);
    }
}

#[test]
fn rows_that_a_counter_of_any_kind_shows_to_be_missing_give_no_k() {
    let rows = sound();
    let at = impact(&rows);
    let counters: [(&str, RowCounter); 7] = [
        ("Lfd", |i| (i % 60).to_string()),
        ("rest", |i| (9000 - i).to_string()),
        ("q", |i| (i % 8).to_string()),
        ("block", |i| (i / 4).to_string()),
        ("ticks", |i| (80 * i + i % 3).to_string()),
        ("czas", |i| format!("{:.5}", timed(i))),
        ("w", |i| (i * 7 % 4096).to_string()),
    ];
    for (name, count) in counters {
        let kept = || rows.iter().enumerate().filter(|(i, _)| !(at..at + 4).contains(i));
        let row = |(i, [a, b]): (usize, &[f64; 2])| format!("{a},{},{b}", count(i));
        let answer = analyzed(&table(&format!("A1,{name},A2"), kept().map(row)), true);
        gives_no_k(name, &answer);
    }
}

#[test]
fn whole_numbers_beside_an_unexplained_number_are_asked_about_wherever_it_stands() {
    let rows = sound();
    let raw = |(at, [a, b]): (usize, &[f64; 2])| {
        format!("{:.5},{:.0},{:.0}", timed(at), (a / 0.9).round(), (b / 0.9).round())
    };
    for above in [
        "# {\"k\": 0.9}",
        "factor,9/10",
        "Output,90 %",
        "0.9 m/s2/LSB",
        "Range,100",
        "Cal A1=0.9 A2=0.9",
        "Sensor constant;0,9",
        "multiply by 0.9",
    ] {
        let head = format!("{above}\nTime,A1,A2");
        let answer = analyzed(&table(&head, rows.iter().enumerate().map(raw)), false);
        assert!(answer.status == 2 && answer.stderr.contains("scale = 1"), "{above}: {}", answer.stderr);
    }
    for head in ["Time,A1 [div],A2 [div]", "Time,A1,A2,K_A1"] {
        let row = |row| raw(row) + if head.contains('K') { ",0.9" } else { "" };
        let answer = analyzed(&table(head, rows.iter().enumerate().map(row)), false);
        assert!(answer.status == 2 && answer.stderr.contains("scale = 1"), "{head}: {}", answer.stderr);
    }
    for above in ["Temperature,21.5", "Mass,1.429 t", "Logger 7;27.11.2026", "Sample rate: 12500 Hz", "A. B."]
    {
        let head = format!("{above}\nTime,A1,A2");
        let answer = analyzed(&table(&head, rows.iter().enumerate().map(raw)), false);
        assert_ne!(answer.status, 2, "{above}: {}", answer.stderr);
    }
}

#[test]
fn a_block_that_one_channel_or_all_hold_several_times_gives_no_k() {
    let rows = sound();
    let at = impact(&rows) - 12;
    for (columns, times) in [(1..2, 1), (0..1, 1), (0..2, 2)] {
        let mut rows = rows.clone();
        for copy in 1..=times {
            for row in 0..12 {
                let block = rows[at + row];
                rows[at + 12 * copy + row][columns.clone()].copy_from_slice(&block[columns.clone()]);
            }
        }
        let row = |(at, [a, b]): (usize, &[f64; 2])| format!("{:.5},{a},{b}", timed(at));
        let answer = analyzed(&table("Time,A1,A2", rows.iter().enumerate().map(row)), false);
        assert!(answer.stdout.contains("to the last digit"), "{columns:?}: {}", answer.stdout);
    }
}

#[test]
fn each_channel_takes_the_times_at_its_left() {
    let rows = sound();
    let half = rows.len() / 2;
    let row = |(at, [a, _]): (usize, &[f64; 2])| {
        let own = if at < half { format!("{:.5},{}", timed(2 * at), rows[2 * at][1]) } else { "0,0".into() };
        format!("{:.5},{a},{own}", timed(at))
    };
    let table = table("Zeit 1 [s],A1,Zeit 2 [s],A2", rows.iter().enumerate().map(row));
    let answer = analyzed(&table, false);
    let k = number(&answer.json(), "/k/value").expect("k");
    let sound =
        number(&analyze(&fixture("anf10-plain.csv"), &fixture("anf10-plain.toml")).json(), "/k/value");
    assert!((k - sound.expect("k")).abs() < 0.01, "{k} for {sound:?}: {}", answer.stdout);
}

#[test]
fn what_is_wrong_with_a_table_is_said_as_it_is() {
    let rows = sound();
    let complaint = |head: &str, row: &dyn Fn(usize) -> String| {
        let answer = analyzed(&table(head, (0..rows.len()).map(row)), false);
        (answer.status, answer.stderr)
    };
    let values = |at: usize| format!("{},{}", rows[at][0], rows[at][1]);
    let unpadded = |at: usize| format!("0.{},{}", 100 * at, values(at));
    let two_units = |at: usize| {
        let time_ms = timed(at) * 1e3 - 40.0;
        let time = if time_ms.abs() < 0.999 { time_ms * 1e3 } else { time_ms };
        format!("{time:.3},{}", values(at))
    };
    let fixed_width = |at: usize| {
        let [a, b] = rows[at];
        let a = if at == impact(&rows) { String::new() } else { a.to_string() };
        format!("{:10.5} {a:>10} {b:>10}", timed(at))
    };
    let r_names = |at: usize| format!("\"{}\" {:.5} {} {}", at + 1, timed(at), rows[at][0], rows[at][1]);
    assert!(complaint("Time,A1,A2", &unpadded).1.contains("without its leading zeros"));
    assert!(complaint("Time [ms],A1,A2", &two_units).1.contains("the unit changes"));
    assert!(complaint("      Time         A1         A2", &fixed_width).1.contains("which one is missing"));
    assert_ne!(complaint("\"time\" \"A1\" \"A2\"", &r_names).0, 2);
    let keysight = |at: usize| format!("{:.6E},{}", timed(at), values(at));
    let numbered = complaint("x-axis,1,2\nsecond,g,g", &keysight).1;
    assert!(numbered.contains("no column is headed \"A1\""), "{numbered}");
}

#[test]
fn layouts_of_loggers_give_the_numbers_of_the_plain_table() {
    let rows = sound();
    let plain = analyze(&fixture("anf10-plain.csv"), &fixture("anf10-plain.toml")).json();
    let k = number(&plain, "/k/value").expect("k");
    let us = |at: usize| 900_000 + 80 * at;
    let stamp = |at: usize| format!("2026/11/20 12:34:{}", 56 + us(at) / 1_000_000);
    let values = |at: usize, mark: &str| format!("{}{mark}{}", rows[at][0], rows[at][1]);
    let slower = |at: usize| rows.get(2 * at).map_or_else(String::new, |row| row[1].to_string());
    let labview = "LabVIEW Measurement\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\n\nChannels\t2\t\n\
                   Y_Unit_Label\tg\tg\nX_Dimension\tTime\tTime\nX0\t0.0\t0.0\nDelta_X\t8.0E-5\t1.6E-4\n\
                   ***End_of_Header***\nA1\tA2\tComment";
    let msr = "*CREATOR\nMSR\n*STARTTIME\n2026-11-20;12:34:56;\n*CHANNEL\nTIME;A1;A2\n*UNIT\n;G;G\n*DATA";
    let graphtec = "Vendor,GRAPHTEC Corporation\nSampling interval,80us\nNumber,Date&Time,ms,A1,A2,Alarm\n\
                    NO.,Time,ms,g,g,A";
    let layouts: [(&str, &dyn Fn(usize) -> String); 5] = [
        (graphtec, &|at| {
            let ms = us(at) % 1_000_000;
            format!("{},{},{}.{:03},{},LL", at + 1, stamp(at), ms / 1000, ms % 1000, values(at, ","))
        }),
        (msr, &|at| {
            format!(
                "2026-11-20 12:34:{}.{:06};{}",
                56 + us(at) / 1_000_000,
                us(at) % 1_000_000,
                values(at, ";")
            )
        }),
        ("stamp.sec,stamp.nsec,A1,A2", &|at| {
            format!(
                "{},{},{}",
                1_795_000_000 + us(at) / 1_000_000,
                us(at) % 1_000_000 * 1000,
                values(at, ",")
            )
        }),
        (labview, &|at| format!("{}\t{}", rows[at][0], slower(at))),
        ("Delta : 0.00008 sec.\nA1 [g];A2 [g]", &|at| values(at, ";")),
    ];
    for (head, row) in layouts {
        let answer = analyzed(&table(head, (0..rows.len()).map(row)), false);
        assert_ne!(answer.status, 2, "{head}: {}", answer.stderr);
        let own = number(&answer.json(), "/k/value").expect("k");
        assert!((own - k).abs() < 0.001, "{head}: {own} for {k}");
    }
}

/// The end of a recording of one second and the next beginning fall back as a clock within each second.
#[test]
fn recordings_of_a_second_that_follow_one_another_are_not_joined() {
    let row = |at: usize| format!("{:.4},{at},{}", timed(at % 12_500), at % 7);
    let answer = analyzed(&table("Time [s],A1,A2", (0..25_000).map(row)), false);
    assert!(answer.status == 2 && answer.stderr.contains("falls back by 1 s"), "{}", answer.stderr);
}
