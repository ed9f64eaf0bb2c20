//! A rung of the ladder of models to its prediction, and all rungs to the one that suffices.

use super::impact::{Struck, strike_first_end};
use super::path::{Outcome, Way};
use super::resting::{End, Support};
use super::state::{State, second_end_m};
use super::{held, predict, rod, thin_rod};
use crate::data::{
    Body, Contact, Drop, FlightRegime, LADDER_TOLERANCE_PERCENT, Ladder, LadderStep, Prediction, Rung,
};

/// What is predicted: a body, its drop, the contact law and k.
#[derive(Clone, Copy)]
pub(super) struct Case<'a> {
    pub body: &'a Body,
    pub drop: &'a Drop,
    pub contact: Contact,
    pub k: f64,
}

/// What `rung` says; [`predict`] is the highest one.
///
/// The rungs below Coulomb friction take any friction for rough. For k = 0 those below the unilateral contact hold L on the target.
#[must_use]
pub fn predict_by(rung: Rung, body: &Body, drop: &Drop, contact: Contact, k: f64) -> Prediction {
    let ideal = match contact {
        Contact::Coulomb(coefficient) if coefficient > 0.0 => Contact::Rough,
        Contact::Coulomb(_) => Contact::Smooth,
        contact => contact,
    };
    match rung {
        Rung::Rod => {
            let rod = thin_rod(body.mass_kg, body.length_m);
            Case { body: &rod, drop, contact: ideal, k }.held_or_one_flight(rod::table_1)
        }
        Rung::Body => Case { body, drop, contact: ideal, k }.held_or_one_flight(strike_first_end),
        Rung::Friction => Case { body, drop, contact, k }.held_or_one_flight(strike_first_end),
        Rung::Unilateral => Case { body, drop, contact, k }.unilateral(),
        Rung::FurtherImpacts => predict(body, drop, contact, k),
    }
}

/// Every rung's prediction, simplest first, and the simplest that no richer one moves by more than [`LADDER_TOLERANCE_PERCENT`].
#[must_use]
pub fn ladder(body: &Body, drop: &Drop, contact: Contact, k: f64) -> Ladder {
    let mut steps: Vec<LadderStep> = Vec::with_capacity(Rung::ALL.len());
    for rung in Rung::ALL {
        let prediction = predict_by(rung, body, drop, contact, k);
        let below = steps.last().and_then(|step| step.prediction.slap_down_speed_m_s);
        let change_percent =
            below.zip(prediction.slap_down_speed_m_s).map(|(below, speed)| 100.0 * (speed - below) / below);
        steps.push(LadderStep { rung, adds: rung.adds(), prediction, change_percent });
    }
    let speeds: Vec<Option<f64>> = steps.iter().map(|step| step.prediction.slap_down_speed_m_s).collect();
    let suffices = (0..steps.len())
        .find(|&i| speeds[i..].iter().all(|richer| alike(speeds[i], *richer)))
        .map_or(Rung::FurtherImpacts, |i| steps[i].rung);
    Ladder { angle_deg: drop.angle_rad.to_degrees(), contact, k, steps, suffices }
}

/// Whether two rungs say the same, within the tolerance of the ladder.
fn alike(one: Option<f64>, other: Option<f64>) -> bool {
    match (one, other) {
        (Some(one), Some(other)) => (other - one).abs() <= LADDER_TOLERANCE_PERCENT / 100.0 * one,
        (None, None) => true,
        _ => false,
    }
}

/// An impact law: body, motion before, contact law and k to the motion after.
type Impact = fn(&Body, &State<f64>, Contact, f64) -> Struck<f64>;

impl Case<'_> {
    fn start(&self) -> State<f64> {
        State::falling(self.body, self.drop.angle_rad, self.drop.impact_velocity_m_s)
    }

    fn support(&self, two_sided: bool) -> Support<'_> {
        Support { body: self.body, gravity_m_s2: self.drop.gravity_m_s2, contact: self.contact, two_sided }
    }

    /// k = 0: L held on the target until R strikes; else one flight.
    fn held_or_one_flight(&self, impact: Impact) -> Prediction {
        let start = self.start();
        let struck = impact(self.body, &start, self.contact, self.k);
        let outcome = if self.k <= 0.0 { self.held(&struck.after) } else { self.one_flight(&struck) };
        self.prediction(&start, &struck, outcome)
    }

    /// k = 0: L on the target while it pushes, then one flight; else one flight.
    fn unilateral(&self) -> Prediction {
        let start = self.start();
        let struck = strike_first_end(self.body, &start, self.contact, self.k);
        let outcome = self.one_flight(&struck);
        self.prediction(&start, &struck, outcome)
    }

    fn one_flight(&self, struck: &Struck<f64>) -> Outcome<f64> {
        Way { support: self.support(false), graze_m: None }.follow(struck.after, self.k)
    }

    /// L held on the target: [P] Table 2 for rough and smooth, step by step for the friction between them.
    fn held(&self, after: &State<f64>) -> Outcome<f64> {
        let second_end = match self.contact {
            Contact::Coulomb(_) => match self.support(true).rest(after) {
                End::SecondEnd(at, time_s) => Some((at, time_s)),
                End::LiftsOff(..) | End::Never => None,
            },
            _ => self.closed_form(after),
        };
        Outcome { second_end, impacts: 1, regime: FlightRegime::Contact }
    }

    /// [P] Table 2 for k = 0, rough or smooth   (11) (12)
    fn closed_form(&self, after: &State<f64>) -> Option<(State<f64>, f64)> {
        let slides = match self.contact {
            Contact::Rough => false,
            Contact::Smooth => true,
            Contact::Coulomb(_) => return None,
        };
        held::to_second_end(self.body, self.drop.gravity_m_s2, slides, after)
    }

    fn second_end_speed_m_s(&self, state: &State<f64>) -> f64 {
        let corner = state.corner(self.body, second_end_m(self.body));
        corner.horizontal_velocity_m_s.hypot(corner.vertical_velocity_m_s)
    }

    /// What is told of a way that began with `start` and its first impact.
    pub fn prediction(&self, start: &State<f64>, struck: &Struck<f64>, outcome: Outcome<f64>) -> Prediction {
        let at = outcome.second_end.as_ref().map(|(state, _)| state);
        let corner = at.map(|state| state.corner(self.body, second_end_m(self.body)));
        Prediction {
            model: self.body.model,
            contact: self.contact,
            k: self.k,
            slap_down_speed_m_s: at.map(|state| self.second_end_speed_m_s(state)),
            vertical_velocity_m_s: corner.as_ref().map(|c| c.vertical_velocity_m_s),
            horizontal_velocity_m_s: corner.as_ref().map(|c| c.horizontal_velocity_m_s),
            angular_velocity_rad_s: struck.after.angular_velocity_rad_s,
            flight_time_s: outcome.second_end.as_ref().map(|(_, time_s)| *time_s),
            energy_ratio: at.map(|s| s.kinetic_energy_j(self.body) / start.kinetic_energy_j(self.body)),
            slap_down_angle_deg: at.map(|s| s.angle_rad.to_degrees()),
            first_end_impacts: outcome.impacts,
            impulse_ratio: struck.horizontal_impulse_n_s / struck.vertical_impulse_n_s,
            friction_to_stick: struck.friction_to_stick,
            sticks: struck.sticks,
            regime: outcome.regime,
            closed_form_speed_m_s: (self.k <= 0.0)
                .then(|| self.closed_form(&struck.after))
                .flatten()
                .map(|(state, _)| self.second_end_speed_m_s(&state)),
        }
    }
}
