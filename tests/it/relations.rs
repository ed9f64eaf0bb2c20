//! A recording and its cask file changed in ways that mean nothing, or known things, to a result that does
//! not change, or changes so.

use crate::run::fixture;
use dropcheck::data::{CaskFile, Channel, DropResult, Recording, Samples, Verdict};
use dropcheck::stages::measure;
use dropcheck::{analyze, ingest};
use std::fmt::Write as _;
use std::path::Path;

/// What rounding may move a number by, as a share of its interval.
const ROUNDING: f64 = 1e-5;
/// What another way to write the same numbers may move it by.
const WRITTEN: f64 = 1e-7;
/// What another cut of the same record may move it by: a tenth of an interval is none of its digits.
const CUT: f64 = 0.1;
/// Three things in every order.
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

fn read(recording: &str, cask: &str) -> (Recording, CaskFile) {
    read_files(&fixture(recording), &fixture(cask))
}

fn read_files(recording: &Path, cask: &Path) -> (Recording, CaskFile) {
    ingest::read_hdf5_with(Path::new(env!("CARGO_BIN_EXE_dropcheck")));
    let file = ingest::cask_file(cask).expect("a cask file");
    (dropcheck::read(recording, &file, &|_| ()).expect("a recording"), file)
}

/// The same channels, in the recording and in the cask file, in another order.
fn ordered((recording, file): &(Recording, CaskFile), order: &[usize]) -> (Recording, CaskFile) {
    let (mut recording, mut file) = (recording.clone(), file.clone());
    recording.channels = order.iter().map(|&i| recording.channels[i].clone()).collect();
    file.channels = order.iter().map(|&i| file.channels[i].clone()).collect();
    (recording, file)
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
    let changes: [(&str, f64, Change); 5] = [
        ("channels in another order", ROUNDING, |r, f| {
            r.channels.reverse();
            f.channels.reverse();
        }),
        ("an offset", 1e-3, |r, _| each(&mut r.channels[1], |x| x + 0.3)),
        ("other names", ROUNDING, |r, f| {
            r.channels.iter_mut().for_each(|c| c.name += "'");
            f.channels.iter_mut().for_each(|c| c.name += "'");
        }),
        ("125 samples fewer", CUT, |r, _| beheaded(r, 125)),
        ("v0 in place of the height", 2.0 * CUT, |_, f| f.drop.impact_velocity_given = true),
    ];
    for (recording, file) in both() {
        let before = measure(&recording, &file).result;
        for (name, most, change) in &changes {
            let (mut other, mut stated) = (recording.clone(), file.clone());
            change(&mut other, &mut stated);
            let after = measure(&other, &stated).result;
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
    let (mut all, mut stated) = (recording, file);
    all.channels.push(third);
    stated.channels.push(spec);
    let all = (all, stated);
    for order in ORDERS {
        let (recording, file) = ordered(&all, &order);
        let after = measure(&recording, &file).result;
        assert!(moved(&before, &after) < ROUNDING, "{order:?}");
        let left_out = after.quality.iter().find(|f| f.message.contains("is left out")).expect("named");
        assert_eq!((left_out.channel.as_deref(), after.verdict), (Some("B1"), Verdict::Review));
    }
}

#[test]
fn three_sound_channels_say_the_same_in_every_order() {
    let all = read("vhlw-rest.h5", "vhlw-rest.toml");
    let before = measure(&all.0, &all.1).result;
    for order in ORDERS {
        let (recording, file) = ordered(&all, &order);
        let by = moved(&before, &measure(&recording, &file).result);
        assert!(by <= WRITTEN, "{order:?}: moved by {by} of the interval");
    }
}

/// A table of times and samples and its cask file, to be written in other ways.
#[derive(Clone)]
struct Files {
    head: Vec<String>,
    rows: Vec<Vec<f64>>,
    cask: String,
}

impl Files {
    /// The sound drop of ANF-10 at 12.5 kHz.
    fn sound() -> Self {
        let [table, cask] = ["anf10-plain.csv", "anf10-plain.toml"]
            .map(|name| std::fs::read_to_string(fixture(name)).expect("a fixture"));
        let mut lines = table.lines().map(|line| line.split(','));
        let head = lines.next().expect("a header").map(str::to_owned).collect();
        let rows = lines.map(|cells| cells.map(|x| x.parse().expect("a number")).collect()).collect();
        Self { head, rows, cask }
    }

    /// What is said of them, written to a folder.
    fn result(&self) -> DropResult {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [table, cask] = ["drop.csv", "drop.toml"].map(|name| folder.path().join(name));
        let mut text = self.head.join(",") + "\n";
        for row in &self.rows {
            let _ = write!(text, "{:.5}", row[0]);
            for x in &row[1..] {
                let _ = write!(text, ",{x}");
            }
            text.push('\n');
        }
        std::fs::write(&table, text).expect("a temporary file");
        std::fs::write(&cask, &self.cask).expect("a temporary file");
        let (recording, file) = read_files(&table, &cask);
        measure(&recording, &file).result
    }

    /// All samples changed, and what the cask file says of each channel's unit.
    fn each(&mut self, change: impl Fn(f64) -> f64, unit: &str) {
        self.rows.iter_mut().flat_map(|row| &mut row[1..]).for_each(|x| *x = change(*x));
        self.cask = self.cask.replace("unit = \"g\"", unit);
    }

    fn later(&mut self, by_s: f64) {
        self.rows.iter_mut().for_each(|row| row[0] += by_s);
    }
}

type FileChange = fn(&mut Files);

#[test]
fn another_way_to_write_the_same_drop_says_the_same() {
    let changes: [(&str, f64, FileChange); 18] = [
        ("columns in another order", WRITTEN, |f| {
            f.head.swap(1, 2);
            f.rows.iter_mut().for_each(|row| row.swap(1, 2));
        }),
        ("a column that no channel names", WRITTEN, |f| {
            f.head.insert(1, "P3".into());
            f.rows.iter_mut().for_each(|row| row.insert(1, -row[1] + 7.0));
        }),
        ("tables of channels in another order", WRITTEN, |f| {
            let mut tables: Vec<&str> = f.cask.split("[[channel]]").collect();
            tables.swap(1, 2);
            f.cask = tables.join("[[channel]]");
        }),
        ("times from 1000 s on", WRITTEN, |f| f.later(1000.0)),
        ("times before zero", WRITTEN, |f| f.later(-1.5)),
        ("times since 1970", WRITTEN, |f| f.later(1.7e9)),
        ("m/s² for g", WRITTEN, |f| f.each(|x| x * 9.806_65, "unit = \"m/s^2\"")),
        ("mV for g", WRITTEN, |f| f.each(|x| x * 9.7, "unit = \"mV\"\nsensitivity = 9.7")),
        ("both polarities", WRITTEN, |f| f.each(|x| -x, "unit = \"g\"\npolarity = -1")),
        ("one polarity", WRITTEN, |f| {
            f.rows.iter_mut().for_each(|row| row[2] = -row[2]);
            f.cask = f.cask.replace("source = \"A2\"", "source = \"A2\"\npolarity = -1");
        }),
        ("a hundredfold mass", WRITTEN, |f| {
            f.cask = f.cask.replace("1429.0", "142900.0").replace("2696.6", "269660.0");
        }),
        ("defaults stated", WRITTEN, |f| {
            f.cask += "[tolerance]\nangle_deg = 0.4\nimpact_velocity_percent = 0.3\ncalibration_percent = 1\n\
                       cross_axis_percent = 2\nposition_m = 0.01\ncog_m = 0.01\nclock_percent = 0.05\n\
                       inertia_percent = 2\nangular_velocity_deg_s = 1\nhorizontal_velocity_m_s = 0.1\n\
                       length_m = 0.04725\nheight_m = 0.00565\n";
        }),
        ("a rate lower by 2e-9", CUT, |f| f.each(|x| x, "unit = \"g\"\nsample_rate_hz = 12499.999975")),
        ("1 row fewer", CUT, |f| drop(f.rows.drain(..1))),
        ("40 rows fewer", CUT, |f| drop(f.rows.drain(..40))),
        ("125 rows fewer", CUT, |f| drop(f.rows.drain(..125))),
        ("half of the rows", CUT, |f| {
            let mut is_kept = false;
            f.rows.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
        }),
        ("twice the rows", CUT, |f| {
            // The cubic through the four rows about the middle.
            let between = |four: &[Vec<f64>]| {
                let at = |i| (9.0 * (four[1][i] + four[2][i]) - four[0][i] - four[3][i]) / 16.0;
                [four[1].clone(), (0..3).map(at).collect()]
            };
            f.rows = f.rows.windows(4).flat_map(between).collect();
        }),
    ];
    let sound = Files::sound();
    let before = sound.result();
    let mut apart = String::new();
    for (name, most, change) in changes {
        let mut other = sound.clone();
        change(&mut other);
        let after = other.result();
        let by = moved(&before, &after);
        if by > most || after.verdict != before.verdict {
            let _ = writeln!(apart, "{name}: {:?}, moved by {by} of the interval", after.verdict);
        }
    }
    assert!(apart.is_empty(), "{apart}");
}

#[test]
fn a_dataset_says_what_a_column_says() {
    fn written<T: hdf5_metno::H5Type>(
        file: &hdf5_metno::File,
        name: &str,
        samples: &[T],
    ) -> hdf5_metno::Result<()> {
        let dataset = file.new_dataset_builder().with_data(samples).create(name)?;
        dataset.new_attr::<f64>().create("sample_rate_hz")?.write_scalar(&12_500.0)
    }
    let sound = Files::sound();
    let before = sound.result();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [path, cask] = ["drop.h5", "drop.toml"].map(|name| folder.path().join(name));
    std::fs::write(&cask, &sound.cask).expect("a temporary file");
    for is_double in [true, false] {
        let file = hdf5_metno::File::create(&path).expect("a temporary file");
        for (name, i) in [("A1", 1), ("A2", 2)] {
            let samples: Vec<f64> = sound.rows.iter().map(|row| row[i]).collect();
            #[allow(clippy::cast_possible_truncation, reason = "that is the change")]
            let single: Vec<f32> = samples.iter().map(|x| *x as f32).collect();
            if is_double { written(&file, name, &samples) } else { written(&file, name, &single) }
                .expect("a dataset");
        }
        file.close().expect("a file");
        let (recording, stated) = read_files(&path, &cask);
        let by = moved(&before, &measure(&recording, &stated).result);
        let most = if is_double { WRITTEN } else { 10.0 * WRITTEN };
        assert!(by <= most, "doubles: {is_double}: moved by {by} of the interval");
    }
}
