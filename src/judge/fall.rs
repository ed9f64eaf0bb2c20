//! The recorded free fall beside the one that the cask file states, to what speaks against them.

use crate::data::{CoarseEvent, Drop, Events, Issue, IssueCode, Severity};

/// A first touch this share of the fall time before first contact is another event, not a late onset.
const MOST_LAG: f64 = 0.02;

/// Checks the fall, where the recording shows it from its release on.
#[must_use]
pub fn judge_fall(drop: &Drop, events: &Events) -> Vec<Issue> {
    let (Some(_), Some(end_s)) = (events.release_s, events.fall_end_s) else { return Vec::new() };
    let warning = |message| Issue::new(IssueCode::Geometry, Severity::Warning, message);
    let mut issues = Vec::new();
    let expected_s = drop.impact_velocity_m_s / drop.gravity_m_s2;
    if let Some(contact_s) = events.first_contact_s().filter(|c| c - end_s > MOST_LAG * expected_s) {
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

/// Says that another drop follows the one at `event`.
#[must_use]
pub fn judge_several_drops(event: &CoarseEvent, another: &CoarseEvent) -> Issue {
    let (from_s, to_s) = (another.near_s, another.near_s + another.spread_s);
    Issue::new(
        IssueCode::SeveralDrops,
        Severity::Warning,
        format!(
            "the first end is struck once more at {to_s:.2} s, {:.1} s after the impact found, and changes its velocity by {:.1} m/s \
             ({:.1} m/s there): that is another drop. The first one was analysed; for the other, cut the recording between them in a copy",
            another.near_s - event.near_s,
            another.velocity_step_m_s.abs(),
            event.velocity_step_m_s.abs(),
        ),
    )
    .between(from_s, to_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::At;

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
            first_contact: Some(At::exactly(contact_s)),
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
    fn a_touch_before_the_impact_is_named() {
        let issues = judge_fall(&drop(false), &events(Some(0.5), 1.86, 2.0));
        assert_eq!(issues.len(), 1);
        assert!(issues[0].message.contains("140 ms before"), "{}", issues[0].message);
    }
}
