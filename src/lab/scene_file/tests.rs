//! Results of scene files, and the message for each mistake in one.

use super::*;
use crate::data::{Axis, Coupling, End, Unit};
use miette::Diagnostic;

const SHORT: &str = "[cask]\nmass_kg = 120\nlength_m = 2.0\n[drop]\nheight_m = 9\nangle_deg = 30\n";

const FULL: &str = r#"
name = "scene"
seed = 7
[cask]
mass_kg = 4466
length_m = 5.512
[drop]
height_m = 9.0
angle_deg = 15.0
stated_angle_deg = 17.0
stated_height_m = 8.0
guided_percent = 4
roll_deg_s = 90
[contact]
friction = 0.3
falling_friction = 0.1
returning_friction = 0.2
[first_end]
pulse_ms = 5.0
k = 0.55
yield_share = 0.8
lock_up_m = 0.02
lock_up_n_m = 2e7
footprint = 0.5
[[contents]]
mass_kg = 100
position_m = 1
[[contents]]
mass_kg = 100
position_m = 4
gap_m = 0.005
pulse_ms = 3
[second_end]
loading_n_m = 1e7
unloading_n_m = 4e7
yield_n = 1e6
[[mode]]
order = 2
frequency_hz = 62.0
[recording]
rest = true
clock_error_ppm = 50
[[channel]]
name = "A1"
end = "first"
position_m = 0.2
stated_position_m = 0.5
lateral_m = 0.3
stated_lateral_m = 0
whip_g = 2
sample_rate_hz = 1e5
polarity = -1
unit = "m/s^2"
stated_unit = "g"
full_scale = 2000
bits = 16
tilt_deg = 90
cross_axis_percent = 5
resonance_hz = 26e3
resonance_damping = 0.05
coupling = "ac"
stated_coupling = "dc"
time_constant_s = 0.3
offset_g = -1
hum_g = 0.1
dropouts_s = [[0.1, 0.2], [1, 2]]
skew_ms = -3.0
swapped_polarity = true
"#;

fn parse_text(text: &str) -> Result<SceneFile, CaskFileError> {
    parse(Path::new("scene.toml"), text)
}

fn near(value: f64, wanted: f64) {
    // Conversions of units round once or twice.
    assert!((value - wanted).abs() <= 1e-12 * wanted.abs(), "{value}, not {wanted}");
}

#[test]
fn six_lines_make_a_scene() {
    let SceneFile { scene, stated } = parse_text(SHORT).unwrap();
    assert_eq!((scene.name.as_str(), scene.seed, scene.modes.len()), ("scene", 1, 0));
    // The ratio of the stiffnesses of an end is k².
    near(scene.first_end.loading_n_m / scene.first_end.unloading_n_m, 0.25);
    near(scene.second_end.loading_n_m / scene.second_end.unloading_n_m, 0.09);
    assert_eq!(scene.channels.len(), 2);
    near(scene.channels[0].position_m, 0.15);
    near(scene.channels[1].position_m, 1.85);
    assert_eq!(stated.channels[1].end, End::Second);
    near(scene.before_s, 0.1);
}

#[test]
fn a_body_may_be_elastic() {
    let SceneFile { scene, .. } = parse_text(&format!("{SHORT}[body]\nfirst_bending_hz = 120\n")).unwrap();
    assert_eq!(scene.elastic, Some(ElasticBody { first_bending_hz: 120.0, damping: 0.01 }));
}

#[test]
fn every_key_finds_its_place() {
    let SceneFile { scene, stated } = parse_text(FULL).unwrap();
    near(scene.first_end.loading_n_m / scene.first_end.unloading_n_m, 0.3025);
    assert!(scene.first_end.yield_n.is_some());
    near(scene.second_end.unloading_n_m, 4e7);
    assert_eq!(scene.modes[0].order, 2);
    // A fall of 9 m takes 1.3546 s, and 2.06 % more if guides remove 4 % of g; the cask file mentions none.
    near(scene.before_s, (18.0_f64 / 9.81 / 0.96).sqrt() + 0.25);
    near(scene.drop.impact_velocity_m_s, (18.0_f64 * 9.81 * 0.96).sqrt());
    near(stated.drop.impact_velocity_m_s, (18.0_f64 * 9.81).sqrt());
    let extras = &scene.extras;
    assert_eq!((extras.falling_friction, extras.returning_friction), (Some((0.1, 1.0)), Some(0.2)));
    near(extras.roll_rad_s, std::f64::consts::FRAC_PI_2);
    assert_eq!((scene.first_end.lock_up, scene.second_end.lock_up), (Some((0.02, 2e7)), None));
    near(scene.first_end.footprint, 0.5);
    let [usual, other] = extras.contents[..] else { panic!("{extras:?}") };
    assert_eq!((usual.gap_m, usual.play_m, usual.damping_s_m), (0.01, 0.02, 0.2));
    assert_eq!((other.gap_m, other.pulse_s), (0.005, 3e-3));
    near(scene.clock_error, 5e-5);
    near(scene.drop.angle_rad, 15_f64.to_radians());
    near(stated.drop.angle_rad, 17_f64.to_radians());
    near(stated.drop.height_m, 8.0);
    let (channel, said) = (&scene.channels[0], &stated.channels[0]);
    assert_eq!((channel.axis, channel.unit.as_str()), (Axis::Transverse, "m/s^2"));
    near(channel.position_m, 0.2);
    near(said.position_m, 0.5);
    assert_eq!((channel.lateral_m, said.lateral_m), (0.3, 0.0));
    assert_eq!(channel.chain.whip, Some((2.0 * 9.806_65, 15.0)));
    near(said.polarity, -1.0);
    assert_eq!((said.unit, said.coupling), (Some(Unit::G), Coupling::Dc));
    let chain = &channel.chain;
    near(chain.full_scale_m_s2.unwrap(), 2000.0);
    near(chain.tilt_rad, std::f64::consts::FRAC_PI_2);
    near(chain.cross_axis, 0.05);
    assert_eq!(chain.resonance, Some((26e3, 0.05)));
    assert_eq!(chain.ac_time_constant_s, Some(0.3));
    near(chain.offset_m_s2, -9.806_65);
    near(chain.hum.unwrap().1, 50.0);
    assert_eq!(chain.dropouts_s, [(0.1, 0.2), (1.0, 2.0)]);
    near(chain.skew_s, -3e-3);
    assert!(chain.swapped_polarity);
    assert_eq!(chain.bits, Some(16));
}

#[test]
fn every_slip_is_one_message_with_its_key() {
    let cases: [(&str, &str, &[&str]); 31] = [
        ("seed = 7", "seed = -7", &["seed is no whole number"]),
        ("seed = 7", "sed = 7", &["knows no table sed", "did you mean seed?"]),
        ("pulse_ms = 5.0", "pulse_ms = 500", &["pulse_ms is 500", "0.05 to 200"]),
        ("pulse_ms = 5.0", "puls_ms = 5", &["[first_end] knows no key puls_ms", "did you mean pulse_ms?"]),
        ("k = 0.55", "k = 0", &["k is 0, outside"]),
        ("lock_up_m = 0.02\n", "", &["lock_up_n_m", "no meaning without lock_up_m"]),
        ("guided_percent = 4", "guided_percent = 104", &["guided_percent is 104"]),
        ("gap_m = 0.005", "gap_m = 0.5", &["gap_m", "not above play_m"]),
        ("whip_g = 2", "whip_hz = 2", &["no meaning without whip_g"]),
        ("[[mode]]", "[[contents]]\nmass_kg = 1\nposition_m = 1\n[[mode]]", &["the two that are simulated"]),
        ("k = 0.55", "k = 0.55\nloading_n_m = 1e7", &["not beside loading_n_m"]),
        ("unloading_n_m = 4e7", "unloading_n_m = 4e6", &["unloading_n_m", "give energy"]),
        ("loading_n_m = 1e7\nun", "un", &["needs loading_n_m"]),
        ("yield_n = 1e6", "yield_n = \"1e6 N\"", &["yield_n", "not a number"]),
        ("order = 2", "order = 4", &["order is 4"]),
        ("[[mode]]", "[body]\nfirst_bending_hz = 90\n[[mode]]", &["not beside [body]"]),
        ("[[mode]]\norder = 2\nfrequency_hz = 62.0", "[body]", &["[body] has no first_bending_hz"]),
        ("frequency_hz = 62.0", "", &["[[mode]] has no frequency_hz"]),
        ("angle_deg = 15.0\n", "angle_deg = 0\n", &["angle_deg is 0", "0.1 to 89"]),
        ("height_m = 9.0\n", "height_m = 9000\n", &["height_m is 9000, outside 0.001 to 1000"]),
        ("rest = true", "rest = 1", &["rest is the number 1, not true or false"]),
        ("clock_error_ppm = 50", "clock_error_ppm = 1e6", &["clock_error_ppm"]),
        ("position_m = 0.2\n", "position_m = 6\n", &["position_m is 6", "0 to 5.512"]),
        ("sample_rate_hz = 1e5", "sample_rate_hz = 1", &["sample_rate_hz is 1,"]),
        ("unit = \"m/s^2\"", "unit = \"mV\"", &["unit cannot be \"mV\""]),
        ("full_scale = 2000\n", "", &["bits", "no meaning without full_scale"]),
        ("bits = 16", "bits = 64", &["bits is 64"]),
        ("resonance_hz = 26e3\n", "", &["resonance_damping", "no meaning without resonance_hz"]),
        ("[[0.1, 0.2], [1, 2]]", "[[0.2, 0.1]]", &["dropouts_s is no list of spans"]),
        ("offset_g = -1", "offset_g = \"1 g\"", &["offset_g", "not a number"]),
        ("mass_kg = 4466\n", "", &["[cask] has no mass_kg"]),
    ];
    for (right, wrong, expected) in cases {
        assert!(FULL.contains(right), "{right}");
        let error = parse_text(&FULL.replacen(right, wrong, 1)).unwrap_err();
        let help = error.help().map(|help| help.to_string()).unwrap_or_default();
        let labels: Vec<String> =
            error.labels().into_iter().flatten().filter_map(|l| l.label().map(str::to_owned)).collect();
        let message = format!("{error}; {help}; {}", labels.join(" "));
        for part in expected {
            assert!(message.contains(part), "{wrong:?} gives\n{message}\nwithout {part:?}");
        }
        assert!(message.starts_with("scene.toml, line "), "{message}");
    }
    let missing = parse_text("[cask]\nmass_kg = 1\nlength_m = 1\n").unwrap_err().to_string();
    assert!(missing.contains("the scene file has no [drop]"), "{missing}");
    let long = format!(
        "{SHORT}[recording]\nbefore_s = 60\n[[channel]]\nname = \"A\"\nend = \"first\"\nsample_rate_hz = \
         5e6\n"
    );
    assert!(parse_text(&long).unwrap_err().to_string().contains("more than 20000000 samples"));
}
