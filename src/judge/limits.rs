//! Compares a limit of the cask file with the result.

use crate::data::{DropResult, Estimate, ImpactTable, Limit, LimitState, STANDARD_GRAVITY_M_S2 as G};

/// Compares a limit with its measurement, with a guard band of one half-width (JCGM 106:2012, 8.3): it is
/// exceeded if the whole interval lies beyond the limit, kept if all of it lies within, else undecided.
pub fn compare_limit(limit: &Limit, result: &DropResult) -> Limit {
    let (least, most) = (limit.least.unwrap_or(f64::NEG_INFINITY), limit.most.unwrap_or(f64::INFINITY));
    let [low, high] = [|e: &Estimate| e.value - e.u95, |e: &Estimate| e.value + e.u95];
    // One impact beyond the limit is enough, whatever the other one is.
    let larger = |number: fn(&ImpactTable) -> Option<Estimate>, scale: f64, unit: &'static str| {
        let scaled = |e: Estimate| Estimate::new(e.value / scale, e.u95 / scale, unit);
        let impacts = result.impacts.each_ref().map(|impact| number(impact).map(scaled));
        let largest = |among: [Option<Estimate>; 2]| {
            among.into_iter().flatten().max_by(|a, b| high(a).total_cmp(&high(b)))
        };
        largest(impacts.map(|e| e.filter(|e| low(e) > most)))
            .or_else(|| largest(impacts).filter(|_| impacts.iter().all(Option::is_some)))
    };
    let measured = match limit.name {
        "slap_down_speed_m_s" => result.slap_down.speed,
        "local_speed_m_s" => result.slap_down.local_speed,
        "rigid_body_deceleration_g" => larger(|table| table.rigid_body_deceleration.at_cog, G, "g"),
        "force_mn" => larger(|table| table.numbers.force_peak, 1e6, "MN"),
        "crush_mm" => larger(|table| table.numbers.crush, 1e-3, "mm"),
        "energy_kj" => larger(|table| table.numbers.energy_absorbed, 1e3, "kJ"),
        _ => result.k,
    };
    let state = match measured {
        Some(e) if low(&e) > most || high(&e) < least => LimitState::Exceeded,
        Some(e) if low(&e) >= least && high(&e) <= most => LimitState::Kept,
        _ => LimitState::Undecided,
    };
    Limit { measured, state, ..*limit }
}
