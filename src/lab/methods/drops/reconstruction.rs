//! The rungs of the reconstruction to how far off each leaves slap-down speed and k, and what it costs by itself.

use super::flight::{CALM, NOISY, ONE_MODE, SLOW_MODE};
use super::sample::{self, Class, Prepared};
use super::scene::Drawn;
use super::summary::{Subject, by_class, point};
use crate::analysis::{self, analyze, settle};
use crate::data::{
    At, Axis, End, Estimate, Events, FlightFit, ReconstructionChoice, ReconstructionRung, Setup,
};
use crate::lab::data::{TrialPart, TrialPeerWork, TrialPoint, TrialRequest};
use crate::lab::methods::timing::{Effort, Timing, Work, in_turn};
use crate::{fit, motion};
use rayon::prelude::*;
use std::hint::black_box;

const CLASSES: [Class; 5] = [
    CALM,
    NOISY,
    ONE_MODE,
    SLOW_MODE,
    Class { name: "12 ms pulse", make: |plan, _, _| plan.pulse_s = 0.012 },
];

/// The family that others are held against too, and its error.
const SPEED: (&str, &str) = ("reconstruction, speed", "% of the slap-down speed");

/// What the result gives: the rung that it says to take.
const TAKEN: &str = "as taken";

const METHODS: [&str; 5] = ["channels", "planar", "flight", "joint", TAKEN];

pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let count = if request.quick { 6 } else { 40 };
    let part =
        by_class(&CLASSES, progress, |class| of_class(class, &sample::plans(class, count, request), request));
    progress(1.0);
    part
}

/// Some drops of each class for programs of others: what the second end reads, and the speed that it strikes with.
pub(in crate::lab::methods) fn peer_work(request: &TrialRequest) -> Vec<TrialPeerWork> {
    let of_class = |class: &Class| {
        let plans = sample::plans(class, if request.quick { 4 } else { 12 }, request);
        let of_drop = |drop: &Prepared| {
            let second = drop.signals.iter().find(|s| s.end == End::Second && s.axis == Axis::Transverse)?;
            Some(TrialPeerWork {
                family: SPEED.0,
                class: class.name.to_owned(),
                low_pass: None,
                drop: Some((second.sample_rate_hz, drop.drawn.stated.drop.impact_velocity_m_s)),
                samples: second.force_m_s2.clone(),
                truth: vec![drop.drawn.truth().speed?],
                error_unit: SPEED.1,
            })
        };
        sample::prepared(&plans).iter().filter_map(of_drop).collect::<Vec<_>>()
    };
    CLASSES.iter().flat_map(of_class).collect()
}

fn of_class(class: &Class, plans: &[super::scene::Plan], request: &TrialRequest) -> Vec<TrialPoint> {
    let readings: Vec<Vec<(Option<f64>, Option<f64>)>> =
        plans.par_iter().map(|plan| off(&plan.draw())).collect();
    let timed =
        plans.first().into_iter().flat_map(|plan| sample::prepared(std::slice::from_ref(plan))).next();
    let Some(timings) = timed.as_ref().and_then(|drop| times(drop, request)) else { return Vec::new() };
    let mut points = Vec::new();
    for (i, method) in METHODS.into_iter().enumerate() {
        let subject = |family, error_unit| Subject {
            family,
            method,
            class: class.name,
            is_default: method == TAKEN,
            error_unit,
        };
        let speeds: Vec<Option<f64>> = readings.iter().map(|r| r[i].0).collect();
        let ks: Vec<Option<f64>> = readings.iter().map(|r| r[i].1).collect();
        points.push(point(subject(SPEED.0, SPEED.1), &speeds, 100.0, timings[i]));
        points.push(point(subject("reconstruction, k", "1"), &ks, 1.0, timings[i]));
    }
    points
}

/// Errors of speed, %, and k by each method, in the order of [`METHODS`]; none where there is no number.
fn off(drawn: &Drawn) -> Vec<(Option<f64>, Option<f64>)> {
    let truth = drawn.truth();
    let result = drawn.recorded().1.map(|recording| analyze(&recording, &drawn.stated).result);
    let speed_off = |stated: Option<Estimate>| {
        let (stated, truth) = stated.zip(truth.speed)?;
        Some(100.0 * (stated.value / truth - 1.0).abs())
    };
    let k_off = |stated: Option<Estimate>| Some((stated?.value - truth.k?).abs());
    let choice: Option<&ReconstructionChoice> = result.as_ref().and_then(|r| r.reconstruction.as_ref());
    let by_rung = |rung: ReconstructionRung| {
        let candidate = choice.and_then(|c| c.candidates.iter().find(|c| c.rung == rung));
        (speed_off(candidate.and_then(|c| c.speed)), k_off(candidate.and_then(|c| c.k)))
    };
    let taken = result.as_ref().map_or((None, None), |r| (speed_off(r.slap_down.speed), k_off(r.k)));
    ReconstructionRung::ALL.into_iter().map(by_rung).chain([taken]).collect()
}

/// What each rung takes once the events are known, in the order of [`METHODS`]: the number alone for the first three, all rungs with
/// their intervals for the joint fit and the choice, which are one piece of work.
fn times(drop: &Prepared, request: &TrialRequest) -> Option<Vec<Timing>> {
    let (signals, file) = (&drop.signals, &drop.drawn.stated);
    let integrate = || motion::Integrated::over(black_box(signals), drop.contact_s);
    let integrated = integrate();
    let settled = settle::settle(file, &integrated)?;
    let flight = settled.flight?;
    let struck = settled.struck?;
    let events = Events {
        first_contact: Some(At { time_s: drop.contact_s, u_s: 1e-5 }),
        separation: Some(settled.left),
        slap_down: Some(struck),
        ..Events::default()
    };
    let setup: Setup = analysis::sticking(file);
    let cog_m = file.cask.cog_m;
    let window = motion::Window {
        from_s: flight.from_s,
        to_s: flight.to_s,
        drift: flight.drift,
        angular_velocity_rad_s: motion::rotation_rad_s(signals, &flight),
    };
    let mean = || motion::mean_of_flight(&integrate(), &flight, &window, cog_m);
    let moved = |flight: &_, events: &_, setup: &_| motion::outcome(&integrated, flight, events, setup);
    let move_by = |flight: Option<FlightFit>| moved(&flight?, &events, &setup);
    let measured = fit::Basis {
        signals,
        flight: &flight,
        events: &events,
        setup: &setup,
        rival_law: None,
        tolerances: file.tolerances,
        inertia_m2: Some(file.cask.inertia_kg_m2 / file.cask.mass_kg),
        rests: &[],
        fall_s: None,
        stood_in: None,
    };
    let mut work: Vec<Work> = vec![
        Box::new(|| {
            black_box(motion::read_channels(&integrate(), &events, &setup));
        }),
        Box::new(|| {
            black_box(move_by(mean()));
        }),
        Box::new(|| {
            black_box(move_by(motion::fit_flight(&integrate(), &window, None, cog_m)));
        }),
        Box::new(|| {
            let reading = motion::read_channels(&integrate(), &events, &setup);
            black_box(fit::ladder(&measured, mean().as_ref(), reading, &moved));
        }),
    ];
    let mut timings = in_turn(&mut work, Effort::of(request.quick));
    timings.extend(timings.last().copied());
    Some(timings)
}
