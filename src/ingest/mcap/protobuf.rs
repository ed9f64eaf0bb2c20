//! Protobuf messages to the wanted fields, by the schema's own descriptor set and straight from the wire.

use super::numbers::push;
use super::plan::{
    Decode, LONGEST_PATH_BYTES, Leaf, NANOSECONDS_NAMES, Node, SECONDS_NAMES, Slots, Value, Want, unix_ns,
};
use super::wire::{Item, Wire};
use crate::data::Samples;
use prost_reflect::{FieldDescriptor, Kind, MessageDescriptor};
use std::collections::HashMap;

/// Messages nested deeper than this (or in themselves) hold no signal that a person would name by a path.
const DEEPEST: usize = 8;
/// So many fields of a type are looked at: types that hold themselves several times multiply at each level.
const MOST_VISITED: usize = 20_000;

/// The numeric fields of a message type.
pub(super) fn leaves(message: &MessageDescriptor) -> Vec<Leaf> {
    let mut found = Vec::new();
    let mut left = MOST_VISITED;
    descend(message, "", DEEPEST, &mut left, &mut found);
    found
}

fn descend(message: &MessageDescriptor, path: &str, depth: usize, left: &mut usize, found: &mut Vec<Leaf>) {
    if depth == 0 || path.len() > LONGEST_PATH_BYTES || is_time(message) {
        return;
    }
    for field in message.fields() {
        let Some(fewer) = left.checked_sub(1) else { return };
        *left = fewer;
        let below =
            if path.is_empty() { field.name().to_owned() } else { format!("{path}.{}", field.name()) };
        match field.kind() {
            Kind::Message(inner) if !field.is_list() && !field.is_map() => {
                descend(&inner, &below, depth - 1, left, found);
            }
            kind if is_number(&kind) && !field.is_map() => {
                found.push(Leaf { path: below, is_array: field.is_list(), is_signal: true });
            }
            Kind::String if !field.is_list() => {
                found.push(Leaf { path: below, is_array: false, is_signal: false });
            }
            _ => {}
        }
    }
}

fn is_time(message: &MessageDescriptor) -> bool {
    seconds_and_nanoseconds(message).is_some_and(|_| message.fields().len() == 2)
}

fn is_number(kind: &Kind) -> bool {
    !matches!(kind, Kind::Message(_) | Kind::Enum(_) | Kind::String | Kind::Bytes | Kind::Bool)
}

/// The field numbers of a time's two parts.
fn seconds_and_nanoseconds(message: &MessageDescriptor) -> Option<[u32; 2]> {
    let number = |names: &[&str]| {
        let mut numbers = message.fields().filter(|field| is_number(&field.kind()) && !field.is_list());
        numbers.find(|field| names.contains(&field.name())).map(|field| field.number())
    };
    Some([number(&SECONDS_NAMES)?, number(&NANOSECONDS_NAMES)?])
}

/// Decodes protobuf messages by a plan: what to do with the fields of a message.
#[derive(Debug, Default)]
pub(super) struct Protobuf {
    fields: Vec<ProtobufField>,
    /// What a field without presence is worth when it is not on the wire.
    defaults: Vec<(usize, Value)>,
}

/// What to do with one field.
#[derive(Debug)]
struct ProtobufField {
    number: u32,
    kind: Kind,
    is_list: bool,
    action: Action,
}

#[derive(Debug)]
enum Action {
    /// Into the slot, and single elements into others.
    Numbers(usize, Vec<(usize, usize)>),
    Text(usize),
    /// Into the slot, by the field numbers of seconds and nanoseconds.
    Stamp(usize, [u32; 2]),
    Descend(Protobuf),
    /// One message of a repeated one.
    Elements(Vec<(usize, Protobuf)>),
}

impl Protobuf {
    /// For the fields below `node` in messages of type `message`; fields that it lacks stay missing.
    pub(super) fn new(node: &Node, message: &MessageDescriptor) -> Self {
        let mut compiled = Self::default();
        for field in message.fields().filter(|field| !field.is_map()) {
            let Some(child) = node.field(field.name()).or_else(|| node.field(field.json_name())) else {
                continue;
            };
            if let Some(action) = action(child, &field) {
                match &action {
                    Action::Numbers(slot, _) if !field.is_list() && !field.supports_presence() => {
                        let is_narrow = matches!(field.kind(), Kind::Float);
                        compiled.defaults.push((*slot, Value::Number { value: 0.0, is_narrow }));
                    }
                    Action::Stamp(slot, _) => compiled.defaults.push((*slot, Value::Stamp(0))),
                    _ => {}
                }
                let (number, kind, is_list) = (field.number(), field.kind(), field.is_list());
                compiled.fields.push(ProtobufField { number, kind, is_list, action });
            }
        }
        compiled
    }
}

fn action(child: &Node, field: &FieldDescriptor) -> Option<Action> {
    match field.kind() {
        Kind::Message(inner) if field.is_list() => {
            let elements = child.indexed().map(|(index, node)| (index, Protobuf::new(node, &inner)));
            Some(Action::Elements(elements.collect()))
        }
        Kind::Message(inner) => match (child.slot(Want::Stamp), seconds_and_nanoseconds(&inner)) {
            (Some(slot), Some(parts)) => Some(Action::Stamp(slot, parts)),
            _ => Some(Action::Descend(Protobuf::new(child, &inner))),
        },
        Kind::String => child.slot(Want::Text).map(Action::Text),
        kind if is_number(&kind) => {
            child.slot(Want::Numbers).map(|slot| Action::Numbers(slot, child.elements()))
        }
        _ => None,
    }
}

impl Decode for Protobuf {
    fn decode(&self, data: &[u8], slots: &mut Slots) -> Result<(), String> {
        for (slot, value) in &self.defaults {
            slots.set(*slot, value.clone());
        }
        let mut wire = Wire(data);
        let mut seen: HashMap<u32, usize> = HashMap::new();
        while let Some((number, item)) = wire.item()? {
            let Some(field) = self.fields.iter().find(|field| field.number == number) else { continue };
            let wrong_type = || format!("field {number} is not of its schema's type");
            match (&field.action, item) {
                (Action::Numbers(slot, _), item) => {
                    field.numbers(*slot, &item, slots).ok_or_else(wrong_type)?;
                }
                (Action::Text(slot), Item::Bytes(bytes)) => slots.set_text(*slot, bytes),
                (Action::Stamp(slot, parts), Item::Bytes(bytes)) => {
                    slots.set(*slot, Value::Stamp(stamp_ns(bytes, *parts)?));
                }
                (Action::Descend(message), Item::Bytes(bytes)) => message.decode(bytes, slots)?,
                (Action::Elements(elements), Item::Bytes(bytes)) => {
                    let count = seen.entry(number).or_default();
                    if let Some((_, message)) = elements.iter().find(|(wanted, _)| wanted == count) {
                        message.decode(bytes, slots)?;
                    }
                    *count += 1;
                }
                _ => return Err(wrong_type()),
            }
        }
        for field in &self.fields {
            if let Action::Numbers(slot, elements) = &field.action {
                slots.pick(*slot, elements);
            }
        }
        Ok(())
    }
}

impl ProtobufField {
    /// Takes what a field holds; `None` where that is not of its schema's type.
    fn numbers(&self, slot: usize, item: &Item, slots: &mut Slots) -> Option<()> {
        let is_narrow = matches!(self.kind, Kind::Float);
        if !self.is_list {
            slots.set(slot, Value::Number { value: scalar(&self.kind, item)?, is_narrow });
            return Some(());
        }
        let Some(place) = slots.values.get_mut(slot) else { return Some(()) };
        if !matches!(place, Value::Array(_)) {
            *place = Value::Array(if is_narrow { Samples::default() } else { Samples::F64(Vec::new()) });
        }
        let Value::Array(samples) = place else { return Some(()) };
        match (item, samples) {
            (Item::Bytes(packed), Samples::F32(samples)) => {
                let (words, rest) = packed.as_chunks::<4>();
                samples.extend(words.iter().map(|&word| f32::from_le_bytes(word)));
                return rest.is_empty().then_some(());
            }
            (Item::Bytes(packed), Samples::F64(samples)) => {
                let mut wire = Wire(packed);
                while !wire.0.is_empty() {
                    let item = match self.kind {
                        Kind::Double | Kind::Fixed64 | Kind::Sfixed64 => Item::Fixed64(wire.fixed().ok()?),
                        Kind::Fixed32 | Kind::Sfixed32 => Item::Fixed32(wire.fixed().ok()?),
                        _ => Item::Varint(wire.varint().ok()?),
                    };
                    samples.push(scalar(&self.kind, &item)?);
                }
            }
            (one, samples) => push(samples, scalar(&self.kind, one)?, is_narrow),
        }
        Some(())
    }
}

fn stamp_ns(bytes: &[u8], [seconds, nanoseconds]: [u32; 2]) -> Result<i64, String> {
    let (mut whole, mut part) = (0, 0);
    let mut wire = Wire(bytes);
    while let Some((number, item)) = wire.item()? {
        let value = match item {
            Item::Varint(value) => value.cast_signed(),
            Item::Fixed32(bytes) => i64::from(i32::from_le_bytes(bytes)),
            Item::Fixed64(bytes) => i64::from_le_bytes(bytes),
            Item::Bytes(_) => continue,
        };
        if number == seconds {
            whole = value;
        } else if number == nanoseconds {
            part = value;
        }
    }
    Ok(unix_ns(whole, part))
}

/// A number from the wire, `None` where the wire type is not the schema's.
#[allow(clippy::cast_precision_loss, reason = "samples beyond 2^53 do not occur")]
#[allow(clippy::cast_possible_truncation, reason = "protobuf cuts 32-bit integers from 64-bit varints so")]
fn scalar(kind: &Kind, item: &Item) -> Option<f64> {
    Some(match (kind, *item) {
        (Kind::Double, Item::Fixed64(bytes)) => f64::from_le_bytes(bytes),
        (Kind::Float, Item::Fixed32(bytes)) => f64::from(f32::from_le_bytes(bytes)),
        (Kind::Fixed32, Item::Fixed32(bytes)) => f64::from(u32::from_le_bytes(bytes)),
        (Kind::Sfixed32, Item::Fixed32(bytes)) => f64::from(i32::from_le_bytes(bytes)),
        (Kind::Fixed64, Item::Fixed64(bytes)) => u64::from_le_bytes(bytes) as f64,
        (Kind::Sfixed64, Item::Fixed64(bytes)) => i64::from_le_bytes(bytes) as f64,
        (Kind::Int32, Item::Varint(value)) => f64::from(value as i32),
        (Kind::Uint32, Item::Varint(value)) => f64::from(value as u32),
        (Kind::Int64, Item::Varint(value)) => value.cast_signed() as f64,
        (Kind::Uint64, Item::Varint(value)) => value as f64,
        (Kind::Sint32 | Kind::Sint64, Item::Varint(value)) => {
            ((value >> 1).cast_signed() ^ -((value & 1).cast_signed())) as f64
        }
        _ => return None,
    })
}

#[cfg(test)]
#[path = "protobuf_tests.rs"]
mod tests;
