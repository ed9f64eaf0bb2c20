//! The fields of a JSON message by a walk along its text, which takes arrays of plain numbers in one pass.
//!
//! `serde_json` tells nobody where in the text it stands: to read numbers by their digits an array would have to be gone
//! through twice. All but objects and plain arrays is left to it, and so is every text that is not as usual.

use super::JsonTaker;
use crate::data::Samples;
use crate::ingest::mcap::plan::{Value, Want};
use crate::ingest::number;
use serde::de::{DeserializeSeed, IgnoredAny};
use serde_json::Deserializer;
use serde_json::value::RawValue;

impl JsonTaker<'_> {
    /// The fields of the object that `text` holds and nothing else; whether it does.
    ///
    /// Where not, some slots may be filled already.
    pub(super) fn whole_object(&mut self, text: &[u8]) -> bool {
        let from = past_spaces(text, 0);
        self.object(&text[from..]).is_some_and(|used| past_spaces(text, from + used) == text.len())
    }

    /// The fields of the object at the start of `text`; how many bytes it takes. `None` where it is none of the usual kind.
    fn object(&mut self, text: &[u8]) -> Option<usize> {
        let mut at = past_spaces(text, after(text, 0, b'{')?);
        if text.get(at) == Some(&b'}') {
            return Some(at + 1);
        }
        loop {
            let key = plain_key(text.get(at..)?)?;
            at = past_spaces(text, at + key.len() + 2);
            at = past_spaces(text, after(text, at, b':')?);
            at = past_spaces(text, at + self.value(key, text.get(at..)?)?);
            match text.get(at)? {
                b',' => at = past_spaces(text, at + 1),
                b'}' => return Some(at + 1),
                _ => return None,
            }
        }
    }

    /// The value of `key` at the start of `text`; how many bytes it takes.
    fn value(&mut self, key: &str, text: &[u8]) -> Option<usize> {
        let node = self.node;
        let Some(child) = node.field(key) else {
            let mut values = Deserializer::from_slice(text).into_iter::<IgnoredAny>();
            values.next()?.ok()?;
            return Some(values.byte_offset());
        };
        if self.wants_array(child)
            && let Some((samples, used)) = plain_numbers(text)
        {
            self.below(child).fill(Want::Numbers, Value::Array(Samples::F64(samples)));
            return Some(used);
        }
        let mut below = self.below(child);
        if text.first() == Some(&b'{') && !below.wants(Want::Stamp) {
            return below.object(text);
        }
        let mut values = Deserializer::from_slice(text).into_iter::<&RawValue>();
        let value = values.next()?.ok()?;
        below.deserialize(&mut Deserializer::from_str(value.get())).ok()?;
        Some(values.byte_offset())
    }
}

/// The text in the quotes that `text` begins with, where nothing in it stands for something else.
fn plain_key(text: &[u8]) -> Option<&str> {
    let rest = text.strip_prefix(b"\"")?;
    let length = rest.iter().position(|&byte| byte == b'"' || byte == b'\\' || byte < b' ')?;
    let is_whole = rest.get(length) == Some(&b'"');
    is_whole.then(|| std::str::from_utf8(&rest[..length]).ok()).flatten()
}

/// The numbers of the array at the start of `text` and how many bytes it takes; `None` where it holds anything else.
pub(super) fn plain_numbers(text: &[u8]) -> Option<(Vec<f64>, usize)> {
    /// Characters of a number and its comma, as loggers write them; more room is taken as it is needed.
    const USUAL: usize = 8;
    let mut at = past_spaces(text, after(text, 0, b'[')?);
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

/// The place behind `byte`, which stands at `at`.
fn after(text: &[u8], at: usize, byte: u8) -> Option<usize> {
    (text.get(at) == Some(&byte)).then_some(at + 1)
}

/// The first place from `at` on that is no space of JSON.
fn past_spaces(text: &[u8], mut at: usize) -> usize {
    while matches!(text.get(at), Some(b' ' | b'\t' | b'\n' | b'\r')) {
        at += 1;
    }
    at
}
