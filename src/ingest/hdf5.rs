//! HDF5 datasets and columns to the channels that a cask file names, with their attributes and their own times.

mod attributes;
mod clocks;
mod dataset;
mod fault;
mod find;
mod list;
mod packed;
mod rate;
mod record;
mod watch;
mod witness;

pub(super) use list::list;
pub(super) use watch::require_library;

use super::error::{self, IngestError};
use super::time_base::{self, Uniform};
use super::{Limits, Progress, RawChannel, RawRecording};
use crate::data::{CaskFile, ChannelSpec, Samples, Source};
use attributes::Attributes;
use clocks::Clocks;
use dataset::Column;
use hdf5_metno::{Dataset, File};
use std::path::Path;
use watch::Signs;

/// The channels of `cask_file` from the HDF5 file at `path`.
///
/// # Errors
/// A damaged file, a source that is not there or holds no numbers, times that are none.
pub(super) fn read(
    path: &Path,
    cask_file: &CaskFile,
    limits: Limits,
    progress: Progress,
) -> Result<RawRecording, IngestError> {
    let (file, named) = (path.to_owned(), cask_file.clone());
    watch::watched(path, progress, move |signs| read_channels(&file, &named, limits, signs))
}

fn read_channels(
    path: &Path,
    cask_file: &CaskFile,
    limits: Limits,
    signs: &Signs,
) -> Result<RawRecording, IngestError> {
    let file = open(path)?;
    let mut room = Room { path, limits, signs, held_bytes: 0, clocks: Clocks::default() };
    let count = cask_file.channels.len().max(1);
    let mut channels = Vec::with_capacity(count);
    for spec in 0..cask_file.channels.len() {
        channels.push(read_channel(&mut room, &file, spec, cask_file)?);
        #[allow(clippy::cast_precision_loss, reason = "a fraction for a progress bar")]
        signs.done((spec + 1) as f64 / count as f64);
    }
    Ok(RawRecording { channels, zero_unix_ns: None, issues: Vec::new() })
}

/// What of the memory is taken.
struct Room<'a> {
    path: &'a Path,
    limits: Limits,
    signs: &'a Signs,
    held_bytes: u64,
    clocks: Clocks,
}

impl Room<'_> {
    /// Takes room for a column before it is read.
    fn take(&mut self, column: &Column) -> Result<(), IngestError> {
        let (part_bytes, samples_bytes) = (self.limits.part_bytes(), self.limits.samples_bytes());
        self.held_bytes = self.held_bytes.saturating_add(column.held_bytes());
        if column.part_bytes() > part_bytes {
            let what = format!("a block of {} takes", column.source());
            return Err(self.limits.refusal(self.path, &what, part_bytes));
        }
        if self.held_bytes > samples_bytes {
            return Err(self.limits.refusal(
                self.path,
                "the samples of the channels read take",
                samples_bytes,
            ));
        }
        self.signs.alive(column.held_bytes().saturating_mul(column.columns as u64));
        Ok(())
    }

    /// Whether there is room for a column that is not kept.
    fn has_for_a_while(&mut self, column: &Column) -> bool {
        let held_bytes = self.held_bytes;
        let has_room = self.take(column).is_ok();
        self.held_bytes = held_bytes;
        has_room
    }
}

fn read_channel(
    room: &mut Room,
    file: &File,
    index: usize,
    cask_file: &CaskFile,
) -> Result<RawChannel, IngestError> {
    let path = room.path;
    room.signs.alive(0);
    let spec = &cask_file.channels[index];
    let wrong = |problem: String, mend: String| error::source(path, &spec.name, problem, mend);
    let Source::Path(source) = &spec.source else {
        return Err(wrong(
            "source gives a topic and a field, but this recording is HDF5".into(),
            "write the dataset's path: source = \"/daq/a1\", or \"/daq/accel[2]\" for a column".into(),
        ));
    };
    let column = locate(room, file, spec, source)?;
    room.take(&column)?;
    let mut attributes = Attributes::of(file, &column);
    if let Some(problem) = &attributes.unclear {
        let mend = "correct the attribute in a copy (where two contradict each other, delete one), or write the channel with its scale as a dataset of numbers";
        return Err(wrong(format!("{}: {problem}", column.source()), mend.into()));
    }
    let samples = column.samples().map_err(|fault| wrong(fault.problem, fault.mend))?;
    let samples = attributes.scaled(samples);
    let times = time_columns(room, file, spec, cask_file.time.as_deref(), &column)?;
    times.first().map_or(Ok(()), |time| room.take(time))?;
    let why_none = if times.is_empty() { clocks::why_none(file, &column) } else { None };
    let is_settled = spec.sample_rate_hz.is_some() || spec.time.is_some() || cask_file.time.is_some();
    let may_read = |other: &Column| room.has_for_a_while(other);
    let is_rate_decided = spec.sample_rate_hz.is_some() || !times.is_empty();
    let mut uniform = on_base(samples, (&times, why_none, may_read), (spec, is_settled), &attributes)
        .map_err(|fault| wrong(format!("{}: {}", column.source(), fault.problem), fault.mend))?;
    uniform.issues.extend(attributes.other_rate(uniform.sample_rate_hz));
    if spec.unit.is_some() {
        // The cask file's goes before all.
        attributes.other_unit = None;
    }
    uniform.issues.extend(attributes.contradictions(is_rate_decided));
    Ok(RawChannel { spec: index, uniform, unit: attributes.unit })
}

/// The file, with the C library's own printing of errors switched off.
fn open(path: &Path) -> Result<File, IngestError> {
    hdf5_metno::silence_errors(true);
    File::open(path).map_err(|source| fault::of_file(path, &source))
}

/// The dataset or column that a cask file names.
fn locate(room: &Room, file: &File, spec: &ChannelSpec, source: &str) -> Result<Column, IngestError> {
    let path = room.path;
    find::find(file, source).map_err(|missing| match missing {
        find::Missing::Nowhere => error::source(
            path,
            &spec.name,
            format!("there is no dataset {source}"),
            error::near_names(path, source, "dataset", &list::sources(file, room.signs)),
        ),
        find::Missing::Because(fault) => error::source(path, &spec.name, fault.problem, fault.mend),
    })
}

/// The times: as the cask file names them, else siblings with a usual name and as many values; behind the ones to take, all others.
fn time_columns(
    room: &mut Room,
    file: &File,
    spec: &ChannelSpec,
    time: Option<&str>,
    column: &Column,
) -> Result<Vec<Column>, IngestError> {
    let mut beside = room.clocks.of(file, column);
    if let Some(name) = spec.time.as_deref().or(time) {
        let named = named_times(room, file, spec, name, column)?;
        beside.retain(|other| other.source() != named.source());
        beside.insert(0, named);
    }
    Ok(beside)
}

fn named_times(
    room: &Room,
    file: &File,
    spec: &ChannelSpec,
    name: &str,
    column: &Column,
) -> Result<Column, IngestError> {
    // A bare name is looked for beside the samples first, in their own records before all.
    let records = column.records().map(|records| format!("{records}.{name}"));
    let beside = records.into_iter().chain([format!("{}/{name}", column.group())]);
    if !name.starts_with('/')
        && let Some(found) = beside.into_iter().find_map(|source| find::find(file, &source).ok())
    {
        return Ok(found);
    }
    locate(room, file, spec, name)
}

fn on_base(
    samples: Samples,
    (times, why_none, mut may_read): (&[Column], Option<String>, impl FnMut(&Column) -> bool),
    (spec, is_settled): (&ChannelSpec, bool),
    attributes: &Attributes,
) -> Result<Uniform, fault::Fault> {
    let in_time = |error: time_base::TimeBaseError| fault::Fault {
        problem: error.to_string(),
        mend: "check the dataset of times (`time` in the cask file), or give sample_rate_hz".into(),
    };
    if let Some((time, others)) = times.split_first() {
        // A rate that the recording states tells the unit of times that state none.
        let (times_s, question) = time.times_s(spec.sample_rate_hz.or(attributes.sample_rate_hz()))?;
        let mut uniform = time_base::from_times(&times_s, samples, spec.sample_rate_hz).map_err(in_time)?;
        uniform.issues.extend(question);
        let is_settled = is_settled || attributes.agrees(uniform.sample_rate_hz);
        for other in others {
            match witness::contradiction((time, &times_s), other, &mut may_read) {
                Some(found) if found.is_far && !is_settled => return Err(found.fault),
                found => uniform.issues.extend(found.map(witness::Contradiction::issue)),
            }
        }
        return Ok(uniform);
    }
    if spec.sample_rate_hz.is_none()
        && let Some(rival) = attributes.rate.as_ref().and_then(|stated| stated.rival.as_ref())
        && rival.is_far
    {
        return Err(fault::Fault { problem: rival.problem.clone(), mend: rival.mend.clone() });
    }
    let stated = spec
        .sample_rate_hz
        .map(Ok)
        .or_else(|| attributes.rate.clone().map(|stated| stated.rate.map(|rate| rate.rate_hz)));
    let stated = stated.unwrap_or_else(|| {
        let why_none = why_none.unwrap_or_else(|| "no dataset of times beside it".into());
        Err(format!("nothing says when its samples were taken: no attribute sample_rate_hz, and {why_none}"))
    });
    let rate_hz = stated.map_err(|problem| fault::Fault {
        problem,
        mend: "give sample_rate_hz in this channel of the cask file, or time = \"/path/of/times\"".into(),
    })?;
    time_base::from_rate(attributes.start_s.unwrap_or(0.0), rate_hz, samples).map_err(in_time)
}

/// How a dataset is stored, for people: type, shape, filters.
fn storage(dataset: &Dataset) -> String {
    let kind = dataset.dtype().map_or_else(|_| "unknown type".to_owned(), |dtype| dataset::type_name(&dtype));
    if dataset.space().is_ok_and(|space| space.is_null()) {
        return format!("{kind}, no data");
    }
    let shape: Vec<String> = dataset.shape().iter().map(ToString::to_string).collect();
    let filters: Vec<String> = dataset.filters().iter().map(|f| format!("{f:?}").to_lowercase()).collect();
    let mut text = format!("{kind}, {}", if shape.is_empty() { "scalar".into() } else { shape.join(" × ") });
    if !filters.is_empty() {
        text.push_str(", ");
        text.push_str(&filters.join(" + "));
    }
    text
}

#[cfg(test)]
mod layout_tests;
#[cfg(test)]
mod place_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod time_tests;
