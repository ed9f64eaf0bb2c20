//! The times beside a channel, by their names, to seconds.

use super::answer::{Object, decoded};
use super::attributes::Attributes;
use super::column::DatasetColumn;
use super::fault::Fault;
use super::{find, names};
use crate::data::{Finding, Samples};
use crate::ingest::clock::{Clock, Refusal};
use crate::ingest::times::{Carrier, Scale, seconds_a_unit};

/// Names that go before others.
const FIRST_NAMES: [&str; 6] = ["time_s", "time", "t", "times", "timestamps", "Time"];

/// No recording has more times beside a channel; each costs a look through the channels of its dataset.
const MOST_TIMES: usize = 64;

/// The times in the group or the records that were asked for last, by their names: channels come in the order of the file.
#[derive(Default)]
pub(super) struct Clocks {
    place: Option<String>,
    times: Vec<DatasetColumn>,
}

impl Clocks {
    /// The times of a channel, likeliest first: fields of the same records, else datasets beside it, that have a usual name and as many values.
    pub(super) fn of(&mut self, column: &DatasetColumn) -> Vec<DatasetColumn> {
        let is_apart =
            |times: &&DatasetColumn| times.length == column.length && times.source != column.source;
        let records = column.is_field().then(|| format!("{}.", column.path));
        for place in records.into_iter().chain([format!("{}/", column.group())]) {
            if self.place.as_ref() != Some(&place) {
                let named = sources(&place, column).into_iter();
                self.times = named.filter_map(|source| find::find(&column.file, &source).ok()?).collect();
                self.place = Some(place);
            }
            let found: Vec<DatasetColumn> = self.times.iter().filter(is_apart).cloned().collect();
            if !found.is_empty() {
                return found;
            }
        }
        Vec::new()
    }
}

/// Why a channel has no times: what is named as times beside it, and is none of its own.
pub(super) fn why_none(column: &DatasetColumn) -> String {
    let sources = sources(&format!("{}/", column.group()), column);
    let others = sources.iter().filter(|source| **source != column.source);
    let mut reasons = others.filter_map(|source| match find::find(&column.file, source) {
        Ok(times) => Some(format!("{source} holds {} times for {} samples", times?.length, column.length)),
        Err(fault) => Some(fault.to_string()),
    });
    reasons.next().unwrap_or_else(|| "no dataset of times beside it".into())
}

/// What is named as times in a group (`/daq/`) or in records (`/daq/table.`), likeliest first.
fn sources(place: &str, column: &DatasetColumn) -> Vec<String> {
    let path = place.trim_end_matches(['/', '.']);
    let mut names = match &*column.file.object(if path.is_empty() { "/" } else { path }) {
        Object::Group { times, .. } => times.clone(),
        Object::Dataset(dataset) => dataset.fields.iter().map(|field| decoded(&field.name)).collect(),
        _ => Vec::new(),
    };
    names.retain(|name| names::is_time(name));
    names.sort_by_key(|name| FIRST_NAMES.iter().position(|first| first == name).unwrap_or(FIRST_NAMES.len()));
    names.into_iter().take(MOST_TIMES).map(|name| format!("{place}{name}")).collect()
}

/// The numbers of a column of times, with its own scale and offset, and what a unit of them is.
fn counted(times: &DatasetColumn) -> Result<(Vec<f64>, Scale), Fault> {
    let own = Attributes::own(times).map_err(|refusal| Fault::from(refusal).at(&times.source))?;
    let numbers = own.scaled(Samples::F64(times.samples()?.into_f64())).into_f64();
    Ok((numbers, Scale::of(&times.bare_name(), own.unit.as_deref())))
}

/// The times of a column in seconds; a rate that is stated tells units apart where nothing else does.
///
/// # Errors
/// They cannot be read, or nothing tells their unit.
pub(super) fn seconds(times: &DatasetColumn, stated_hz: Option<f64>) -> Result<Vec<f64>, Fault> {
    let (mut numbers, scale) = counted(times)?;
    let source = &times.source;
    let carrier = if times.is_field() { Carrier::Field(source) } else { Carrier::Dataset(source) };
    let unit_s = seconds_a_unit(scale, carrier, &numbers, stated_hz)?;
    #[allow(clippy::float_cmp, reason = "1.0 is the literal for seconds")]
    if unit_s != 1.0 {
        for t in &mut numbers {
            *t *= unit_s;
        }
    }
    Ok(numbers)
}

/// Whether other times beside a channel bear out those that were taken, in seconds; what is no time by its unit says nothing.
///
/// # Errors
/// They are far apart, and nothing decides between them.
pub(super) fn witness(
    taken: (&DatasetColumn, &[f64]),
    other: &DatasetColumn,
    is_decided: bool,
) -> Result<Option<Finding>, Refusal> {
    let Ok((mut others, scale)) = counted(other) else { return Ok(None) };
    let (first_s, last_s) = span_s(taken.1);
    let Some(unit_s) = scale.beside(last_s - first_s, &others) else { return Ok(None) };
    for t in &mut others {
        *t *= unit_s;
    }
    let [one, two] = [taken.0, other].map(|column| format!("{:?}", column.source));
    let clock = Clock { name: &one, times_s: taken.1 };
    clock.borne_out_by(&Clock { name: &two, times_s: &others }, false, is_decided)
}

/// The least and the largest time, s.
pub(super) fn span_s(times_s: &[f64]) -> (f64, f64) {
    times_s.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &t| (a.min(t), b.max(t)))
}
