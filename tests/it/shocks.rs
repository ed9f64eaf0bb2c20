//! From pulses of known size, and from drops without a slap-down, to the shocks, spectra and low-passes.

use crate::command_line::{Bench, scene_with_axial_channels};
use crate::run::{analyze, dropcheck, findings, fixture, number, read_json, words};
use dropcheck::data::{STANDARD_GRAVITY_M_S2, Signal};
use dropcheck::stages::{pulses, shock_response, vector_pulses};
use serde_json::Value;
use std::f64::consts::PI;
use std::fs;

/// A half sine of a peak in g from a time on for so long, s, at 100 kHz for 0.1 s, in m/s².
fn pulse_of([peak_g, begin_s, length_s]: [f64; 3]) -> Signal {
    let sample = |i: u32| {
        let phase = (f64::from(i) * 1e-5 - begin_s) / length_s;
        if (0.0..1.0).contains(&phase) { peak_g * STANDARD_GRAVITY_M_S2 * (PI * phase).sin() } else { 0.0 }
    };
    Signal { sample_rate_hz: 1e5, force_m_s2: (0..10_000).map(sample).collect(), ..Signal::default() }
}

/// A half sine of 100 g and 11 ms at 20 ms.
fn half_sine() -> Signal {
    pulse_of([100.0, 0.02, 0.011])
}

#[test]
fn a_half_sine_of_100_g_and_11_ms_has_its_peak_length_and_change_of_velocity() {
    // The default low-pass of 4.5 t, CFC 1000, and none.
    for cutoff_hz in [564.0, 1650.0, f64::INFINITY] {
        let pulse = pulses(&[half_sine()], [0.015, 0.04], cutoff_hz)[0].expect("a pulse");
        let off = |value: f64, truth: f64| (value / truth - 1.0).abs();
        let (a_m_s2, t_s) = (100.0 * STANDARD_GRAVITY_M_S2, 0.011);
        assert!(off(pulse.filtered, a_m_s2) < 5e-3 && off(pulse.raw, a_m_s2) < 1e-5, "{pulse:?}");
        // sin passes 0.1 at asin 0.1 of π.
        let length_s = t_s * (1.0 - 2.0 * 0.1_f64.asin() / PI);
        assert!(off(pulse.length.expect("both flanks").length_s, length_s) < 5e-3, "{pulse:?}");
        let [change_m_s, way_m] = pulse.integrals.expect("both feet");
        assert!(off(change_m_s, 2.0 * a_m_s2 * t_s / PI) < 5e-3, "{pulse:?}");
        // A low-pass moves the foot by up to 1 % of the length, in which the velocity gained goes on.
        assert!(off(way_m, a_m_s2 * t_s * t_s / PI) < 0.025, "{pulse:?}");
    }
}

/// The numbers of tests/reference/resultants.tsv are those of numpy and scipy.
#[test]
fn the_shock_of_three_components_is_that_of_their_vector() {
    let components = [[80.0, 0.040, 0.011], [-50.0, 0.042, 0.007], [30.0, 0.039, 0.015]].map(pulse_of);
    let table = include_str!("../reference/resultants.tsv");
    for line in table.lines().skip(1) {
        let row: Vec<f64> = line.split('\t').map(|cell| cell.parse().expect("a number")).collect();
        let found = vector_pulses(&components, 3, [0.03, 0.07], row[0]).pop().flatten().expect("a pulse");
        let [change_m_s, way_m] = found.integrals.expect("both feet");
        let length_s = found.length.expect("both flanks").length_s;
        let all = [found.filtered, found.raw, found.time_s, length_s, change_m_s, way_m];
        // A low-pass works at a lower rate, whose samples lie up to 0.05 ms beside those of the reference.
        for ((own, reference), most) in all.iter().zip(&row[1..]).zip([1e-3, 1e-5, 2e-3, 2e-3, 2e-3, 1e-2]) {
            assert!((own / reference - 1.0).abs() < most, "{line}: {found:?}");
        }
    }
    let mut clipped = components;
    clipped[1].clipped = vec![dropcheck::data::Span { from: 4300, to: 4400 }];
    assert_eq!(vector_pulses(&clipped, 3, [0.03, 0.07], 564.0), [None]);
}

#[test]
fn a_clipped_pulse_has_no_shock() {
    let mut clipped = half_sine();
    clipped.clipped = vec![dropcheck::data::Span { from: 2500, to: 2600 }];
    assert_eq!(pulses(&[clipped], [0.015, 0.04], 564.0), [None]);
}

/// Natural frequencies, Hz, with the response and the pseudo-velocity times s that `pyyeti` 1.4.7 gives:
/// `srs(…, Q=10, stype="absacce" and "pvelo", rolloff="none")`, 2000 samples at 20 kHz.
const FREQUENCIES_HZ: [f64; 6] = [5.0, 20.0, 80.0, 320.0, 1000.0, 2000.0];
const HALF_SINE: [[f64; 6]; 2] = [
    [20.43136, 78.30987, 164.8243, 110.4254, 100.7543, 100.0883],
    [0.647_101_2, 0.620_057, 0.327_044_3, 0.054_895_23, 0.016_034_53, 0.007_964_903],
];
const SAWTOOTH: [[f64; 6]; 2] = [
    [21.74015, 85.6953, 270.4914, 254.5282, 248.2783, 247.9689],
    [0.688_553_4, 0.678_535_3, 0.535_436_1, 0.126_370_4, 0.039_424_12, 0.019_706_8],
];
const RINGING: [[f64; 6]; 2] = [
    [22.86842, 90.91594, 329.2624, 426.0224, 484.7372, 368.8254],
    [0.724_287_6, 0.719_881_2, 0.651_868_4, 0.211_472, 0.076_849_7, 0.029_334_99],
];

#[test]
fn spectra_are_those_of_pyyeti() {
    let sine = |since: f64, long: f64| if since < long { (PI * since / long).sin() } else { 0.0 };
    let half_sine = |since: f64| 100.0 * sine(since, 220.0);
    let sawtooth = |since: f64| if since < 120.0 { 250.0 * since / 120.0 } else { 0.0 };
    let ringing = |since: f64| {
        let since_s = since / 2e4;
        300.0 * sine(since, 80.0) + 80.0 * (-since_s / 0.004).exp() * (1400.0 * PI * since_s).sin()
    };
    let pulses: [(&dyn Fn(f64) -> f64, _); 3] =
        [(&half_sine, HALF_SINE), (&sawtooth, SAWTOOTH), (&ringing, RINGING)];
    for (pulse, [accelerations, velocities]) in pulses {
        let sample = |i: u32| if i < 200 { 0.0 } else { pulse(f64::from(i - 200)) };
        let samples: Vec<f64> = (0..2000).map(sample).collect();
        // What follows a record that ends early is the oscillators' own.
        for count in [2000, 1600] {
            let found = shock_response(&samples[..count], 2e4, &FREQUENCIES_HZ, 10.0);
            for (i, response) in found.iter().enumerate() {
                let off = |value: f64, truth: f64| (value / truth - 1.0).abs();
                assert!(off(response.acceleration, accelerations[i]) < 1e-5, "{i}: {response:?}");
                assert!(off(response.pseudo_velocity, velocities[i]) < 1e-5, "{i}: {response:?}");
            }
        }
    }
}

fn rows<'a>(result: &'a Value, name: &str) -> &'a Vec<Value> {
    result[name].as_array().unwrap_or_else(|| panic!("{name}: {result}"))
}

#[test]
fn every_channel_has_its_shocks_and_every_low_pass_its_peak() {
    let (recording, cask) = ["anf18-json.mcap", "anf18-json.toml"].map(fixture).into();
    let bench = Bench::new();
    let out = bench.0.path().join("out");
    assert_eq!(dropcheck(words!["analyze", recording, "--cask", cask, "--out", out]).status, 0);
    let text = |name: &str| fs::read_to_string(out.join(name)).expect(name);
    let result: Value = serde_json::from_str(&text("result.json")).expect("a result");
    for channel in rows(&result, "channels") {
        for (event, impact) in ["first", "second"].into_iter().zip(rows(&result, "impacts")) {
            let is_own = |row: &&Value| row["channel"] == channel["name"] && row["event"] == event;
            let shock = rows(&result, "shocks").iter().find(is_own).expect("a shock");
            let own = rows(impact, "channels").iter().find(|peak| peak["name"] == channel["name"]);
            let in_m_s2 = if shock["unit"] == "g" { STANDARD_GRAVITY_M_S2 } else { 1.0 };
            for (name, of_impact, factor) in [
                ("/peak", "/peak_filtered/value", in_m_s2),
                ("/peak_unfiltered", "/peak_raw/value", in_m_s2),
                ("/duration_s", "/pulse_length/value", 1.0),
            ] {
                let stated = number(own.expect("a pulse"), of_impact).expect(of_impact);
                let off = number(shock, name).expect(name) * factor / stated - 1.0;
                assert!(off.abs() < 1e-9, "{name}: {shock} {stated}");
            }
        }
    }
    let filters = rows(&result, "filters");
    let names: Vec<&str> = filters.iter().filter_map(|row| row["name"].as_str()).collect();
    assert_eq!(names, ["SSG-26, 100 Hz", "SSG-26, 200 Hz", "CFC 60", "CFC 180", "CFC 600", "unfiltered"]);
    assert!(
        filters
            .iter()
            .all(|row| number(row, "/peak_g").is_some() && number(row, "/deceleration_g").is_some())
    );
    let page = text("report.html");
    for words in
        ["Shocks of every channel", "upper end of the band", "What another low-pass would make of it"]
    {
        assert!(page.contains(words), "{words}");
    }
}

/// Of a channel that clips, or whose zero shifts, no spectrum is stated: at 5 Hz it would be its velocity's
/// error.
#[test]
fn spectra_are_of_channels_that_return_to_rest() {
    for (name, ending, channels) in [
        ("anf18-json", "mcap", &["A1", "A2"][..]),
        ("damaged-clipped", "h5", &["A2"]),
        ("damaged-zero-shift", "h5", &["A2"]),
    ] {
        let [recording, cask] = [ending, "toml"].map(|ending| fixture(&format!("{name}.{ending}")));
        let bench = Bench::new();
        let out = bench.0.path().join("out");
        dropcheck(words!["analyze", recording, "--cask", cask, "--out", out]);
        let table = fs::read_to_string(out.join("srs.csv")).expect("spectra");
        let mut lines = table.lines();
        assert_eq!(lines.next(), Some("channel,frequency_hz,acceleration,pseudo_velocity_m_s"));
        let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
        let mut named: Vec<&str> = rows.iter().map(|row| row[0]).collect();
        named.dedup();
        assert_eq!(named, channels, "{name}");
        let value = |row: &[&str], i: usize| row[i].parse::<f64>().expect("a number");
        let first = rows.first().expect("a spectrum");
        assert!((value(first, 1) - 5.0).abs() < 1e-6, "{first:?}");
        assert!(rows.iter().all(|row| value(row, 2) > 0.0 && value(row, 3) > 0.0), "{name}");
    }
}

#[test]
fn a_drop_without_a_slap_down_says_what_kind_it_is_and_has_its_shocks() {
    let scene = scene_with_axial_channels();
    for (angle_deg, kind) in
        [("0.1", "Flat drop"), ("1.0", "Flat drop"), ("81.0", "Corner drop"), ("89.0", "End drop")]
    {
        let bench = Bench::new();
        let line = scene.lines().find(|line| line.starts_with("angle_deg")).expect("an angle");
        let wide = scene.replace("full_scale = 2000.0", "full_scale = 6000.0");
        let made = bench.synth("drop", wide.replacen(line, &format!("angle_deg = {angle_deg}"), 1));
        let cask = made.with_extension("toml");
        let result = analyze(&made, &cask).json();
        assert!(result["slap_down"]["speed"].is_null(), "{angle_deg}: {}", result["slap_down"]);
        for name in ["A1", "A2", "B1", "B2"] {
            let own = rows(&result, "shocks").iter().find(|row| row["channel"] == name);
            assert!(own.is_some_and(|row| row["peak"].is_number()), "{angle_deg}: {name} {own:?}");
        }
        if angle_deg == "89.0" {
            // The first end comes down with v0 and goes up with k v0; a part of it is the ringing's.
            let own = rows(&result, "shocks").iter().find(|row| row["channel"] == "B1").expect("B1");
            let change_m_s = number(own, "/velocity_change_m_s").expect("a change of velocity");
            let truth_m_s = 1.55 * (2.0 * 9.81 * 9.0_f64).sqrt() * 89.0_f64.to_radians().sin();
            assert!((change_m_s / truth_m_s - 1.0).abs() < 0.02, "{own}: {truth_m_s}");
            let truth = read_json(&made.with_extension("truth.json"));
            for (of_result, of_truth) in [
                ("/k", "/k"),
                ("/first_impact/rebound_velocity", "/rebound_velocity"),
                ("/first_impact/duration", "/contact_s"),
            ] {
                let [value, u95] =
                    ["value", "u95"].map(|part| number(&result, &format!("{of_result}/{part}")));
                let (value, u95) = value.zip(u95).expect(of_result);
                let off = value - number(&truth, of_truth).expect(of_truth);
                assert!(off.abs() < u95 && u95 < 0.06 * value, "{of_result}: {off} ± {u95}");
            }
            let said = findings(&result);
            assert!(!said.contains("polarity") && !said.contains("not_rigid"), "{said}");
        }
        let screen = dropcheck(words!["analyze", made, "--cask", cask]).stdout;
        let first = screen.lines().take(3).collect::<Vec<_>>().join(" ");
        assert!(first.starts_with(kind) && first.contains(" is expected"), "{angle_deg}: {screen}");
    }
}

#[test]
fn an_end_drop_without_axial_channels_or_of_the_wrong_sign_has_no_k_and_says_why() {
    let scene = scene_with_axial_channels().replacen("angle_deg = 15.0", "angle_deg = 88.5", 1);
    let bench = Bench::new();
    let made = bench.synth("drop", scene.replace("full_scale = 2000.0", "full_scale = 6000.0"));
    let cask = fs::read_to_string(made.with_extension("toml")).expect("a cask file");
    let without = cask.split("[[channel]]").filter(|table| !table.contains("\"axial\"")).collect::<Vec<_>>();
    let reversed = cask.replace("axis = \"axial\"", "axis = \"axial\"\npolarity = -1");
    for (cask, why) in [(without.join("[[channel]]"), "axial channels"), (reversed, "lies outside 0 to 1")] {
        let result = analyze(&made, &bench.put("cask.toml", cask)).json();
        assert!(result["k"].is_null() && result["first_impact"]["rebound_velocity"].is_null(), "{result}");
        let missing = rows(&result, "missing").iter().find(|row| row["quantity"] == "k").expect("k");
        let finding = missing["because"].as_u64().and_then(|at| usize::try_from(at).ok()).expect("a finding");
        let message = result["quality"][finding]["message"].as_str().expect("words");
        assert!(message.contains(why), "{message}");
    }
}
