//! Tests of listing: counts, fields, rates, and files that hold nothing or are cut.

use super::*;
use crate::data::{IssueCode, Severity};
use crate::ingest::mcap::written::{
    IMU_TEXT, ZERO_NS, block_descriptors, channel, closed, imu, json_file, message, protobuf_block,
};
use crate::ingest::{Limits, ReadRequest};
use mcap::{Compression, WriteOptions};
use re_cdr::LittleEndian;

fn listing(bytes: &[u8]) -> Listing {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording");
    std::fs::write(&path, bytes).unwrap();
    list(ReadRequest::silent(&path, Limits::default())).unwrap()
}

#[test]
fn json_blocks_are_listed_with_rate_unit_and_range() {
    let listing = listing(&json_file(WriteOptions::new().compression(Some(Compression::Lz4)).profile("p")));
    assert_eq!((listing.counts["messages"], listing.counts["schemas"], listing.counts["chunks"]), (10, 1, 1));
    assert_eq!((listing.facts["compression"].as_str(), listing.facts["profile"].as_str()), ("lz4", "p"));
    assert_eq!(listing.facts["start"], "2023-11-14T22:13:20Z");
    assert_eq!(listing.channels.len(), 1);
    let samples = &listing.channels[0];
    assert_eq!((samples.source.as_str(), samples.kind.as_str()), ("/daq/a1.samples", "array"));
    assert_eq!((samples.samples, samples.messages, samples.gaps), (Some(100), Some(10), Some(0)));
    assert_eq!((samples.sample_rate_hz, samples.unit.as_deref()), (Some(1000.0), Some("g")));
    assert_eq!(samples.range, Some((0.0, 99.0)));
    assert!((samples.duration_s.unwrap() - 0.099).abs() < 1e-9);
    assert_eq!(listing.issues, []);
}

#[test]
fn every_signal_of_an_imu_and_of_a_protobuf_block_is_listed() {
    let bytes = closed(WriteOptions::new(), |writer| {
        let id = channel(writer, "/imu", "cdr", ("sensor_msgs/msg/Imu", "ros2msg", IMU_TEXT.as_bytes()));
        for i in 0..20_i32 {
            let time_ns = ZERO_NS + i64::from(i) * 1_000_000;
            message(writer, id, time_ns, &imu::<LittleEndian>(time_ns, f64::from(i)));
        }
        let schema = ("dropcheck.AccelerationBlock", "protobuf", &block_descriptors(true)[..]);
        let id = channel(writer, "/daq", "protobuf", schema);
        message(writer, id, ZERO_NS, &protobuf_block(true, ZERO_NS + 1_000_000, 1000.0, &[1.0, 2.0]));
        let id = channel(writer, "/log", "ros1", ("std_msgs/String", "ros1msg", b"string data"));
        message(writer, id, ZERO_NS, b"\0\0\0\0");
    });
    let listing = listing(&bytes);
    let listed = |source: &str| listing.channels.iter().find(|channel| channel.source == source).unwrap();
    let z = listed("/imu.linear_acceleration.z");
    assert_eq!((z.kind.as_str(), z.samples, z.unit.as_deref()), ("number", Some(20), Some("m/s^2")));
    assert_eq!((z.range, z.start_s), (Some((0.0, 19.0)), Some(0.0)));
    assert!((z.sample_rate_hz.unwrap() - 1000.0).abs() < 1e-6);
    assert!(listing.channels.iter().all(|channel| !channel.source.ends_with("covariance")));
    let samples = listed("/daq.samples");
    assert_eq!((samples.samples, samples.start_s), (Some(2), Some(0.001)));
    assert!(listed("/log").unreadable.as_deref().is_some_and(|reason| reason.contains("ros1")));
}

#[test]
fn a_mark_of_an_overrange_is_no_value_of_the_range() {
    let bytes = closed(WriteOptions::new(), |writer| {
        let id = channel(writer, "/x", "json", ("", "", b""));
        for (log_ns, value) in (ZERO_NS..).step_by(1_000_000).zip(["1", "9.9e37", "-2", "3"]) {
            message(writer, id, log_ns, format!("{{\"a\":{value},\"b\":[{value}]}}").as_bytes());
        }
    });
    for listed in listing(&bytes).channels {
        assert_eq!(listed.range, Some((-2.0, 3.0)), "{listed:?}");
    }
}

#[test]
fn a_clock_that_starts_at_zero_is_kept_and_one_lone_zero_falls_back() {
    let listed = |stamps_ns: &[i64]| {
        let bytes = closed(WriteOptions::new(), |writer| {
            let id = channel(writer, "/imu", "cdr", ("sensor_msgs/msg/Imu", "ros2msg", IMU_TEXT.as_bytes()));
            for (log_ns, stamp_ns) in (ZERO_NS..).step_by(1_000_000).zip(stamps_ns) {
                message(writer, id, log_ns, &imu::<LittleEndian>(*stamp_ns, 1.0));
            }
        });
        let listing = listing(&bytes);
        (listing.channels[0].samples, listing.channels[0].duration_s, listing.facts.contains_key("start"))
    };
    assert_eq!(listed(&[0, 2_000_000, 4_000_000]), (Some(3), Some(0.004), false));
    assert_eq!(listed(&[0, 0, 0]), (Some(3), Some(0.002), true));
    assert_eq!(listed(&[0]), (Some(1), None, true));
    assert_eq!(listed(&[ZERO_NS, ZERO_NS + 5_000_000]), (Some(2), Some(0.005), true));
}

#[test]
fn what_many_topics_hold_together_is_listed_to_a_bound_that_is_said() {
    let fields = |count: usize| (0..count).map(|i| format!("float64 f{i}\n")).collect::<Vec<_>>().concat();
    let bytes = closed(WriteOptions::new(), |writer| {
        for i in 0..30 {
            let text = fields(if i == 0 { 2005 } else { 600 });
            let schema = (&*format!("p/S{i}"), "ros2msg", text.as_bytes());
            channel(writer, &format!("/t{i}"), "cdr", schema);
        }
    });
    let listing = listing(&bytes);
    assert_eq!(listing.channels.len(), 10_000);
    let [note] = &listing.issues[..] else { panic!("{:?}", listing.issues) };
    assert_eq!((note.code, note.severity), (IssueCode::Unlisted, Severity::Note));
    // 2000 + 13 · 600 = 9800: of the fifteenth topic 200 fields are listed, of those behind it none.
    let left_out = "15 more topics and 405 more fields";
    assert!(note.message.contains(left_out), "{}", note.message);
}

#[test]
fn a_long_name_counts_for_as_many_as_its_kilobytes() {
    let text = (0..100).map(|i| format!("float64 f{i}\n")).collect::<Vec<_>>().concat();
    let bytes = closed(WriteOptions::new(), |writer| {
        channel(writer, &"t".repeat(1 << 20), "cdr", ("p/S", "ros2msg", text.as_bytes()));
    });
    // 1024 and one for the topic, and each field repeats its name.
    assert_eq!(listing(&bytes).channels.len(), 9);
}

#[test]
fn types_that_double_are_taken_apart_to_a_bound() {
    let levels = (1..12)
        .map(|level| format!("===\nMSG: p/A{level}\nA{} a\nA{0} b\n", level + 1))
        .collect::<Vec<_>>()
        .concat();
    let text = format!("A1 a\nA1 b\n{levels}===\nMSG: p/A12\nstring s\n");
    let bytes = closed(WriteOptions::new(), |writer| {
        for i in 0..100 {
            channel(writer, &format!("/t{i}"), "cdr", (&*format!("p/S{i}"), "ros2msg", text.as_bytes()));
        }
    });
    let listing = listing(&bytes);
    let refused = listing.channels.iter().filter(|channel| channel.unreadable.is_some()).count();
    assert!(listing.channels.len() == 100 && (80..100).contains(&refused), "{refused}");
    let last = listing.channels[99].unreadable.as_deref().unwrap_or_default();
    assert!(last.contains("--max-memory"), "{last}");
}

#[test]
fn an_empty_file_is_listed_as_empty_and_a_cut_one_with_an_issue() {
    let empty = listing(&closed(WriteOptions::new(), |_| ()));
    assert_eq!((empty.channels.len(), empty.counts["messages"], empty.issues.len()), (0, 0, 0));
    let bytes = json_file(WriteOptions::new().chunk_size(Some(300)));
    for end in 8..bytes.len() {
        let listing = listing(&bytes[..end]);
        assert_eq!(listing.issues[0].code, IssueCode::Truncated, "cut at {end}");
    }
}
