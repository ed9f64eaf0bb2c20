//! The recorded free fall beside the one that the cask file states, to what speaks against them.

use crate::data::{CoarseEvent, Drop, DropFinding, Events, Finding};

/// A first touch this share of the fall time before first contact is another event, not a late onset.
const MOST_LAG: f64 = 0.02;

/// Checks the fall, where the recording shows it from its release on.
#[must_use]
pub fn judge_fall(drop: &Drop, events: &Events) -> Option<Finding> {
    events.release_s?;
    let (end_s, contact_s) = events.fall_end_s.zip(events.first_contact_s())?;
    let expected_s = drop.impact_velocity_m_s / drop.gravity_m_s2;
    let found = DropFinding::SoftTouch { end_s, contact_s };
    (contact_s - end_s > MOST_LAG * expected_s).then(|| Finding::from(found).between(end_s, contact_s))
}

/// Says that another drop follows the one at `event`.
#[must_use]
pub fn judge_several_drops(event: &CoarseEvent, another: &CoarseEvent) -> Finding {
    let (from_s, to_s) = (another.near_s, another.near_s + another.spread_s);
    let found = DropFinding::SeveralDrops {
        at_s: to_s,
        later_s: another.near_s - event.near_s,
        step_m_s: another.velocity_step_m_s.abs(),
        first_step_m_s: event.velocity_step_m_s.abs(),
    };
    Finding::from(found).between(from_s, to_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{At, What};

    fn drop(given: bool) -> Drop {
        Drop { impact_velocity_m_s: 13.288, impact_velocity_given: given, ..Drop::of_height(9.0, 0.2) }
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
        assert!(judge_fall(&drop(false), &events(Some(0.5), 1.86, 1.86)).is_none());
        assert!(judge_fall(&drop(false), &events(Some(0.5), 1.89, 1.89)).is_none());
        assert!(judge_fall(&drop(false), &events(None, 0.9, 0.9)).is_none());
    }

    #[test]
    fn a_touch_before_the_impact_is_named() {
        let found = judge_fall(&drop(false), &events(Some(0.5), 1.86, 2.0)).expect("a touch");
        assert_eq!(found.what, What::Drop(DropFinding::SoftTouch { end_s: 1.86, contact_s: 2.0 }));
        assert!(found.message.contains("140 ms before"), "{}", found.message);
    }
}
