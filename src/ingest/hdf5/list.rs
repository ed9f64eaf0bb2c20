//! An HDF5 file to the list of its datasets and columns.

use super::super::error::IngestError;
use super::answer::Object;
use super::attributes::Attributes;
use super::clocks::Clocks;
use super::dataset::Column;
use super::fault::Fault;
use super::find::{self, Missing};
use super::room::{File, Found};
use super::time_base::TimeBaseError;
use super::witness::{self, Contradiction};
use super::{Limits, Progress, storage, time_base};
use crate::data::{Issue, IssueCode, ListedChannel, Listing, RecordingFormat, Samples, Severity};
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

/// So many channels are listed at most.
const MOST_CHANNELS: usize = 10_000;
/// A dataset with more columns than this is listed in one line: it is no table of channels.
const MOST_COLUMNS: usize = 256;
/// The range of a longer column is not looked for: `inspect` should answer at once.
const RANGED_SAMPLES: usize = 20_000_000;

/// So many values are read for ranges and times in all: names may stand for one large dataset many times over.
const MOST_VALUES: u64 = 1 << 30;

/// What a listing may still cost.
struct Effort {
    limits: Limits,
    values_left: u64,
    clocks: Clocks,
}

impl Effort {
    /// Whether a column may be read; it is then paid for.
    fn pays_for(&mut self, column: &Column) -> bool {
        let (held, part) = (column.held_bytes(), column.part_bytes());
        let values = (column.len() as u64).saturating_mul(column.columns as u64);
        let pays = held <= self.limits.samples_bytes() && part <= self.limits.part_bytes();
        if pays && values <= self.values_left {
            self.values_left -= values;
            return true;
        }
        false
    }
}

/// What can be written as `source`.
pub(super) fn sources(file: &File) -> Vec<String> {
    let found = file.walk();
    found.iter().flat_map(|(path, object)| sources_of(object, path).unwrap_or_default()).collect()
}

/// The sources of one dataset: itself, its columns, rows or fields; `None` where it holds no numbers in one or two dimensions.
fn sources_of(object: &Object, path: &str) -> Option<Vec<String>> {
    let Object::Dataset(dataset) = object else { return None };
    find::sources(dataset, path, MOST_COLUMNS).ok().filter(|sources| !sources.is_empty())
}

/// Lists what the HDF5 file at `path` holds.
///
/// # Errors
/// A file that the library cannot open.
pub(in super::super) fn list(
    path: &Path,
    limits: Limits,
    progress: Progress,
) -> Result<Listing, IngestError> {
    let file = File::open(path, limits, Vec::new())?;
    let listing = list_objects(&file, progress);
    file.whole().map(|()| listing)
}

fn list_objects(file: &Rc<File>, progress: Progress) -> Listing {
    // No number takes fewer than four bytes once it is unpacked and turned.
    let values_left = MOST_VALUES.min(file.limits.unpacked_bytes(file.bytes) / 4);
    let mut effort = Effort { limits: file.limits, values_left, clocks: Clocks::default() };
    let objects = file.walk();
    let (mut channels, mut broken) = (Vec::new(), Vec::new());
    let mut issues: Vec<Issue> = Vec::new();
    let (mut groups, mut datasets) = (0, 0);
    for (number, (path, object)) in objects.iter().enumerate() {
        match &**object {
            Object::Group { .. } => groups += 1,
            Object::Dataset(_) => datasets += 1,
            Object::NamedType | Object::Nothing => {}
            Object::NotFollowed(what) => {
                broken.push(ListedChannel {
                    unreadable: Some(what.clone()),
                    ..ListedChannel::named(path, "link")
                });
            }
            Object::Broken(_) => {
                let what = "a link to what is not there, or what the HDF5 library cannot open";
                let fault = find::no_dataset(object, path).map(|fault| fault.problem);
                let reason = fault
                    .and_then(|f| f.strip_prefix(path).map(|f| f.trim_start_matches([':', ' ']).to_owned()));
                let reason = reason.filter(|reason| !reason.starts_with("it cannot be read"));
                broken.push(ListedChannel {
                    unreadable: Some(reason.unwrap_or_else(|| what.to_owned())),
                    ..ListedChannel::named(path, "link")
                });
            }
        }
        if matches!(**object, Object::Dataset(_)) && channels.len() < MOST_CHANNELS {
            match sources_of(object, path) {
                Some(sources) => {
                    for source in &sources {
                        channels.push(listed(file, source, &mut effort, &mut issues));
                    }
                }
                None => channels.push(unreadable(file, path)),
            }
        }
        #[allow(clippy::cast_precision_loss, reason = "a fraction for a progress bar")]
        progress((number + 1) as f64 / objects.len() as f64);
    }
    channels.extend(broken);
    count_from_first(&mut channels, &mut issues);
    let version = file.library;
    Listing {
        schema: "dropcheck.inspect/1",
        recording: file.path.display().to_string(),
        bytes: file.bytes,
        format: RecordingFormat::Hdf5,
        counts: BTreeMap::from([("groups".into(), groups), ("datasets".into(), datasets)]),
        facts: BTreeMap::from([(
            "read with".into(),
            format!("HDF5 library {}.{}.{}", version.0, version.1, version.2),
        )]),
        channels,
        issues,
    }
}

/// Times from the earliest first sample on.
fn count_from_first(channels: &mut [ListedChannel], issues: &mut [Issue]) {
    let first_s = channels.iter().filter_map(|channel| channel.start_s).fold(f64::INFINITY, f64::min);
    for time_s in channels.iter_mut().filter_map(|channel| channel.start_s.as_mut()) {
        *time_s -= first_s;
    }
    for issue in issues {
        issue.from_s = issue.from_s.map(|time_s| time_s - first_s);
        issue.to_s = issue.to_s.map(|time_s| time_s - first_s);
    }
}

/// A dataset that holds no channel, with the reason.
fn unreadable(file: &Rc<File>, path: &str) -> ListedChannel {
    let fault = match find::find(file, path) {
        Err(Missing::Because(fault)) => fault.problem,
        Err(Missing::Nowhere) | Ok(_) => "it cannot be opened".to_owned(),
    };
    let reason = fault.strip_prefix(path).unwrap_or(&fault).trim_start_matches([':', ' ']).to_owned();
    let encoding = Found::at(file, path).map(|dataset| storage(&dataset)).unwrap_or_default();
    ListedChannel { encoding, unreadable: Some(reason), ..ListedChannel::named(path, "dataset") }
}

fn listed(file: &Rc<File>, source: &str, effort: &mut Effort, issues: &mut Vec<Issue>) -> ListedChannel {
    let Ok(column) = find::find(file, source) else { return unreadable(file, source) };
    let attributes = Attributes::of(&column);
    let kind = column.kind_name();
    let mut channel = ListedChannel {
        samples: Some(column.len() as u64),
        encoding: storage(&column.dataset) + &attributes.scaling(),
        ..ListedChannel::named(source, kind)
    };
    match survey(file, &column, &attributes, effort, &mut channel) {
        Ok(found) => issues.extend(found.into_iter().map(|issue| issue.on(source))),
        Err(fault) => channel.unreadable = Some(fault.problem),
    }
    channel
}

/// Range, rate, start and gaps of a column into `channel`.
fn survey(
    file: &Rc<File>,
    column: &Column,
    attributes: &Attributes,
    effort: &mut Effort,
    channel: &mut ListedChannel,
) -> Result<Vec<Issue>, Fault> {
    channel.sample_rate_hz = attributes.sample_rate_hz();
    channel.unit.clone_from(&attributes.unit);
    channel.start_s = attributes.start_s;
    let mut samples = Samples::F32(vec![0.0; column.len().min(RANGED_SAMPLES)]);
    if column.len() <= RANGED_SAMPLES && effort.pays_for(column) {
        samples = attributes.scaled(column.samples()?);
        channel.range = range(&samples);
    }
    let times = effort.clocks.of(file, column);
    let Some((time, others)) = times.split_first() else {
        let intervals = column.len().saturating_sub(1);
        #[allow(clippy::cast_precision_loss, reason = "below 2^31")]
        let duration_s = channel.sample_rate_hz.map(|rate_hz| intervals as f64 / rate_hz);
        channel.duration_s = duration_s;
        channel.start_s = attributes.start_s.or(duration_s.map(|_| 0.0));
        let unclear =
            attributes.unclear.clone().or(attributes.rate.clone().and_then(|stated| stated.rate.err()));
        return Ok(unclear.map(no_base).into_iter().chain(attributes.contradictions(false)).collect());
    };
    if !effort.pays_for(time) {
        return Ok(Vec::new());
    }
    let (times_s, question) = match time.times_s(attributes.sample_rate_hz()) {
        Ok(read) => read,
        Err(fault) => return Ok(vec![no_base(format!("{}: {}", fault.problem, fault.mend))]),
    };
    if times_s.len() != samples.len() {
        return Ok(Vec::new());
    }
    let uniform = match time_base::from_times(&times_s, samples, None) {
        Ok(uniform) => uniform,
        Err(TimeBaseError::TooFew { .. }) => return Ok(Vec::new()),
        Err(error) => return Ok(vec![no_base(format!("{}: {error}", time.source()))]),
    };
    let (first_s, last_s) =
        times_s.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &t| (a.min(t), b.max(t)));
    channel.sample_rate_hz = Some(uniform.sample_rate_hz);
    channel.start_s = Some(first_s);
    channel.duration_s = Some(last_s - first_s);
    let has_gap = uniform.issues.iter().any(|issue| issue.code == IssueCode::Gap);
    channel.gaps = Some(if has_gap { uniform.gaps.len() as u64 } else { 0 });
    let told = others
        .iter()
        .filter_map(|other| witness::contradiction((time, &times_s), other, |other| effort.pays_for(other)));
    let told = told.map(Contradiction::issue);
    Ok(uniform
        .issues
        .into_iter()
        .chain(question)
        .chain(attributes.contradictions(true))
        .chain(told)
        .collect())
}

/// That times or rate would not do, as reading says.
fn no_base(problem: String) -> Issue {
    Issue::new(IssueCode::Clock, Severity::Warning, problem)
}

fn range(samples: &Samples) -> Option<(f64, f64)> {
    let (mut smallest, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in (0..samples.len()).map(|i| samples.get(i)).filter(|value| value.is_finite()) {
        smallest = smallest.min(value);
        largest = largest.max(value);
    }
    (smallest <= largest).then_some((smallest, largest))
}
