//! The motion just after L's first impact to the motion just before R strikes.

use super::flight::{first_end_touches, second_end_touches, sinks};
use super::impact::{Struck, strike_first_end};
use super::pulse::push_first_end;
use super::resting::RestEnd;
use super::state::{State, second_end_m};
use super::support::{Hold, Support};
use crate::data::{Body, Contact, Drop, FlightRegime};

/// More impacts of L than this before R strikes count as bouncing without end: with k ≤ 0.96 the last rebound
/// is below [`REST_M_S`].
const MOST_IMPACTS: u32 = 300;

/// A rebound slower than this, m/s, is a rest on Earth: it lifts L by 5 nm. Another gravity's lifts it as
/// high.
const REST_M_S: f64 = 3e-4;

/// L that touches the target again sooner than this, s, has not left it on Earth: gravity moves a free corner
/// by 5 nm.
const LET_GO_S: f64 = 3e-5;

/// Gravity for which the two hold, m/s²: the default of a cask file.
const EARTH_M_S2: f64 = 9.81;

/// What L meets, and how far its motion is followed.
#[derive(Clone, Copy)]
pub(super) struct Way<'a> {
    pub support: Support<'a>,
    /// How deep L must sink to strike again, m; `None`: further impacts are left out.
    pub graze_m: Option<f64>,
}

/// How the way ends.
pub(super) struct PathEnd {
    /// The motion just before R strikes, and the time since the first impact, s.
    pub second_end: Option<(State, f64)>,
    pub impacts: u32,
    pub regime: FlightRegime,
}

impl<'a> Way<'a> {
    /// `graze_share` is the share of the length that L must sink to strike again; `None`: further impacts are
    /// left out.
    pub fn of(body: &'a Body, drop: &Drop, contact: Contact, graze_share: Option<f64>) -> Self {
        Self {
            support: Support::of(body, drop, contact, Hold::Pushes),
            graze_m: graze_share.map(|share| share * body.length_m),
        }
    }

    /// L's first impact, as long as the drop says, and the way after it.
    pub fn from(mut self, start: &State, drop: &Drop, k: f64) -> (Struck, PathEnd) {
        let body = self.support.body;
        let (struck, strikes_s) = push_first_end(body, start, drop, self.support.contact, k);
        if let Some(time_s) = strikes_s {
            let second_end = Some((struck.after, time_s)).filter(|(at, _)| self.is_slap_down(at));
            return (struck, PathEnd { second_end, impacts: 1, regime: FlightRegime::Contact });
        }
        if drop.contact_duration_s > 0.0 {
            self.support.sunk_m = -struck.after.corner(body, body.cog_m).height_m;
        }
        let mut outcome = self.follow(struck.after, k);
        if let Some((_, time_s)) = &mut outcome.second_end {
            *time_s += drop.contact_duration_s;
        }
        (struck, outcome)
    }

    /// Follows flights, rests and further impacts of L until R strikes, or says that it does not.
    pub fn follow(&self, after_impact: State, k: f64) -> PathEnd {
        let (body, gravity_m_s2) = (self.support.body, self.support.gravity_m_s2);
        let mut state = after_impact;
        let mut elapsed_s = 0.0;
        let mut outcome = PathEnd { second_end: None, impacts: 1, regime: FlightRegime::Free };
        loop {
            if self.rests(&state) {
                let (end, held) = self.rest(&state);
                let Some(RestEnd { at, time_s, strikes }) = end else { return outcome };
                if strikes {
                    let whole = held && outcome.impacts == 1 && elapsed_s == 0.0;
                    outcome.regime = if whole { FlightRegime::Contact } else { FlightRegime::Mixed };
                    outcome.second_end = Some((at, elapsed_s + time_s));
                    return outcome;
                }
                if time_s > 0.0 {
                    outcome.regime = FlightRegime::Mixed;
                }
                state = at;
                elapsed_s += time_s;
            }
            let second_s = second_end_touches(body, gravity_m_s2, &state);
            match self.strikes_again(&state, second_s) {
                Some(time_s) if outcome.impacts < MOST_IMPACTS => {
                    let at = state.after(time_s, gravity_m_s2).with_first_end_at(body, self.support.sunk_m);
                    state = strike_first_end(body, &at, self.support.contact, k).after;
                    elapsed_s += time_s;
                    outcome.impacts += 1;
                }
                Some(_) => return outcome,
                None => {
                    outcome.second_end = second_s
                        .map(|time_s| (state.after(time_s, gravity_m_s2), elapsed_s + time_s))
                        .filter(|(at, _)| self.is_slap_down(at));
                    return outcome;
                }
            }
        }
    }

    /// Gravity over that of the Earth.
    fn gravity_share(&self) -> f64 {
        self.support.gravity_m_s2 / EARTH_M_S2
    }

    /// Whether the last impact left L on the target. Even with k = 0 stopping its sliding may throw a rough
    /// corner up.
    fn rests(&self, state: &State) -> bool {
        let body = self.support.body;
        state.corner(body, body.cog_m).vertical_velocity_m_s < REST_M_S * self.gravity_share().sqrt()
    }

    /// L on the target until R strikes or the target would have to pull. L then flies, the limit k → 0,
    /// unless it sinks deeper than a graze: then it has not left the target at all and slides on until it
    /// rises by itself. The flag says whether the contact law held L all the time.
    fn rest(&self, from: &State) -> (Option<RestEnd>, bool) {
        let end = self.support.rest(from);
        let Some(lifted) = end.filter(|end| !end.strikes) else { return (end, true) };
        let second_s = second_end_touches(self.support.body, self.support.gravity_m_s2, &lifted.at);
        let again_s = self.strikes_again(&lifted.at, second_s);
        if again_s.is_none_or(|again_s| again_s > LET_GO_S / self.gravity_share().sqrt()) {
            return (end, true);
        }
        let slid = (Support { hold: Hold::Yields, ..self.support }).rest(&lifted.at);
        (slid.map(|end| RestEnd { time_s: lifted.time_s + end.time_s, ..end }), false)
    }

    /// When L strikes again before R does, deeper than a graze   (9)
    fn strikes_again(&self, state: &State, second_s: Option<f64>) -> Option<f64> {
        let graze_m = self.graze_m?;
        let first_s = first_end_touches(&self.support, state, second_s)?;
        let Some(second_s) = second_s else { return Some(first_s) };
        let strikes = first_s < second_s && sinks(&self.support, state, first_s..second_s, graze_m);
        strikes.then_some(first_s)
    }

    /// R at the target but with the axis past the vertical is the other side of the cask.
    fn is_slap_down(&self, at: &State) -> bool {
        let body = self.support.body;
        let corner = at.corner(body, second_end_m(body));
        at.angle_rad.cos() > 0.0 && corner.vertical_velocity_m_s < 0.0
    }
}
