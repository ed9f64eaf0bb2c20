//! Channels in rows and in fields of records.

use super::tests::{Made, made, number, told, values};
use super::*;
use crate::ingest::csv::tests::cask_file;
use crate::ingest::{Limits, ReadRequest};
use hdf5_metno::H5Type;
use hdf5_metno::types::{FixedAscii, VarLenUnicode};

fn channels(made: &Made, sources: &[&str]) -> Vec<RawChannel> {
    let read = read(ReadRequest::silent(&made.path, Limits::default()), &cask_file(sources));
    read.unwrap_or_else(|error| panic!("{error}")).channels
}

/// Sample `i` of channel `channel`.
fn sample(channel: u16, i: u16) -> f32 {
    f32::from(i) - 1000.0 * f32::from(channel)
}

#[test]
fn rows_are_channels_where_they_are_few_and_long() {
    const LONG: u16 = 20_000;
    let rows = |count: u16| -> Vec<f32> {
        (0..count).flat_map(|channel| (0..LONG).map(move |i| sample(channel, i))).collect()
    };
    let long = usize::from(LONG);
    let made = made(|file| {
        number(file, "fs", 1e4)?;
        file.new_dataset::<f32>().shape((3, long)).create("plain")?.write_raw(&rows(3))?;
        file.new_dataset::<f32>().chunk((2, 700)).shape((3, long)).create("chunked")?.write_raw(&rows(3))?;
        let packed = file.new_dataset::<f32>().chunk((3, 4096)).shuffle().deflate(1).shape((3, long));
        let packed = packed.create("packed")?;
        packed.write_raw(&rows(3))?;
        packed.new_attr::<f64>().shape(3).create("scale")?.write(&[1.0, 2.0, -1.0])?;
        file.new_dataset::<f32>()
            .deflate(1)
            .chunk((1, 999))
            .shape((1, long))
            .create("one")?
            .write_raw(&rows(1))?;
        file.new_dataset::<f32>()
            .deflate(1)
            .chunk((999, 1))
            .shape((long, 1))
            .create("down")?
            .write_raw(&rows(1))?;
        // Fewer than eight samples a row: a table of three samples, as before.
        file.new_dataset::<f32>().shape((3, 20)).create("short")?.write_raw(&rows(1)[..60])
    });
    let sources =
        ["/plain[1]", "/chunked[2]", "/packed[1]", "/one", "/one[0]", "/down", "/down[0]", "/short[19]"];
    let read = channels(&made, &sources);
    let scales = [(1, 1.0), (2, 1.0), (1, 2.0), (0, 1.0), (0, 1.0), (0, 1.0), (0, 1.0)];
    for ((channel, source), (number, scale)) in read.iter().zip(sources).zip(scales) {
        let expected: Vec<f64> = (0..LONG).map(|i| f64::from(sample(number, i)) * scale).collect();
        assert!(values(channel) == expected, "{source}");
    }
    assert_eq!(values(&read[7]), [19.0, 39.0, 59.0]);
    for source in ["/plain", "/plain[3]"] {
        assert!(told(&made, source).contains("name one: /plain[0], /plain[1], /plain[2]"), "{source}");
    }
    let listing = list(ReadRequest::silent(&made.path, Limits::default())).unwrap();
    let plain: Vec<_> = listing.channels.iter().filter(|c| c.source.starts_with("/plain")).collect();
    assert_eq!(plain.len(), 3);
    assert_eq!((plain[2].samples, plain[2].range), (Some(20_000), Some((-2000.0, 17_999.0))));
}

/// A record as tables of a logger hold them: time, two sensors, a list, what is no number.
#[derive(H5Type, Clone)]
#[repr(C)]
struct Row {
    time_ms: f64,
    a1: f32,
    a2: i16,
    imu: [f32; 2],
    #[hdf5(rename = "Bemerkung 1.2")]
    note: FixedAscii<9>,
    #[hdf5(rename = "A3 [g]")]
    a3: f32,
}

#[test]
fn a_field_of_records_is_a_channel() {
    const ROWS: u16 = 30_000;
    let rows: Vec<Row> = (0..ROWS)
        .map(|i| {
            let half = 0.5 * f32::from(i);
            let (time_ms, a2) = (f64::from(i), -i16::try_from(i).unwrap());
            Row { time_ms, a1: half, a2, imu: [half, -half], note: FixedAscii::new(), a3: 2.0 * half }
        })
        .collect();
    let made = made(|file| {
        let group = file.create_group("daq")?;
        let new = || group.new_dataset_builder();
        new().with_data(&rows).create("plain")?;
        new().chunk(4096).with_data(&rows).create("chunked")?;
        new().chunk(4096).deflate(1).with_data(&rows).create("packed")?;
        new().chunk(4096).shuffle().deflate(1).with_data(&rows).create("shuffled")?;
        new().chunk(4096).lzf().with_data(&rows).create("lzf").map(|_| ())
    });
    for table in ["plain", "chunked", "packed", "shuffled"] {
        let sources = [".a1", ".a2", ".imu[1]", ".A3 [g]"].map(|field| format!("/daq/{table}{field}"));
        let read = channels(&made, &sources.each_ref().map(String::as_str));
        for ((channel, source), factor) in read.iter().zip(&sources).zip([0.5, -1.0, -0.5, 1.0]) {
            let expected: Vec<f64> = (0..ROWS).map(|i| factor * f64::from(i)).collect();
            assert!(values(channel) == expected, "{source}");
            assert!(
                (channel.uniform.sample_rate_hz - 1e3).abs() < 1e-6,
                "{}",
                channel.uniform.sample_rate_hz
            );
        }
    }
    for (source, expected) in [
        (
            "/daq/plain",
            "records (time_ms, a1, a2, imu, Bemerkung 1.2, A3 [g]), 30000) | name one: /daq/plain.time_ms, ",
        ),
        ("/daq/plain.a4", "none of the 6 channel(s) in /daq/plain"),
        ("/daq/plain.Bemerkung 1.2", "none of the 6 channel(s)"),
        ("/daq/plain.imu", "name one: /daq/plain.time_ms, /daq/plain.a1, /daq/plain.a2, /daq/plain.imu[0], "),
        ("/daq/plain.imu[2]", "none of the 6 channel(s)"),
        ("/daq/lzf.a1", "h5repack"),
    ] {
        assert!(told(&made, source).contains(expected), "{source}: {}", told(&made, source));
    }
    let listing = list(ReadRequest::silent(&made.path, Limits::default())).unwrap();
    let of_plain: Vec<&str> =
        listing.channels.iter().map(|c| c.source.as_str()).filter(|s| s.contains("plain")).collect();
    assert_eq!(
        of_plain,
        ["time_ms", "a1", "a2", "imu[0]", "imu[1]", "A3 [g]"].map(|field| format!("/daq/plain.{field}"))
    );
}

#[test]
fn records_that_cannot_be_read_are_told() {
    #[derive(H5Type, Clone, Copy)]
    #[repr(C)]
    struct Pair {
        t: f64,
        a: f32,
    }
    #[derive(H5Type, Clone)]
    #[repr(C)]
    struct Noted {
        a: f64,
        note: VarLenUnicode,
    }
    let rows: Vec<Pair> = (0..5000_u16).map(|i| Pair { t: f64::from(i) * 1e-4, a: 1.0 }).collect();
    let made = made(|file| {
        file.new_dataset_builder().chunk(1000).deflate(1).with_data(&rows).create("a")?;
        let noted = vec![Noted { a: 1.0, note: VarLenUnicode::new() }; 9];
        file.new_dataset_builder().with_data(&noted).create("noted")?;
        // The rows behind were never written.
        let partly = file.new_dataset::<Pair>().chunk(1000).shape(5000).create("partly")?;
        partly.write_slice(&rows[..1000], 0..1000)
    });
    assert_eq!(channels(&made, &["/a.a"])[0].uniform.samples.len(), 5000);
    let message = told(&made, "/noted.a");
    assert!(message.contains("records (a, note)") && message.contains("dataset of its own"), "{message}");
    assert!(told(&made, "/partly.a").contains("copy the file"), "{}", told(&made, "/partly.a"));
}
