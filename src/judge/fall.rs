//! The recorded free fall beside the one that the cask file states, to what speaks against them.

use crate::data::{Drop, Events, Issue, IssueCode, Severity};

/// A rest level this far off g cos φ, beside three of its standard uncertainties, is a scale error: an angle 5° off moves it by 4 %.
const MOST_SCALE: f64 = 0.06;
const SURE: f64 = 3.0;
/// Fall times that differ by more contradict each other: 3 % are 6 % of the height, beyond any tape measure or air drag.
const MOST_DIFFERENCE: f64 = 0.03;
/// A first touch this share of the fall time before first contact is another event, not a late onset.
const MOST_LAG: f64 = 0.02;

/// Checks the fall, where the recording shows it from its release on.
#[must_use]
pub fn judge_fall(drop: &Drop, events: &Events) -> Vec<Issue> {
    let (Some(release_s), Some(end_s)) = (events.release_s, events.fall_end_s) else { return Vec::new() };
    let warning = |message| Issue::new(IssueCode::Geometry, Severity::Warning, message);
    let mut issues = Vec::new();
    let fall_s = end_s - release_s;
    let expected_s = drop.impact_velocity_m_s / drop.gravity_m_s2;
    if (fall_s / expected_s - 1.0).abs() > MOST_DIFFERENCE {
        let height_m = 0.5 * drop.gravity_m_s2 * fall_s * fall_s;
        let velocity_m_s = drop.gravity_m_s2 * fall_s;
        let stated = if drop.impact_velocity_given {
            format!("the impact velocity of {:.2} m/s", drop.impact_velocity_m_s)
        } else {
            format!("the drop height of {} m", drop.height_m)
        };
        issues.push(
            warning(format!(
                "the recording shows a free fall of {fall_s:.3} s, which is {height_m:.2} m and {velocity_m_s:.2} m/s; {stated} in the cask file needs {expected_s:.3} s: check it, and the recording's sample rate"
            ))
            .between(release_s, end_s),
        );
    }
    if let Some(contact_s) = events.first_contact_s.filter(|c| c - end_s > MOST_LAG * expected_s) {
        issues.push(
            warning(format!(
                "the free fall ends at {end_s:.3} s, {:.0} ms before the impact found at {contact_s:.3} s: something soft (water, a guide, a cable) was touched first, and the impact velocity is not that of a free fall",
                1e3 * (contact_s - end_s)
            ))
            .between(end_s, contact_s),
        );
    }
    issues
}

/// Holds a channel's step from rest to free fall and its standard uncertainty, m/s², against g cos φ: a scale that is off
/// shows there.
#[must_use]
pub fn judge_rest(channel: &str, (rest_m_s2, u_m_s2): (f64, f64), drop: &Drop) -> Option<Issue> {
    let expected_m_s2 = drop.gravity_m_s2 * drop.angle_rad.cos();
    let share = rest_m_s2 / expected_m_s2;
    ((share - 1.0).abs() > MOST_SCALE + SURE * u_m_s2 / expected_m_s2).then(|| {
        Issue::new(
            IssueCode::Scale,
            Severity::Warning,
            format!(
                "{channel} reads {:.3} g at rest where gravity gives {:.3} g: its scale seems {:+.0} % off; check sensitivity, unit and angle",
                rest_m_s2 / 9.806_65,
                expected_m_s2 / 9.806_65,
                100.0 * (share - 1.0)
            ),
        )
        .on(channel)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drop(given: bool) -> Drop {
        Drop {
            height_m: 9.0,
            angle_rad: 0.2,
            impact_velocity_m_s: 13.288,
            impact_velocity_given: given,
            gravity_m_s2: 9.81,
        }
    }

    fn events(release_s: Option<f64>, end_s: f64, contact_s: f64) -> Events {
        Events {
            release_s,
            fall_end_s: release_s.map(|_| end_s),
            first_contact_s: Some(contact_s),
            ..Events::default()
        }
    }

    #[test]
    fn a_fall_as_stated_is_not_mentioned() {
        // √(2 · 9 / 9.81) s is 1.3546 s; 3 % are 0.0406 s.
        assert!(judge_fall(&drop(false), &events(Some(0.5), 1.86, 1.86)).is_empty());
        assert!(judge_fall(&drop(false), &events(Some(0.5), 1.89, 1.89)).is_empty());
        assert!(judge_fall(&drop(false), &events(None, 0.9, 0.9)).is_empty());
    }

    #[test]
    fn a_rest_level_is_held_against_gravity_within_what_it_is_known_to() {
        let expected_m_s2 = 9.81 * 0.2_f64.cos();
        assert!(judge_rest("A1", (1.05 * expected_m_s2, 0.01), &drop(false)).is_none());
        assert!(judge_rest("A1", (0.83 * expected_m_s2, 0.4), &drop(false)).is_none());
        let off = judge_rest("A1", (0.83 * expected_m_s2, 0.05), &drop(false)).expect("17 % off");
        assert!(off.message.contains("-17 %"), "{}", off.message);
    }

    #[test]
    fn a_wrong_height_is_contradicted_by_the_fall() {
        let issues = judge_fall(&drop(false), &events(Some(0.5), 1.0, 1.0));
        assert_eq!(issues.len(), 1);
        assert!(issues[0].message.contains("0.500 s") && issues[0].message.contains("1.23 m"));
        assert!(issues[0].message.contains("drop height of 9 m"), "{}", issues[0].message);
        let given = judge_fall(&drop(true), &events(Some(0.5), 1.0, 1.0));
        assert!(given[0].message.contains("impact velocity of 13.29 m/s"), "{}", given[0].message);
    }

    #[test]
    fn a_touch_before_the_impact_is_named() {
        let issues = judge_fall(&drop(false), &events(Some(0.5), 1.86, 2.0));
        assert_eq!(issues.len(), 1);
        assert!(issues[0].message.contains("140 ms before"), "{}", issues[0].message);
    }
}
