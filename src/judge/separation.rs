//! Extrapolates a flight back to the separation, and finds what a channel lost between that and the flight's
//! fit.

use crate::data::{ChannelFinding, DropFinding, Finding, FlightFit};

/// Deviation of a velocity from its flight at the separation that is not the flight's, m/s: 2 % of a
/// slap-down. Of 118 simulated sound drops one was off by 0.27 m/s; a cable that broke contact by 1.9.
const LARGE_MISMATCH_M_S: f64 = 0.4;
/// Such a deviation also exceeds the residual of the fit by this factor: a sound drop with a residual of 0.11
/// m/s was off by 3 of them.
const RESIDUALS: f64 = 5.0;

/// Reports the one channel whose velocity deviates from the flight's fit after the separation at `left_s`: a
/// deviation of several channels is a force or a decaying mode, and no cable.
pub fn judge_separation(flight: &FlightFit, left_s: f64) -> Option<Finding> {
    let mut missed = flight.plateaus.iter().filter_map(|plateau| {
        let most_m_s = LARGE_MISMATCH_M_S.max(RESIDUALS * plateau.residual_m_s);
        let mismatch_m_s = plateau.early_mismatch_m_s.filter(|off_m_s| off_m_s.abs() > most_m_s)?;
        let finding = ChannelFinding::EarlyMismatch { mismatch_m_s }.tag(&plateau.channel);
        Some(finding.span(left_s, flight.from_s))
    });
    missed.next().filter(|_| missed.next().is_none())
}

/// Reports modes that the flight is too short to separate from one another, or from a contact whose force has
/// `two_maxima`: of 4 drawn drops with less than a period after those, one was accepted with ω 3 half-widths
/// off.
pub fn judge_unresolved(flight: &FlightFit, two_maxima: Option<Finding>) -> Option<Finding> {
    let flight_s = flight.to_s - flight.from_s;
    let is_open = two_maxima.is_some_and(|_| flight.first_bending_hz(flight_s) * flight_s < 1.0);
    let modes_hz = flight.modes.iter().map(|m| m.frequency_hz).collect();
    let finding = DropFinding::Unresolved { flight_s, modes_hz };
    (is_open || !flight.resolves_modes()).then(|| Finding::from(finding).span(flight.from_s, flight.to_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;

    #[test]
    fn a_channel_that_lost_velocity_before_the_fit_begins_is_named() {
        let named = |off_m_s: f64, residual_m_s: f64| {
            let plateau = crate::data::Plateau {
                early_mismatch_m_s: Some(off_m_s),
                residual_m_s,
                ..example::plateau("A1", 18.0)
            };
            judge_separation(&example::flight(0.1, 0.16, vec![plateau]), 0.092).iter().count()
        };
        assert_eq!([named(-1.9, 0.02), named(0.05, 0.02), named(0.5, 0.11)], [1, 0, 0]);
    }
}
