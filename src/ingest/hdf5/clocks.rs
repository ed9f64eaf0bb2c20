//! The times beside a channel, by their name.

use super::super::time_name;
use super::answer::{Object, decoded};
use super::dataset::Column;
use super::find;
use super::room::File;
use std::rc::Rc;

/// Names that go before others.
const FIRST_NAMES: [&str; 6] = ["time_s", "time", "t", "times", "timestamps", "Time"];

/// Times by their names, of the group or the records that were asked for last: channels come in the order of the file.
#[derive(Default)]
pub(super) struct Clocks {
    place: Option<String>,
    sources: Vec<String>,
}

impl Clocks {
    /// The times of a channel, likeliest first: fields of the same records, else datasets beside it, that have a usual name and as many values.
    pub(super) fn of(&mut self, file: &Rc<File>, column: &Column) -> Vec<Column> {
        let is_apart = |times: &Column| times.len() == column.len() && times.source() != column.source();
        let records = column.records().map(|name| (format!("{name}."), true));
        let places = records.into_iter().chain([(format!("{}/", column.group()), false)]);
        let found = places.map(|(place, is_records)| {
            if self.place.as_ref() != Some(&place) {
                let names = if is_records { fields(file, &place) } else { members(file, &place) };
                self.sources = ranked(&place, names);
                self.place = Some(place);
            }
            let found = self.sources.iter().filter_map(|source| find::find(file, source).ok());
            found.filter(is_apart).collect::<Vec<_>>()
        });
        found.into_iter().find(|found| !found.is_empty()).unwrap_or_default()
    }
}

/// Why what is named as times beside a channel was not taken for its times; `None` where nothing is named so.
pub(super) fn why_none(file: &Rc<File>, column: &Column) -> Option<String> {
    let place = format!("{}/", column.group());
    let sources = ranked(&place, members(file, &place));
    sources.iter().filter(|source| **source != column.source()).find_map(|source| {
        match find::find(file, source) {
            Ok(times) => Some(format!("{source} holds {} times for {} samples", times.len(), column.len())),
            Err(find::Missing::Because(fault)) => Some(fault.problem),
            Err(find::Missing::Nowhere) => None,
        }
    })
}

fn fields(file: &Rc<File>, place: &str) -> Vec<String> {
    match &*file.object(place.trim_end_matches('.')) {
        Object::Dataset(dataset) => dataset.fields.iter().map(|field| decoded(&field.name)).collect(),
        _ => Vec::new(),
    }
}

fn members(file: &Rc<File>, place: &str) -> Vec<String> {
    let group = place.trim_end_matches('/');
    match &*file.object(if group.is_empty() { "/" } else { group }) {
        Object::Group { times, .. } => times.clone(),
        _ => Vec::new(),
    }
}

/// Whether a dataset or field of this name is one of times.
pub(super) fn is_time(name: &str) -> bool {
    let last = name.rsplit_once('.').map_or(name, |(_, last)| last);
    time_name::is_time(time_name::split(last).0)
}

/// The sources named as times, likeliest first.
fn ranked(place: &str, mut names: Vec<String>) -> Vec<String> {
    names.retain(|name| is_time(name));
    names.sort_by_key(|name| FIRST_NAMES.iter().position(|first| first == name).unwrap_or(FIRST_NAMES.len()));
    names.into_iter().map(|name| format!("{place}{name}")).collect()
}
