//! The recordings of a drop to one, on the clock of the first: all show the first contact at one time.

use super::impact::{OwnContact, own_contact};
use super::{rest, simulation};
use crate::data::{
    BENDING_WAVE_M_S, CaskFile, DropFinding, End, JoinedRecording, Onset, Recording, transverse,
};
use crate::events;
use crate::ingest::refusal::Refusal;
use crate::ingest::{self, IngestError, Limits, Progress, RecordingFile, error};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Reads the channels that `cask_file` names from the recording at `path`, its format told by its content,
/// and from the files beside it that the cask file names: other recorders, the rest before the drop, the
/// calculation.
///
/// # Errors
/// [`IngestError`] where a file, a source or its content is at fault.
pub fn read(path: &Path, cask_file: &CaskFile, progress: Progress) -> Result<Recording, IngestError> {
    read_within(path, cask_file, Limits::default(), progress)
}

/// As [`read`], within other limits than the usual ones.
///
/// # Errors
/// As [`read`]; also where a file would pass a limit.
pub fn read_within<'a>(
    recording: impl Into<RecordingFile<'a>>,
    cask_file: &CaskFile,
    limits: Limits,
    progress: Progress,
) -> Result<Recording, IngestError> {
    let mut recording = ingest::read_within(recording, cask_file, limits, progress)?;
    complete(&mut recording, cask_file, limits)?;
    Ok(recording)
}

/// Adds what the cask file names beside the recording: the channels of other recorders, what all read at rest
/// in a file of its own, and the calculation.
///
/// # Errors
/// As [`read`].
pub fn complete(recording: &mut Recording, file: &CaskFile, limits: Limits) -> Result<(), IngestError> {
    join(recording, file, limits)?;
    rest::take_rest(recording, file, limits)?;
    recording.calculation = simulation::calculation(file, limits)?;
    Ok(())
}

/// Adds the channels that the cask file has of other recordings, their clocks joined at the first contact.
fn join(recording: &mut Recording, file: &CaskFile, limits: Limits) -> Result<(), IngestError> {
    let all = file.channels.iter().chain(file.others.iter().map(|other| &other.read));
    let mut names: Vec<&str> = all.filter_map(|spec| spec.file.as_deref()).collect();
    names.sort_unstable();
    names.dedup();
    // Each against the recording as it was read: none hangs on another one's shift.
    let main = if names.is_empty() { None } else { own_contact(recording, &file.for_recorder(None)) };
    for name in names {
        let path = file.path.parent().unwrap_or(Path::new("")).join(name);
        let refuse = |problem: &str, mend: &str| Err(error::of_file(&path, Refusal::new(problem, mend)));
        let of_file = file.for_recorder(Some(name));
        if of_file.channels.is_empty() {
            let mend = "add one accelerometer of this recorder with end = \"first\" or \"second\"";
            return refuse("no accelerometer of this recording joins its clock to the other one", mend);
        }
        let mut second = ingest::read_within(&path, &of_file, limits, &|_| ())?;
        if second.sha256 == recording.sha256 {
            let mend = "delete `file`: without it the channel is in the recording that is analysed";
            return refuse("this is the recording that is analysed, under another name", mend);
        }
        let own = own_contact(&second, &of_file);
        let (Some(main), Some(own)) = (&main, own) else {
            let mend = "check `source`, `unit` and `end` of its channels: each recorder needs one that shows \
                        the first impact, by which the clocks are joined";
            return refuse("no first impact is seen in it, or in the recording that is analysed", mend);
        };
        let mut joined = joined(name, main, own, file.cask.length_m);
        shift(&mut second, joined.shift_s);
        // By the times that stand in both files.
        joined.shift_s += match (recording.start_unix_ns, second.start_unix_ns) {
            (Some(first_ns), Some(second_ns)) => {
                let apart_s = Duration::from_nanos(first_ns.abs_diff(second_ns)).as_secs_f64();
                if first_ns < second_ns { -apart_s } else { apart_s }
            }
            _ => recording.first_s - second.first_s,
        };
        let others = std::mem::take(&mut second.others);
        recording.channels.append(&mut second.channels);
        recording.issues.append(&mut second.issues);
        if let (Some(all), Ok(mut others)) = (Arc::get_mut(&mut recording.others), Arc::try_unwrap(others)) {
            all.channels.append(&mut others.channels);
            all.issues.append(&mut others.issues);
        }
        let said = DropFinding::Joined { file: name.into(), shift_s: joined.shift_s, u_s: joined.u_s };
        recording.issues.push(said.into());
        recording.joined.push(JoinedRecording { sha256: second.sha256, ..joined });
    }
    // Times count from the earliest first sample.
    let first_s = recording.channels.iter().map(|channel| channel.start_s).fold(0.0, f64::min);
    if first_s < 0.0 {
        shift(recording, -first_s);
        recording.start_unix_ns =
            recording.start_unix_ns.map(|ns| ns.saturating_add(crate::numerics::nanoseconds(first_s)));
        recording.before_trigger_s = recording.before_trigger_s.map(|before_s| before_s - first_s);
    }
    Ok(())
}

/// What is added to the times of the second recorder, by the channel whose answer tells it best.
fn joined(name: &str, main: &OwnContact, mut second: OwnContact, length_m: f64) -> JoinedRecording {
    let rough_s = main.at.time_s - second.at.time_s;
    for signal in &mut second.signals {
        signal.start_s += rough_s;
    }
    let ends = [&main.signals, &second.signals]
        .map(|signals| [End::First, End::Second].map(|end| transverse(signals, end).is_some()));
    let channels: Vec<String> = second.signals.iter().map(|signal| signal.name.clone()).collect();
    let all = [main.signals.clone(), second.signals].concat();
    let is_own = |name: &String| channels.contains(name);
    let struck_in_own = transverse(&all, End::First).is_some_and(|struck| is_own(&struck.name));
    let answers = events::answers(&all, main.at.time_s);
    let of_other = answers.iter().filter(|onset| is_own(&onset.channel) != struck_in_own);
    let best = of_other.min_by(|a, b| a.u_s.total_cmp(&b.u_s));
    let (more_s, u_s) = match best {
        Some(Onset { delay_s, u_s, .. }) if struck_in_own => (*delay_s, *u_s),
        Some(Onset { delay_s, u_s, .. }) => (-delay_s, *u_s),
        None => (0.0, main.at.u_s.hypot(second.at.u_s)),
    };
    // Between the ends it is not told from the way of a bending wave.
    let shares_an_end = (0..2).any(|end| ends[0][end] && ends[1][end]);
    let u_way_s = if shares_an_end { 0.0 } else { length_m / BENDING_WAVE_M_S / 12.0_f64.sqrt() };
    JoinedRecording {
        file: name.to_owned(),
        sha256: String::new(),
        shift_s: rough_s + more_s,
        u_s: u_s.hypot(u_way_s),
        channels,
    }
}

/// Adds to all times of a recording.
fn shift(recording: &mut Recording, by_s: f64) {
    let of_others = Arc::get_mut(&mut recording.others);
    let (others, their_issues) = of_others
        .map_or((&mut [][..], &mut [][..]), |others| (&mut others.channels[..], &mut others.issues[..]));
    for channel in recording.channels.iter_mut().chain(others) {
        channel.start_s += by_s;
    }
    for issue in recording.issues.iter_mut().chain(their_issues) {
        issue.from_s = issue.from_s.map(|from_s| from_s + by_s);
        issue.to_s = issue.to_s.map(|to_s| to_s + by_s);
    }
}
