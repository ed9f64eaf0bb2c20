//! Follows the motion from just after L's first impact to just before R strikes.

use super::flight::{first_end_touches, second_end_touches, sinks};
use super::impact::{Struck, strike_first_end};
use super::pulse::push_first_end;
use super::resting::RestEnd;
use super::state::{State, second_end_m};
use super::support::{Hold, Support};
use crate::data::{Body, Contact, Drop, FlightRegime};

/// More impacts of L than this before R strikes count as endless bouncing: with k ≤ 0.96 the last rebound is
/// below [`REST_M_S`].
const MOST_IMPACTS: u32 = 300;

/// A rebound slower than this, m/s, is a rest on Earth: it lifts L by 5 nm. With another gravity the limit
/// scales so that the height is equal.
const REST_M_S: f64 = 3e-4;

/// If L touches the target again sooner than this, s, it has not left it on Earth: gravity moves a free
/// corner by 5 nm.
const LET_GO_S: f64 = 3e-5;

/// Gravity for which both limits hold, m/s²: the default of a cask file.
const EARTH_M_S2: f64 = 9.81;

/// Conditions of a path: the contact of L, and the extent of the calculation.
#[derive(Clone, Copy)]
pub(super) struct Track<'a> {
    pub support: Support<'a>,
    /// Depth to which L must sink to strike again, m; `None` ignores further impacts.
    pub graze_m: Option<f64>,
}

/// End of a path.
pub(super) struct PathEnd {
    /// The motion just before R strikes, and the time since the first impact, s.
    pub second_end: Option<(State, f64)>,
    pub impacts: u32,
    pub regime: FlightRegime,
}

impl<'a> Track<'a> {
    /// Prepares the path; `graze_share` is the share of the length that L must sink to strike again, and
    /// `None` ignores further impacts.
    pub fn new(body: &'a Body, drop: &Drop, contact: Contact, graze_share: Option<f64>) -> Self {
        Self {
            support: Support::new(body, drop, contact, Hold::Pushes),
            graze_m: graze_share.map(|share| share * body.length_m),
        }
    }

    /// Follows L's first impact, with the duration that the drop states, and the path after it.
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

    /// Follows flights, rests and further impacts of L until R strikes, or reports that it does not.
    pub fn follow(&self, after_impact: State, k: f64) -> PathEnd {
        let (body, gravity_m_s2) = (self.support.body, self.support.gravity_m_s2);
        let mut state = after_impact;
        let mut elapsed_s = 0.0;
        let mut outcome = PathEnd { second_end: None, impacts: 1, regime: FlightRegime::Free };
        loop {
            if self.is_at_rest(&state) {
                let (end, held) = self.follow_rest(&state);
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
            match self.next_strike_s(&state, second_s) {
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

    /// True if the last impact left L on the target. Even with k = 0 stopping its sliding may throw a rough
    /// corner up.
    fn is_at_rest(&self, state: &State) -> bool {
        let body = self.support.body;
        state.corner(body, body.cog_m).vertical_velocity_m_s < REST_M_S * self.gravity_share().sqrt()
    }

    /// Follows L on the target until R strikes or the target would have to pull. L then flies, the limit k →
    /// 0, unless it sinks deeper than a graze: then it has not left the target at all and slides on until it
    /// rises by itself. The flag is true if the contact law held L all the time.
    fn follow_rest(&self, from: &State) -> (Option<RestEnd>, bool) {
        let end = self.support.follow(from);
        let Some(lifted) = end.filter(|end| !end.strikes) else { return (end, true) };
        let second_s = second_end_touches(self.support.body, self.support.gravity_m_s2, &lifted.at);
        let again_s = self.next_strike_s(&lifted.at, second_s);
        if again_s.is_none_or(|again_s| again_s > LET_GO_S / self.gravity_share().sqrt()) {
            return (end, true);
        }
        let slid = (Support { hold: Hold::Yields, ..self.support }).follow(&lifted.at);
        (slid.map(|end| RestEnd { time_s: lifted.time_s + end.time_s, ..end }), false)
    }

    /// Time at which L strikes again before R does, deeper than a graze   (9)
    fn next_strike_s(&self, state: &State, second_s: Option<f64>) -> Option<f64> {
        let graze_m = self.graze_m?;
        let first_s = first_end_touches(&self.support, state, second_s)?;
        let Some(second_s) = second_s else { return Some(first_s) };
        let strikes = first_s < second_s && sinks(&self.support, state, first_s..second_s, graze_m);
        strikes.then_some(first_s)
    }

    /// If R is at the target but the axis is past the vertical, the cask lies on its other side.
    fn is_slap_down(&self, at: &State) -> bool {
        let body = self.support.body;
        let corner = at.corner(body, second_end_m(body));
        at.angle_rad.cos() > 0.0 && corner.vertical_velocity_m_s < 0.0
    }
}
