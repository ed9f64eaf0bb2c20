//! From pulses of known size, and from drops without a slap-down, to the shocks and low-passes.

use crate::command_line::Bench;
use crate::run::{dropcheck, fixture, number, words};
use dropcheck::data::{STANDARD_GRAVITY_M_S2, Signal};
use dropcheck::stages::pulses;
use serde_json::Value;
use std::f64::consts::PI;
use std::fs;

/// A half sine of 100 g and 11 ms at 20 ms, at 100 kHz, in m/s².
fn half_sine() -> Signal {
    let sample = |i: u32| {
        let phase = (f64::from(i) * 1e-5 - 0.02) / 0.011;
        if (0.0..1.0).contains(&phase) { 100.0 * STANDARD_GRAVITY_M_S2 * (PI * phase).sin() } else { 0.0 }
    };
    Signal { sample_rate_hz: 1e5, force_m_s2: (0..6000).map(sample).collect(), ..Signal::default() }
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

#[test]
fn a_clipped_pulse_has_no_shock() {
    let mut clipped = half_sine();
    clipped.clipped = vec![dropcheck::data::Span { from: 2500, to: 2600 }];
    assert_eq!(pulses(&[clipped], [0.015, 0.04], 564.0), [None]);
}

fn rows<'a>(result: &'a Value, name: &str) -> &'a Vec<Value> {
    result[name].as_array().unwrap_or_else(|| panic!("{name}: {result}"))
}

#[test]
fn every_channel_has_its_shocks_and_every_low_pass_its_peak() {
    let (recording, cask) =
        ["anf18-json.mcap", "anf18-json.toml"].map(|name| fixture(&format!("examples/{name}"))).into();
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
