//! A limit of the cask file and a result to whether it is kept.

use crate::data::{DropResult, Estimate, ImpactTable, Limit, LimitState, STANDARD_GRAVITY_M_S2 as G};

/// A limit beside what was measured; of what both impacts have, that which may be the larger.
pub fn beside_limit(limit: &Limit, result: &DropResult) -> Limit {
    let larger = |of: fn(&ImpactTable) -> Option<Estimate>| {
        let [first, second] = result.impacts.each_ref().map(of);
        let larger = |(a, b): (Estimate, Estimate)| if a.value + a.u95 > b.value + b.u95 { a } else { b };
        first.zip(second).map(larger)
    };
    let (measured, scale, unit) = match limit.name {
        "slap_down_speed_m_s" => (result.slap_down.speed, 1.0, "m/s"),
        "rigid_body_deceleration_g" => (larger(|of| of.rigid_body_deceleration.at_cog), G, "g"),
        "force_mn" => (larger(|of| of.numbers.force_peak), 1e6, "MN"),
        "crush_mm" => (larger(|of| of.numbers.crush), 1e-3, "mm"),
        "energy_kj" => (larger(|of| of.numbers.energy_absorbed), 1e3, "kJ"),
        _ => (result.k, 1.0, "1"),
    };
    let measured = measured.map(|of| Estimate::new(of.value / scale, of.u95 / scale, unit));
    let [low, high] = measured.map_or([f64::NAN; 2], |of| [of.value - of.u95, of.value + of.u95]);
    let (least, most) = (limit.least.unwrap_or(f64::NEG_INFINITY), limit.most.unwrap_or(f64::INFINITY));
    let state = match () {
        () if low > most || high < least => LimitState::Exceeded,
        () if low >= least && high <= most => LimitState::Kept,
        () => LimitState::Undecided,
    };
    Limit { measured, state, ..*limit }
}
