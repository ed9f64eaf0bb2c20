//! Predictions over the angle to critical angles and their bands, for one case and over the ranges of k and friction.

use super::Fall;
use super::peak::{Bands, Peak, Sample, common, peak, with_jumps};
use crate::data::{
    Body, CaskFile, Contact, Criterion, CriticalAngle, CriticalRange, Prediction, StudyRequest, WorstCase,
};
use rayon::prelude::*;

/// Values of k and of the Coulomb coefficient over their ranges: 0.1 of k and a sixth of the friction apart.
const RANGE_KS: u32 = 11;
const RANGE_FRICTIONS: u32 = 7;

/// Angles, degrees, and the predictions there.
pub(super) type AtAngles<'a> = (&'a [f64], &'a [Prediction]);

/// Every criterion's critical angle for a case whose predictions are known at some angles.
pub(super) fn critical_angles(
    fall: &Fall,
    bands: Bands,
    (angles_deg, predictions): AtAngles,
) -> Vec<CriticalAngle> {
    let at = |angle_deg: f64| Sample::new(angle_deg, &fall.at(angle_deg));
    let traced: Vec<Sample> =
        angles_deg.iter().zip(predictions).map(|(&angle_deg, p)| Sample::new(angle_deg, p)).collect();
    let samples = with_jumps(&traced, &at);
    let of = |(index, criterion): (usize, Criterion)| {
        let none = || Peak { angle_deg: f64::NAN, largest: f64::NAN, bands_deg: Vec::new() };
        let peak = peak(&samples, index, &at, bands).unwrap_or_else(none);
        let bounced = traced.iter().filter(|s| s.course.is_none() && s.values[index].is_finite());
        CriticalAngle {
            model: fall.body.model,
            contact: fall.contact,
            k: fall.k,
            criterion,
            angle_deg: peak.angle_deg,
            largest: peak.largest,
            bands_deg: peak.bands_deg,
            further_impacts: highest(bounced.map(|s| (s.angle_deg, s.values[index])), peak.largest),
        }
    };
    Criterion::ALL.into_iter().enumerate().map(of).collect()
}

/// The highest of some angles' values, where no single impact reaches it: above `largest`, or that is none.
fn highest(values: impl Iterator<Item = (f64, f64)>, largest: f64) -> Option<(f64, f64)> {
    let highest = values.reduce(|top, next| if next.1 > top.1 { next } else { top });
    highest.filter(|top| largest.is_nan() || top.1 > largest)
}

/// For every body and criterion the critical angles while k and friction go through their ranges, looked for from `angles_deg`.
///
/// Cases in which L strikes once before R at no angle have no critical angle and are left out.
pub(super) fn ranges(cask_file: &CaskFile, request: &StudyRequest, angles_deg: &[f64]) -> Vec<CriticalRange> {
    let ks = spread(request.uncertain.k, RANGE_KS);
    let contacts: Vec<Contact> = request.uncertain.friction.map_or_else(
        || request.contacts.clone(),
        |range| spread(range, RANGE_FRICTIONS).into_iter().map(Contact::Coulomb).collect(),
    );
    let bodies = super::bodies(&cask_file.cask);
    let falls = super::falls(&bodies, cask_file.drop, &contacts, &ks);
    let of = |fall: &Fall| critical_angles(fall, Bands::of(request), (angles_deg, &fall.over(angles_deg)));
    let found: Vec<CriticalAngle> = falls.par_iter().flat_map(of).collect();
    let of_body = |body: &Body| {
        let model = body.model;
        Criterion::ALL.map(|criterion| {
            found.iter().filter(|c| (c.model, c.criterion) == (model, criterion)).collect::<Vec<_>>()
        })
    };
    bodies.iter().flat_map(of_body).filter_map(|cases| range(&cases)).collect()
}

fn range(cases: &[&CriticalAngle]) -> Option<CriticalRange> {
    let mut peaks = cases.iter().filter(|case| case.angle_deg.is_finite());
    let at = |c: &CriticalAngle| WorstCase { angle_deg: c.angle_deg, contact: c.contact, k: c.k };
    let first = peaks.next()?;
    let mut range = CriticalRange {
        model: first.model,
        criterion: first.criterion,
        angle_deg: (first.angle_deg, first.angle_deg),
        largest: first.largest,
        worst: at(first),
        common_bands_deg: first.bands_deg.clone(),
        further_impacts: None,
    };
    for case in peaks {
        range.angle_deg = (range.angle_deg.0.min(case.angle_deg), range.angle_deg.1.max(case.angle_deg));
        if case.largest > range.largest {
            (range.largest, range.worst) = (case.largest, at(case));
        }
        range.common_bands_deg = common(&range.common_bands_deg, &case.bands_deg);
    }
    range.further_impacts = highest(cases.iter().filter_map(|case| case.further_impacts), range.largest);
    Some(range)
}

/// `count` values from one end of the range to the other, both included; one where the range is a point.
fn spread((low, high): (f64, f64), count: u32) -> Vec<f64> {
    if low >= high {
        return vec![low];
    }
    let at = |i: u32| low + (high - low) * f64::from(i) / f64::from(count - 1);
    (0..count).map(at).collect()
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that are handed through, not computed")]
mod tests {
    use super::super::tests::{V0_M_S, cask_file, request, rough_rod, steps, uncertain};
    use super::*;

    fn critical(height_m: f64, contact: Contact, k: f64, band_percent: f64) -> Vec<CriticalAngle> {
        let file = cask_file(height_m);
        let asked = StudyRequest { band_percent, ..request(vec![contact], vec![k], steps(180, 90.0)) };
        let fall = Fall { body: super::super::richest(&file), drop: file.drop, contact, k };
        critical_angles(&fall, Bands::of(&asked), (&asked.angles_deg, &fall.over(&asked.angles_deg)))
    }

    const VALUES: [fn(&Prediction) -> Option<f64>; 3] =
        [|p| p.slap_down_speed_m_s, |p| p.vertical_velocity_m_s.map(|v| -v), |p| p.energy_ratio];

    /// Angle and size of the largest of 18 001 predictions in which L strikes once, of each criterion.
    fn scanned(fall: &Fall) -> [(f64, f64); 3] {
        let mut tops = [(0.0, 0.0); 3];
        for i in 0..=18_000 {
            let angle_deg = f64::from(i) / 200.0;
            let prediction = fall.at(angle_deg);
            for (top, value) in tops.iter_mut().zip(VALUES) {
                let found = value(&prediction).filter(|_| prediction.first_end_impacts == 1);
                if let Some(found) = found.filter(|found| *found > top.1) {
                    *top = (angle_deg, found);
                }
            }
        }
        tops
    }

    #[test]
    fn a_fine_scan_finds_nothing_larger() {
        for k in [0.3, 1.0] {
            let tops = scanned(&rough_rod(k));
            for (found, (angle_deg, largest)) in critical(0.0, Contact::Rough, k, 5.0).iter().zip(tops) {
                assert!(found.largest >= largest * (1.0 - 1e-12), "{found:?} {largest}");
                // A smooth maximum lies within a step of the scan's, and so does a jump.
                assert!((found.angle_deg - angle_deg).abs() <= 5e-3, "{found:?} {angle_deg}");
                // What a step can add: slopes stay below 100 m/s per radian, and those of the energy ratio below that number.
                assert!(found.largest <= largest + 100.0 * 5e-3_f64.to_radians(), "{found:?} {largest}");
            }
        }
    }

    #[test]
    fn values_of_further_impacts_are_named_where_they_are_larger() {
        // A rough rod with k = 1 gets beyond its 26.6 m/s somewhere above 47°, by luck of its bounces; with k = 0.5 it never does.
        let asked = request(vec![Contact::Rough], vec![1.0], steps(1800, 90.0));
        let fall = rough_rod(1.0);
        let predictions = fall.over(&asked.angles_deg);
        let found = &critical_angles(&fall, Bands::of(&asked), (&asked.angles_deg, &predictions))[0];
        let (angle_deg, speed_m_s) = found.further_impacts.expect("a larger one");
        let there = fall.at(angle_deg);
        assert!(there.first_end_impacts > 1 && there.slap_down_speed_m_s == Some(speed_m_s));
        assert!(speed_m_s > found.largest && found.angle_deg < 3.0, "{found:?}");
        assert_eq!(critical(0.0, Contact::Rough, 0.5, 5.0)[0].further_impacts, None);
    }

    #[test]
    fn a_plastic_rough_rod_is_stationary_at_its_critical_angle() {
        // Flight with k just above 0: speed rises from the flat drop, then falls; the maximum is inside.
        let found = &critical(0.0, Contact::Rough, 0.1, 5.0)[0];
        assert!(found.angle_deg > 1.0 && found.angle_deg < 20.0, "{found:?}");
        let speed = |angle_deg: f64| rough_rod(0.1).at(angle_deg).slap_down_speed_m_s.expect("R strikes");
        let step_deg = 0.1;
        let slope =
            (speed(found.angle_deg + step_deg) - speed(found.angle_deg - step_deg)) / (2.0 * step_deg);
        let elsewhere = (speed(found.angle_deg + 1.0) - speed(found.angle_deg + 0.8)) / 0.2;
        // Third derivatives of v0 cos φ and the like: v0 (π/180)³ a degree cubed, times step²; a slope of 0.9° off is far above.
        assert!(slope.abs() < 10.0 * V0_M_S * 1_f64.to_radians().powi(3) * step_deg * step_deg, "{slope}");
        assert!(elsewhere < -20.0 * slope.abs(), "{elsewhere} {slope}");
    }

    #[test]
    fn a_smooth_elastic_rod_is_critical_over_the_wide_band_of_the_paper() {
        let found = &critical(0.0, Contact::Smooth, 1.0, 5.0)[0];
        // [P]: between 5° and 45° the speed hardly changes; here by less than 4 %.
        assert!(found.bands_deg.iter().any(|b| b.0 <= 5.0 && b.1 >= 45.0), "{found:?}");
        assert!((20.0..35.0).contains(&found.angle_deg), "{found:?}");
        // The rough one has no such band: its speed has halved at 40°.
        let rough = &critical(0.0, Contact::Rough, 1.0, 5.0)[0];
        assert!(rough.bands_deg.iter().all(|b| b.1 < 30.0), "{rough:?}");
    }

    #[test]
    fn a_maximum_that_no_rig_hits_is_not_critical() {
        // The elastic smooth rod at 88.9° flies for seconds before it comes down flat: a tenth of a degree wide.
        let fall = Fall { contact: Contact::Smooth, ..rough_rod(1.0) };
        let mut asked = request(vec![Contact::Smooth], vec![1.0], steps(180, 90.0));
        let mut energy = |tolerance_deg: f64| {
            asked.uncertain.angle_deg = tolerance_deg;
            critical_angles(&fall, Bands::of(&asked), (&asked.angles_deg, &fall.over(&asked.angles_deg)))[2]
                .clone()
        };
        let (of_formula, of_rig) = (energy(0.0), energy(1.0));
        assert!(of_formula.angle_deg > 88.0 && of_formula.largest > 1.3, "{of_formula:?}");
        assert!(of_rig.angle_deg < 60.0 && of_rig.largest < 1.1, "{of_rig:?}");
    }

    #[test]
    fn all_of_a_band_lies_within_its_percentage() {
        for found in critical(0.792, Contact::Smooth, 0.5, 2.0) {
            let fall = Fall {
                body: super::super::richest(&cask_file(0.792)),
                contact: Contact::Smooth,
                ..rough_rod(0.5)
            };
            let value = |angle_deg: f64| {
                Sample::new(angle_deg, &fall.at(angle_deg)).critical(found.criterion as usize)
            };
            for &(low_deg, high_deg) in &found.bands_deg {
                for i in 0..=100 {
                    let angle_deg = low_deg + (high_deg - low_deg) * f64::from(i) / 100.0;
                    assert!(
                        value(angle_deg) >= 0.98 * found.largest * (1.0 - 1e-12),
                        "{angle_deg} {found:?}"
                    );
                }
                assert!(value(low_deg - 1e-3) < 0.98 * found.largest || low_deg == 0.0);
                assert!(value(high_deg + 1e-3) < 0.98 * found.largest || high_deg == 90.0);
            }
        }
    }

    #[test]
    fn ranges_hold_every_case_in_them() {
        let file = cask_file(0.792);
        let contacts = vec![Contact::Rough, Contact::Smooth];
        let mut asked = request(contacts, vec![0.2, 0.4], steps(90, 45.0));
        asked.uncertain = uncertain((0.2, 0.4), 1);
        let ranges = ranges(&file, &asked, &asked.angles_deg);
        assert_eq!(ranges.len(), 6);
        let falls =
            super::super::falls(&super::super::bodies(&file.cask), file.drop, &asked.contacts, &asked.ks);
        for fall in falls {
            let found =
                critical_angles(&fall, Bands::of(&asked), (&asked.angles_deg, &fall.over(&asked.angles_deg)));
            for (of_case, range) in found.iter().zip(ranges.iter().filter(|r| r.model == fall.body.model)) {
                assert!(range.angle_deg.0 <= of_case.angle_deg && of_case.angle_deg <= range.angle_deg.1);
                assert!(range.largest >= of_case.largest);
                for band in &range.common_bands_deg {
                    assert!(of_case.bands_deg.iter().any(|b| b.0 <= band.0 && band.1 <= b.1), "{range:?}");
                }
            }
        }
        // The speed grows with k at these angles: the worst case is the highest k.
        assert!(ranges.iter().filter(|r| r.criterion == Criterion::Speed).all(|r| r.worst.k == 0.4));
    }

    #[test]
    fn a_range_of_friction_takes_the_place_of_the_contact_law() {
        let mut asked = request(vec![Contact::Rough], vec![0.5], steps(45, 45.0));
        asked.uncertain = crate::data::Uncertain { friction: Some((0.0, 0.3)), ..uncertain((0.5, 0.5), 1) };
        let found = &ranges(&cask_file(0.0), &asked, &asked.angles_deg)[0];
        // Less friction leaves more speed to the rod.
        assert_eq!((found.worst.contact, found.worst.k), (Contact::Coulomb(0.0), 0.5));
    }

    #[test]
    fn a_range_is_spread_with_its_ends() {
        assert_eq!(spread((0.0, 1.0), 5), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(spread((0.3, 0.3), 5), [0.3]);
    }
}
