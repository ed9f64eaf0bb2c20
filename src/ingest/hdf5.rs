//! HDF5 datasets and columns to the channels that a cask file names, with their attributes and their own times.

mod answer;
mod attributes;
mod clocks;
mod dataset;
mod fault;
mod find;
mod library;
mod list;
mod packed;
mod patience;
mod rate;
mod room;
mod types;
mod wall;
mod witness;

pub(super) use list::list;
#[cfg(any(test, fuzzing))]
pub(super) use room::answer_by;
pub(super) use room::use_program;

use super::error::{self, IngestError};
use super::time_base::{self, Uniform};
use super::{Limits, Progress, RawChannel, RawRecording};
use crate::data::{CaskFile, ChannelSpec, Samples, Source};
use answer::{Dataset, Filter, decoded};
use attributes::Attributes;
use clocks::Clocks;
use dataset::Column;
use room::File;
#[cfg(unix)]
use std::ffi::OsString;
use std::io::{BufWriter, stdin, stdout};
use std::path::Path;
use std::process::ExitCode;
use std::rc::Rc;

/// Where this process was started to take an HDF5 file apart: does so until nobody asks any more. Else `program` is noted as the one to
/// be started for it.
pub(super) fn serve(program: &Path) -> Option<ExitCode> {
    let mut words = std::env::args_os().skip(1);
    if words.next().is_none_or(|word| word != room::WORD) {
        #[cfg(unix)]
        begin_without_variables(program);
        use_program(program);
        return None;
    }
    let path = words.next()?;
    let path = Path::new(&path);
    let mut wall = wall::Wall::around(path);
    let mut grant = |bytes, held_bytes| wall.grant(bytes, held_bytes);
    let answered = library::answer(path, &mut stdin().lock(), &mut BufWriter::new(stdout()), &mut grant);
    Some(if answered.is_ok() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Starts the program anew where variables are set by which the C library, which writes the curves of a report in this process, would
/// load code or take another driver: `HDF5_PLUGIN_PATH`, `HDF5_VOL_CONNECTOR`, `HDF5_DRIVER` and the like.
#[cfg(unix)]
fn begin_without_variables(program: &Path) {
    use std::os::unix::process::CommandExt;
    let is_heeded = |(name, value): &(OsString, OsString)| {
        name.as_encoded_bytes().starts_with(b"HDF5_")
            && (name != room::NO_PLUGINS.0 || value != room::NO_PLUGINS.1)
    };
    let mut heeded = std::env::vars_os().filter(is_heeded).peekable();
    if heeded.peek().is_some() {
        let mut words = std::env::args_os();
        let mut command = std::process::Command::new(program);
        command.arg0(words.next().unwrap_or_default()).args(words);
        for (name, _) in heeded {
            command.env_remove(name);
        }
        // It does not come back but where it cannot be started; then all goes on with the variables.
        let _ = command.env(room::NO_PLUGINS.0, room::NO_PLUGINS.1).exec();
    }
}

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
    let file = File::open(path, limits, wanted(cask_file))?;
    let mut room = Room { file: &file, held_bytes: 0, clocks: Clocks::default() };
    let count = cask_file.channels.len().max(1);
    let mut channels = Vec::with_capacity(count);
    for spec in 0..cask_file.channels.len() {
        let channel = read_channel(&mut room, spec, cask_file);
        // A library that broke off gives no answers, which is not what is wrong with the channel.
        file.whole()?;
        channels.push(channel?);
        #[allow(clippy::cast_precision_loss, reason = "a fraction for a progress bar")]
        progress((spec + 1) as f64 / count as f64);
    }
    Ok(RawRecording { channels, zero_unix_ns: None, issues: Vec::new() })
}

/// Where the sources of a cask file may stand, to ask for all of them at once.
fn wanted(cask_file: &CaskFile) -> Vec<String> {
    let sources = cask_file.channels.iter().filter_map(|channel| match &channel.source {
        Source::Path(source) => Some(source),
        Source::TopicField { .. } => None,
    });
    let times = cask_file.channels.iter().filter_map(|channel| channel.time.as_ref());
    let all = sources.chain(times).chain(&cask_file.time);
    let mut wanted: Vec<String> =
        all.flat_map(|source| find::places(source)).map(|(path, ..)| path).collect();
    wanted.sort();
    wanted.dedup();
    wanted
}

/// What of the memory is taken.
struct Room<'a> {
    file: &'a Rc<File>,
    held_bytes: u64,
    clocks: Clocks,
}

impl Room<'_> {
    /// Takes room for a column before it is read.
    fn take(&mut self, column: &Column) -> Result<(), IngestError> {
        let File { limits, path, .. } = &**self.file;
        let (part_bytes, samples_bytes) = (limits.part_bytes(), limits.samples_bytes());
        self.held_bytes = self.held_bytes.saturating_add(column.held_bytes());
        if column.part_bytes() > part_bytes {
            let what = format!("a block of {} takes", column.source());
            return Err(limits.refusal(path, &what, part_bytes));
        }
        let unpacked_bytes = limits.unpacked_bytes(self.file.bytes);
        if self.held_bytes > unpacked_bytes {
            return Err(limits.refusal(path, "the samples of the channels read unpack to", unpacked_bytes));
        }
        if self.held_bytes > samples_bytes {
            return Err(limits.refusal(path, "the samples of the channels read take", samples_bytes));
        }
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

fn read_channel(room: &mut Room, index: usize, cask_file: &CaskFile) -> Result<RawChannel, IngestError> {
    let path = &room.file.path;
    let spec = &cask_file.channels[index];
    let wrong = |problem: String, mend: String| error::source(path, &spec.name, problem, mend);
    let Source::Path(source) = &spec.source else {
        return Err(wrong(
            "source gives a topic and a field, but this recording is HDF5".into(),
            "write the dataset's path: source = \"/daq/a1\", or \"/daq/accel[2]\" for a column".into(),
        ));
    };
    let column = locate(room.file, spec, source)?;
    room.take(&column)?;
    let mut attributes = Attributes::of(&column);
    if let Some(problem) = &attributes.unclear {
        let mend = "correct the attribute in a copy (where two contradict each other, delete one), or write the channel with its scale as a dataset of numbers";
        return Err(wrong(format!("{}: {problem}", column.source()), mend.into()));
    }
    let samples = column.samples().map_err(|fault| wrong(fault.problem, fault.mend))?;
    let samples = attributes.scaled(samples);
    let times = time_columns(room, spec, cask_file.time.as_deref(), &column)?;
    times.first().map_or(Ok(()), |time| room.take(time))?;
    let why_none = if times.is_empty() { clocks::why_none(room.file, &column) } else { None };
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

/// The dataset or column that a cask file names.
fn locate(file: &Rc<File>, spec: &ChannelSpec, source: &str) -> Result<Column, IngestError> {
    find::find(file, source).map_err(|missing| match missing {
        find::Missing::Nowhere => error::source(
            &file.path,
            &spec.name,
            format!("there is no dataset {source}"),
            error::near_names(&file.path, source, "dataset", &list::sources(file)),
        ),
        find::Missing::Because(fault) => error::source(&file.path, &spec.name, fault.problem, fault.mend),
    })
}

/// The times: as the cask file names them, else siblings with a usual name and as many values; behind the ones to take, all others.
fn time_columns(
    room: &mut Room,
    spec: &ChannelSpec,
    time: Option<&str>,
    column: &Column,
) -> Result<Vec<Column>, IngestError> {
    let mut beside = room.clocks.of(room.file, column);
    if let Some(name) = spec.time.as_deref().or(time) {
        let named = named_times(room.file, spec, name, column)?;
        beside.retain(|other| other.source() != named.source());
        beside.insert(0, named);
    }
    Ok(beside)
}

fn named_times(
    file: &Rc<File>,
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
    locate(file, spec, name)
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
    let kind = decoded(&dataset.type_name);
    let Some(shape) = &dataset.shape else { return format!("{kind}, no data") };
    let shape: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let filters: Vec<String> = dataset.filters.iter().map(ToString::to_string).collect();
    let mut text = format!("{kind}, {}", if shape.is_empty() { "scalar".into() } else { shape.join(" × ") });
    if !filters.is_empty() {
        text.push_str(", ");
        text.push_str(&filters.join(" + "));
    }
    text
}

impl std::fmt::Display for Filter {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::Shuffle => f.write_str("shuffle"),
            Self::Deflate(level) => write!(f, "deflate({level})"),
            Self::Fletcher32 => f.write_str("fletcher32"),
            Self::Lzf => f.write_str("lzf"),
            Self::Other(what) => f.write_str(what),
        }
    }
}

#[cfg(test)]
mod layout_tests;
#[cfg(test)]
mod place_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod time_tests;
