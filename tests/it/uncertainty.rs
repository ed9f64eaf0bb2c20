//! The linear propagation of the uncertainty against draws of its inputs (JCGM 101), and the ladder on a committed recording.

use dropcheck::data::{AxialClosure, End, Estimate, ReconstructionRung, RivalLaw, Samples, Setup, Verdict};
use dropcheck::{condition, events, fit, ingest, motion};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::path::Path;

/// Draws: the standard deviation of 4000 is known to 1/√8000 = 1.1 %.
const DRAWS: usize = 4000;

fn fixture(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

#[test]
fn the_linear_propagation_agrees_with_draws_of_the_inputs() {
    let file = ingest::cask_file(&fixture("anf18-json.toml")).expect("a cask file");
    let recording = ingest::read(&fixture("anf18-json.mcap"), &file, &|_| ()).expect("a recording");
    let result = dropcheck::analyze(&recording, &file).result;
    let event =
        events::Changes::of(&recording).locate(file.drop.transverse_velocity_m_s()).expect("an impact");
    let reach = condition::Reach::of(&file.cask, &file.drop);
    let (signals, _) = condition::condition(&recording, &event, &reach, file.corrections);
    let setup = Setup {
        length_m: file.cask.length_m,
        height_m: file.cask.height_m,
        cog_m: file.cask.cog_m,
        angle_rad: file.drop.angle_rad,
        impact_velocity_m_s: file.drop.impact_velocity_m_s,
        gravity_m_s2: file.drop.gravity_m_s2,
        axial: AxialClosure::Sticking,
    };
    let u_s = |time: Option<Estimate>| time.map_or(0.0, |t| t.u95 / 2.0);
    let measured = fit::Measured {
        signals: &signals,
        flight: result.flight.as_ref().expect("a flight"),
        events: &result.events,
        u_events_s: [u_s(result.first_impact.time), 1e-4, u_s(result.slap_down.time)],
        setup: &setup,
        rival_law: Some(RivalLaw { axial: AxialClosure::Sliding { friction_ppm: 0 }, way: 1.0 }),
        tolerances: file.tolerances,
        inertia_m2: Some(file.cask.inertia_kg_m2 / file.cask.mass_kg),
        rests: &[],
        fall_s: None,
        stood_in: None,
    };
    let integrated = motion::Integrated::over(&signals, result.events.first_contact_s.expect("a contact"));
    let moved = |flight: &_, events: &_, setup: &_| motion::outcome(&integrated, flight, events, setup);
    let linear = fit::quantities(&measured, &moved).expect("quantities");
    let (mut chance, mut left) = (ChaCha8Rng::seed_from_u64(4), DRAWS);
    let mut draw = |count: usize| {
        left = left.checked_sub(1)?;
        Some((0..count).map(|_| StandardNormal.sample(&mut chance)).collect())
    };
    let (speed_m_s, k) = fit::spread_by_draws(&measured, &moved, &mut draw).expect("draws");
    // Four standard deviations of the draws' own scatter; what bends over ± 3 u adds less.
    for (by_draws, by_slopes) in
        [(speed_m_s, linear.speed.expect("a slap-down").u95 / 2.0), (k, linear.k.u95 / 2.0)]
    {
        assert!((by_draws / by_slopes - 1.0).abs() < 0.045, "{by_draws} by draws, {by_slopes} by slopes");
    }
}

#[test]
fn every_rung_speaks_and_the_budget_adds_up() {
    let file = ingest::cask_file(&fixture("anf18-json.toml")).expect("a cask file");
    let recording = ingest::read(&fixture("anf18-json.mcap"), &file, &|_| ()).expect("a recording");
    let result = dropcheck::analyze(&recording, &file).result;
    let choice = result.reconstruction.expect("a reconstruction");
    let rungs: Vec<ReconstructionRung> = choice.candidates.iter().map(|c| c.rung).collect();
    assert_eq!(rungs, ReconstructionRung::ALL);
    let squares: f64 = result.budget.iter().filter_map(|c| c.speed_m_s).map(|u| u * u).sum();
    let speed = result.slap_down.speed.expect("a slap-down");
    assert!((2.0 * squares.sqrt() / speed.u95 - 1.0).abs() < 1e-9, "{} {}", squares.sqrt(), speed.u95);
    assert!(choice.closures.iter().all(|c| c.miss_in_u.abs() < 3.5), "{:?}", choice.closures);
}

#[test]
fn one_end_alone_gives_its_time_with_an_interval_and_says_what_is_missing() {
    let mut file = ingest::cask_file(&fixture("anf18-json.toml")).expect("a cask file");
    file.channels.truncate(1);
    let recording = ingest::read(&fixture("anf18-json.mcap"), &file, &|_| ()).expect("a recording");
    let result = dropcheck::analyze(&recording, &file).result;
    let time = result.first_impact.time.expect("a first contact");
    // The fixture strikes at 0.1 s.
    assert!(time.u95 > 0.0 && (time.value - 0.1).abs() < time.u95, "{time:?}");
    assert!(result.slap_down.speed.is_none());
    assert!(result.quality.iter().any(|i| i.code == dropcheck::data::IssueCode::MissingChannel));
}

#[test]
fn what_clipping_took_of_the_impact_is_had_from_the_rest_of_the_motion() {
    let file = ingest::cask_file(&fixture("anf18-json.toml")).expect("a cask file");
    let mut recording = ingest::read(&fixture("anf18-json.mcap"), &file, &|_| ()).expect("a recording");
    let whole = dropcheck::analyze(&recording, &file).result;
    let first = recording.channels.iter_mut().find(|c| c.end == End::First).expect("a first end");
    let Samples::F64(samples) = &mut first.samples else { panic!("JSON holds doubles") };
    let limit = 0.8 * samples.iter().copied().fold(0.0, f64::max);
    for sample in samples {
        *sample = sample.clamp(-limit, limit);
    }
    let cut = dropcheck::analyze(&recording, &file).result;
    assert_eq!(cut.verdict, Verdict::Fail, "a step is lost");
    let truth: serde_json::Value =
        serde_json::from_slice(&std::fs::read(fixture("anf18-json.truth.json")).expect("a truth"))
            .expect("JSON");
    let stated = [(cut.k, whole.k, "k"), (cut.slap_down.speed, whole.slap_down.speed, "speed")];
    for (cut, whole, key) in stated {
        let (cut, whole) = (cut.expect(key), whole.expect(key));
        let off = (cut.value - truth[key].as_f64().expect(key)).abs();
        assert!(off <= cut.u95 && cut.u95 > whole.u95, "{key}: {cut:?} beside {whole:?}, off by {off}");
    }
}
