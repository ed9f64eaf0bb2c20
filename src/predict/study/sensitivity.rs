//! Differences of the slap-down speed to its slopes over k and angle, and to where it does not tell k.

use super::peak::bands;
use super::{Fall, falls, richest};
use crate::data::{CaskFile, Prediction, Sensitivity, StudyRequest};
use rayon::prelude::*;
use std::ops::Range;

/// Coefficients of restitution for which the sensitivity is stated where the request does not name one.
const TYPICAL_KS: [f64; 3] = [0.1, 0.5, 0.9];

/// A speed known to 1 % must tell k to 0.1: |∂v/∂k| below this share of v does not, and k is then not known from the speed.
const BLIND_SHARE: f64 = 0.01 / 0.1;

/// Half the steps of the differences, of k and in degrees. They lie 1e-7 m/s off the derivatives while L strikes once, by the square of the
/// step; at k = 0 and at 0°, where a difference has one side, 3e-4 m/s and 1e-4 m/s per degree.
const STEP_K: f64 = 1e-4;
const STEP_DEG: f64 = 0.01;

/// The richest body's sensitivities for every contact law, and for the request's k or, unless it names one alone, typical ones.
pub(super) fn sensitivities(cask_file: &CaskFile, request: &StudyRequest) -> Vec<Sensitivity> {
    let ks = if request.ks.len() == 1 { request.ks.as_slice() } else { TYPICAL_KS.as_slice() };
    let falls = falls(&[richest(cask_file)], cask_file.drop, &request.contacts, ks);
    falls.par_iter().map(|fall| sensitivity(fall, &request.angles_deg)).collect()
}

fn sensitivity(fall: &Fall, angles_deg: &[f64]) -> Sensitivity {
    let over =
        |of: fn(&Fall, f64) -> f64| angles_deg.par_iter().map(|&angle_deg| of(fall, angle_deg)).collect();
    let by_k_m_s: Vec<f64> = over(by_k_m_s);
    let mut blind_angles_deg = zeros(angles_deg, &by_k_m_s, |angle_deg| self::by_k_m_s(fall, angle_deg));
    blind_angles_deg.retain(|&angle_deg| is_blind(fall, angle_deg));
    let mut marks: Vec<(f64, bool)> = angles_deg.par_iter().map(|&a| (a, is_blind(fall, a))).collect();
    marks.extend(blind_angles_deg.iter().map(|&angle_deg| (angle_deg, true)));
    marks.sort_by(|a, b| a.0.total_cmp(&b.0));
    Sensitivity {
        model: fall.body.model,
        contact: fall.contact,
        k: fall.k,
        angle_deg: angles_deg.to_vec(),
        by_k_m_s,
        by_angle_m_s_deg: over(by_angle_m_s_deg),
        blind_angles_deg,
        blind_bands_deg: bands(&marks, |angle_deg| is_blind(fall, angle_deg)),
    }
}

/// ∂v/∂k, m/s.
fn by_k_m_s(fall: &Fall, angle_deg: f64) -> f64 {
    let ends = (fall.k - STEP_K).max(0.0)..(fall.k + STEP_K).min(1.0);
    slope(ends, |k| Fall { k, ..*fall }.at(angle_deg))
}

/// ∂v/∂φ0, m/s per degree.
fn by_angle_m_s_deg(fall: &Fall, angle_deg: f64) -> f64 {
    slope((angle_deg - STEP_DEG).max(0.0)..(angle_deg + STEP_DEG).min(90.0), |angle_deg| fall.at(angle_deg))
}

/// The slope of the speed; NaN without a slap-down, or where L goes another way at one end: there the speed may jump.
fn slope(ends: Range<f64>, at: impl Fn(f64) -> Prediction) -> f64 {
    let [low, middle, high] = [ends.start, f64::midpoint(ends.start, ends.end), ends.end].map(at);
    let way = |p: &Prediction| p.slap_down_speed_m_s.map(|_| (p.regime, p.first_end_impacts));
    match (low.slap_down_speed_m_s, high.slap_down_speed_m_s) {
        (Some(low_m_s), Some(high_m_s)) if [way(&low), way(&high)] == [way(&middle); 2] => {
            (high_m_s - low_m_s) / (ends.end - ends.start)
        }
        _ => f64::NAN,
    }
}

/// Whether the speed does not tell k. Where L strikes again before R it jumps with k as it does with the angle, and nothing is said.
fn is_blind(fall: &Fall, angle_deg: f64) -> bool {
    let there = fall.at(angle_deg);
    let below = |speed_m_s| by_k_m_s(fall, angle_deg).abs() < BLIND_SHARE * speed_m_s;
    there.first_end_impacts == 1 && there.slap_down_speed_m_s.is_some_and(below)
}

/// Angles at which a curve goes through zero, straight between two of its points. `at` is the curve between them: where it jumps
/// from one sign to the other it is not near zero, compared with both points.
fn zeros(angles_deg: &[f64], curve: &[f64], at: impl Fn(f64) -> f64) -> Vec<f64> {
    let zero = |(angle, value): (&[f64], &[f64])| {
        let has_zero = value[0] > 0.0 && value[1] <= 0.0 || value[0] <= 0.0 && value[1] > 0.0;
        let angle_deg = angle[0] + (angle[1] - angle[0]) * value[0] / (value[0] - value[1]);
        let near = 0.5 * value[0].abs().min(value[1].abs());
        (has_zero && at(angle_deg).abs() <= near).then_some(angle_deg)
    };
    angles_deg.windows(2).zip(curve.windows(2)).filter_map(zero).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{V0_M_S, cask_file, request, rough_rod, steps};
    use super::*;
    use crate::data::Contact;

    #[test]
    fn at_small_angles_it_is_half_the_impact_velocity() {
        // dv_R/dk = v0/2 as φ → 0; R falls for τ = l φ/v_R = 0.5 ms at 0.1°, in which gravity adds g τ, 3e-4 of the speed.
        let found = by_k_m_s(&rough_rod(0.5), 0.1);
        assert!((found / (V0_M_S / 2.0) - 1.0).abs() < 5e-4, "{found}");
    }

    #[test]
    fn half_the_step_is_the_same_slope() {
        let fall = Fall { body: richest(&cask_file(0.792)), ..rough_rod(0.5) };
        for angle_deg in [0.1, 15.0, 30.0, 44.0] {
            let [half, twice] = [0.5, 2.0].map(|share| {
                let at = |k: f64| Fall { k, ..fall }.at(angle_deg);
                slope(0.5 - share * STEP_K..0.5 + share * STEP_K, at)
            });
            assert!((half - twice).abs() < 1e-4, "{angle_deg}: {half} {twice}");
        }
    }

    #[test]
    fn a_blind_angle_is_where_two_k_give_one_speed_and_the_band_is_around_it() {
        let asked = request(vec![Contact::Rough], vec![0.5], steps(120, 60.0));
        let found = &sensitivities(&cask_file(0.0), &asked)[0];
        assert_eq!(found.blind_angles_deg.len(), 1, "{:?}", found.blind_angles_deg);
        let angle_deg = found.blind_angles_deg[0];
        let speed =
            |k: f64, angle_deg: f64| rough_rod(k).at(angle_deg).slap_down_speed_m_s.expect("R strikes");
        let by_k = |angle_deg: f64| (speed(0.501, angle_deg) - speed(0.499, angle_deg)) / 0.002;
        // Straight over half a degree: off by its square times a curvature of 5e-3 m/s per square degree, over 8.
        assert!(by_k(angle_deg).abs() < 1e-3, "{}", by_k(angle_deg));
        assert!(by_k(angle_deg - 3.0) > 0.3 && by_k(angle_deg + 3.0) < -0.3);
        let (low_deg, high_deg) = found.blind_bands_deg[0];
        assert!(low_deg < angle_deg && angle_deg < high_deg);
        for end_deg in [low_deg, high_deg] {
            assert!(
                (by_k(end_deg).abs() / (BLIND_SHARE * speed(0.5, end_deg)) - 1.0).abs() < 1e-4,
                "{end_deg}"
            );
        }
    }

    #[test]
    fn a_jump_is_no_zero_and_a_zero_at_an_angle_is_found_once() {
        let angles_deg = steps(180, 90.0);
        let of = |value: fn(f64) -> f64| {
            let curve: Vec<f64> = angles_deg.iter().map(|&angle_deg| value(angle_deg)).collect();
            zeros(&angles_deg, &curve, value)
        };
        assert!(of(|a| if a < 40.2 { 6.0 } else { -6.0 }).is_empty());
        assert!(of(|a| if a < 40.2 { 0.1 } else { -60.0 }).is_empty());
        assert!(of(|a| if a < 30.25 { 6.0 } else { f64::NAN }).is_empty());
        assert_eq!(of(|a| a - 45.0), [45.0]);
        assert!((of(|a| 1000.0 * (40.2 - a))[0] - 40.2).abs() < 1e-9);
    }

    #[test]
    fn where_another_way_begins_nothing_is_said() {
        // With k = 0 the pivot of a rough rod at 60° stays on the target; with any rebound it flies.
        assert!(by_k_m_s(&rough_rod(0.0), 60.0).is_nan());
        assert!(by_k_m_s(&rough_rod(0.9), 89.0).is_nan() || !is_blind(&rough_rod(0.9), 89.0));
    }

    #[test]
    fn typical_k_unless_one_is_named() {
        let ks = |ks: Vec<f64>| -> Vec<f64> {
            let asked = request(vec![Contact::Rough], ks, steps(9, 45.0));
            sensitivities(&cask_file(0.0), &asked).iter().map(|s| s.k).collect()
        };
        assert_eq!(ks(vec![0.0, 1.0]), TYPICAL_KS);
        assert_eq!(ks(vec![0.4]), [0.4]);
    }
}
