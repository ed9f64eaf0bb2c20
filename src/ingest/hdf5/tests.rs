//! HDF5 files of every kind of number, with the attributes and times that recordings have.

use super::super::csv::tests::cask_file;
use super::*;
use crate::data::{IssueCode, Samples, Severity};
use crate::ingest::{Limits, ReadRequest};
use hdf5_metno::File;
use hdf5_metno::types::VarLenUnicode;
use std::path::PathBuf;

pub(super) struct Made {
    _dir: tempfile::TempDir,
    pub path: PathBuf,
}

/// A file that `fill` fills.
pub(super) fn made(fill: impl FnOnce(&File) -> hdf5_metno::Result<()>) -> Made {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("r.h5");
    let created = File::create(&path).unwrap();
    fill(&created).unwrap();
    created.close().unwrap();
    // The C library may have it open still when the next line is reached.
    let copy = dir.path().join("copy.h5");
    std::fs::copy(&path, &copy).unwrap();
    let refused = super::pure::tests::refused_of(&copy);
    assert!(refused.iter().all(|refused| refused.contains("only the HDF5 library")), "{refused:?}");
    Made { _dir: dir, path }
}

pub(super) fn number(place: &hdf5_metno::Location, name: &str, value: f64) -> hdf5_metno::Result<()> {
    place.new_attr::<f64>().create(name)?.write_scalar(&value)
}

pub(super) fn text(place: &hdf5_metno::Location, name: &str, value: &str) -> hdf5_metno::Result<()> {
    place.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&value.parse::<VarLenUnicode>().unwrap())
}

pub(super) fn values(raw: &RawChannel) -> Vec<f64> {
    (0..raw.uniform.samples.len()).map(|i| raw.uniform.samples.get(i)).collect()
}

pub(super) fn told(made: &Made, source: &str) -> String {
    let error = read(ReadRequest::silent(&made.path, Limits::default()), &cask_file(&[source])).unwrap_err();
    let help = miette::Diagnostic::help(&error).map(|help| help.to_string()).unwrap_or_default();
    format!("{error} | {help}")
}

#[test]
fn every_number_type_filter_and_attribute_is_read() {
    let made = made(|file| {
        let group = file.create_group("daq")?;
        number(&group, "fs", 1000.0)?;
        text(&group, "units", "m/s^2")?;
        let short = group.new_dataset_builder().with_data(&[-2_i16, 0, 300]).create("i16")?;
        number(&short, "scale", 0.5)?;
        number(&short, "offset", 1.0)?;
        number(&short, "sample_rate_hz", 500.0)?;
        text(&short, "unit", "g")?;
        number(&short, "start_time_s", 0.25)?;
        group.new_dataset_builder().with_data(&[1_u8, 2, 3]).create("u8")?;
        group.new_dataset_builder().with_data(&[1_i32 << 30, 2, 3]).create("i32")?;
        group.new_dataset_builder().with_data(&[1_i64 << 40, 2, 3]).create("i64")?;
        group.new_dataset_builder().with_data(&[1.5_f64, 2.5, 3.5]).create("f64")?;
        let packed: Vec<f32> = (0..5000_u16).map(f32::from).collect();
        let builder = group.new_dataset_builder().chunk(1000).shuffle().deflate(4).fletcher32();
        builder.with_data(&packed).create("gz")?;
        group.new_dataset_builder().chunk(1000).lzf().with_data(&packed).create("lzf").map(|_| ())
    });
    let names = ["/daq/i16", "/daq/u8", "daq/i32", "/daq/i64", "/daq/f64", "/daq/gz", "/daq/lzf"];
    let channels =
        read(ReadRequest::silent(&made.path, Limits::default()), &cask_file(&names)).unwrap().channels;
    assert_eq!(values(&channels[0]), [0.0, 1.0, 151.0]);
    assert_eq!((channels[0].unit.as_deref(), channels[1].unit.as_deref()), (Some("g"), Some("m/s^2")));
    let base = &channels[0].uniform;
    assert!((base.sample_rate_hz - 500.0).abs() < 1e-12 && (base.start_s - 0.25).abs() < 1e-12);
    assert!((channels[1].uniform.sample_rate_hz - 1000.0).abs() < 1e-12);
    assert_eq!(values(&channels[1]), [1.0, 2.0, 3.0]);
    assert_eq!(values(&channels[2])[..1], [f64::from(1_i32 << 30)]);
    assert!(matches!(channels[3].uniform.samples, Samples::F64(_)));
    assert_eq!(values(&channels[4]), [1.5, 2.5, 3.5]);
    for packed in &channels[5..] {
        assert!(matches!(packed.uniform.samples, Samples::F32(_)));
        assert_eq!((packed.uniform.samples.len(), packed.uniform.samples.get(4999)), (5000, 4999.0));
    }
}

#[test]
fn whole_numbers_of_fewer_bits_than_their_bytes_keep_their_sign() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("r.h5");
    // The older layout, whose headers have no check sum.
    let made = File::with_options().with_fapl(|access| access.libver_earliest()).create(&path).unwrap();
    let data = made.new_dataset_builder().with_data(&[5_i16, 0x0FFB, 0x0800]).create("a").unwrap();
    number(&data, "sample_rate", 100.0).unwrap();
    drop(data);
    made.close().unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    // The type's class, sign, bytes, first bit, and bits: 16, of which 12 are left.
    let stated = [0x10, 8, 0, 0, 2, 0, 0, 0, 0, 0, 16, 0];
    let at = bytes.windows(stated.len()).position(|window| window == stated).unwrap();
    bytes[at + 10] = 12;
    std::fs::write(&path, bytes).unwrap();
    let channels = read(ReadRequest::silent(&path, Limits::default()), &cask_file(&["/a"])).unwrap().channels;
    assert_eq!(values(&channels[0]), [5.0, -5.0, -2048.0]);
}

/// Two sensors in groups of their own, columns in g, the times of one drifting by 30 % of an interval.
fn two_sensors() -> Made {
    made(|file| {
        for (name, rate_hz, count) in [("fast", 1000.0, 2000_u16), ("slow", 250.0, 500)] {
            let group = file.create_group(name)?;
            let times: Vec<f64> =
                (0..count).map(f64::from).map(|i| 7.0 + (i + 0.3 * (i / 50.0).sin()) / rate_hz).collect();
            let rows: Vec<[f32; 3]> = (0..count).map(|i| [f32::from(i), -f32::from(i), 0.5]).collect();
            let flat: Vec<f32> = rows.into_iter().flatten().collect();
            let shape = (usize::from(count), 3);
            let data = group.new_dataset::<f32>().shape(shape).create("acc")?;
            data.write_raw(&flat)?;
            text(&data, "units", "g")?;
            group.new_dataset_builder().with_data(&times).create("time_s")?;
        }
        Ok(())
    })
}

#[test]
fn each_sensor_keeps_its_own_jittering_times() {
    let made = two_sensors();
    let channels = read(
        ReadRequest::silent(&made.path, Limits::default()),
        &cask_file(&["/fast/acc[1]", "/slow/acc[0]"]),
    )
    .unwrap()
    .channels;
    for (channel, rate_hz, slope) in [(&channels[0], 1000.0, -1.0), (&channels[1], 250.0, 1.0)] {
        // The sine leaves the fitted slope off by less than its amplitude over the record.
        assert!((channel.uniform.sample_rate_hz / rate_hz - 1.0).abs() < 2e-3);
        assert!(channel.uniform.time_jitter_s * rate_hz > 0.15);
        assert_eq!(channel.uniform.issues[0].code, IssueCode::Clock);
        assert_eq!(channel.unit.as_deref(), Some("g"));
        let middle = channel.uniform.samples.get(100);
        assert!((middle - slope * 100.0).abs() < 1.0, "{middle}");
    }
}

#[test]
fn a_column_of_chunks_is_read_whole() {
    let flat: Vec<i16> = (0..9000).collect();
    let made = made(|file| {
        let data = file.new_dataset::<i16>().chunk((700, 2)).deflate(1).shape((3000, 3)).create("table")?;
        number(&data, "sample_rate", 100.0)?;
        data.write_raw(&flat)
    });
    let channels = read(ReadRequest::silent(&made.path, Limits::default()), &cask_file(&["/table[2]"]))
        .unwrap()
        .channels;
    let expected: Vec<f64> = flat.iter().skip(2).step_by(3).map(|&x| f64::from(x)).collect();
    assert_eq!(values(&channels[0]), expected);
}

#[test]
fn named_times_and_a_declared_rate_are_followed() {
    let made = made(|file| {
        let clock = file.new_dataset_builder().with_data(&[0_i32, 20, 40]).create("clock")?;
        text(&clock, "unit", "ms")?;
        file.new_dataset_builder().with_data(&[1.0_f32, 2.0, 3.0]).create("a").map(|_| ())
    });
    let mut cask = cask_file(&["/a"]);
    assert!(told(&made, "/a").contains("nothing says when"), "{}", told(&made, "/a"));
    cask.time = Some("clock".into());
    let channel = &read(ReadRequest::silent(&made.path, Limits::default()), &cask).unwrap().channels[0];
    assert!((channel.uniform.sample_rate_hz - 50.0).abs() < 1e-9);
    cask.time = None;
    cask.channels[0].sample_rate_hz = Some(80.0);
    let channel = &read(ReadRequest::silent(&made.path, Limits::default()), &cask).unwrap().channels[0];
    assert!((channel.uniform.sample_rate_hz - 80.0).abs() < 1e-9);
}

#[test]
fn what_is_no_column_says_what_it_is() {
    let made = made(|file| {
        let group = file.create_group("daq")?;
        group.new_dataset_builder().with_data(&[1.0_f32, 2.0]).create("a1")?;
        group.new_dataset::<f32>().shape((4, 3)).create("never")?;
        let table = group.new_dataset::<f32>().shape((4, 3)).create("table")?;
        table.write_raw(&[0.0_f32; 12])?;
        let cube = group.new_dataset::<f32>().shape((2, 2, 2)).create("cube")?;
        cube.write_raw(&[0.0_f32; 8])?;
        group.new_dataset::<f64>().create("scalar")?.write_scalar(&1.0)?;
        group.new_dataset::<f32>().shape(0).create("none")?;
        let words: Vec<VarLenUnicode> = vec!["a".parse().unwrap(), "b".parse().unwrap()];
        group.new_dataset_builder().with_data(&words).create("words").map(|_| ())
    });
    let cases: [(&str, &[&str]); 11] = [
        ("/daq/A1", &["no dataset /daq/A1", "did you mean /daq/a1"]),
        ("/daq", &["is a group"]),
        ("/daq/words", &["no numbers but text"]),
        ("/daq/scalar", &["single value"]),
        ("/daq/none", &["empty"]),
        ("/daq/cube", &["3 dimensions"]),
        ("/daq/table", &["none of the 3 channel(s)", "float32, 4 × 3", "/daq/table[2]"]),
        ("/daq/table[3]", &["none of the 3 channel(s)"]),
        ("/daq/a1[1]", &["none of the 1 channel(s)", "name one: /daq/a1"]),
        ("/daq/never[0]", &["never written"]),
        ("/daq/table[x]", &["no dataset"]),
    ];
    for (source, expected) in cases {
        let message = told(&made, source);
        for part in expected {
            assert!(message.contains(part), "{source}: {message} without {part:?}");
        }
    }
}

#[test]
fn a_cut_file_is_told_as_such() {
    let made = two_sensors();
    let bytes = std::fs::read(&made.path).unwrap();
    std::fs::write(&made.path, &bytes[..bytes.len() / 2]).unwrap();
    let message = told(&made, "/fast/acc[0]");
    assert!(message.contains("not closed or is cut off"), "{message}");
    std::fs::write(&made.path, b"\x89HDF\r\n\x1a\n").unwrap();
    let message = told(&made, "/fast/acc[0]");
    assert!(message.contains("r.h5") && message.contains("copy"), "{message}");
}

#[test]
fn everything_is_listed() {
    let made = two_sensors();
    let listing = list(ReadRequest::silent(&made.path, Limits::default())).unwrap();
    assert_eq!((listing.counts["groups"], listing.counts["datasets"]), (2, 4));
    let sources: Vec<&str> = listing.channels.iter().map(|channel| channel.source.as_str()).collect();
    assert_eq!(sources[..4], ["/fast/acc[0]", "/fast/acc[1]", "/fast/acc[2]", "/fast/time_s"]);
    let fast = &listing.channels[1];
    assert_eq!((fast.kind.as_str(), fast.samples, fast.unit.as_deref()), ("column", Some(2000), Some("g")));
    assert_eq!((fast.range, fast.gaps, fast.start_s), (Some((-1999.0, 0.0)), Some(0), Some(0.0)));
    assert!((fast.sample_rate_hz.unwrap() / 1000.0 - 1.0).abs() < 2e-3);
    assert!(fast.encoding.starts_with("float32, 2000 × 3"), "{}", fast.encoding);
}

#[test]
fn a_shape_that_would_fill_the_memory_is_refused_before_it_is_read() {
    let made = made(|file| {
        let zeros = vec![0.0_f64; 5_000_000];
        let dataset = file.new_dataset_builder().deflate(9).chunk(500_000).with_data(&zeros).create("a")?;
        number(&dataset, "sample_rate_hz", 1e5)
    });
    let cask = cask_file(&["/a"]);
    assert!(read(ReadRequest::silent(&made.path, Limits::default()), &cask).is_ok());
    // 40 MB of samples, and half of the least memory is 32 MiB.
    let refused = read(ReadRequest::silent(&made.path, Limits::of_memory(0)), &cask).unwrap_err();
    assert!(refused.to_string().contains("the limit where reading may take 64 MiB"), "{refused}");
    let listing = list(ReadRequest::silent(&made.path, Limits::of_memory(0))).unwrap();
    assert_eq!((listing.channels[0].samples, listing.channels[0].range), (Some(5_000_000), None));
    // 80 MB from as many kilobytes: a sensor that stands still beside others that do not is in a larger file.
    let bomb = self::made(|file| {
        let zeros = vec![0.0_f64; 10_000_000];
        file.new_dataset_builder().deflate(9).chunk(500_000).with_data(&zeros).create("a").map(drop)
    });
    let refused = read(ReadRequest::silent(&bomb.path, Limits::of_memory(4 << 30)), &cask).unwrap_err();
    assert!(refused.to_string().contains("unpack to"), "{refused}");
}

#[test]
fn groups_in_a_circle_are_listed_to_an_end() {
    let made = made(|file| {
        let group = file.create_group("g")?;
        group.link_hard("/g", "again")?;
        group.link_hard("/g", "and_again")
    });
    assert!(list(ReadRequest::silent(&made.path, Limits::default())).unwrap().counts["groups"] <= 10_000);
}

#[test]
fn data_that_lie_elsewhere_are_refused() {
    let made = made(|file| {
        file.new_dataset::<f64>().shape(100).external("/etc/hostname", 0, 800).create("a").map(drop)
    });
    assert!(told(&made, "/a").contains("in another file, which is not read"), "{}", told(&made, "/a"));
}

type Places<'a> = &'a [(&'a str, &'a str)];

/// 100 samples `/daq/a` with attributes of their own and of their group; sources in words or numbers.
fn nested(samples: &[i16], own: &[(&str, &str)], outer: &[(&str, &str)]) -> Made {
    made(|file| {
        let group = file.create_group("daq")?;
        let data = group.new_dataset_builder().with_data(samples).create("a")?;
        let locations: [&hdf5_metno::Location; 2] = [&data, &group];
        for (location, attributes) in locations.into_iter().zip([own, outer]) {
            for (name, value) in attributes {
                value.parse().map_or_else(|_| text(location, name, value), |x| number(location, name, x))?;
            }
        }
        Ok(())
    })
}

#[test]
fn the_nearest_attribute_is_taken_and_another_one_is_told_or_refused() {
    // Attributes of the dataset and of its group, the samples' value, and the severity of the one finding.
    let rate = ("fs", "10000");
    let rows: [(Places, Places, f64, Option<Severity>); 9] = [
        (&[rate], &[("dt", "0.0001")], 2.0, None),
        (&[rate], &[("sampleRate", "10.5 kHz")], 2.0, Some(Severity::Warning)),
        (&[("fs_khz", "10")], &[("scale", "0.5")], 1.0, None),
        (&[rate, ("scale", "0.5")], &[("scale_factor", "0.25")], 1.0, Some(Severity::Warning)),
        (&[rate, ("scale", "0.5")], &[("scale", "1")], 1.0, Some(Severity::Note)),
        (&[rate, ("offset", "2")], &[("add_offset", "5")], 4.0, Some(Severity::Warning)),
        (&[rate, ("scale", "linear")], &[], 2.0, None),
        (&[rate, ("unit", "g")], &[("units", "m/s^2")], 2.0, Some(Severity::Note)),
        (&[rate, ("scale", "1"), ("binToVoltFactor", "0.5")], &[("binToVoltConstant", "0")], 2.0, None),
    ];
    for (own, outer, expected, severity) in rows {
        let made = nested(&[2; 100], own, outer);
        let channel = &read(ReadRequest::silent(&made.path, Limits::default()), &cask_file(&["/daq/a"]))
            .unwrap()
            .channels[0];
        assert!((values(channel)[99] - expected).abs() < 1e-12, "{own:?} {outer:?}");
        let severities: Vec<Severity> = channel.uniform.issues.iter().map(|issue| issue.severity).collect();
        assert_eq!(severities, Vec::from_iter(severity), "{own:?} {outer:?}: {:?}", channel.uniform.issues);
        let listing = list(ReadRequest::silent(&made.path, Limits::default())).unwrap();
        assert_eq!(listing.channels[0].range, Some((expected, expected)));
        assert_eq!(listing.issues.len(), severities.len(), "{:?}", listing.issues);
    }
    let refused: [(Places, Places, &[&str]); 7] = [
        (&[rate, ("dt", "0.00011")], &[], &["10000 Hz", "9090.909 Hz", "sample_rate_hz = 10000 or"]),
        (&[("fs", "0")], &[rate], &["fs = 0 is no rate", "give sample_rate_hz"]),
        (&[rate, ("scale", "0.5"), ("scale_factor", "0.25")], &[], &["contradict each other", "delete it"]),
        (&[rate, ("scale_factor", "1,05")], &[], &["scale_factor = 1,05", "is no number"]),
        (&[rate, ("unit", "g"), ("units", "m/s^2")], &[], &["unit = g and units = m/s^2 contradict"]),
        (
            &[rate],
            &[("binToVoltFactor", "3e-4")],
            &["counts of the recorder", "binToVoltFactor = 0.0003", "scale = 1"],
        ),
        (&[rate, ("range", "200")], &[], &["range = 200", "raw · scale + offset"]),
    ];
    for (own, outer, parts) in refused {
        let made = nested(&[2; 100], own, outer);
        let message = told(&made, "/daq/a");
        for part in parts {
            assert!(message.contains(part), "{own:?}: {message} without {part}");
        }
        let listing = list(ReadRequest::silent(&made.path, Limits::default())).unwrap();
        assert_eq!(listing.issues.len(), 1, "{own:?}: {:?}", listing.issues);
    }
}

#[test]
fn chunks_far_wider_than_their_dataset_are_refused_and_small_ones_read() {
    let wide = |columns: usize, rows: usize| {
        made(|file| {
            let builder = file.new_dataset::<f32>().deflate(9).chunk((rows, columns)).shape((12, 1..));
            let dataset = builder.create("a")?;
            dataset.resize((12, 1))?;
            number(&dataset, "fs", 1000.0)?;
            let samples: Vec<[f32; 1]> = (0..12_u8).map(|i| [f32::from(i)]).collect();
            dataset.write_raw(samples.as_flattened())
        })
    };
    let limits = Limits::of_memory(64 << 20);
    let read = |made: &Made| {
        read(ReadRequest::silent(&made.path, limits), &cask_file(&["/a"])).map(|raw| raw.channels.len())
    };
    assert_eq!(read(&wide(1000, 12)).unwrap(), 1);
    let told = |made: &Made| read(made).unwrap_err().to_string();
    let one = told(&wide(100_000, 12));
    assert!(one.contains("a chunk of /a is wider than its dataset by more than 1 MiB"), "{one}");
    // Each is small enough, together they unpack to more than such a file can.
    let many = told(&wide(200_000, 1));
    assert!(many.contains("the chunks of /a and of those before unpack to more than"), "{many}");
}

#[test]
fn a_circle_of_groups_is_walked_through_once_and_an_attribute_looked_at_once() {
    let made = made(|file| {
        let dataset = file.new_dataset_builder().with_data(&[1.0_f32, 2.0, 3.0]).create("x")?;
        number(&dataset, "fs", 1000.0)?;
        file.new_attr_builder()
            .with_data(&vec!["g".parse::<VarLenUnicode>().unwrap(); 4000])
            .create("unit")?;
        file.create_group("g")?;
        file.link_hard("g", "h")?;
        file.link_soft("g", "e")?;
        file.link_hard("/", "g/a")?;
        file.link_hard("/", "b")
    });
    let listing = list(ReadRequest::silent(&made.path, Limits::default())).unwrap();
    let sources: Vec<&str> = listing.channels.iter().map(|channel| &channel.source[..]).collect();
    assert_eq!((sources, listing.channels[0].unit.as_deref()), (vec!["/x"], Some("g")));
    let deep =
        read(ReadRequest::silent(&made.path, Limits::default()), &cask_file(&["/b/g/a/h/a/x"])).unwrap();
    assert_eq!(values(&deep.channels[0]), [1.0, 2.0, 3.0]);
}
