//! Points of the trial to which of them no other beats.

use crate::lab::data::TrialPoint;

/// Two errors below this cannot be told apart: a few roundings of a double.
const ROUNDING: f64 = 1e-15;
/// Two errors or two times whose ratio is below this are alike: another seed, another run moves them as much.
const ALIKE: f64 = 1.1;

/// For each point whether it lies on the front: no other of its family, class and units is at least as accurate (95th
/// percentile) and at least as fast, and better in one of the two. Programs of others take no part and are on no front.
///
/// A rival is better only by more than 10 %, and faster only where the quartiles of the two times do not overlap either.
#[must_use]
pub fn front(points: &[TrialPoint]) -> Vec<bool> {
    let rivals = |a: &TrialPoint, b: &TrialPoint| {
        a.family == b.family
            && a.class == b.class
            && a.error_unit == b.error_unit
            && a.time_per == b.time_per
            && !a.is_peer()
    };
    let error = |p: &TrialPoint| p.p95_error.max(ROUNDING);
    let beats = |a: &TrialPoint, b: &TrialPoint| {
        let apart = |a: &TrialPoint, b: &TrialPoint| {
            ALIKE * a.time_ns < b.time_ns && a.time_quartiles_ns[1] < b.time_quartiles_ns[0]
        };
        let (faster, slower) = (apart(a, b), apart(b, a));
        (ALIKE * error(a) < error(b) && !slower) || (error(a) <= ALIKE * error(b) && faster)
    };
    points
        .iter()
        .map(|p| !p.is_peer() && !points.iter().any(|rival| rivals(rival, p) && beats(rival, p)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(class: &str, p95_error: f64, time_ns: f64) -> TrialPoint {
        TrialPoint {
            family: "filter".into(),
            method: String::new(),
            class: class.into(),
            is_default: false,
            median_error: p95_error,
            p95_error,
            error_unit: "1".into(),
            time_ns,
            time_quartiles_ns: [time_ns - 0.1, time_ns + 0.1],
            time_per: "sample".into(),
            cases: 1,
        }
    }

    #[test]
    fn the_front_is_what_no_other_beats() {
        let points = [
            point("a", 1e-3, 1.0),
            point("a", 1e-6, 5.0),
            point("a", 1e-5, 6.0),
            point("a", 1e-2, 1.05),
            point("b", 1.0, 9.0),
        ];
        assert_eq!(front(&points), [true, true, false, false, true]);
    }

    #[test]
    fn programs_of_others_take_no_part() {
        let mut peer = point("a", 1e-9, 1.0);
        peer.method = "scipy sosfiltfilt".into();
        assert_eq!(front(&[point("a", 1e-6, 5.0), peer]), [true, false]);
    }

    #[test]
    fn roundings_are_alike_and_the_faster_wins() {
        assert_eq!(front(&[point("a", 1e-16, 9.0), point("a", 9e-16, 5.0)]), [false, true]);
    }
}
