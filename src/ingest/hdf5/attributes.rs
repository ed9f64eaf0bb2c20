//! A column's attributes, or those of the groups above it, to rate, unit, start, scale and offset.

use super::super::time_reading::Scale;
use super::answer::{Object, Value as Held, decoded};
use super::dataset::Column;
use super::fault::Fault;
use super::rate::{self, Rival, Stated};
use crate::data::{Issue, IssueCode, Samples, Severity, acceleration_unit_m_s2};
use crate::ingest::time_base::RATE_TOLERANCE;

/// What the recording says of a column.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Attributes {
    /// Samples a second, or why what stands there is none; and what contradicts it.
    pub rate: Option<Stated>,
    /// A rate that a group farther off states, which is another.
    outer_rate: Option<Rival>,
    pub unit: Option<String>,
    pub start_s: Option<f64>,
    pub scale: Option<f64>,
    pub offset: Option<f64>,
    /// Stored values that stand for a missing sample.
    pub fills: Vec<f64>,
    /// What a scale or offset says that is no number.
    pub unclear: Option<String>,
    /// What a group farther off says otherwise of scale or offset.
    pub overridden: Vec<Issue>,
    /// Another unit than the one taken.
    pub other_unit: Option<Issue>,
}

const UNIT_NAMES: [&str; 2] = ["unit", "units"];
/// The second is that of the CF conventions of netCDF.
const SCALE_NAMES: [&str; 2] = ["scale", "scale_factor"];
/// As [`SCALE_NAMES`].
const OFFSET_NAMES: [&str; 2] = ["offset", "add_offset"];

/// As the CF conventions have them.
const FILL_NAMES: [&str; 2] = ["_FillValue", "missing_value"];

const START_NAME: &str = "start_time_s";

/// The attributes of a dataset or group.
pub(super) type Place = [(String, Held)];

/// Whether an attribute of this name says something of samples.
pub(super) fn is_read(name: &str) -> bool {
    let lists = [UNIT_NAMES, SCALE_NAMES, OFFSET_NAMES, FILL_NAMES];
    name == START_NAME || lists.iter().flatten().any(|known| *known == name) || rate::is_named(name)
}

impl Attributes {
    /// The nearest of each, from the dataset up to the root.
    pub(super) fn of(column: &Column) -> Self {
        let own = Self::own(&column.dataset.attributes, column);
        let mut attributes = Self { fills: fills(column), ..own };
        let mut group = column.group();
        loop {
            let path = if group.is_empty() { "/" } else { group };
            if let Object::Group { attributes: found, .. } = &*column.dataset.file.object(path) {
                attributes.fill(Self::own(found, column), path);
            }
            if group.is_empty() {
                return attributes;
            }
            group = group.rsplit_once('/').map_or("", |(parent, _)| parent);
        }
    }

    fn own(place: &Place, column: &Column) -> Self {
        let number = |name: &str| number(place, name, column);
        Self {
            rate: rate::stated(place, column),
            unit: UNIT_NAMES.iter().find_map(|name| text(place, name, column)),
            start_s: number(START_NAME),
            outer_rate: None,
            overridden: Vec::new(),
            other_unit: two_units(UNIT_NAMES.map(|name| text(place, name, column))),
            fills: Vec::new(),
            scale: SCALE_NAMES.iter().find_map(|name| number(name)),
            offset: OFFSET_NAMES.iter().find_map(|name| number(name)),
            unclear: SCALE_NAMES
                .iter()
                .chain(&OFFSET_NAMES)
                .find_map(|name| unclear(place, name, column))
                .or_else(|| twofold(SCALE_NAMES, number).or_else(|| twofold(OFFSET_NAMES, number))),
        }
    }

    /// Takes what nothing nearer says from the group at `path`, and keeps what that says otherwise.
    fn fill(&mut self, other: Self, path: &str) {
        if let (Some(near), Some(far)) = (&self.rate, &other.rate) {
            self.outer_rate = self.outer_rate.take().or(near.rival_of(far, path));
        }
        // A scale of 1 and an offset of 0 do nothing: they are what a writer puts where each dataset has its own.
        let pairs = [("scale", self.scale, other.scale, 1.0), ("offset", self.offset, other.offset, 0.0)];
        let apart = pairs.into_iter().filter_map(|(what, near, far, neutral)| {
            let (near, far) = (near?, far?);
            let is_idle = is_alike(far, neutral);
            (!is_alike(near, far))
                .then(|| overridden(path, what, &[near, far].map(|x| x.to_string()), is_idle))
        });
        self.overridden.extend(apart);
        if let (Some(near), Some(far)) = (&self.unit, &other.unit)
            && are_other_units(near, far)
        {
            // A wrong one is off by a factor of three and more, which no drop height or geometry bears.
            self.other_unit
                .get_or_insert_with(|| overridden(path, "unit", &[near, far].map(Clone::clone), true));
        }
        let is_none = |stated: &Stated| !stated.is_sure;
        self.rate = match self.rate.take() {
            near if near.as_ref().is_none_or(is_none) => other.rate.or(near),
            near => near,
        };
        self.unit = self.unit.take().or(other.unit);
        self.start_s = self.start_s.or(other.start_s);
        self.scale = self.scale.or(other.scale);
        self.offset = self.offset.or(other.offset);
        self.unclear = self.unclear.take().or(other.unclear);
    }

    /// A warning where the recording states another rate than the one that was taken.
    pub(super) fn other_rate(&self, taken_hz: f64) -> Option<Issue> {
        let stated_hz = self.sample_rate_hz()?;
        // Of two that contradict each other that says enough.
        let has_rival = self.rate.as_ref().is_some_and(|stated| stated.rival.is_some());
        (!has_rival && !self.agrees(taken_hz)).then(|| {
            let message = format!(
                "an attribute of the recording states {stated_hz} Hz, the samples were taken at {taken_hz:.6} Hz by the times or by sample_rate_hz of the cask file: one of the two is wrong, and every velocity goes with the rate"
            );
            Issue::new(IssueCode::Clock, Severity::Warning, message)
        })
    }

    /// What is done to the stored numbers, for people; empty where nothing is.
    pub(super) fn scaling(&self) -> String {
        let (scale, offset) = (self.scale.map(|s| format!(" × {s}")), self.offset.map(|o| format!(" {o:+}")));
        match (scale, offset) {
            (None, None) => String::new(),
            (scale, offset) => {
                format!(", value = stored{}{}", scale.unwrap_or_default(), offset.unwrap_or_default())
            }
        }
    }

    /// The rate that is stated, Hz.
    pub(super) fn sample_rate_hz(&self) -> Option<f64> {
        self.rate.as_ref().and_then(|stated| stated.rate.as_ref().ok()).map(|rate| rate.rate_hz)
    }

    /// Whether the rate that is stated is the one in Hz.
    pub(super) fn agrees(&self, taken_hz: f64) -> bool {
        self.sample_rate_hz().is_some_and(|stated_hz| (stated_hz / taken_hz - 1.0).abs() <= RATE_TOLERANCE)
    }

    /// A warning where two attributes of one place state different rates; where nothing else decides, also where two places do.
    fn rival(&self, is_decided: bool) -> Option<Issue> {
        let own = self.rate.as_ref()?.rival.as_ref();
        let rival = own.or(self.outer_rate.as_ref().filter(|_| !is_decided))?;
        let message = format!("{}; {}", rival.problem, rival.mend);
        Some(Issue::new(IssueCode::Clock, Severity::Warning, message))
    }

    /// All that they say twice and differently.
    pub(super) fn contradictions(&self, is_rate_decided: bool) -> Vec<Issue> {
        let others = self.overridden.iter().chain(&self.other_unit).cloned();
        self.rival(is_rate_decided).into_iter().chain(others).collect()
    }

    /// value = raw · scale + offset, NaN where raw stands for a missing sample.
    #[allow(clippy::cast_possible_truncation, reason = "f32 samples stay f32")]
    pub(super) fn scaled(&self, mut samples: Samples) -> Samples {
        #[allow(clippy::float_cmp, reason = "the very value that stands for nothing")]
        for &fill in &self.fills {
            match &mut samples {
                Samples::F32(v) => v.iter_mut().filter(|x| **x == fill as f32).for_each(|x| *x = f32::NAN),
                Samples::F64(v) => v.iter_mut().filter(|x| **x == fill).for_each(|x| *x = f64::NAN),
            }
        }
        if self.scale.is_none() && self.offset.is_none() {
            return samples;
        }
        let (scale, offset) = (self.scale.unwrap_or(1.0), self.offset.unwrap_or(0.0));
        match samples {
            Samples::F32(mut v) => {
                for x in &mut v {
                    *x = (f64::from(*x) * scale + offset) as f32;
                }
                Samples::F32(v)
            }
            Samples::F64(mut v) => {
                for x in &mut v {
                    *x = *x * scale + offset;
                }
                Samples::F64(v)
            }
        }
    }
}

/// What the numbers of a column of times count, and by what they are scaled and moved before, from its own attributes and name alone.
pub(super) fn time_scale(column: &Column) -> Result<(Scale, f64, f64), Fault> {
    // Those of records are for the samples in them.
    let own = match column.records() {
        Some(_) => Attributes::default(),
        None => Attributes::own(&column.dataset.attributes, column),
    };
    if let Some(problem) = &own.unclear {
        return Err(Fault {
            problem: format!("{}: {problem}", column.source()),
            mend: "correct the attribute in a copy, name another dataset of times, or give sample_rate_hz"
                .into(),
        });
    }
    let scale = Scale::of(column.bare_name(), own.unit.as_deref());
    if scale == Scale::Unknown {
        let unit = own.unit.unwrap_or_default();
        return Err(Fault {
            problem: format!("{} is in {unit:?}, which is no unit of time known here", column.source()),
            mend: "name a dataset of times in s, ms, us or ns, or give sample_rate_hz".into(),
        });
    }
    Ok((scale, own.scale.unwrap_or(1.0), own.offset.unwrap_or(0.0)))
}

/// The stored values that stand for a sample which is missing.
fn fills(column: &Column) -> Vec<f64> {
    if column.records().is_some() {
        return Vec::new();
    }
    FILL_NAMES.iter().filter_map(|name| number(&column.dataset.attributes, name, column)).collect()
}

/// The value for the column: that of its index where there is one a column, else the only one, as which several count that are the same.
fn pick<T: PartialEq>(mut values: Vec<T>, column: &Column) -> Option<T> {
    match (values.len(), column.index) {
        (count, Some(index)) if count == column.columns && index < count => Some(values.swap_remove(index)),
        (1.., _) if values.windows(2).all(|pair| pair[0] == pair[1]) => values.pop(),
        _ => None,
    }
}

fn attribute<'a>(place: &'a Place, name: &str) -> Option<&'a Held> {
    place.iter().find(|(there, _)| there == name).map(|(_, held)| held)
}

/// What an attribute holds for one column.
pub(super) enum Value {
    Number(f64),
    Text(String),
}

/// The attribute's value for the column: the only one, or that of its index.
pub(super) fn value(place: &Place, name: &str, column: &Column) -> Option<Value> {
    match attribute(place, name)? {
        Held::Numbers(numbers) => pick(numbers.clone(), column).map(Value::Number),
        Held::Texts(texts) => pick(texts.clone(), column).map(|text| Value::Text(decoded(&text))),
        Held::Other => None,
    }
}

fn number(place: &Place, name: &str, column: &Column) -> Option<f64> {
    match value(place, name, column)? {
        Value::Number(number) => Some(number),
        Value::Text(text) => text.trim().parse().ok(),
    }
    .filter(|value: &f64| value.is_finite())
}

/// What a scale or an offset says where it is no number. Names that are not of the CF conventions may hold words ("linear").
fn unclear(place: &Place, name: &str, column: &Column) -> Option<String> {
    attribute(place, name)?;
    let says = match value(place, name, column) {
        Some(Value::Number(number)) if number.is_finite() => return None,
        Some(Value::Number(number)) => number.to_string(),
        Some(Value::Text(text)) if text.trim().parse::<f64>().is_ok_and(f64::is_finite) => return None,
        Some(Value::Text(text)) => {
            let is_word = !text.trim_start().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
            if is_word && !name.contains('_') {
                return None;
            }
            format!("{text:?}")
        }
        None => format!("of another length than the {} channels", column.columns),
    };
    Some(format!(
        "the attribute {name}, by which its numbers are to be scaled, is {says}, which is no number"
    ))
}

/// That two attributes of one meaning say different things.
fn twofold(names: [&str; 2], number: impl Fn(&str) -> Option<f64>) -> Option<String> {
    let (one, other) = (number(names[0])?, number(names[1])?);
    (!is_alike(one, other)).then(|| {
        format!(
            "the attributes {} = {one} and {} = {other} contradict each other: by which its numbers are to be scaled is open",
            names[0], names[1]
        )
    })
}

fn is_alike(one: f64, other: f64) -> bool {
    /// Single precision keeps 6e-8 of a number.
    const ALIKE: f64 = 1e-6;
    (one - other).abs() <= ALIKE * one.abs().max(other.abs())
}

/// Whether both are units of acceleration, and different ones.
fn are_other_units(one: &str, other: &str) -> bool {
    let both = acceleration_unit_m_s2(one).zip(acceleration_unit_m_s2(other));
    both.is_some_and(|(one, other)| !is_alike(one, other))
}

/// That two attributes of one place state different units.
fn two_units([one, other]: [Option<String>; 2]) -> Option<Issue> {
    let (one, other) = (one?, other?);
    are_other_units(&one, &other).then(|| {
        let message = format!(
            "the attributes unit = {one:?} and units = {other:?} contradict each other; the first was taken: state `unit` in this channel of the cask file"
        );
        Issue::new(IssueCode::Scale, Severity::Warning, message)
    })
}

/// That a group states another scale, offset or unit than what stands nearer to the samples; a note where it can do no harm unseen.
///
/// It may be for other datasets. But nothing in a recording shows a scale that is some percent off, and k goes with it.
fn overridden(path: &str, what: &str, [near, far]: &[String; 2], is_harmless: bool) -> Issue {
    let message = format!(
        "the group {path} states the {what} {far}; nearer to the samples stands {near}, which was taken: one of the two is wrong, or the group's is \
         for other datasets; correct the wrong one in a copy, or delete that of the group where each dataset has its own"
    );
    let severity = if is_harmless { Severity::Note } else { Severity::Warning };
    Issue::new(IssueCode::Scale, severity, message)
}

fn text(place: &Place, name: &str, column: &Column) -> Option<String> {
    let Held::Texts(texts) = attribute(place, name)? else { return None };
    pick(texts.clone(), column)
        .map(|text| decoded(&text).trim().trim_end_matches('\0').to_owned())
        .filter(|text| !text.is_empty())
}
