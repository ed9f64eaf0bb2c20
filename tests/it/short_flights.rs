//! Contacts that last longer than the flight after them, and flights far longer than the angle lets expect,
//! to results that are right or doubtful.

use dropcheck::data::{DropResult, Verdict};
use dropcheck::lab::in_memory;

/// Angle, °; pulse of L, ms; its k; frequencies of the modes, Hz; damping.
type Drop<'a> = (f64, f64, f64, &'a [f64], f64);

/// Drawn at random from angles of 3 to 9°, pulses of 6 to 20 ms and modes from 28 Hz on; each once passed
/// with a speed 10 to 15 % off.
const DROPS: [Drop; 6] = [
    (3.070, 12.504, 0.699, &[48.315], 0.042),
    (4.296, 15.353, 0.669, &[35.766], 0.008),
    (4.729, 16.500, 0.861, &[31.809], 0.045),
    (4.042, 16.504, 0.767, &[52.127], 0.041),
    (4.145, 12.665, 0.211, &[36.147, 99.071], 0.021),
    (5.945, 19.429, 0.923, &[44.760, 116.892], 0.030),
];

/// The scene of the fixtures with this drop in it.
fn scene_text((angle_deg, pulse_ms, k, modes, damping): Drop) -> String {
    use std::fmt::Write;
    let mut text = format!(
        "name = \"short\"\nseed = 1\n[cask]\nname = \"ANF-18\"\nmass_kg = 4466.0\nlength_m = 5.512\n\
         height_m = 0.792\n\
         [drop]\nheight_m = 9.0\nangle_deg = {angle_deg}\n[contact]\nfriction = \"rough\"\n\
         [first_end]\npulse_ms = {pulse_ms}\nk = {k}\n[second_end]\npulse_ms = 4.0\nk = 0.3\n\
         [recording]\nbefore_s = 0.1\nafter_s = 0.05\n"
    );
    for (order, frequency_hz) in (1..).zip(modes) {
        let _ =
            write!(text, "[[mode]]\norder = {order}\nfrequency_hz = {frequency_hz}\ndamping = {damping}\n");
    }
    for (name, end, position_m) in [("A1", "first", 0.15), ("A2", "second", 5.362)] {
        let _ = write!(
            text,
            "[[channel]]\nname = \"{name}\"\nend = \"{end}\"\naxis = \"transverse\"\n\
             position_m = {position_m}\n\
             sample_rate_hz = 25000\nfull_scale = 20000.0\nbits = 16\n\
             anti_alias_hz = 8000.0\nwhite_noise_g = 0.1\n"
        );
    }
    text
}

/// What the analysis makes of a scene, and the true speed, m/s.
fn analysed(text: &str) -> (DropResult, f64) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).expect("a temporary file");
    let made = dropcheck::lab::scene_file::read(&path).expect("a scene");
    let synthetic = dropcheck::lab::synthesise(&made.scene);
    let recording = in_memory::synthetic(&synthetic, &made.stated).expect("a recording");
    let result = dropcheck::analyze(&recording, &made.stated).result;
    (result, synthetic.truth.speed.expect("a slap-down"))
}

#[test]
fn a_contact_that_was_not_over_is_no_flight() {
    for drop in DROPS {
        let (result, truth_m_s) = analysed(&scene_text(drop));
        let is_held =
            result.slap_down.speed.is_some_and(|speed| (speed.value - truth_m_s).abs() <= speed.u95);
        assert!(is_held || result.verdict != Verdict::Pass, "{drop:?}: {:?}", result.slap_down.speed);
    }
}

#[test]
fn a_slap_down_later_than_the_angle_lets_expect_is_found() {
    // A short cask with a wide section hardly turns when it is struck from 58°: R comes down after half a
    // second.
    let text = scene_text((58.0, 3.0, 0.15, &[], 0.02))
        .replace("4466.0\nlength_m = 5.512\nheight_m = 0.792", "2218.0\nlength_m = 1.2246\nheight_m = 0.556")
        .replace("position_m = 5.362", "position_m = 1.075");
    let (result, truth_m_s) = analysed(&text);
    let speed = result.slap_down.speed.expect("a slap-down");
    assert!((speed.value - truth_m_s).abs() <= speed.u95, "{speed:?} for {truth_m_s}");
}
