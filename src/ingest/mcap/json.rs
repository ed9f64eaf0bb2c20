//! JSON messages to the wanted fields, straight from the text: samples never become a tree of values.

mod fields;

use super::plan::{
    Decode, LONGEST_PATH_BYTES, Leaf, MOST_LEAVES, NANOSECONDS_NAMES, Node, Plan, SECONDS_NAMES, Slots,
    Value, Want, unix_ns,
};
use crate::data::Samples;
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

/// Messages nested deeper than this hold no signal that a person would name by a path.
const DEEPEST: usize = 8;

/// Decodes JSON messages by a plan.
#[derive(Debug)]
pub(super) struct Json {
    plan: Plan,
}

impl Json {
    /// For the fields of `plan`; JSON needs no schema.
    pub(super) fn new(plan: &Plan) -> Self {
        Self { plan: plan.clone() }
    }

    fn attempt(&self, text: &[u8], slots: &mut Slots) -> Result<(), serde_json::Error> {
        if self.root(slots).whole_object(text) {
            return Ok(());
        }
        slots.clear(self.plan.wants.len());
        self.by_grammar(text, slots)
    }

    /// The same by `serde_json` alone, which says where a text at fault ceases to be JSON.
    fn by_grammar(&self, text: &[u8], slots: &mut Slots) -> Result<(), serde_json::Error> {
        let mut deserializer = serde_json::Deserializer::from_slice(text);
        self.root(slots).deserialize(&mut deserializer)?;
        deserializer.end()
    }

    fn root<'a>(&'a self, slots: &'a mut Slots) -> JsonTaker<'a> {
        JsonTaker { node: &self.plan.root, wants: &self.plan.wants, slots }
    }
}

impl Decode for Json {
    fn decode(&self, data: &[u8], slots: &mut Slots) -> Result<(), String> {
        let Err(error) = self.attempt(data, slots) else { return Ok(()) };
        // Python writes NaN and Infinity, which JSON does not know.
        let Some(repaired) = without_bare_nan(data) else { return Err(error.to_string()) };
        slots.clear(self.plan.wants.len());
        self.attempt(&repaired, slots).map_err(|error| error.to_string())
    }
}

/// The text with bare NaN and Infinity as null, `None` where it holds none.
fn without_bare_nan(text: &[u8]) -> Option<Cow<'_, [u8]>> {
    let (mut out, mut at, mut is_quoted, mut found) = (Vec::with_capacity(text.len()), 0, false, false);
    while let Some(&byte) = text.get(at) {
        if is_quoted {
            let width = if byte == b'\\' { 2 } else { 1 };
            is_quoted = byte != b'"';
            out.extend_from_slice(text.get(at..(at + width).min(text.len())).unwrap_or_default());
            at += width;
            continue;
        }
        let rest = text.get(at..).unwrap_or_default();
        let word =
            [&b"-Infinity"[..], b"Infinity", b"NaN", b"nan"].into_iter().find(|word| rest.starts_with(word));
        if let Some(word) = word {
            out.extend_from_slice(b"null");
            at += word.len();
            found = true;
        } else {
            is_quoted = byte == b'"';
            out.push(byte);
            at += 1;
        }
    }
    found.then_some(Cow::Owned(out))
}

/// A place in the text and in the tree of wanted fields.
struct JsonTaker<'a> {
    node: &'a Node,
    wants: &'a [Want],
    slots: &'a mut Slots,
}

impl JsonTaker<'_> {
    fn below<'b>(&'b mut self, node: &'b Node) -> JsonTaker<'b> {
        JsonTaker { node, wants: self.wants, slots: self.slots }
    }

    fn fill(&mut self, want: Want, value: Value) {
        let mut slots = self.node.slots.iter().filter(|&&slot| self.wants.get(slot) == Some(&want));
        let Some(&last) = slots.next_back() else { return };
        for &slot in slots {
            self.slots.set(slot, value.clone());
        }
        self.slots.set(last, value);
    }

    /// Whether a whole array is wanted here and none of its elements by itself.
    fn wants_array(&self, node: &Node) -> bool {
        node.children.is_empty() && node.slot(self.wants, Want::Numbers).is_some()
    }

    fn wants(&self, want: Want) -> bool {
        self.node.slots.iter().any(|&slot| self.wants.get(slot) == Some(&want))
    }

    fn number(&mut self, value: f64) {
        self.fill(Want::Numbers, Value::Number { value, is_narrow: false });
        self.fill(Want::Stamp, Value::BadStamp);
    }
}

impl<'de> DeserializeSeed<'de> for JsonTaker<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for JsonTaker<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a message")
    }

    fn visit_f64<E: Error>(mut self, value: f64) -> Result<(), E> {
        self.number(value);
        Ok(())
    }

    #[allow(clippy::cast_precision_loss, reason = "samples beyond 2^53 do not occur")]
    fn visit_i64<E: Error>(mut self, value: i64) -> Result<(), E> {
        self.number(value as f64);
        Ok(())
    }

    #[allow(clippy::cast_precision_loss, reason = "samples beyond 2^53 do not occur")]
    fn visit_u64<E: Error>(mut self, value: u64) -> Result<(), E> {
        self.number(value as f64);
        Ok(())
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_unit<E: Error>(mut self) -> Result<(), E> {
        self.fill(Want::Numbers, Value::Number { value: f64::NAN, is_narrow: false });
        Ok(())
    }

    fn visit_str<E: Error>(mut self, text: &str) -> Result<(), E> {
        if self.wants(Want::Text) {
            self.fill(Want::Text, Value::Text(text.to_owned()));
        }
        if self.wants(Want::Stamp) {
            let stamp = text.parse::<jiff::Timestamp>().ok();
            let ns = stamp.and_then(|stamp| i64::try_from(stamp.as_nanosecond()).ok());
            self.fill(Want::Stamp, ns.map_or(Value::BadStamp, Value::Stamp));
        }
        if self.wants(Want::Numbers)
            && let Some(value) = spelled_number(text)
        {
            self.number(value);
        }
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut map: A) -> Result<(), A::Error> {
        if self.wants(Want::Stamp) {
            let (mut seconds, mut nanoseconds) = (None, 0);
            while let Some(key) = map.next_key::<Cow<str>>()? {
                if SECONDS_NAMES.contains(&&*key) {
                    seconds = map.next_value::<Scalar>()?.whole();
                } else if NANOSECONDS_NAMES.contains(&&*key) {
                    nanoseconds = map.next_value::<Scalar>()?.whole().unwrap_or(0);
                } else {
                    map.next_value::<IgnoredAny>()?;
                }
            }
            let value =
                seconds.map_or(Value::BadStamp, |seconds| Value::Stamp(unix_ns(seconds, nanoseconds)));
            self.fill(Want::Stamp, value);
            return Ok(());
        }
        let node = self.node;
        while let Some(key) = map.next_key::<Cow<str>>()? {
            match node.field(&key) {
                Some(child) => map.next_value_seed(self.below(child))?,
                None => map.next_value::<IgnoredAny>().map(|_| ())?,
            }
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut seq: A) -> Result<(), A::Error> {
        let node = self.node;
        if self.wants(Want::Numbers) {
            let mut samples = Vec::new();
            while let Some(scalar) = seq.next_element::<Scalar>()? {
                let value = scalar.sample()?;
                if let Some(child) = node.element(samples.len()) {
                    self.below(child).number(value);
                }
                samples.push(value);
            }
            self.fill(Want::Numbers, Value::Array(Samples::F64(samples)));
            return Ok(());
        }
        let mut index = 0;
        loop {
            let more = match node.element(index) {
                Some(child) => seq.next_element_seed(self.below(child))?.is_some(),
                None => seq.next_element::<IgnoredAny>()?.is_some(),
            };
            if !more {
                return Ok(());
            }
            index += 1;
        }
    }
}

/// What protobuf's JSON mapping writes as words.
fn spelled_number(text: &str) -> Option<f64> {
    match text {
        "NaN" | "nan" => Some(f64::NAN),
        "Infinity" => Some(f64::INFINITY),
        "-Infinity" => Some(f64::NEG_INFINITY),
        _ => text.parse().ok(),
    }
}

/// A number, or what writers put in its place: null, a word, or a 64-bit integer in quotes (protobuf's JSON mapping).
#[derive(Deserialize)]
#[serde(untagged, expecting = "a number is expected")]
enum Scalar<'a> {
    Number(f64),
    #[serde(borrow)]
    Text(Cow<'a, str>),
    Missing(()),
}

impl Scalar<'_> {
    /// A sample: null is NaN.
    fn sample<E: Error>(&self) -> Result<f64, E> {
        match self {
            Self::Number(value) => Ok(*value),
            Self::Missing(()) => Ok(f64::NAN),
            Self::Text(text) => spelled_number(text)
                .ok_or_else(|| E::custom(format!("{text:?} stands where a number should"))),
        }
    }

    /// A whole number.
    #[allow(clippy::cast_possible_truncation, reason = "a float-to-integer cast saturates")]
    fn whole(&self) -> Option<i64> {
        match self {
            Self::Number(value) => Some(*value as i64),
            Self::Text(text) => text.parse().ok(),
            Self::Missing(()) => None,
        }
    }
}

/// The numeric fields of one message; none where it does not parse.
pub(super) fn leaves(message: &[u8]) -> Vec<Leaf> {
    let value = serde_json::from_slice::<serde_json::Value>(message).ok().or_else(|| {
        without_bare_nan(message).and_then(|text| serde_json::from_slice::<serde_json::Value>(&text).ok())
    });
    let mut found = Vec::new();
    if let Some(value) = value {
        // Beyond the limit the rest stays unlisted.
        descend(&value, "", DEEPEST, &mut found);
    }
    found
}

fn descend(value: &serde_json::Value, path: &str, depth: usize, found: &mut Vec<Leaf>) {
    // One more than are listed tells that there are more.
    if found.len() > MOST_LEAVES || path.len() > LONGEST_PATH_BYTES {
        return;
    }
    match value {
        serde_json::Value::Number(_) if !path.is_empty() => {
            found.push(Leaf { path: path.to_owned(), is_array: false });
        }
        serde_json::Value::Array(elements) if !path.is_empty() => {
            let mut numbers = elements.iter().filter(|element| !element.is_null()).take(8).peekable();
            if numbers.peek().is_some() && numbers.all(serde_json::Value::is_number) {
                found.push(Leaf { path: path.to_owned(), is_array: true });
            }
        }
        serde_json::Value::Object(fields) if depth > 0 && !is_stamp(fields) => {
            for (name, value) in fields {
                let below = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                descend(value, &below, depth - 1, found);
            }
        }
        _ => {}
    }
}

fn is_stamp(fields: &serde_json::Map<String, serde_json::Value>) -> bool {
    fields.len() == 2
        && fields.keys().any(|key| SECONDS_NAMES.contains(&key.as_str()))
        && fields.keys().any(|key| NANOSECONDS_NAMES.contains(&key.as_str()))
}

#[cfg(test)]
#[path = "json_tests.rs"]
mod tests;
