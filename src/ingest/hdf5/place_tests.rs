//! Attributes of a dataset, its group and the root that state different things.

use super::super::csv::tests::cask_file;
use super::tests::{Made, made, number, text};
use super::*;
use crate::data::{Issue, IssueCode, Severity, Unit};

/// 100 samples `/daq/a` with attributes of their own, of their group and of the root, and times of 10 kHz beside them where wanted.
fn nested(places: [&[(&str, &str)]; 3], has_times: bool) -> Made {
    made(|file| {
        let group = file.create_group("daq")?;
        let data = group.new_dataset_builder().with_data(&[1.0_f32; 100]).create("a")?;
        if has_times {
            let times: Vec<f64> = (0..100).map(|i| f64::from(i) * 1e-4).collect();
            group.new_dataset_builder().with_data(&times).create("time_s")?;
        }
        let locations: [&hdf5_metno::Location; 3] = [&data, &group, file];
        for (location, attributes) in locations.into_iter().zip(places) {
            for (name, value) in attributes {
                value.parse().map_or_else(|_| text(location, name, value), |x| number(location, name, x))?;
            }
        }
        Ok(())
    })
}

fn issues(made: &Made, spec: impl FnOnce(&mut ChannelSpec)) -> Vec<Issue> {
    let mut cask = cask_file(&["/daq/a"]);
    spec(&mut cask.channels[0]);
    read(&made.path, &cask, Limits::default(), &|_| {}).unwrap().channels.remove(0).uniform.issues
}

#[test]
fn a_nearer_rate_is_taken_and_another_one_told() {
    for (own, outer, parts) in [
        (("fs", "9800"), ("fs", "10000"), ["group /daq states fs = 10000", "sample_rate_hz = 9800 or"]),
        (("fs", "9800"), ("dt", "0.0001"), ["dt = 0.0001, which is 10000 Hz", "or sample_rate_hz = 10000"]),
    ] {
        let made = nested([&[own], &[outer], &[]], false);
        let [issue] = &issues(&made, |_| ())[..] else { panic!("{:?}", issues(&made, |_| ())) };
        assert_eq!((issue.code, issue.severity), (IssueCode::Clock, Severity::Warning));
        assert!(parts.iter().all(|part| issue.message.contains(part)), "{}", issue.message);
        let listing = list(&made.path, Limits::default(), &|_| {}).unwrap();
        assert_eq!(listing.issues.len(), 1, "{:?}", listing.issues);
    }
    let far = nested([&[], &[("fs", "5000")], &[("fs", "10000")]], false);
    assert!(issues(&far, |_| ())[0].message.contains("the group / states fs = 10000"));
    // What decides leaves nothing to ask, nor do clocks that are a little apart.
    assert!(issues(&far, |spec| spec.sample_rate_hz = Some(5000.0)).is_empty());
    assert!(issues(&nested([&[("fs", "10000")], &[("fs", "5000")], &[]], true), |_| ()).is_empty());
    assert!(issues(&nested([&[("fs", "10000")], &[("fs", "10005")], &[]], false), |_| ()).is_empty());
}

#[test]
fn a_nearer_scale_is_taken_and_another_one_told() {
    let rate = ("fs", "10000");
    for (own, outer, severity) in [
        (("scale", "0.03"), ("scale_factor", "0.0285"), Severity::Warning),
        (("offset", "2"), ("add_offset", "5"), Severity::Warning),
        (("scale", "1"), ("scale", "0.03"), Severity::Warning),
        // What does nothing is there to be put out of force.
        (("scale", "0.03"), ("scale", "1"), Severity::Note),
        (("offset", "2"), ("offset", "0"), Severity::Note),
        // Nobody takes g for m/s² unseen.
        (("unit", "g"), ("units", "m/s^2"), Severity::Note),
    ] {
        let found = issues(&nested([&[rate, own], &[outer], &[]], false), |_| ());
        let [issue] = &found[..] else { panic!("{own:?}: {found:?}") };
        assert_eq!((issue.code, issue.severity), (IssueCode::Scale, severity), "{own:?}");
        assert!(
            [own.1, outer.1, "/daq"].iter().all(|part| issue.message.contains(part)),
            "{}",
            issue.message
        );
    }
    for (own, outer) in [
        (("scale", "0.03"), ("scale", "0.03")),
        (("unit", "g"), ("unit", "G")),
        (("unit", "g"), ("unit", "SI")),
        (("scale", "0.03"), ("offset", "5")),
    ] {
        assert!(issues(&nested([&[rate, own], &[outer], &[]], false), |_| ()).is_empty(), "{own:?}");
    }
}

#[test]
fn two_units_of_one_place_are_told_unless_the_cask_file_states_one() {
    let made = nested([&[("fs", "10000"), ("unit", "g"), ("units", "m/s^2")], &[], &[]], false);
    let found = issues(&made, |_| ());
    assert!(found[0].severity == Severity::Warning && found[0].message.contains("units = \"m/s^2\""));
    assert!(issues(&made, |spec| spec.unit = Some(Unit::G)).is_empty());
}
