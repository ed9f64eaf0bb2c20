//! A recording and its cask file changed in ways that mean nothing, or known things, to a result that does not change, or changes so.

use dropcheck::data::{CaskFile, Channel, DropResult, Recording, Samples, Verdict};
use dropcheck::{analyze, ingest};
use std::path::Path;

/// What rounding may move a number by, as a share of its interval.
const ROUNDING: f64 = 1e-5;
/// What another cut of the same record may move it by.
const CUT: f64 = 0.05;

fn read(recording: &str, cask: &str) -> (Recording, CaskFile) {
    ingest::read_hdf5_with(Path::new(env!("CARGO_BIN_EXE_dropcheck")));
    let fixture = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name);
    let file = ingest::cask_file(&fixture(cask)).expect("a cask file");
    (ingest::read(&fixture(recording), &file, &|_| ()).expect("a recording"), file)
}

/// A recording without rest, and one with.
fn both() -> [(Recording, CaskFile); 2] {
    [read("anf18-german.csv", "anf18-german.toml"), read("vhlw-rest.h5", "vhlw-rest.toml")]
}

fn each(channel: &mut Channel, change: impl Fn(f64) -> f64) {
    channel.samples =
        Samples::F64((0..channel.samples.len()).map(|i| change(channel.samples.get(i))).collect());
}

/// Leaves out the first samples of every channel.
fn beheaded(recording: &mut Recording, count: usize) {
    for channel in &mut recording.channels {
        channel.start_s = channel.time_s(count);
        let samples = (count..channel.samples.len()).map(|i| channel.samples.get(i)).collect();
        channel.samples = Samples::F64(samples);
    }
}

/// By how much of its interval the number moves that moves most: speed, k, ω, both velocities.
fn moved(before: &DropResult, after: &DropResult) -> f64 {
    let numbers = |r: &DropResult| {
        let s = &r.slap_down;
        [s.speed, r.k, r.first_impact.angular_velocity, s.vertical_velocity, s.horizontal_velocity]
            .map(|number| number.expect("a whole result"))
    };
    let by = |(a, b): (dropcheck::data::Estimate, dropcheck::data::Estimate)| {
        ((a.value - b.value).abs() / a.u95).max((b.u95 / a.u95 - 1.0).abs())
    };
    numbers(before).into_iter().zip(numbers(after)).map(by).fold(0.0, f64::max)
}

type Change = fn(&mut Recording, &mut CaskFile);

#[test]
fn what_means_nothing_changes_nothing() {
    let changes: [(&str, f64, Change); 12] = [
        ("channels in another order", ROUNDING, |r, f| {
            r.channels.reverse();
            f.channels.reverse();
        }),
        ("another origin of time", ROUNDING, |r, _| r.channels.iter_mut().for_each(|c| c.start_s += 1000.0)),
        ("another unit", ROUNDING, |r, _| {
            for channel in &mut r.channels {
                each(channel, |x| x * 9.806_65);
                channel.scale_m_s2 /= 9.806_65;
            }
        }),
        ("the other polarity", ROUNDING, |r, _| {
            each(&mut r.channels[0], |x| -x);
            r.channels[0].scale_m_s2 *= -1.0;
        }),
        ("an offset", 1e-3, |r, _| each(&mut r.channels[1], |x| x + 0.3)),
        ("a hundredfold mass", ROUNDING, |_, f| {
            f.cask.mass_kg *= 100.0;
            f.cask.inertia_kg_m2 *= 100.0;
        }),
        ("other names", ROUNDING, |r, f| {
            r.channels.iter_mut().for_each(|c| c.name += "'");
            f.channels.iter_mut().for_each(|c| c.name += "'");
        }),
        ("a rate lower by 2e-9", CUT, |r, _| {
            r.channels.iter_mut().for_each(|c| c.sample_rate_hz *= 1.0 - 2e-9);
        }),
        ("7 samples fewer", CUT, |r, _| beheaded(r, 7)),
        ("125 samples fewer", CUT, |r, _| beheaded(r, 125)),
        ("single precision", CUT, |r, _| {
            for channel in &mut r.channels {
                #[allow(clippy::cast_possible_truncation, reason = "that is the change")]
                each(channel, |x| f64::from(x as f32));
            }
        }),
        ("v0 in place of the height", 2.0 * CUT, |_, f| f.drop.impact_velocity_given = true),
    ];
    for (recording, file) in both() {
        let before = analyze(&recording, &file).result;
        for (name, most, change) in &changes {
            let (mut other, mut stated) = (recording.clone(), file.clone());
            change(&mut other, &mut stated);
            let after = analyze(&other, &stated).result;
            let by = moved(&before, &after);
            assert!(by <= *most, "{}, {name}: moved by {by} of the interval", file.cask.name);
        }
    }
}

#[test]
fn a_channel_told_twice_is_not_known_better() {
    for (mut recording, mut file) in both() {
        let before = analyze(&recording, &file).result;
        let (mut copy, mut spec) = (recording.channels[0].clone(), file.channels[0].clone());
        copy.name = "again".into();
        spec.name = "again".into();
        recording.channels.push(copy);
        file.channels.push(spec);
        let after = analyze(&recording, &file).result;
        assert!(moved(&before, &after) < ROUNDING, "{}", file.cask.name);
        assert!(after.quality.iter().any(|f| f.message.contains("one for one")), "{:?}", after.quality);
        assert_eq!(after.verdict, Verdict::Review);
    }
}

#[test]
fn the_one_channel_that_disagrees_is_left_out_whatever_the_order() {
    let (recording, file) = read("anf18-german.csv", "anf18-german.toml");
    let before = analyze(&recording, &file).result;
    // Another sensor at the same place with a noise of its own, read 1.3 times too large.
    let (mut third, mut spec) = (recording.channels[0].clone(), file.channels[0].clone());
    third.name = "B1".into();
    spec.name = "B1".into();
    let samples =
        (0..third.samples.len()).map(|i| 1.3 * third.samples.get(i) + if i % 2 == 0 { 0.02 } else { -0.02 });
    third.samples = Samples::F64(samples.collect());
    for at in [0, recording.channels.len()] {
        let (mut recording, mut file) = (recording.clone(), file.clone());
        recording.channels.insert(at, third.clone());
        file.channels.insert(at, spec.clone());
        let after = analyze(&recording, &file).result;
        assert!(moved(&before, &after) < ROUNDING, "at {at}");
        let left_out = after.quality.iter().find(|f| f.message.contains("is left out")).expect("named");
        assert_eq!((left_out.channel.as_deref(), after.verdict), (Some("B1"), Verdict::Review));
    }
}

#[test]
fn a_usual_slip_is_named_first() {
    let slips: [(&str, Change); 3] = [
        ("polarity of A2", |r, _| r.channels[1].scale_m_s2 *= -1.0),
        ("sources of A1 and A2 exchanged", |r, _| {
            let [first, second] = &mut r.channels[..] else { panic!("two channels") };
            std::mem::swap(&mut first.samples, &mut second.samples);
        }),
        ("count from the vertical", |_, f| f.drop.angle_rad = std::f64::consts::FRAC_PI_2 - f.drop.angle_rad),
    ];
    let (recording, file) = read("anf18-german.csv", "anf18-german.toml");
    for (named, slip) in slips {
        let (mut wrong, mut stated) = (recording.clone(), file.clone());
        slip(&mut wrong, &mut stated);
        let result = analyze(&wrong, &stated).result;
        let first = result.quality.first().expect("a finding");
        assert!(first.message.contains(named), "{named}: {}", first.message);
        assert_eq!(result.verdict, Verdict::Fail, "it is never taken by itself");
    }
}
