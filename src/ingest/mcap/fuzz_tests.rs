//! Mutated MCAP files, messages and schemas through each decoder.

use super::cdr::{self, Cdr};
use super::descriptors;
use super::json::{self, Json};
use super::list::ListWalk;
use super::plan::{Decode, Leaf, Plan, Slots};
use super::protobuf::{self, Protobuf};
use super::read::Reading;
use super::scan::scan_in;
use super::written::{
    IMU_TEXT, ZERO_NS, block_descriptors, cask_file, channel, closed, fill_json, imu, json_block, message,
    protobuf_block,
};
use super::{path::FieldPath, ros_type};
use crate::ingest::{Limits, fuzz};
use mcap::{Compression, WriteOptions};
use re_cdr::{BigEndian, LittleEndian};
use std::io::Cursor;
use std::path::Path;

const BLOCK: &str = "dropcheck.AccelerationBlock";

/// A plan for everything in `leaves`.
fn plan_of(leaves: &[Leaf]) -> Plan {
    Plan::new(&leaves.iter().filter_map(|leaf| FieldPath::parse(&leaf.path)).collect::<Vec<_>>())
}

fn decoded(decoder: &dyn Decode, plan: &Plan, data: &[u8]) -> String {
    let mut slots = Slots::default();
    slots.clear(plan.wants.len());
    match decoder.decode(data, &mut slots) {
        Ok(()) => format!("{:?}", slots.values),
        Err(problem) => problem,
    }
}

/// Small files of every encoding and compression.
fn files() -> Vec<Vec<u8>> {
    let mut files = Vec::new();
    for compression in [None, Some(Compression::Lz4), Some(Compression::Zstd)] {
        for is_chunked in [false, true] {
            let options =
                WriteOptions::new().compression(compression).use_chunks(is_chunked).chunk_size(Some(300));
            files.push(closed(options, |writer| {
                fill_json(writer);
                let block = channel(writer, "/pb", "protobuf", (BLOCK, "protobuf", &block_descriptors(true)));
                let imus = ("sensor_msgs/msg/Imu", "ros2msg", IMU_TEXT.as_bytes());
                let imu_id = channel(writer, "/imu", "cdr", imus);
                for step in 0..3 {
                    let stamp_ns = ZERO_NS + step * 2_000_000;
                    message(writer, block, stamp_ns, &protobuf_block(true, stamp_ns, 1000.0, &[1.0, 2.0]));
                    message(writer, imu_id, stamp_ns, &imu::<LittleEndian>(stamp_ns, 1.0));
                }
            }));
        }
    }
    files
}

#[test]
fn mcap_records() {
    let cask = cask_file(&["/daq/a1.samples", "/pb.samples", "/imu.linear_acceleration.z"]);
    let limits = Limits::of_memory(0);
    fuzz::run("mcap", &files(), &[b"\x05", b"\x06\0\0\0\0\0\0\0\0", b"zstd", b"lz4"], |bytes| {
        let length = bytes.len() as u64;
        let mut listing = ListWalk::new(limits, length);
        let listed = scan_in(Cursor::new(bytes), length, limits, &mut listing, &|_| ());
        let mut reading = Reading::new(&cask.channels, limits, length);
        match scan_in(Cursor::new(bytes), length, limits, &mut reading, &|_| ()) {
            Ok(scanned) => {
                let issues: Vec<String> = scanned.issues().into_iter().map(|issue| issue.message).collect();
                format!("{issues:?} {:?}", reading.finish(Path::new("r"), &scanned).map(|raw| raw.issues))
            }
            Err(error) => format!("{error} {}", listed.is_ok()),
        }
    });
}

#[test]
fn json_messages() {
    let seeds = [
        json_block(ZERO_NS, 1000.0, &[1.0, -2.5, 3e9]),
        br#"{"header":{"stamp":{"sec":1,"nanosec":2}},"a":[1,null,"NaN",{"b":[[1]]}],"x":"2026-01-01T00:00:00Z"}"#.to_vec(),
        br#"{"a":NaN,"b":-Infinity,"c":{"d":{"e":{"f":1e400}}},"units":"g"}"#.to_vec(),
    ];
    let found: Vec<Leaf> = seeds.iter().flat_map(|seed| json::leaves(seed)).collect();
    let plan = plan_of(&found);
    let decoder = Json::new(&plan);
    let words: [&[u8]; 10] =
        [b"{", b"[", b"}", b"]", b"null", b"NaN", b"\"\\u", b"1e999", b"\"samples\":", b"-"];
    fuzz::run("json", &seeds, &words, |bytes| {
        format!("{:?} {}", json::leaves(bytes), decoded(&decoder, &plan, bytes))
    });
}

#[test]
fn protobuf_messages() {
    for is_packed in [false, true] {
        let kind = descriptors::message_type(BLOCK, &block_descriptors(is_packed)).unwrap();
        let plan = plan_of(&protobuf::leaves(&kind));
        let decoder = Protobuf::new(&plan, &kind);
        let seeds = [true, false].map(|packed| protobuf_block(packed, ZERO_NS, 1000.0, &[1.0, -2.0, 3.5]));
        fuzz::run("protobuf", &seeds, &[b"\x0a", b"\xff\xff\xff\xff\x0f"], |bytes| {
            decoded(&decoder, &plan, bytes)
        });
    }
}

#[test]
fn cdr_messages() {
    let text = "std_msgs/Header header\nstring[] names\nwstring wide\nfloat64[] list\nint16[3] three\n\
                Inner[] inners\nbool flag\n===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\n\
                string frame_id\n===\nMSG: my/Inner\nfloat32[] values\nuint64 count\n";
    let imus = ros_type::parse("sensor_msgs/msg/Imu", IMU_TEXT, &mut 20_000).unwrap();
    let mixed = ros_type::parse("my/msg/Mixed", text, &mut 20_000).unwrap();
    for (name, fields) in [("cdr", imus), ("cdr-mixed", mixed)] {
        let plan = plan_of(&cdr::leaves(&fields));
        let decoder = Cdr::new(&plan, &fields.into());
        let seeds = [imu::<LittleEndian>(ZERO_NS, 1.5), imu::<BigEndian>(ZERO_NS, -2.5), vec![0, 1, 0, 0]];
        fuzz::run(name, &seeds, &[b"\0\0\0\x01", b"\x03\0\0\0"], |bytes| decoded(&decoder, &plan, bytes));
    }
}

#[test]
fn ros2msg_schemas() {
    let recorded = imu::<LittleEndian>(ZERO_NS, 1.5);
    let words: [&[u8]; 12] = [
        b"float64",
        b"[",
        b"]",
        b"[<=4]",
        b"[4294967295]",
        b"===\nMSG: my/A\n",
        b"my/A a\n",
        b"string<=10 s\n",
        b"int32 X=5\n",
        b"wstring",
        b" \"x\"\n",
        b"A[] b\n",
    ];
    fuzz::run("ros2msg", &[IMU_TEXT.into(), b"A a\n===\nMSG: my/A\nint8 x\n".to_vec()], &words, |bytes| {
        match ros_type::parse("my/msg/Top", &String::from_utf8_lossy(bytes), &mut 20_000) {
            Err(problem) => problem,
            Ok(fields) => {
                let leaves = cdr::leaves(&fields);
                let plan = plan_of(&leaves);
                format!("{} {}", leaves.len(), decoded(&Cdr::new(&plan, &fields.into()), &plan, &recorded))
            }
        }
    });
}

#[test]
fn protobuf_schemas() {
    let recorded = protobuf_block(true, ZERO_NS, 1000.0, &[1.0, -2.0]);
    let seeds = [block_descriptors(true), block_descriptors(false)];
    let words: [&[u8]; 5] = [
        b".dropcheck.AccelerationBlock",
        b"proto3",
        b"\x18\x01",
        b"\x20\x03",
        b"google/protobuf/timestamp.proto",
    ];
    fuzz::run("descriptors", &seeds, &words, |bytes| match descriptors::message_type(BLOCK, bytes) {
        Err(problem) => problem,
        Ok(kind) => {
            let leaves = protobuf::leaves(&kind);
            let plan = plan_of(&leaves);
            format!("{} {}", leaves.len(), decoded(&Protobuf::new(&plan, &kind), &plan, &recorded))
        }
    });
}
