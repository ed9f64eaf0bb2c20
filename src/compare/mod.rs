//! Compares measurement and prediction: the models tried, the model selected, and whether it agrees.

use crate::data::{
    Body, BodyModel, CaskFile, Comparison, Contact, Drop, Estimate, ModelCandidate, ModelChoice, Prediction,
    Quantities, Rung, UNSTATED_INERTIA,
};

/// Predicts a drop with one of the analytical models, such as `predict::predict_by`.
pub type PredictBy<'a> = &'a dyn Fn(Rung, &Body, &Drop, Contact, f64) -> Prediction;

/// Relative standard uncertainty of the change that a pulse of finite length makes: simulated limiters with
/// other shapes than a half-sine, that harden, yield or spring back at once, differ by up to 5 % if L sticks
/// and 17 % if it slides.
const U_PULSE_SHAPE: f64 = 0.1;

/// Inputs of the comparison: the rod and the richest body, the cask file, the drop with the duration of its
/// contact, and the measured values.
struct ModelComparison<'a> {
    rod: &'a Body,
    body: &'a Body,
    file: &'a CaskFile,
    drop: Drop,
    contact: Contact,
    measured: &'a Quantities,
    predict: PredictBy<'a>,
}

/// Compares every model's prediction at the measured k with the measured slap-down speed, simplest first.
///
/// `bodies` are the rod and, where the cask file describes one, the body. Rod and body are always compared, a
/// higher model only where it changes the speed; the finite pulse has the measured duration. Returns the
/// choice and, where both speeds exist, the comparison with the selected model. The simplest model is
/// selected that agrees together with all richer ones, none of them further from it than the uncertainty of
/// the measured speed.
pub fn compare(
    bodies: &[Body],
    cask_file: &CaskFile,
    measured: &Quantities,
    predict: PredictBy,
) -> Option<(ModelChoice, Option<Comparison>)> {
    let (rod, body) = (bodies.first()?, bodies.last()?);
    let contact = contact_as_measured(cask_file, measured);
    let drop = Drop { contact_duration_s: measured.duration.value.max(0.0), ..cask_file.drop };
    let scene = ModelComparison { rod, body, file: cask_file, drop, contact, measured, predict };
    let candidates = scene.candidates();
    // A simple model that agrees where a richer one does not agrees by luck: the richer ones must agree as
    // well. Uncertain inputs that all models share move them together; a test can separate models only by
    // what it measures.
    let known_m_s = measured.speed.map_or(0.0, |speed| speed.u95);
    let taken = (0..candidates.len())
        .find(|&i| objection(&candidates[i..], known_m_s).is_none())
        .unwrap_or(candidates.len().checked_sub(1)?);
    let reason = reason(taken, &candidates, known_m_s);
    let taken = candidates[taken].clone();
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
    Some((ModelChoice { name: taken.model, rung: taken.rung, reason, candidates }, comparison))
}

impl ModelComparison<'_> {
    /// Lists the models that differ from the simpler ones.
    fn candidates(&self) -> Vec<ModelCandidate> {
        let mut candidates: Vec<ModelCandidate> = Vec::new();
        for rung in Rung::for_drop(&self.drop) {
            let candidate = self.candidate(rung);
            let always = rung == Rung::Rod || (rung == Rung::Body && self.body.model == BodyModel::Body);
            let below = candidates.last().and_then(|c| c.predicted);
            if always || !Rung::agree(below, candidate.predicted) {
                candidates.push(candidate);
            }
        }
        candidates
    }

    fn candidate(&self, rung: Rung) -> ModelCandidate {
        let measured = self.measured;
        let predicted = self.speed_m_s(rung, self.body, &self.drop, measured.k.value);
        let u95 = predicted.and_then(|_| self.uncertainty_m_s(rung));
        let difference = match (measured.speed, predicted) {
            (Some(m), Some(p)) => Some((m.value - p, p, m.u95)),
            _ => None,
        };
        ModelCandidate {
            rung,
            model: if rung == Rung::Rod { BodyModel::Rod } else { self.body.model },
            predicted,
            u95,
            difference_percent: difference.map(|(d, p, _)| 100.0 * d / p),
            // E_n = |difference| / √(U₁² + U₂²) ≤ 1 (ISO 13528)
            consistent: difference.zip(u95).is_some_and(|((d, _, m), u)| d.abs() <= m.hypot(u)),
        }
    }

    fn speed_m_s(&self, rung: Rung, body: &Body, drop: &Drop, k: f64) -> Option<f64> {
        (self.predict)(rung, body, drop, self.contact, k.clamp(0.0, 1.0)).slap_down_speed_m_s
    }

    /// 95 % half-width of a prediction, m/s: from k, the cask file's values, and the shape of a pulse of
    /// finite length.
    fn uncertainty_m_s(&self, rung: Rung) -> Option<f64> {
        let Self { body, file, drop, measured, .. } = self;
        let k = measured.k.value.clamp(0.0, 1.0);
        let base = self.speed_m_s(rung, body, drop, k)?;
        let change = |body: &Body, drop: &Drop, k: f64| {
            self.speed_m_s(rung, body, drop, k).map_or(0.0, |speed| speed - base)
        };
        let by_k = change(body, drop, k + measured.k.u95 / 2.0);
        let turned = |by_rad: f64| Drop { angle_rad: (drop.angle_rad + by_rad).max(0.0), ..*drop };
        let by_angle = change(body, &turned(file.tolerances.angle_rad / 2.0), k);
        let by_inertia = self.inertia_influence_m_s(rung, k);
        let known = &file.tolerances;
        let faster_m_s = drop.impact_velocity_m_s * (1.0 + known.impact_velocity / 2.0);
        let by_velocity = change(body, &Drop { impact_velocity_m_s: faster_m_s, ..*drop }, k);
        let by_cog = change(&Body { cog_m: body.cog_m + known.cog_m / 2.0, ..**body }, drop, k);
        let size = |share: f64| 1.0 + share / 2.0;
        let longer = Body { length_m: body.length_m * size(known.length), ..**body };
        let thicker = Body { height_m: body.height_m * size(known.height), ..**body };
        let by_size = change(&longer, drop, k).hypot(change(&thicker, drop, k));
        let omega = drop.angular_velocity_rad_s + known.angular_velocity_rad_s / 2.0;
        let by_turn = change(body, &Drop { angular_velocity_rad_s: omega, ..*drop }, k);
        let along = drop.horizontal_velocity_m_s + known.horizontal_velocity_m_s / 2.0;
        let by_swing = change(body, &Drop { horizontal_velocity_m_s: along, ..*drop }, k);
        let by_law = self.friction_influence_m_s(rung, k);
        let lasting = |contact_duration_s: f64| change(body, &Drop { contact_duration_s, ..*drop }, k);
        let by_duration = lasting(drop.contact_duration_s + measured.duration.u95 / 2.0);
        let by_pulse = by_duration.hypot(U_PULSE_SHAPE * lasting(0.0));
        let stated = [by_angle, by_inertia, by_velocity, by_cog, by_law, by_size, by_turn, by_swing];
        let stated = stated.into_iter().fold(0.0, f64::hypot);
        Some(2.0 * by_k.hypot(stated).hypot(by_pulse))
    }

    /// Change of the speed when the friction is off by its standard uncertainty, m/s; towards less friction
    /// where more has no effect.
    fn friction_influence_m_s(&self, rung: Rung, k: f64) -> f64 {
        // The lower rungs take any friction for rough.
        let predicted = |contact| (self.predict)(rung.max(Rung::Friction), self.body, &self.drop, contact, k);
        let Estimate { value, u95, .. } = self.measured.friction;
        let (taken, share) = (predicted(self.contact), self.file.tolerances.friction / 2.0);
        let needed = taken.friction_to_stick;
        let other = match self.file.contact {
            _ if self.file.has_open_friction() => (value - u95 / 2.0).max(0.0),
            Contact::Smooth => share * needed,
            Contact::Rough | Contact::Unknown => (1.0 - share) * needed,
            Contact::Coulomb(mu) => (1.0 - share) * mu,
        };
        let other = predicted(Contact::Coulomb(other)).slap_down_speed_m_s;
        other.zip(taken.slap_down_speed_m_s).map_or(0.0, |(other, taken)| other - taken)
    }

    /// Change of the speed when the inertia is heavier by its standard uncertainty, m/s. The rod's own
    /// inertia cannot change, so it is treated as a body.
    fn inertia_influence_m_s(&self, rung: Rung, k: f64) -> f64 {
        let (rung, body, inertia) = match rung {
            Rung::Rod => (Rung::Body, self.rod, UNSTATED_INERTIA),
            rung => (rung, self.body, self.file.tolerances.inertia),
        };
        let heavier = Body { inertia_kg_m2: body.inertia_kg_m2 * (1.0 + inertia / 2.0), ..*body };
        let speed = |body: &Body| self.speed_m_s(rung, body, &self.drop, k);
        speed(&heavier).zip(speed(body)).map_or(0.0, |(heavier, as_it_is)| heavier - as_it_is)
    }
}

/// The contact law of the prediction: the stated one, else the friction that was measured.
pub fn contact_as_measured(file: &CaskFile, measured: &Quantities) -> Contact {
    let by_ratio = Contact::Coulomb(measured.friction.value.max(0.0));
    if file.has_open_friction() { by_ratio } else { file.contact }
}

/// The reason why the first of these models, the others being richer, is not selected; `None` if there is
/// none.
fn objection(models: &[ModelCandidate], known_m_s: f64) -> Option<String> {
    let (own, richer) = models.split_first()?;
    if !own.consistent {
        return Some(String::new());
    }
    if let Some(model) = richer.iter().find(|model| !model.consistent) {
        return Some(format!(", which agrees, but the richer '{}' does not", model.rung.words()));
    }
    let apart_m_s = |model: &ModelCandidate| Some((own.predicted? - model.predicted?).abs());
    let model = richer.iter().find(|model| apart_m_s(model).is_some_and(|by_m_s| by_m_s > known_m_s))?;
    let name = model.rung.words();
    Some(format!(", which agrees, but '{name}' lies farther from it than ±{known_m_s:.2} m/s"))
}

/// The reason for the selected model, and what the other models predict.
fn reason(taken: usize, candidates: &[ModelCandidate], known_m_s: f64) -> String {
    let own = &candidates[taken];
    let lead = match (own.predicted, own.difference_percent) {
        (None, _) => "is the richest model, and by it the second end would not strike".to_owned(),
        (_, None) => "is shown: no slap-down speed was measured to choose by".to_owned(),
        (_, Some(percent)) if own.consistent && taken + 1 < candidates.len() => format!(
            "is the simplest model that agrees within both intervals ({percent:+.1} %) while all richer ones \
             agree too and lie within ±{known_m_s:.2} m/s of it"
        ),
        (_, Some(percent)) => {
            let agrees = if own.consistent { "agrees" } else { "does not agree" };
            format!("is the richest model, and {agrees} within both intervals ({percent:+.1} %)")
        }
    };
    let mut words = vec![format!("'{}' {lead}", own.rung.words())];
    for (i, other) in candidates.iter().enumerate().filter(|(i, _)| *i != taken) {
        let name = other.rung.words();
        let predicts = match (other.predicted, other.difference_percent) {
            (Some(m_s), Some(percent)) => format!("'{name}' predicts {m_s:.2} m/s ({percent:+.1} %)"),
            (Some(m_s), None) => format!("'{name}' predicts {m_s:.2} m/s"),
            _ => format!("by '{name}' the second end would not strike"),
        };
        let objection = objection(&candidates[i..], known_m_s).filter(|_| i < taken);
        words.push(predicts + &objection.unwrap_or_default());
    }
    words.join("; ") + "."
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{CogVelocity, Estimate, FlightRegime, example};

    fn quantities(speed_m_s: f64) -> Quantities {
        let exactly = |value, unit| Estimate::new(value, 0.0, unit);
        Quantities {
            impact_velocity: exactly(13.3, "m/s"),
            duration: exactly(0.005, "s"),
            k: exactly(0.5, "1"),
            speed: Some(Estimate::new(speed_m_s, 0.2, "m/s")),
            friction: exactly(0.6, "1"),
            ..Quantities::UNITS.map(|unit| exactly(0.0, unit))
        }
    }

    fn file() -> CaskFile {
        let cask = example::cask(1000.0, 5.0, 0.6);
        CaskFile::new(
            cask,
            Drop { impact_velocity_m_s: 13.3, ..Drop::from_height(9.0, 0.26) },
            Contact::Rough,
        )
    }

    /// The rod says `rod_m_s`, the body 20 m/s, whatever k; each degree adds 1 m/s, so that 0.4° leave 0.4
    /// m/s.
    fn choice(measured_m_s: f64, rod_m_s: f64) -> (BodyModel, bool) {
        let predict = |rung: Rung, body: &Body, drop: &Drop, contact: Contact, k: f64| Prediction {
            model: body.model,
            contact,
            k,
            slap_down_speed_m_s: Some(
                if rung == Rung::Rod { rod_m_s } else { 20.0 } + (drop.angle_rad - 0.26).to_degrees(),
            ),
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
            cog: CogVelocity::default(),
            closed_form_speed_m_s: None,
        };
        let body = example::body(1.0, 5.0, 0.5);
        let (choice, comparison) =
            compare(&[body, body], &file(), &quantities(measured_m_s), &predict).expect("two models");
        (choice.name, comparison.expect("both speeds").agrees)
    }

    #[test]
    fn the_simplest_model_that_agrees_is_taken() {
        assert_eq!(choice(20.1, 20.1), (BodyModel::Rod, true));
        assert_eq!(choice(20.1, 23.0), (BodyModel::Body, true));
    }

    #[test]
    fn a_rod_that_a_richer_body_moves_by_more_than_is_measured_is_not_taken() {
        // Both lie within 0.45 m/s, √(0.2² + 0.4²), of what was measured, but 0.3 m/s from each other; that
        // is known to 0.2 m/s.
        assert_eq!(choice(20.2, 20.3), (BodyModel::Body, true));
    }

    #[test]
    fn a_rod_that_agrees_where_the_body_does_not_agrees_by_luck() {
        assert_eq!(choice(22.0, 22.0), (BodyModel::Body, false));
    }
}
