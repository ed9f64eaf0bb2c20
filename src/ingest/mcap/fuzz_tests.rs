//! Bytes to messages of each encoding, their schema before them, for [`crate::ingest::fuzz`].

use super::cdr::{self, Cdr};
use super::descriptors;
use super::json::{self, Json};
use super::path::FieldPath;
use super::plan::{AskedField, Decode, Leaf, Plan, Slots};
use super::protobuf::{self, Protobuf};
use super::ros_type;

/// Decodes every leaf of a message.
fn decode<D: Decode>(leaves: &[Leaf], decoder: impl FnOnce(&Plan) -> D, message: &[u8]) {
    let asked = leaves.iter().filter_map(|leaf| FieldPath::parse(&leaf.path)).map(AskedField::plain);
    let plan = Plan::new(&asked.collect::<Vec<_>>(), leaves, |_| true);
    let mut slots = Slots::default();
    slots.clear(plan.count);
    let _ = decoder(&plan).decode(message, &mut slots);
}

pub(in super::super) fn json(bytes: &[u8]) {
    decode(&json::Fields::of(bytes).leaves, |plan| Json(plan.root.clone()), bytes);
}

/// The length of the descriptors in two bytes, the descriptors, a message.
pub(in super::super) fn protobuf(bytes: &[u8]) {
    let Some((&length, rest)) = bytes.split_first_chunk() else { return };
    let (schema, message) = rest.split_at(rest.len().min(u16::from_le_bytes(length).into()));
    if let Ok(kind) = descriptors::message_type("dropcheck.AccelerationBlock", schema) {
        decode(&protobuf::leaves(&kind), |plan| Protobuf::new(&plan.root, &kind), message);
    }
}

/// A schema in ros2msg, a zero, a message in CDR.
pub(in super::super) fn ros2(bytes: &[u8]) {
    let (schema, message) = bytes.split_at(bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len()));
    let mut left = ros_type::MOST_FIELDS;
    if let Ok(fields) = ros_type::parse("my/msg/Top", &String::from_utf8_lossy(schema), &mut left) {
        let (leaves, fields) = (cdr::leaves(&fields), fields.into());
        decode(&leaves, |plan| Cdr::new(plan, &fields), message.get(1..).unwrap_or_default());
    }
}
