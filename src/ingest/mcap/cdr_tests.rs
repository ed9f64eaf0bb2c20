//! Tests of the CDR decoder against messages that the CDR library encodes.

use super::*;
use crate::data::Samples;
use crate::ingest::mcap::path::FieldPath;
use crate::ingest::mcap::plan::AskedField;
use crate::ingest::mcap::ros_type;
use crate::ingest::mcap::written::{IMU_TEXT, ZERO_NS, imu};
use re_cdr::CdrWriter;

fn decoded(text: &str, field: &str, data: &[u8]) -> Result<(Value, Value), String> {
    let fields = ros_type::parse("my/msg/Top", text, &mut 20_000)?;
    let plan = Plan::new(&[AskedField::plain(FieldPath::parse(field).unwrap())], &[], |_| true);
    let mut slots = Slots::default();
    slots.clear(plan.count);
    Cdr::new(&plan, &fields.into()).decode(data, &mut slots)?;
    let stamp = slots.beside(&plan.fields[0]).stamp.cloned().unwrap_or_default();
    Ok((slots.samples(&plan.fields[0]), stamp))
}

#[test]
fn an_imu_of_either_byte_order_gives_its_acceleration_and_stamp() {
    for data in [imu::<LittleEndian>(ZERO_NS + 3, 9.5), imu::<BigEndian>(ZERO_NS + 3, 9.5)] {
        let (value, stamp) = decoded(IMU_TEXT, "linear_acceleration.z", &data).unwrap();
        assert_eq!(value, Value::Number { value: 9.5, is_narrow: false });
        assert_eq!(stamp, Value::Stamp(ZERO_NS + 3));
        let (value, _) = decoded(IMU_TEXT, "angular_velocity_covariance[4]", &data).unwrap();
        assert_eq!(value, Value::Number { value: 4.0, is_narrow: false });
    }
}

#[test]
fn sequences_strings_and_narrow_integers_are_walked_through() {
    const TEXT: &str = "string[] names\nP[] points\nint16[] raw\nfloat32[<=4] fine\nuint8 flag\nfloat64 \
                        last\n===\nMSG: my/P\nfloat32 x\nuint8 y\n";
    let mut body = Vec::new();
    let mut writer = CdrWriter::<LittleEndian, _>::new(&mut body);
    writer.write_sequence_length(2);
    writer.write_string("a");
    writer.write_string("bcd");
    writer.write_sequence_length(2);
    for (x, y) in [(1.5, 1), (2.5, 2)] {
        writer.write_f32(x);
        writer.write_u8(y);
    }
    writer.write_sequence_length(3);
    for value in [-1, 2, -300] {
        writer.write_i16(value);
    }
    writer.write_sequence_length(2);
    for value in [0.5, 0.25] {
        writer.write_f32(value);
    }
    writer.write_u8(1);
    writer.write_f64(8.25);
    let mut data = vec![0, 1, 0, 0];
    data.extend(&body);
    let narrow = |samples: &[f32]| Value::Array(Samples::F32(samples.to_vec()));
    assert_eq!(decoded(TEXT, "raw", &data).unwrap().0, narrow(&[-1.0, 2.0, -300.0]));
    assert_eq!(decoded(TEXT, "fine", &data).unwrap().0, narrow(&[0.5, 0.25]));
    assert_eq!(decoded(TEXT, "points[1].x", &data).unwrap().0, Value::Number { value: 2.5, is_narrow: true });
    assert_eq!(decoded(TEXT, "last", &data).unwrap().0, Value::Number { value: 8.25, is_narrow: false });
    for end in 0..data.len() {
        assert!(decoded(TEXT, "last", &data[..end]).is_err(), "{end}");
    }
}

#[test]
fn a_length_beyond_the_message_takes_no_memory() {
    for order in [0, 1] {
        let data = [0, order, 0, 0, 0xff, 0xff, 0xff, 0xff, 1, 2, 3, 4];
        for text in [
            "float64[] v\n",
            "string[] v\nfloat64 w\n",
            "E[] v\nfloat64 w\n===\nMSG: my/E\nfloat64[0] none\n",
        ] {
            let field = if text.contains('w') { "w" } else { "v" };
            assert!(decoded(text, field, &data).is_err(), "{text}");
        }
    }
    assert!(decoded("float64 v\n", "v", &[0, 7, 0, 0, 1]).unwrap_err().contains("representation"));
}

#[test]
fn leaves_are_signals_not_times_nor_bytes() {
    let fields = ros_type::parse("sensor_msgs/msg/Imu", IMU_TEXT, &mut 20_000).unwrap();
    let found: Vec<_> = leaves(&fields).into_iter().filter(|leaf| leaf.is_signal).collect();
    assert_eq!(found.len(), 4 + 1 + 3 + 1 + 3 + 1);
    assert!(!found.iter().any(|leaf| leaf.path.contains("stamp")));
}
