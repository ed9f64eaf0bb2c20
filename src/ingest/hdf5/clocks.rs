//! The times beside a channel, by their names, to seconds.

use super::answer::{Object, decoded};
use super::attributes::Attributes;
use super::column::DatasetColumn;
use super::{find, names};
use crate::data::{Finding, Samples};
use crate::ingest::clock::Clock;
use crate::ingest::refusal::Refusal;
use crate::ingest::times::{Carrier, Counted, Scale, seconds_a_unit};
use crate::ingest::vocabulary;
use crate::numerics::extent;

/// Names that go before others.
const FIRST_NAMES: [&str; 6] = ["time_s", "time", "t", "times", "timestamps", "Time"];

/// No recording has more times beside a channel; each costs a look through the channels of its dataset.
const MOST_TIMES: usize = 64;

/// The times in the group or the records that were asked for last, by their names: channels come in the order
/// of the file.
#[derive(Default)]
pub(super) struct Clocks {
    place: Option<String>,
    times: Vec<DatasetColumn>,
    /// The first start that is stated, s since 1970: others count from it, which keeps their digits.
    pub zero_s: Option<f64>,
}

impl Clocks {
    /// The times of a channel, likeliest first: fields of the same records or columns beside it, else
    /// datasets, that have a usual name and as many values.
    pub(super) fn of(&mut self, column: &DatasetColumn) -> Vec<DatasetColumn> {
        let is_apart =
            |times: &&DatasetColumn| times.length == column.length && times.source != column.source;
        let index = column.names().iter().position(|name| names::is_time(name));
        let named = index.map(|index| find::find(&column.file, &format!("{}[{index}]", column.path)));
        if let Some(Ok(Some(times))) = named
            && times.source != column.source
        {
            return vec![times];
        }
        for place in places(column) {
            if self.place.as_ref() != Some(&place) {
                let named = sources(&place, column, names::is_time).into_iter();
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

/// Where what is beside a channel stands: in the same records, and in its group.
pub(super) fn places(column: &DatasetColumn) -> impl Iterator<Item = String> {
    let records = column.is_field().then(|| format!("{}.", column.path));
    records.into_iter().chain([format!("{}/", column.group())])
}

/// What says of which sensor each sample of a channel is: by its name, or whole numbers beside it.
pub(super) fn sensors_beside(column: &DatasetColumn) -> Vec<DatasetColumn> {
    let is_open = |name: &str| !names::is_sensor(name) && !vocabulary::may_count(name);
    beside(column, names::is_sensor).chain(few(column, is_open)).collect()
}

/// What may count the samples of a channel: by its name, or whole numbers beside it.
pub(super) fn counters_beside(column: &DatasetColumn) -> Vec<DatasetColumn> {
    let is_open = |name: &str| !names::is_time(name) && !vocabulary::may_count(name);
    let named = beside(column, vocabulary::may_count);
    let named = named.filter(|other| other.number.is_whole() && other.source != column.source);
    named.chain(few(column, is_open)).collect()
}

/// What is named so beside a channel, itself among them, of as many samples.
fn beside(
    column: &DatasetColumn,
    is_named: impl Fn(&str) -> bool + Copy,
) -> impl Iterator<Item = DatasetColumn> {
    let all = places(column).flat_map(move |place| sources(&place, column, is_named));
    let found = all.filter_map(|source| find::find(&column.file, &source).ok()?);
    found.filter(|other| other.length == column.length)
}

/// Whole numbers that are named so, as many as may be read beside each channel.
fn few(
    column: &DatasetColumn,
    is_named: impl Fn(&str) -> bool + Copy,
) -> impl Iterator<Item = DatasetColumn> {
    /// Of all together.
    const MOST_SAMPLES: usize = 1 << 22;
    let most = (MOST_SAMPLES / column.length.max(1)).min(MOST_TIMES);
    let is_it = |other: &DatasetColumn| other.number.is_whole() && other.source != column.source;
    beside(column, is_named).filter(is_it).take(most)
}

/// Why a channel has no times: what is named as times beside it, and is none of its own.
pub(super) fn why_none(column: &DatasetColumn) -> String {
    let sources = sources(&format!("{}/", column.group()), column, names::is_time);
    let others = sources.iter().filter(|source| **source != column.source);
    let mut reasons = others.filter_map(|source| match find::find(&column.file, source) {
        Ok(times) => Some(format!("{source} holds {} times for {} samples", times?.length, column.length)),
        Err(fault) => Some(fault.to_string()),
    });
    reasons.next().unwrap_or_else(|| "no dataset of times beside it".into())
}

/// What is named so in a group (`/daq/`) or in records (`/daq/table.`), likeliest first; what MATLAB's cells
/// hold is named by chance.
fn sources(place: &str, column: &DatasetColumn, is_named: impl Fn(&str) -> bool) -> Vec<String> {
    let path = place.trim_end_matches(['/', '.']);
    let mut names = match &*column.file.object(if path.is_empty() { "/" } else { path }) {
        Object::Group { times, .. } if !path.ends_with("/#refs#") => times.clone(),
        Object::Dataset(dataset) => dataset.fields.iter().map(|field| decoded(&field.name)).collect(),
        _ => Vec::new(),
    };
    names.retain(|name| is_named(name));
    names.sort_by_key(|name| FIRST_NAMES.iter().position(|first| first == name).unwrap_or(FIRST_NAMES.len()));
    names.into_iter().take(MOST_TIMES).map(|name| format!("{place}{name}")).collect()
}

/// The numbers of a column of times, with its own scale and offset, and what a unit of them is.
pub(super) fn counted(times: &DatasetColumn) -> Result<(Vec<f64>, Scale), Refusal> {
    let own = Attributes::own(times).map_err(|refusal| refusal.at(&times.source))?;
    let numbers = own.scaled(Samples::F64(times.samples()?.into_f64())).into_f64();
    Ok((numbers, Scale::of(&times.bare_name(), own.unit.as_deref())))
}

/// Why numbers that are named as times are none.
pub(super) fn why_unfit(times: &DatasetColumn, (numbers, scale): &(Vec<f64>, Scale)) -> Option<String> {
    let (falls, steps) = (numbers.windows(2).filter(|pair| pair[1] < pair[0]).count(), numbers.len() - 1);
    let what = match scale {
        Scale::Unknown => "is in a unit that is none of time".into(),
        _ if 10 * falls > steps => format!("falls in {falls} of {steps} steps, as no times do"),
        _ => return None,
    };
    Some(format!("{} {what}", times.source))
}

/// The times of a column in seconds; a rate that is stated tells units apart where nothing else does.
///
/// # Errors
/// Nothing tells their unit.
pub(super) fn seconds(
    times: &DatasetColumn,
    (numbers, scale): (Vec<f64>, Scale),
    stated_hz: Option<f64>,
) -> Result<Vec<f64>, Refusal> {
    let source = &times.source;
    let carrier = if times.is_field() { Carrier::Field(source) } else { Carrier::Dataset(source) };
    let unit_s = seconds_a_unit(scale, carrier, || Counted::of(&numbers), stated_hz)?;
    Ok(numbers.into_iter().map(|time| time * unit_s).collect())
}

/// Whether other times beside a channel bear out those that were taken, in seconds; what is no time by its
/// unit says nothing.
///
/// # Errors
/// They are far apart, and nothing decides between them.
pub(super) fn witness(
    taken: (&DatasetColumn, &[f64]),
    other: &DatasetColumn,
    is_decided: bool,
) -> Result<Option<Finding>, Refusal> {
    let Ok((others, scale)) = counted(other) else { return Ok(None) };
    let (first_s, last_s) = extent(taken.1.iter().copied());
    let Some(unit_s) = scale.beside(last_s - first_s, &others) else { return Ok(None) };
    let others: Vec<f64> = others.into_iter().map(|time| time * unit_s).collect();
    let [one, two] = [taken.0, other].map(|column| format!("{:?}", column.source));
    let clock = Clock { name: &one, times_s: taken.1 };
    clock.borne_out_by(&Clock { name: &two, times_s: &others }, false, is_decided)
}
