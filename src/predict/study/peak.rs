//! The largest of values over the angle, its angle, and the bands of angles near it.

use super::Fall;
use crate::data::{FlightRegime, Prediction};

/// Width to which a jump is bracketed, degrees: the value changes by less than 1e-6 m/s over it.
const JUMP_DEG: f64 = 1e-7;

/// Width to which a maximum is bracketed, degrees: far below the accuracy of any drop rig; the maximum is
/// flat, so its value is exact to rounding.
const PEAK_DEG: f64 = 1e-5;

/// Width to which the end of a band is bracketed, degrees.
const EDGE_DEG: f64 = 1e-6;

/// Jumps sought between two neighbouring angles; further ones lie within the last stretch of the cell.
const MOST_JUMPS: usize = 8;

/// A value must exceed another by this share to count as larger: predictions of a plateau differ by rounding.
const ROUNDING: f64 = 1e-12;

/// The criteria at one angle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub angle_deg: f64,
    /// Values in the order of [`crate::data::Criterion::ALL`]; minus infinity without a slap-down.
    pub values: [f64; 3],
    /// Motion of L before a single slap-down: while it stays the same the values are continuous in the angle.
    /// `None` if there is none.
    pub course: Option<FlightRegime>,
}

impl Sample {
    pub fn new(fall: &Fall, angle_deg: f64, prediction: &Prediction) -> Self {
        let value = |found: Option<f64>| found.unwrap_or(f64::NEG_INFINITY);
        // Before L has left, its energy is not lost yet; a cask that comes down more slowly than it would
        // fall from rest was tossed up.
        let longest_s =
            (2.0 * fall.body.length_m * angle_deg.to_radians().sin() / fall.drop.gravity_m_s2).sqrt();
        let is_driven = |time_s: f64| (fall.drop.contact_duration_s..=longest_s).contains(&time_s);
        Self {
            angle_deg,
            values: [
                value(prediction.slap_down_speed_m_s),
                value(prediction.vertical_velocity_m_s.map(|v| -v)),
                value(prediction.energy_ratio.filter(|_| prediction.flight_time_s.is_some_and(is_driven))),
            ],
            course: prediction.is_single_slap_down().then_some(prediction.regime),
        }
    }

    pub fn predict(fall: &Fall, angle_deg: f64) -> Self {
        Self::new(fall, angle_deg, &fall.predict(angle_deg))
    }

    /// Value of a criterion if the angle can be critical; minus infinity if it cannot.
    pub fn critical(&self, criterion: usize) -> f64 {
        if self.course.is_some() { self.values[criterion] } else { f64::NEG_INFINITY }
    }
}

/// Maximum of a criterion, and the angles at which the value is close to it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Peak {
    pub angle_deg: f64,
    pub largest: f64,
    pub bands_deg: Vec<(f64, f64)>,
}

/// The samples, and between neighbours with different courses both sides of each jump.
pub(super) fn with_jumps(samples: &[Sample], at: &impl Fn(f64) -> Sample) -> Vec<Sample> {
    let mut all: Vec<Sample> = Vec::with_capacity(samples.len() + MOST_JUMPS);
    for &right in samples {
        for _ in 0..MOST_JUMPS {
            let Some(&left) = all.last() else { break };
            if left.course == right.course || right.angle_deg - left.angle_deg <= JUMP_DEG {
                break;
            }
            let (mut before, mut behind) = (left, right);
            while behind.angle_deg - before.angle_deg > JUMP_DEG {
                let middle = at(f64::midpoint(before.angle_deg, behind.angle_deg));
                if middle.course == left.course { before = middle } else { behind = middle }
            }
            all.extend(
                [before, behind]
                    .into_iter()
                    .filter(|s| s.angle_deg > left.angle_deg && s.angle_deg < right.angle_deg),
            );
        }
        all.push(right);
    }
    all
}

/// The largest value of one criterion over samples that include both sides of each jump, and the bands within
/// `percent` of it.
///
/// Every hump of the samples that may be the highest is refined between its neighbours by golden section. At
/// a jump the value on the higher side counts: it is the supremum. A maximum at the border has the border's
/// angle, a plateau its lowest sampled angle. A hump between two samples that lifts neither above its
/// neighbours is missed. `None` if there is no single slap-down at any angle.
pub(super) fn peak(
    samples: &[Sample],
    criterion: usize,
    at: &impl Fn(f64) -> Sample,
    percent: f64,
) -> Option<Peak> {
    let value = |i: usize| samples[i].critical(criterion);
    let highest = (0..samples.len()).map(value).fold(f64::NEG_INFINITY, f64::max);
    let mut top = (f64::NAN, f64::NEG_INFINITY);
    for i in 0..samples.len() {
        let same = |j: usize| samples.get(j).filter(|s| s.course.is_some() && s.course == samples[i].course);
        let (left, right) = (i.checked_sub(1).and_then(same), same(i + 1));
        let rise = |s: Option<&Sample>| s.map_or(0.0, |s| value(i) - s.critical(criterion));
        let (from_left, from_right) = (rise(left), rise(right));
        if from_left < 0.0 || from_right < 0.0 {
            continue;
        }
        take_if_larger(&mut top, (samples[i].angle_deg, value(i)));
        // A hump rises between its samples by at most its fall to the next ones.
        if from_left.max(from_right) > 0.0 && value(i) + from_left.max(from_right) >= highest {
            let end = |s: Option<&Sample>| s.map_or(samples[i].angle_deg, |s| s.angle_deg);
            take_if_larger(&mut top, golden_section(end(left), end(right), |a| at(a).critical(criterion)));
        }
    }
    let (angle_deg, largest) = top;
    if largest == f64::NEG_INFINITY {
        return None;
    }
    let least = largest - percent / 100.0 * largest.abs();
    let mut marks: Vec<(f64, bool)> =
        samples.iter().map(|s| (s.angle_deg, s.critical(criterion) >= least)).collect();
    let place = marks.partition_point(|m| m.0 < angle_deg);
    marks.insert(place, (angle_deg, true));
    let bands_deg = bands(&marks, |a| at(a).critical(criterion) >= least);
    Some(Peak { angle_deg, largest, bands_deg })
}

fn take_if_larger(top: &mut (f64, f64), other: (f64, f64)) {
    if other.1 > f64::NEG_INFINITY && (top.1 == f64::NEG_INFINITY || other.1 > top.1 + ROUNDING * top.1.abs())
    {
        *top = other;
    }
}

/// The highest point found by golden section (Kiefer 1953) between two angles: the maximum if there is one
/// hump.
fn golden_section(mut low_deg: f64, mut high_deg: f64, value: impl Fn(f64) -> f64) -> (f64, f64) {
    let share = (5.0_f64.sqrt() - 1.0) / 2.0;
    let inner = |from: f64, to: f64| {
        let angle_deg = to - share * (to - from);
        (angle_deg, value(angle_deg))
    };
    let (mut a, mut b) = (inner(low_deg, high_deg), inner(high_deg, low_deg));
    while high_deg - low_deg > PEAK_DEG {
        if a.1 >= b.1 {
            high_deg = b.0;
            b = a;
            a = inner(low_deg, high_deg);
        } else {
            low_deg = a.0;
            a = b;
            b = inner(high_deg, low_deg);
        }
    }
    if a.1 >= b.1 { a } else { b }
}

/// Stretches in which `holds`, from marks at ascending angles; ends between two marks by bisection, on the
/// side that holds.
fn bands(marks: &[(f64, bool)], holds: impl Fn(f64) -> bool) -> Vec<(f64, f64)> {
    let edge = |inside: f64, outside: f64| {
        let (mut inside, mut outside) = (inside, outside);
        while (outside - inside).abs() > EDGE_DEG {
            let middle = f64::midpoint(inside, outside);
            if holds(middle) { inside = middle } else { outside = middle }
        }
        inside
    };
    let mut behind = 0_usize;
    let band = |run: &[(f64, bool)]| {
        let before = behind.checked_sub(1).and_then(|before| marks.get(before));
        behind += run.len();
        let (first, last) = run.first().zip(run.last()).filter(|(first, _)| first.1)?;
        let end = |inside: f64, outside: Option<&(f64, bool)>| {
            outside.map_or(inside, |outside| edge(inside, outside.0))
        };
        Some((end(first.0, before), end(last.0, marks.get(behind))))
    };
    marks.chunk_by(|a, b| a.1 == b.1).filter_map(band).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;

    const FREE: Option<FlightRegime> = Some(FlightRegime::Free);
    const KEPT: Option<FlightRegime> = Some(FlightRegime::Contact);

    /// The peak of a function over 0, 0.5 … 90° within 1 %.
    fn peak_of(function: impl Fn(f64) -> (f64, Option<FlightRegime>)) -> Option<Peak> {
        let at = |angle_deg: f64| {
            let (value, course) = function(angle_deg);
            Sample { angle_deg, values: [value; 3], course }
        };
        let samples: Vec<Sample> = (0..=180).map(|i| at(f64::from(i) / 2.0)).collect();
        peak(&with_jumps(&samples, &at), 0, &at, 1.0)
    }

    #[test]
    fn a_cask_that_turns_over_has_no_critical_angle_there() {
        let body = example::body(1429.0, 4.725, 0.565);
        let at = |angle_deg: f64| {
            let drop = crate::data::Drop {
                impact_velocity_m_s: 13.288,
                ..crate::data::Drop::from_height(9.0, angle_deg.to_radians())
            };
            Sample::predict(&Fall { body, drop, contact: crate::data::Contact::Smooth, k: 1.0 }, angle_deg)
        };
        // About 66° it flies for two seconds and turns over twice, faster than at the 18° where it strikes on
        // its first way down.
        let steep = (600..720).map(|tenths| at(f64::from(tenths) / 10.0));
        let over = steep.max_by(|a, b| a.values[0].total_cmp(&b.values[0])).expect("angles");
        let first = at(18.0);
        assert!(over.values[0] > first.values[0] && over.critical(0) < first.critical(0), "{over:?}");
        assert!(over.course.is_none() && first.course.is_some());
    }

    fn near(found: f64, expected: f64, bound: f64) {
        assert!((found - expected).abs() <= bound, "{found} {expected}");
    }

    fn one_band(peak: &Peak, low_deg: f64, high_deg: f64) {
        assert_eq!(peak.bands_deg.len(), 1, "{:?}", peak.bands_deg);
        near(peak.bands_deg[0].0, low_deg, 2.0 * EDGE_DEG);
        near(peak.bands_deg[0].1, high_deg, 2.0 * EDGE_DEG);
    }

    #[test]
    fn a_smooth_hump_is_found_between_the_samples() {
        let found = peak_of(|a| (3.0 - 0.01 * (a - 12.3).powi(2), FREE)).expect("a peak");
        near(found.angle_deg, 12.3, PEAK_DEG);
        // The band ends where 0.01 (a − 12.3)² = 0.03.
        one_band(&found, 12.3 - 3.0_f64.sqrt(), 12.3 + 3.0_f64.sqrt());
    }

    #[test]
    fn a_band_narrower_than_the_spacing_is_found() {
        let found = peak_of(|a| (3.0 - (a - 12.3).powi(2), FREE)).expect("a peak");
        one_band(&found, 12.3 - 0.03_f64.sqrt(), 12.3 + 0.03_f64.sqrt());
    }

    #[test]
    fn the_higher_of_two_humps_is_taken_though_a_sample_of_the_lower_is_higher() {
        // The samples at 60.0 and 20.0, 20.5 read 2.99 and 2.95.
        let hump = |a: f64, at: f64, top: f64| top - 0.8 * (a - at).abs();
        let found = peak_of(|a| (hump(a, 60.0, 2.99).max(hump(a, 20.25, 3.0)), FREE)).expect("a peak");
        near(found.angle_deg, 20.25, PEAK_DEG);
        near(found.largest, 3.0, PEAK_DEG);
        assert_eq!(found.bands_deg.len(), 2);
        near(found.bands_deg[1].0, 60.0 - 0.02 / 0.8, 2.0 * EDGE_DEG + PEAK_DEG);
    }

    #[test]
    fn at_a_jump_the_higher_side_counts() {
        let found = peak_of(|a| if a < 20.2 { (a, FREE) } else { (a - 15.0, KEPT) });
        let found = found.expect("a peak");
        // At 90° the second stretch has reached 75.
        near(found.largest, 75.0, 0.0);
        let found = peak_of(|a| if a < 80.2 { (a, FREE) } else { (a - 15.0, KEPT) }).expect("a peak");
        assert!(found.angle_deg < 80.2 && found.angle_deg > 80.2 - 2.0 * JUMP_DEG);
        one_band(&found, 0.99 * 80.2, 80.2);
    }

    #[test]
    fn a_stretch_between_two_jumps_within_one_spacing_is_seen() {
        let found = peak_of(|a| match a {
            a if a < 33.1 => (1.0, FREE),
            a if a < 33.2 => (2.0, KEPT),
            _ => (1.5, FREE),
        });
        let found = found.expect("a peak");
        near(found.largest, 2.0, 0.0);
        one_band(&found, 33.1, 33.2);
    }

    #[test]
    fn where_l_does_not_strike_once_there_is_no_band() {
        let found = peak_of(|a| if a < 40.3 { (a, FREE) } else { (100.0, None) }).expect("a peak");
        near(found.angle_deg, 40.3, 2.0 * JUMP_DEG);
        one_band(&found, 0.99 * 40.3, 40.3);
        assert_eq!(peak_of(|_| (1.0, None)), None);
    }

    #[test]
    fn the_border_counts() {
        let rising = peak_of(|a| (1.0 + a, FREE)).expect("a peak");
        assert_eq!((rising.angle_deg, rising.largest), (90.0, 91.0));
        one_band(&rising, 0.99 * 91.0 - 1.0, 90.0);
        let falling = peak_of(|a| (100.0 - a, FREE)).expect("a peak");
        assert_eq!((falling.angle_deg, falling.largest), (0.0, 100.0));
        one_band(&falling, 0.0, 1.0);
    }

    #[test]
    fn a_plateau_gives_its_lowest_angle_and_all_of_it_as_band() {
        let found = peak_of(|a| (a.min(30.2), FREE)).expect("a peak");
        assert_eq!((found.angle_deg, found.largest), (30.5, 30.2));
        let found = peak_of(|_| (10.0, FREE)).expect("a peak");
        assert_eq!((found.angle_deg, found.bands_deg.as_slice()), (0.0, &[(0.0, 90.0)][..]));
    }
}
