//! Measures the rotation of the cask with angular-rate sensors; the motion is compared with it.

use super::impact::Impact;
use crate::data::{
    Axis, CaskFile, Channel, DropResult, Events, Finding, FlightFit, MeasuredRotation, Recording,
};
use crate::{condition, judge, motion};

/// Measures the rotation with each sensor; omits those that cannot be right.
pub(super) fn measure_rotations(
    impact: &Impact,
    file: &CaskFile,
    flight: &FlightFit,
    events: &Events,
) -> Vec<MeasuredRotation> {
    let gained_rad_s = motion::rotation_rad_s(&impact.signals, flight);
    let read = impact.others.channels.iter().filter_map(|channel| read(channel, file, events, flight));
    read.filter(|rotation| judge::judge_rotation(rotation, gained_rad_s).is_none()).collect()
}

/// Measures the rotation with one channel, if it is an angular-rate sensor.
fn read(channel: &Channel, file: &CaskFile, events: &Events, flight: &FlightFit) -> Option<MeasuredRotation> {
    let spec = file.others.iter().find(|spec| spec.read.name == channel.name)?;
    let usual_s = condition::Reach::for_drop(&file.cask, &file.drop).before_s;
    condition::measured_rotation(channel, spec.rate?, usual_s, events, flight)
}

/// Reports a fault of a channel beside the accelerometers, if it is an angular-rate sensor.
pub(super) fn judge_sensor(
    channel: &Channel,
    recording: &Recording,
    file: &CaskFile,
    result: &DropResult,
) -> Option<Finding> {
    let flight = result.flight.as_ref()?;
    let across = recording.channels.iter().filter(|c| c.axis == Axis::Transverse);
    let gained_rad_s = motion::rotation_from_names(across.map(|c| (&c.name[..], c.position_m)), flight);
    let rotation = read(channel, file, &result.events, flight)?;
    judge::judge_rotation(&rotation, gained_rad_s).map(|found| found.tag(&channel.name))
}
