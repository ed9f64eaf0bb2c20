//! What a file says of its samples beside them, and whether it is applied or refused.

use super::tests::{Made, made, number, text, told, values};
use super::*;
use crate::data::{RowsOf, Severity};
use crate::ingest::csv::tests::cask_file;
use crate::ingest::{Limits, ReadRequest};
use hdf5_metno::types::VarLenUnicode;
use hdf5_metno::{Group, Location};

/// Attributes by name and value; those of a group whose name begins with a slash are datasets of one value in
/// it.
type Words<'a> = &'a [(&'a str, &'a str)];

const RATE: (&str, &str) = ("fs", "1000");

fn say(place: &Location, words: Words) -> hdf5_metno::Result<()> {
    for (name, value) in words.iter().filter(|(name, _)| !name.starts_with('/')) {
        value.parse().map_or_else(|_| text(place, name, value), |x| number(place, name, x))?;
    }
    Ok(())
}

/// A group with 100 samples `x` of 2, floats or counts, and words on each.
fn group(
    file: &hdf5_metno::File,
    name: &str,
    words: [Words; 2],
    is_float: bool,
) -> hdf5_metno::Result<Group> {
    let group = file.create_group(name)?;
    let new = || group.new_dataset_builder();
    let data = if is_float {
        new().with_data(&[2_f64; 100]).create("x")?
    } else {
        new().with_data(&[2_i16; 100]).create("x")?
    };
    say(&data, words[0])?;
    say(&group, words[1])?;
    for (name, value) in words[1].iter().filter_map(|(name, value)| Some((name.strip_prefix('/')?, value))) {
        // MATLAB writes a number so.
        let single = group.new_dataset::<f64>().shape((1, 1)).create(name)?;
        single.write_raw(&[value.parse::<f64>().unwrap()])?;
    }
    Ok(group)
}

/// The channels, or the refusal; listing has to say the same.
fn of(file: &Made, sources: &[&str]) -> Result<Vec<RawChannel>, String> {
    let read = read(ReadRequest::silent(&file.path, Limits::default()), &cask_file(sources));
    let issues = list(ReadRequest::silent(&file.path, Limits::default())).unwrap().issues;
    let is_told = issues.iter().any(|issue| issue.severity != Severity::Note);
    assert_eq!(read.is_err(), is_told, "{issues:?}");
    read.map(|read| read.channels).map_err(|error| error.to_string())
}

#[test]
fn a_conversion_is_done_or_refused() {
    let rows: [(Words, Words, Result<f64, &str>); 24] = [
        (&[RATE, ("conversion", "0.9"), ("offset", "0")], &[], Ok(1.8)),
        (&[RATE, ("conversion", "0.9"), ("offset", "0.5")], &[("gain", "3")], Ok(2.3)),
        (&[RATE, ("ScaleFactor", "0.5")], &[], Ok(1.0)),
        (&[RATE, ("conversion", "twice")], &[], Err("conversion = twice")),
        (&[RATE, ("gain", "0.9"), ("offset", "0")], &[], Err("to be converted by gain = 0.9")),
        (&[RATE, ("gain", "0.9"), ("offset", "1")], &[], Err("gain = 0.9")),
        (&[RATE], &[("ADC Gain", "0.9")], Err("ADC Gain = 0.9")),
        (&[RATE, ("cal", "1.02")], &[], Err("cal = 1.02")),
        (&[RATE, ("calibration factor", "1.02 g/V")], &[], Err("calibration factor = 1.02 g/V")),
        (&[RATE, ("slope", "2")], &[], Err("slope = 2")),
        (&[RATE, ("gPerBit", "2")], &[], Err("gPerBit = 2")),
        (&[RATE, ("lsb", "2e-3")], &[], Err("lsb = 0.002")),
        (&[RATE, ("gain", "2"), ("scale", "1")], &[], Ok(2.0)),
        (&[RATE, ("gain", "1"), ("factor", "1"), ("offset", "0")], &[("cal", "1")], Ok(2.0)),
        (&[RATE, ("calibration_date", "2026-01-02"), ("calibrated", "2025"), ("local", "3")], &[], Ok(2.0)),
        (&[RATE, ("conversion_date", "2026-01-02"), ("cal_date", "20260102")], &[], Ok(2.0)),
        (&[RATE, ("NI_Scale[0]_Linear_Slope", "0.5")], &[("decimation_factor", "4")], Ok(2.0)),
        (&[RATE], &[("/scale_factor", "0.5")], Ok(1.0)),
        (&[RATE], &[("/offset", "0.5")], Ok(2.5)),
        (&[RATE], &[("/gain", "0.5")], Err("gain = 0.5")),
        (&[], &[("/Fs", "1000")], Ok(2.0)),
        (&[("sample_rate", "1"), ("sample_rate_unit", "kHz")], &[], Ok(2.0)),
        (&[("dt", "1000"), ("dt_unit", "us")], &[], Ok(2.0)),
        (&[("XInc", "1e-3"), ("XUnits", "Second"), ("XOrg", "-0.2")], &[], Ok(2.0)),
    ];
    for (own, outer, expected) in rows {
        for is_float in [false, true] {
            let made = made(|file| group(file, "daq", [own, outer], is_float).map(drop));
            match (of(&made, &["/daq/x"]), expected) {
                (Ok(read), Ok(expected)) => {
                    assert!((values(&read[0])[99] - expected).abs() < 1e-6, "{own:?} {outer:?}");
                    assert!((read[0].uniform.sample_rate_hz - 1000.0).abs() < 1e-9, "{own:?} {outer:?}");
                }
                (Err(message), Err(part)) => assert!(message.contains(part), "{own:?}: {message}"),
                // Any word of a conversion shows that whole numbers are counts.
                (Err(message), Ok(_)) if !is_float => {
                    assert!(message.contains("counts of the recorder"), "{message}");
                }
                (read, expected) => panic!("{own:?} {outer:?} {is_float}: {read:?}, not {expected:?}"),
            }
        }
    }
    let words: Words = &[("sample_rate", "8"), ("sample_rate_units", "furlong")];
    let other = made(|file| group(file, "daq", [words, &[]], true).map(drop));
    assert!(told(&other, "/daq/x").contains("sample_rate = 8 furlong is no rate"));
}

#[test]
fn channels_that_begin_apart_are_laid_apart_or_refused() {
    const NINE: (&str, &str) = ("wf_start_time", "2026-11-22T09:00:00Z");
    let rows: [(Words, Words, Option<f64>); 19] = [
        (&[("starttime", "1600000000000000000")], &[("starttime", "1600000000010000000")], Some(0.01)),
        (&[("start_time", "1600000000000000")], &[("start_time", "1600000000010000")], Some(0.01)),
        (&[("t0", "1600000000000")], &[("t0", "1600000000010")], Some(0.01)),
        (
            &[("starttime", "2026-11-22T10:00:00+01:00")],
            &[("starttime", "2026-11-22T09:00:00.010Z")],
            Some(0.01),
        ),
        (
            &[("wf_start_time", "2026-11-22 09:00:00")],
            &[("wf_start_time", "2026-11-22 09:00:00.010")],
            Some(0.01),
        ),
        (&[NINE, ("wf_start_offset", "0")], &[NINE, ("wf_start_offset", "0.01")], Some(0.01)),
        (&[], &[("t0", "0.01")], Some(0.01)),
        (&[("start_time_ms", "5")], &[("start_time_ms", "15")], Some(0.01)),
        (&[("start_time", "0")], &[("start_time", "10"), ("start_time_unit", "ms")], Some(0.01)),
        (&[("XOrg", "0"), ("XUnits", "Second")], &[("XOrg", "0.01"), ("XUnits", "Second")], Some(0.01)),
        (&[("/starting_time", "0")], &[("/starting_time", "0.01")], Some(0.01)),
        (
            &[("starttime", "9"), ("start_time_s", "0")],
            &[("starttime", "7"), ("start_time_s", "0.01")],
            Some(0.01),
        ),
        (&[("starttime", "10")], &[("starttime", "10")], Some(0.0)),
        (&[("starttime", "Sunday")], &[("starttime", "Sunday")], Some(0.0)),
        (&[("starttime", "1600000000")], &[("starttime", "1600000000")], Some(0.0)),
        (&[("starttime", "0")], &[("starttime", "10")], None),
        (&[("starttime", "Sunday")], &[("starttime", "Monday")], None),
        (&[("starttime", "1600000000")], &[], None),
        (&[], &[("starttime", "1600000000")], None),
    ];
    for (one, two, apart_s) in rows {
        let made = made(|file| {
            number(file, "fs", 1e3)?;
            group(file, "a", [&[], one], true)?;
            group(file, "b", [&[], two], true).map(drop)
        });
        match (of(&made, &["/a/x", "/b/x"]), apart_s) {
            (Ok(read), Some(apart_s)) => {
                let read_s = read[1].uniform.start_s - read[0].uniform.start_s;
                // A double keeps 0.2 µs of a time since 1970.
                assert!((read_s - apart_s).abs() < 1e-6, "{one:?} {two:?}: {read_s}");
            }
            (Err(message), None) => {
                assert!(message.contains("nothing tells how far they are apart"), "{message}");
            }
            (read, _) => panic!("{one:?} {two:?}: {read:?}"),
        }
    }
}

#[test]
fn what_is_no_time_is_none() {
    let noise: Vec<f64> = (0..100_i32).map(|i| f64::from(i * 37 % 100)).collect();
    let rising: Vec<f64> = (0..100_i32).map(|i| f64::from(i) * 1e-3).collect();
    for (times, unit, group, is_time) in [
        (&noise, "", "g", false),
        (&rising, "degC", "g", false),
        (&rising, "s", "g", true),
        (&rising, "", "#refs#", false),
    ] {
        let made = |rate_hz: Option<f64>| {
            made(|file| {
                let group = file.create_group(group)?;
                rate_hz.map_or(Ok(()), |rate_hz| number(&group, "fs", rate_hz))?;
                let t = group.new_dataset_builder().with_data(times).create("t")?;
                text(&t, "unit", unit)?;
                group.new_dataset_builder().with_data(&[2_f64; 100]).create("x").map(drop)
            })
        };
        let source = format!("/{group}/x");
        let beside = made(Some(1100.0));
        let channel = &read(ReadRequest::silent(&beside.path, Limits::default()), &cask_file(&[&source]))
            .unwrap()
            .channels[0];
        let expected_hz = if is_time { 1000.0 } else { 1100.0 };
        assert!((channel.uniform.sample_rate_hz - expected_hz).abs() < 1e-6, "{unit} {group}");
        if !is_time {
            assert!(told(&made(None), &source).contains("nothing says when"), "{unit} {group}");
        }
    }
}

#[test]
fn a_named_column_of_times_and_the_index_of_a_frame_are_the_times() {
    let rows: Vec<f64> = (0..100_i32).flat_map(|i| [f64::from(i), 2.0, 3.0]).collect();
    let made = made(|file| {
        let data = file.new_dataset::<f64>().shape((100, 3)).create("d")?;
        data.write_raw(&rows)?;
        let names = ["time_ms", "a", "b"].map(|name| name.parse::<VarLenUnicode>().unwrap());
        data.new_attr::<VarLenUnicode>().shape(3).create("columns")?.write(&names)?;
        let frame = file.create_group("df")?;
        let index: Vec<f64> = (0..100_i32).map(|i| f64::from(i) * 1e-3).collect();
        frame.new_dataset_builder().with_data(&index).create("axis1")?;
        frame.new_dataset::<f64>().shape((100, 3)).create("block0_values")?.write_raw(&rows)?;
        let letters = file.new_dataset_builder().with_data(&[104_u16, 105]).create("text")?;
        text(&letters, "MATLAB_class", "char")
    });
    for source in ["/d[1]", "/df/block0_values[1]"] {
        let read = &read(ReadRequest::silent(&made.path, Limits::default()), &cask_file(&[source]))
            .unwrap()
            .channels[0];
        assert!((read.uniform.sample_rate_hz - 1000.0).abs() < 1e-6, "{source}");
    }
    assert!(told(&made, "/text").contains("no numbers but text or cells of MATLAB"));
}

#[test]
fn samples_of_several_sensors_are_refused_or_picked() {
    let by = |ids: &dyn Fn(i32) -> i32| {
        let ids: Vec<i32> = (0..100).map(ids).collect();
        made(|file| {
            let times: Vec<f64> = (0..100_i32).map(|i| f64::from(i / 2) * 1e-3).collect();
            let samples: Vec<f64> = (0..100_i32).map(|i| f64::from(i % 2)).collect();
            file.new_dataset_builder().with_data(&ids).create("sensor_id")?;
            file.new_dataset_builder().with_data(&times).create("t")?;
            file.new_dataset_builder().with_data(&samples).create("x").map(drop)
        })
    };
    let rows_of = |made: &Made, is: Option<&str>| {
        let mut cask = cask_file(&["/x"]);
        cask.channels[0].rows = is.map(|is| RowsOf { column: "sensor_id".into(), is: is.into() });
        read(ReadRequest::silent(&made.path, Limits::default()), &cask)
            .map(|mut read| read.channels.remove(0))
    };
    let two = by(&|i| 3 + 4 * (i % 2));
    let message = told(&two, "/x");
    for part in ["by sensor_id = 3, 7", "where = { column = \"sensor_id\", is = \"3\" }"] {
        assert!(message.contains(part), "{message}");
    }
    assert!(rows_of(&two, Some("5")).is_err());
    assert!(rows_of(&by(&|i| i), Some("5")).unwrap_err().to_string().contains("more than 64"));
    for (is, expected) in [("3", 0.0), ("7", 1.0)] {
        let read = rows_of(&two, Some(is)).unwrap();
        assert_eq!(values(&read), vec![expected; 50]);
        assert!((read.uniform.sample_rate_hz - 1000.0).abs() < 1e-6);
    }
    let listing = list(ReadRequest::silent(&two.path, Limits::default())).unwrap();
    let listed: Vec<_> = listing.channels.iter().filter(|listed| listed.source == "/x").collect();
    assert_eq!((listed.len(), listed[1].samples, listed[1].range), (2, Some(50), Some((1.0, 1.0))));
    // One sensor, two that follow one another, and as many as samples.
    for ids in [&(|_| 1) as &dyn Fn(i32) -> i32, &|i| i / 50, &|i| i] {
        let told = rows_of(&by(ids), None).map_or_else(|error| error.to_string(), |_| String::new());
        assert!(!told.contains("by turns"), "{told}");
    }
}

fn read_a1(file: &Made) -> Result<Vec<RawChannel>, String> {
    let read = read(ReadRequest::silent(&file.path, Limits::default()), &cask_file(&["/A1"]));
    read.map(|read| read.channels).map_err(|error| error.to_string())
}

#[test]
fn a_counter_beside_the_samples_places_them_or_contradicts_the_times() {
    let counts: Vec<i32> = (0..600).filter(|row| !(300..304).contains(row)).map(|row| row % 256).collect();
    let file_with = |times: bool| {
        made(|file| {
            let samples = vec![2_f64; counts.len()];
            let data = file.new_dataset_builder().with_data(&samples).create("A1")?;
            number(&data, "fs", 1000.0)?;
            file.new_dataset_builder().with_data(&counts).create("Pkt_seq")?;
            if times {
                let even: Vec<f64> = (0..counts.len()).map(|i| as_f64(i) * 1e-3).collect();
                file.new_dataset_builder().with_data(&even).create("time_s")?;
            }
            Ok(())
        })
    };
    let channels = read_a1(&file_with(false)).unwrap();
    assert_eq!((channels[0].uniform.samples.len(), channels[0].uniform.samples.missing()), (600, 4));
    let refused = read_a1(&file_with(true)).unwrap_err();
    assert!(refused.contains("counts the rows, and 4 of them are missing"), "{refused}");
}

#[test]
fn unsigned_numbers_and_valid_ranges_are_applied_and_factors_are_named() {
    let file = made(|file| {
        let data = file.new_dataset_builder().with_data(&[1_i16, -2, 3, 9999, 5, 6]).create("A1")?;
        number(&data, "fs", 1000.0)?;
        text(&data, "_Unsigned", "true")?;
        number(&data, "valid_max", 65_534.5)?;
        number(&data, "bit_volts", 0.9)?;
        Ok(())
    });
    let channels = read_a1(&file).unwrap();
    assert_eq!(channels[0].factors, ["bit_volts = 0.9"]);
    assert!((channels[0].uniform.samples.get(1) - 65_534.0).abs() < 0.5);
    let file = made(|file| {
        let data = file.new_dataset_builder().with_data(&[1.0, -2.0, 3.0, 9999.0, 5.0, 6.0]).create("A1")?;
        number(&data, "fs", 1000.0)?;
        number(&data, "valid_max", 100.0)
    });
    assert_eq!(read_a1(&file).unwrap()[0].uniform.samples.missing(), 1);
}
