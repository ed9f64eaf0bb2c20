//! Tests of reading: encodings, compressions, sources, and files that are cut or damaged anywhere.

use super::*;
use crate::data::{IssueCode, Samples, Severity, Unit};
use crate::ingest::mcap::written::{
    IMU_TEXT, ZERO_NS, block_descriptors, cask_file, channel, closed, fill_json, imu, json_block, json_file,
    message, protobuf_block,
};
use crate::ingest::{Limits, ReadRequest};
use mcap::{Compression, WriteOptions};
use re_cdr::LittleEndian;
use std::io::Cursor;

fn read_bytes(bytes: &[u8], cask_file: &CaskFile) -> Result<RawRecording, String> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording");
    std::fs::write(&path, bytes).unwrap();
    read(ReadRequest::silent(&path, Limits::default()), cask_file).map_err(|error| {
        format!(
            "{error} | {}",
            miette::Diagnostic::help(&error).map(|help| help.to_string()).unwrap_or_default()
        )
    })
}

fn values(samples: &Samples) -> Vec<f64> {
    (0..samples.len()).map(|index| samples.get(index)).collect()
}

fn count_up(count: u32) -> Vec<f64> {
    (0..count).map(f64::from).collect()
}

#[test]
fn every_compression_with_and_without_chunks_and_summary_reads_the_same() {
    let options = [
        WriteOptions::new().compression(None),
        WriteOptions::new().compression(None).use_chunks(false),
        WriteOptions::new().compression(Some(Compression::Zstd)),
        WriteOptions::new().compression(Some(Compression::Lz4)).chunk_size(Some(200)),
        WriteOptions::new()
            .compression(Some(Compression::Zstd))
            .chunk_size(Some(200))
            .emit_summary_records(false),
        WriteOptions::new().repeat_channels(false).repeat_schemas(false).calculate_chunk_crcs(false),
    ];
    for options in options {
        let raw = read_bytes(&json_file(options), &cask_file(&["/daq/a1.samples"])).unwrap();
        let channel = &raw.channels[0];
        assert_eq!(values(&channel.uniform.samples), count_up(100));
        assert!((channel.uniform.sample_rate_hz - 1000.0).abs() < 1e-9);
        assert_eq!((channel.unit.as_deref(), raw.zero_unix_ns), (Some("g"), Some(ZERO_NS)));
        assert_eq!(raw.issues, []);
    }
}

#[test]
fn protobuf_blocks_stay_single_precision() {
    let bytes = closed(WriteOptions::new(), |writer| {
        let schema = ("dropcheck.AccelerationBlock", "protobuf", &block_descriptors(true)[..]);
        let id = channel(writer, "/daq/a1", "protobuf", schema);
        for block in [0, 2, 1_u8, 1] {
            let samples: Vec<f32> = (0..10).map(|i| f32::from(block * 10 + i)).collect();
            let stamp_ns = ZERO_NS + i64::from(block) * 10_000_000;
            message(writer, id, ZERO_NS, &protobuf_block(true, stamp_ns, 1000.0, &samples));
        }
    });
    let raw = read_bytes(&bytes, &cask_file(&["/daq/a1.samples"])).unwrap();
    let uniform = &raw.channels[0].uniform;
    assert!(matches!(uniform.samples, Samples::F32(_)));
    assert_eq!(values(&uniform.samples), count_up(30));
    let codes: Vec<IssueCode> = uniform.issues.iter().map(|issue| issue.code).collect();
    assert!(
        codes.contains(&IssueCode::DuplicateBlocks) && codes.contains(&IssueCode::DisorderedBlocks),
        "{codes:?}"
    );
}

/// Blocks of 100 samples of whole milliseconds as JSON messages of these fields.
fn blocks(count: u32, fields: impl Fn(u32) -> String) -> Vec<u8> {
    closed(WriteOptions::new(), |writer| {
        let id = channel(writer, "/a", "json", ("", "", b""));
        for block in 0..count {
            let time_ns = ZERO_NS + i64::from(block) * 10_000_000;
            let samples = vec![1.0; 100];
            let (sec, nsec) = (time_ns / 1_000_000_000, time_ns % 1_000_000_000);
            let text = format!(
                r#"{{"timestamp":{{"sec":{sec},"nsec":{nsec}}},{},"samples":{samples:?}}}"#,
                fields(block)
            );
            message(writer, id, time_ns, text.as_bytes());
        }
    })
}

#[test]
fn two_rates_of_a_message_are_weighed_or_refused() {
    let read = |count, fields: &'static str, declared_hz| {
        let mut cask = cask_file(&["/a.samples"]);
        cask.channels[0].sample_rate_hz = declared_hz;
        read_bytes(&blocks(count, |_| fields.to_owned()), &cask)
    };
    for fields in [r#""sample_rate_hz":9700,"fs":10000"#, r#""fs":9700,"sampling_rate":10000"#] {
        let refused = read(1, fields, None).unwrap_err();
        assert!(refused.contains("9700") && refused.contains("or sample_rate_hz = 10000"), "{refused}");
        assert!(read(1, fields, Some(1e4)).is_ok(), "{fields}");
    }
    let sound = read(40, r#""sample_rate_hz":10000,"fs":10000.5"#, None).unwrap();
    assert!(sound.channels[0].uniform.issues.is_empty());
}

#[test]
fn a_unit_that_changes_between_messages_is_refused_unless_the_cask_file_states_one() {
    let unit = |block| format!(r#""fs":10000,"unit":"{}""#, if block < 20 { "g" } else { "m/s^2" });
    let mut cask = cask_file(&["/a.samples"]);
    let refused = read_bytes(&blocks(40, unit), &cask).map(|_| ()).unwrap_err();
    assert!(refused.contains("from \"g\" to \"m/s^2\"") && refused.contains("write `unit`"), "{refused}");
    cask.channels[0].unit = Some(Unit::G);
    let raw = read_bytes(&blocks(40, unit), &cask).unwrap();
    let [issue] = &raw.issues[..] else { panic!("{:?}", raw.issues) };
    assert!(issue.code == IssueCode::Scale && issue.severity == Severity::Warning, "{issue:?}");
    let same = |block| format!(r#""fs":10000,"unit":"{}""#, if block < 20 { "m/s^2" } else { "m/s²" });
    assert_eq!(read_bytes(&blocks(40, same), &cask_file(&["/a.samples"])).unwrap().issues, []);
}

/// Blocks of so many samples as at 100 kHz, their stamps cut to whole ms of so many.
fn stamped(count: u32, samples: u32, cut_ms: i64, fields: &str) -> Vec<u8> {
    closed(WriteOptions::new(), |writer| {
        let id = channel(writer, "/a", "json", ("", "", b""));
        for block in 0..count {
            let time_ns = i64::from(block * samples) * 10_000 / (1_000_000 * cut_ms) * (1_000_000 * cut_ms);
            let (sec, nsec) = ((ZERO_NS + time_ns) / 1_000_000_000, (ZERO_NS + time_ns) % 1_000_000_000);
            let values: Vec<u32> = (block * samples..(block + 1) * samples).collect();
            let text = format!(r#"{{"stamp":{{"sec":{sec},"nsec":{nsec}}}{fields},"samples":{values:?}}}"#);
            message(writer, id, ZERO_NS, text.as_bytes());
        }
    })
}

#[test]
fn stamps_that_tell_the_rate_badly_ask_for_it() {
    let read = |bytes: &[u8], declared_hz| {
        let mut cask = cask_file(&["/a.samples"]);
        cask.channels[0].sample_rate_hz = declared_hz;
        read_bytes(bytes, &cask)
    };
    // Blocks of 10.15 ms that are stamped each 10 ms, and exact ones of 10 ms that look the same.
    for samples in [1015, 1000] {
        let bytes = stamped(46, samples, 10, "");
        let refused = read(&bytes, None).unwrap_err();
        assert!(
            refused.contains("no rate is stated") && refused.contains("write `sample_rate_hz`"),
            "{refused}"
        );
        let raw = read(&bytes, Some(1e5)).unwrap();
        assert!((raw.channels[0].uniform.sample_rate_hz / 1e5 - 1.0).abs() < 1e-9, "{samples}");
        assert!(raw.channels[0].uniform.gaps.is_empty());
    }
    let fine = read(&stamped(700, 512, 1, ""), None).unwrap();
    // Cut to 1 ms over 3.6 s.
    assert!((fine.channels[0].uniform.sample_rate_hz / 1e5 - 1.0).abs() < 1e-3);
    assert!(read(&stamped(3, 512, 1, ""), None).unwrap_err().contains("too few"));
    assert!(read(&stamped(1, 512, 1, ""), None).unwrap_err().contains("one block"));
}

#[test]
fn blocks_that_share_stamps_are_refused() {
    let bytes = stamped(90, 512, 10, r#","fs":100000"#);
    for declared_hz in [None, Some(1e5)] {
        let mut cask = cask_file(&["/a.samples"]);
        cask.channels[0].sample_rate_hz = declared_hz;
        let refused = read_bytes(&bytes, &cask).map(|_| ()).unwrap_err();
        assert!(refused.contains("carry the same stamp") && refused.contains("stamp finer"), "{refused}");
    }
}

#[test]
fn a_listing_says_what_reading_refuses() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording");
    std::fs::write(&path, stamped(90, 512, 10, "")).unwrap();
    let listing = crate::ingest::mcap::list(ReadRequest::silent(&path, Limits::default())).unwrap();
    assert_eq!((listing.channels[0].samples, listing.channels[0].sample_rate_hz), (Some(46_080), None));
    assert!(listing.issues[0].message.starts_with("/a.samples: "), "{:?}", listing.issues);
    assert!(listing.issues[0].message.contains("carry the same stamp"), "{:?}", listing.issues);
}

fn imu_file(stamps: impl Fn(i64) -> i64) -> Vec<u8> {
    closed(WriteOptions::new(), |writer| {
        let id =
            channel(writer, "/imu.first", "cdr", ("sensor_msgs/msg/Imu", "ros2msg", IMU_TEXT.as_bytes()));
        for i in 0..50_i32 {
            let time_ns = ZERO_NS + i64::from(i) * 1_000_000;
            message(writer, id, time_ns, &imu::<LittleEndian>(stamps(time_ns), f64::from(i)));
        }
    })
}

#[test]
fn two_axes_of_one_imu_are_si_by_rep_103_and_topics_may_hold_dots() {
    let sources = [
        "/imu.first.linear_acceleration.z",
        "/imu.first.linear_acceleration.x",
        "imu.first.linear_acceleration.z",
    ];
    let raw = read_bytes(&imu_file(|time_ns| time_ns), &cask_file(&sources)).unwrap();
    assert_eq!(values(&raw.channels[0].uniform.samples), count_up(50));
    assert_eq!(values(&raw.channels[1].uniform.samples), vec![7.0; 50]);
    assert_eq!(raw.channels[2].uniform, raw.channels[0].uniform);
    assert_eq!(raw.channels[0].unit.as_deref(), Some("m/s^2"));
    assert!((raw.channels[0].uniform.sample_rate_hz - 1000.0).abs() < 1e-6);
    assert_eq!(raw.issues, []);
}

#[test]
fn a_zero_stamp_falls_back_to_the_log_time_and_says_so() {
    let raw = read_bytes(&imu_file(|_| 0), &cask_file(&["/imu.first.linear_acceleration.z"])).unwrap();
    assert_eq!(raw.zero_unix_ns, Some(ZERO_NS));
    assert_eq!((raw.issues[0].code, raw.issues[0].severity), (IssueCode::LogTimeUsed, Severity::Note));
}

#[test]
fn a_declared_rate_overrides_and_a_zero_rate_is_an_error() {
    let bytes = closed(WriteOptions::new(), |writer| {
        let id = channel(writer, "/daq/a1", "json", ("", "", b""));
        message(writer, id, ZERO_NS, &json_block(ZERO_NS, 0.0, &[1.0, 2.0, 3.0]));
    });
    let mut cask_file = cask_file(&["/daq/a1.samples"]);
    let error = read_bytes(&bytes, &cask_file).unwrap_err();
    assert!(
        error.contains("sample_rate_hz = 0, which is no rate") && error.contains("sample_rate_hz"),
        "{error}"
    );
    cask_file.channels[0].sample_rate_hz = Some(250.0);
    cask_file.channels[0].unit = Some(Unit::G);
    let raw = read_bytes(&bytes, &cask_file).unwrap();
    assert!((raw.channels[0].uniform.sample_rate_hz - 250.0).abs() < 1e-9);
}

#[test]
fn what_is_not_there_is_named_with_what_is() {
    let bytes = json_file(WriteOptions::new());
    for (source, parts) in [
        ("/daq/b1.samples", vec!["no topic", "did you mean /daq/a1", "dropcheck inspect"]),
        ("/daq/a1.sample", vec!["no numeric field sample", "did you mean samples"]),
        ("/daq/a1", vec!["names a topic but no field", "/daq/a1.FIELD"]),
        ("/daq/a1.unit", vec!["no numeric field unit"]),
    ] {
        let error = read_bytes(&bytes, &cask_file(&[source])).unwrap_err();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
    let ros1 = closed(WriteOptions::new(), |writer| {
        let id = channel(writer, "/imu", "ros1", ("sensor_msgs/Imu", "ros1msg", b""));
        message(writer, id, ZERO_NS, b"\0");
    });
    assert!(read_bytes(&ros1, &cask_file(&["/imu.a"])).unwrap_err().contains("ros1"));
    let empty = closed(WriteOptions::new(), |_| ());
    assert!(read_bytes(&empty, &cask_file(&["/imu.a"])).unwrap_err().contains("no topics"));
}

#[test]
fn messages_that_do_not_decode_are_counted_and_left_out() {
    let bytes = closed(WriteOptions::new(), |writer| {
        fill_json(writer);
        let id = channel(writer, "/daq/a1", "json", ("dropcheck.AccelerationBlock", "jsonschema", b"{}"));
        message(writer, id, ZERO_NS, b"{\"samples\":[1,");
    });
    let raw = read_bytes(&bytes, &cask_file(&["/daq/a1.samples"])).unwrap();
    assert_eq!(values(&raw.channels[0].uniform.samples), count_up(100));
    assert_eq!(raw.issues[0].code, IssueCode::Damaged);
    assert!(raw.issues[0].message.contains("1 of 11"), "{}", raw.issues[0].message);
}

/// Cut at any byte, a file gives what it holds and says that it is cut, or an error: it never panics and
/// never passes in silence.
#[test]
fn a_file_cut_at_any_byte_says_so_and_keeps_whole_messages() {
    for options in [
        WriteOptions::new().compression(None).chunk_size(Some(400)),
        WriteOptions::new().compression(None).use_chunks(false),
        WriteOptions::new().compression(Some(Compression::Lz4)),
        WriteOptions::new().compression(Some(Compression::Zstd)).chunk_size(Some(400)),
    ] {
        let bytes = json_file(options);
        let mut longest = 0;
        for end in 8..bytes.len() {
            let Ok(raw) = read_bytes(&bytes[..end], &cask_file(&["/daq/a1.samples"])) else { continue };
            let got = values(&raw.channels[0].uniform.samples);
            assert_eq!(got, count_up(u32::try_from(got.len()).unwrap()), "cut at {end}");
            assert_eq!(raw.issues[0].code, IssueCode::Truncated, "cut at {end}");
            assert!(got.len() >= longest, "cut at {end}: {} after {longest}", got.len());
            longest = got.len();
        }
        assert_eq!(longest, 100);
    }
}

#[test]
fn a_writer_that_was_killed_leaves_its_whole_messages() {
    let options = WriteOptions::new().compression(None);
    let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
    fill_json(&mut writer);
    // The chunk is never closed: its length stays at its largest value.
    let bytes = writer.into_inner().into_inner();
    let raw = read_bytes(&bytes, &cask_file(&["/daq/a1.samples"])).unwrap();
    assert_eq!(values(&raw.channels[0].uniform.samples), count_up(100));
    assert_eq!(raw.issues[0].code, IssueCode::Truncated);
    assert!(raw.issues[0].message.contains("stopped"), "{}", raw.issues[0].message);
}

#[test]
fn a_chunk_that_fails_its_check_sum_is_left_out_and_said() {
    let bytes = json_file(WriteOptions::new().compression(None).chunk_size(Some(400)));
    let at = bytes.windows(4).rposition(|window| window == b"57.0").unwrap();
    let mut damaged = bytes.clone();
    damaged[at] = b'9';
    let raw = read_bytes(&damaged, &cask_file(&["/daq/a1.samples"])).unwrap();
    let got = values(&raw.channels[0].uniform.samples);
    assert!(got[57].is_nan(), "{got:?}");
    let is_right = |(index, value): (u32, &f64)| value.is_nan() || (value - f64::from(index)).abs() < 1e-9;
    assert!((0..).zip(&got).all(is_right), "{got:?}");
    assert_eq!(raw.issues[0].code, IssueCode::Damaged);
    assert!(raw.issues[0].message.contains("check sum"), "{}", raw.issues[0].message);
}

#[test]
fn garbage_in_the_middle_is_skipped_to_the_next_chunk_of_the_index() {
    let bytes = json_file(WriteOptions::new().compression(None).chunk_size(Some(400)));
    let chunk = bytes.windows(4).position(|window| window == b"30.0").unwrap();
    let mut damaged = bytes.clone();
    // The chunk's own header stands less than 200 bytes before its third block.
    let header = (0..chunk).rev().find(|&at| bytes[at] == 6 && bytes[at + 3..at + 9] == [0; 6]).unwrap();
    damaged[header..header + 9].fill(0);
    let raw = read_bytes(&damaged, &cask_file(&["/daq/a1.samples"])).unwrap();
    assert_eq!(raw.issues[0].code, IssueCode::Damaged);
    let got = values(&raw.channels[0].uniform.samples);
    assert_eq!((got[0], got[got.len() - 1]), (0.0, 99.0));
    assert!(got.iter().any(|x| x.is_nan()));
}

/// Any single byte may be wrong: no panic, no endless loop, no wrong number without an issue.
#[test]
fn a_wrong_byte_anywhere_is_harmless() {
    for compression in [None, Some(Compression::Lz4), Some(Compression::Zstd)] {
        let bytes = json_file(WriteOptions::new().compression(compression).chunk_size(Some(400)));
        for position in 8..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[position] ^= 0x55;
            let Ok(raw) = read_bytes(&damaged, &cask_file(&["/daq/a1.samples"])) else { continue };
            let uniform = &raw.channels[0].uniform;
            let is_said = !raw.issues.is_empty() || !uniform.issues.is_empty();
            assert!(is_said || values(&uniform.samples) == count_up(100), "{compression:?}, byte {position}");
        }
    }
}
