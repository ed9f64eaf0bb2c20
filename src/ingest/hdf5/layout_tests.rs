//! Channels in rows and in fields of records, scaled integers, rates as text, and times by the names that loggers give them.

use super::tests::{Made, made, number, text, told, values};
use super::*;
use crate::data::Severity;
use crate::ingest::csv::tests::cask_file;
use hdf5_metno::H5Type;
use hdf5_metno::types::{FixedAscii, VarLenUnicode};

fn channels(made: &Made, sources: &[&str]) -> Vec<RawChannel> {
    let read = read(&made.path, &cask_file(sources), Limits::default(), &|_| {});
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
    for (channel, (number, scale)) in
        read.iter().zip([(1, 1.0), (2, 1.0), (1, 2.0), (0, 1.0), (0, 1.0), (0, 1.0), (0, 1.0)])
    {
        let expected: Vec<f64> = (0..LONG).map(|i| f64::from(sample(number, i)) * scale).collect();
        assert!(values(channel) == expected, "{}", sources[channel.spec]);
    }
    assert_eq!(values(&read[7]), [19.0, 39.0, 59.0]);
    assert!(
        told(&made, "/plain").contains("name one row: \"/plain[0]\" to \"/plain[2]\""),
        "{}",
        told(&made, "/plain")
    );
    assert!(told(&made, "/plain[3]").contains("3 rows, one a channel"), "{}", told(&made, "/plain[3]"));
    let listing = list(&made.path, Limits::default(), &|_| {}).unwrap();
    let plain: Vec<_> = listing.channels.iter().filter(|c| c.source.starts_with("/plain")).collect();
    assert_eq!(plain.len(), 3);
    assert_eq!((plain[2].samples, plain[2].range), (Some(20_000), Some((-2000.0, 17_999.0))));
}

#[test]
fn scaled_integers_are_in_the_unit_that_is_stated() {
    let made = made(|file| {
        let data = file.new_dataset_builder().with_data(&[-2_i16, 0, 300]).create("a")?;
        number(&data, "scale_factor", 0.5)?;
        number(&data, "add_offset", 1.0)?;
        number(&data, "fs", 100.0)?;
        text(&data, "units", "g")
    });
    let channel = &channels(&made, &["/a"])[0];
    assert_eq!((values(channel), channel.unit.as_deref()), (vec![0.0, 1.0, 151.0], Some("g")));
    let listing = list(&made.path, Limits::default(), &|_| {}).unwrap();
    assert_eq!(listing.channels[0].range, Some((0.0, 151.0)));
    assert!(
        listing.channels[0].encoding.ends_with("value = stored × 0.5 +1"),
        "{}",
        listing.channels[0].encoding
    );
}

#[test]
fn a_scale_that_is_no_number_and_a_rate_that_is_another_are_told() {
    let made = made(|file| {
        for (name, scale) in [("comma", "1,05"), ("unit", "1.05 g"), ("word", "linear")] {
            let data = file.new_dataset_builder().with_data(&[1.0_f32, 2.0, 3.0]).create(name)?;
            number(&data, "fs", 100.0)?;
            text(&data, if name == "word" { "scale" } else { "scale_factor" }, scale)?;
        }
        let data = file.new_dataset_builder().with_data(&[1.0_f32, 2.0, 3.0]).create("rates")?;
        number(&data, "fs", 102.0)?;
        file.new_dataset_builder().with_data(&[0.0, 0.01, 0.02]).create("time").map(|_| ())
    });
    for (source, says) in [("/comma", "scale_factor"), ("/unit", "\"1.05 g\"")] {
        assert!(told(&made, source).contains(says), "{}", told(&made, source));
    }
    assert_eq!(values(&channels(&made, &["/word"])[0]), vec![1.0, 2.0, 3.0]);
    let issues = &channels(&made, &["/rates"])[0].uniform.issues;
    assert!(issues.iter().any(|issue| issue.message.contains("states 102 Hz")), "{issues:?}");
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
        for (channel, factor) in read.iter().zip([0.5, -1.0, -0.5, 1.0]) {
            let expected: Vec<f64> = (0..ROWS).map(|i| factor * f64::from(i)).collect();
            assert!(values(channel) == expected, "{}", sources[channel.spec]);
            assert!(
                (channel.uniform.sample_rate_hz - 1e3).abs() < 1e-6,
                "{}",
                channel.uniform.sample_rate_hz
            );
        }
    }
    for (source, expected) in [
        ("/daq/plain", "fields time_ms, a1, a2, imu, A3 [g] | name one field: \"/daq/plain.time_ms\""),
        ("/daq/plain.a4", "no field a4 of numbers | name one of time_ms, a1"),
        ("/daq/plain.Bemerkung 1.2", "no field Bemerkung 1.2 of numbers"),
        ("/daq/plain.imu", "2 numbers a record | name one: \"/daq/plain.imu[0]\""),
        ("/daq/plain.imu[2]", "there is no [2]"),
        ("/daq/lzf.a1", "h5repack"),
    ] {
        assert!(told(&made, source).contains(expected), "{source}: {}", told(&made, source));
    }
    let listing = list(&made.path, Limits::default(), &|_| {}).unwrap();
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

#[test]
fn rates_are_read_as_loggers_write_them_or_asked_for() {
    for (name, stated) in [
        ("fs", "50 kHz"),
        ("sample_rate", "50000"),
        ("sampling_rate", " 50000.0 Hz"),
        ("sampling_frequency", "0.05 MHz"),
        ("SampleRate", "50 kS/s"),
        ("dt", "20 us"),
        ("wf_increment", "2e-5"),
        ("Sample_Rate", "50000"),
        ("sampleRate", "50 kHz"),
        ("fs_khz", "50"),
        ("dt_us", "20"),
        ("DT_ms", "20 us"),
    ] {
        for is_text in [true, false] {
            let made = made(|file| {
                let data = file.new_dataset_builder().with_data(&[1.0_f32, 2.0, 3.0]).create("a")?;
                if is_text {
                    return text(&data, name, stated);
                }
                let value = match name {
                    "dt" | "wf_increment" => 2e-5,
                    "dt_us" => 20.0,
                    "DT_ms" => 0.02,
                    "fs_khz" => 50.0,
                    _ => 5e4,
                };
                data.new_attr::<f64>().shape(1).create(name)?.write(&[value])
            });
            let rate_hz = channels(&made, &["/a"])[0].uniform.sample_rate_hz;
            assert!((rate_hz / 5e4 - 1.0).abs() < 1e-12, "{name} {is_text}: {rate_hz}");
        }
    }
    for (name, value) in [("fs", f64::NAN), ("fs", 0.0), ("dt", -1.0), ("dt", 0.0)] {
        let made = made(|file| {
            let data = file.new_dataset_builder().with_data(&[1.0_f32, 2.0, 3.0]).create("a")?;
            number(&data, name, value)
        });
        let message = told(&made, "/a");
        assert!(message.contains(&format!("attribute {name} is {value}")), "{message}");
        assert!(message.contains("sample_rate_hz"), "{message}");
        let listing = list(&made.path, Limits::default(), &|_| {}).unwrap();
        assert!(listing.issues[0].message.contains(name), "{:?}", listing.issues);
    }
}

#[test]
fn a_list_of_one_rate_is_that_rate_and_what_only_looks_like_one_is_left_alone() {
    let with = |own: &[(&str, &[f64])], outer: Option<f64>| {
        made(|file| {
            let data = file.new_dataset_builder().with_data(&[1.0_f32, 2.0, 3.0]).create("a")?;
            outer.map_or(Ok(()), |rate_hz| number(file, "fs", rate_hz))?;
            own.iter().try_for_each(|(name, values)| {
                data.new_attr::<f64>().shape(values.len()).create(*name)?.write_raw(values)
            })
        })
    };
    let rate_hz = |made: &Made| channels(made, &["/a"])[0].uniform.sample_rate_hz;
    assert!((rate_hz(&with(&[("fs", &[5e4, 5e4])], None)) - 5e4).abs() < 1e-9);
    // A full scale, a list of others' rates, and what is no rate do not stand in the way of one that is.
    for own in [("FS", &[50.0][..]), ("fs", &[5e4, 4.9e4]), ("Sample_Rate", &[0.0])] {
        let made = with(&[own], Some(5e4));
        assert!((rate_hz(&made) - 5e4).abs() < 1e-9, "{own:?}");
        assert!(channels(&made, &["/a"])[0].uniform.issues.is_empty(), "{own:?}");
    }
    let message = told(&with(&[("fs", &[5e4, 4.9e4])], None), "/a");
    assert!(message.contains("the attribute fs is a list of different values"), "{message}");
    // Spelled as listed goes before.
    let rate_hz = rate_hz(&with(&[("SampleRATE", &[5e4]), ("dt", &[2.001e-5])], None));
    assert!((rate_hz * 2.001e-5 - 1.0).abs() < 1e-9, "{rate_hz}");
}

/// 100 samples with some attributes, and times of 10 kHz beside them where wanted.
fn with_attributes(attributes: &[(&str, &str)], has_times: bool) -> Made {
    made(|file| {
        let data = file.new_dataset_builder().with_data(&[1.0_f32; 100]).create("a")?;
        if has_times {
            let times: Vec<f64> = (0..100).map(|i| f64::from(i) * 1e-4).collect();
            file.new_dataset_builder().with_data(&times).create("time_s")?;
        }
        attributes.iter().try_for_each(|(name, value)| match value.parse() {
            Ok(value) => number(&data, name, value),
            Err(_) => text(&data, name, value),
        })
    })
}

#[test]
fn attributes_that_contradict_each_other_are_told() {
    let issues = |made: &Made, rate_hz: Option<f64>| {
        let mut cask = cask_file(&["/a"]);
        cask.channels[0].sample_rate_hz = rate_hz;
        read(&made.path, &cask, Limits::default(), &|_| {}).unwrap().channels[0].uniform.issues.clone()
    };
    for same in [
        [("sample_rate_hz", "10000"), ("fs", "10 kHz")],
        [("fs", "51200"), ("dt", "1.95e-5")],
        [("fs", "30000"), ("dt", "33.3 us")],
        [("fs", "30000"), ("dt", "0.0000333333333")],
        [("fs", "10000"), ("sampling_rate", "n/a")],
    ] {
        assert!(issues(&with_attributes(&same, false), None).is_empty(), "{same:?}");
    }
    // By half a percent: a warning.
    let slightly = with_attributes(&[("fs", "10000"), ("dt", "0.0001005")], false);
    let [issue] = &issues(&slightly, None)[..] else { panic!() };
    assert!(
        issue.severity == Severity::Warning && issue.message.contains("dt = 0.0001005, which is 9950.249 Hz")
    );
    for (other, hz) in
        [(("fs", "10.5 kHz"), "10500"), (("dt", "105 us"), "9523.81"), (("SampleRate", "1e5"), "100000")]
    {
        let attributes = [("sample_rate_hz", "10000"), other];
        let made = with_attributes(&attributes, false);
        let message = told(&made, "/a");
        for part in
            ["/a", "sample_rate_hz = 10000", other.0, "contradict", &format!("or sample_rate_hz = {hz}")]
        {
            assert!(message.contains(part), "{message} without {part}");
        }
        // What the cask file states is followed, as are times, and both are named.
        for (made, rate_hz) in [(made, Some(1e4)), (with_attributes(&attributes, true), None)] {
            let [issue] = &issues(&made, rate_hz)[..] else { panic!("{:?}", issues(&made, rate_hz)) };
            assert!(
                issue.severity == Severity::Warning && issue.message.contains(other.0),
                "{}",
                issue.message
            );
            let listing = list(&made.path, Limits::default(), &|_| {}).unwrap();
            assert!(listing.issues.iter().any(|issue| issue.message.contains("contradict")));
        }
    }
    for (names, values) in
        [(["scale", "scale_factor"], ["0.5", "0.25"]), (["offset", "add_offset"], ["0", "2"])]
    {
        let both = |other| [("fs", "10000"), (names[0], values[0]), (names[1], other)];
        let message = told(&with_attributes(&both(values[1]), false), "/a");
        let part = format!("{} = {} and {} = {} contradict", names[0], values[0], names[1], values[1]);
        assert!(message.contains(&part) && message.contains("delete one"), "{message}");
        assert!(issues(&with_attributes(&both(values[0]), false), None).is_empty());
    }
}

#[test]
fn times_are_found_by_their_names_and_units() {
    for (name, scale) in [("time_ms", 1e3), ("t_us", 1e6), ("Zeit", 1.0), ("Time", 1.0), ("Zeit in ms", 1e3)]
    {
        let made = made(|file| {
            let times: Vec<f64> = (0..100).map(|i| f64::from(i) * scale * 1e-4).collect();
            file.new_dataset_builder().with_data(&[0.0; 100]).create("timeout_count")?;
            file.new_dataset_builder().with_data(&times).create(name)?;
            let data: Vec<f32> = (0..100_u8).map(f32::from).collect();
            file.new_dataset_builder().with_data(&data).create("a").map(|_| ())
        });
        let rate_hz = channels(&made, &["/a"])[0].uniform.sample_rate_hz;
        assert!((rate_hz / 1e4 - 1.0).abs() < 1e-9, "{name}: {rate_hz}");
    }
}
