//! The attributes of a column and of the groups above it to rates, unit, start, scale and offset: the nearest
//! of each.

use super::answer::{AttributeValue as Held, Object, decoded};
use super::column::DatasetColumn;
use super::names::{self, AttributeRole};
use super::starts::{self, start_s};
use crate::data::{AttributeFinding, Finding, Samples, acceleration_unit_m_s2};
use crate::ingest::factors;
use crate::ingest::refusal::Refusal;
use crate::ingest::statement::{Statement, number_and_unit};
use crate::ingest::vocabulary::Meaning;

/// More numbers of one attribute are no factors.
const MOST_NUMBERS: usize = 16;

/// What the recording says of a column.
#[derive(Debug, Clone, Default)]
pub(super) struct Attributes {
    /// The rates that are stated, nearest to the samples first.
    pub stated: Vec<Statement>,
    /// What an attribute says that should state a rate and states none, where none nearer does: `fs = 0`.
    pub no_rate: Option<String>,
    pub unit: Option<String>,
    /// Two units that one place states.
    pub two_units: Option<Refusal>,
    pub start: starts::Start,
    pub scale: Option<f64>,
    pub offset: Option<f64>,
    /// Numbers that may be factors of the samples, and are not applied.
    pub factors: Vec<String>,
    /// Stored values that stand for a missing sample.
    fills: Vec<f64>,
    /// What is added to stored numbers below zero.
    unsigned: f64,
    /// The least and the largest stored number that is a sample.
    valid: Option<(f64, f64)>,
    /// What groups farther off say otherwise.
    pub issues: Vec<Finding>,
}

/// What one attribute says of a column.
#[derive(Clone)]
struct Said {
    name: String,
    role: Option<AttributeRole>,
    /// The dataset or group that bears it.
    place: String,
    /// 0 of the dataset, 1 of its group, and so on up to the root.
    distance: usize,
    /// As text; `None` where it holds different values and none of them is the column's.
    value: Option<String>,
    /// As numbers, where it holds some.
    bounds: Vec<f64>,
}

impl Attributes {
    /// The nearest of each, from the dataset up to the root; `is_settled`: the cask file states the scale.
    ///
    /// # Errors
    /// A scale or offset is no number or stands twice in one place, or whole numbers are to be converted
    /// otherwise.
    pub(super) fn of(column: &DatasetColumn, is_settled: bool) -> Result<Self, Refusal> {
        let said = said(column);
        let mut attributes = Self::of_said(&said, column)?;
        if attributes.scale.is_none() {
            let open = said.iter().filter(|said| said.role.is_none());
            attributes.factors = open.filter_map(Said::as_factor).collect();
        }
        let are_counts = column.number.is_whole();
        let undone = said.iter().filter(|said| said.is_undone(are_counts));
        let undone: Vec<String> = undone.map(Said::shown).collect();
        if attributes.scale.is_none() && !is_settled && !undone.is_empty() {
            let what = if are_counts { "whole numbers are counts of the recorder," } else { "numbers are" };
            return Err(Refusal::new(
                format!("its {what} to be converted by {}, which is not done here", undone.join(", ")),
                "write into this [[channel]] of the cask file what the numbers are to be multiplied by to be \
                 in `unit`, such as scale = 0.9, or scale = 1 where they are converted already; in a copy \
                 the dataset may have attributes scale and offset: value = raw · scale + offset",
            ));
        }
        Ok(attributes)
    }

    /// Of the dataset alone. Those of records are for the samples in them, not for the times.
    ///
    /// # Errors
    /// As [`Attributes::of`].
    pub(super) fn own(column: &DatasetColumn) -> Result<Self, Refusal> {
        let mut said = if column.is_field() { Vec::new() } else { said(column) };
        said.retain(|said| said.distance == 0);
        Self::of_said(&said, column)
    }

    fn of_said(said: &[Said], column: &DatasetColumn) -> Result<Self, Refusal> {
        use AttributeRole::{Fill, Offset, OpenStart, Scale, Start, Unit};
        let mut all = Self::default();
        let with = |role: AttributeRole| said.iter().filter(move |said| said.role == Some(role));
        let numbers = |role: AttributeRole| -> Result<Vec<(f64, &Said)>, Refusal> {
            with(role).filter_map(|said| Some(said.number(column).transpose()?.map(|x| (x, said)))).collect()
        };
        let is_same = |near: &f64, far: &f64| is_alike(*near, *far);
        // A scale of 1 and an offset of 0 do nothing: they are what a writer puts where each dataset has its
        // own.
        all.scale = all.nearest(numbers(Scale)?, is_same, |far| is_alike(*far, 1.0))?;
        all.offset = all.nearest(numbers(Offset)?, is_same, |far| is_alike(*far, 0.0))?;
        let own = said.iter().filter(|said| said.name == "start_time_s").take(1);
        let others = said.iter().filter(|said| matches!(said.role, Some(Start | OpenStart)));
        let starts: Vec<&Said> = if own.clone().count() > 0 { own.collect() } else { others.collect() };
        for said in starts {
            let at_s =
                said.value.as_deref().and_then(|text| start_s(&said.name, text, said.role == Some(Start)));
            all.start.note(at_s, said.shown());
        }
        let units =
            with(Unit).filter_map(|said| Some((said.value.clone().filter(|unit| !unit.is_empty())?, said)));
        // A wrong unit is off by a factor of three and more, which no drop height or geometry bears.
        match all.nearest(units.collect(), |near, far| !are_other_units(near, far), |_| true) {
            Ok(unit) => all.unit = unit,
            Err(two) => {
                let remedy = "write `unit` into this channel of the cask file";
                all.two_units = Some(Refusal::new(two.problem, remedy));
            }
        }
        if !column.is_field() {
            let own = with(Fill).filter(|said| said.distance == 0);
            all.fills = own.filter_map(|said| said.number(column).ok().flatten()).collect();
        }
        let own = |role: AttributeRole| with(role).filter(|said| said.distance == 0);
        let is_true =
            |said: &Said| said.value.as_deref().is_some_and(|word| word.eq_ignore_ascii_case("true"));
        if own(AttributeRole::Unsigned).any(is_true) && column.number.is_whole() {
            all.unsigned = 2_f64.powi(8 * i32::try_from(column.number.bytes()).unwrap_or_default());
        }
        let bounds = own(AttributeRole::Valid).map(|said| (said.name.to_lowercase(), said.bounds.clone()));
        for (name, numbers) in bounds.filter(|(_, numbers)| numbers.iter().all(|number| number.is_finite())) {
            let (low, high) = all.valid.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            all.valid = match (&numbers[..], name.ends_with("max")) {
                (&[least, most], _) if least < most => Some((least, most)),
                (&[most], true) => Some((low, most)),
                (&[least], false) if name.ends_with("min") => Some((least, high)),
                _ => all.valid,
            };
        }
        for said in said {
            let Some(meaning) = names::rate_meaning(&said.name) else { continue };
            let stated = said.value.as_ref().and_then(|value| Statement::of(&said.name, value, meaning));
            match stated {
                Some(mut stated) => {
                    if said.distance > 0 {
                        stated.place.push_str(" of the group ");
                        stated.place.push_str(&said.place);
                    }
                    all.stated.push(stated.at(said.distance));
                }
                None if all.stated.is_empty() && all.no_rate.is_none() => {
                    all.no_rate = Some(format!("the attribute {} is no rate or interval", said.shown()));
                }
                None => {}
            }
        }
        Ok(all)
    }

    /// The nearest of some values; one finding where another farther off differs, a note where that can do no
    /// harm unseen.
    ///
    /// What a group states may be for other datasets. But nothing in a recording shows a scale that is some
    /// percent off, and k goes with it.
    ///
    /// # Errors
    /// Two of one place differ.
    fn nearest<T>(
        &mut self,
        found: Vec<(T, &Said)>,
        is_same: fn(&T, &T) -> bool,
        is_harmless: fn(&T) -> bool,
    ) -> Result<Option<T>, Refusal> {
        let mut found = found.into_iter();
        let Some((taken, near)) = found.next() else { return Ok(None) };
        let Some((other, far)) = found.find(|(other, _)| !is_same(&taken, other)) else {
            return Ok(Some(taken));
        };
        if near.distance == far.distance {
            return Err(Refusal::new(
                format!("the attributes {} and {} contradict each other", near.shown(), far.shown()),
                "correct one in a copy, or delete it",
            ));
        }
        let (group, is_harmless) = (far.place.clone(), is_harmless(&other));
        let (stated, nearer) = (far.shown(), near.shown());
        self.issues.push(AttributeFinding::GroupDiffers { group, stated, nearer, is_harmless }.into());
        Ok(Some(taken))
    }

    /// What is done to the stored numbers, for people; empty where nothing is.
    pub(super) fn scaling(&self) -> String {
        let scale = self.scale.map_or_else(String::new, |scale| format!(" × {scale}"));
        let change = self.offset.map_or(scale.clone(), |offset| format!("{scale} {offset:+}"));
        if change.is_empty() { change } else { format!(", value = stored{change}") }
    }

    /// value = raw · scale + offset, NaN where raw stands for a missing sample.
    pub(super) fn scaled(&self, mut samples: Samples) -> Samples {
        let fills = samples.match_precision(self.fills.clone()).into_f64();
        let (scale, offset) = (self.scale.unwrap_or(1.0), self.offset.unwrap_or(0.0));
        let is_scaled = self.scale.is_some() || self.offset.is_some();
        let (least, most) = self.valid.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let plain = |x: f64| if x < 0.0 { x + self.unsigned } else { x };
        if is_scaled || !fills.is_empty() || self.valid.is_some() || self.unsigned > 0.0 {
            samples.change(|x| match plain(x) {
                _ if fills.contains(&x) => f64::NAN,
                x if x < least || x > most => f64::NAN,
                x if is_scaled => x * scale + offset,
                x => x,
            });
        }
        samples
    }
}

/// All that attributes say of a column, nearest first, of one place rates before intervals: an interval is
/// rounded more often.
fn said(column: &DatasetColumn) -> Vec<Said> {
    let mut all = Vec::new();
    let (mut place, mut distance) = (column.path.as_str(), 0);
    loop {
        let path = if place.is_empty() { "/" } else { place };
        let object = column.file.object(path);
        let attributes = match &*object {
            Object::Dataset(dataset) => &dataset.attributes[..],
            Object::Group { attributes, .. } => attributes,
            _ => &[],
        };
        all.extend(attributes.iter().map(|(name, held)| Said {
            name: name.clone(),
            role: names::role(name, distance),
            place: path.to_owned(),
            distance,
            value: column.own_of(held),
            bounds: match held {
                Held::Numbers(numbers) if numbers.len() <= MOST_NUMBERS => numbers.clone(),
                _ => Vec::new(),
            },
        }));
        let Some((above, _)) = place.rsplit_once('/') else { break };
        (place, distance) = (above, distance + 1);
    }
    // No place states the units of more than 64.
    let units: Vec<Said> =
        all.iter().filter(|said| names::ends_in_unit(&said.name)).take(64).cloned().collect();
    for said in all.iter_mut().filter(|said| said.takes_unit()) {
        let is_its = |unit: &&Said| {
            (unit.distance, true) == (said.distance, names::is_unit_of(&unit.name, &said.name))
        };
        let unit = units.iter().find(is_its).and_then(|unit| unit.value.as_deref()).unwrap_or_default();
        said.value = said.value.take().map(|value| format!("{value} {unit}").trim_end().to_owned());
    }
    let is_interval = |said: &Said| matches!(names::rate_meaning(&said.name), Some(Meaning::Interval(_)));
    all.sort_by_key(|said| (said.distance, is_interval(said)));
    all
}

impl DatasetColumn {
    /// The column's value of an attribute: that of its index where there is one a column, else the only one.
    fn own_of(&self, held: &Held) -> Option<String> {
        let place = |count| if count == 1 { Some(0) } else { (count == self.columns).then_some(self.index) };
        match held {
            Held::Numbers(numbers) => Some(numbers[place(numbers.len())?].to_string()),
            Held::Texts(texts) => {
                Some(decoded(&texts[place(texts.len())?]).trim_end_matches('\0').trim().to_owned())
            }
            Held::Other => None,
        }
    }
}

impl Said {
    /// Whether it is a rate, an interval or a start that is a bare number.
    fn takes_unit(&self) -> bool {
        (names::rate_meaning(&self.name).is_some() || self.role == Some(AttributeRole::OpenStart))
            && self.value.as_ref().is_some_and(|value| value.parse::<f64>().is_ok())
    }

    /// Whether it is a conversion that is to be done and is not: a factor of 1 and an offset of 0 do nothing,
    /// and of samples that are no counts it is a number, or several, and no date.
    fn is_undone(&self, are_counts: bool) -> bool {
        use AttributeRole::{Conversion, CountsConversion};
        let is_idle = |(number, unit): (&str, &str)| {
            matches!(number.parse(), Ok(0.0 | 1.0)) || !are_counts && unit.starts_with(['-', '/', '.', ':'])
        };
        match (self.role, self.value.as_deref().map(number_and_unit)) {
            (Some(Conversion), Some(Some(number))) => !is_idle(number),
            (Some(Conversion), None) => true,
            (role, _) => are_counts && matches!(role, Some(Conversion | CountsConversion)),
        }
    }

    /// `counts_to_g = 0.9`, where that may be a factor of the samples.
    fn as_factor(&self) -> Option<String> {
        let is_rate = names::rate_meaning(&self.name).is_some();
        if is_rate || names::ends_in_unit(&self.name) {
            return None;
        }
        let Some(value) = &self.value else {
            let is_open = |number: &f64| factors::unexplained(&self.name, &number.to_string()).is_some();
            let is_factor = factors::is_factor(&self.name) || self.bounds.iter().any(is_open);
            return is_factor.then(|| self.shown());
        };
        factors::unexplained(&self.name, value)
    }

    /// `scale = 0.5`.
    fn shown(&self) -> String {
        format!("{} = {}", self.name, self.value.as_deref().unwrap_or("[different values]"))
    }

    /// The number; `None` where a name that is of no convention holds a word, as in `scale = linear`.
    ///
    /// # Errors
    /// It is no finite number: `scale_factor = 1,05`.
    fn number(&self, column: &DatasetColumn) -> Result<Option<f64>, Refusal> {
        let text = self.value.as_deref().unwrap_or_default();
        let is_word =
            text.starts_with(char::is_alphabetic) && ["scale", "offset"].contains(&self.name.as_str());
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => return Ok(Some(number)),
            Err(_) if is_word => return Ok(None),
            _ => {}
        }
        let count = column.columns;
        Err(Refusal::new(
            format!(
                "the attribute {}, by which its numbers are to be read, is no number for each of {count} \
                 channel(s)",
                self.shown()
            ),
            "correct the attribute in a copy, or write the channel with its scale as a dataset of numbers",
        ))
    }
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
