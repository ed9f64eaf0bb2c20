//! A class of drops and a seed to plans of drops, and a recording to its conditioned channels.

use crate::data::{CaskFile, CoarseEvent, Recording, STANDARD_GRAVITY_M_S2, Signal};
use crate::lab::chance::Chance;
use crate::lab::data::TrialRequest;
use crate::lab::drawn::{BUILDS, DropPlan};
use crate::{condition, events};
use rayon::prelude::*;

/// Drops that have one difficulty in common.
#[derive(Clone, Copy)]
pub(super) struct DropClass {
    pub name: &'static str,
    /// What makes a sound drop one of the class, with its flight, s, and a number between 0 and 1.
    pub make: fn(&mut DropPlan, f64, f64),
}

/// Nothing rings.
pub(super) const CALM: DropClass = DropClass { name: "calm", make: |_, _, _| {} };
pub(super) const NOISY: DropClass = DropClass {
    name: "5 g of noise",
    make: |plan, _, _| plan.chain.white_noise_m_s2 = 5.0 * STANDARD_GRAVITY_M_S2,
};
pub(super) const ONE_MODE: DropClass = DropClass {
    name: "one mode, 2 to 5 periods",
    make: |plan, flight_s, share| plan.modes = vec![DropPlan::mode(1, (2.0 + 3.0 * share) / flight_s)],
};
pub(super) const SLOW_MODE: DropClass = DropClass {
    name: "slow mode, 0.7 to 1.2 periods",
    make: |plan, flight_s, share| plan.modes = vec![DropPlan::mode(1, (0.7 + 0.5 * share) / flight_s)],
};

impl DropClass {
    /// The drops of the class; the same class and seed give the same.
    pub(super) fn plans(&self, count: u64, request: &TrialRequest) -> Vec<DropPlan> {
        let plan = |number: u64| {
            let mut chance = Chance::new(request.seed, number);
            let build = BUILDS[usize::try_from(number).unwrap_or(0) % BUILDS.len()];
            let (angle_deg, k) = (chance.even(8.0, 22.0), chance.even(0.2, 0.7));
            let mut plan = DropPlan::of(build, angle_deg, k, request.seed + number);
            plan.pulse_s = chance.even(3e-3, 8e-3);
            // Not on the same place of the first sample's interval every time.
            plan.before_s += chance.even(0.0, 1e-3);
            let sound_s = plan.flight_s();
            (self.make)(&mut plan, sound_s, chance.even(0.0, 1.0));
            plan
        };
        (0..count).into_par_iter().map(plan).collect()
    }
}

/// The conditioned channels of a recording about the first impact, and where that lies; none without an
/// impact.
pub(super) fn conditioned(recording: &Recording, file: &CaskFile) -> Option<(Vec<Signal>, CoarseEvent)> {
    let coarse = events::Changes::of(&recording.channels).locate(file.drop.transverse_velocity_m_s())?;
    let reach = condition::Reach::of(&file.cask, &file.drop);
    let (signals, _) = condition::condition(recording, &coarse, &reach, file.corrections);
    Some((signals, coarse))
}

#[cfg(test)]
mod tests;
