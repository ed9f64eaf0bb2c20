//! A class of drops and a seed to recordings, conditioned, with the truth that a method is held against.

use crate::data::{CoarseEvent, STANDARD_GRAVITY_M_S2, Signal};
use crate::lab::chance::Chance;
use crate::lab::damage;
use crate::lab::data::{SyntheticRecording, TrialMap, TrialRequest};
use crate::lab::drawn::{BUILDS, DrawnDrop};
use crate::lab::methods::contest::{Contest, map, some_of};
use crate::lab::plan::DropPlan;
use crate::{condition, events};
use rayon::prelude::*;

/// Drops that have one difficulty in common.
#[derive(Clone, Copy)]
pub(super) struct DropClass {
    pub name: &'static str,
    /// What makes a sound drop one of the class, with its flight, s, and a number between 0 and 1.
    pub make: fn(&mut DropPlan, f64, f64),
}

pub(super) const NOISY: DropClass = DropClass {
    name: "5 g of noise",
    make: |plan, _, _| plan.chain.white_noise_m_s2 = 5.0 * STANDARD_GRAVITY_M_S2,
};

/// A recording up to where first contact is sought.
pub(super) struct Prepared {
    pub drop: DrawnDrop,
    pub signals: Vec<Signal>,
    pub coarse: CoarseEvent,
    /// True first contact, s from the first sample.
    pub contact_s: f64,
}

/// The drops of a class; the same class and seed give the same.
pub(super) fn plans(class: &DropClass, count: u64, request: &TrialRequest) -> Vec<DropPlan> {
    (0..count)
        .into_par_iter()
        .map(|number| {
            let mut chance = Chance::new(request.seed, number);
            let build = BUILDS[usize::try_from(number).unwrap_or(0) % BUILDS.len()];
            let (angle_deg, k) = (chance.even(8.0, 22.0), chance.even(0.2, 0.7));
            let mut plan = DropPlan::of(build, angle_deg, k, request.seed + number);
            plan.pulse_s = chance.even(3e-3, 8e-3);
            // Not on the same place of the first sample's interval every time.
            plan.before_s += chance.even(0.0, 1e-3);
            let sound_s = flight_s(&plan);
            (class.make)(&mut plan, sound_s, chance.even(0.0, 1.0));
            plan
        })
        .collect()
}

/// Length of a plan's flight, s.
pub(super) fn flight_s(plan: &DropPlan) -> f64 {
    plan.draw().motion.truth.flight_s.unwrap_or(0.0)
}

/// The plans' recordings, read and conditioned; a drop without an impact is left out.
pub(super) fn prepared(plans: &[DropPlan]) -> Vec<Prepared> {
    let recorded = |plan: &DropPlan| {
        let drop = plan.draw();
        let written = drop.recorded();
        prepare(drop, &written)
    };
    plans.par_iter().filter_map(recorded).collect()
}

fn prepare(drop: DrawnDrop, written: &SyntheticRecording) -> Option<Prepared> {
    let recording = drop.read(written)?;
    let stated = &drop.stated;
    let coarse = events::Changes::of(&recording).locate(stated.drop.transverse_velocity_m_s())?;
    let reach = condition::Reach::of(&stated.cask, &stated.drop);
    let (signals, _) = condition::condition(&recording, &coarse, &reach, stated.corrections);
    Some(Prepared { contact_s: written.first_contact_s, signals, coarse, drop })
}

/// The methods of `contest` on sound drops with a damage that grows; `case` makes of a drop what they are given, `off` says what they miss.
pub(super) fn grown<M: Copy + PartialEq + Sync, C: Sync + Send, O>(
    contest: &Contest<M, C, O>,
    kind: &str,
    off: &str,
    case: fn(Prepared) -> Option<C>,
    request: &TrialRequest,
) -> Option<TrialMap> {
    /// A method has failed that is off by 1 % of what it measures.
    const LIMIT_PERCENT: f64 = 1.0;
    const SOUND: DropClass = DropClass { name: "sound", make: |_, _, _| {} };
    let kind = damage::growing().find(|one| one.name == kind)?;
    let plans: Vec<(DropPlan, f64)> = plans(&SOUND, if request.quick { 5 } else { 25 }, request)
        .into_par_iter()
        .map(|plan| (plan.clone(), flight_s(&plan)))
        .collect();
    let cases = |size: &f64| {
        let one = |(plan, flight_s): &(DropPlan, f64)| {
            let (drop, written) = kind.grown(plan, *flight_s, *size);
            case(prepare(drop, &written)?)
        };
        plans.par_iter().filter_map(one).collect()
    };
    let sizes = some_of(&kind.growing, request);
    let lines = contest.lines(&sizes, cases);
    let (purpose, title) = (contest.purpose.name, kind.what);
    let name = format!("{purpose}-{}", kind.name).replace([' ', '_'], "-");
    let title = format!("Methods of the {purpose}. {title}");
    Some(map([&name, &title, kind.unit, off], sizes, LIMIT_PERCENT, lines))
}
