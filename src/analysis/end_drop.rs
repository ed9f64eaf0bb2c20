//! Determines rebound and k of a cask that strikes with its end face, along its axis, from the axial
//! channels.

use super::impact::Impact;
use crate::data::planar::first_arm_m;
use crate::data::{
    At, Axis, CaskFile, Drop, DropFinding, End, Estimate, Events, Finding, FirstImpact, Signal, transverse,
};
use crate::fit::{self, COVERAGE};
use crate::numerics::noise::integral_uncertainty_by;
use crate::numerics::quadrature::running_integral;
use crate::numerics::{as_f64, robust};
use crate::{events, judge};

/// Shortest time over which the velocity after the contact is averaged, s, five periods of the first axial
/// mode of a cask of 5 m; a longer contact is averaged over its own length.
const FLIGHT_S: f64 = 0.01;
/// Time before first contact at which the integral starts, s: the free fall in it adds only noise.
const CLEAR_S: f64 = 1e-3;
/// Share of the contact's length after which its force has faded.
const FADING_SHARE: f64 = 0.25;

/// Impact and rebound of the cask along its axis.
pub(super) struct EndImpact {
    pub first: FirstImpact,
    pub k: Estimate,
}

/// Returns the events and the impact as the axial channels show it; adds findings on anything that prevents
/// it.
pub(super) fn end_impact(
    impact: &Impact,
    file: &CaskFile,
    findings: &mut Vec<Finding>,
) -> (Events, Option<EndImpact>) {
    let axial = || impact.signals.iter().filter(|signal| signal.axis == Axis::Axial);
    let nearest = axial().min_by(|a, b| a.position_m.total_cmp(&b.position_m));
    let separation = nearest.and_then(|signal| find_separation(signal, impact.contact.time_s));
    let events = Events { separation, ..impact.events() };
    let after_s = impact.search_end_s - separation.map_or(impact.contact.time_s, |at| at.time_s);
    findings.push(judge::judge_no_slap_down(&file.cask, &file.drop, after_s, impact.is_record_end));
    findings.extend(nearest.is_none().then(|| DropFinding::NoAxial.into()));
    let rebound = find_rebound(impact, file, &events);
    if let Some(wrong) = rebound.as_ref().filter(|rebound| !judge::is_restitution(rebound.k)) {
        findings.push(DropFinding::Restitution { k: wrong.k }.into());
        return (events, None);
    }
    (events, rebound)
}

/// Time at which the end leaves the target, from an axial channel.
fn find_separation(signal: &Signal, contact_s: f64) -> Option<At> {
    let left_s = events::first_separation(signal, contact_s, signal.end_s())?;
    let by_force = At { time_s: left_s, u_s: 1.0 / signal.sample_rate_hz };
    let flight_s = left_s + FADING_SHARE * (left_s - contact_s)..signal.end_s();
    Some(events::refine_end(signal, contact_s, by_force, &flight_s))
}

/// Averages the axial channels that show the impact completely   (57)
fn find_rebound(impact: &Impact, file: &CaskFile, events: &Events) -> Option<EndImpact> {
    let (contact, left) = events.first_contact.zip(events.separation)?;
    let axial = impact.signals.iter().filter(|signal| signal.axis == Axis::Axial);
    let gain = |signal: &Signal| gain(signal, events, file);
    let gains: Vec<Estimate> = axial.clone().filter_map(gain).collect();
    let values: Vec<f64> = gains.iter().map(|gain| gain.value).collect();
    let count = as_f64(gains.len());
    let (mean_m_s, spread_m_s) = robust::mean_and_rms(&values);
    // Calibrations may have an error in common, which no mean reduces.
    let u95_own_m_s = gains.iter().map(|gain| gain.u95).sum::<f64>() / count;
    let u95_spread_m_s = COVERAGE * spread_m_s / (count - 1.0).max(1.0).sqrt();
    // The struck corner, or a sensor off the axis, may move differently from the axis by this much.
    let corner_m = first_arm_m(file.cask.cog_m, file.cask.height_m, file.drop.angle_rad);
    let arm_m = axial.map(|signal| signal.offset_m.abs()).fold(corner_m.abs(), f64::max);
    let rotation_m_s = rotation_rad_s(&impact.signals, gain).unwrap_or(0.0) * arm_m;
    let u95_rotation_m_s = COVERAGE * rotation_m_s.abs() / 3.0_f64.sqrt();
    let u95_m_s = u95_own_m_s.hypot(u95_spread_m_s).hypot(u95_rotation_m_s);
    let Drop { impact_velocity_m_s: v0_m_s, gravity_m_s2, angle_rad, .. } = file.drop;
    let (lasts_s, v0_u95_m_s) = (left.time_s - contact.time_s, file.tolerances.impact_velocity * v0_m_s);
    let gained_m_s = mean_m_s / angle_rad.sin() - gravity_m_s2 * lasts_s;
    let share = gained_m_s / v0_m_s;
    let k_u95 = (u95_m_s / v0_m_s).hypot(share * file.tolerances.impact_velocity);
    let first = FirstImpact {
        impact_velocity: Some(Estimate::new(v0_m_s, v0_u95_m_s, "m/s")),
        rebound_velocity: Some(Estimate::new(gained_m_s - v0_m_s, u95_m_s.hypot(v0_u95_m_s), "m/s")),
        duration: Some(Estimate::new(lasts_s, COVERAGE * contact.u_s.hypot(left.u_s), "s")),
        ..FirstImpact::default()
    };
    (!gains.is_empty()).then(|| EndImpact { first, k: Estimate::new(share - 1.0, k_u95, "1") })
}

/// Velocity that a channel gains from first contact to the flight, m/s; `None` if samples are clipped or
/// missing.
fn gain(signal: &Signal, events: &Events, file: &CaskFile) -> Option<Estimate> {
    let (contact_s, left_s) = events.first_contact_s().zip(events.separation_s())?;
    let from_s = contact_s - CLEAR_S;
    let until_s = left_s + FLIGHT_S.max(left_s - contact_s);
    let is_lost = [&signal.clipped, &signal.gaps].iter().any(|spans| signal.overlaps(spans, from_s, until_s));
    let [from, left, to] = [from_s, left_s, until_s].map(|time_s| signal.index_from(time_s));
    let velocity_m_s = running_integral(signal.force_m_s2.get(from..to)?, 1.0 / signal.sample_rate_hz);
    let after_m_s = velocity_m_s.get(left.checked_sub(from)?..).filter(|m_s| !is_lost && m_s.len() > 1)?;
    let (value_m_s, u_ringing_m_s) = robust::mean_and_u(after_m_s);
    let length_s = f64::midpoint(left_s, until_s) - from_s;
    let noise_m_s = integral_uncertainty_by(&signal.noise_spectrum, signal.free_fall_s, length_s);
    let u_own_m_s = u_ringing_m_s.hypot(noise_m_s.max(signal.u_offset_m_s2 * length_s));
    let u_scale_m_s = value_m_s * (file.scale_half_width(&signal.name) / COVERAGE).hypot(signal.u_around);
    let u_strain_m_s = fit::u_base_strain_m_s(signal, events, &file.tolerances);
    let u_m_s = u_own_m_s.hypot(u_scale_m_s).hypot(u_strain_m_s);
    Some(Estimate::new(value_m_s, COVERAGE * u_m_s, "m/s"))
}

/// Angular velocity of the cask from the transverse channels of both ends, rad/s; `None` without these.
fn rotation_rad_s(signals: &[Signal], gain: impl Fn(&Signal) -> Option<Estimate>) -> Option<f64> {
    let (first, second) = transverse(signals, End::First).zip(transverse(signals, End::Second))?;
    Some((gain(first)?.value - gain(second)?.value) / (second.position_m - first.position_m))
}
