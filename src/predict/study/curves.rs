//! Curves for pictures from predictions over the angle.

use super::Fall;
use crate::data::{AngleCurve, Body, BodyModel, CaskFile, Contact, Prediction};

/// Sections of \[P\] Fig. 9 beside the rod, m: 10 × 10 mm and 500 × 600 mm, either way up.
const SECTIONS_M: [f64; 3] = [0.01, 0.5, 0.6];

/// The curve of predictions made at `angles_deg`; NaN where a prediction lacks the value.
pub(super) fn curve(fall: &Fall, angles_deg: &[f64], predictions: &[Prediction]) -> AngleCurve {
    let values_of = |value: fn(&Prediction) -> Option<f64>| {
        predictions.iter().map(|p| value(p).unwrap_or(f64::NAN)).collect()
    };
    AngleCurve {
        model: fall.body.model,
        height_m: fall.body.height_m,
        contact: fall.contact,
        k: fall.k,
        angle_deg: angles_deg.to_vec(),
        speed_m_s: values_of(|p| p.slap_down_speed_m_s),
        vertical_velocity_m_s: values_of(|p| p.vertical_velocity_m_s),
        horizontal_velocity_m_s: values_of(|p| p.horizontal_velocity_m_s),
        energy_ratio: values_of(|p| p.energy_ratio),
        closed_form_speed_m_s: values_of(|p| p.closed_form_speed_m_s),
        turns_over: predictions.iter().map(Prediction::turns_over).collect(),
    }
}

/// Smooth and k = 1: uniform bodies of the cask's length as a rod and with the sections of \[P\] Fig. 9, then
/// the cask's own body.
pub(super) fn sections(cask_file: &CaskFile, angles_deg: &[f64]) -> Vec<AngleCurve> {
    let rod = super::super::body(&cask_file.cask, BodyModel::Rod);
    let uniform =
        |height_m: f64| Body { model: BodyModel::Body, ..super::resize(&rod, rod.length_m, height_m) };
    let own = cask_file.cask.is_body.then(|| super::richest_body(cask_file));
    let of_body = |body| {
        let fall = Fall { body, drop: cask_file.drop, contact: Contact::Smooth, k: 1.0 };
        curve(&fall, angles_deg, &fall.sweep(angles_deg))
    };
    std::iter::once(rod).chain(SECTIONS_M.map(uniform)).chain(own).map(of_body).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{V0_M_S, cask_file, rough_rod, steps};
    use super::*;

    #[test]
    fn a_curve_is_the_predictions_one_by_one() {
        let (fall, angles_deg) = (rough_rod(1.0), steps(90, 90.0));
        let found = curve(&fall, &angles_deg, &fall.sweep(&angles_deg));
        for (i, &angle_deg) in angles_deg.iter().enumerate() {
            let one = fall.predict(angle_deg);
            assert_eq!(one.slap_down_speed_m_s.is_none(), found.speed_m_s[i].is_nan());
            if let Some(speed_m_s) = one.slap_down_speed_m_s {
                assert_eq!(found.speed_m_s[i].to_bits(), speed_m_s.to_bits());
                let components = found.horizontal_velocity_m_s[i].hypot(found.vertical_velocity_m_s[i]);
                assert!((components - speed_m_s).abs() < 1e-14 * speed_m_s);
            }
        }
    }

    #[test]
    fn sections_start_at_the_rod_and_a_thin_one_hardly_differs() {
        let sections = sections(&cask_file(0.792), &steps(9, 45.0));
        let heights_m: Vec<f64> = sections.iter().map(|s| s.height_m).collect();
        assert_eq!(heights_m, [0.0, 0.01, 0.5, 0.6, 0.792]);
        for j in 0..10 {
            // ω2 and b change by (h / l) of their size to first order: 0.2 % of v0 at the most for 10 mm of
            // 5.5 m.
            assert!((sections[1].speed_m_s[j] - sections[0].speed_m_s[j]).abs() < 0.002 * 2.0 * V0_M_S);
        }
        // [P]: a large section matters at steep angles.
        assert!(sections[0].speed_m_s[9] - sections[3].speed_m_s[9] > 0.5);
    }

    #[test]
    fn an_elastic_smooth_impact_loses_nothing() {
        let angles_deg = steps(40, 40.0);
        for section in sections(&cask_file(0.792), &angles_deg) {
            for ratio in section.energy_ratio {
                // Only the fall of S adds to it: at most its height over R's, l sin φ0 / 2 + h of 9 m.
                assert!((1.0 - 1e-12..1.0 + (5.512 / 2.0 + 0.792) / 9.0).contains(&ratio), "{ratio}");
            }
        }
    }
}
