//! Reports an impact, an end, a slap-down or a flight that the analysis did not find.

use crate::data::{Cask, CoarseEvent, Drop, DropFinding, Finding, IssueCode, Severity, Tolerances};

/// Time after L left from which a record is not cut off before the slap-down, s: a cask of 5.5 m takes 65 ms
/// from 15°.
const LONG_ENOUGH_S: f64 = 0.3;

/// Fewest samples over the longest first pulse, 25 ms, that show an impact or its absence.
const LEAST_SAMPLES: f64 = 10.0;
pub(super) const LONGEST_PULSE_S: f64 = 0.025;

/// Share of the angle at which the corner lies under the centre of gravity; from there on a cask hardly
/// turns.
const STEEP_SHARE: f64 = 0.97;

/// Reports that no channel shows an impact, or none a rise that begins the change of velocity at `event`;
/// earlier findings may give the reason, or the sample rate of the struck end.
pub fn judge_no_impact(
    found: &[Finding],
    drop: &Drop,
    rate_hz: Option<f64>,
    event: Option<&CoarseEvent>,
) -> Finding {
    if let Some(rate_hz) = rate_hz.filter(|rate_hz| rate_hz * LONGEST_PULSE_S < LEAST_SAMPLES) {
        let (samples, least_hz) = (rate_hz * LONGEST_PULSE_S, 2.0 * LEAST_SAMPLES / LONGEST_PULSE_S);
        return DropFinding::TooSlow { rate_hz, samples, least_hz }.into();
    }
    let is_doubt = |f: &&Finding| f.code == IssueCode::Clock && f.severity == Severity::Warning;
    let doubt = found.iter().find(is_doubt).cloned().map(Box::new);
    let without_rise = event.copied();
    DropFinding::NoImpact { least_m_s: drop.least_impact_m_s(), doubt, without_rise }.into()
}

/// Reports that the second end shows no slap-down in the interval searched after the first one left; the
/// record may end there, or the drop may be too steep.
pub fn judge_no_slap_down(cask: &Cask, drop: &Drop, after_s: f64, is_record_end: bool) -> Finding {
    let finding = if let Some(too_steep) = too_steep(cask, drop) {
        too_steep
    } else if is_record_end && after_s < LONG_ENOUGH_S {
        DropFinding::EndsEarly { after_s }
    } else {
        DropFinding::NoSlapDown { after_s }
    };
    finding.into()
}

/// Reports an impact of L that lasts until R is down, which no impulse of L delays: no flight lies between
/// them.
pub fn judge_overlap(lasts_s: f64, cask: &Cask, drop: &Drop, tolerances: &Tolerances) -> Option<Finding> {
    let down_m_s = drop.impact_velocity_m_s
        + (drop.angular_velocity_rad_s - tolerances.angular_velocity_rad_s) * cask.length_m;
    let strikes_by_s = cask.length_m * (drop.angle_rad + tolerances.angle_rad).sin() / down_m_s;
    (down_m_s > 0.0 && lasts_s > strikes_by_s).then(|| DropFinding::Overlap { strikes_by_s, lasts_s }.into())
}

/// Reports a drop so steep that the second end does not strike.
pub(super) fn too_steep(cask: &Cask, drop: &Drop) -> Option<DropFinding> {
    let limit_deg = (2.0 * cask.cog_m / cask.height_m).atan().to_degrees();
    let angle_deg = drop.angle_rad.to_degrees();
    (angle_deg > STEEP_SHARE * limit_deg).then_some(DropFinding::TooSteep { angle_deg, limit_deg })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_ends_before_the_slap_down_only_where_it_ends() {
        let (cask, drop) = (Cask::block("rod", 1000.0, 5.0, 0.5), Drop::from_height(9.0, 0.3));
        let code = |after_s, is_record_end| judge_no_slap_down(&cask, &drop, after_s, is_record_end).code;
        let steep = judge_no_slap_down(&cask, &Drop::from_height(9.0, 1.5), 0.2, true);
        assert_eq!(steep.code, IssueCode::NoSlapDown);
        assert!(steep.message.contains("behind it (from 84.3° on"), "{}", steep.message);
        let nearly = judge_no_slap_down(&cask, &Drop::from_height(9.0, 83.0_f64.to_radians()), 0.2, true);
        assert!(nearly.message.contains("not yet under it (from 84.3° on"), "{}", nearly.message);
        assert_eq!(code(0.2, true), IssueCode::EndsEarly);
        assert_eq!(code(0.2, false), IssueCode::NoSlapDown);
        assert_eq!(code(0.7, true), IssueCode::NoSlapDown);
    }

    #[test]
    fn an_impact_overlaps_where_the_second_end_is_down_before_its_end() {
        let cask = Cask::block("rod", 1000.0, 5.0, 0.5);
        let overlaps = |lasts_s, angle_deg: f64| {
            judge_overlap(
                lasts_s,
                &cask,
                &Drop::from_height(9.0, angle_deg.to_radians()),
                &Tolerances::default(),
            )
        };
        // 5 m · sin 1.4° over 13.28 m/s less 1 °/s of 5 m: 9.3 ms.
        assert!(overlaps(9.2e-3, 1.0).is_none());
        assert_eq!(overlaps(9.4e-3, 1.0).expect("overlaps").code, IssueCode::SecondContact);
        assert!(overlaps(9.4e-3, 5.0).is_none());
    }

    #[test]
    fn a_rate_too_low_to_show_an_impact_denies_none() {
        let drop = Drop { impact_velocity_m_s: 6.26, ..Drop::from_height(2.0, 0.0) };
        let finding_at = |rate_hz| judge_no_impact(&[], &drop, Some(rate_hz), None);
        assert_eq!((finding_at(10.0).code, finding_at(10.0).severity), (IssueCode::LowRate, Severity::Error));
        assert_eq!(finding_at(198.0).code, IssueCode::LowRate);
        assert_eq!(finding_at(2000.0).code, IssueCode::NoImpact);
        let event = CoarseEvent { near_s: 1.5, spread_s: 0.025, velocity_step_m_s: -3.0 };
        let without_rise = judge_no_impact(&[], &drop, Some(2000.0), Some(&event)).message;
        assert!(without_rise.contains("changes by 3.0 m/s within 25 ms at 1.500 s"), "{without_rise}");
    }
}
