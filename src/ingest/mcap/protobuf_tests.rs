//! Tests of the protobuf decoder against messages that the reflection library encodes.

use super::*;
use crate::ingest::mcap::descriptors::message_type;
use crate::ingest::mcap::path::FieldPath;
use crate::ingest::mcap::plan::{AskedField, Plan};
use crate::ingest::mcap::written::{ZERO_NS, block_descriptors, protobuf_block};
use prost_reflect::prost::Message as _;
use prost_reflect::prost_types::field_descriptor_proto::Type;
use prost_reflect::prost_types::{
    DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet,
};

fn decoded(
    is_packed: bool,
    field: &str,
    data: &[u8],
) -> Result<(Value, Value, Option<f64>, Option<String>), String> {
    let message = message_type("dropcheck.AccelerationBlock", &block_descriptors(is_packed))?;
    let plan = Plan::new(&[AskedField::plain(FieldPath::parse(field).unwrap())], &[], |_| true);
    let mut slots = Slots::default();
    slots.clear(plan.count);
    Protobuf::new(&plan.root, &message).decode(data, &mut slots)?;
    let field = &plan.fields[0];
    let said = slots.beside(field);
    let stamp = said.stamp.cloned().unwrap_or_default();
    let (rate, unit) = (said.rates.first().map(|rate| rate.value), said.unit.map(String::from));
    Ok((slots.samples(field), stamp, rate, unit))
}

#[test]
fn packed_and_unpacked_samples_come_with_stamp_rate_and_unit() {
    for is_packed in [true, false] {
        let data = protobuf_block(is_packed, ZERO_NS + 7, 1000.0, &[1.5, -2.0, 3.0]);
        let (value, stamp, rate, unit) = decoded(is_packed, "samples", &data).unwrap();
        assert_eq!(value, Value::Array(Samples::F32(vec![1.5, -2.0, 3.0])));
        assert_eq!(stamp, Value::Stamp(ZERO_NS + 7));
        assert_eq!((rate, unit.as_deref()), (Some(1000.0), Some("g")));
    }
}

#[test]
fn a_packed_schema_reads_unpacked_data_and_the_other_way_round() {
    let data = protobuf_block(false, 1, 1000.0, &[1.5, -2.0]);
    assert_eq!(decoded(true, "samples", &data).unwrap().0, Value::Array(Samples::F32(vec![1.5, -2.0])));
    let data = protobuf_block(true, 1, 1000.0, &[1.5, -2.0]);
    assert_eq!(decoded(false, "samples", &data).unwrap().0, Value::Array(Samples::F32(vec![1.5, -2.0])));
}

#[test]
fn zigzag_counts_elements_and_nested_numbers_are_read() {
    let data = protobuf_block(true, 1, 1000.0, &[1.0, -3.0]);
    assert_eq!(decoded(true, "counts", &data).unwrap().0, Value::Array(Samples::F64(vec![-1e6, 3e6])));
    assert_eq!(decoded(true, "samples[1]", &data).unwrap().0, Value::Number { value: -3.0, is_narrow: true });
    assert_eq!(
        decoded(true, "nested.level", &data).unwrap().0,
        Value::Number { value: 2.5, is_narrow: false }
    );
    // proto3 leaves a zero off the wire.
    assert_eq!(decoded(true, "level", &data).unwrap().0, Value::Number { value: 0.0, is_narrow: false });
    assert_eq!(decoded(true, "nothing", &data).unwrap().0, Value::Missing);
    assert_eq!(decoded(true, "samples", &[]).unwrap().1, Value::Stamp(0));
}

#[test]
fn a_cut_message_is_an_error_or_holds_less_and_never_panics() {
    let data = protobuf_block(true, 1, 1000.0, &[1.0, 2.0, 3.0]);
    let errors = (0..data.len()).filter(|&end| decoded(true, "samples", &data[..end]).is_err()).count();
    assert!(errors > data.len() / 2, "{errors} of {}", data.len());
    for position in 0..data.len() {
        let mut damaged = data.clone();
        damaged[position] ^= 0xff;
        let _ = decoded(true, "samples", &damaged);
    }
}

#[test]
fn leaves_stop_at_times_and_at_messages_within_themselves() {
    let message = message_type("dropcheck.AccelerationBlock", &block_descriptors(true)).unwrap();
    let paths: Vec<String> = leaves(&message).into_iter().map(|leaf| leaf.path).collect();
    assert!(paths.contains(&"samples".to_owned()) && paths.contains(&"nested.level".to_owned()));
    assert!(!paths.iter().any(|path| path.contains("seconds")), "{paths:?}");
    assert!(message_type("dropcheck.Other", &block_descriptors(true)).unwrap_err().contains("Other"));
    assert!(message_type("x", b"\xff\xff").is_err());
}

#[test]
fn a_type_that_holds_itself_many_times_is_listed_to_an_end() {
    let fields = (1..=100).map(|number| FieldDescriptorProto {
        name: Some(format!("again{number}")),
        number: Some(number),
        r#type: Some(Type::Message.into()),
        type_name: Some(".T".into()),
        ..FieldDescriptorProto::default()
    });
    let level = FieldDescriptorProto {
        name: Some("level".into()),
        number: Some(101),
        r#type: Some(Type::Double.into()),
        ..FieldDescriptorProto::default()
    };
    let kind = DescriptorProto {
        name: Some("T".into()),
        field: fields.chain([level]).collect(),
        ..DescriptorProto::default()
    };
    let file = FileDescriptorProto {
        name: Some("t.proto".into()),
        message_type: vec![kind],
        ..FileDescriptorProto::default()
    };
    let set = FileDescriptorSet { file: vec![file] }.encode_to_vec();
    // A hundred to the eighth power without the limit.
    let found = leaves(&message_type("T", &set).unwrap());
    assert!(!found.is_empty() && found.len() <= 20_000);
}
