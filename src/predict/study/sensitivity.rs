//! The gradient of the slap-down speed over the angle to where it does not tell k.

use super::peak::bands;
use super::{Fall, richest};
use crate::data::{CaskFile, Sensitivity, SpeedGradient, StudyRequest};
use rayon::prelude::*;

/// Coefficients of restitution for which the sensitivity is stated where the request does not name one.
const TYPICAL_KS: [f64; 3] = [0.1, 0.5, 0.9];

/// A speed known to 1 % must tell k to 0.1: |∂v/∂k| below this share of v does not, and k is then not known from the speed.
const BLIND_SHARE: f64 = 0.01 / 0.1;

/// Width to which a sign change is bracketed, degrees.
const BLIND_DEG: f64 = 1e-9;

/// A derivative that changes sign without coming this near to zero, as a share of the speed, has jumped.
const ZERO_SHARE: f64 = 1e-3;

/// What the speed does at one angle.
struct GradientAt {
    /// `None` without a slap-down.
    gradient: Option<SpeedGradient>,
    /// Whether L strikes once before R. Where it strikes again the speed jumps with k as it does with the angle.
    strikes_once: bool,
}

impl GradientAt {
    fn is_blind(&self) -> bool {
        let below = |g: &SpeedGradient| g.by_k_m_s.abs() < BLIND_SHARE * g.speed_m_s;
        self.strikes_once && self.gradient.as_ref().is_some_and(below)
    }
}

/// The richest body's sensitivities for every contact law, and for the request's k or, unless it names one alone, typical ones.
pub(super) fn sensitivities(cask_file: &CaskFile, request: &StudyRequest) -> Vec<Sensitivity> {
    let ks = if request.ks.len() == 1 { request.ks.as_slice() } else { TYPICAL_KS.as_slice() };
    let (body, drop) = (richest(cask_file), cask_file.drop);
    let mut falls = Vec::new();
    for &contact in &request.contacts {
        falls.extend(ks.iter().map(|&k| Fall { body, drop, contact, k }));
    }
    let of = |fall: &Fall| {
        let answer = |angle_deg: f64| GradientAt {
            gradient: fall.gradient_at(angle_deg),
            strikes_once: fall.at(angle_deg).first_end_impacts == 1,
        };
        sensitivity(fall, &request.angles_deg, &answer)
    };
    falls.par_iter().map(of).collect()
}

/// The sensitivity of one fall, its `answer` given at an angle in degrees.
fn sensitivity(fall: &Fall, angles_deg: &[f64], answer: &(impl Fn(f64) -> GradientAt + Sync)) -> Sensitivity {
    let answers: Vec<GradientAt> = angles_deg.par_iter().map(|&a| answer(a)).collect();
    let each = |value: fn(&SpeedGradient) -> f64| {
        answers.iter().map(|a| a.gradient.as_ref().map_or(f64::NAN, value)).collect()
    };
    let blind_angles_deg = zeros(angles_deg, &answers, answer);
    let mut marks: Vec<(f64, bool)> =
        angles_deg.iter().zip(&answers).map(|(&angle_deg, a)| (angle_deg, a.is_blind())).collect();
    marks.extend(blind_angles_deg.iter().map(|&angle_deg| (angle_deg, true)));
    marks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let blind_bands_deg = bands(&marks, |angle_deg| answer(angle_deg).is_blind());
    Sensitivity {
        model: fall.body.model,
        contact: fall.contact,
        k: fall.k,
        angle_deg: angles_deg.to_vec(),
        by_k_m_s: each(|g| g.by_k_m_s),
        by_angle_m_s_deg: each(|g| g.by_angle_m_s_rad.to_radians()),
        blind_angles_deg,
        blind_bands_deg,
    }
}

/// Angles at which ∂(speed)/∂k goes through zero; where it jumps from one sign to the other there is none.
fn zeros(angles_deg: &[f64], answers: &[GradientAt], answer: &impl Fn(f64) -> GradientAt) -> Vec<f64> {
    let mut zeros = Vec::new();
    // The last angle with a sign: one whose derivative is exactly zero has none.
    let mut signed: Option<(f64, bool)> = None;
    for (&angle_deg, at) in angles_deg.iter().zip(answers) {
        let Some(gradient) = at.gradient.filter(|_| at.strikes_once) else {
            signed = None;
            continue;
        };
        if gradient.by_k_m_s == 0.0 {
            continue;
        }
        let is_positive = gradient.by_k_m_s > 0.0;
        if let Some((low_deg, was_positive)) = signed
            && was_positive != is_positive
        {
            let by_k = |angle_deg: f64| answer(angle_deg).gradient;
            zeros.extend(zero_between((low_deg, angle_deg), was_positive, &by_k));
        }
        signed = Some((angle_deg, is_positive));
    }
    zeros
}

fn zero_between(
    (mut low_deg, mut high_deg): (f64, f64),
    is_positive_at_low: bool,
    gradient: &impl Fn(f64) -> Option<SpeedGradient>,
) -> Option<f64> {
    while high_deg - low_deg > BLIND_DEG {
        let middle_deg = f64::midpoint(low_deg, high_deg);
        if (gradient(middle_deg)?.by_k_m_s > 0.0) == is_positive_at_low {
            low_deg = middle_deg;
        } else {
            high_deg = middle_deg;
        }
    }
    let is_small = |g: SpeedGradient| g.by_k_m_s.abs() < ZERO_SHARE * g.speed_m_s;
    (is_small(gradient(low_deg)?) && is_small(gradient(high_deg)?)).then(|| f64::midpoint(low_deg, high_deg))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{V0_M_S, request, rough_rod, steps};
    use super::*;
    use crate::data::Contact;

    fn of(by_k_m_s: impl Fn(f64) -> f64 + Sync) -> Sensitivity {
        let answer = |angle_deg: f64| {
            let by_k_m_s = by_k_m_s(angle_deg);
            let gradient = SpeedGradient { speed_m_s: 20.0, by_k_m_s, by_angle_m_s_rad: 18.0 };
            // Not a number stands for no slap-down; beyond 80° L strikes again.
            GradientAt { gradient: (!by_k_m_s.is_nan()).then_some(gradient), strikes_once: angle_deg <= 80.0 }
        };
        sensitivity(&rough_rod(0.5), &steps(180, 90.0), &answer)
    }

    #[test]
    fn the_rough_rod_is_blind_at_35_degrees() {
        // Just after a rough impact: ∂v_z/∂k = v0 (1 − ¾ · 2 cos² φ0), zero at cos² φ0 = 2/3.
        let found = of(|a| V0_M_S * (1.0 - 1.5 * a.to_radians().cos().powi(2)));
        assert_eq!(found.blind_angles_deg.len(), 1);
        assert!((found.blind_angles_deg[0] - (2.0_f64 / 3.0).sqrt().acos().to_degrees()).abs() < BLIND_DEG);
        // 1 % of 20 m/s is 0.2 m/s, over 0.1 in k 2 m/s: cos² φ0 = (1 ± 2 / v0) / 1.5.
        let end = |sign: f64| ((1.0 + sign * 2.0 / V0_M_S) / 1.5).sqrt().acos().to_degrees();
        assert_eq!(found.blind_bands_deg.len(), 1);
        let (low_deg, high_deg) = found.blind_bands_deg[0];
        assert!(
            (low_deg - end(1.0)).abs() < 2e-6 && (high_deg - end(-1.0)).abs() < 2e-6,
            "{low_deg} {high_deg}"
        );
        // Per degree instead of per radian.
        assert!((found.by_angle_m_s_deg[0] - std::f64::consts::PI / 10.0).abs() < 1e-15);
    }

    #[test]
    fn a_steep_zero_between_two_angles_is_found_with_its_band() {
        let found = of(|a| 1000.0 * (a - 40.2));
        assert!((found.blind_angles_deg[0] - 40.2).abs() < BLIND_DEG);
        let (low_deg, high_deg) = found.blind_bands_deg[0];
        assert!((low_deg - 40.198).abs() < 2e-6 && (high_deg - 40.202).abs() < 2e-6);
    }

    #[test]
    fn a_jump_is_no_zero() {
        let found = of(|a| if a < 40.2 { 6.0 } else { -6.0 });
        assert!(found.blind_angles_deg.is_empty() && found.blind_bands_deg.is_empty());
    }

    #[test]
    fn a_zero_at_an_angle_of_the_grid_is_found_once() {
        assert_eq!(of(|a| a - 45.0).blind_angles_deg.len(), 1);
        assert_eq!(of(|a| (a - 45.0).powi(2)).blind_angles_deg.len(), 0);
    }

    #[test]
    fn without_slap_down_nothing_is_said() {
        let found = of(|a| if a < 30.25 { 6.0 } else { f64::NAN });
        assert!(found.by_k_m_s[61].is_nan() && found.by_angle_m_s_deg[61].is_nan());
        assert!(found.blind_angles_deg.is_empty() && found.blind_bands_deg.is_empty());
    }

    #[test]
    fn where_l_strikes_again_nothing_is_called_blind() {
        let found = of(|a| if a < 85.2 { 4.0 } else { 85.2 - a });
        assert!(found.blind_angles_deg.is_empty() && found.blind_bands_deg.is_empty());
        assert!((found.by_k_m_s[180] + 4.8).abs() < 1e-12);
    }

    #[test]
    fn a_blind_angle_is_where_two_k_give_one_speed() {
        let file = super::super::tests::cask_file(0.0);
        let asked = request(vec![Contact::Rough], vec![0.5], steps(120, 60.0));
        let found = &sensitivities(&file, &asked)[0];
        assert_eq!(found.blind_angles_deg.len(), 1, "{:?}", found.blind_angles_deg);
        let angle_deg = found.blind_angles_deg[0];
        let speed =
            |k: f64, angle_deg: f64| rough_rod(k).at(angle_deg).slap_down_speed_m_s.expect("R strikes");
        let by_k = |angle_deg: f64| (speed(0.501, angle_deg) - speed(0.499, angle_deg)) / 0.002;
        // A central difference is off by the third derivative, some 10 m/s, times 0.001² / 6.
        assert!(by_k(angle_deg).abs() < 1e-5, "{}", by_k(angle_deg));
        assert!(by_k(angle_deg - 3.0) > 0.3 && by_k(angle_deg + 3.0) < -0.3);
    }

    #[test]
    fn typical_k_unless_one_is_named() {
        let file = super::super::tests::cask_file(0.0);
        let ks = |ks: Vec<f64>| -> Vec<f64> {
            let asked = request(vec![Contact::Rough], ks, steps(9, 45.0));
            sensitivities(&file, &asked).iter().map(|s| s.k).collect()
        };
        assert_eq!(ks(vec![0.0, 1.0]), TYPICAL_KS);
        assert_eq!(ks(vec![0.4]), [0.4]);
    }
}
