//! Recordings in files to points of how far off each way of working with them is, timed whole from file to answer.

use super::contest::{measured, with_pooled};
use super::drops::{CALM, DropClass, NOISY, ONE_MODE, SLOW_MODE, conditioned};
use super::prediction;
use super::timing::quartiles;
use crate::analysis::{analyze, settle, sticking};
use crate::data::{
    AssumedFriction, Axis, CaskFile, DropResult, End, Estimate, Events, ReconstructionCandidate,
    ReconstructionRung, Recording,
};
use crate::lab::damage;
use crate::lab::data::{SceneFile, TrialPoint, TrialRequest, Truth};
use crate::lab::report::{SyntheticFormat, synthetic_files};
use crate::motion::{self, Integrated};
use crate::numerics::as_f64;
use crate::numerics::filter::ZeroPhaseLowPass;
use crate::numerics::quadrature::running_integral;
use crate::numerics::robust;
use crate::{events, fit, ingest};
use rayon::prelude::*;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

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

/// What a way says of a drop.
#[derive(Clone, Copy, Default)]
struct Answer {
    speed: Option<Estimate>,
    k: Option<Estimate>,
}

impl Answer {
    fn of(result: &DropResult) -> Self {
        Self { speed: result.slap_down.speed, k: result.k }
    }

    /// Numbers, in m/s and 1, without an interval.
    fn bare(speed_m_s: Option<f64>, k: Option<f64>) -> Self {
        let bare = |value| Estimate::new(value, f64::NAN, "");
        Self { speed: speed_m_s.map(bare), k: k.map(bare) }
    }
}

/// A drop as its files hold it.
struct FiledDrop {
    class: &'static str,
    truth: Truth,
    recording: PathBuf,
    cask: PathBuf,
}

type Working = Box<dyn Fn(&Recording, &CaskFile) -> Option<Answer>>;

/// What the program says and takes.
const TAKEN: &str = "dropcheck, as taken";

/// Ways of working with a recording that is read.
fn ways() -> Vec<(&'static str, Working)> {
    let mut ways: Vec<(&'static str, Working)> = vec![
        (TAKEN, Box::new(|recording, file| Some(Answer::of(&analyze(recording, file).result)))),
        ("filter first, CFC 60", Box::new(|recording, file| filter_first(60.0, recording, file))),
        ("filter first, CFC 180", Box::new(|recording, file| filter_first(180.0, recording, file))),
    ];
    for (name, rung) in ["single channels (paper)", "planar alone", "flight alone", "joint alone"]
        .into_iter()
        .zip(ReconstructionRung::ALL)
    {
        ways.push((name, Box::new(move |recording, file| alone(rung, recording, file))));
    }
    ways
}

/// As one reads it off filtered curves: both channels filtered, integrated, the speed at the foot of the second's highest pulse, the rebound
/// as the first's mean between its own and that foot.
fn filter_first(class: f64, recording: &Recording, file: &CaskFile) -> Option<Answer> {
    let v0_m_s = file.drop.impact_velocity_m_s;
    let of = |end: End| {
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
    let ((first, rising), (second, falling)) = (of(End::First)?, of(End::Second)?);
    let top = |of: &[f64], from: usize| (from..of.len()).max_by(|&a, &b| of[a].total_cmp(&of[b]));
    let struck = top(&first, 0)?;
    let left = (struck..first.len()).find(|&i| first[i] < 0.05 * first[struck])?;
    let slap = top(&second, left)?;
    let foot = (left..slap).rev().find(|&i| second[i] < 0.05 * second[slap])?;
    let free = rising.get(left..foot).filter(|free| !free.is_empty());
    let mean = |free: &[f64]| free.iter().sum::<f64>() / as_f64(free.len());
    Some(Answer::bare(Some(v0_m_s - falling[foot]), free.map(|free| mean(free) / v0_m_s - 1.0)))
}

/// One rung of the reconstruction, without the others, the checks and the prediction.
fn alone(rung: ReconstructionRung, recording: &Recording, file: &CaskFile) -> Option<Answer> {
    let (signals, coarse) = conditioned(recording, file)?;
    let contact = events::first_contact(&signals, &coarse)?;
    let integrated = Integrated::over(&signals, contact.time_s);
    let settled = settle::settle(file, &integrated)?;
    let events = Events {
        first_contact: Some(contact),
        separation: Some(settled.left),
        slap_down: settled.struck,
        ..Events::default()
    };
    let (setup, flight) = (sticking(file), settled.flight?);
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
        ReconstructionRung::Channels => motion::read_channels(&integrated, &events, &setup).map(|read| {
            Answer::bare(read.second_m_s.map(f64::abs), Some(read.first_m_s / setup.impact_velocity_m_s))
        }),
        ReconstructionRung::Planar => moved(&plain()?, &events, &setup).map(of_motion),
        ReconstructionRung::Flight => moved(&flight, &events, &setup).map(of_motion),
        ReconstructionRung::Joint => {
            let ratio = moved(&flight, &events, &setup)?.impulse_ratio;
            let u = file.tolerances.friction / 2.0 * ratio.abs();
            let basis = fit::Basis {
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
                stood_in: None,
            };
            let said = fit::ladder(&basis, None, None, &moved)?.choice.candidates;
            let of_joint = |c: &ReconstructionCandidate| Answer { speed: c.speed, k: c.k };
            said.iter().find(|c| c.rung == ReconstructionRung::Joint).map(of_joint)
        }
    }
}

/// What a way says of every drop, and how long it takes for each, ns.
struct Worked {
    name: String,
    is_default: bool,
    answers: Vec<Answer>,
    times_ns: Vec<f64>,
}

/// The points of all ways, by quantity and class; what is no answer is wholly off. Reading alone has a time and no answer.
pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    let Ok(folder) = tempfile::tempdir() else { return Vec::new() };
    let drops: Vec<FiledDrop> =
        CLASSES.iter().flat_map(|class| filed(class, request, folder.path())).collect();
    let mut worked = vec![Worked::named(READING, false)];
    let ways = ways();
    worked.extend(ways.iter().map(|(name, _)| Worked::named(name, *name == TAKEN)));
    for drop in &drops {
        // Each way has its turn on a file, after one that nobody times.
        black_box(read(drop));
        worked[0].timed(|| read(drop).map(|_| Answer::default()));
        for (worked, (_, way)) in worked[1..].iter_mut().zip(&ways) {
            worked.timed(|| read(drop).and_then(|(recording, file)| way(&recording, &file)));
        }
    }
    worked.extend(in_python(&drops, folder.path()));
    [SPEED, K].iter().flat_map(|quantity| scored(quantity, &worked, &drops)).collect()
}

/// What a reading alone is called.
pub const READING: &str = "reading alone";

impl Worked {
    fn named(name: &str, is_default: bool) -> Self {
        Self { name: name.to_owned(), is_default, answers: Vec::new(), times_ns: Vec::new() }
    }

    /// One answer more; no answer is an empty one.
    fn timed(&mut self, work: impl FnOnce() -> Option<Answer>) {
        let begun = Instant::now();
        let answer = black_box(work()).unwrap_or_default();
        self.times_ns.push(1e9 * begun.elapsed().as_secs_f64());
        self.answers.push(answer);
    }
}

fn read(drop: &FiledDrop) -> Option<(Recording, CaskFile)> {
    let file = ingest::cask_file(&drop.cask).ok()?;
    Some((ingest::read(&drop.recording, &file, &|_| ()).ok()?, file))
}

/// The drops of a class as files in a folder; those in which R does not strike are left out.
fn filed((class, struck): &WayClass, request: &TrialRequest, folder: &Path) -> Vec<FiledDrop> {
    let plans = class.plans(request.either(6, 30), request);
    let filed = |(number, plan): (usize, &crate::lab::plan::DropPlan)| {
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
        Some(FiledDrop { class: class.name, truth, recording: recording?, cask: cask? })
    };
    plans.par_iter().enumerate().filter_map(filed).collect()
}

/// The same work by numpy and scipy, where there is a Python that has them.
fn in_python(drops: &[FiledDrop], folder: &Path) -> Option<Worked> {
    let line = |drop: &FiledDrop| format!("{}\t{}", drop.recording.display(), drop.truth.v0);
    let list = drops.iter().map(line).collect::<Vec<_>>().join("\n");
    let path = folder.join("drops.txt");
    std::fs::write(&path, list).ok()?;
    let answered =
        Command::new("python3").args(["-c", include_str!("notebook.py")]).arg(path).output().ok()?;
    let mut worked = Worked::named("scipy, as in a notebook", false);
    for line in String::from_utf8(answered.stdout).ok()?.lines() {
        let numbers: Vec<f64> = line.split(' ').map_while(|number| number.parse().ok()).collect();
        let [seconds, speed_m_s, k] = numbers[..] else { return None };
        let number = |number: f64| number.is_finite().then_some(number);
        worked.answers.push(Answer::bare(number(speed_m_s), number(k)));
        worked.times_ns.push(1e9 * seconds);
    }
    (worked.answers.len() == drops.len()).then_some(worked)
}

/// What is held against the truth.
struct WayQuantity {
    family: &'static str,
    unit: &'static str,
    /// What a verdict needs.
    matters: f64,
    stated: fn(&Answer) -> Option<Estimate>,
    truth: fn(&Truth) -> Option<f64>,
    /// What the truth is divided by, of itself.
    scale: fn(f64) -> f64,
}

/// The families of what is worked from file to answer, and of the prediction for itself.
pub const WAYS: [&str; 3] = [SPEED.family, K.family, prediction::FAMILY];

const SPEED: WayQuantity = WayQuantity {
    family: "speed, from file to answer",
    unit: "% of the slap-down speed",
    matters: 1.0,
    stated: |answer| answer.speed,
    truth: |truth| truth.speed,
    scale: |speed_m_s| 100.0 / speed_m_s,
};

const K: WayQuantity = WayQuantity {
    family: "k, from file to answer",
    unit: "1",
    matters: 0.01,
    stated: |answer| answer.k,
    truth: |truth| truth.k,
    scale: |_| 1.0,
};

/// A point a way and class, and one of all classes; a way that never says anything of the quantity is none for it.
fn scored(of: &WayQuantity, worked: &[Worked], drops: &[FiledDrop]) -> Vec<TrialPoint> {
    let off = |stated: Option<Estimate>, truth: &Truth| {
        let (stated, truth) = stated.zip((of.truth)(truth))?;
        let scale = (of.scale)(truth);
        Some((scale * (stated.value - truth).abs(), scale * stated.u95))
    };
    let of_class = |class: &'static str| {
        worked.iter().filter_map(move |way| {
            let of_class = || (0..drops.len()).filter(|&i| drops[i].class == class);
            let said: Vec<_> =
                of_class().map(|i| off((of.stated)(&way.answers[i]), &drops[i].truth)).collect();
            let (errors, mut half_widths): (Vec<f64>, Vec<f64>) = said.iter().flatten().copied().unzip();
            let held =
                errors.iter().zip(&half_widths).filter(|(error, half_width)| error <= half_width).count();
            let is_any = !errors.is_empty();
            let promised = is_any.then(|| robust::median(&mut half_widths)).filter(|u| u.is_finite());
            let words = TrialPoint {
                family: of.family.to_owned(),
                method: way.name.clone(),
                class: class.to_owned(),
                is_default: way.is_default,
                error_unit: of.unit.to_owned(),
                time_per: "file".to_owned(),
                matters: of.matters,
                missing: u32::try_from(said.len() - errors.len()).unwrap_or(0),
                promised,
                held: promised.map(|_| as_f64(held) / as_f64(errors.len())),
                ..TrialPoint::default()
            };
            let times_ns = quartiles(of_class().map(|i| way.times_ns[i]).collect());
            (is_any || way.name == READING).then(|| measured(words, errors, times_ns))
        })
    };
    with_pooled(CLASSES.iter().map(|(class, _)| class.name).flat_map(of_class).collect())
}
