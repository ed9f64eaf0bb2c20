//! The rungs of the reconstruction to how far off each leaves slap-down speed and k, and what it costs by itself.

use super::flight::{CALM, ONE_MODE, SLOW_MODE};
use super::sample::{self, DropClass, NOISY, Prepared};
use crate::analysis::{self, settle};
use crate::data::{At, Axis, End, Estimate, Events, FlightFit, ReconstructionRung, Setup};
use crate::lab::data::{TrialPart, TrialPeerWork, TrialPoint, TrialRequest};
use crate::lab::drawn::DrawnDrop;
use crate::lab::methods::contest::{MethodRecord, Purpose, by_class};
use crate::lab::methods::timing::{Effort, Timing, Work, in_turn};
use crate::lab::plan::DropPlan;
use crate::{fit, motion};
use rayon::prelude::*;
use std::hint::black_box;

const CLASSES: [DropClass; 5] = [
    CALM,
    NOISY,
    ONE_MODE,
    SLOW_MODE,
    DropClass { name: "12 ms pulse", make: |plan, _, _| plan.pulse_s = 0.012 },
];

/// Speed, which programs of others are held against too, and k.
const SPEED: Purpose = Purpose::of_calls("reconstruction, speed", "% of the slap-down speed");
const K: Purpose = Purpose { missing: 1.0, ..Purpose::of_calls("reconstruction, k", "1") };

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
    let of_class = |class: &DropClass| {
        let plans = sample::plans(class, if request.quick { 4 } else { 12 }, request);
        let of_drop = |drop: &Prepared| {
            let second = drop.signals.iter().find(|s| s.end == End::Second && s.axis == Axis::Transverse)?;
            Some(TrialPeerWork {
                family: SPEED.name,
                class: class.name.to_owned(),
                low_pass: None,
                drop: Some((second.sample_rate_hz, drop.drop.stated.drop.impact_velocity_m_s)),
                samples: second.force_m_s2.clone(),
                truth: vec![drop.drop.motion.truth.speed?],
                error_unit: SPEED.error_unit,
            })
        };
        sample::prepared(&plans).iter().filter_map(of_drop).collect::<Vec<_>>()
    };
    CLASSES.iter().flat_map(of_class).collect()
}

fn of_class(class: &DropClass, plans: &[DropPlan], request: &TrialRequest) -> Vec<TrialPoint> {
    let errors: Vec<[Errors; METHODS.len()]> = plans.par_iter().map(|plan| errors(&plan.draw())).collect();
    let timed = sample::prepared(plans.get(..1).unwrap_or_default());
    let Some(timings) = timed.first().and_then(|drop| times(drop, request)) else { return Vec::new() };
    let mut points = Vec::new();
    for (i, method) in METHODS.into_iter().enumerate() {
        let record = |error: fn(&Errors) -> Option<f64>| MethodRecord {
            method: method.to_owned(),
            is_default: method == TAKEN,
            errors: errors.iter().map(|of_drop| error(&of_drop[i])).collect(),
            timing: timings[i],
        };
        points.push(SPEED.point(class.name, record(|errors| errors.speed_percent)));
        points.push(K.point(class.name, record(|errors| errors.k)));
    }
    points
}

/// What a method misses on a drop; none where it gives no number.
struct Errors {
    speed_percent: Option<f64>,
    k: Option<f64>,
}

/// The errors of each of [`METHODS`].
fn errors(drop: &DrawnDrop) -> [Errors; METHODS.len()] {
    let truth = &drop.motion.truth;
    let result = drop.analyzed(&drop.recorded()).map(|analysis| analysis.result);
    let errors = |speed: Option<Estimate>, k: Option<Estimate>| Errors {
        speed_percent: speed.zip(truth.speed).map(|(e, truth)| 100.0 * (e.value / truth - 1.0).abs()),
        k: k.zip(truth.k).map(|(e, truth)| (e.value - truth).abs()),
    };
    let candidates = result.iter().filter_map(|r| r.reconstruction.as_ref()).flat_map(|c| &c.candidates);
    let by_rung = |rung: ReconstructionRung| {
        let candidate = candidates.clone().find(|candidate| candidate.rung == rung);
        errors(candidate.and_then(|c| c.speed), candidate.and_then(|c| c.k))
    };
    let [channels, planar, flight, joint] = ReconstructionRung::ALL.map(by_rung);
    let taken = result.as_ref().map_or(errors(None, None), |r| errors(r.slap_down.speed, r.k));
    [channels, planar, flight, joint, taken]
}

/// What each rung takes once the events are known, in the order of [`METHODS`]: the number alone for the first three, all rungs with
/// their intervals for the joint fit and the choice, which are one piece of work.
fn times(drop: &Prepared, request: &TrialRequest) -> Option<Vec<Timing>> {
    let (signals, file) = (&drop.signals, &drop.drop.stated);
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
