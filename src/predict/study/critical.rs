//! Critical angles and their bands, from predictions over the angle.

use super::Fall;
use super::peak::{Peak, Sample, peak, with_jumps};
use crate::data::{Criterion, CriticalAngle, Prediction};

/// Angles, degrees, and the predictions there.
pub(super) type AtAngles<'a> = (&'a [f64], &'a [Prediction]);

/// Every criterion's critical angle for a case whose predictions are known at some angles.
pub(super) fn critical_angles(
    fall: &Fall,
    band_percent: f64,
    (angles_deg, predictions): AtAngles,
) -> Vec<CriticalAngle> {
    let at = |angle_deg: f64| Sample::predict(fall, angle_deg);
    let traced: Vec<Sample> =
        angles_deg.iter().zip(predictions).map(|(&angle_deg, p)| Sample::new(fall, angle_deg, p)).collect();
    let samples = with_jumps(&traced, &at);
    let critical = |(index, criterion): (usize, Criterion)| {
        let none = || Peak { angle_deg: f64::NAN, largest: f64::NAN, bands_deg: Vec::new() };
        let peak = peak(&samples, index, &at, band_percent).unwrap_or_else(none);
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
    Criterion::ALL.into_iter().enumerate().map(critical).collect()
}

/// The highest of the values with its angle, if no single impact reaches it: it exceeds `largest`, or
/// `largest` is NaN.
fn highest(values: impl Iterator<Item = (f64, f64)>, largest: f64) -> Option<(f64, f64)> {
    let highest = values.reduce(|top, next| if next.1 > top.1 { next } else { top });
    highest.filter(|top| largest.is_nan() || top.1 > largest)
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that are handed through, not computed")]
mod tests {
    use super::super::tests::{V0_M_S, cask_file, request, rough_rod, steps};
    use super::*;
    use crate::data::{Contact, StudyRequest};

    fn critical(height_m: f64, contact: Contact, k: f64, band_percent: f64) -> Vec<CriticalAngle> {
        let file = cask_file(height_m);
        let asked = StudyRequest { band_percent, ..request(vec![contact], vec![k], steps(180, 90.0)) };
        let fall = Fall { body: super::super::richest_body(&file), drop: file.drop, contact, k };
        critical_angles(&fall, asked.band_percent, (&asked.angles_deg, &fall.sweep(&asked.angles_deg)))
    }

    /// Angle and value of the largest of 18 001 single slap-downs, for each criterion.
    fn scan(fall: &Fall) -> [(f64, f64); 3] {
        let mut tops = [(0.0, 0.0); 3];
        for i in 0..=18_000 {
            let sample = Sample::predict(fall, f64::from(i) / 200.0);
            for (j, top) in tops.iter_mut().enumerate() {
                if sample.critical(j) > top.1 {
                    *top = (sample.angle_deg, sample.critical(j));
                }
            }
        }
        tops
    }

    #[test]
    fn a_fine_scan_finds_nothing_larger() {
        for k in [0.3, 1.0] {
            let tops = scan(&rough_rod(k));
            for (found, (angle_deg, largest)) in critical(0.0, Contact::Rough, k, 5.0).iter().zip(tops) {
                assert!(found.largest >= largest * (1.0 - 1e-12), "{found:?} {largest}");
                // A smooth maximum lies within a step of the scan's, and so does a jump.
                assert!((found.angle_deg - angle_deg).abs() <= 5e-3, "{found:?} {angle_deg}");
                // A step can add at most this much: slopes stay below 100 m/s per radian, and those of the
                // energy ratio below that number.
                assert!(found.largest <= largest + 100.0 * 5e-3_f64.to_radians(), "{found:?} {largest}");
            }
        }
    }

    #[test]
    fn values_of_further_impacts_are_named_where_they_are_larger() {
        // A rough rod with k = 1 gets beyond its 26.6 m/s somewhere above 47°, by luck of its bounces; with k
        // = 0.5 it never does.
        let asked = request(vec![Contact::Rough], vec![1.0], steps(1800, 90.0));
        let fall = rough_rod(1.0);
        let predictions = fall.sweep(&asked.angles_deg);
        let found = &critical_angles(&fall, asked.band_percent, (&asked.angles_deg, &predictions))[0];
        let (angle_deg, speed_m_s) = found.further_impacts.expect("a larger one");
        let there = fall.predict(angle_deg);
        assert!(there.first_end_impacts > 1 && there.slap_down_speed_m_s == Some(speed_m_s));
        assert!(speed_m_s > found.largest && found.angle_deg < 3.0, "{found:?}");
        assert_eq!(critical(0.0, Contact::Rough, 0.5, 5.0)[0].further_impacts, None);
    }

    #[test]
    fn a_plastic_rough_rod_is_stationary_at_its_critical_angle() {
        // Flight with k just above 0: speed rises from the flat drop, then falls; the maximum is inside.
        let found = &critical(0.0, Contact::Rough, 0.1, 5.0)[0];
        assert!(found.angle_deg > 1.0 && found.angle_deg < 20.0, "{found:?}");
        let speed =
            |angle_deg: f64| rough_rod(0.1).predict(angle_deg).slap_down_speed_m_s.expect("R strikes");
        let step_deg = 0.1;
        let slope =
            (speed(found.angle_deg + step_deg) - speed(found.angle_deg - step_deg)) / (2.0 * step_deg);
        let elsewhere = (speed(found.angle_deg + 1.0) - speed(found.angle_deg + 0.8)) / 0.2;
        // Third derivatives of v0 cos φ and the like: v0 (π/180)³ a degree cubed, times step²; a slope of
        // 0.9° off is far above.
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
    fn the_energy_of_a_cask_that_is_tossed_up_is_not_critical() {
        // The elastic smooth rod at 88.9° flies for seconds before it comes down flat.
        let fall = Fall { contact: Contact::Smooth, ..rough_rod(1.0) };
        let asked = request(vec![Contact::Smooth], vec![1.0], steps(180, 90.0));
        let found =
            critical_angles(&fall, 5.0, (&asked.angles_deg, &fall.sweep(&asked.angles_deg)))[2].clone();
        assert!(found.angle_deg < 60.0 && found.largest < 1.1, "{found:?}");
        assert!(fall.predict(88.9).energy_ratio > Some(1.2));
    }

    #[test]
    fn all_of_a_band_lies_within_its_percentage() {
        for found in critical(0.792, Contact::Smooth, 0.5, 2.0) {
            let fall = Fall {
                body: super::super::richest_body(&cask_file(0.792)),
                contact: Contact::Smooth,
                ..rough_rod(0.5)
            };
            let value = |angle_deg: f64| Sample::predict(&fall, angle_deg).critical(found.criterion as usize);
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
}
