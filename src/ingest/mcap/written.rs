//! Test recordings: small MCAP files made in memory, of every encoding and compression.

use crate::data::{Cask, CaskFile, ChannelSpec, Contact, Drop, End};
use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};
use prost_reflect::prost::Message as _;
use prost_reflect::prost_types::field_descriptor_proto::{Label, Type};
use prost_reflect::prost_types::{
    DescriptorProto, FieldDescriptorProto, FieldOptions, FileDescriptorProto, FileDescriptorSet,
};
use prost_reflect::{DescriptorPool, DynamicMessage, Value};
use re_cdr::CdrWriter;
use re_cdr::numeric::CdrEndian;
use std::collections::BTreeMap;
use std::io::Cursor;

pub(super) type MemoryWriter = Writer<Cursor<Vec<u8>>>;

/// 14 November 2023, 22:13:20 UTC, a time at which f64 seconds resolve only 0.24 µs.
pub(super) const ZERO_NS: i64 = 1_700_000_000_000_000_000;

/// A closed file.
pub(super) fn closed(options: WriteOptions, fill: impl FnOnce(&mut MemoryWriter)) -> Vec<u8> {
    let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
    fill(&mut writer);
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// A channel with its schema.
pub(super) fn channel(
    writer: &mut MemoryWriter,
    topic: &str,
    encoding: &str,
    schema: (&str, &str, &[u8]),
) -> u16 {
    let id = if schema.0.is_empty() { 0 } else { writer.add_schema(schema.0, schema.1, schema.2).unwrap() };
    writer.add_channel(id, topic, encoding, &BTreeMap::new()).unwrap()
}

/// A message.
pub(super) fn message(writer: &mut MemoryWriter, channel_id: u16, log_time_ns: i64, data: &[u8]) {
    let time = u64::try_from(log_time_ns).unwrap();
    let header = MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
    writer.write_to_known_channel(&header, data).unwrap();
}

/// A JSON block of the contract.
pub(super) fn json_block(stamp_ns: i64, rate_hz: f64, samples: &[f64]) -> Vec<u8> {
    let (sec, nsec) = (stamp_ns / 1_000_000_000, stamp_ns % 1_000_000_000);
    format!(
        r#"{{"timestamp":{{"sec":{sec},"nsec":{nsec}}},"sample_rate_hz":{rate_hz},{}:{samples:?}}}"#,
        r#""unit":"g","samples""#
    )
    .into_bytes()
}

/// Ten JSON blocks of 10 samples 0, 1, 2 … at 1 kHz on `/daq/a1`.
pub(super) fn json_file(options: WriteOptions) -> Vec<u8> {
    closed(options, fill_json)
}

/// The same, into an open file.
pub(super) fn fill_json(writer: &mut MemoryWriter) {
    let id = channel(writer, "/daq/a1", "json", ("dropcheck.AccelerationBlock", "jsonschema", b"{}"));
    for block in 0..10_i32 {
        let samples: Vec<f64> = (0..10).map(|i| f64::from(block * 10 + i)).collect();
        let stamp_ns = ZERO_NS + i64::from(block) * 10_000_000;
        message(writer, id, stamp_ns + 5, &json_block(stamp_ns, 1000.0, &samples));
    }
}

/// The descriptor set of the contract's block, its samples packed or not, with a nested message and 64-bit
/// counts.
pub(super) fn block_descriptors(is_packed: bool) -> Vec<u8> {
    let field = |name: &str, number, kind: Type, type_name: Option<&str>, is_list| FieldDescriptorProto {
        name: Some(name.into()),
        number: Some(number),
        r#type: Some(kind.into()),
        type_name: type_name.map(String::from),
        label: Some(if is_list { Label::Repeated } else { Label::Optional }.into()),
        options: is_list.then(|| FieldOptions { packed: Some(is_packed), ..FieldOptions::default() }),
        ..FieldDescriptorProto::default()
    };
    let timestamp = FileDescriptorProto {
        name: Some("google/protobuf/timestamp.proto".into()),
        package: Some("google.protobuf".into()),
        syntax: Some("proto3".into()),
        message_type: vec![DescriptorProto {
            name: Some("Timestamp".into()),
            field: vec![
                field("seconds", 1, Type::Int64, None, false),
                field("nanos", 2, Type::Int32, None, false),
            ],
            ..DescriptorProto::default()
        }],
        ..FileDescriptorProto::default()
    };
    let block = DescriptorProto {
        name: Some("AccelerationBlock".into()),
        field: vec![
            field("timestamp", 1, Type::Message, Some(".google.protobuf.Timestamp"), false),
            field("sample_rate_hz", 2, Type::Double, None, false),
            field("unit", 3, Type::String, None, false),
            field("samples", 4, Type::Float, None, true),
            field("counts", 5, Type::Sint64, None, true),
            field("nested", 6, Type::Message, Some(".dropcheck.AccelerationBlock"), false),
            field("level", 7, Type::Double, None, false),
        ],
        ..DescriptorProto::default()
    };
    let file = FileDescriptorProto {
        name: Some("block.proto".into()),
        package: Some("dropcheck".into()),
        syntax: Some("proto3".into()),
        dependency: vec!["google/protobuf/timestamp.proto".into()],
        message_type: vec![block],
        ..FileDescriptorProto::default()
    };
    FileDescriptorSet { file: vec![timestamp, file] }.encode_to_vec()
}

/// A protobuf block, encoded by the reflection library from its descriptors.
pub(super) fn protobuf_block(is_packed: bool, stamp_ns: i64, rate_hz: f64, samples: &[f32]) -> Vec<u8> {
    let pool = DescriptorPool::decode(block_descriptors(is_packed).as_slice()).unwrap();
    let mut stamp = DynamicMessage::new(pool.get_message_by_name("google.protobuf.Timestamp").unwrap());
    stamp.set_field_by_name("seconds", Value::I64(stamp_ns / 1_000_000_000));
    stamp.set_field_by_name("nanos", Value::I32(i32::try_from(stamp_ns % 1_000_000_000).unwrap()));
    let mut block = DynamicMessage::new(pool.get_message_by_name("dropcheck.AccelerationBlock").unwrap());
    block.set_field_by_name("timestamp", Value::Message(stamp));
    block.set_field_by_name("sample_rate_hz", Value::F64(rate_hz));
    block.set_field_by_name("unit", Value::String("g".into()));
    block.set_field_by_name("samples", Value::List(samples.iter().map(|&x| Value::F32(x)).collect()));
    #[allow(clippy::cast_possible_truncation, reason = "small test values")]
    let counts = samples.iter().map(|&x| Value::I64(-(x as i64) * 1_000_000)).collect();
    block.set_field_by_name("counts", Value::List(counts));
    let mut nested = block.clone();
    nested.set_field_by_name("level", Value::F64(2.5));
    block.set_field_by_name("nested", Value::Message(nested));
    block.encode_to_vec()
}

/// The text of `sensor_msgs/msg/Imu` with its parts, as ROS 2 writes it into MCAP files.
pub(super) const IMU_TEXT: &str = "std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance # row major
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// A message of that type: acceleration (7, 8, `z`).
pub(super) fn imu<Order: CdrEndian>(stamp_ns: i64, z: f64) -> Vec<u8> {
    let mut body = Vec::new();
    let mut writer = CdrWriter::<Order, _>::new(&mut body);
    writer.write_i32(i32::try_from(stamp_ns / 1_000_000_000).unwrap());
    writer.write_u32(u32::try_from(stamp_ns % 1_000_000_000).unwrap());
    writer.write_string("imu");
    for value in [0.0, 0.0, 0.0, 1.0] {
        writer.write_f64(value);
    }
    (0..9).for_each(|_| writer.write_f64(-1.0));
    for value in [4.0, 5.0, 6.0] {
        writer.write_f64(value);
    }
    (0..9).for_each(|i| writer.write_f64(f64::from(i)));
    for value in [7.0, 8.0, z] {
        writer.write_f64(value);
    }
    (0..9).for_each(|_| writer.write_f64(0.0));
    let mut message = vec![0, u8::from(Order::IS_LITTLE), 0, 0];
    message.extend(body);
    message
}

/// A cask file whose channels have these sources.
pub(in crate::ingest) fn cask_file(sources: &[&str]) -> CaskFile {
    let channel = |source: &&str| ChannelSpec::new(source, End::First, source, 0.0);
    let cask = Cask::block("test", 1.0, 1.0, 0.0);
    let drop = Drop { impact_velocity_m_s: 13.3, ..Drop::from_height(9.0, 0.2) };
    CaskFile { channels: sources.iter().map(channel).collect(), ..CaskFile::new(cask, drop, Contact::Rough) }
}
