//! Predicts a drop with each model, and finds the simplest one that suffices.

use super::held::HeldBody;
use super::impact::{Struck, strike_first_end, table_1};
use super::path::{PathEnd, Track};
use super::state::{State, second_end_m};
use super::support::{Hold, Support};
use super::{Fall, predict, thin_rod};
use crate::data::{Body, CogVelocity, Contact, Drop, FlightRegime, Ladder, LadderStep, Prediction, Rung};

/// Predicts with the given model; [`predict`] is the highest one.
///
/// The models below Coulomb friction treat any friction as rough. For k = 0 those below the unilateral
/// contact hold L on the target.
pub fn predict_by(rung: Rung, body: &Body, drop: &Drop, contact: Contact, k: f64) -> Prediction {
    let ideal = match contact {
        Contact::Coulomb(coefficient) if coefficient > 0.0 => Contact::Rough,
        Contact::Coulomb(_) => Contact::Smooth,
        contact => contact,
    };
    let fall = Fall { body: *body, drop: *drop, contact, k };
    match rung {
        Rung::Rod => {
            let rod = thin_rod(body.mass_kg, body.length_m);
            Fall { body: rod, contact: ideal, ..fall }.one_flight(table_1, true)
        }
        Rung::Body => Fall { contact: ideal, ..fall }.one_flight(strike_first_end, true),
        Rung::Friction => fall.one_flight(strike_first_end, true),
        Rung::Unilateral => fall.one_flight(strike_first_end, false),
        Rung::FurtherImpacts => predict(body, &Drop { contact_duration_s: 0.0, ..*drop }, contact, k),
        Rung::FinitePulse => predict(body, drop, contact, k),
    }
}

/// Predicts with every model, simplest first, and finds the simplest that no richer one contradicts. The
/// finite pulse is included if the drop states its duration.
pub fn ladder(body: &Body, drop: &Drop, contact: Contact, k: f64) -> Ladder {
    let mut steps: Vec<LadderStep> = Vec::with_capacity(Rung::ALL.len());
    for rung in Rung::for_drop(drop) {
        let prediction = predict_by(rung, body, drop, contact, k);
        let below = steps.last().and_then(|step| step.prediction.slap_down_speed_m_s);
        let change_percent =
            below.zip(prediction.slap_down_speed_m_s).map(|(below, speed)| 100.0 * (speed - below) / below);
        steps.push(LadderStep { rung, adds: rung.physics(), prediction, change_percent });
    }
    let speeds: Vec<Option<f64>> = steps.iter().map(|step| step.prediction.slap_down_speed_m_s).collect();
    let suffices = (0..steps.len())
        .find(|&i| speeds[i..].iter().all(|richer| Rung::agree(speeds[i], *richer)))
        .map_or(Rung::FinitePulse, |i| steps[i].rung);
    // The last digits of the conversion are rounded off.
    let angle_deg = (drop.angle_rad.to_degrees() * 1e9).round() / 1e9;
    Ladder { angle_deg, contact, k, steps, suffices }
}

/// An impact law: computes the motion after an impact from body, motion before, contact law and k.
type ImpactLaw = fn(&Body, &State, Contact, f64) -> Struck;

impl Fall {
    /// One flight; for k = 0 it follows a rest of L on the target, while the target pushes, or if it `pulls`
    /// until R strikes.
    fn one_flight(&self, impact: ImpactLaw, pulls: bool) -> Prediction {
        let start = State::falling(&self.body, self.drop.angle_rad, &self.drop);
        let struck = impact(&self.body, &start, self.contact, self.k);
        let outcome = if pulls && self.k <= 0.0 {
            self.path_when_held(&struck.after)
        } else {
            Track::new(&self.body, &self.drop, self.contact, None).follow(struck.after, self.k)
        };
        self.prediction(&start, &struck, &outcome)
    }

    /// Path of L held on the target: \[P\] Table 2 for rough and smooth, step by step for the friction
    /// between them.
    fn path_when_held(&self, after: &State) -> PathEnd {
        let second_end = match self.contact {
            Contact::Coulomb(_) => {
                let end = Support::new(&self.body, &self.drop, self.contact, Hold::Pulls).follow(after);
                end.filter(|end| end.strikes).map(|end| (end.at, end.time_s))
            }
            _ => self.closed_form(after).and_then(|held| {
                let time_s = Some(held.time_s()).filter(|time_s| time_s.is_finite())?;
                Some((held.at_second_end()?, time_s))
            }),
        };
        PathEnd { second_end, impacts: 1, regime: FlightRegime::Contact }
    }

    /// \[P\] Table 2 for k = 0, rough or smooth   (11) (12)
    fn closed_form(&self, after: &State) -> Option<HeldBody<'_>> {
        let slides = match self.contact {
            Contact::Rough | Contact::Unknown => false,
            Contact::Smooth => true,
            Contact::Coulomb(_) => return None,
        };
        Some(HeldBody { body: &self.body, gravity_m_s2: self.drop.gravity_m_s2, slides, start: *after })
    }

    fn second_end_speed_m_s(&self, state: &State) -> f64 {
        let corner = state.corner(&self.body, second_end_m(&self.body));
        corner.horizontal_velocity_m_s.hypot(corner.vertical_velocity_m_s)
    }

    /// Prediction for a path that began with `start` and its first impact.
    pub fn prediction(&self, start: &State, struck: &Struck, outcome: &PathEnd) -> Prediction {
        let at = outcome.second_end.as_ref().map(|(state, _)| state);
        let corner = at.map(|state| state.corner(&self.body, second_end_m(&self.body)));
        Prediction {
            model: self.body.model,
            contact: self.contact,
            k: self.k,
            slap_down_speed_m_s: at.map(|state| self.second_end_speed_m_s(state)),
            vertical_velocity_m_s: corner.as_ref().map(|c| c.vertical_velocity_m_s),
            horizontal_velocity_m_s: corner.as_ref().map(|c| c.horizontal_velocity_m_s),
            angular_velocity_rad_s: struck.after.angular_velocity_rad_s,
            flight_time_s: outcome.second_end.as_ref().map(|(_, time_s)| *time_s),
            energy_ratio: at.map(|s| s.kinetic_energy_j(&self.body) / start.kinetic_energy_j(&self.body)),
            slap_down_angle_deg: at.map(|s| s.angle_rad.to_degrees()),
            first_end_impacts: outcome.impacts,
            impulse_ratio: struck.horizontal_impulse_n_s / struck.vertical_impulse_n_s,
            friction_to_stick: struck.friction_to_stick,
            sticks: struck.sticks,
            regime: outcome.regime,
            cog: CogVelocity {
                horizontal_after_impact_m_s: struck.after.horizontal_velocity_m_s,
                vertical_after_impact_m_s: struck.after.vertical_velocity_m_s,
                horizontal_at_slap_down_m_s: at.map(|s| s.horizontal_velocity_m_s),
                vertical_at_slap_down_m_s: at.map(|s| s.vertical_velocity_m_s),
            },
            closed_form_speed_m_s: (self.k <= 0.0 && self.drop.contact_duration_s <= 0.0)
                .then(|| self.closed_form(&struck.after))
                .flatten()
                .and_then(|held| held.at_second_end())
                .map(|state| self.second_end_speed_m_s(&state)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example::anf18;

    fn drop(angle_deg: f64) -> Drop {
        Drop::from_height(9.0, angle_deg.to_radians())
    }

    #[test]
    fn the_first_rung_that_the_others_leave_alone_suffices() {
        let suffices =
            |body: &Body, angle_deg, contact, k| ladder(body, &drop(angle_deg), contact, k).suffices;
        let rod = thin_rod(4466.0, 5.512);
        assert_eq!(suffices(&rod, 15.0, Contact::Rough, 0.5), Rung::Rod);
        assert_eq!(suffices(&anf18(), 15.0, Contact::Rough, 0.5), Rung::Body);
        assert_eq!(suffices(&anf18(), 15.0, Contact::Coulomb(0.3), 0.5), Rung::Friction);
        assert_eq!(suffices(&anf18(), 15.0, Contact::Rough, 0.0), Rung::Unilateral);
        assert_eq!(suffices(&anf18(), 45.0, Contact::Rough, 0.9), Rung::FurtherImpacts);
    }

    #[test]
    fn each_step_says_what_it_changes() {
        let prediction = ladder(&anf18(), &drop(15.0), Contact::Coulomb(0.3), 0.5);
        let speeds: Vec<f64> =
            prediction.steps.iter().map(|s| s.prediction.slap_down_speed_m_s.expect("R strikes")).collect();
        // physics: rod 22.49, body rough 20.18, with friction 22.31 m/s.
        for (speed, expected) in speeds.iter().zip([22.49, 20.18, 22.31, 22.31, 22.31]) {
            assert!((speed - expected).abs() < 0.005, "{speeds:?}");
        }
        assert!(prediction.steps[0].change_percent.is_none());
        let change = prediction.steps[1].change_percent.expect("both strike");
        assert!((change - 100.0 * (speeds[1] / speeds[0] - 1.0)).abs() < 1e-12);
        assert!(!prediction.steps[2].prediction.sticks && prediction.steps[1].prediction.sticks);
    }

    #[test]
    fn the_closed_form_stands_beside_the_flight() {
        let castor = thin_rod(20950.0, 4.486);
        let prediction = predict_by(Rung::Unilateral, &castor, &drop(15.0), Contact::Rough, 0.0);
        assert!((prediction.closed_form_speed_m_s.expect("k = 0") - 20.12).abs() < 0.005);
        assert_eq!(prediction.regime, FlightRegime::Free);
        let held = predict_by(Rung::Rod, &castor, &drop(15.0), Contact::Rough, 0.0);
        assert_eq!(held.slap_down_speed_m_s, prediction.closed_form_speed_m_s);
        assert_eq!(held.regime, FlightRegime::Contact);
        assert!(predict(&castor, &drop(15.0), Contact::Rough, 0.5).closed_form_speed_m_s.is_none());
    }

    #[test]
    fn steep_drops_with_little_rebound_come_down_after_all() {
        // L comes to rest on the target; the body topples over it unless it stands beyond its balance
        // (81.8°).
        for angle_deg in [60.0, 70.0, 80.0] {
            assert!(predict(&anf18(), &drop(angle_deg), Contact::Rough, 0.0).slap_down_speed_m_s.is_some());
        }
        for tenth in 400..600 {
            let prediction = predict(&anf18(), &drop(f64::from(tenth) / 10.0), Contact::Rough, 0.0);
            assert!(prediction.slap_down_speed_m_s.is_some(), "{tenth}: {prediction:?}");
        }
        assert!(predict(&anf18(), &drop(85.0), Contact::Rough, 0.0).slap_down_speed_m_s.is_none());
        let upright = |k| predict(&thin_rod(1000.0, 5.0), &drop(90.0), Contact::Coulomb(0.3), k);
        assert!([0.0, 0.3, 0.86, 1.0].iter().all(|k| upright(*k).slap_down_speed_m_s.is_none()));
    }
}
