//! Compares the recorded free fall with the one that the cask file states.

use super::closures;
use crate::data::{
    Axis, CheckKind, CoarseEvent, Consistency, Drop, DropFinding, Events, Finding, FindingKind, MISSED_U,
    RestLevel, Tolerances, U_RELEASE_S,
};
use crate::numerics::as_f64;

/// A first touch earlier than this share of the fall time before first contact is another event, not a
/// delayed onset.
const MOST_LAG_SHARE: f64 = 0.02;

/// A fall is longer than free if it exceeds its length by this many standard uncertainties and the rest
/// levels agree; a scale error of all channels does not change its length.
const LEAST_FALL_U: f64 = 3.0;

/// Judges the fall, if its release was recorded.
pub fn judge_fall(drop: &Drop, events: &Events) -> Option<Finding> {
    events.release_s?;
    let (end_s, contact_s) = events.fall_end_s.zip(events.first_contact_s())?;
    let expected_s = drop.impact_velocity_m_s / drop.gravity_m_s2;
    let finding = DropFinding::SoftTouch { end_s, contact_s };
    (contact_s - end_s > MOST_LAG_SHARE * expected_s).then(|| Finding::from(finding).span(end_s, contact_s))
}

/// Compares the length of the recorded fall with v0, if no motion could be determined that includes this
/// comparison   (35)
pub fn judge_fall_time(
    found: &[Finding],
    drop: &Drop,
    events: &Events,
    tolerances: &Tolerances,
) -> Option<Finding> {
    let fallen_m_s = drop.gravity_m_s2 * (events.fall_end_s? - events.release_s?);
    let v0_m_s = drop.impact_velocity_m_s;
    // Half of a 95 % half-width is a standard uncertainty.
    let u_m_s = (drop.gravity_m_s2 * U_RELEASE_S)
        .hypot(v0_m_s * tolerances.impact_velocity / 2.0)
        .hypot(fallen_m_s * tolerances.clock / 2.0);
    let miss_in_u = (fallen_m_s - v0_m_s) / u_m_s;
    let closure = Consistency {
        name: "time of the free fall".into(),
        kind: CheckKind::Fall,
        channel: None,
        miss: format!("{:+.1} % of v0", 100.0 * (fallen_m_s / v0_m_s - 1.0)),
        miss_in_u,
        beside_others_in_u: miss_in_u,
    };
    (miss_in_u.abs() > MISSED_U && !found.iter().any(|f| missed_kind(f) == Some(CheckKind::Fall)))
        .then(|| closures::judge_missed(&closure, drop, events))
}

/// Kind of check that a finding reports as failed.
fn missed_kind(finding: &Finding) -> Option<CheckKind> {
    let FindingKind::Drop(DropFinding::Missed { closure, .. }) = &finding.what else { return None };
    Some(closure.kind)
}

/// Replaces the findings on rest levels and on the fall's length by one on a slow fall, if that explains them
/// all.
///
/// A guide, a rope or a brake that removes the share q of g leaves (1 − q) g cos φ of every step from rest to
/// fall, and the time √(2 h / (1 − q) g).
pub fn judge_slowed(
    mut found: Vec<Finding>,
    drop: &Drop,
    rests: &[RestLevel],
    events: &Events,
    tolerances: &Tolerances,
) -> Vec<Finding> {
    let explained = [Some(CheckKind::Rest), Some(CheckKind::Fall)];
    let is_explained = |f: &Finding| explained.contains(&missed_kind(f));
    let severity = found.iter().filter(|f| is_explained(f)).map(|f| f.severity).max();
    let slowed = slowed_share(drop, rests, events, tolerances);
    if let (Some(severity), Some((share, u))) = (severity, slowed) {
        found.retain(|f| !is_explained(f));
        let v0_m_s = drop.impact_velocity_m_s * (1.0 - share).sqrt();
        found.push(DropFinding::SlowedFall { share, u95: 2.0 * u, v0_m_s, severity }.into());
    }
    found
}

/// Share of g that a fall lacks, with its standard uncertainty, if all rest levels and the length of the fall
/// agree.
fn slowed_share(
    drop: &Drop,
    rests: &[RestLevel],
    events: &Events,
    tolerances: &Tolerances,
) -> Option<(f64, f64)> {
    let rests: Vec<&RestLevel> = rests.iter().filter(|r| r.axis == Axis::Transverse).collect();
    if drop.impact_velocity_given || rests.len() < 2 {
        return None;
    }
    let (sin, cos) = drop.angle_rad.sin_cos();
    let weight_m_s2 = drop.gravity_m_s2 * cos;
    // Half of a 95 % half-width is a standard uncertainty; the angle is one for all channels.
    let u_angle = tolerances.angle_rad / 2.0 * sin / cos;
    let u_cross = tolerances.cross_axis / 2.0 * sin / cos;
    let lack = |r: &RestLevel| {
        let u_own = (r.u_m_s2 / weight_m_s2).hypot(tolerances.calibration / 2.0).hypot(u_cross);
        (1.0 - r.rest_m_s2 / weight_m_s2, u_own)
    };
    let count = as_f64(rests.len());
    let mean = rests.iter().map(|r| lack(r).0).sum::<f64>() / count;
    let u_mean = rests.iter().map(|r| lack(r).1.powi(2)).sum::<f64>().sqrt() / count;
    let u_rest = u_mean.hypot(u_angle);
    let fall_s = events.fall_end_s? - events.release_s?;
    let free_s = drop.impact_velocity_m_s / drop.gravity_m_s2;
    let by_fall = 1.0 - (free_s / fall_s).powi(2);
    let u_fall = (2.0 * U_RELEASE_S / fall_s).hypot(tolerances.impact_velocity).hypot(tolerances.clock);
    let are_alike = rests.iter().map(|r| lack(r)).all(|(share, u)| (share - mean).abs() < MISSED_U * u)
        && (mean - by_fall).abs() < MISSED_U * u_rest.hypot(u_fall);
    let is_clear = mean > MISSED_U * u_rest && by_fall > LEAST_FALL_U * u_fall;
    let (w_rest, w_fall) = (u_rest.powi(-2), u_fall.powi(-2));
    (are_alike && is_clear)
        .then(|| ((w_rest * mean + w_fall * by_fall) / (w_rest + w_fall), (w_rest + w_fall).powf(-0.5)))
}

/// Reports another drop after the one at `event`.
pub fn judge_several_drops(event: &CoarseEvent, another: &CoarseEvent) -> Finding {
    let (from_s, to_s) = (another.near_s, another.near_s + another.spread_s);
    let finding = DropFinding::SeveralDrops {
        at_s: to_s,
        later_s: another.near_s - event.near_s,
        step_m_s: another.velocity_step_m_s.abs(),
        first_step_m_s: event.velocity_step_m_s.abs(),
    };
    Finding::from(finding).span(from_s, to_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{At, FindingKind};

    fn drop(given: bool) -> Drop {
        Drop { impact_velocity_m_s: 13.288, impact_velocity_given: given, ..Drop::from_height(9.0, 0.2) }
    }

    fn events(release_s: Option<f64>, end_s: f64, contact_s: f64) -> Events {
        Events {
            release_s,
            fall_end_s: release_s.map(|_| end_s),
            first_contact: Some(At::exact(contact_s)),
            ..Events::default()
        }
    }

    #[test]
    fn a_fall_as_stated_is_not_mentioned() {
        // √(2 · 9 / 9.81) s is 1.3546 s; 3 % are 0.0406 s.
        assert!(judge_fall(&drop(false), &events(Some(0.5), 1.86, 1.86)).is_none());
        assert!(judge_fall(&drop(false), &events(Some(0.5), 1.89, 1.89)).is_none());
        assert!(judge_fall(&drop(false), &events(None, 0.9, 0.9)).is_none());
    }

    #[test]
    fn a_fall_of_another_height_is_named_without_a_motion() {
        let judged = |found: &[Finding], contact_s| {
            judge_fall_time(
                found,
                &drop(false),
                &events(Some(0.5), contact_s, contact_s),
                &Tolerances::default(),
            )
        };
        // 1.3546 s ± 7 ms: 5 ms of the release and 0.3 % of v0.
        assert!(judged(&[], 1.8546).is_none() && judged(&[], 1.87).is_none());
        let found = judged(&[], 0.5 + 0.6386).expect("a fall from 2 m");
        assert!(found.message.contains("a free fall of 0.639 s, which is 2.00 m"), "{}", found.message);
        assert!(judged(&[found], 0.5 + 0.6386).is_none());
    }

    #[test]
    fn a_fall_that_rails_slow_is_named_as_such_and_a_scale_is_not() {
        let drop = drop(false);
        let slowed = |rest: f64, fall: f64, given: bool| {
            let rests: Vec<RestLevel> = ["A1", "A2"]
                .map(|name| RestLevel {
                    channel: name.into(),
                    axis: Axis::Transverse,
                    rest_m_s2: (1.0 - rest) * 9.81 * 0.2_f64.cos(),
                    u_m_s2: 0.02,
                })
                .into();
            let fall_s = 13.288 / 9.81 / (1.0 - fall).sqrt();
            let drop = Drop { impact_velocity_given: given, ..drop };
            let events = events(Some(0.5), 0.5 + fall_s, 0.5 + fall_s);
            let closure = Consistency {
                name: "rest level of A1".into(),
                kind: CheckKind::Rest,
                channel: Some("A1".into()),
                miss: "-5.0 %".into(),
                miss_in_u: -9.0,
                beside_others_in_u: -9.0,
            };
            let missed = closures::judge_missed(&closure, &drop, &events);
            judge_slowed(vec![missed], &drop, &rests, &events, &Tolerances::default()).remove(0).message
        };
        let said = slowed(0.05, 0.05, false);
        // 13.288 √0.95
        assert!(said.contains("slower than free by 5.0 ±") && said.contains("12.95 m/s"), "{said}");
        for (rest, fall, given) in
            [(0.05, 0.0, false), (0.05, 0.05, true), (-0.05, -0.05, false), (0.1, 0.05, false)]
        {
            assert!(!slowed(rest, fall, given).contains("slower"), "{rest} {fall} {given}");
        }
    }

    #[test]
    fn a_touch_before_the_impact_is_named() {
        let found = judge_fall(&drop(false), &events(Some(0.5), 1.86, 2.0)).expect("a touch");
        assert_eq!(found.what, FindingKind::Drop(DropFinding::SoftTouch { end_s: 1.86, contact_s: 2.0 }));
        assert!(found.message.contains("140 ms before"), "{}", found.message);
    }
}
