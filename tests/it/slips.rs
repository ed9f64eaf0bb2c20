//! A set-up stated wrongly to the slip that is named, and recordings that no slip explains to none.

use crate::run::fixture;
use dropcheck::data::{
    Axis, CaskFile, Channel, CheckKind, Consistency, Finding, IssueCode, Recording, Samples, Severity,
    Tolerances, Verdict,
};
use dropcheck::lab::data::{SceneFile, SimulatedMotion};
use dropcheck::lab::{self, in_memory, synth};
use dropcheck::{analyze, ingest, stages};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::fs;
use std::mem::swap;
use std::ops::Range;
use std::path::Path;

const G_M_S2: f64 = 9.806_65;

type Change = fn(&mut Recording, &mut CaskFile);

/// Two channels without rest, in a table without words for their unit.
fn read() -> (Recording, CaskFile) {
    ingest::read_hdf5_with(Path::new(env!("CARGO_BIN_EXE_dropcheck")));
    let [recording, cask] = ["anf18-german.csv", "anf18-german.toml"].map(fixture);
    let file = ingest::cask_file(&cask).expect("a cask file");
    let mut recording = dropcheck::read(&recording, &file, &|_| ()).expect("a recording");
    recording.channels.iter_mut().for_each(|c| c.is_unit_recorded = false);
    (recording, file)
}

fn each(channel: &mut Channel, change: impl Fn(usize, &Samples) -> f64) {
    let samples = &channel.samples;
    channel.samples = Samples::F64((0..samples.len()).map(|i| change(i, samples)).collect());
}

/// One channel later, or earlier, by so many seconds: what its file said of its start was not read.
fn moved(channel: &mut Channel, late_s: f64) {
    channel.start_s += late_s;
}

fn exchange(recording: &mut Recording) {
    let [first, second] = &mut recording.channels[..] else { panic!("two channels") };
    swap(&mut first.samples, &mut second.samples);
}

fn cures(change: Change) -> (Vec<Finding>, Verdict) {
    let (mut recording, mut file) = read();
    change(&mut recording, &mut file);
    let result = analyze(&recording, &file).result;
    (result.quality, result.verdict)
}

#[test]
fn a_usual_slip_is_named_first() {
    let slips: [(&str, Change); 13] = [
        ("`polarity` of A2 reversed", |r, _| r.channels[1].scale_m_s2 *= -1.0),
        ("`source` of A1 and A2 exchanged everything", |r, _| exchange(r)),
        ("`drop.angle_deg` counted from the horizontal", |_, f| {
            f.drop.angle_rad = std::f64::consts::FRAC_PI_2 - f.drop.angle_rad;
        }),
        ("`drop.angle_deg` in rad", |_, f| f.drop.angle_rad = f.drop.angle_rad.to_radians()),
        ("`drop.height_m` in cm", |_, f| {
            f.drop.height_m *= 100.0;
            f.drop.impact_velocity_m_s *= 10.0;
        }),
        ("`drop.height_m` in ft", |_, f| {
            f.drop.height_m /= 0.3048;
            f.drop.impact_velocity_m_s /= 0.3048_f64.sqrt();
        }),
        ("`[cask]` in ft and `position_m` of A1 and A2 in ft", |r, f| {
            f.cask.length_m /= 0.3048;
            f.cask.height_m /= 0.3048;
            f.cask.cog_m /= 0.3048;
            r.channels.iter_mut().for_each(|c| c.position_m /= 0.3048);
        }),
        ("`sample_rate_hz` of A1 and A2 halved", |r, f| {
            f.time = None;
            for (channel, spec) in r.channels.iter_mut().zip(&mut f.channels) {
                channel.sample_rate_hz *= 2.0;
                spec.time = None;
                spec.sample_rate_hz = Some(channel.sample_rate_hz);
            }
        }),
        ("`source` of A1 and A2 exchanged and `polarity` of A1 reversed", |r, _| {
            exchange(r);
            r.channels[0].scale_m_s2 *= -1.0;
        }),
        ("`source` of A1 and A2 exchanged and `polarity` of A1 and A2 reversed", |r, _| {
            exchange(r);
            r.channels.iter_mut().for_each(|c| c.scale_m_s2 *= -1.0);
        }),
        ("`unit` of A1 and A2 taken as m/s²", |r, _| {
            // Stated with a full scale, at which the samples then seem to be cut off.
            for channel in &mut r.channels {
                each(channel, |i, samples| samples.get(i) * G_M_S2);
                channel.full_scale = Some(500.0);
            }
        }),
        ("`unit` of A1 and A2 taken as g", |r, _| {
            for channel in &mut r.channels {
                channel.scale_m_s2 = 1.0;
                channel.unit = "m/s^2".into();
            }
        }),
        ("`position_m` of A2 counted from the other end", |r, f| {
            r.channels[1].position_m = f.cask.length_m - r.channels[1].position_m;
        }),
    ];
    for (named, slip) in slips {
        let (findings, verdict) = cures(slip);
        let first = findings.first().expect("a finding");
        assert!(first.message.contains(named), "{named}: {}", first.message);
        assert!(!first.message.contains("; with"), "one alone: {}", first.message);
        assert_ne!(verdict, Verdict::Pass, "{named}: it is never taken by itself");
    }
}

#[test]
fn what_no_single_slip_explains_or_the_file_contradicts_names_none() {
    let changes: [(&str, Change); 6] = [
        ("an angle 6° off", |_, f| f.drop.angle_rad += 6_f64.to_radians()),
        ("two polarities and the vertical", |r, f| {
            r.channels[1].scale_m_s2 *= -1.0;
            f.drop.angle_rad = std::f64::consts::FRAC_PI_2 - f.drop.angle_rad;
        }),
        ("ends exchanged and one in another unit", |r, _| {
            exchange(r);
            r.channels[0].scale_m_s2 /= G_M_S2;
        }),
        ("a scale of 0.7", |r, _| r.channels[0].scale_m_s2 *= 0.7),
        ("a unit that the recording states too", |r, _| {
            for channel in &mut r.channels {
                each(channel, |i, samples| samples.get(i) * G_M_S2);
                channel.is_unit_recorded = true;
            }
        }),
        ("a rate that named times bear out", |r, f| {
            for (channel, spec) in r.channels.iter_mut().zip(&mut f.channels) {
                channel.sample_rate_hz *= 2.0;
                spec.time = Some("t".into());
                spec.sample_rate_hz = Some(channel.sample_rate_hz);
            }
        }),
    ];
    for (name, change) in changes {
        let named = cures(change).0.into_iter().find(|f| f.code == IssueCode::UsualSlip);
        assert!(named.is_none(), "{name}: {}", named.expect("some").message);
    }
}

#[test]
fn the_clock_of_the_second_end_is_named_with_what_it_is_off() {
    let changes: [(&str, Change); 4] = [
        ("10.00 ms later", |r, _| moved(&mut r.channels[1], -0.01)),
        ("20.00 ms later", |r, _| moved(&mut r.channels[1], -0.02)),
        ("20.00 ms earlier", |r, _| moved(&mut r.channels[1], 0.02)),
        ("50.00 ms earlier", |r, _| moved(&mut r.channels[1], 0.05)),
    ];
    for (right, change) in changes {
        let named = cures(change).0.into_iter().find(|f| f.code == IssueCode::UsualSlip).expect(right);
        assert!(named.message.contains(&format!("`time` of A2 {right}")), "{right}: {}", named.message);
    }
}

#[test]
fn the_angle_that_would_close_is_said() {
    let (recording, mut file) = read();
    let right_deg = file.drop.angle_rad.to_degrees();
    file.drop.angle_rad += 3_f64.to_radians();
    let result = analyze(&recording, &file).result;
    let [cause] = &result.causes[..] else { panic!("{:?}", result.quality) };
    let said = format!(" in place of {:.0} everything is consistent", right_deg + 3.0);
    let geometry: Vec<&str> =
        result.quality.iter().filter(|f| f.code == IssueCode::Geometry).map(|f| f.message.as_str()).collect();
    assert!(geometry.iter().any(|message| message.contains(&said)), "{geometry:?}");
    assert!(cause.explains.is_some_and(|deg| (deg - right_deg).abs() < 0.1), "{cause:?}");
}

#[test]
fn the_axes_of_an_end_are_told_apart() {
    ingest::read_hdf5_with(Path::new(env!("CARGO_BIN_EXE_dropcheck")));
    let [recording, cask] = ["vhlw-rest.h5", "vhlw-rest.toml"].map(fixture);
    let file = ingest::cask_file(&cask).expect("a cask file");
    let mut recording = dropcheck::read(&recording, &file, &|_| ()).expect("a recording");
    let axial = recording.channels.iter().position(|c| c.axis == Axis::Axial).expect("an axial channel");
    let end = recording.channels[axial].end;
    let is_beside = |c: &Channel| c.axis == Axis::Transverse && c.end == end;
    let beside = recording.channels.iter().position(is_beside).expect("one of its end");
    let names = [beside.min(axial), beside.max(axial)].map(|i| recording.channels[i].name.clone());
    let [one, other] = recording.channels.get_disjoint_mut([axial, beside]).expect("two channels");
    swap(&mut one.samples, &mut other.samples);
    let found = analyze(&recording, &file).result.quality;
    let said = format!("`source` of {} and {} exchanged", names[0], names[1]);
    assert!(found[0].message.contains(&said), "{}", found[0].message);
}

#[test]
fn the_free_fall_is_the_one_that_is_recorded() {
    for (left_s, is_short) in [(0.004, true), (0.03, false)] {
        let (mut recording, file) = read();
        let contact_s = analyze(&recording, &file).result.first_impact.time.expect("a contact").value;
        for channel in &mut recording.channels {
            let from = channel.index_at(contact_s - left_s);
            channel.start_s = channel.time_s(from);
            let samples = (from..channel.samples.len()).map(|i| channel.samples.get(i)).collect();
            channel.samples = Samples::F64(samples);
        }
        let found = analyze(&recording, &file).result.quality;
        let late: Vec<&str> =
            found.iter().filter(|f| f.code == IssueCode::BeginsLate).map(|f| f.message.as_str()).collect();
        assert_eq!(!late.is_empty(), is_short, "{late:?}");
        assert!(
            late.iter()
                .all(|message| message.contains(" 4.0 ms of free fall") || message.contains(" 3.9 ms")),
            "{late:?}"
        );
    }
}

/// A drop from 9 m of the paper's casks, two in five stretched, with an axial channel at the first end.
fn drawn_drop(seed: u64) -> SceneFile {
    const CASKS: [[f64; 3]; 4] =
        [[315.0, 4.538, 0.15], [1429.0, 4.725, 0.565], [4466.0, 5.512, 0.792], [20_950.0, 4.486, 1.156]];
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut even = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let [mass_kg, length_m, section_m] = CASKS[usize::try_from(seed % 4).expect("a place")];
    let [length_m, section_m] = if even(0.0, 1.0) < 0.4 {
        [length_m * even(0.7, 1.3), section_m * even(0.5, 1.2)]
    } else {
        [length_m, section_m]
    };
    let (angle_deg, [k, second_k]) = (even(5.0, 30.0), [even(0.02, 0.98), even(0.05, 0.7)]);
    let [pulse_ms, bending_hz] =
        [(2.0_f64, 20.0_f64), (30.0, 160.0)].map(|(low, high)| even(low.ln(), high.ln()).exp());
    let second_ms = pulse_ms * even(0.5, 1.5);
    let mut scene = format!(
        "seed = {seed}\n[cask]\nmass_kg = {mass_kg}\nlength_m = {length_m}\nheight_m = {section_m}\n\
         [drop]\nheight_m = 9.0\nangle_deg = {angle_deg}\n[first_end]\npulse_ms = {pulse_ms}\nk = {k}\n\
         [second_end]\npulse_ms = {second_ms}\nk = {second_k}\n\
         [[mode]]\nfrequency_hz = {bending_hz}\ndamping = 0.03\n[recording]\nbefore_s = 0.15\nafter_s = 0.1\n"
    );
    let channels = [
        ("A1", "first", "transverse", 0.15),
        ("A2", "second", "transverse", length_m - 0.15),
        ("A3", "first", "axial", 0.15),
    ];
    scene += &channels.map(|(name, end, axis, position_m)| {
        format!(
            "[[channel]]\nname = \"{name}\"\nend = \"{end}\"\naxis = \"{axis}\"\nposition_m = {position_m}\n\
             sample_rate_hz = 20000\nanti_alias_hz = 6000.0\nwhite_noise_g = 0.1\n"
        )
    }).concat();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    fs::write(&path, scene).expect("a scene");
    lab::scene_file::read(&path).expect("a scene")
}

/// So many of them, with their motion, whose first end strikes once before a flight of 8 ms and more.
fn sound(seeds: Range<u64>, count: usize) -> impl Iterator<Item = (SceneFile, SimulatedMotion)> {
    let simulated = seeds.map(drawn_drop).map(|file| {
        let motion = synth::simulate(&file.scene);
        (file, motion)
    });
    simulated
        .filter(|(_, m)| m.truth.relands == 0 && m.truth.flight_s.is_some_and(|flight_s| flight_s > 8e-3))
        .take(count)
}

#[test]
fn the_second_impact_tells_a_length_off_by_5_percent_where_an_axial_channel_is_there() {
    let is_told = |c: &Consistency| c.kind == CheckKind::SecondTurning;
    let (mut told, mut found, mut held, mut withheld) = (0, 0, 0, 0);
    for (file, motion) in sound(0..100, 20) {
        let recording = synth::record(&file.scene, &motion);
        let read = in_memory::synthetic(&recording, &file.stated).expect("a recording");
        // A cask whose centre of gravity and inertia nobody knows hides its length.
        let stated = CaskFile { tolerances: Tolerances::default(), ..file.stated.clone() };
        let result = stages::measure(&read, &stated).result;
        if result.reconstruction.is_none_or(|choice| !choice.closures.iter().any(is_told)) {
            continue;
        }
        assert_eq!(result.verdict, Verdict::Pass);
        let mut longer = stated;
        longer.cask.length_m *= 1.05;
        let result = stages::measure(&read, &longer).result;
        told += 1;
        if result.quality.iter().any(|f| f.severity == Severity::Warning && f.message.contains("length")) {
            found += 1;
            continue;
        }
        let truth_m_s = motion.truth.speed.expect("R strikes");
        let Some(speed) = result.slap_down.speed else {
            withheld += 1;
            continue;
        };
        held += usize::from((speed.value - truth_m_s).abs() < 2.0 * speed.u95);
    }
    // Six of twelve stand 3 u and more out of what the other closures and all tolerances explain.
    let is_right = found + held + withheld + 2 >= told;
    assert!(told >= 10 && 2 * found >= told && is_right, "{found}, {held} and {withheld} of {told}");
}

#[test]
fn sensors_on_the_skin_that_are_stated_on_the_axis_are_named_and_never_wrong() {
    let (mut passed, mut named, mut told) = (0, 0, 0);
    for (mut file, motion) in sound(100..200, 8) {
        let half_m = file.stated.cask.height_m / 2.0;
        for (channel, spec) in file.scene.channels.iter_mut().zip(&mut file.stated.channels) {
            (channel.offset_m, spec.offset_m) = (-half_m, 0.0);
        }
        let recording = synth::record(&file.scene, &motion);
        let read = in_memory::synthetic(&recording, &file.stated).expect("a recording");
        let result = analyze(&read, &file.stated).result;
        let truth_m_s = motion.truth.speed.expect("R strikes");
        let is_off = |speed: dropcheck::data::Estimate| (speed.value - truth_m_s).abs() > 2.0 * speed.u95;
        let says = |f: &Finding| f.message.contains("`offset_m`") && f.message.contains("(lower skin)");
        passed += usize::from(result.verdict == Verdict::Pass && result.slap_down.speed.is_some_and(is_off));
        named += usize::from(result.quality.iter().any(says));
        told += usize::from(result.verdict != Verdict::Pass);
    }
    assert!(passed == 0 && 2 * named >= told && told > 0, "{named} of {told} named, {passed} pass wrongly");
}

#[test]
fn the_number_that_is_stated_wrong_is_among_the_two_that_are_named() {
    let mistakes: [(&str, Change); 4] = [
        ("position_m", |r, _| r.channels[1].position_m -= 0.4),
        ("scale", |r, _| r.channels[1].scale_m_s2 *= 1.2),
        ("drop.angle_deg", |_, f| f.drop.angle_rad += 4_f64.to_radians()),
        ("drop.height_m", |_, f| {
            f.drop.height_m *= 1.2;
            f.drop.impact_velocity_m_s *= 1.2_f64.sqrt();
        }),
    ];
    let (mut told, mut named, mut listed, mut wrong) = (0, 0, 0, Vec::new());
    for (file, motion) in sound(200..300, 6) {
        let recording = synth::record(&file.scene, &motion);
        let read = in_memory::synthetic(&recording, &file.stated).expect("a recording");
        let truth_m_s = motion.truth.speed.expect("R strikes");
        for (key, mistake) in mistakes {
            let (mut recording, mut stated) = (read.clone(), file.stated.clone());
            mistake(&mut recording, &mut stated);
            let result = analyze(&recording, &stated).result;
            assert!(result.causes.len() <= 2, "{key}: {:?}", result.causes);
            let own = result.causes.iter().find(|cause| cause.key == key);
            told += usize::from(result.verdict != Verdict::Pass);
            named += usize::from(own.is_some());
            let key_words = format!("`{key}`");
            let lists =
                |f: &Finding| f.message.contains("several mistakes") && f.message.contains(&key_words);
            listed += usize::from(result.quality.iter().any(lists));
            let is_wrong = own.is_none() && !result.causes.is_empty();
            wrong.extend(is_wrong.then(|| format!("{key}: {:?}", result.causes)));
            if let Some(speed) = own.and_then(|cause| cause.speed) {
                assert!((speed.value - truth_m_s).abs() < 2.0 * speed.u95, "{key}: {truth_m_s}, {own:?}");
            }
        }
    }
    let is_found = 5 * named >= 2 * told && 2 * (named + listed) >= told;
    assert!(is_found && wrong.is_empty() && told > 0, "{named} and {listed} of {told}; {wrong:#?}");
}
