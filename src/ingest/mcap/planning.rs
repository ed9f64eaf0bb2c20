//! Fields that are asked for, and what a message type holds beside them, to the plan of everything to fetch.

use super::path::{FieldPath, Step};
use super::plan::{AskedField, Beside, Field, Leaf, Plan, RATE_NAMES, STAMP_NAMES, Says, UNIT_NAMES, Want};
use crate::ingest::factors;
use crate::ingest::hdf5::names::{AttributeRole, role};
use crate::ingest::vocabulary::{self, Meaning};

/// So many fields are heeded for one signal besides stamps, units and rates: no message says more of its
/// samples.
const MOST_BESIDE: usize = 32;
/// Of those whose names say nothing.
const MOST_OTHERS: usize = 8;
/// So many fields of a message type are heeded: no sensor's message says more of its samples.
const MOST_TELLING: usize = 64;

impl Plan {
    /// The plan for what is asked of messages with such `leaves`, as far as these are known; other fields are
    /// looked for in each message, but for those that none of them `has`.
    pub(super) fn new(asked: &[AskedField], leaves: &[Leaf], has: impl Fn(&FieldPath) -> bool) -> Self {
        let (mut plan, telling) = (Self::default(), Telling::among(leaves));
        for asked in asked {
            let value = plan.slot(&asked.path, Want::Numbers);
            // A field may be named twice, and a key with dots reads like a field within another.
            if plan.fields.iter().any(|known| known.value == value) {
                continue;
            }
            if let Some((Step::Index(_), array)) = asked.path.0.split_last() {
                // An element is taken from its array once that is read.
                plan.slot(&FieldPath(array.to_vec()), Want::Numbers);
            }
            let beside = BesideField { asked, plan: &mut plan, telling: &telling, all: Vec::new() };
            let beside = beside.of(&has);
            plan.fields.push(Field { asked: asked.clone(), value, beside });
        }
        plan
    }
}

/// What stands beside the samples of a field, as it is planned.
struct BesideField<'a> {
    asked: &'a AskedField,
    plan: &'a mut Plan,
    telling: &'a [Telling],
    all: Vec<Beside>,
}

impl BesideField<'_> {
    /// All of it, the nearest first.
    fn of(mut self, has: impl Fn(&FieldPath) -> bool) -> Vec<Beside> {
        let asked = self.asked;
        asked.sensor.iter().for_each(|path| self.sensor(path));
        asked.times.iter().flatten().for_each(|path| self.time(path));
        for (level, message) in asked.path.enclosing().enumerate() {
            let named = |name: &str| Some(message.then(name)).filter(&has);
            let stamp = |names: &&[&str]| names.iter().fold(message.clone(), |path, name| path.then(name));
            for path in STAMP_NAMES.iter().filter(|_| asked.times.is_none()).map(stamp).filter(&has) {
                self.time(&path);
            }
            self.others(&message, level);
            for path in RATE_NAMES.into_iter().filter_map(named) {
                self.rate(&path, Meaning::Rate(1.0), level);
            }
            for path in UNIT_NAMES.into_iter().filter_map(named) {
                self.say(&path, Want::Text, Says::Unit);
            }
        }
        self.all
    }

    fn say(&mut self, path: &FieldPath, want: Want, says: Says) {
        let slot = self.plan.slot(path, want);
        let is_new = self.all.iter().all(|known| (known.slot, known.says) != (slot, says));
        // The paths of others are said in refusals.
        let has_path = |says: Says| !matches!(says, Says::Stamp | Says::Unit | Says::Rate { .. });
        let is_other = says == Says::Other;
        let is_alike = |known: &&Beside| has_path(known.says) && (known.says == Says::Other) == is_other;
        let (alike, most) = (self.all.iter().filter(is_alike).count(), [MOST_BESIDE, MOST_OTHERS]);
        if is_new && (!has_path(says) || alike < most[usize::from(is_other)]) {
            let name = || path.last_name().unwrap_or_default().to_owned();
            let field = if has_path(says) { path.to_string() } else { name() };
            self.all.push(Beside { slot, says, field });
        }
    }

    /// Takes the field at `path` for their time, be it a structure, words or a number.
    fn time(&mut self, path: &FieldPath) {
        self.say(path, Want::Stamp, Says::Stamp);
        self.say(path, Want::Numbers, Says::Time);
    }

    /// Takes the field at `path` for the name or number of their sensor.
    fn sensor(&mut self, path: &FieldPath) {
        for want in [Want::Text, Want::Numbers] {
            self.say(path, want, Says::Sensor);
        }
    }

    /// Takes the field at `path` for their rate or interval, in the unit that may stand beside it:
    /// `sample_rate_unit`.
    fn rate(&mut self, path: &FieldPath, meaning: Meaning, level: usize) {
        let name = path.last_name().unwrap_or_default();
        let is_unit = |other: &&Telling| {
            let unit = other.path.last_name().and_then(|unit| unit.strip_prefix(name));
            other.says == Says::Unit
                && other.path.enclosing().next() == path.enclosing().next()
                && matches!(unit, Some("_unit" | "_units"))
        };
        let unit = self.telling.iter().find(is_unit).map(|unit| self.plan.slot(&unit.path, Want::Text));
        self.say(path, Want::Numbers, Says::Rate { meaning, level, unit });
    }

    /// Takes the fields of a message that encloses the samples, so many `level`s above them, that say
    /// something of them.
    fn others(&mut self, message: &FieldPath, level: usize) {
        let asked = self.asked;
        // A number within a structure beside them may be of them too.
        let is_inner = |t: &Telling| {
            matches!(t.says, Says::Scale | Says::Conversion | Says::Factor | Says::Other)
                && t.message.0.len() == message.0.len() + 1
                && t.message.0.starts_with(&message.0)
        };
        let is_beside = |t: &&Telling| (t.message == *message || is_inner(t)) && t.path != asked.path;
        for telling in self.telling.iter().filter(is_beside) {
            let Telling { path, says, .. } = telling;
            match says {
                Says::Scale | Says::Conversion if telling.message != *message => {
                    self.say(path, Want::Numbers, Says::Factor);
                }
                Says::Sensor if asked.may_be_sensor(path) => self.sensor(path),
                Says::Time if asked.times.is_none() => self.time(path),
                Says::Rate { meaning, .. } => self.rate(path, *meaning, level),
                Says::Times if asked.times.is_some() => {}
                Says::Sensor | Says::Time | Says::Unit => {}
                says => self.say(path, Want::Numbers, *says),
            }
        }
    }
}

/// A field that says something of the samples in a message.
struct Telling {
    message: FieldPath,
    path: FieldPath,
    says: Says,
}

impl Telling {
    /// Those among the leaves of a message type, the first of them.
    fn among(leaves: &[Leaf]) -> Vec<Self> {
        let mut all: Vec<Self> = leaves.iter().filter_map(Self::of).collect();
        all.sort_by_key(|telling| telling.says == Says::Other);
        all.truncate(MOST_TELLING);
        all
    }

    fn of(leaf: &Leaf) -> Option<Self> {
        let path = FieldPath::parse(&leaf.path)?;
        let (Step::Name(name), mut message) = path.0.split_last()? else { return None };
        let mut says = Some(Says::of(name, leaf.is_signal));
        match message.split_last() {
            Some((Step::Name(header), outer)) if header == "header" => message = outer,
            // `std_msgs/MultiArrayLayout`, which stands beside its array.
            Some((Step::Name(layout), outer)) if layout == "layout" && name == "data_offset" => {
                let size = [Step::Name("dim".into()), Step::Index(1), Step::Name("size".into())];
                let path = FieldPath([message, &size].concat());
                return Some(Self { message: FieldPath(outer.to_vec()), path, says: Says::Turns });
            }
            _ => {}
        }
        if leaf.is_array {
            says = says.map(|says| if says == Says::Time { Says::Times } else { says });
            says = says.filter(|says| matches!(says, Says::Factor | Says::Times));
        }
        // The stamp of a header is known by its name.
        says = says.filter(|says| *says != Says::Time || message.len() + 1 == path.0.len());
        Some(Self { message: FieldPath(message.to_vec()), says: says?, path })
    }
}

impl Says {
    /// What a field of this name says; words and single bytes are no signal.
    fn of(name: &str, is_signal: bool) -> Self {
        match (role(name, 1), vocabulary::meaning(name)) {
            _ if vocabulary::is_sensor(name) => Self::Sensor,
            _ if !is_signal && (name.ends_with("_unit") || name.ends_with("_units")) => Self::Unit,
            _ if is_signal && vocabulary::is_named_time(name) && !STAMP_NAMES.contains(&&[name][..]) => {
                Self::Time
            }
            // Outside of NWB nothing defines it.
            _ if ["gain", "conversion"].contains(&name) => Self::Conversion,
            (Some(AttributeRole::Scale), _) => Self::Scale,
            (Some(AttributeRole::Offset), _) => Self::Offset,
            (Some(AttributeRole::Conversion), _) => Self::Conversion,
            (_, Some(Meaning::Count)) => Self::Count,
            (_, Some(meaning)) if !RATE_NAMES.contains(&name) => Self::Rate { meaning, level: 0, unit: None },
            _ if is_signal && factors::is_factor(name) => Self::Factor,
            _ => Self::Other,
        }
    }
}
