//! Accuracy and time of each method on recordings in files, timed from file to answer.

use crate::analysis::{self, analyze};
use crate::data::{CaskFile, Estimate, Recording, STANDARD_GRAVITY_M_S2};
use crate::ingest;
use crate::lab::chance::Chance;
use crate::lab::damage;
use crate::lab::data::{SceneFile, TrialPoint, TrialRequest};
use crate::lab::drawn::{BUILDS, DropPlan};
use crate::lab::report::{SyntheticFormat, synthetic_files};
use crate::numerics::{as_f64, robust};
use rayon::prelude::*;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// Drops that have one difficulty in common.
#[derive(Clone, Copy)]
struct DropClass {
    name: &'static str,
    /// Changes a sound drop to one of the class; receives its flight, s, and a number between 0 and 1.
    make: fn(&mut DropPlan, f64, f64),
}

/// A drop without ringing.
const CALM: DropClass = DropClass { name: "calm", make: |_, _, _| {} };
const NOISY: DropClass = DropClass {
    name: "5 g of noise",
    make: |plan, _, _| plan.chain.white_noise_m_s2 = 5.0 * STANDARD_GRAVITY_M_S2,
};
const ONE_MODE: DropClass = DropClass {
    name: "one mode, 2 to 5 periods",
    make: |plan, flight_s, share| plan.modes = vec![DropPlan::mode(1, (2.0 + 3.0 * share) / flight_s)],
};
/// A mode slower than any cask bends: the program must refuse it (`swings`).
const SWINGING: DropClass = DropClass {
    name: "moves as a whole, 0.7 to 1.2 periods",
    make: |plan, flight_s, share| plan.modes = vec![DropPlan::mode(1, (0.7 + 0.5 * share) / flight_s)],
};

impl DropClass {
    /// The drops of the class; the same class and seed give the same.
    fn plans(&self, count: u64, request: &TrialRequest) -> Vec<DropPlan> {
        let plan = |number: u64| {
            let mut chance = Chance::new(request.seed, number);
            let build = BUILDS[usize::try_from(number).unwrap_or(0) % BUILDS.len()];
            let (angle_deg, k) = (chance.uniform(8.0, 22.0), chance.uniform(0.2, 0.7));
            let mut plan = DropPlan::new(build, angle_deg, k, request.seed + number);
            plan.ends[0].duration_s = chance.uniform(3e-3, 8e-3);
            // The first sample should not always fall on the same point of its interval.
            plan.before_s += chance.uniform(0.0, 1e-3);
            let sound_s = plan.flight_s();
            (self.make)(&mut plan, sound_s, chance.uniform(0.0, 1.0));
            plan
        };
        (0..count).into_par_iter().map(plan).collect()
    }
}

/// Drops of one kind, and their damage: a row of the table of damages, and its size.
type DamagedClass = (DropClass, Option<(&'static str, f64)>);

const CLASSES: [DamagedClass; 7] = [
    (DropClass { name: "clean", ..CALM }, None),
    (NOISY, None),
    (ONE_MODE, None),
    (SWINGING, None),
    (LIMITER, None),
    (DropClass { name: "clipped by 10 %", ..ONE_MODE }, Some(("clip_first", 10.0))),
    (DropClass { name: "length off by 1 %", ..ONE_MODE }, Some(("stated_length", 1.0))),
];
const LIMITER: DropClass = DropClass {
    name: "limiter, 12 to 25 ms",
    make: |plan, _, share| {
        for (end, share) in plan.ends.iter_mut().zip([share, 1.0 - share]) {
            (end.duration_s, end.yield_share) = (0.012 + 0.013 * share, Some(0.7));
        }
    },
};

/// Sample rate, Hz, and the record before first contact, s: typical loggers at test sites.
const RATE_HZ: f64 = 1e5;
const BEFORE_S: f64 = 0.4;

/// A drop as its files hold it.
struct FiledDrop {
    class: &'static str,
    /// Speed and k.
    truth: [Option<f64>; 2],
    recording: PathBuf,
    cask: PathBuf,
}

/// Speed, m/s, and k of a drop, as a method states them.
type Answer = [Option<Estimate>; 2];

/// Families of analyses from file to answer.
pub const WAYS: [&str; 2] = ["speed, from file to answer", "k, from file to answer"];

/// Reference of each relative error, or its unit, and the accuracy that a verdict needs.
const NEEDED: [(&str, f64); 2] = [("% of the slap-down speed", 1.0), ("1", 0.01)];

/// Name of the program's own answer.
const TAKEN: &str = "dropcheck, as taken";

/// The points of the program and of the notebook, by quantity and class; a missing answer counts as entirely
/// wrong. Reading alone has a time and no answer.
pub fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    let Ok(folder) = tempfile::tempdir() else { return Vec::new() };
    let drops: Vec<FiledDrop> =
        CLASSES.iter().flat_map(|class| write_drops(class, request, folder.path())).collect();
    let mut worked = vec![TimedAnswers::new(READING), TimedAnswers::new(TAKEN)];
    for drop in &drops {
        // Each method in turn reads a file that an untimed reading has warmed up.
        black_box(read(drop));
        worked[0].time_work(|| read(drop).map(|_| Answer::default()));
        worked[1].time_work(|| {
            let (recording, file) = read(drop)?;
            let result = analyze(&recording, &file).result;
            Some([result.slap_down.speed, result.k])
        });
    }
    worked.extend(in_python(&drops, folder.path()));
    (0..WAYS.len()).flat_map(|quantity| score(quantity, &worked, &drops)).collect()
}

fn read(drop: &FiledDrop) -> Option<(Recording, CaskFile)> {
    let file = ingest::cask_file(&drop.cask).ok()?;
    Some((analysis::read(&drop.recording, &file, &|_| ()).ok()?, file))
}

/// Writes the drops of a class as files in a folder; drops in which R does not strike are omitted.
fn write_drops((class, struck): &DamagedClass, request: &TrialRequest, folder: &Path) -> Vec<FiledDrop> {
    let plans = class.plans(request.choose(6, 30), request);
    let filed = |(number, plan): (usize, &DropPlan)| {
        let mut plan = plan.clone();
        (plan.rate_hz, plan.before_s) = (RATE_HZ, plan.before_s + BEFORE_S);
        let mut drop = plan.draw();
        let kind = struck.and_then(|(name, size)| Some((damage::find_kind(name)?, size)));
        let recording = kind.map(|(kind, size)| kind.apply(&mut drop, size));
        let recording = recording.unwrap_or_else(|| drop.record());
        let truth = drop.motion.truth;
        let scene = SceneFile { scene: drop.scene, stated: drop.stated };
        let name = format!("{} {number}.csv", class.name.replace(['%', ','], ""));
        let files = synthetic_files(&scene, &recording, &name, SyntheticFormat::Csv).ok()?;
        let [recording, cask, _] = <[_; 3]>::try_from(files).ok()?.map(|(name, bytes)| {
            let path = folder.join(name);
            std::fs::write(&path, bytes).ok().map(|()| path)
        });
        truth.speed?;
        let truth = [truth.speed, truth.k];
        Some(FiledDrop { class: class.name, truth, recording: recording?, cask: cask? })
    };
    plans.par_iter().enumerate().filter_map(filed).collect()
}

/// Analysis of the same files by a notebook of numpy and scipy that shares no code with the program, if a
/// Python (3.11 or later) has them.
fn in_python(drops: &[FiledDrop], folder: &Path) -> Option<TimedAnswers> {
    let line = |drop: &FiledDrop| format!("{}\t{}", drop.recording.display(), drop.cask.display());
    let list = drops.iter().map(line).collect::<Vec<_>>().join("\n");
    let path = folder.join("drops.txt");
    std::fs::write(&path, list).ok()?;
    let answered =
        Command::new("python3").args(["-c", include_str!("notebook.py")]).arg(path).output().ok()?;
    let mut worked = TimedAnswers::new("notebook, least squares");
    for line in String::from_utf8(answered.stdout).ok()?.lines() {
        let numbers: Vec<f64> = line.split(' ').map_while(|number| number.parse().ok()).collect();
        let [seconds, speed_m_s, k] = numbers[..] else { return None };
        // The notebook states no interval.
        let number = |value: f64| value.is_finite().then(|| Estimate::new(value, f64::NAN, ""));
        worked.answers.push([speed_m_s, k].map(number));
        worked.times_ns.push(1e9 * seconds);
    }
    (worked.answers.len() == drops.len()).then_some(worked)
}

/// Name of all classes together.
pub const ALL_CLASSES: &str = "all";

/// Name of reading alone.
pub const READING: &str = "reading alone";

/// Answers of one method for every drop, and the time of each, ns.
struct TimedAnswers {
    name: &'static str,
    answers: Vec<Answer>,
    times_ns: Vec<f64>,
}

impl TimedAnswers {
    fn new(name: &'static str) -> Self {
        Self { name, answers: Vec::new(), times_ns: Vec::new() }
    }

    /// Runs and times one more answer; no answer gives an empty one.
    fn time_work(&mut self, work: impl FnOnce() -> Option<Answer>) {
        let begun = Instant::now();
        let answer = black_box(work()).unwrap_or_default();
        self.times_ns.push(1e9 * begun.elapsed().as_secs_f64());
        self.answers.push(answer);
    }
}

/// Scores one point per method and class, and one for all classes; a method without any answer for the
/// quantity has none. The drops of a class must be adjacent.
fn score(quantity: usize, worked: &[TimedAnswers], drops: &[FiledDrop]) -> Vec<TrialPoint> {
    let mut classes: Vec<&'static str> = drops.iter().map(|drop| drop.class).collect();
    classes.dedup();
    classes.extend(drops.first().map(|_| ALL_CLASSES));
    let on_class = |class| worked.iter().map(move |way| point(quantity, way, drops, class));
    let points = classes.into_iter().flat_map(on_class);
    points.filter(|point| point.cases > 0 || point.method == READING).collect()
}

/// Scores the answers of a method for the drops of a class, and its time.
fn point(quantity: usize, way: &TimedAnswers, drops: &[FiledDrop], class: &str) -> TrialPoint {
    let is_own = |i: &usize| class == ALL_CLASSES || drops[*i].class == class;
    let own: Vec<usize> = (0..drops.len()).filter(is_own).collect();
    let off = |i: &usize| {
        let (stated, truth) = way.answers[*i][quantity].zip(drops[*i].truth[quantity])?;
        let scale = if quantity == 0 { 100.0 / truth } else { 1.0 };
        Some((scale * (stated.value - truth).abs(), scale * stated.u95))
    };
    let answers: Vec<(f64, f64)> = own.iter().filter_map(off).collect();
    let held = answers.iter().filter(|(error, half_width)| error <= half_width).count();
    let (errors, mut half_widths): (Vec<f64>, Vec<f64>) = answers.into_iter().unzip();
    let cases = errors.len();
    let promised = (cases > 0).then(|| robust::median(&mut half_widths)).filter(|u| u.is_finite());
    let [median_error, p95_error] = median_and_p95(errors);
    let mut taken_ns: Vec<f64> = own.iter().map(|i| way.times_ns[*i]).collect();
    taken_ns.sort_by(f64::total_cmp);
    let (unit, matters) = NEEDED[quantity];
    TrialPoint {
        family: WAYS[quantity].to_owned(),
        method: way.name.to_owned(),
        class: class.to_owned(),
        is_default: way.name == TAKEN,
        median_error,
        p95_error,
        error_unit: unit.to_owned(),
        time_ns: taken_ns[(taken_ns.len() - 1) / 2],
        cases,
        missing: own.len() - cases,
        matters,
        promised,
        held: promised.map(|_| as_f64(held) / as_f64(cases)),
    }
}

/// Median and 95th percentile, each the value of a drop; NaN if there is none.
fn median_and_p95(mut errors: Vec<f64>) -> [f64; 2] {
    errors.sort_by(f64::total_cmp);
    let Some(last) = errors.len().checked_sub(1) else { return [f64::NAN; 2] };
    [errors[last / 2], errors[(95 * last).div_ceil(100)]]
}

#[cfg(test)]
mod tests;
