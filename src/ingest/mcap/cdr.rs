//! ROS 2 messages in CDR to the wanted fields, by the schema's `ros2msg` text.

use super::plan::{
    Decode, LONGEST_PATH_BYTES, Leaf, NANOSECONDS_NAMES, Node, Plan, SECONDS_NAMES, Slots, Value, Want,
    unix_ns,
};
use super::ros_type::{RosField, Type};
use crate::ingest::number_type::NumberType;
use re_cdr::{BigEndian, CdrReader, LittleEndian, numeric::CdrEndian};
use std::sync::Arc;

/// A serialised message begins with two bytes of representation and two of options.
const ENCAPSULATION_BYTES: usize = 4;
/// What a letter of wide text may take.
const WIDE_BYTES: [usize; 2] = [2, 4];

/// Decodes CDR messages by a plan.
#[derive(Debug)]
pub(super) struct Cdr {
    root: Node,
    fields: Arc<[RosField]>,
    /// Whether a string of wide letters stands among them.
    has_wide_text: bool,
    /// So many of the fields hold all that is wanted.
    needed: usize,
}

impl Cdr {
    /// For the fields of `plan` in messages of `fields`; fields that they lack stay missing.
    pub(super) fn new(plan: &Plan, fields: &Arc<[RosField]>) -> Self {
        // What lies behind the last wanted field need not be walked through.
        let needed =
            fields.iter().rposition(|field| plan.root.field(&field.name).is_some()).map_or(0, |at| at + 1);
        let has_wide_text = fields[..needed].iter().any(|field| field.kind.has_wide_text());
        Self { root: plan.root.clone(), fields: fields.clone(), has_wide_text, needed }
    }
}

impl Decode for Cdr {
    fn decode(&self, data: &[u8], slots: &mut Slots) -> Result<(), String> {
        let (header, body) = data
            .split_at_checked(ENCAPSULATION_BYTES)
            .ok_or_else(|| "the message is shorter than its CDR header".to_owned())?;
        match header {
            [0, 0, ..] => self.walk::<BigEndian>(body, slots),
            [0, 1, ..] => self.walk::<LittleEndian>(body, slots),
            _ => Err(format!(
                "the message is in the representation {header:02x?}; plain CDR of either byte order is read"
            )),
        }
    }
}

impl Cdr {
    fn walk<Order: CdrEndian>(&self, body: &[u8], slots: &mut Slots) -> Result<(), String> {
        let mut wide_bytes = WIDE_BYTES[0];
        if self.has_wide_text {
            // Writers differ in what a wide letter takes; the right width leaves nothing of the message but
            // what aligns its end.
            let end = |bytes: usize| {
                let mut walk = CdrWalk::<Order>::new(body, slots, bytes);
                let is_whole = walk.fields(&self.fields, None).is_ok();
                let end = walk.reader.position();
                (is_whole && body.len() - end < ENCAPSULATION_BYTES).then_some((bytes, end))
            };
            let fitting: Vec<(usize, usize)> = WIDE_BYTES.into_iter().filter_map(end).collect();
            let (first, is_one) = (fitting.first(), fitting.windows(2).all(|pair| pair[0].1 == pair[1].1));
            (wide_bytes, _) = *first.filter(|_| is_one).ok_or(
                "a wstring stands before the numbers, and the message does not tell whether its letters take \
                 2 or 4 bytes",
            )?;
        }
        let needed = self.fields.get(..self.needed).unwrap_or_default();
        let mut walk = CdrWalk::<Order>::new(body, slots, wide_bytes);
        walk.fields(needed, Some(&self.root)).map_err(|error| {
            walk.undecoded.reverse();
            let what = match error {
                re_cdr::Error::UnexpectedEof => "the message ends before it".to_owned(),
                other => other.to_string(),
            };
            format!("at {}: {what}", walk.undecoded.join("."))
        })
    }
}

/// A walk through one message, in the order of its fields.
struct CdrWalk<'a, Order: CdrEndian> {
    reader: CdrReader<'a, Order>,
    slots: &'a mut Slots,
    /// Of a letter of wide text.
    wide_bytes: usize,
    /// The field that does not decode, and those that it lies in, from the innermost.
    undecoded: Vec<String>,
}

impl<'a, Order: CdrEndian> CdrWalk<'a, Order> {
    fn new(body: &'a [u8], slots: &'a mut Slots, wide_bytes: usize) -> Self {
        Self { reader: CdrReader::new(body), slots, wide_bytes, undecoded: Vec::new() }
    }

    fn fields(&mut self, fields: &[RosField], node: Option<&Node>) -> Result<(), re_cdr::Error> {
        for field in fields {
            let child = node.and_then(|node| node.field(&field.name));
            let walked = self.value(&field.kind, child);
            walked.inspect_err(|_| self.undecoded.push(field.name.clone()))?;
        }
        Ok(())
    }

    fn value(&mut self, kind: &Type, node: Option<&Node>) -> Result<(), re_cdr::Error> {
        match kind {
            Type::Text => {
                let text = self.text()?;
                if let Some(slot) = node.and_then(|node| node.slot(Want::Text)) {
                    self.slots.set_text(slot, text);
                }
                Ok(())
            }
            Type::WideText => {
                let units = self.reader.read_u32()? as usize;
                self.reader.read_bytes(units.saturating_mul(self.wide_bytes))?;
                Ok(())
            }
            Type::Message(fields) => self.message(fields, node),
            Type::Array(element, length) => self.array(element, *length, node),
            Type::Number(number) => {
                let value = self.number(*number)?;
                if let Some(slot) = node.and_then(|node| node.slot(Want::Numbers)) {
                    self.slots.set(slot, Value::Number { value, is_narrow: !number.is_wide() });
                }
                Ok(())
            }
        }
    }

    fn message(&mut self, fields: &[RosField], node: Option<&Node>) -> Result<(), re_cdr::Error> {
        let slot = node.and_then(|node| node.slot(Want::Stamp));
        if let (Some(slot), [seconds, nanoseconds], true) = (slot, fields, is_time(fields))
            && let (Type::Number(seconds), Type::Number(nanoseconds)) = (&seconds.kind, &nanoseconds.kind)
        {
            let (whole, part) = (self.number(*seconds)?, self.number(*nanoseconds)?);
            #[allow(clippy::cast_possible_truncation, reason = "both were 32-bit integers")]
            self.slots.set(slot, Value::Stamp(unix_ns(whole as i64, part as i64)));
            return Ok(());
        }
        self.fields(fields, node)
    }

    fn array(
        &mut self,
        element: &Type,
        length: Option<usize>,
        node: Option<&Node>,
    ) -> Result<(), re_cdr::Error> {
        let count = match length {
            Some(count) => count,
            None => self.reader.read_u32()? as usize,
        };
        let Type::Number(number) = *element else {
            for index in 0..count {
                let before = self.reader.position();
                self.value(element, node.and_then(|node| node.element(index)))?;
                if self.reader.position() == before {
                    // Elements without content, however many are announced.
                    break;
                }
            }
            return Ok(());
        };
        if count > 0 {
            self.reader.align(number.bytes())?;
        }
        let stored = self.reader.read_bytes(count.saturating_mul(number.bytes()))?;
        if let Some((node, slot)) = node.and_then(|node| Some((node, node.slot(Want::Numbers)?))) {
            self.slots.set(slot, Value::Array(number.samples(stored, !Order::IS_LITTLE)));
            self.slots.pick(slot, &node.elements());
        }
        Ok(())
    }

    fn number(&mut self, number: NumberType) -> Result<f64, re_cdr::Error> {
        self.reader.align(number.bytes())?;
        Ok(number.value(self.reader.read_bytes(number.bytes())?, !Order::IS_LITTLE))
    }

    /// A string's bytes without the closing zero.
    fn text(&mut self) -> Result<&'a [u8], re_cdr::Error> {
        let length = self.reader.read_u32()? as usize;
        let bytes = self.reader.read_bytes(length)?;
        Ok(bytes.strip_suffix(&[0]).unwrap_or(bytes))
    }
}

/// The numeric fields of a message type; single bytes are images and flags, no signals.
pub(super) fn leaves(fields: &[RosField]) -> Vec<Leaf> {
    let mut found = Vec::new();
    descend(fields, "", &mut found);
    found
}

fn descend(fields: &[RosField], path: &str, found: &mut Vec<Leaf>) {
    if path.len() > LONGEST_PATH_BYTES {
        return;
    }
    for field in fields {
        let below = if path.is_empty() { field.name.clone() } else { format!("{path}.{}", field.name) };
        match &field.kind {
            Type::Message(inner) if !is_time(inner) => descend(inner, &below, found),
            Type::Array(element, _) if matches!(**element, Type::Number(number) if number.bytes() > 1) => {
                found.push(Leaf { path: below, is_array: true, is_signal: true });
            }
            Type::Message(_) | Type::Array(..) | Type::WideText => {}
            Type::Number(number) => {
                found.push(Leaf { path: below, is_array: false, is_signal: *number != NumberType::U8 });
            }
            Type::Text => found.push(Leaf { path: below, is_array: false, is_signal: false }),
        }
    }
}

fn is_time(fields: &[RosField]) -> bool {
    matches!(fields, [seconds, nanoseconds]
        if SECONDS_NAMES.contains(&seconds.name.as_str())
            && NANOSECONDS_NAMES.contains(&nanoseconds.name.as_str()))
}

#[cfg(test)]
#[path = "cdr_tests.rs"]
mod tests;
