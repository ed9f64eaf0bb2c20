//! What a cask file gives, and what each slip in one is told.

use super::*;
use crate::data::{Axis, Coupling, End, Source, Unit};
use miette::Diagnostic;

const FULL: &str = r#"
[cask]
name = "ANF-18"
mass_kg = 4466
length_m = 5.512
height_m = 0.792
width_m = 0.960
cog_m = 2.7
inertia_kg_m2 = 11_540.0

[drop]
height_m = 9.0
angle_deg = 15.0
impact_velocity_m_s = 13.3
gravity_m_s2 = 9.80

[contact]
friction = 0.4

[filter]
cfc = 180

[recording]
time = "time_s"

[[channel]]
name = "A1"
end = "first"
axis = "transverse"
source = "/daq/a1.samples"
unit = "mV"
position_m = 0.156
offset_m = -0.1
polarity = -1
sensitivity = 10.0
full_scale = 2000.0
sample_rate_hz = 1e5
time = "/daq/time_s"
coupling = "ac"
time_constant_s = 0.3

[[channel]]
name = "A2"
end = "second"
axis = "axial"
source = { topic = "/a.b", field = "x.y" }
position_m = 5.512
"#;

const SHORT: &str =
    "[cask]\nmass_kg = 120\nlength_m = 2.0\nheight_m = 0\n[drop]\nheight_m = 9\nangle_deg = 30\n";

fn of(text: &str) -> Result<CaskFile, IngestError> {
    checked(Path::new("box.toml"), text, None)
}

/// The whole diagnostic as one line of text: message, label and help.
fn told(error: &IngestError) -> String {
    let labels: Vec<String> =
        error.labels().into_iter().flatten().filter_map(|l| l.label().map(str::to_owned)).collect();
    let help = error.help().map(|help| help.to_string()).unwrap_or_default();
    format!("{error} | {} | {help}", labels.join(" "))
}

#[test]
fn every_key_is_read() {
    let turning = "9.80\nangular_velocity_deg_s = 2\nhorizontal_velocity_m_s = -0.1";
    let calibrated = "0.3\ncalibration_percent = 0.5\nreference = \"amplifier 3\"\nlateral_m = 0.2";
    let full = FULL.replace("gravity_m_s2 = 9.80", &format!("gravity_m_s2 = {turning}"));
    let file =
        of(&full.replace("time_constant_s = 0.3", &format!("time_constant_s = {calibrated}"))).unwrap();
    assert_eq!(file.cask.name, "ANF-18");
    assert_eq!(
        (file.cask.mass_kg, file.cask.cog_m, file.cask.inertia_kg_m2, file.cask.width_m),
        (4466.0, 2.7, 11540.0, Some(0.96))
    );
    assert!(file.cask.is_body && file.drop.impact_velocity_given);
    assert_eq!((file.drop.impact_velocity_m_s, file.drop.gravity_m_s2), (13.3, 9.8));
    assert_eq!(
        (file.drop.angular_velocity_rad_s.to_degrees(), file.drop.horizontal_velocity_m_s),
        (2.0, -0.1)
    );
    assert_eq!((file.contact, file.filter), (Contact::Coulomb(0.4), FilterChoice::Cfc(180.0)));
    assert_eq!(file.time.as_deref(), Some("time_s"));
    let a1 = &file.channels[0];
    assert_eq!((a1.end, a1.axis, a1.polarity, a1.offset_m), (End::First, Axis::Transverse, -1.0, -0.1));
    assert_eq!(a1.unit, Some(Unit::Millivolt { sensitivity_mv_per_g: 10.0 }));
    assert_eq!(a1.coupling, Coupling::Ac { time_constant_s: 0.3 });
    assert_eq!((a1.full_scale, a1.sample_rate_hz), (Some(2000.0), Some(1e5)));
    assert_eq!(a1.time.as_deref(), Some("/daq/time_s"));
    assert_eq!((a1.calibration, a1.lateral_m), (Some(0.005), 0.2));
    assert_eq!(a1.reference.as_deref(), Some("amplifier 3"));
    let a2 = &file.channels[1];
    assert_eq!(a2.source, Source::TopicField { topic: "/a.b".into(), field: "x.y".into(), channel: None });
    assert_eq!((a2.unit, a2.coupling, a2.polarity), (None, Coupling::Dc, 1.0));
    assert!(file.defaults.iter().all(|d| d.starts_with("tolerance.")), "{:?}", file.defaults);
}

#[test]
fn defaults_are_filled_in_and_named() {
    let file = of(SHORT).unwrap();
    assert_eq!((file.cask.name.as_str(), file.cask.height_m, file.cask.cog_m), ("box", 0.0, 1.0));
    // m l² / 12 = 120 · 4 / 12.
    assert!((file.cask.inertia_kg_m2 - 40.0).abs() < 1e-12);
    assert!((file.drop.impact_velocity_m_s - (2.0_f64 * 9.81 * 9.0).sqrt()).abs() < 1e-12);
    assert!((file.drop.angle_rad - std::f64::consts::FRAC_PI_6).abs() < 1e-15);
    assert!(!file.cask.is_body && !file.drop.impact_velocity_given);
    assert_eq!((file.contact, file.filter), (Contact::Unknown, FilterChoice::Auto));
    for key in ["cask.cog_m", "drop.gravity_m_s2", "contact.friction", "filter"] {
        assert!(file.defaults.iter().any(|d| d == key), "{key}: {:?}", file.defaults);
    }
    let error = require_channels(&file, Path::new("test.mcap")).unwrap_err();
    assert!(told(&error).contains("dropcheck init test.mcap"), "{}", told(&error));
}

#[test]
fn slips_in_tables_and_numbers_are_told_with_line_and_remedy() {
    let cases: [(&str, &str, &[&str]); 26] = [
        ("mass_kg = 4466", "mas_kg = 4466", &["line 4", "knows no key mas_kg", "did you mean mass_kg?"]),
        ("mass_kg = 4466", "mass = 4466", &["did you mean mass_kg?"]),
        ("mass_kg = 4466\n", "", &["[cask] has no mass_kg", "mass_kg = 4466.0"]),
        ("mass_kg = 4466", "mass_kg = 4466,0", &["line 4", "decimal comma", "4466.0"]),
        (
            "mass_kg = 4466",
            "mass_kg = \"4466 kg\"",
            &["the text \"4466 kg\"", "write the number alone in kg: 4466"],
        ),
        (
            "mass_kg = 4466",
            "mass_kg = 4466 kg",
            &["unit behind the number", "write the number alone in kg: 4466"],
        ),
        ("mass_kg = 4466", "mass_kg = \"4466\"", &["without quotes: mass_kg = 4466"]),
        ("mass_kg = 4466", "mass_kg = -1", &["mass_kg is -1", "0.001 to 1000000", "in kg"]),
        ("mass_kg = 4466", "mass_kg = nan", &["nan, not a number", "dropcheck init"]),
        (
            "source = { topic = \"/a.b\", field = \"x.y\" }",
            "source = \"/daq/a1.samples\"",
            &["reads the same source as A1"],
        ),
        ("mass_kg = 4466", "mass_kg = inf", &["inf, not a number"]),
        ("mass_kg = 4466", "mass_kg = true", &["true, not a number"]),
        ("mass_kg = 4466", "angle_deg = 4466", &["belongs in [drop]"]),
        ("height_m = 0.792", "height_m = 7.92", &["section is longer than the cask", "0 to 5.512 m"]),
        ("cog_m = 2.7", "cog_m = 5.6", &["centre of gravity lies outside", "from the first end"]),
        ("inertia_kg_m2 = 11_540.0", "inertia_kg_m2 = 0", &["inertia_kg_m2 is 0", "kg m²"]),
        ("angle_deg = 15.0", "angle_deg = 115", &["outside 0 to 90", "0 to 90 degrees"]),
        ("height_m = 9.0", "height_m = 0", &["height_m is 0", "0.001 to 1000"]),
        ("gravity_m_s2 = 9.80", "gravity_m_s2 = -9.8", &["gravity_m_s2 is -9.8"]),
        (
            "friction = 0.4",
            "friction = \"rouhg\"",
            &["friction cannot be \"rouhg\"", "did you mean \"rough\"?"],
        ),
        ("friction = 0.4", "friction = -0.4", &["coefficient of friction of -0.4"]),
        ("cfc = 180", "cfc = 180\ncutoff_hz = 400", &["both cfc and cutoff_hz", "line 22"]),
        ("cfc = 180", "cutoff_hz = 0", &["cutoff_hz is 0", "in Hz"]),
        ("[contact]", "[kontakt]", &["knows no table kontakt", "did you mean contact?"]),
        ("[cask]", "[[cask]]", &["cask is a list, not a table", "write [cask] once"]),
        ("name = \"ANF-18\"", "name = \"ANF-18", &["line 3", "words stand between two quotes"]),
    ];
    check(&cases);
}

#[test]
fn an_inertia_about_an_end_is_refused_and_the_largest_possible_is_not() {
    // l = 2 m, c = 1 m, no section: all mass at the two ends has m c (l − c) = 120 kg m², about an end m l²/3
    // = 160.
    let with = |value: &str| of(&SHORT.replace("[drop]", &format!("inertia_kg_m2 = {value}\n[drop]")));
    assert!((with("120").unwrap().cask.inertia_kg_m2 - 120.0).abs() < 1e-12);
    let message = told(&with("160").unwrap_err());
    for part in ["line 5", "no cask of this mass and size", "at most 120", "not about an end", "has 40"] {
        assert!(message.contains(part), "{message} without {part}");
    }
    // A centre of gravity near an end leaves less: 120 · 0.2 · 1.8 = 43.2; a section adds m h²/4 = 7.5.
    let near = |rest: &str| {
        of(&SHORT.replace("height_m = 0\n", &format!("cog_m = 0.2\ninertia_kg_m2 = 48\nheight_m = {rest}\n")))
    };
    assert!(told(&near("0").unwrap_err()).contains("at most 43.2"));
    assert!(near("0.5").is_ok());
}

#[test]
fn what_no_cask_and_no_drop_can_be_is_refused_with_its_range() {
    // l = 2 m, m = 120 kg, h = 9 m: v0²/(g l) = 9.
    let with = |key: &str, value: &str| {
        let (table, replaced) = match key {
            "mass_kg" | "length_m" => ("[cask]", Some(key)),
            "cog_m" | "inertia_kg_m2" => ("[cask]", None),
            "height_m" => ("[drop]", Some("height_m = 9")),
            _ => ("[drop]", None),
        };
        let kept = SHORT.lines().filter(|line| replaced.is_none_or(|key| !line.starts_with(key)));
        let text = kept.collect::<Vec<_>>().join("\n") + "\n";
        of(&text.replacen(table, &format!("{table}\n{key} = {value}"), 1))
    };
    for (key, least, most, beyond) in [
        ("mass_kg", "1e-3", "1e6", ["9e-4", "1.7e308"]),
        ("length_m", "0.01", "100.0", ["9e-3", "1e300"]),
        ("cog_m", "0.2", "1.8", ["0.19", "1.81"]),
        ("inertia_kg_m2", "0.41", "119.9", ["1e-30", "121.0"]),
        ("height_m", "6e-2", "1000.0", ["1e-4", "1e150"]),
        ("impact_velocity_m_s", "1.0", "200.0", ["0.009", "1e5"]),
        ("gravity_m_s2", "1.0", "2000.0", ["1e-9", "1e4"]),
    ] {
        for value in [least, most] {
            assert!(with(key, value).is_ok(), "{key} = {value}: {}", told(&with(key, value).unwrap_err()));
        }
        for value in beyond {
            let message = told(&with(key, value).unwrap_err());
            assert!(message.contains(key) && message.len() < 500, "{key} = {value}: {message}");
        }
    }
    // ANF-18 in tonnes.
    let anf_18 = |mass: &str| {
        of(&format!(
            "[cask]\nmass_kg = {mass}\nlength_m = 5.512\nheight_m = 0.792\n[drop]\nheight_m = 9\nangle_deg = \
             15\n"
        ))
    };
    assert!(anf_18("4466").is_ok() && told(&anf_18("4.466").unwrap_err()).contains("4.466 t are 4466"));
    // Each for itself is in its range, the two together are no drop.
    let text = SHORT.replace("length_m = 2", "length_m = 100").replace("height_m = 9", "height_m = 0.002");
    assert!(told(&of(&text).unwrap_err()).contains("v0²/(g l) is 4.000e-5"));
}

#[test]
fn more_channels_than_any_test_has_are_refused() {
    let many = |count: usize| {
        let channel = |i| {
            format!(
                "[[channel]]\nname = \"A{i}\"\nend = \"first\"\naxis = \"axial\"\nsource = \
                 \"/a{i}\"\nposition_m = 0\n"
            )
        };
        of(&(0..count).map(channel).fold(SHORT.to_owned(), |text, channel| text + &channel))
    };
    assert_eq!(many(1000).unwrap().channels.len(), 1000);
    let message = told(&many(1001).unwrap_err());
    assert!(message.contains("has 1001 channels") && message.contains("at most 1000"), "{message}");
}

#[test]
fn slips_in_channels_are_told_with_line_and_remedy() {
    let cases: [(&str, &str, &[&str]); 24] = [
        ("name = \"A1\"", "name = “A1”", &["“ is a typographic quote", "straight ones"]),
        ("[contact]", "[first_end]\n[contact]", &["knows no table first_end", "`dropcheck synth`"]),
        ("end = \"first\"", "end = \"frist\"", &["end cannot be \"frist\"", "did you mean \"first\"?"]),
        ("end = \"first\"", "end = first", &["this is not TOML", "words stand between two quotes"]),
        ("end = \"first\"\n", "", &["[[channel]] has no end", "slaps down"]),
        ("axis = \"transverse\"", "axis = \"x\"", &["axis cannot be \"x\"", "\"transverse\" or \"axial\""]),
        ("unit = \"mV\"", "unit = \"m/s2\"", &["unit cannot be \"m/s2\"", "did you mean \"m/s^2\"?"]),
        ("sensitivity = 10.0\n", "", &["needs sensitivity", "calibration sheet"]),
        ("unit = \"mV\"", "unit = \"g\"", &["no meaning without unit", "delete sensitivity"]),
        ("sensitivity = 10.0", "sensitivity = -10.0", &["polarity = -1"]),
        ("position_m = 0.156", "position_m = 156", &["outside the cask, which is 5.512 m long"]),
        ("position_m = 0.156\n", "", &["has no position_m"]),
        ("polarity = -1", "polarity = 2", &["polarity is 2", "1 or -1"]),
        ("full_scale = 2000.0", "full_scale = 0", &["full_scale is 0"]),
        ("sample_rate_hz = 1e5", "sample_rate_hz = 0", &["sample_rate_hz is 0", "in Hz"]),
        ("time_constant_s = 0.3\n", "", &["needs time_constant_s", "corner"]),
        ("coupling = \"ac\"\n", "", &["no meaning without coupling"]),
        ("name = \"A2\"", "name = \"A1\"", &["two channels are named \"A1\", the first on line 27"]),
        ("source = \"/daq/a1.samples\"\n", "", &["has no source", "dropcheck inspect"]),
        ("source = \"/daq/a1.samples\"", "source = 3", &["source is the number 3", "quotes"]),
        ("field = \"x.y\"", "feld = \"x.y\"", &["knows no key feld", "did you mean field?"]),
        ("field = \"x.y\" }", "}", &["has no field"]),
        ("name = \"A2\"", "name = \"\"", &["name is empty"]),
        ("full_scale", "fullscale", &["did you mean full_scale?"]),
    ];
    check(&cases);
    let single = format!("{SHORT}[channel]\nname = \"A1\"\n");
    let message = told(&of(&single).unwrap_err());
    assert!(message.contains("[[channel]], with two brackets"), "{message}");
    let message = told(&of(&format!("{single}[channel]\nname = \"A2\"\n")).unwrap_err());
    assert!(message.contains("[channel] stands more than once"), "{message}");
}

fn check(cases: &[(&str, &str, &[&str])]) {
    for (right, wrong, expected) in cases {
        assert!(FULL.contains(right), "{right}");
        let error = of(&FULL.replacen(right, wrong, 1)).unwrap_err();
        let message = told(&error);
        for part in *expected {
            assert!(message.contains(part), "{wrong:?} gives\n{message}\nwithout {part:?}");
        }
        assert!(message.starts_with("box.toml, line "), "{message}");
    }
}

#[test]
fn files_that_are_none_are_told_apart() {
    let dir = tempfile::tempdir().unwrap();
    let told_of = |name: &str, content: &[u8]| {
        let path = dir.path().join(name);
        std::fs::write(&path, content).unwrap();
        parse(&path).map_err(|error| told(&error))
    };
    for (content, part) in [
        (&b""[..], "is empty"),
        (b"[cask]\nname = \"Beh\xE4lter\"\n", "line 2 is not UTF-8"),
        (b"\x89HDF\r\n\x1a\n", "this is a recording"),
        (b"t;a\n0;1\n", "box.toml, line 1"),
        (
            b"[cask]\nmass_kg = 1\nlength_m = 1\n",
            "[cask] height_m (missing); [drop] height_m (missing), angle_deg (missing)",
        ),
    ] {
        let message = told_of("box.toml", content).unwrap_err();
        assert!(message.contains(part), "{message}");
    }
    let with_mark = [b"\xEF\xBB\xBF", SHORT.as_bytes()].concat();
    let file = told_of("marked.toml", &with_mark).unwrap();
    assert_eq!(file.sha256.len(), 64);
    assert!(told(&parse(dir.path()).unwrap_err()).contains("directory"));
    assert!(told(&parse(&dir.path().join("none.toml")).unwrap_err()).contains("cannot be read"));
}

#[test]
fn a_minus_that_a_report_prints_can_be_pasted() {
    let text = FULL.replace("polarity = -1", "polarity = −1").replace("ANF-18", "ANF −18");
    let file = of(&text).unwrap();
    assert!((file.channels[0].polarity + 1.0).abs() < 1e-12 && file.cask.name == "ANF −18");
    // Later lines keep their number and their place.
    let message = told(&of(&text.replace("time_constant_s = 0.3", "time_constant_s = x")).unwrap_err());
    assert!(message.contains("line 40"), "{message}");
    assert!(told(&of(&FULL.replace("offset_m = -0.1", "offset_m = −")).unwrap_err()).contains("not TOML"));
    // As many as a file may have, in one look at it: a look for each would take minutes.
    let many = format!("{SHORT}[test.more]\na = [{}]\n", "−1, ".repeat(100_000));
    assert!(told(&of(&many).unwrap_err()).contains("not a text or a number"));
}

#[test]
fn a_low_pass_below_one_hertz_and_an_impact_below_ten_microseconds_are_refused() {
    for (key, least, below) in
        [("cutoff_hz", "1.0", "1e-4"), ("cfc", "1", "1e-308"), ("duration_s", "1e-5", "1e-6")]
    {
        let table = if key == "duration_s" { "contact" } else { "filter" };
        let with = |value: &str| of(&format!("{SHORT}[{table}]\n{key} = {value}\n"));
        assert!(with(least).is_ok() && told(&with(below).unwrap_err()).contains("outside"), "{key}");
    }
    assert!(of(&format!("{SHORT}[contact]\nduration_s = 0\n")).is_ok(), "an impulse");
}

#[test]
fn the_line_is_drawn() {
    let error = of(&FULL.replacen("mass_kg", "mas_kg", 1)).unwrap_err();
    let mut drawn = String::new();
    miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor())
        .render_report(&mut drawn, &error)
        .unwrap();
    assert!(drawn.contains("mas_kg = 4466") && drawn.contains("knows no key"), "{drawn}");
}
