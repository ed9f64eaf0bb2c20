//! The linear propagation of the uncertainty against draws of its inputs (JCGM 101), and the ladder on a
//! committed recording.

use crate::run::{fixture, truth};
use dropcheck::data::{AssumedFriction, Contact, End, Method, Recording, Samples, Verdict};
use dropcheck::{ingest, stages};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Draws: the standard deviation of 4000 is known to 1/√8000 = 1.1 %.
const DRAWS: u32 = 4000;

#[test]
fn the_linear_propagation_agrees_with_draws_of_the_inputs() {
    let file = ingest::cask_file(&fixture("anf18-json.toml")).expect("a cask file");
    let recording = dropcheck::read(&fixture("anf18-json.mcap"), &file, &|_| ()).expect("a recording");
    let result = dropcheck::analyze(&recording, &file).result;
    let event = stages::Changes::new(&recording.channels)
        .locate(file.drop.transverse_velocity_m_s())
        .expect("an impact");
    let reach = stages::Reach::for_drop(&file.cask, &file.drop);
    let (signals, _) = stages::condition(&recording, &event, &reach, file.corrections);
    let setup = stages::sticking(&file);
    let measured = stages::FitData {
        signals: &signals,
        flight: result.flight.as_ref().expect("a flight"),
        events: &result.events,
        setup: &setup,
        friction: Some(AssumedFriction { ratio: 0.6, u: 0.06 }),
        specs: &file.channels,
        tolerances: file.tolerances,
        inertia_m2: Some(file.cask.inertia_kg_m2 / file.cask.mass_kg),
        rests: &[],
        fall_s: None,
        rotations: &[],
        stood_in: None,
        second: None,
    };
    let integrated = stages::Integrated::new(&signals, result.events.first_contact_s().expect("a contact"));
    let moved = |flight: &_, events: &_, setup: &_| stages::outcome(&integrated, flight, events, setup);
    let ladder = stages::run_methods(&measured, &moved).expect("quantities");
    let linear = ladder.choice.candidates.iter().find(|c| c.rung == Method::Flight).expect("one");
    let mut chance = ChaCha8Rng::seed_from_u64(4);
    let mut drawn = || {
        let inputs = ladder.draw_inputs(|| StandardNormal.sample(&mut chance));
        let motion = moved(&inputs.flight, &inputs.events, &inputs.setup).expect("a motion");
        let (x, z) = motion.second_end_m_s.expect("a slap-down");
        [x.hypot(z), motion.rebound_m_s / inputs.setup.impact_velocity_m_s]
    };
    let draws: Vec<[f64; 2]> = (0..DRAWS).map(|_| drawn()).collect();
    let deviation = |i: usize| {
        let mean = |of: &dyn Fn(f64) -> f64| draws.iter().map(|d| of(d[i])).sum::<f64>() / f64::from(DRAWS);
        (mean(&|x| x * x) - mean(&|x| x).powi(2)).sqrt()
    };
    // Four standard deviations of the draws' own scatter; what bends over ± 3 u adds less.
    for (i, by_slopes) in [linear.speed, linear.k].into_iter().enumerate() {
        let (by_draws, by_slopes) = (deviation(i), by_slopes.expect("a number").u95 / 2.0);
        assert!((by_draws / by_slopes - 1.0).abs() < 0.045, "{by_draws} by draws, {by_slopes} by slopes");
    }
}

/// The fixture as a recorder whose clock is slow by a share would have written it.
fn by_a_slow_clock(recording: &Recording, share: f64) -> Recording {
    let mut recording = recording.clone();
    for channel in &mut recording.channels {
        channel.sample_rate_hz *= 1.0 + share;
        channel.start_s /= 1.0 + share;
    }
    recording
}

#[test]
fn the_clock_contributes_what_another_rate_changes() {
    let mut file = ingest::cask_file(&fixture("anf18-german.toml")).expect("a cask file");
    file.contact = Contact::Rough;
    let recording = dropcheck::read(&fixture("anf18-german.csv"), &file, &|_| ()).expect("a recording");
    let stated = |recording: &Recording| {
        let result = dropcheck::analyze(recording, &file).result;
        let speed = result.slap_down.speed.expect("a slap-down");
        (result.k.expect("an impact"), speed, result.budget)
    };
    let (k, _, budget) = stated(&recording);
    let clock = budget.iter().find(|c| c.input == "recorder's clock").expect("an input of its own");
    assert_eq!(clock.standard_uncertainty, "0.025 %");
    let u = file.tolerances.clock / 2.0;
    let k_by_clock = clock.k.expect("k");
    // All that L gains in the contact is in proportion to it: k v0 + v0. That the cask turns by as much more
    // meanwhile adds 1e-3 of it.
    assert!((k_by_clock / ((1.0 + k.value) * u) - 1.0).abs() < 2e-3, "{k_by_clock}");
    let share = 0.02;
    let ((k_slow, slow, _), (k_fast, fast, _)) =
        (stated(&by_a_slow_clock(&recording, share)), stated(&by_a_slow_clock(&recording, -share)));
    for (slow, fast, by_clock) in [(k_slow, k_fast, clock.k), (slow, fast, clock.speed_m_s)] {
        let (change, expected) =
            ((slow.value - fast.value).abs() * u / (2.0 * share), by_clock.expect("a share"));
        // At another rate an event lies on another part of a sample: 0.1 ms of fall are 1 mm/s of 260, and
        // 4e-5 of 0.054.
        assert!((change / expected - 1.0).abs() < 0.02, "{change} by rates, {expected} by slopes");
    }
}

#[test]
fn a_rate_off_by_less_than_the_stated_tolerance_leaves_the_truth_in_its_interval() {
    let mut file = ingest::cask_file(&fixture("anf18-json.toml")).expect("a cask file");
    let recording = dropcheck::read(&fixture("anf18-json.mcap"), &file, &|_| ()).expect("a recording");
    let truth = truth("anf18-json");
    // Off by a share, with a stated tolerance in percent: whether the intervals of k and speed hold the
    // truth.
    let mut holds = |share: f64, clock_percent: f64| {
        file.tolerances.clock = clock_percent / 100.0;
        let result = dropcheck::analyze(&by_a_slow_clock(&recording, share), &file).result;
        [(result.k, "k"), (result.slap_down.speed, "speed")].map(|(stated, key)| {
            let stated = stated.expect(key);
            (stated.value - truth[key].as_f64().expect(key)).abs() <= stated.u95
        })
    };
    for sign in [-1.0, 1.0] {
        assert_eq!(holds(sign * 0.001, 0.2), [true; 2]);
        assert_eq!(holds(sign * 0.02, 4.0), [true; 2]);
        assert!(!holds(sign * 0.02, 0.05)[0], "k by a clock 2 % off");
    }
}

#[test]
fn a_clock_that_the_free_fall_contradicts_is_named() {
    ingest::read_hdf5_with(std::path::Path::new(env!("CARGO_BIN_EXE_dropcheck")));
    let file = ingest::cask_file(&fixture("vhlw-rest.toml")).expect("a cask file");
    let recording = dropcheck::read(&fixture("vhlw-rest.h5"), &file, &|_| ()).expect("a recording");
    for (share, words) in [(0.02, "clock is 2.0 % slow"), (-0.02, "clock is 2.0 % fast")] {
        let result = dropcheck::analyze(&by_a_slow_clock(&recording, share), &file).result;
        assert_eq!(result.verdict, Verdict::Review);
        assert!(result.quality.iter().any(|i| i.message.contains(words)), "{:?}", result.quality);
    }
    let mut known = file.clone();
    known.tolerances.clock = 0.04;
    let result = dropcheck::analyze(&by_a_slow_clock(&recording, 0.02), &known).result;
    assert!(!result.quality.iter().any(|i| i.message.contains("clock is")), "{:?}", result.quality);
}

#[test]
fn every_rung_speaks_and_the_budget_adds_up() {
    let file = ingest::cask_file(&fixture("anf18-json.toml")).expect("a cask file");
    let recording = dropcheck::read(&fixture("anf18-json.mcap"), &file, &|_| ()).expect("a recording");
    let result = dropcheck::analyze(&recording, &file).result;
    let choice = result.reconstruction.expect("a reconstruction");
    let rungs: Vec<Method> = choice.candidates.iter().map(|c| c.rung).collect();
    assert_eq!(rungs, Method::ALL);
    let squares: f64 = result.budget.iter().filter_map(|c| c.speed_m_s).map(|u| u * u).sum();
    let speed = result.slap_down.speed.expect("a slap-down");
    assert!((2.0 * squares.sqrt() / speed.u95 - 1.0).abs() < 1e-9, "{} {}", squares.sqrt(), speed.u95);
    assert!(choice.closures.iter().all(|c| c.miss_in_u.abs() < 3.5), "{:?}", choice.closures);
}

#[test]
fn one_end_alone_gives_its_time_with_an_interval_and_says_what_is_missing() {
    let mut file = ingest::cask_file(&fixture("anf18-json.toml")).expect("a cask file");
    file.channels.truncate(1);
    let recording = dropcheck::read(&fixture("anf18-json.mcap"), &file, &|_| ()).expect("a recording");
    let result = dropcheck::analyze(&recording, &file).result;
    let time = result.first_impact.time.expect("a first contact");
    // The fixture strikes at 0.1 s.
    assert!(time.u95 > 0.0 && (time.value - 0.1).abs() < time.u95, "{time:?}");
    assert!(result.slap_down.speed.is_none());
    assert!(result.quality.iter().any(|i| i.code == dropcheck::data::IssueCode::MissingChannel));
}

#[test]
fn what_clipping_took_of_the_impact_is_had_from_the_rest_of_the_motion() {
    let mut file = ingest::cask_file(&fixture("anf18-json.toml")).expect("a cask file");
    // With a friction off by a fifth, or an inertia by a tenth, the turning says too little of a lost step.
    (file.contact, file.tolerances.friction, file.tolerances.inertia) = (Contact::Rough, 0.02, 0.02);
    let mut recording = dropcheck::read(&fixture("anf18-json.mcap"), &file, &|_| ()).expect("a recording");
    let whole = dropcheck::analyze(&recording, &file).result;
    let first = recording.channels.iter_mut().find(|c| c.end == End::First).expect("a first end");
    let Samples::F64(samples) = &mut first.samples else { panic!("JSON holds doubles") };
    let limit = 0.8 * samples.iter().copied().fold(0.0, f64::max);
    for sample in samples {
        *sample = sample.clamp(-limit, limit);
    }
    let cut = dropcheck::analyze(&recording, &file).result;
    assert_eq!(cut.verdict, Verdict::Fail, "a step is lost");
    let truth = truth("anf18-json");
    let stated = [(cut.k, whole.k, "k"), (cut.slap_down.speed, whole.slap_down.speed, "speed")];
    for (cut, whole, key) in stated {
        let (cut, whole) = (cut.expect(key), whole.expect(key));
        let off = (cut.value - truth[key].as_f64().expect(key)).abs();
        assert!(off <= cut.u95 && cut.u95 > whole.u95, "{key}: {cut:?} beside {whole:?}, off by {off}");
    }
}
