//! Recordings in files to points of how far off each way of working with them is, timed whole from file to
//! answer.

use super::drops::{CALM, DropClass, NOISY, ONE_MODE, SLOW_MODE, conditioned};
use super::points::{Answer, K, KnownDrop, READING, SPEED, Worked, scored};
use crate::analysis::flight_search::{self, Patience};
use crate::analysis::{analyze, sticking};
use crate::data::{CaskFile, Events, ReconstructionRung, Recording};
use crate::lab::damage;
use crate::lab::data::{SceneFile, TrialPoint, TrialRequest};
use crate::lab::report::{SyntheticFormat, synthetic_files};
use crate::motion::{self, Integrated};
use crate::{analysis, events, ingest};
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
const WORKINGS: [(&str, Working); 3] = [
    (TAKEN, |recording, file| Some(Answer::of(&analyze(recording, file).result))),
    ("planar alone", |recording, file| alone(ReconstructionRung::Planar, recording, file)),
    ("flight alone", |recording, file| alone(ReconstructionRung::Flight, recording, file)),
];

/// A simple rung of the reconstruction, without the others, the checks and the prediction.
fn alone(rung: ReconstructionRung, recording: &Recording, file: &CaskFile) -> Option<Answer> {
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
    let (setup, mut flight) = (sticking(file), found.flight?);
    if rung == ReconstructionRung::Planar {
        let window = motion::Window {
            from_s: flight.from_s,
            to_s: flight.to_s,
            drift: flight.drift,
            angular_velocity_rad_s: motion::rotation_rad_s(&signals, &flight),
        };
        flight = motion::mean_of_flight(&integrated, &flight, &window, setup.cog_m)?;
    }
    let moved = motion::outcome(&integrated, &flight, &events, &setup)?;
    let speed_m_s = moved.second_end_m_s.map(|(x, z)| x.hypot(z));
    Some(Answer::bare(speed_m_s, Some(moved.rebound_m_s / setup.impact_velocity_m_s)))
}

/// The points of all ways, by quantity and class; what is no answer is wholly off. Reading alone has a time
/// and no answer.
pub fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    let Ok(folder) = tempfile::tempdir() else { return Vec::new() };
    let drops: Vec<FiledDrop> =
        CLASSES.iter().flat_map(|class| filed(class, request, folder.path())).collect();
    let mut worked = vec![Worked::named(READING, false)];
    worked.extend(WORKINGS.iter().map(|(name, _)| Worked::named(name, *name == TAKEN)));
    for drop in &drops {
        // Each way has its turn on a file, after one that nobody times.
        black_box(read(drop));
        worked[0].timed(|| read(drop).map(|_| Answer::default()));
        for (worked, (_, way)) in worked[1..].iter_mut().zip(&WORKINGS) {
            worked.timed(|| read(drop).and_then(|(recording, file)| way(&recording, &file)));
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

/// The families of what is worked from file to answer.
pub const WAYS: [&str; 2] = [SPEED.family, K.family];
