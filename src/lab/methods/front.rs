//! Points of the trial to which of them no other beats.

use crate::lab::data::TrialPoint;

/// Two errors below this cannot be told apart: a few roundings of a double.
const ROUNDING: f64 = 1e-15;
/// Two errors or two times whose ratio is below this are alike: another seed, another run moves them as much.
const ALIKE: f64 = 1.1;

/// Marks the points on the front: no other of their family and class is at least as accurate (95th
/// percentile) and at least as fast, and better in one of the two.
///
/// Another is better only by more than 10 %, and faster only where the quartiles of the two times do not
/// overlap either.
pub(super) fn mark_front(points: &mut [TrialPoint]) {
    let is_beside =
        |a: &TrialPoint, b: &TrialPoint| a.cases > 0 && a.family == b.family && a.class == b.class;
    let error = |p: &TrialPoint| p.p95_error.max(ROUNDING);
    let is_faster = |a: &TrialPoint, b: &TrialPoint| {
        ALIKE * a.time_ns < b.time_ns && a.time_quartiles_ns[1] < b.time_quartiles_ns[0]
    };
    let beats = |a: &TrialPoint, b: &TrialPoint| {
        (ALIKE * error(a) < error(b) && !is_faster(b, a)) || (error(a) <= ALIKE * error(b) && is_faster(a, b))
    };
    let is_on_front =
        |p: &TrialPoint| p.cases > 0 && !points.iter().any(|other| is_beside(other, p) && beats(other, p));
    let front: Vec<bool> = points.iter().map(is_on_front).collect();
    for (point, is_on_front) in points.iter_mut().zip(front) {
        point.is_on_front = is_on_front;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(class: &str, p95_error: f64, time_ns: f64) -> TrialPoint {
        let time_quartiles_ns = [time_ns - 0.1, time_ns + 0.1];
        let class = class.into();
        TrialPoint { class, p95_error, time_ns, time_quartiles_ns, cases: 1, ..TrialPoint::default() }
    }

    fn front(mut points: Vec<TrialPoint>) -> Vec<bool> {
        mark_front(&mut points);
        points.iter().map(|p| p.is_on_front).collect()
    }

    #[test]
    fn the_front_is_what_no_other_beats() {
        let points = vec![
            point("a", 1e-3, 1.0),
            point("a", 1e-6, 5.0),
            point("a", 1e-5, 6.0),
            point("a", 1e-2, 1.05),
            point("b", 1.0, 9.0),
        ];
        assert_eq!(front(points), [true, true, false, false, true]);
    }

    #[test]
    fn roundings_are_alike_and_the_faster_wins() {
        assert_eq!(front(vec![point("a", 1e-16, 9.0), point("a", 9e-16, 5.0)]), [false, true]);
    }
}
