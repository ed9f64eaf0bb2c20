//! Tests of what messages say of their samples: of files of one topic in JSON, what reading gives or why it
//! refuses.

use super::super::list::list;
use super::super::read::read;
use super::super::written::{ZERO_NS, cask_file, channel, closed, message};
use crate::data::{CaskFile, RowsOf, Severity};
use crate::ingest::{Limits, RawRecording, ReadRequest};
use mcap::WriteOptions;
use miette::Diagnostic;

/// Forty messages 1 ms apart on a clock of 1970, logged 3 % slower; `fields` stand beside `"a"`, the number
/// of the message.
fn file(publishers: u16, fields: impl Fn(i64) -> String) -> Vec<u8> {
    closed(WriteOptions::new(), |writer| {
        let publisher = |i: u16| [("publisher".to_owned(), i.to_string())].into();
        let ids: Vec<u16> =
            (0..publishers).map(|i| writer.add_channel(0, "/x", "json", &publisher(i)).unwrap()).collect();
        for i in 0..40 {
            for id in &ids {
                let text = format!("{{\"a\":{i},{}}}", fields(i));
                message(writer, *id, ZERO_NS + i * 1_030_000, text.as_bytes());
            }
        }
    })
}

fn with_path<T>(bytes: &[u8], f: impl FnOnce(&std::path::Path) -> T) -> T {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording");
    std::fs::write(&path, bytes).unwrap();
    f(&path)
}

fn read_bytes(bytes: &[u8], cask_file: &CaskFile) -> Result<RawRecording, String> {
    let told = |error: crate::ingest::IngestError| {
        format!("{error} | {}", error.help().map(|help| help.to_string()).unwrap_or_default())
    };
    with_path(bytes, |path| read(ReadRequest::silent(path, Limits::default()), cask_file).map_err(told))
}

/// Rate and first samples, or why it refuses.
fn told(bytes: &[u8], cask_file: &CaskFile) -> Result<(f64, Vec<f64>), String> {
    let uniform = read_bytes(bytes, cask_file)?.channels.remove(0).uniform;
    let samples = (0..uniform.samples.len().min(3)).map(|i| uniform.samples.get(i)).collect();
    Ok(((uniform.sample_rate_hz * 100.0).round() / 100.0, samples))
}

#[test]
fn a_stamp_that_is_a_number_is_read_in_any_unit_and_the_log_time_held_against_it() {
    let zero_ms = ZERO_NS / 1_000_000;
    let spelled = |i: i64| format!("2023-11-14 22:13:{:02}.{:03}", 20 + i / 1000, i % 1000);
    let forms: [(&str, &dyn Fn(i64) -> String); 10] = [
        ("s since 1970", &|i| format!("\"timestamp\":{}.{:03}", ZERO_NS / 1_000_000_000, i)),
        ("ms since 1970", &|i| format!("\"stamp\":{}", zero_ms + i)),
        ("us since 1970", &|i| format!("\"timestamp\":{}", (zero_ms + i) * 1000)),
        ("ns since 1970", &|i| format!("\"timestamp_ns\":{}", (zero_ms + i) * 1_000_000)),
        ("in a header", &|i| format!("\"header\":{{\"stamp\":{}}}", (zero_ms + i) * 1000)),
        ("s since the start", &|i| format!("\"time\":0.{i:03}")),
        ("us since the start, by the log time", &|i| format!("\"t\":{}", 500_000 + 1000 * i)),
        ("by its name", &|i| format!("\"time_us\":{}", 1000 * i)),
        ("words with a blank", &|i| format!("\"timestamp\":\"{}\"", spelled(i))),
        ("a number in quotes", &|i| format!("\"timestamp\":\"{}\"", (zero_ms + i) * 1000)),
    ];
    for (name, fields) in forms {
        let bytes = file(1, fields);
        let raw = read_bytes(&bytes, &cask_file(&["/x.a"])).expect(name);
        assert!((raw.channels[0].uniform.sample_rate_hz - 1000.0).abs() < 0.01, "{name}: {raw:?}");
        let drift: Vec<_> = raw.issues.iter().filter(|issue| issue.severity == Severity::Warning).collect();
        assert!(drift.len() == 1 && drift[0].message.contains("log times"), "{name}: {:?}", raw.issues);
        let listing = with_path(&bytes, |path| list(ReadRequest::silent(path, Limits::default()))).unwrap();
        let listed = listing.channels.iter().find(|channel| channel.source == "/x.a").unwrap();
        assert!(listed.sample_rate_hz.is_some_and(|hz| (hz - 1000.0).abs() < 0.01), "{name}: {listed:?}");
    }
    // What does not rise is no time, whatever its name.
    let (rate_hz, _) = told(&file(1, |i| format!("\"t\":{}", 20 + i % 2)), &cask_file(&["/x.a"])).unwrap();
    assert!((rate_hz - 970.87).abs() < 0.01, "{rate_hz}");
}

#[test]
fn a_cask_file_names_the_time_of_messages() {
    let bytes =
        file(1, |i| format!("\"timestamp\":{},\"sent\":{{\"at_ms\":{}}}", ZERO_NS / 1000 + 1000 * i, 2 * i));
    let read = |time: &str| {
        let mut cask = cask_file(&["/x.a"]);
        cask.time = Some(time.into());
        told(&bytes, &cask)
    };
    for (time, expected_hz) in
        [("timestamp", 1000.0), ("sent.at_ms", 500.0), ("/x.sent.at_ms", 500.0), ("log_time", 970.87)]
    {
        let (rate_hz, _) = read(time).expect(time);
        assert!((rate_hz - expected_hz).abs() < 0.02, "{time}: {rate_hz}");
    }
    assert!(read("clock").unwrap_err().contains("time = \"log_time\""));
}

#[test]
fn what_messages_say_of_their_samples_is_applied_or_refused() {
    let stamped = |i: i64, fields: &str| format!("\"timestamp\":{},{fields}", ZERO_NS / 1000 + 8000 * i);
    for (fields, expected) in [
        ("\"v\":[1,2,3]", Ok(vec![1.0, 2.0, 3.0])),
        ("\"v\":[1,2,3],\"scale\":0.5", Ok(vec![0.5, 1.0, 1.5])),
        ("\"v\":[1,2,3],\"scale\":2,\"offset\":-1", Ok(vec![1.0, 3.0, 5.0])),
        ("\"v\":[1,2,3],\"offset\":0,\"gain\":1", Ok(vec![1.0, 2.0, 3.0])),
        ("\"v\":[1,2,3],\"gain\":10", Err("gain = 10")),
        ("\"v\":[1,2,3],\"offset\":10", Err("offset = 10")),
        ("\"v\":[1,2,0,0],\"samples\":2,\"dt\":4000", Ok(vec![1.0, 2.0, 1.0])),
        ("\"v\":[1,2],\"sample_rate\":0.25,\"sample_rate_unit\":\"kHz\"", Ok(vec![1.0, 2.0, 1.0])),
        (
            "\"v\":[1,2,3,4],\"layout\":{\"dim\":[{\"size\":2},{\"size\":2}],\"data_offset\":0}",
            Err("2 signals by turns"),
        ),
    ] {
        let found = told(&file(1, |i| stamped(i, fields)), &cask_file(&["/x.v"]));
        match (found, expected) {
            (Ok((_, samples)), Ok(expected)) => assert_eq!(samples, expected, "{fields}"),
            (Err(refused), Err(part)) => assert!(refused.contains(part), "{fields}: {refused}"),
            (found, _) => panic!("{fields}: {found:?}"),
        }
    }
    let bytes = file(1, |_| "\"v\":[1,2],\"sample_rate\":8,\"sample_rate_unit\":\"kV\"".into());
    assert!(told(&bytes, &cask_file(&["/x.v"])).unwrap_err().contains("sample_rate = 8"));
}

#[test]
fn sensors_of_one_topic_stay_apart_and_are_picked_by_name() {
    let two = file(2, |i| format!("\"timestamp\":{}", ZERO_NS / 1000 + 1000 * i));
    let refused = told(&two, &cask_file(&["/x.a"])).unwrap_err();
    assert!(refused.contains("2 MCAP channels write") && refused.contains("channel = 1"), "{refused}");
    let sides = file(1, |i| {
        format!(
            "\"header\":{{\"stamp\":{},\"frame_id\":\"{}\"}}",
            ZERO_NS / 1000 + 500 * i,
            ["left", "right"][usize::from(i % 2 == 1)]
        )
    });
    let refused = told(&sides, &cask_file(&["/x.a"])).unwrap_err();
    assert!(refused.contains("where = { column = \"header.frame_id\", is = \"left\" }"), "{refused}");
    let mut cask = cask_file(&["/x.a"]);
    cask.channels[0].rows = Some(RowsOf { column: "header.frame_id".into(), is: "right".into() });
    assert_eq!(told(&sides, &cask).unwrap().1, [1.0, 3.0, 5.0]);
    cask.channels[0].rows = Some(RowsOf { column: "header.frame_id".into(), is: "top".into() });
    assert!(told(&sides, &cask).unwrap_err().contains("is = \"right\""));
    // A field of any name will do, and a number.
    let numbered = file(1, |i| format!("\"timestamp\":{},\"place\":{}", ZERO_NS / 1000 + 500 * i, i % 2));
    cask.channels[0].rows = Some(RowsOf { column: "place".into(), is: "1".into() });
    assert_eq!(told(&numbered, &cask).unwrap().1, [1.0, 3.0, 5.0]);
    let listing = with_path(&sides, |path| list(ReadRequest::silent(path, Limits::default()))).unwrap();
    let rows: Vec<_> = listing
        .channels
        .iter()
        .filter(|listed| listed.source == "/x.a")
        .map(|listed| listed.rows.clone())
        .collect();
    assert!(rows.len() == 2 && rows.iter().all(Option::is_some), "{rows:?}");
    let listing = with_path(&two, |path| list(ReadRequest::silent(path, Limits::default()))).unwrap();
    assert!(
        listing
            .channels
            .iter()
            .any(|listed| listed.source == "{ topic = \"/x\", field = \"a\", channel = 1 }"),
        "{listing:?}"
    );
}

#[test]
fn more_sensors_than_are_told_apart_give_none() {
    let sensors = |count: u64| {
        let bytes = closed(WriteOptions::new().chunk_size(Some(64)), |writer| {
            let id = channel(writer, "/x", "json", ("", "", b""));
            for i in 0..4 * count {
                let text = format!("{{\"a\":{i},\"sensor\":{}}}", i % count);
                message(writer, id, ZERO_NS + i64::try_from(i).unwrap() * 1_000_000, text.as_bytes());
            }
        });
        let mut cask = cask_file(&["/x.a"]);
        let samples_by = |cask: &CaskFile| told(&bytes, cask).map(|told| told.1);
        let asked = samples_by(&cask).unwrap_err();
        cask.channels[0].rows = Some(RowsOf { column: "sensor".into(), is: "3".into() });
        (asked, samples_by(&cask))
    };
    let (asked, picked) = sensors(64);
    assert!(asked.contains("where") && picked == Ok(vec![3.0, 67.0, 131.0]), "{asked}");
    let (asked, picked) = sensors(65);
    for refused in [asked, picked.unwrap_err()] {
        assert!(refused.contains("more than 64 sensors"), "{refused}");
    }
}

#[test]
fn a_file_without_chunks_shows_by_its_sums_that_a_digit_was_changed() {
    let sound = closed(WriteOptions::new().use_chunks(false), |writer| {
        let id = channel(writer, "/x", "json", ("", "", b""));
        for i in 0..20 {
            message(writer, id, ZERO_NS + i * 1_000_000, b"{\"a\":0.111}");
        }
    });
    let of_sums = |bytes: &[u8]| {
        let raw = read_bytes(bytes, &cask_file(&["/x.a"])).unwrap();
        let summed = raw.issues.iter().filter(|issue| issue.message.contains("check sum"));
        let told =
            summed.map(|issue| (issue.severity, issue.message.contains("summary"))).collect::<Vec<_>>();
        (raw.channels[0].uniform.samples.len(), told)
    };
    assert_eq!(of_sums(&sound), (20, vec![]));
    let at = sound.windows(5).position(|five| five == b"0.111").unwrap();
    let mut changed = sound.clone();
    changed[at] = b'9';
    assert_eq!(of_sums(&changed), (20, vec![(Severity::Error, false)]));
    // A record of the summary that begins to look like a message is none.
    let data_end = sound.windows(9).position(|nine| nine == [15, 4, 0, 0, 0, 0, 0, 0, 0]).unwrap();
    let mut changed = sound.clone();
    changed[data_end + 13] = 5;
    assert_eq!(of_sums(&changed), (20, vec![(Severity::Warning, true)]));
}
