//! Times without a unit, with one of the CF conventions, and datasets that are no times of their neighbours; samples that count as missing.

use super::super::csv::tests::cask_file;
use super::tests::{Made, made, number, text, told, values};
use super::*;
use crate::data::{IssueCode, Severity};
use hdf5_metno::File;
use hdf5_metno::types::VarLenUnicode;

/// 9000 samples at 20 kHz beside a dataset of their times in units of so many µs from `first` on.
fn timed(name: &str, (unit_us, first): (i64, i64), unit: Option<&str>, rate_hz: Option<f64>) -> Made {
    made(|file| {
        let samples: Vec<f32> = (0..9000_u16).map(f32::from).collect();
        let data = file.new_dataset_builder().with_data(&samples).create("a")?;
        rate_hz.map_or(Ok(()), |rate_hz| number(&data, "fs", rate_hz))?;
        #[allow(clippy::cast_precision_loss, reason = "far below 2^53")]
        let times = if first == 0 {
            let times: Vec<f64> = (0..9000_i64).map(|i| (50 * i) as f64 / unit_us as f64).collect();
            file.new_dataset_builder().with_data(&times).create(name)?
        } else {
            let times: Vec<i64> = (0..9000).map(|i| first + 50 * i / unit_us).collect();
            file.new_dataset_builder().with_data(&times).create(name)?
        };
        unit.map_or(Ok(()), |unit| text(&times, "units", unit))
    })
}

#[track_caller]
fn uniform(made: &Made) -> Uniform {
    let read = read(&made.path, &cask_file(&["/a"]), Limits::default(), &|_| {});
    read.unwrap_or_else(|error| panic!("{error}")).channels.remove(0).uniform
}

#[test]
fn times_say_their_unit_by_epoch_rate_or_convention() {
    for made in [
        timed("time", (1, 1_795_176_000_000_000), None, None),
        timed("time", (1, 0), Some("microseconds since 1970-01-01 00:00:00"), None),
        timed("time", (1000, 0), Some("milliseconds since 2026-11-20T12:00:00Z"), None),
        timed("time", (1_000_000, 0), Some("seconds since 1970-01-01"), None),
        timed("time", (1_000_000, 0), None, None),
        timed("time", (1000, 0), None, Some(2e4)),
        timed("time_ms", (1000, 0), Some("ms"), None),
    ] {
        let uniform = uniform(&made);
        assert!((uniform.sample_rate_hz / 2e4 - 1.0).abs() < 1e-4, "{}", uniform.sample_rate_hz);
        assert!(uniform.issues.is_empty() && uniform.samples.len() == 9000, "{:?}", uniform.issues);
    }
    let nanoseconds = made(|file| {
        let times: Vec<i64> = (0..9000).map(|i| 1_795_176_000_000_000_000 + 50_000 * i).collect();
        file.new_dataset_builder().with_data(&times).create("timestamps")?;
        file.new_dataset_builder().with_data(&vec![1.0_f32; 9000]).create("a").map(drop)
    });
    assert!((uniform(&nanoseconds).sample_rate_hz / 2e4 - 1.0).abs() < 1e-4);
}

#[test]
fn times_without_a_unit_are_asked_about() {
    let made = timed("time", (1000, 0), None, None);
    let message = told(&made, "/a");
    for part in ["the times in /time", "are they in ms", "unit = \"ms\"", "sample_rate_hz = 20000"] {
        assert!(message.contains(part), "{message} without {part}");
    }
    let listing = list(&made.path, Limits::default(), &|_| {}).unwrap();
    assert!(
        listing.issues.iter().any(|issue| issue.message.contains("are they in ms")),
        "{:?}",
        listing.issues
    );
    let mut cask = cask_file(&["/a"]);
    cask.channels[0].sample_rate_hz = Some(2e4);
    let channel = &read(&made.path, &cask, Limits::default(), &|_| {}).unwrap().channels[0];
    assert!(channel.uniform.issues.is_empty(), "{:?}", channel.uniform.issues);
    // An IMU at 400 Hz is read with a question.
    let slow = self::made(|file| {
        let times: Vec<f64> = (0..12_000).map(|i| f64::from(i) / 400.0).collect();
        file.new_dataset_builder().with_data(&times).create("time")?;
        file.new_dataset_builder().with_data(&vec![1.0_f32; 12_000]).create("a").map(drop)
    });
    let issues = uniform(&slow).issues;
    assert!(issues[0].severity == Severity::Warning && issues[0].message.contains("400 Hz"), "{issues:?}");
    let message = told(&timed("time_ms", (1000, 0), Some("s"), None), "/a");
    assert!(message.contains("by its name") && message.contains("sample_rate_hz"), "{message}");
}

/// 9000 samples at 20 kHz by `time_s`, beside another dataset of times.
fn beside(name: &str, others: &[f64], rate_hz: Option<f64>) -> Made {
    made(|file| {
        let times: Vec<f64> = (0..9000).map(|i| f64::from(i) / 2e4).collect();
        file.new_dataset_builder().with_data(&times).create("time_s")?;
        file.new_dataset_builder().with_data(others).create(name)?;
        let data = file.new_dataset_builder().with_data(&vec![1.0_f32; 9000]).create("a")?;
        rate_hz.map_or(Ok(()), |rate_hz| number(&data, "fs", rate_hz))
    })
}

#[test]
fn two_datasets_of_times_that_contradict_each_other_are_told() {
    let times = |hz: f64| -> Vec<f64> { (0..9000).map(|i| f64::from(i) / hz).collect() };
    let [issue] = &uniform(&beside("t", &times(1.99e4), None)).issues[..] else { panic!() };
    let says = "/time_s and /t contradict each other: from the first row to the last they say 0.44995 s and 0.45221 s";
    assert!(issue.severity == Severity::Warning && issue.code == IssueCode::Clock, "{issue:?}");
    assert!(issue.message.contains(says), "{}", issue.message);
    let listing = list(&beside("t", &times(1.99e4), None).path, Limits::default(), &|_| {}).unwrap();
    assert!(listing.issues.iter().any(|issue| issue.message.contains("contradict")), "{:?}", listing.issues);
    // By over 1 % nothing is taken, unless something decides.
    let far: Vec<f64> = times(1.9e4).iter().map(|t| 1.7e18 + 1e9 * t).collect();
    let message = told(&beside("timestamps", &far, None), "/a");
    for part in ["/time_s and /timestamps contradict", "time = \"/timestamps\"", "sample_rate_hz"] {
        assert!(message.contains(part), "{message} without {part}");
    }
    assert!(told(&beside("timestamps", &far, Some(1.9e4)), "/a").contains("contradict"));
    assert_eq!(uniform(&beside("timestamps", &far, Some(2e4))).issues.len(), 1);
    let mut cask = cask_file(&["/a"]);
    cask.time = Some("timestamps".into());
    let channel = read(&beside("timestamps", &far, None).path, &cask, Limits::default(), &|_| {});
    let uniform = channel.unwrap().channels.remove(0).uniform;
    assert!((uniform.sample_rate_hz / 1.9e4 - 1.0).abs() < 1e-4, "{}", uniform.sample_rate_hz);
    assert!(uniform.issues[0].message.contains("/timestamps and /time_s"), "{:?}", uniform.issues);
}

#[test]
fn times_that_bear_each_other_out_and_what_is_no_time_say_nothing() {
    let of = |value: fn(f64) -> f64| -> Vec<f64> { (0..9000).map(|i| value(f64::from(i) / 2e4)).collect() };
    for (name, others) in [
        ("t", of(|t| t + 100.0)),
        ("time_ms", of(|t| 1e3 * t)),
        ("timestamps", of(|t| 1.7e18 + 1e9 * t)),
        // A computer's clock that was cut, one that counts rows, ticks, and a temperature.
        ("timestamps", of(|t| ((t + 0.0003) * 200.0).floor() / 200.0)),
        ("t", of(|t| (2e4 * t).round())),
        ("time", of(|t| 12_345.0 * t)),
        ("t", of(|t| 20.0 + (40.0 * t).sin())),
    ] {
        assert!(uniform(&beside(name, &others, None)).issues.is_empty(), "{name} {:?}", &others[..3]);
    }
}

#[test]
fn datasets_that_are_no_times_of_their_neighbours_are_named() {
    let beside = |fill: &dyn Fn(&File) -> hdf5_metno::Result<()>| {
        let made = made(|file| {
            fill(file)?;
            file.new_dataset_builder().with_data(&[1.0_f32; 100]).create("a").map(drop)
        });
        told(&made, "/a")
    };
    let message = beside(&|file| file.new_dataset_builder().with_data(&[0.0; 99]).create("time_s").map(drop));
    assert!(message.contains("/time_s holds 99 times for 100 samples"), "{message}");
    let words: Vec<VarLenUnicode> = vec!["12:00:00".parse().unwrap(); 100];
    let message = beside(&|file| file.new_dataset_builder().with_data(&words).create("time").map(drop));
    assert!(message.contains("/time holds no numbers but text"), "{message}");
    let message =
        beside(&|file| file.new_dataset::<f64>().shape((100, 2)).create("time")?.write_raw(&[0.0; 200]));
    assert!(message.contains("/time has 100 rows and 2 columns"), "{message}");
    assert!(beside(&|_| Ok(())).contains("no dataset of times beside it"));
}

#[test]
fn a_fill_value_is_a_missing_sample() {
    for name in ["_FillValue", "missing_value"] {
        let made = made(|file| {
            let data = file.new_dataset_builder().with_data(&[1_i16, -32_768, 3, 4]).create("a")?;
            number(&data, name, -32_768.0)?;
            number(&data, "scale_factor", 0.5)?;
            number(&data, "fs", 100.0)?;
            let data = file.new_dataset_builder().with_data(&[1.5_f32, -9999.9, 3.5, 4.5]).create("b")?;
            number(&data, name, -9999.9)?;
            number(&data, "fs", 100.0)
        });
        let channels =
            read(&made.path, &cask_file(&["/a", "/b"]), Limits::default(), &|_| {}).unwrap().channels;
        for (channel, last) in channels.iter().zip([2.0, 4.5]) {
            let values = values(channel);
            assert!(values[1].is_nan() && (values[3] - last).abs() < 1e-9, "{name}: {values:?}");
            assert_eq!(channel.uniform.issues[0].code, IssueCode::NonFinite);
        }
    }
}
