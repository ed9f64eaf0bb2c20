//! Recordings in files to points of how far off each way of working with them is, timed whole from file to
//! answer.

use super::drops::{CALM, DropClass, NOISY, ONE_MODE, SLOW_MODE, conditioned};
use super::points::{Answer, K, KnownDrop, READING, SPEED, Worked, scored};
use super::prediction;
use crate::analysis::flight_search::{self, Patience};
use crate::analysis::{analyze, sticking};
use crate::data::{
    AssumedFriction, At, Axis, CaskFile, End, Events, ReconstructionCandidate, ReconstructionRung, Recording,
};
use crate::lab::damage;
use crate::lab::data::{SceneFile, TrialPoint, TrialRequest};
use crate::lab::report::{SyntheticFormat, synthetic_files};
use crate::motion::{self, Integrated};
use crate::numerics::as_f64;
use crate::numerics::filter::ZeroPhaseLowPass;
use crate::numerics::quadrature::running_integral;
use crate::{analysis, events, fit, ingest};
use rayon::prelude::*;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Drops of one kind, and what is wrong with them: a row of the table of damages, and its size.
type WayClass = (DropClass, Option<(&'static str, f64)>);

const CLASSES: [WayClass; 7] = [
    (DropClass { name: "clean", ..CALM }, None),
    (NOISY, None),
    (ONE_MODE, None),
    (SLOW_MODE, None),
    (LIMITER, None),
    (DropClass { name: "clipped by 10 %", ..ONE_MODE }, Some(("clip_first", 10.0))),
    (DropClass { name: "length off by 1 %", ..ONE_MODE }, Some(("stated_length", 1.0))),
];
const LIMITER: DropClass = DropClass {
    name: "limiter, 12 to 25 ms",
    make: |plan, _, share| (plan.pulse_s, plan.yield_share) = (0.012 + 0.013 * share, Some(0.7)),
};

/// Samples a second, and the record before first contact, s: what loggers at test sites write.
const RATE_HZ: f64 = 1e5;
const BEFORE_S: f64 = 0.4;

/// A drop as its files hold it.
struct FiledDrop {
    known: KnownDrop,
    recording: PathBuf,
    cask: PathBuf,
}

/// From a recording to what a way says of it.
type Working = fn(&Recording, &CaskFile) -> Option<Answer>;

/// What the program says and takes.
const TAKEN: &str = "dropcheck, as taken";

/// Ways of working with a recording that is read.
const WORKINGS: [(&str, Working); 7] = [
    (TAKEN, |recording, file| Some(Answer::of(&analyze(recording, file).result))),
    ("filter first, CFC 60", |recording, file| filter_first(60.0, recording, file)),
    ("filter first, CFC 180", |recording, file| filter_first(180.0, recording, file)),
    ("single channels (paper)", |recording, file| alone(None, recording, file)),
    ("planar alone", |recording, file| alone(Some(ReconstructionRung::Planar), recording, file)),
    ("flight alone", |recording, file| alone(Some(ReconstructionRung::Flight), recording, file)),
    ("joint alone", |recording, file| alone(Some(ReconstructionRung::Joint), recording, file)),
];

/// As one reads it off filtered curves: both channels filtered, integrated, the speed at the foot of the
/// second's highest pulse, the rebound as the first's mean between its own and that foot.
fn filter_first(class: f64, recording: &Recording, file: &CaskFile) -> Option<Answer> {
    let v0_m_s = file.drop.impact_velocity_m_s;
    let filtered = |end: End| {
        let channel = recording.channels.iter().find(|c| c.end == end && c.axis == Axis::Transverse)?;
        let mut force = channel.force_m_s2(0, channel.samples.len());
        let still = force.len().min(2000);
        let offset_m_s2 = force[..still].iter().sum::<f64>() / as_f64(still);
        for f in &mut force {
            *f -= offset_m_s2;
        }
        let smooth = ZeroPhaseLowPass::with_cfc(class, channel.sample_rate_hz)?.apply(&force);
        let velocity = running_integral(&smooth, 1.0 / channel.sample_rate_hz);
        Some((smooth, velocity))
    };
    let ((first, rising), (second, falling)) = (filtered(End::First)?, filtered(End::Second)?);
    let top = |of: &[f64], from: usize| (from..of.len()).max_by(|&a, &b| of[a].total_cmp(&of[b]));
    let struck = top(&first, 0)?;
    let left = (struck..first.len()).find(|&i| first[i] < 0.05 * first[struck])?;
    let slap = top(&second, left)?;
    let foot = (left..slap).rev().find(|&i| second[i] < 0.05 * second[slap])?;
    let free = rising.get(left..foot).filter(|free| !free.is_empty());
    let mean = |free: &[f64]| free.iter().sum::<f64>() / as_f64(free.len());
    Some(Answer::bare(Some(v0_m_s - falling[foot]), free.map(|free| mean(free) / v0_m_s - 1.0)))
}

/// One rung of the reconstruction, without the others, the checks and the prediction; none is each channel by
/// itself, as \[P\] Fig. 13 has it: −v0 + ∫f dt, gravity left out, read off as L leaves and as R strikes.
fn alone(rung: Option<ReconstructionRung>, recording: &Recording, file: &CaskFile) -> Option<Answer> {
    let (signals, coarse) = conditioned(recording, file)?;
    let contact = events::first_contact(&signals, &coarse)?;
    let integrated = Integrated::over(&signals, contact.time_s);
    let found = flight_search::find(file, &integrated, Patience::EachBeginning)?;
    let events = Events {
        first_contact: Some(contact),
        separation: Some(found.separation),
        slap_down: found.slap_down,
        ..Events::default()
    };
    let (setup, flight) = (sticking(file), found.flight?);
    let plain = || {
        let window = motion::Window {
            from_s: flight.from_s,
            to_s: flight.to_s,
            drift: flight.drift,
            angular_velocity_rad_s: motion::rotation_rad_s(&signals, &flight),
        };
        motion::mean_of_flight(&integrated, &flight, &window, setup.cog_m)
    };
    let moved = |flight: &_, events: &_, setup: &_| motion::outcome(&integrated, flight, events, setup);
    let of_motion = |moved: crate::data::Motion| {
        let speed_m_s = moved.second_end_m_s.map(|(x, z)| x.hypot(z));
        Answer::bare(speed_m_s, Some(moved.rebound_m_s / setup.impact_velocity_m_s))
    };
    match rung {
        None => {
            let v0_m_s = setup.impact_velocity_m_s;
            let read_m_s = |end: End, at: At| {
                let own = signals.iter().position(|s| s.axis == Axis::Transverse && s.end == end)?;
                Some(integrated.gained_m_s(own, at.time_s) - v0_m_s)
            };
            let struck_m_s = events.slap_down.and_then(|at| read_m_s(End::Second, at));
            let left_m_s = read_m_s(End::First, found.separation)?;
            Some(Answer::bare(struck_m_s.map(f64::abs), Some(left_m_s / v0_m_s)))
        }
        Some(ReconstructionRung::Planar) => moved(&plain()?, &events, &setup).map(of_motion),
        Some(ReconstructionRung::Flight) => moved(&flight, &events, &setup).map(of_motion),
        Some(ReconstructionRung::Joint) => {
            let ratio = moved(&flight, &events, &setup)?.impulse_ratio;
            let u = file.tolerances.friction / 2.0 * ratio.abs();
            let basis = fit::FitData {
                signals: &signals,
                flight: &flight,
                events: &events,
                setup: &setup,
                friction: Some(AssumedFriction { ratio, u }),
                specs: &file.channels,
                tolerances: file.tolerances,
                inertia_m2: Some(file.cask.inertia_kg_m2 / file.cask.mass_kg),
                rests: &[],
                fall_s: None,
                rotations: &[],
                stood_in: None,
                second: None,
            };
            let said = fit::ladder(&basis, None, &moved)?.choice.candidates;
            let of_joint = |c: &ReconstructionCandidate| Answer { speed: c.speed, k: c.k };
            said.iter().find(|c| c.rung == ReconstructionRung::Joint).map(of_joint)
        }
    }
}

/// The points of all ways, by quantity and class; what is no answer is wholly off. Reading alone has a time
/// and no answer.
pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    let Ok(folder) = tempfile::tempdir() else { return Vec::new() };
    let drops: Vec<FiledDrop> =
        CLASSES.iter().flat_map(|class| filed(class, request, folder.path())).collect();
    let mut worked = vec![Worked::named(READING, false)];
    worked.extend(WORKINGS.iter().map(|(name, _)| Worked::named(name, *name == TAKEN)));
    for drop in &drops {
        // Each way has its turn on a file, after one that nobody times.
        black_box(read(drop));
        worked[0].timed(1, || read(drop).map(|_| Answer::default()));
        for (worked, (_, way)) in worked[1..].iter_mut().zip(&WORKINGS) {
            worked.timed(1, || read(drop).and_then(|(recording, file)| way(&recording, &file)));
        }
    }
    worked.extend(in_python(&drops, folder.path()));
    let known: Vec<KnownDrop> = drops.iter().map(|drop| drop.known).collect();
    [SPEED, K].iter().flat_map(|quantity| scored(quantity, &worked, &known)).collect()
}

fn read(drop: &FiledDrop) -> Option<(Recording, CaskFile)> {
    let file = ingest::cask_file(&drop.cask).ok()?;
    Some((analysis::read(&drop.recording, &file, &|_| ()).ok()?, file))
}

/// The drops of a class as files in a folder; those in which R does not strike are left out.
fn filed((class, struck): &WayClass, request: &TrialRequest, folder: &Path) -> Vec<FiledDrop> {
    let plans = class.plans(request.either(6, 30), request);
    let filed = |(number, plan): (usize, &crate::lab::drawn::DropPlan)| {
        let mut plan = plan.clone();
        (plan.rate_hz, plan.before_s) = (RATE_HZ, plan.before_s + BEFORE_S);
        let mut drop = plan.draw();
        let kind = struck.and_then(|(name, size)| Some((damage::named(name)?, size)));
        let recording = kind.map(|(kind, size)| kind.strike(&mut drop, size));
        let recording = recording.unwrap_or_else(|| drop.recorded());
        let truth = drop.motion.truth;
        let scene = SceneFile { scene: drop.scene, stated: drop.stated };
        let name = format!("{} {number}.csv", class.name.replace(['%', ','], ""));
        let files = synthetic_files(&scene, &recording, &name, SyntheticFormat::Csv).ok()?;
        let [recording, cask, _] = <[_; 3]>::try_from(files).ok()?.map(|(name, bytes)| {
            let path = folder.join(name);
            std::fs::write(&path, bytes).ok().map(|()| path)
        });
        truth.speed?;
        let known = KnownDrop { class: class.name, truth };
        Some(FiledDrop { known, recording: recording?, cask: cask? })
    };
    plans.par_iter().enumerate().filter_map(filed).collect()
}

/// The same work by a notebook of numpy and scipy that shares no code with the program, where there is a
/// Python (3.11 or later) that has them.
fn in_python(drops: &[FiledDrop], folder: &Path) -> Option<Worked> {
    let line = |drop: &FiledDrop| format!("{}\t{}", drop.recording.display(), drop.cask.display());
    let list = drops.iter().map(line).collect::<Vec<_>>().join("\n");
    let path = folder.join("drops.txt");
    std::fs::write(&path, list).ok()?;
    let answered =
        Command::new("python3").args(["-c", include_str!("notebook.py")]).arg(path).output().ok()?;
    let mut worked = Worked::named("notebook, least squares", false);
    for line in String::from_utf8(answered.stdout).ok()?.lines() {
        let numbers: Vec<f64> = line.split(' ').map_while(|number| number.parse().ok()).collect();
        let [seconds, speed_m_s, k] = numbers[..] else { return None };
        let number = |number: f64| number.is_finite().then_some(number);
        worked.answers.push(Answer::bare(number(speed_m_s), number(k)));
        worked.times_ns.push(1e9 * seconds);
    }
    (worked.answers.len() == drops.len()).then_some(worked)
}

/// The families of what is worked from file to answer, and of the prediction for itself.
pub const WAYS: [&str; 3] = [SPEED.family, K.family, prediction::FAMILY];
