//! HDF5 datasets and columns to the channels that a cask file names, with their attributes and their own
//! times.

mod account;
mod answer;
mod attributes;
mod channel;
mod clocks;
mod column;
mod fault;
mod find;
#[cfg(all(windows, feature = "native"))]
mod job;
#[cfg(feature = "native")]
mod library;
mod list;
pub(super) mod names;
mod packed;
mod patience;
#[cfg(any(not(feature = "native"), test, fuzzing))]
mod pure;
#[cfg_attr(not(feature = "native"), allow(dead_code, reason = "a page starts no process"))]
mod room;
mod sensors;
mod starts;
mod tree;
mod types;
#[cfg(feature = "native")]
mod wall;

pub(super) use list::list;
#[cfg(not(feature = "native"))]
pub(super) use pure::READER;
#[cfg(any(test, fuzzing))]
pub(super) use room::answer_by;
#[cfg(feature = "native")]
pub use room::{Hdf5Program, use_program};

use super::refusal::Refusal;
use super::{RawChannel, RawRecording, ReadRequest};
use super::{error, error::IngestError};
use crate::data::{CaskFile, ChannelSpec, Source};
use crate::numerics::as_f64;
use account::Account;
use channel::{Based, DatasetChannel};
use room::File;
#[cfg(all(unix, feature = "native"))]
use std::ffi::OsString;
use std::rc::Rc;
#[cfg(feature = "native")]
use std::{
    io::{BufWriter, stdin, stdout},
    path::Path,
    process::ExitCode,
};

/// Whether an attribute of this name on samples says how they become a physical quantity.
#[must_use]
pub fn is_conversion(name: &str) -> bool {
    use names::AttributeRole::{Conversion, Offset, Scale};
    matches!(names::role(name, 0), Some(Scale | Offset | Conversion))
}

/// Where this process was started to take an HDF5 file apart: does so until nobody asks any more. Else
/// `program` is noted as the one to be started for it.
#[cfg(feature = "native")]
pub(super) fn serve(program: &Path) -> Option<ExitCode> {
    let mut words = std::env::args_os().skip(1);
    if words.next().is_none_or(|word| word != room::WORD) {
        #[cfg(unix)]
        begin_without_variables(program);
        use_program(Hdf5Program { path: program.to_owned(), ..Hdf5Program::default() });
        return None;
    }
    let path = words.next()?;
    Some(if take_apart(Path::new(&path)) { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// For a process that was started to take the file at `path` apart: closes it in and answers on standard
/// output what standard input asks, and says whether it could; then the process is to end.
#[cfg(feature = "native")]
#[must_use]
pub fn take_apart(path: &Path) -> bool {
    let mut wall = wall::Wall::around(path);
    let is_whole = wall.is_whole;
    let mut grant = |bytes, held_bytes| wall.grant(bytes, held_bytes);
    library::answer(path, &mut stdin().lock(), &mut BufWriter::new(stdout()), is_whole, &mut grant).is_ok()
}

/// Starts the program anew where variables are set by which the C library, which writes the curves of a
/// report in this process, would load code or take another driver: `HDF5_PLUGIN_PATH`, `HDF5_VOL_CONNECTOR`,
/// `HDF5_DRIVER` and the like.
#[cfg(all(unix, feature = "native"))]
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

/// The channels of `cask_file` from an HDF5 file.
///
/// # Errors
/// A damaged file, a source that is not there or holds no numbers, times that are none.
pub(super) fn read(request: ReadRequest, cask_file: &CaskFile) -> Result<RawRecording, IngestError> {
    let file = File::open(request.file, request.limits)?;
    let count = cask_file.channels.len().max(1);
    let (mut channels, mut account) = (Vec::with_capacity(count), Account::default());
    for (index, spec) in cask_file.channels.iter().enumerate() {
        let channel = read_channel(&file, spec, cask_file.time_source(spec), &mut account);
        // A library that broke off gives no answers, which is not what is wrong with the channel.
        file.whole()?;
        channels.push(channel?);
        let is_common = account.require_common_start();
        is_common.map_err(|fault| error::of_channel(request.file.path, &spec.name, fault))?;
        (request.progress)(as_f64(index + 1) / as_f64(count));
    }
    Ok(RawRecording { channels, zero_unix_ns: None, issues: Vec::new() })
}

fn read_channel(
    file: &Rc<File>,
    spec: &ChannelSpec,
    time: Option<&str>,
    account: &mut Account,
) -> Result<RawChannel, IngestError> {
    let refused = |fault: Refusal| error::of_channel(&file.path, &spec.name, fault);
    let Source::Path(source) = &spec.source else {
        return Err(refused(Refusal::new(
            "source gives a topic and a field, but this recording is HDF5",
            "write the dataset's path: source = \"/daq/a1\", or \"/daq/accel[2]\" for a column",
        )));
    };
    let column = find::locate(file, source).map_err(refused)?;
    account.take(&column)?;
    let sensors = channel::sensors_of(&column, spec.rows.as_ref(), account).map_err(refused)?;
    let channel = DatasetChannel::of(column, spec, time, sensors.as_ref(), account).map_err(refused)?;
    channel.times.first().map_or(Ok(()), |time| account.take(time))?;
    let samples = channel.samples().map_err(refused)?;
    let Based { mut uniform, start } = channel.on_base(samples, account).map_err(refused)?;
    let attributes = channel.attributes;
    uniform.issues.extend(attributes.issues);
    account.begin(&spec.source.to_string(), start);
    match attributes.two_units {
        // The cask file's goes before all.
        Some(two) if spec.unit.is_none() => Err(refused(two.at(source))),
        _ => Ok(RawChannel { uniform, unit: attributes.unit, factors: attributes.factors }),
    }
}

#[cfg(test)]
mod layout_tests;
#[cfg(test)]
mod said_tests;
#[cfg(test)]
mod tests;
