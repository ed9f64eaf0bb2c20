//! A prediction to how its slap-down speed answers to k and to the drop angle.

use super::path::Way;
use super::state::{Differentiable, State, second_end_m};
use crate::data::{Body, Contact, Drop, GRAZE_SHARE, SpeedGradient};
use num_dual::Dual64;

/// Slap-down speed of [`super::predict`] with its derivatives by k and φ0, by forward differentiation of the same code.
///
/// `None` without a slap-down. Where the way changes its kind (L begins to strike again, R stops striking) the speed
/// jumps; the gradient is that of the way taken.
#[must_use]
pub fn speed_gradient(body: &Body, drop: &Drop, contact: Contact, k: f64) -> Option<SpeedGradient> {
    let (angle, restitution) = (Dual64::from_re(drop.angle_rad), Dual64::from_re(k));
    let by_k = speed_m_s(body, drop, contact, angle, restitution.derivative())?;
    let by_angle = speed_m_s(body, drop, contact, angle.derivative(), restitution)?;
    Some(SpeedGradient { speed_m_s: by_k.re, by_k_m_s: by_k.eps, by_angle_m_s_rad: by_angle.eps })
}

fn speed_m_s<T: Differentiable>(body: &Body, drop: &Drop, contact: Contact, angle_rad: T, k: T) -> Option<T> {
    let start = State::falling(body, angle_rad, drop);
    let (at, _) = Way::of(body, drop, contact, Some(GRAZE_SHARE)).from(&start, drop, k).1.second_end?;
    let corner = at.corner(body, second_end_m(body));
    Some((corner.horizontal_velocity_m_s.powi(2) + corner.vertical_velocity_m_s.powi(2)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::BodyModel;
    use crate::predict::impact::strike_first_end;
    use crate::predict::{predict, thin_rod};

    fn drop(angle_rad: f64, height_m: f64) -> Drop {
        Drop::of_height(height_m, angle_rad)
    }

    fn speed(body: &Body, drop: &Drop, contact: Contact, k: f64) -> f64 {
        predict(body, drop, contact, k).slap_down_speed_m_s.expect("R strikes")
    }

    #[test]
    fn it_is_the_slope_of_the_prediction() {
        let body = Body { model: BodyModel::Body, height_m: 0.8, cog_m: 2.5, ..thin_rod(4466.0, 5.512) };
        // One flight, several impacts, a slide with friction on the target (from 5 cm) and a pivot there.
        let cases = [
            (15.0_f64, 9.0, Contact::Rough, 0.5),
            (20.0, 9.0, Contact::Coulomb(0.3), 0.3),
            (55.0, 9.0, Contact::Rough, 0.85),
            (50.0, 0.05, Contact::Coulomb(0.2), 0.0),
            (30.0, 0.05, Contact::Rough, 0.0),
        ];
        for (angle_deg, height_m, contact, k) in cases {
            let drop = drop(angle_deg.to_radians(), height_m);
            let told = speed_gradient(&body, &drop, contact, k).expect("R strikes");
            let step = 1e-5;
            let turned = |by: f64| Drop { angle_rad: drop.angle_rad + by, ..drop };
            let by_angle = (speed(&body, &turned(step), contact, k)
                - speed(&body, &turned(-step), contact, k))
                / (2.0 * step);
            // Truncation step² f‴/6 and round-off 1e-13 f / step (times the bisection's 1e-3): both below 1e-5 of the speed.
            let bound = 1e-4 * told.speed_m_s.max(1.0);
            assert!(
                (told.by_angle_m_s_rad - by_angle).abs() < bound,
                "{angle_deg}° {contact}: {told:?} {by_angle}"
            );
            if k > 0.0 {
                let by_k = (speed(&body, &drop, contact, k + step) - speed(&body, &drop, contact, k - step))
                    / (2.0 * step);
                assert!((told.by_k_m_s - by_k).abs() < bound, "{angle_deg}° {contact}: {told:?} {by_k}");
            }
        }
    }

    #[test]
    fn just_after_the_impact_k_is_blind_where_the_literature_says() {
        // The vertical velocity of R just after the impact: k v0 − ω2 l cos φ with (7) has no k at cos² φ = 2/3 rough, 1/3 smooth.
        let rod = thin_rod(1000.0, 4.75);
        for (contact, cos2) in [(Contact::Rough, 2.0_f64 / 3.0), (Contact::Smooth, 1.0 / 3.0)] {
            let start = |k: Dual64| {
                let before = State::falling(&rod, Dual64::from_re(cos2.sqrt().acos()), &drop(0.0, 9.0));
                strike_first_end(&rod, &before, contact, k).after.corner(&rod, second_end_m(&rod))
            };
            let corner = start(Dual64::from_re(0.4).derivative());
            let told = corner.vertical_velocity_m_s.eps;
            assert!(told.abs() < 1e-10, "{contact}: {told}");
        }
    }

    #[test]
    fn at_small_angles_it_is_half_the_impact_velocity() {
        let told =
            speed_gradient(&thin_rod(1000.0, 4.75), &drop(0.002, 9.0), Contact::Rough, 0.5).expect("R");
        // dv_R/dk = v0/2 as φ → 0; R falls for τ = l φ/v_R = 0.4 ms, in which gravity adds g τ, 2e-4 of the speed.
        assert!((told.by_k_m_s / (13.288_341 / 2.0) - 1.0).abs() < 5e-4, "{told:?}");
    }
}
