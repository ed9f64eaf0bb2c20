//! Wanted fields of a message type to one tree of everything to fetch: the samples, their stamp, rate and
//! unit.

use super::path::{FieldPath, Step};
use crate::data::Samples;
use crate::ingest::statement::Statement;
use crate::ingest::vocabulary::Meaning;
use std::sync::Arc;

/// Names under which a message states the time of its first sample; nanoseconds follow as a structure.
pub(super) const STAMP_NAMES: [&[&str]; 3] = [&["timestamp"], &["header", "stamp"], &["stamp"]];
/// Names under which a message states the rate of its samples, Hz; the last are those of protobuf in JSON.
#[rustfmt::skip]
pub(super) const RATE_NAMES: [&str; 8] = [
    "sample_rate_hz", "sample_rate", "fs", "sampling_rate_hz", "sampling_rate", "fs_hz",
    "sampleRateHz", "sampleRate",
];
/// Names under which a message states their unit.
pub(super) const UNIT_NAMES: [&str; 2] = ["unit", "units"];
/// Names of the whole seconds of a time.
pub(super) const SECONDS_NAMES: [&str; 4] = ["sec", "seconds", "secs", "s"];
/// Names of the nanoseconds of a time.
pub(super) const NANOSECONDS_NAMES: [&str; 5] = ["nsec", "nanosec", "nanos", "nsecs", "nanoseconds"];

/// What a slot takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Want {
    /// A number or an array of numbers.
    Numbers,
    /// A time.
    Stamp,
    /// Words.
    Text,
}

/// A place in the tree of wanted fields.
#[derive(Debug, Default, Clone)]
pub(super) struct Node {
    /// The slots that are filled here, one for each [`Want`].
    slots: [Option<usize>; 3],
    /// What lies below.
    pub(super) children: Vec<(Step, Node)>,
}

impl Node {
    /// The child field `name`.
    pub(super) fn field(&self, name: &str) -> Option<&Self> {
        let is_it = |(step, _): &&(Step, Self)| matches!(step, Step::Name(own) if own == name);
        self.children.iter().find(is_it).map(|(_, node)| node)
    }

    /// The field that a key with dots means, whose path reads like that of a field within others.
    pub(super) fn below(&self, key: &str) -> Option<&Self> {
        if key.contains('.') { key.split('.').try_fold(self, |node, name| node.field(name)) } else { None }
    }

    /// The child elements with their places.
    pub(super) fn indexed(&self) -> impl Iterator<Item = (usize, &Self)> {
        self.children.iter().filter_map(|(step, node)| match step {
            Step::Index(index) => Some((*index, node)),
            Step::Name(_) => None,
        })
    }

    /// The child element `index`.
    pub(super) fn element(&self, index: usize) -> Option<&Self> {
        self.indexed().find(|(own, _)| *own == index).map(|(_, node)| node)
    }

    /// The slot of this place that takes `want`.
    pub(super) fn slot(&self, want: Want) -> Option<usize> {
        self.slots[want as usize]
    }

    /// The numbers wanted of an array here: index and slot.
    pub(super) fn elements(&self) -> Vec<(usize, usize)> {
        self.indexed().filter_map(|(index, node)| Some((index, node.slot(Want::Numbers)?))).collect()
    }

    fn at(&mut self, path: &FieldPath) -> &mut Self {
        let mut node = self;
        for step in &path.0 {
            let position = node.children.iter().position(|(own, _)| own == step).unwrap_or_else(|| {
                node.children.push((step.clone(), Self::default()));
                node.children.len() - 1
            });
            node = &mut node.children[position].1;
        }
        node
    }
}

/// What a field says of the samples beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Says {
    /// Their time, as a structure or in words.
    Stamp,
    /// Their time, as a number.
    Time,
    /// The time of each of an array of samples.
    Times,
    /// By what they are to be multiplied.
    Scale,
    /// What is to be added to them.
    Offset,
    /// A conversion that is not made here.
    Conversion,
    /// By what they may be meant to be multiplied.
    Factor,
    /// How many numbers of the array are samples.
    Count,
    /// How many signals stand in the array by turns.
    Turns,
    /// Which sensor they are of.
    Sensor,
    /// Their rate or interval, so many messages above them, in the unit that may stand in a slot.
    Rate { meaning: Meaning, level: usize, unit: Option<usize> },
    /// Their unit, or that of a rate.
    Unit,
    /// Nothing by its name; its numbers may count them, or be one factor of all.
    Other,
}

/// A field that says something of the samples beside it.
#[derive(Debug, Clone)]
pub(super) struct Beside {
    pub(super) slot: usize,
    pub(super) says: Says,
    /// Its path in the message; of a stamp, a unit or a rate its name alone.
    pub(super) field: String,
}

/// A field that is asked for, with what the cask file says of it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AskedField {
    pub(super) path: FieldPath,
    /// Whether it is an array, as its schema or first message says; of no meaning where a cask file names it.
    pub(super) is_array: bool,
    /// The fields that may be its time, where the cask file names it; none for the log time.
    pub(super) times: Option<Vec<FieldPath>>,
    /// The field that says which sensor a message is of, where the cask file names it.
    pub(super) sensor: Option<FieldPath>,
    /// Whether the cask file states its scale.
    pub(super) is_scaled: bool,
}

impl AskedField {
    /// Whether the field at `path` may say which sensor a message is of: the one that the cask file names, be
    /// it by its last name.
    pub(super) fn may_be_sensor(&self, path: &FieldPath) -> bool {
        self.sensor.as_ref().is_none_or(|named| named.0.len() == 1 && named.last_name() == path.last_name())
    }

    /// Of which nothing more is said.
    pub(super) fn plain(path: FieldPath) -> Self {
        Self { path, is_array: false, times: None, sensor: None, is_scaled: false }
    }
}

/// A field that is fetched, and the slots of what belongs to it.
#[derive(Debug, Clone)]
pub(super) struct Field {
    pub(super) asked: AskedField,
    /// The slot of its samples.
    pub(super) value: usize,
    /// What stands beside its samples, the nearest first.
    pub(super) beside: Vec<Beside>,
}

/// A rate or an interval that a message states.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StatedRate {
    /// Of its field.
    pub(super) name: Arc<str>,
    pub(super) meaning: Meaning,
    /// How many messages lie between that field and the samples.
    pub(super) level: usize,
    /// As it stands there, with the unit beside it.
    pub(super) value: f64,
    pub(super) unit: Option<Arc<str>>,
}

impl StatedRate {
    /// As a statement; an interval without a unit is in the one in which it agrees with the rate at which the
    /// samples came, `told_hz`, and in seconds where it does in none.
    pub(super) fn statement(&self, told_hz: f64) -> Option<Statement> {
        /// Units are a thousandfold apart.
        const ALIKE: f64 = 0.1;
        let statement =
            |unit: &str| Statement::of(&self.name, format!("{} {unit}", self.value).trim(), self.meaning);
        let is_bare = self.unit.is_none() && self.meaning == Meaning::Interval(1.0);
        let is_told = |stated: &Statement| (stated.rate_hz / told_hz - 1.0).abs() < ALIKE;
        let as_told = || ["s", "ms", "us", "ns"].into_iter().filter_map(statement).find(is_told);
        let told = if is_bare { as_told() } else { None };
        told.or_else(|| statement(self.unit.as_deref().unwrap_or_default()))
    }
}

/// Everything to fetch from the messages of one channel.
#[derive(Debug, Default, Clone)]
pub(super) struct Plan {
    pub(super) root: Node,
    /// How many slots there are.
    pub(super) count: usize,
    /// What is asked for, in the order given.
    pub(super) fields: Vec<Field>,
}

impl Plan {
    /// The slot of a field.
    pub(super) fn slot(&mut self, path: &FieldPath, want: Want) -> usize {
        let slot = &mut self.root.at(path).slots[want as usize];
        *slot.get_or_insert_with(|| {
            self.count += 1;
            self.count - 1
        })
    }
}

/// What a message gave for one slot.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) enum Value {
    /// The message has no such field.
    #[default]
    Missing,
    /// One number; `is_narrow` where f32 holds every value of its type.
    Number { value: f64, is_narrow: bool },
    /// An array of numbers.
    Array(Samples),
    /// A time, ns since 1970; 0 where it is not set.
    Stamp(i64),
    /// A time that could not be understood.
    BadStamp,
    /// Words.
    Text(Arc<str>),
}

/// What a message gave, slot by slot.
#[derive(Debug, Default)]
pub(super) struct Slots {
    pub(super) values: Vec<Value>,
    /// Words of earlier messages: most say the same again.
    words: Vec<Arc<str>>,
}

impl Slots {
    /// Empties all slots, `count` of them.
    pub(super) fn clear(&mut self, count: usize) {
        self.values.clear();
        self.values.resize(count, Value::Missing);
    }

    /// Fills one; the last of a field that comes twice stands.
    pub(super) fn set(&mut self, slot: usize, value: Value) {
        if let Some(place) = self.values.get_mut(slot) {
            *place = value;
        }
    }

    /// Fills one with words.
    pub(super) fn set_text(&mut self, slot: usize, text: &[u8]) {
        /// More words that differ change with every message.
        const MOST_WORDS: usize = 8;
        let known = self.words.iter().find(|known| known.as_bytes() == text).cloned();
        let words = known.unwrap_or_else(|| {
            let new: Arc<str> = String::from_utf8_lossy(text).into();
            self.words.truncate(MOST_WORDS - 1);
            self.words.insert(0, new.clone());
            new
        });
        self.set(slot, Value::Text(words));
    }

    /// Fills the slots of single elements from the array in `array_slot`.
    pub(super) fn pick(&mut self, array_slot: usize, elements: &[(usize, usize)]) {
        for &(index, slot) in elements {
            if let Some(Value::Array(samples)) = self.values.get(array_slot)
                && index < samples.len()
            {
                let (value, is_narrow) = (samples.get(index), matches!(samples, Samples::F32(_)));
                self.set(slot, Value::Number { value, is_narrow });
            }
        }
    }

    /// The samples of `field`, an array out of its slot; a number may say something of others.
    pub(super) fn samples(&mut self, field: &Field) -> Value {
        match self.values.get_mut(field.value) {
            Some(number @ Value::Number { .. }) => number.clone(),
            Some(value) => std::mem::take(value),
            None => Value::Missing,
        }
    }
}

/// Nanoseconds since 1970 from whole seconds and nanoseconds; saturates beyond the years that fit.
pub(super) fn unix_ns(seconds: i64, nanoseconds: i64) -> i64 {
    seconds.saturating_mul(1_000_000_000).saturating_add(nanoseconds)
}

/// A message with more numeric fields is no recording of sensors; each is looked for in every message.
pub(super) const MOST_LEAVES: usize = 2000;
/// What lies below a longer path has none that a person would write; each of its fields would repeat it.
pub(super) const LONGEST_PATH_BYTES: usize = 1024;

/// A field that a message type has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Leaf {
    /// Its path, as in a `source`.
    pub(super) path: String,
    /// Whether it is an array.
    pub(super) is_array: bool,
    /// Whether it may be a signal; words and single bytes are none, though they may say something of one.
    pub(super) is_signal: bool,
}

impl Leaf {
    /// Whether it is words, a byte, the rate or the covariance of other fields rather than a signal.
    pub(super) fn is_about_others(&self) -> bool {
        if !self.is_signal {
            return true;
        }
        let last = self.path.rsplit('.').next().unwrap_or_default();
        RATE_NAMES.contains(&last) || last.ends_with("covariance")
    }
}

/// Turns one message into slots.
pub(super) trait Decode: Send + Sync {
    /// Fills `slots`, cleared before, from `data`.
    ///
    /// # Errors
    /// Why the message does not decode; the slots are then worth nothing.
    fn decode(&self, data: &[u8], slots: &mut Slots) -> Result<(), String>;
}
