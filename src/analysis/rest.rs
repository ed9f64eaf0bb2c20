//! Adds the levels at rest to a recording's channels, from the file with the rest before the drop.

use crate::data::shown;
use crate::data::{
    CaskFile, Channel, Coupling, Finding, Recording, RestFile, RestFinding, RestLevel, RestReading, Signal,
    rate_unit_rad_s,
};
use crate::events;
use crate::ingest::refusal::Refusal;
use crate::ingest::{self, IngestError, Limits, error};
use std::path::Path;
use std::sync::Arc;

/// Recordings of one recorder state rates that differ by less than this share.
const SAME_RATE: f64 = 0.01;

/// Reads the levels of the channels at rest from the file that the cask file names, if it names one.
///
/// # Errors
/// [`IngestError`] if that file cannot be read, or does not hold the same sensors at rest.
pub(super) fn read_rest_file(
    recording: &mut Recording,
    file: &CaskFile,
    limits: Limits,
) -> Result<(), IngestError> {
    let Some(path) = &file.rest else { return Ok(()) };
    let rest = ingest::read_within(path, file, limits, &|_| ())?;
    if rest.sha256 == recording.sha256 {
        let mend = "name a file of the rest before the drop; rest in the recording itself needs no `rest`";
        return Err(error::of_file(path, Refusal::new("this is the recording of the drop", mend)));
    }
    let found: Vec<Finding> =
        rest.issues.iter().filter_map(|found| rest_file_finding(found, path, recording)).collect();
    recording.issues.extend(found);
    let refuse = |channel: &Channel, (problem, mend): (String, &str)| {
        error::of_channel(path, &channel.name, Refusal::new(problem, mend))
    };
    for channel in &mut recording.channels {
        let Some(at_rest) = rest.channels.iter().find(|at_rest| at_rest.name == channel.name) else {
            continue;
        };
        let weight = events::feels_gravity(channel, &file.drop).then_some(file.drop.gravity_m_s2);
        channel.rest = rest_reading(channel, at_rest, weight).map_err(|why| refuse(channel, why))?;
    }
    // No other owner has the recording yet.
    let others = Arc::get_mut(&mut recording.others).map_or(&mut [][..], |others| &mut others.channels);
    for (channel, at_rest) in others.iter_mut().zip(&rest.others.channels) {
        let Some(weight) = rate_weight(channel, file) else { continue };
        channel.rest = rest_reading(channel, at_rest, Some(weight)).map_err(|why| refuse(channel, why))?;
    }
    recording.rest = Some(RestFile { path: path.clone(), sha256: rest.sha256 });
    Ok(())
}

/// Turns a finding on the file of the rest into a note on the drop; `None` if the recording has it too.
fn rest_file_finding(found: &Finding, path: &Path, recording: &Recording) -> Option<Finding> {
    let is_known = recording.issues.iter().any(|known| known.message == found.message);
    let [file, message] = [path.display().to_string(), found.message.clone()];
    let in_file = RestFinding::InRestFile { file, found: message, what: found.code };
    (!is_known).then(|| Finding { channel: found.channel.clone(), ..in_file.into() })
}

/// Replacement of gravity for the level at rest of an angular-rate sensor, in its unit: it is at rest within
/// 2 % of it, 1°/s. `None` for another channel.
pub(super) fn rate_weight(channel: &Channel, file: &CaskFile) -> Option<f64> {
    let spec = file.others.iter().find(|spec| spec.read.name == channel.name)?;
    spec.rate.and_then(|_| Some(50.0_f64.to_radians() / rate_unit_rad_s(&channel.unit)?))
}

/// Reads the level of a drop's channel in the file with its rest; `None` if it does not respond to a
/// `weight`. The error is the fault of that file and its correction.
fn rest_reading(
    channel: &Channel,
    at_rest: &Channel,
    weight: Option<f64>,
) -> Result<Option<RestReading>, (String, &'static str)> {
    let rates = [at_rest, channel].map(|channel| channel.sample_rate_hz);
    let [there, here] = if (rates[1] / rates[0] - 1.0).abs() > SAME_RATE {
        rates.map(|rate_hz| format!("{} Hz", shown::hz(rate_hz)))
    } else {
        [&at_rest.unit, &channel.unit].map(Clone::clone)
    };
    if here != there {
        let problem = format!("{there} in this file of the rest, {here} in the recording of the drop");
        return Err((problem, "record the rest as the drop, take `rest` out, or state what is right"));
    }
    let Some(weight) = weight.filter(|_| channel.coupling == Coupling::Dc) else { return Ok(None) };
    let Some(rest) = events::at_rest(at_rest, weight) else {
        return Err((
            "its rest is shorter than 0.1 s".into(),
            "record the cask at rest for a second or more",
        ));
    };
    let (level, u) = (rest.level_m_s2 / channel.scale_m_s2, rest.u_m_s2 / channel.scale_m_s2.abs());
    let moves = "it does not rest in this file: its level changes by more than 2 % of g, or 1°/s";
    let mend = "cut the file to where the cask hangs still; `dropcheck check` says what else is wrong";
    if rest.is_still { Ok(Some(RestReading { level, u })) } else { Err((moves.into(), mend)) }
}

/// Returns the levels at rest from a separate file, less those in the free fall.
pub(super) fn levels(
    recording: &Recording,
    signals: &[Signal],
    file: &CaskFile,
    contact_s: f64,
) -> Vec<RestLevel> {
    let level = |channel: &Channel| {
        let rest = channel.rest?;
        let signal = signals.iter().find(|signal| signal.name == channel.name)?;
        let is_known = file.corrections.offset && signal.free_fall_s > 0.0;
        let from_offset = || RestLevel {
            channel: channel.name.clone(),
            axis: channel.axis,
            rest_m_s2: channel.scale_m_s2 * rest.level - signal.removed_offset_m_s2,
            u_m_s2: (channel.scale_m_s2 * rest.u).hypot(signal.u_offset_m_s2),
        };
        let level = || events::rest_level(channel, rest, &file.drop, contact_s).unwrap_or_else(from_offset);
        is_known.then(level)
    };
    recording.channels.iter().filter_map(level).collect()
}
