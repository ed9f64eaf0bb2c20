//! Joins the recordings of a drop into one, on the clock of the first: all show the first contact at one
//! time.

use super::impact::{RecorderContact, recorder_contact};
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

/// Reads the channels that `cask_file` names from the recording at `path`, whose format is recognised by its
/// content, and from the files that the cask file names: other recorders, the rest before the drop, the
/// calculation.
///
/// # Errors
/// [`IngestError`] if a file, a source or its content is at fault.
pub fn read(path: &Path, cask_file: &CaskFile, progress: Progress) -> Result<Recording, IngestError> {
    read_within(path, cask_file, Limits::default(), progress)
}

/// Like [`read`], within other limits than the usual ones.
///
/// # Errors
/// Those of [`read`]; also if a file would pass a limit.
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

/// Adds the other files that the cask file names: the channels of other recorders, the levels at rest in a
/// separate file, and the calculation.
///
/// # Errors
/// Those of [`read`].
pub fn complete(recording: &mut Recording, file: &CaskFile, limits: Limits) -> Result<(), IngestError> {
    join_recorders(recording, file, limits)?;
    rest::read_rest_file(recording, file, limits)?;
    recording.calculation = simulation::read_curves(file, limits)?;
    Ok(())
}

/// Adds the channels of other recorders that the cask file names, with their clocks joined at the first
/// contact.
fn join_recorders(recording: &mut Recording, file: &CaskFile, limits: Limits) -> Result<(), IngestError> {
    let all = file.channels.iter().chain(file.others.iter().map(|other| &other.read));
    let mut names: Vec<&str> = all.filter_map(|spec| spec.file.as_deref()).collect();
    names.sort_unstable();
    names.dedup();
    // Each is joined to the recording as it was read, so that no shift depends on another.
    let main = if names.is_empty() { None } else { recorder_contact(recording, &file.for_recorder(None)) };
    for name in names {
        let path = file.path.parent().unwrap_or(Path::new("")).join(name);
        let refuse = |problem: &str, mend: &str| Err(error::of_file(&path, Refusal::new(problem, mend)));
        let recorder_file = file.for_recorder(Some(name));
        if recorder_file.channels.is_empty() {
            let mend = "add one accelerometer of this recorder with end = \"first\" or \"second\"";
            return refuse("no accelerometer of this recording joins its clock to the other one", mend);
        }
        let mut second = ingest::read_within(&path, &recorder_file, limits, &|_| ())?;
        if second.sha256 == recording.sha256 {
            let mend = "delete `file`: without it the channel is in the recording that is analysed";
            return refuse("this is the recording that is analysed, under another name", mend);
        }
        let own = recorder_contact(&second, &recorder_file);
        let (Some(main), Some(own)) = (&main, own) else {
            let mend = "check `source`, `unit` and `end` of its channels: each recorder needs one that shows \
                        the first impact, by which the clocks are joined";
            return refuse("no first impact is seen in it, or in the recording that is analysed", mend);
        };
        let mut joined = join_clocks(main, own, file.cask.length_m);
        shift_times(&mut second, joined.shift_s);
        // The stated shift refers to the absolute times in both files.
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
        let note = DropFinding::Joined { file: name.into(), shift_s: joined.shift_s, u_s: joined.u_s };
        recording.issues.push(note.into());
        recording.joined.push(JoinedRecording { file: name.into(), sha256: second.sha256, ..joined });
    }
    // Times count from the earliest first sample.
    let first_s = recording.channels.iter().map(|channel| channel.start_s).fold(0.0, f64::min);
    if first_s < 0.0 {
        shift_times(recording, -first_s);
        recording.start_unix_ns =
            recording.start_unix_ns.map(|ns| ns.saturating_add(crate::numerics::nanoseconds(first_s)));
        recording.before_trigger_s = recording.before_trigger_s.map(|before_s| before_s - first_s);
    }
    Ok(())
}

/// Determines the shift of the second recorder's times from the channel whose answer shows it best.
fn join_clocks(main: &RecorderContact, mut second: RecorderContact, length_m: f64) -> JoinedRecording {
    let rough_s = main.at.time_s - second.at.time_s;
    for signal in &mut second.signals {
        signal.start_s += rough_s;
    }
    let ends = [&main.signals, &second.signals]
        .map(|signals| [End::First, End::Second].map(|end| transverse(signals, end).is_some()));
    let channels: Vec<String> = second.signals.iter().map(|signal| signal.name.clone()).collect();
    let all = [main.signals.clone(), second.signals].concat();
    let is_own = |name: &String| channels.contains(name);
    let struck_in_second = transverse(&all, End::First).is_some_and(|struck| is_own(&struck.name));
    let answers = events::answers(&all, main.at.time_s);
    let from_other = answers.iter().filter(|onset| is_own(&onset.channel) != struck_in_second);
    let best = from_other.min_by(|a, b| a.u_s.total_cmp(&b.u_s));
    let (more_s, u_s) = match best {
        Some(Onset { delay_s, u_s, .. }) if struck_in_second => (*delay_s, *u_s),
        Some(Onset { delay_s, u_s, .. }) => (-delay_s, *u_s),
        None => (0.0, main.at.u_s.hypot(second.at.u_s)),
    };
    // Between the ends it cannot be separated from the delay of a bending wave.
    let shares_an_end = (0..2).any(|end| ends[0][end] && ends[1][end]);
    let u_way_s = if shares_an_end { 0.0 } else { length_m / BENDING_WAVE_M_S / 12.0_f64.sqrt() };
    JoinedRecording {
        file: String::new(),
        sha256: String::new(),
        shift_s: rough_s + more_s,
        u_s: u_s.hypot(u_way_s),
        channels,
    }
}

/// Shifts all times of a recording.
fn shift_times(recording: &mut Recording, by_s: f64) {
    let owned = Arc::get_mut(&mut recording.others);
    let (others, their_issues) =
        owned.map_or((&mut [][..], &mut [][..]), |others| (&mut others.channels[..], &mut others.issues[..]));
    for channel in recording.channels.iter_mut().chain(others) {
        channel.start_s += by_s;
    }
    for issue in recording.issues.iter_mut().chain(their_issues) {
        issue.from_s = issue.from_s.map(|from_s| from_s + by_s);
        issue.to_s = issue.to_s.map(|to_s| to_s + by_s);
    }
}
