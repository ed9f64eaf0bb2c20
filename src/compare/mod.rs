//! Measured beside predicted: the models tried, the one taken and whether it agrees.

use crate::data::{
    Body, BodyModel, CaskFile, Comparison, Contact, Drop, ModelCandidate, ModelChoice, Prediction,
    Quantities, U_ANGLE_RAD,
};

/// Standard uncertainty of an inertia that is only the uniform body's: casks carry their mass off the even spread (5 %).
const U_INERTIA_DEFAULT: f64 = 0.05;
/// Standard uncertainty of an inertia that the cask file states.
const U_INERTIA_STATED: f64 = 0.01;

/// The analytical model as a function, such as `predict::predict`.
pub type Predict<'a> = &'a dyn Fn(&Body, &Drop, Contact, f64) -> Prediction;

/// Holds every body's prediction with the measured k against the measured slap-down speed, simplest first.
///
/// Returns the choice and, where both speeds exist, the comparison with the model taken. The simplest model wins whose own and all richer
/// predictions agree.
#[must_use]
pub fn compare(
    bodies: &[Body],
    cask_file: &CaskFile,
    measured: &Quantities,
    predict: Predict,
) -> Option<(ModelChoice, Option<Comparison>)> {
    let k = measured.k.value.clamp(0.0, 1.0);
    let candidates: Vec<ModelCandidate> = bodies
        .iter()
        .map(|body| {
            let predicted = predict(body, &cask_file.drop, cask_file.contact, k).slap_down_speed_m_s;
            let u95 = predicted.and_then(|_| uncertainty(body, cask_file, measured, predict));
            let difference = match (measured.speed, predicted) {
                (Some(m), Some(p)) => Some((m.value - p, p, m.u95)),
                _ => None,
            };
            ModelCandidate {
                model: body.model,
                predicted,
                u95,
                difference_percent: difference.map(|(d, p, _)| 100.0 * d / p),
                consistent: difference.zip(u95).is_some_and(|((d, _, m), u)| d.abs() <= m.hypot(u)),
            }
        })
        .collect();
    // A simple model that agrees where a richer one does not agrees by luck: the richer ones must agree as well.
    let taken = (0..candidates.len())
        .find(|&i| candidates[i..].iter().all(|c| c.consistent))
        .map(|i| &candidates[i])
        .or_else(|| candidates.last())?
        .clone();
    let comparison = match (measured.speed, taken.predicted, taken.u95) {
        (Some(m), Some(predicted), Some(u95)) => Some(Comparison {
            predicted,
            predicted_u95: u95,
            measured: m.value,
            measured_u95: m.u95,
            difference_percent: 100.0 * (m.value - predicted) / predicted,
            agrees: taken.consistent,
        }),
        _ => None,
    };
    let reason = reason(&taken, &candidates);
    Some((ModelChoice { name: taken.model, reason, candidates }, comparison))
}

/// 95 % half-width of a prediction, m/s: k, angle, inertia, and the finite pulse that the impact formula leaves out.
fn uncertainty(body: &Body, file: &CaskFile, measured: &Quantities, predict: Predict) -> Option<f64> {
    let k = measured.k.value.clamp(0.0, 1.0);
    let speed = |body: &Body, drop: &Drop, k: f64| {
        predict(body, drop, file.contact, k.clamp(0.0, 1.0)).slap_down_speed_m_s
    };
    let base = speed(body, &file.drop, k)?;
    let by_k = speed(body, &file.drop, k + measured.k.u95 / 2.0).map_or(0.0, |s| s - base);
    let turned = |by_rad: f64| Drop { angle_rad: (file.drop.angle_rad + by_rad).max(0.0), ..file.drop };
    let by_angle = speed(body, &turned(U_ANGLE_RAD), k).map_or(0.0, |s| s - base);
    let stated = body.model == BodyModel::Body && !file.defaults.iter().any(|d| d == "cask.inertia_kg_m2");
    let share = if stated { U_INERTIA_STATED } else { U_INERTIA_DEFAULT };
    let heavier = Body { inertia_kg_m2: body.inertia_kg_m2 * (1.0 + share), ..*body };
    let by_inertia = speed(&heavier, &file.drop, k).map_or(0.0, |s| s - base);
    // While the pulse of duration T lasts the cask turns by about ω T / 2 and gravity adds g T.
    let duration_s = measured.duration.value.max(0.0);
    let turn_rad = -measured.angular_velocity.value * duration_s / 2.0;
    let by_pulse = speed(body, &turned(turn_rad), k).map_or(0.0, |s| s - base).abs()
        + file.drop.gravity_m_s2 * duration_s;
    Some(2.0 * by_k.hypot(by_angle).hypot(by_inertia).hypot(by_pulse / 3.0_f64.sqrt()))
}

fn reason(taken: &ModelCandidate, candidates: &[ModelCandidate]) -> String {
    let name = |m: BodyModel| match m {
        BodyModel::Rod => "thin rod",
        BodyModel::Body => "body with section, centre of gravity and inertia",
    };
    let Some(percent) = taken.difference_percent else {
        return format!("No slap-down speed was measured to choose by; the {} is shown.", name(taken.model));
    };
    let others: Vec<String> = candidates
        .iter()
        .filter(|c| c.model != taken.model)
        .filter_map(|c| {
            c.predicted.map(|p| {
                format!(
                    "the {} would say {p:.2} m/s ({:+.1} %)",
                    name(c.model),
                    c.difference_percent.unwrap_or(0.0)
                )
            })
        })
        .collect();
    let lead = if taken.consistent {
        format!("The {} is the simplest model within both intervals ({percent:+.1} %)", name(taken.model))
    } else {
        format!(
            "The measurement does not agree within both intervals; the {} comes nearest ({percent:+.1} %)",
            name(taken.model)
        )
    };
    if others.is_empty() { format!("{lead}.") } else { format!("{lead}; {}.", others.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Cask, Estimate, FilterChoice, FlightRegime};

    fn quantities(speed_m_s: f64) -> Quantities {
        let e = |value, unit| Estimate::new(value, 0.0, unit);
        Quantities {
            impact_velocity: e(13.3, "m/s"),
            duration: e(0.005, "s"),
            rebound_velocity: e(6.65, "m/s"),
            angular_velocity: e(5.0, "rad/s"),
            k: e(0.5, "1"),
            flight_time: None,
            speed: Some(Estimate::new(speed_m_s, 0.2, "m/s")),
            vertical_velocity: None,
            horizontal_velocity: None,
            angle: None,
            second_end_height: None,
            slip_velocity: e(0.0, "m/s"),
            budget: vec![],
        }
    }

    fn file() -> CaskFile {
        CaskFile {
            path: "c.toml".into(),
            sha256: String::new(),
            cask: Cask {
                name: "C".into(),
                mass_kg: 1000.0,
                length_m: 5.0,
                height_m: 0.6,
                width_m: None,
                cog_m: 2.5,
                inertia_kg_m2: 2100.0,
                is_body: true,
            },
            drop: Drop {
                height_m: 9.0,
                angle_rad: 0.26,
                impact_velocity_m_s: 13.3,
                impact_velocity_given: false,
                gravity_m_s2: 9.81,
            },
            contact: Contact::Rough,
            filter: FilterChoice::Auto,
            time: None,
            channels: vec![],
            defaults: vec![],
        }
    }

    /// The rod always says `rod_m_s`, the body 20 m/s, whatever angle and k.
    fn choice(measured_m_s: f64, rod_m_s: f64) -> (BodyModel, bool) {
        let predict = |body: &Body, _: &Drop, contact: Contact, k: f64| Prediction {
            model: body.model,
            contact,
            k,
            slap_down_speed_m_s: Some(if body.model == BodyModel::Rod { rod_m_s } else { 20.0 }),
            vertical_velocity_m_s: None,
            horizontal_velocity_m_s: None,
            angular_velocity_rad_s: 5.0,
            flight_time_s: None,
            energy_ratio: None,
            slap_down_angle_deg: None,
            first_end_impacts: 1,
            impulse_ratio: 0.4,
            friction_to_stick: 0.4,
            sticks: true,
            regime: FlightRegime::Free,
            closed_form_speed_m_s: None,
        };
        let body = |model| Body {
            model,
            mass_kg: 1.0,
            length_m: 5.0,
            height_m: 0.0,
            cog_m: 2.5,
            inertia_kg_m2: 1.0,
        };
        let bodies = [body(BodyModel::Rod), body(BodyModel::Body)];
        let (choice, comparison) =
            compare(&bodies, &file(), &quantities(measured_m_s), &predict).expect("two bodies");
        (choice.name, comparison.expect("both speeds").agrees)
    }

    #[test]
    fn the_simplest_model_that_agrees_is_taken() {
        assert_eq!(choice(20.1, 20.1), (BodyModel::Rod, true));
        assert_eq!(choice(20.1, 23.0), (BodyModel::Body, true));
    }

    #[test]
    fn a_rod_that_agrees_where_the_body_does_not_agrees_by_luck() {
        assert_eq!(choice(22.0, 22.0), (BodyModel::Body, false));
    }
}
