//! A class of drops and a seed to recordings, conditioned, with the truth that a method is held against.

use super::scene::{ANF_10, ANF_18, Drawn, ESBB, Plan, VHLW};
use crate::data::{CoarseEvent, Signal};
use crate::lab::data::TrialRequest;
use crate::{condition, events};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;

/// Drops that have one difficulty in common.
#[derive(Clone, Copy)]
pub(super) struct Class {
    pub name: &'static str,
    /// What makes a sound drop one of the class, with its flight, s, and a number between 0 and 1.
    pub make: fn(&mut Plan, f64, f64),
}

/// A recording up to where first contact is sought.
pub(super) struct Prepared {
    pub drawn: Drawn,
    pub signals: Vec<Signal>,
    pub coarse: CoarseEvent,
    /// True first contact, s from the first sample.
    pub contact_s: f64,
}

/// The drops of a class; the same class and seed give the same.
pub(super) fn plans(class: &Class, count: u64, request: &TrialRequest) -> Vec<Plan> {
    (0..count)
        .into_par_iter()
        .map(|number| {
            let mut random = ChaCha8Rng::seed_from_u64(request.seed);
            random.set_stream(number);
            let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
            let builds = [ESBB, ANF_10, ANF_18, VHLW];
            let build = builds[usize::try_from(number).unwrap_or(0) % builds.len()];
            let (angle_deg, k) = (between(8.0, 22.0), between(0.2, 0.7));
            let mut plan = Plan::of(build, angle_deg, k, request.seed + number);
            plan.pulse_s = between(3e-3, 8e-3);
            // Not on the same place of the first sample's interval every time.
            plan.before_s += between(0.0, 1e-3);
            let flight_s = plan.draw().truth().flight_s.unwrap_or(0.0);
            (class.make)(&mut plan, flight_s, between(0.0, 1.0));
            plan
        })
        .collect()
}

/// The plans' recordings, read and conditioned; a drop without an impact is left out.
pub(super) fn prepared(plans: &[Plan]) -> Vec<Prepared> {
    plans.par_iter().filter_map(prepare).collect()
}

fn prepare(plan: &Plan) -> Option<Prepared> {
    let drawn = plan.draw();
    let (written, recording) = drawn.recorded();
    let recording = recording?;
    let stated = &drawn.stated;
    let coarse = events::Changes::of(&recording).locate(stated.drop.transverse_velocity_m_s())?;
    let reach = condition::Reach::of(&stated.cask, &stated.drop);
    let (signals, _) = condition::condition(&recording, &coarse, &reach, stated.corrections);
    Some(Prepared { contact_s: written.first_contact_s, signals, coarse, drawn })
}
