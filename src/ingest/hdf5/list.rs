//! An HDF5 file to the list of its datasets and columns.

use super::super::error::IngestError;
use super::attributes::Attributes;
use super::clocks::Clocks;
use super::dataset::Column;
use super::fault::Fault;
use super::find::{self, Missing};
use super::time_base::TimeBaseError;
use super::watch::{self, Signs};
use super::witness::{self, Contradiction};
use super::{Limits, Progress, open, storage, time_base};
use crate::data::{Issue, IssueCode, ListedChannel, Listing, RecordingFormat, Samples, Severity};
use hdf5_metno::{File, Group};
use std::collections::BTreeMap;
use std::path::Path;

/// Groups deeper than this are not followed: links may form circles.
const DEEPEST: usize = 32;
/// At most so many objects are listed, for the same reason.
const MOST_OBJECTS: usize = 10_000;
/// A dataset with more columns than this is listed in one line: it is no table of channels.
const MOST_COLUMNS: usize = 256;
/// The range of a longer column is not looked for: `inspect` should answer at once.
const RANGED_SAMPLES: usize = 20_000_000;

/// So many values are read for ranges and times in all: names may stand for one large dataset many times over.
const MOST_VALUES: u64 = 1 << 30;

/// What a listing may still cost.
struct Effort<'a> {
    limits: Limits,
    signs: &'a Signs,
    values_left: u64,
    clocks: Clocks,
}

impl Effort<'_> {
    /// Whether a column may be read; it is then paid for.
    fn pays_for(&mut self, column: &Column) -> bool {
        let (held, part) = (column.held_bytes(), column.part_bytes());
        let values = (column.len() * column.columns) as u64;
        let pays = held <= self.limits.samples_bytes() && part <= self.limits.part_bytes();
        if pays && values <= self.values_left {
            self.values_left -= values;
            self.signs.alive(values.saturating_mul(8));
            return true;
        }
        false
    }
}

/// Everything in the file, by path.
#[derive(Default)]
struct Objects {
    groups: u64,
    datasets: Vec<String>,
    broken: Vec<String>,
}

/// What can be written as `source`.
pub(super) fn sources(file: &File, signs: &Signs) -> Vec<String> {
    let mut objects = Objects::default();
    walk(file, "", (0, signs), &mut objects);
    objects.datasets.iter().flat_map(|path| sources_of(file, path).unwrap_or_default()).collect()
}

fn walk(group: &Group, path: &str, (depth, signs): (usize, &Signs), objects: &mut Objects) {
    for name in group.member_names().unwrap_or_default() {
        signs.alive(0);
        let groups = usize::try_from(objects.groups).unwrap_or(usize::MAX);
        if objects.datasets.len() + objects.broken.len() + groups >= MOST_OBJECTS {
            return;
        }
        let full = format!("{path}/{name}");
        if let Ok(inner) = group.group(&name) {
            objects.groups += 1;
            if depth < DEEPEST {
                walk(&inner, &full, (depth + 1, signs), objects);
            }
        } else if group.dataset(&name).is_ok() {
            objects.datasets.push(full);
        } else if !group
            .loc_type_by_name(&name)
            .is_ok_and(|kind| kind == hdf5_metno::LocationType::NamedDatatype)
        {
            objects.broken.push(full);
        }
    }
}

/// The sources of one dataset: itself, its columns, rows or fields; `None` where it holds no numbers in one or two dimensions.
fn sources_of(file: &File, path: &str) -> Option<Vec<String>> {
    let dataset = file.dataset(path).ok()?;
    find::sources(&dataset, path, MOST_COLUMNS).ok().filter(|sources| !sources.is_empty())
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
    let file = path.to_owned();
    watch::watched(path, progress, move |signs| list_objects(&file, limits, signs))
}

fn list_objects(path: &Path, limits: Limits, signs: &Signs) -> Result<Listing, IngestError> {
    let mut effort = Effort { limits, signs, values_left: MOST_VALUES, clocks: Clocks::default() };
    let file = open(path)?;
    let mut objects = Objects::default();
    walk(&file, "", (0, signs), &mut objects);
    let mut channels = Vec::new();
    let mut issues: Vec<Issue> = Vec::new();
    let count = objects.datasets.len().max(1);
    for (number, dataset) in objects.datasets.iter().enumerate() {
        if channels.len() >= MOST_OBJECTS {
            break;
        }
        match sources_of(&file, dataset) {
            Some(sources) => {
                for source in &sources {
                    channels.push(listed(&file, source, &mut effort, &mut issues));
                }
            }
            None => channels.push(unreadable(&file, dataset)),
        }
        #[allow(clippy::cast_precision_loss, reason = "a fraction for a progress bar")]
        signs.done((number + 1) as f64 / count as f64);
    }
    channels.extend(objects.broken.iter().map(|link| ListedChannel {
        unreadable: Some("a link to what is not there".into()),
        ..blank(link, "link")
    }));
    count_from_first(&mut channels, &mut issues);
    let version = hdf5_metno::library_version();
    Ok(Listing {
        schema: "dropcheck.inspect/1",
        recording: path.display().to_string(),
        bytes: std::fs::metadata(path).map_or(0, |metadata| metadata.len()),
        format: RecordingFormat::Hdf5,
        counts: BTreeMap::from([
            ("groups".into(), objects.groups),
            ("datasets".into(), objects.datasets.len() as u64),
        ]),
        facts: BTreeMap::from([(
            "read with".into(),
            format!("HDF5 library {}.{}.{}", version.0, version.1, version.2),
        )]),
        channels,
        issues,
    })
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

fn blank(source: &str, kind: &str) -> ListedChannel {
    ListedChannel {
        source: source.to_owned(),
        kind: kind.to_owned(),
        samples: None,
        messages: None,
        sample_rate_hz: None,
        unit: None,
        start_s: None,
        duration_s: None,
        gaps: None,
        range: None,
        encoding: String::new(),
        unreadable: None,
    }
}

/// A dataset that holds no channel, with the reason.
fn unreadable(file: &File, path: &str) -> ListedChannel {
    let fault = match find::find(file, path) {
        Err(Missing::Because(fault)) => fault.problem,
        Err(Missing::Nowhere) | Ok(_) => "it cannot be opened".to_owned(),
    };
    let reason = fault.strip_prefix(path).unwrap_or(&fault).trim_start_matches([':', ' ']).to_owned();
    let encoding = file.dataset(path).map(|dataset| storage(&dataset)).unwrap_or_default();
    ListedChannel { encoding, unreadable: Some(reason), ..blank(path, "dataset") }
}

fn listed(file: &File, source: &str, effort: &mut Effort, issues: &mut Vec<Issue>) -> ListedChannel {
    effort.signs.alive(0);
    let Ok(column) = find::find(file, source) else { return unreadable(file, source) };
    let attributes = Attributes::of(file, &column);
    let kind = column.kind_name();
    let mut channel = ListedChannel {
        samples: Some(column.len() as u64),
        encoding: storage(&column.dataset) + &attributes.scaling(),
        ..blank(source, kind)
    };
    match survey(file, &column, &attributes, effort, &mut channel) {
        Ok(found) => issues.extend(found.into_iter().map(|issue| issue.on(source))),
        Err(fault) => channel.unreadable = Some(fault.problem),
    }
    channel
}

/// Range, rate, start and gaps of a column into `channel`.
fn survey(
    file: &File,
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
    Issue::new(IssueCode::TimeJitter, Severity::Warning, problem)
}

fn range(samples: &Samples) -> Option<(f64, f64)> {
    let (mut smallest, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in (0..samples.len()).map(|i| samples.get(i)).filter(|value| value.is_finite()) {
        smallest = smallest.min(value);
        largest = largest.max(value);
    }
    (smallest <= largest).then_some((smallest, largest))
}
