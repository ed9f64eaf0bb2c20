//! JSON messages to the wanted fields by a walk along their text: samples never become a tree of values.
//!
//! `serde_json` tells nobody where in the text it stands: to read numbers by their digits an array would have
//! to be gone through twice. All but objects and plain arrays is left to it.

use super::path::Step;
use super::plan::{
    Decode, LONGEST_PATH_BYTES, Leaf, MOST_LEAVES, NANOSECONDS_NAMES, Node, SECONDS_NAMES, Slots, Value,
    Want, unix_ns,
};
use crate::data::Samples;
use crate::ingest::number;
use crate::ingest::times::dated;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value as Tree;
use std::borrow::Cow;

/// Messages nested deeper than this hold no signal that a person would name by a path.
const DEEPEST: usize = 8;

/// Decodes JSON messages by the root of a plan; they need no schema.
#[derive(Debug)]
pub(super) struct Json(pub(super) Node);

impl Json {
    fn walk(&self, text: &[u8], slots: &mut Slots) -> Result<(), String> {
        let from = past_spaces(text, 0);
        match slots.value(&self.0, &text[from..]) {
            Ok(used) if past_spaces(text, from + used) == text.len() => Ok(()),
            Err(Some(problem)) => Err(problem),
            // The grammar says where a text ceases to be JSON.
            _ => match serde_json::from_slice::<IgnoredAny>(text) {
                Err(error) => Err(error.to_string()),
                Ok(_) => Err("one of its values is out of range, or no text".into()),
            },
        }
    }
}

impl Decode for Json {
    fn decode(&self, data: &[u8], slots: &mut Slots) -> Result<(), String> {
        let Err(problem) = self.walk(data, slots) else { return Ok(()) };
        // Python writes NaN and Infinity, which JSON does not know.
        let Some(repaired) = without_bare_nan(data) else { return Err(problem) };
        slots.clear(slots.values.len());
        self.walk(&repaired, slots)
    }
}

/// The text with bare NaN and Infinity as null, `None` where it holds none.
fn without_bare_nan(text: &[u8]) -> Option<Vec<u8>> {
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
    found.then_some(out)
}

/// A walk along a message in JSON: what stands at a place goes into the slots of its node. It fails by a
/// wanted value that is none that is read, or, without a word, where the text is no JSON.
impl Slots {
    /// The value at the start of `text`; how many bytes it takes.
    fn value(&mut self, node: &Node, text: &[u8]) -> Result<usize, Option<String>> {
        let numbers = node.slot(Want::Numbers);
        if text.first() == Some(&b'{') && node.slot(Want::Stamp).is_none() {
            return self.object(node, text);
        }
        if let (Some(slot), Some((samples, used))) = (numbers, plain_numbers(text)) {
            self.array(node, slot, samples);
            return Ok(used);
        }
        let (value, used) = first(text)?;
        self.take(node, &value)?;
        Ok(used)
    }

    /// The fields of the object at the start of `text`; how many bytes it takes.
    fn object(&mut self, node: &Node, text: &[u8]) -> Result<usize, Option<String>> {
        let mut at = past_spaces(text, 1);
        if text.get(at) == Some(&b'}') {
            return Ok(at + 1);
        }
        loop {
            let (FieldName(key), used) = first(&text[at..])?;
            at = past_spaces(text, at + used);
            if text.get(at) != Some(&b':') {
                return Err(None);
            }
            at = past_spaces(text, at + 1);
            at += match node.field(&key).or_else(|| node.below(&key)) {
                Some(child) => self.value(child, &text[at..])?,
                None => first::<IgnoredAny>(&text[at..])?.1,
            };
            at = past_spaces(text, at);
            match text.get(at) {
                Some(b',') => at = past_spaces(text, at + 1),
                Some(b'}') => return Ok(at + 1),
                _ => return Err(None),
            }
        }
    }

    fn array(&mut self, node: &Node, slot: usize, samples: Vec<f64>) {
        self.set(slot, Value::Array(Samples::F64(samples)));
        self.pick(slot, &node.elements());
    }

    /// A value other than a run of plain numbers: one, words, a time, or what holds such at places of their
    /// own.
    fn take(&mut self, node: &Node, value: &Tree) -> Result<(), Option<String>> {
        match (node.slot(Want::Numbers), value) {
            (Some(slot), Tree::Array(elements)) => {
                let no_number = |element| format!("{element} stands in an array where a number should");
                let sample = |element| number(element).ok_or_else(|| Some(no_number(element)));
                let samples = elements.iter().map(sample).collect::<Result<_, _>>()?;
                self.array(node, slot, samples);
                return Ok(());
            }
            (Some(slot), _) => {
                if let Some(value) = number(value) {
                    self.set(slot, Value::Number { value, is_narrow: false });
                }
            }
            (None, _) => {}
        }
        if let (Some(slot), Tree::String(text)) = (node.slot(Want::Text), value) {
            self.set_text(slot, text.as_bytes());
        }
        if let (Some(slot), Some(stamp)) = (node.slot(Want::Stamp), stamp(value)) {
            self.set(slot, stamp);
            return Ok(());
        }
        for (step, child) in &node.children {
            let below = match step {
                Step::Name(name) => value.get(name),
                Step::Index(index) => value.get(index),
            };
            below.map_or(Ok(()), |below| self.take(child, below))?;
        }
        Ok(())
    }
}

/// The time that `value` is; `None` where it is nothing of the kind.
fn stamp(value: &Tree) -> Option<Value> {
    let part = |names: &[&str]| names.iter().find_map(|name| value.get(name)).and_then(whole);
    let ns = match value {
        Tree::String(text) => dated(text).and_then(|(at, _)| i64::try_from(at.as_nanosecond()).ok()),
        Tree::Object(_) => {
            part(&SECONDS_NAMES).map(|seconds| unix_ns(seconds, part(&NANOSECONDS_NAMES).unwrap_or(0)))
        }
        _ => return None,
    };
    Some(ns.map_or(Value::BadStamp, Value::Stamp))
}

/// A whole number, also one in quotes: protobuf's JSON mapping writes those of 64 bits so.
#[allow(clippy::cast_possible_truncation, reason = "a float-to-integer cast saturates")]
fn whole(value: &Tree) -> Option<i64> {
    match value {
        Tree::String(text) => text.parse().ok(),
        other => other.as_f64().map(|value| value as i64),
    }
}

/// A sample; in its place writers put null where it is missing, and the words of protobuf's JSON mapping.
fn number(value: &Tree) -> Option<f64> {
    match value {
        Tree::Null => Some(f64::NAN),
        Tree::String(text) => match text.as_str() {
            "NaN" | "nan" => Some(f64::NAN),
            "Infinity" => Some(f64::INFINITY),
            "-Infinity" => Some(f64::NEG_INFINITY),
            _ => text.parse().ok(),
        },
        other => other.as_f64(),
    }
}

/// The name of a field.
#[derive(Deserialize)]
struct FieldName<'a>(#[serde(borrow)] Cow<'a, str>);

/// The first value of `text` and how many bytes it takes.
fn first<'a, T: Deserialize<'a>>(text: &'a [u8]) -> Result<(T, usize), Option<String>> {
    let mut values = serde_json::Deserializer::from_slice(text).into_iter::<T>();
    let value = values.next().ok_or(None)?.map_err(|_| None)?;
    Ok((value, values.byte_offset()))
}

/// The numbers of the array that `text` begins with and how many bytes it takes; `None` where it holds
/// anything else.
fn plain_numbers(text: &[u8]) -> Option<(Vec<f64>, usize)> {
    /// Characters of a number and its comma, as loggers write them; more room is taken as it is needed.
    const USUAL: usize = 8;
    let mut at = past_spaces(text, text.starts_with(b"[").then_some(1)?);
    if text.get(at) == Some(&b']') {
        return Some((Vec::new(), at + 1));
    }
    let mut numbers = Vec::with_capacity(text.len() / USUAL);
    loop {
        let (value, used) = number::leading_json(text.get(at..)?)?;
        numbers.push(value);
        at += used;
        // Most writers put one space behind a comma or none, and none before it.
        if text.get(at) != Some(&b',') {
            at = past_spaces(text, at);
        }
        match text.get(at)? {
            b',' => at = past_spaces(text, at + 1),
            b']' => return Some((numbers, at + 1)),
            _ => return None,
        }
    }
}

/// The first place from `at` on that is no space of JSON.
fn past_spaces(text: &[u8], mut at: usize) -> usize {
    while matches!(text.get(at), Some(b' ' | b'\t' | b'\n' | b'\r')) {
        at += 1;
    }
    at
}

/// What a message holds.
#[derive(Default)]
pub(super) struct Fields {
    /// Its numeric fields; beyond the limit the rest stays unlisted.
    pub(super) leaves: Vec<Leaf>,
    /// Whether it holds a list of records, whose numbers are no such fields.
    pub(super) has_records: bool,
}

impl Fields {
    /// Of a message; none where it does not parse.
    pub(super) fn of(message: &[u8]) -> Self {
        let repaired = || serde_json::from_slice::<Tree>(&without_bare_nan(message)?).ok();
        let mut fields = Self::default();
        if let Some(value) = serde_json::from_slice::<Tree>(message).ok().or_else(repaired) {
            fields.descend(&value, "", DEEPEST);
        }
        fields
    }

    fn descend(&mut self, value: &Tree, path: &str, depth: usize) {
        // One more than are listed tells that there are more.
        if self.leaves.len() > MOST_LEAVES || path.len() > LONGEST_PATH_BYTES {
            return;
        }
        let is_array = value.is_array();
        let is_signal = match value {
            Tree::Number(_) => true,
            Tree::String(_) => false,
            Tree::Array(elements) => {
                let mut numbers = elements.iter().filter(|element| !element.is_null()).take(8).peekable();
                self.has_records |= elements.iter().take(8).any(Tree::is_object);
                if numbers.peek().is_none() || !numbers.all(Tree::is_number) {
                    return;
                }
                true
            }
            Tree::Object(fields) if depth > 0 && !is_stamp(fields) => {
                for (name, value) in fields {
                    let below = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                    self.descend(value, &below, depth - 1);
                }
                return;
            }
            _ => return,
        };
        if !path.is_empty() {
            self.leaves.push(Leaf { path: path.to_owned(), is_array, is_signal });
        }
    }
}

fn is_stamp(fields: &serde_json::Map<String, Tree>) -> bool {
    fields.len() == 2
        && fields.keys().any(|key| SECONDS_NAMES.contains(&key.as_str()))
        && fields.keys().any(|key| NANOSECONDS_NAMES.contains(&key.as_str()))
}

#[cfg(test)]
#[path = "json_tests.rs"]
mod tests;
