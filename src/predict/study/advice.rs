//! Recommended drop angle and expected slap-down speed from the draws and cases of a study.

use super::monte_carlo::{Trace, five_quantiles, sort};
use crate::data::SweepVariable::{DropHeight, Length};
use crate::data::{Advice, Criterion, CriticalAngle, MonteCarlo, PredictionRow, StudyRequest};
use crate::numerics::as_f64;

/// Combines the draws with the cases, critical angles and rows of their body.
pub(super) fn advice(
    request: &StudyRequest,
    (found, draws): (&MonteCarlo, &[Trace]),
    critical: &[CriticalAngle],
    rows: &[PredictionRow],
) -> Advice {
    let own = sort(draws.iter().map(|traced| traced.own.critical(0)).filter(|speed| speed.is_finite()));
    let is_shown = 2 * own.len() >= draws.len();
    let [low, _, median, _, high] = if is_shown { five_quantiles(&own) } else { [f64::NAN; 5] };
    let is_speed = |c: &&CriticalAngle| c.model == found.model && c.criterion == Criterion::Speed;
    let at_peaks = critical.iter().filter(is_speed).map(|c| (c.angle_deg, c.largest));
    // A swept length or height makes another cask or drop.
    let is_stated = request.sweeps.iter().all(|sweep| ![Length, DropHeight].contains(&sweep.variable));
    let is_counted = |row: &&PredictionRow| {
        is_stated && row.prediction.model == found.model && row.prediction.is_single_slap_down()
    };
    let at_rows = rows.iter().filter(is_counted);
    let at_rows = at_rows.filter_map(|row| Some((row.angle_deg, row.prediction.slap_down_speed_m_s?)));
    let all = draws.iter().map(|traced| traced.largest[0]).chain(at_peaks).chain(at_rows);
    let top = all.filter(|(_, speed)| speed.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1));
    let (at_deg, largest_m_s) = top.unwrap_or((f64::NAN, f64::NAN));
    // Within the tolerance of the angle a drop counts as flat.
    let flat_deg = request.uncertain.angle_deg;
    let bands = found.quantiles[0].robust_bands_deg.iter().map(|band| (band.0.max(flat_deg), band.1));
    let width_deg = |band: &(f64, f64)| band.1 - band.0;
    Advice {
        band_deg: bands.filter(|band| band.0 < band.1).max_by(|a, b| width_deg(a).total_cmp(&width_deg(b))),
        largest_m_s,
        at_deg,
        own_deg: request.angle_deg,
        own_m_s: median,
        own_range_m_s: (low, high),
        own_share: as_f64(own.len()) / as_f64(draws.len()),
        drawn: request.uncertain,
    }
}
