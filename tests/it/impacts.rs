//! From simulated drops with and without limiters to how often the intervals of both impacts' numbers hold
//! the truth.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of steps and of drops"
)]

use crate::moved;
use crate::run::{fixture, root};
use dropcheck::data::{BENDING_WAVE_M_S, ChannelPeak, Estimate, ImpactTable};
use dropcheck::lab::data::{MotionStep, Scene, SceneNumber, SimulatedMotion};
use dropcheck::lab::{campaign, in_memory, synth};
use dropcheck::{ingest, stages};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Simulated drops; shares of 200 are known to 1.5 % where they are 95 %.
const DROPS: u32 = 200;
/// A contact longer than this is that of a limiter, s.
const LIMITER_S: f64 = 0.012;
/// The truth's grid, s: a hundredth of the shortest pulse.
const GRID_S: f64 = 2e-5;

/// Horizontal and vertical velocity of the lower corner of an end, and its height, by the simulation's own
/// state.
fn corner(scene: &Scene, step: &MotionStep, end: usize) -> [f64; 3] {
    let [_, z, inclination, x_rate, z_rate, turning, ..] = step.state;
    let cask = &scene.cask;
    let ahead = if end == 0 { -cask.cog_m } else { cask.length_m - cask.cog_m };
    let (sin, cos) = inclination.sin_cos();
    let arm = [ahead * cos + cask.height_m / 2.0 * sin, ahead * sin - cask.height_m / 2.0 * cos];
    [x_rate - turning * arm[1], z_rate + turning * arm[0], z + arm[1]]
}

/// What a perfect measurement would tabulate of the impact of an end; `None` where it does not leave within
/// the simulation.
fn truth(
    scene: &Scene,
    motion: &SimulatedMotion,
    end: usize,
    cutoff_hz: f64,
) -> Option<BTreeMap<&'static str, f64>> {
    let touch_s = if end == 0 { 0.0 } else { motion.truth.slap_t? };
    let from = motion.count_before(|t| t <= touch_s) - 1;
    let steps = &motion.steps[from..];
    let began = steps.iter().position(|s| s.loads_n[end].1 > 0.0)?;
    let last = began + steps[began..].iter().position(|s| s.loads_n[end].1 <= 0.0)?;
    let steps = &steps[began.saturating_sub(1)..=last];
    let (first, last) = (steps.first()?, steps.last()?);
    let cask = &scene.cask;
    let kinetic = |s: &MotionStep| {
        0.5 * cask.mass_kg * (s.state[3].powi(2) + s.state[4].powi(2))
            + 0.5 * cask.inertia_kg_m2 * s.state[5].powi(2)
    };
    let before_first = kinetic(&motion.steps[0]);
    let impulse = |part: &dyn Fn(&MotionStep) -> f64| -> f64 {
        steps.windows(2).map(|p| (p[1].time_s - p[0].time_s) * (part(&p[0]) + part(&p[1])) / 2.0).sum()
    };
    let (along, up) = (impulse(&|s| s.loads_n[end].0), impulse(&|s| s.loads_n[end].1));
    let [_, struck, _] = corner(scene, first, end);
    let [_, left, _] = corner(scene, last, end);
    let touched = corner(scene, first, end)[2];
    let crush = steps.iter().map(|s| touched - corner(scene, s, end)[2]).fold(0.0, f64::max);
    // Forces on an even grid with nothing around them, through the same low-pass.
    let duration = last.time_s - first.time_s;
    let clear = 2.0 / cutoff_hz;
    let count = ((duration + 2.0 * clear) / GRID_S) as usize;
    let filtered_peak = |part: &dyn Fn(&MotionStep) -> f64| {
        let at = |i: usize| {
            let time_s = first.time_s - clear + i as f64 * GRID_S;
            let next = steps.partition_point(|s| s.time_s <= time_s);
            match (next.checked_sub(1).and_then(|i| steps.get(i)), steps.get(next)) {
                (Some(a), Some(b)) => {
                    let share = (time_s - a.time_s) / (b.time_s - a.time_s);
                    part(a) + share * (part(b) - part(a))
                }
                _ => 0.0,
            }
        };
        let samples: Vec<f64> = (0..count).map(at).collect();
        let filter = stages::LowPass::with_cutoff_hz(cutoff_hz, 1.0 / GRID_S).expect("below half the rate");
        filter.apply(&samples).into_iter().fold(f64::MIN, f64::max)
    };
    let arm = if end == 0 { cask.cog_m } else { cask.length_m - cask.cog_m };
    let across = |s: &MotionStep, reach: f64| {
        let (sin, cos) = s.state[2].sin_cos();
        let (x, z) = s.loads_n[end];
        let away = if end == 0 { -1.0 } else { 1.0 };
        (z * cos - x * sin) / cask.mass_kg + away * reach * s.rates[5]
    };
    let (before, after) = (kinetic(first), kinetic(last));
    let sunk = cask.mass_kg * scene.drop.gravity_m_s2 * (first.state[1] - last.state[1]);
    Some(BTreeMap::from([
        ("duration", duration),
        ("velocity_change", left - struck),
        ("impulse_x", along),
        ("impulse_z", up),
        ("restitution", -left / struck),
        ("friction", along / up),
        ("energy_before", before),
        ("energy_absorbed", before - after + sunk),
        ("energy_after", after),
        ("energy_ratio", before / before_first),
        ("absorbed_ratio", (before - after + sunk) / before_first),
        ("crush", crush),
        ("force_peak", filtered_peak(&|s| s.loads_n[end].1)),
        ("at_cog", filtered_peak(&|s| across(s, 0.0))),
        ("at_struck_end", filtered_peak(&|s| across(s, arm))),
    ]))
}

/// The numbers of an impact by name.
fn stated(table: &ImpactTable) -> BTreeMap<&'static str, Option<Estimate>> {
    let deceleration = &table.rigid_body_deceleration;
    BTreeMap::from([
        ("duration", table.numbers.duration),
        ("velocity_change", table.numbers.velocity_change),
        ("impulse_x", table.numbers.impulse_x),
        ("impulse_z", table.numbers.impulse_z),
        ("restitution", table.numbers.restitution),
        ("friction", table.numbers.friction),
        ("energy_before", table.numbers.energy_before),
        ("energy_absorbed", table.numbers.energy_absorbed),
        ("energy_after", table.numbers.energy_after),
        ("energy_ratio", table.numbers.energy_ratio),
        ("absorbed_ratio", table.numbers.absorbed_ratio),
        ("crush", table.numbers.crush),
        ("force_peak", table.numbers.force_peak),
        ("at_cog", deceleration.at_cog),
        ("at_struck_end", deceleration.at_struck_end),
    ])
}

/// Of each channel what is stated of its pulse in the impact of `end`, and what a perfect sensor would read,
/// by name.
fn channel_pulses(
    scene: &Scene,
    motion: &SimulatedMotion,
    end: usize,
    tables: &[ImpactTable; 2],
) -> Vec<(&'static str, Option<Estimate>, f64)> {
    // The stretch that the program states, by the simulation's clock: which pulse of a ringing cask is whose
    // is a matter of words.
    let seconds = |estimate: Option<Estimate>| estimate.map(|e| e.value / (1.0 + scene.clock_error));
    let [start, next] = [end, end + 1].map(|i| seconds(tables.get(i)?.start).map(|s| s - scene.before_s));
    let Some(touch_s) = start else { return Vec::new() };
    let left_s = seconds(tables[end].numbers.duration)
        .map_or(touch_s + 0.025, |s| touch_s + s + scene.cask.length_m / BENDING_WAVE_M_S);
    let ends_s = motion.truth.slap_t.map_or(f64::INFINITY, |s| s + scene.after_s);
    let until_s = left_s.min(next.unwrap_or(f64::INFINITY)).min(ends_s);
    // Two peaks of opposite signs may be equally large.
    let size = |estimate: Option<Estimate>| estimate.map(|e| Estimate { value: e.value.abs(), ..e });
    let pulse = |peak: &ChannelPeak| {
        let channel = scene.channels.iter().find(|c| c.name == peak.name).expect("a channel of that name");
        let beyond_s = 7.0 / peak.cutoff_hz;
        let from_s = touch_s - beyond_s;
        let grid_s = GRID_S / 4.0;
        let count = ((until_s + 2.0 * beyond_s - touch_s) / grid_s) as usize;
        let times_s: Vec<f64> = (0..count).map(|i| from_s + i as f64 * grid_s).collect();
        let raw = synth::specific_force_m_s2(scene, motion, channel, &times_s);
        let filter = stages::LowPass::with_cutoff_hz(peak.cutoff_hz, 1.0 / grid_s);
        let filtered = filter.expect("below half the rate").apply(&raw);
        let largest = |values: &[f64]| {
            let within = (0..count).filter(|&i| (touch_s..until_s).contains(&times_s[i]));
            within.max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs())).expect("a sample")
        };
        let at = largest(&filtered);
        let is_low = |f: &f64| f * filtered[at].signum() < 0.1 * filtered[at].abs();
        let began = filtered[..at].iter().rposition(is_low);
        let ended = filtered[at..].iter().position(is_low);
        let length_s = began.zip(ended).map_or(f64::NAN, |(b, e)| (at + e - b - 1) as f64 * grid_s);
        [
            ("peak_raw", size(peak.peak_raw), raw[largest(&raw)].abs()),
            ("peak_filtered", size(peak.peak_filtered), filtered[at].abs()),
            ("pulse_length", peak.pulse_length, length_s),
        ]
    };
    tables[end].channels.iter().flat_map(pulse).collect()
}

/// Distances from the truth in half-widths, and half-widths as shares of the truth, by end, limiter and name.
type Distances = BTreeMap<(usize, bool, &'static str), Vec<[f64; 2]>>;

fn distances(seed: u64, drops: u32) -> Distances {
    let of_drop = |number: u32| {
        let (file, recording) = campaign::scene(seed, SceneNumber::Undamaged(number), false);
        let motion = synth::simulate(&file.scene);
        let mut found = Vec::new();
        let Ok(read) = in_memory::synthetic(&recording, &file.stated) else { return found };
        let result = stages::measure(&read, &file.stated).result;
        for (end, table) in result.impacts.iter().enumerate() {
            let is_limited = motion.truth.contact_s > Some(LIMITER_S);
            let Some(truth) =
                truth(&file.scene, &motion, end, table.rigid_body_deceleration.cutoff_hz.max(1.0))
            else {
                found.push(((end, is_limited, "untrue"), [0.0, 0.0]));
                continue;
            };
            if table.numbers.crush.is_none() {
                found.push(((end, is_limited, "untold"), [0.0, 0.0]));
            }
            let of_impact = stated(table).into_iter().map(|(name, estimate)| (name, estimate, truth[name]));
            for (name, estimate, truth) in
                of_impact.chain(channel_pulses(&file.scene, &motion, end, &result.impacts))
            {
                let Some(estimate) = estimate else { continue };
                let off = (estimate.value - truth) / estimate.u95.max(1e-12);
                found.push(((end, is_limited, name), [off, estimate.u95 / truth.abs()]));
            }
        }
        found
    };
    let mut all = Distances::new();
    for (key, value) in (0..drops).into_par_iter().flat_map_iter(of_drop).collect::<Vec<_>>() {
        all.entry(key).or_default().push(value);
    }
    all
}

/// What of 200 drops may lie outside by chance: of 95 % shares three standard deviations of what is there.
fn least_held(count: usize) -> f64 {
    let n = count as f64;
    0.95 * n - 3.0 * (0.05 * 0.95 * n).sqrt()
}

#[test]
#[ignore = "a campaign of drops: .ci/long"]
fn the_intervals_of_both_impacts_hold_the_truth() {
    let mut wrong = Vec::new();
    let found = distances(2011, DROPS);
    let mut of_impact: BTreeMap<(usize, &str), Vec<[f64; 2]>> = BTreeMap::new();
    for ((end, _, name), all) in found.iter().filter(|((.., name), _)| !name.starts_with("un")) {
        of_impact.entry((*end, *name)).or_default().extend(all);
    }
    let mut page = format!(
        "# Numbers of both impacts, as measured\n\n\
         Of {DROPS} simulated drops, with and without limiters: how often a number is stated, how many of \
         the intervals hold the\ntruth, and their median half-width.\n\n\
         | impact | quantity | stated | holds | half-width: median |\n|---|---|---|---|---|\n"
    );
    for ((end, name), all) in of_impact {
        let mut wide: Vec<f64> = all.iter().map(|a| a[1]).collect();
        wide.sort_by(f64::total_cmp);
        let held = all.iter().filter(|a| a[0].abs() <= 1.0).count();
        let _ = writeln!(
            page,
            "| {} | `{name}` | {} | {:.1} % | {:.1} % |",
            ["first", "second"][end],
            all.len(),
            100.0 * held as f64 / all.len() as f64,
            100.0 * wide[wide.len() / 2]
        );
    }
    moved::hold(&root().join("docs/measured/impacts.md"), &page, moved::lines);
    for ((end, is_limited, name), all) in found {
        let mut off: Vec<f64> = all.iter().map(|a| a[0].abs()).collect();
        let mut wide: Vec<f64> = all.iter().map(|a| a[1]).collect();
        off.sort_by(f64::total_cmp);
        wide.sort_by(f64::total_cmp);
        let held = off.iter().filter(|o| **o <= 1.0).count();
        let middle = off.len() / 2;
        println!(
            "end {end}, limiter {is_limited}, {name}: {held} of {} held, median {:.2} half-widths off, \
             the median half-width {:.1} %",
            off.len(),
            off[middle],
            100.0 * wide[middle]
        );
        if (held as f64) < least_held(off.len()) {
            wrong.push(format!("{name} of end {end}, limiter {is_limited}: {held} of {}", off.len()));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_second_simulation_says_the_same_of_both_impacts() {
    // fixtures/reference/impacts.py, which shares no line with this program.
    let names = [
        "duration",
        "velocity_change",
        "restitution",
        "impulse_x",
        "impulse_z",
        "energy_before",
        "energy_after",
        "energy_absorbed",
        "crush",
    ];
    let truths = [
        [0.005_826, 20.7233, 0.559_51, 24_413.6, 33_547.6, 394_303.1, 296_010.9, 100_810.4, 0.031_962],
        [0.004_147, 26.5644, 0.299_40, -17_024.3, 34_048.5, 313_596.3, 28_670.6, 285_514.7, 0.041_460],
    ];
    let file = ingest::cask_file(&fixture("anf18-json.toml")).expect("a cask file");
    let recording = dropcheck::read(&fixture("anf18-json.mcap"), &file, &|_| ()).expect("a recording");
    let result = dropcheck::analyze(&recording, &file).result;
    for (table, truths) in result.impacts.iter().zip(truths) {
        let stated = stated(table);
        for (name, truth) in names.into_iter().zip(truths) {
            let Estimate { value, u95, .. } = stated[name].expect(name);
            assert!((value - truth).abs() <= u95, "{name}: {value} ± {u95}, {truth}");
        }
    }
    let [speed, before] =
        [result.slap_down.speed, result.first_impact.impact_velocity].map(|e| e.expect("told").value);
    assert!((result.amplification.expect("told").value - speed / before).abs() < 1e-12);
    assert!(result.impacts[1].numbers.energy_ratio.is_some_and(|r| (r.value - 0.795_318).abs() <= r.u95));
}
