//! Wanted fields of a message type to one tree of everything to fetch: the samples, their stamp, rate and unit.

use super::path::{FieldPath, Step};
use crate::data::Samples;

/// Names under which a message states the time of its first sample; nanoseconds follow as a structure.
const STAMP_NAMES: [&[&str]; 3] = [&["timestamp"], &["header", "stamp"], &["stamp"]];
/// Names under which a message states the rate of its samples, Hz.
pub(super) const RATE_NAMES: [&str; 8] = [
    "sample_rate_hz",
    "sample_rate",
    "fs",
    "sampling_rate_hz",
    "sampling_rate",
    "fs_hz",
    // As protobuf and others write them into JSON.
    "sampleRateHz",
    "sampleRate",
];
/// Names under which a message states their unit.
const UNIT_NAMES: [&str; 2] = ["unit", "units"];
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
    /// Slots that are filled here.
    pub(super) slots: Vec<usize>,
    /// What lies below.
    pub(super) children: Vec<(Step, Node)>,
}

impl Node {
    /// The child field `name`.
    pub(super) fn field(&self, name: &str) -> Option<&Self> {
        self.children
            .iter()
            .find(|(step, _)| matches!(step, Step::Name(own) if own == name))
            .map(|(_, node)| node)
    }

    /// The child element `index`.
    pub(super) fn element(&self, index: usize) -> Option<&Self> {
        self.children.iter().find(|(step, _)| *step == Step::Index(index)).map(|(_, node)| node)
    }

    /// The slot of this place that takes `want`.
    pub(super) fn slot(&self, wants: &[Want], want: Want) -> Option<usize> {
        self.slots.iter().copied().find(|&slot| wants.get(slot) == Some(&want))
    }

    /// The numbers wanted of an array here: index and slot.
    pub(super) fn elements(&self, wants: &[Want]) -> Vec<(usize, usize)> {
        self.children
            .iter()
            .filter_map(|(step, node)| match step {
                Step::Index(index) => node.slot(wants, Want::Numbers).map(|slot| (*index, slot)),
                Step::Name(_) => None,
            })
            .collect()
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

/// The slots that belong to one wanted field, each list by preference.
#[derive(Debug, Clone)]
pub(super) struct Target {
    /// Its samples.
    pub(super) value: usize,
    stamps: Vec<usize>,
    /// Slots with what they state, those of a message one after another.
    rates: Vec<(usize, StatedRate)>,
    units: Vec<usize>,
}

/// A rate that a message states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StatedRate {
    /// Of its field.
    pub(super) name: &'static str,
    /// How many messages lie between that field and the samples.
    pub(super) level: usize,
    /// As it stands there.
    pub(super) hz: f64,
}

/// Everything to fetch from the messages of one channel.
#[derive(Debug, Default, Clone)]
pub(super) struct Plan {
    pub(super) root: Node,
    /// What each slot takes.
    pub(super) wants: Vec<Want>,
    /// One for each wanted field, in the order given.
    pub(super) targets: Vec<Target>,
}

impl Plan {
    /// The plan for `fields`.
    pub(super) fn new(fields: &[FieldPath]) -> Self {
        let mut plan = Self::default();
        for field in fields {
            let value = plan.slot(field, Want::Numbers);
            if let Some((Step::Index(_), array)) = field.0.split_last() {
                // An element is taken from its array once that is read.
                plan.slot(&FieldPath(array.to_vec()), Want::Numbers);
            }
            let mut target = Target { value, stamps: Vec::new(), rates: Vec::new(), units: Vec::new() };
            for (level, message) in field.enclosing().enumerate() {
                for names in STAMP_NAMES {
                    let path = names.iter().fold(message.clone(), |path, name| path.then(name));
                    target.stamps.push(plan.slot(&path, Want::Stamp));
                }
                target.rates.extend(RATE_NAMES.map(|name| {
                    let stated = StatedRate { name, level, hz: f64::NAN };
                    (plan.slot(&message.then(name), Want::Numbers), stated)
                }));
                target.units.extend(UNIT_NAMES.map(|name| plan.slot(&message.then(name), Want::Text)));
            }
            plan.targets.push(target);
        }
        plan
    }

    fn slot(&mut self, path: &FieldPath, want: Want) -> usize {
        let node = self.root.at(path);
        let wants = &self.wants;
        if let Some(slot) = node.slots.iter().copied().find(|&slot| wants.get(slot) == Some(&want)) {
            return slot;
        }
        let slot = self.wants.len();
        node.slots.push(slot);
        self.wants.push(want);
        slot
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
    Text(String),
}

/// What a message gave, slot by slot.
#[derive(Debug, Default)]
pub(super) struct Slots {
    pub(super) values: Vec<Value>,
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

    /// Fills the slots of single elements from the array in `array_slot`.
    pub(super) fn pick(&mut self, array_slot: usize, elements: &[(usize, usize)]) {
        for &(index, slot) in elements {
            let value = match self.values.get(array_slot) {
                Some(Value::Array(Samples::F32(samples))) => {
                    samples.get(index).map(|&x| (f64::from(x), true))
                }
                Some(Value::Array(Samples::F64(samples))) => samples.get(index).map(|&x| (x, false)),
                _ => None,
            };
            if let Some((value, is_narrow)) = value {
                self.set(slot, Value::Number { value, is_narrow });
            }
        }
    }

    /// Takes the samples of `target` out of their slot.
    pub(super) fn samples(&mut self, target: &Target) -> Value {
        self.values.get_mut(target.value).map(std::mem::take).unwrap_or_default()
    }

    /// The stamp that stands nearest to the field of `target`; `Missing` where none does.
    pub(super) fn stamp(&self, target: &Target) -> Value {
        self.first(&target.stamps, |value| matches!(value, Value::Stamp(_) | Value::BadStamp))
    }

    /// The rates that the message states for the field of `target`, the nearest first, whatever their values.
    pub(super) fn rates<'a>(&'a self, target: &'a Target) -> impl Iterator<Item = StatedRate> + 'a {
        target.rates.iter().filter_map(|&(slot, stated)| match self.values.get(slot) {
            Some(Value::Number { value, .. }) => Some(StatedRate { hz: *value, ..stated }),
            _ => None,
        })
    }

    /// The unit stated nearest to the field of `target`.
    pub(super) fn unit(&self, target: &Target) -> Option<&str> {
        target.units.iter().find_map(|&slot| match self.values.get(slot) {
            Some(Value::Text(text)) if !text.trim().is_empty() => Some(text.as_str()),
            _ => None,
        })
    }

    fn first(&self, slots: &[usize], fits: impl Fn(&Value) -> bool) -> Value {
        slots
            .iter()
            .filter_map(|&slot| self.values.get(slot))
            .find(|value| fits(value))
            .cloned()
            .unwrap_or_default()
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
}

impl Leaf {
    /// Whether it is the rate or the covariance of other fields rather than a signal.
    pub(super) fn is_about_others(&self) -> bool {
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
