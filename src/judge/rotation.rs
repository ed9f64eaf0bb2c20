//! The rotation by an angular-rate sensor beside that by the accelerometers to what is wrong with the sensor.

use crate::data::{AtRest, Channel, ChannelFinding, Finding, MeasuredRotation, RestFinding, RotationCause};

/// Rotation by the first impact below which a sensor is not judged by it, rad/s: a tenth of a slap-down's.
const LEAST_RAD_S: f64 = 0.3;
/// A share of the rotation within this of a cause's is explained by it, a smaller one than the smallest
/// cause's by none.
const WITHIN: f64 = 0.2;
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// What is wrong with a sensor by the share of the rotation that it has the first impact give; it takes no
/// part in the motion then.
pub fn judge_rotation(read: &MeasuredRotation, gained_rad_s: f64) -> Option<ChannelFinding> {
    if gained_rad_s.abs() < LEAST_RAD_S {
        return None;
    }
    let share = read.gained.rad_s / gained_rad_s;
    let is_near = |of: f64| (share.abs() / of - 1.0).abs() < WITHIN;
    let cause = match () {
        () if is_near(DEGREES) || is_near(1.0 / DEGREES) => RotationCause::Unit,
        () if share.abs() < 1.0 / DEGREES => RotationCause::Nothing,
        () if is_near(1.0) && share < 0.0 => RotationCause::Sign,
        () => return None,
    };
    Some(ChannelFinding::OtherRotation { share, cause })
}

/// What an angular-rate sensor reads at rest, where it must read 0; `unit_rad_s` is that of its level.
pub fn judge_rate_level(channel: &Channel, rest: AtRest, unit_rad_s: f64) -> Finding {
    let found = match () {
        () if rest.least_step_m_s2 == 0.0 => RestFinding::OneValue,
        () if !rest.is_still => RestFinding::Turning,
        () => RestFinding::Rate { reads_deg_s: DEGREES * unit_rad_s * rest.level_m_s2 },
    };
    found.on(&channel.name)
}
