//! From set-ups that are wrong in one way each, recorded at rest, to the first cause that `check` names.

use crate::run::{Answer, dropcheck, words};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;

const NAMES: [&str; 3] = ["A1", "A2", "B1"];

/// A cask at rest at 15° with a transverse channel on each end and an axial one, as CSV.
#[derive(Clone)]
struct Rig {
    /// What each channel reads, g, noise and blows included, times this and …
    scales: [f64; 3],
    /// … this added, g.
    offsets_g: [f64; 3],
    /// Shares of gravity that each channel feels.
    felt: [f64; 3],
    noise_g: f64,
    hum_g: f64,
    rate_hz: f64,
    from_s: f64,
    length_s: f64,
    /// Column of which each channel holds the samples.
    columns: [usize; 3],
    full_scale: f64,
    /// Blows on both ends, how much later the other end feels each, s, and how late A2 is stamped, s.
    wave_s: Option<f64>,
    late_s: f64,
    /// Of the first channel in the cask file.
    lines: &'static str,
}

fn sound() -> Rig {
    let (sin, cos) = 15_f64.to_radians().sin_cos();
    Rig {
        scales: [1.0; 3],
        offsets_g: [0.15, -0.2, 0.1],
        felt: [cos, cos, sin],
        noise_g: 0.05,
        hum_g: 0.0,
        rate_hz: 10_000.0,
        from_s: 0.0,
        length_s: 1.5,
        columns: [0, 1, 2],
        full_scale: 500.0,
        wave_s: None,
        late_s: 0.0,
        lines: "",
    }
}

/// Uniform noise of ± 1.
fn noise(i: u32) -> f64 {
    let hash = i.wrapping_mul(2_654_435_761) ^ (i >> 7).wrapping_mul(0x9E37_79B9);
    f64::from(hash.wrapping_mul(1_664_525).wrapping_add(1_013_904_223) >> 8) / f64::from(1_u32 << 23) - 1.0
}

/// A blow that swings up first, and rings for a few ms.
fn blow_g(since_s: f64) -> f64 {
    if since_s < 0.0 { 0.0 } else { 30.0 * (-since_s / 3e-3).exp() * (since_s * 3000.0).sin() }
}

impl Rig {
    fn reads_g(&self, channel: usize, i: u32, since_s: f64) -> f64 {
        let hum_g = self.hum_g * (since_s * 50.0 * std::f64::consts::TAU).sin();
        let struck = self.wave_s.map_or(0.0, |wave_s| {
            let [own_s, other_s] = [0.0, wave_s];
            let is_second = channel == 1;
            let late_s = if is_second { self.late_s } else { 0.0 };
            let [first_s, second_s] = if is_second { [other_s, own_s] } else { [own_s, other_s] };
            blow_g(since_s - 0.6 - first_s - late_s) + blow_g(since_s - 1.1 - second_s - late_s)
        });
        let noise_g = self.noise_g * noise(3 * i + u32::try_from(channel).expect("a small number"));
        self.scales[channel] * (self.felt[channel] + noise_g + struck + hum_g) + self.offsets_g[channel]
    }

    fn check(&self, more: &[&str]) -> Answer {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut table = format!("time_s,{}\n", NAMES.join(","));
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
        let count = (self.length_s * self.rate_hz) as u32;
        for i in 0..count {
            let since_s = f64::from(i) / self.rate_hz;
            let reads = self.columns.map(|column| format!("{:.4}", self.reads_g(column, i, since_s)));
            writeln!(table, "{:.6},{}", self.from_s + since_s, reads.join(",")).expect("room");
        }
        let mut cask = "[cask]\nmass_kg = 4466\nlength_m = 5.512\nheight_m = 0.792\n[drop]\nheight_m = 9\n\
                        angle_deg = 15\n[contact]\nduration_s = 0.02\n"
            .to_owned();
        let places =
            [("first", "transverse", 0.15), ("second", "transverse", 5.362), ("first", "axial", 0.15)];
        for (name, (end, axis, position_m)) in NAMES.iter().zip(places) {
            let lines = if *name == "A1" { self.lines } else { "" };
            writeln!(
                cask,
                "[[channel]]\nname = \"{name}\"\nsource = \"{name}\"\nend = \"{end}\"\naxis = \"{axis}\"\n\
                 unit = \"g\"\nposition_m = {position_m}\nfull_scale = {}\n{lines}",
                self.full_scale
            )
            .expect("room");
        }
        let [rest, toml] = ["rest.csv", "cask.toml"].map(|name| folder.path().join(name));
        fs::write(&rest, table).expect("a temporary file");
        fs::write(&toml, cask).expect("a temporary file");
        let words = words!["check", rest, "--cask", toml];
        dropcheck(words.into_iter().chain(more.iter().map(std::ffi::OsStr::new)))
    }
}

/// The first finding that speaks against the set-up: its code, its channel and its sentence.
fn first_cause(check: &Value) -> Option<[String; 3]> {
    let own = check["channels"].as_array().expect("channels").iter();
    let found = own.flat_map(|channel| channel["findings"].as_array().expect("a list"));
    let mut all = found.chain(check["findings"].as_array().expect("a list"));
    let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let severe = all.find(|finding| finding["severity"] != "note")?;
    Some(["code", "channel", "message"].map(|key| word(&severe[key])))
}

#[test]
fn each_mistake_is_named_first() {
    let with = |change: fn(&mut Rig)| {
        let mut rig = sound();
        change(&mut rig);
        rig
    };
    let blows = |change: fn(&mut Rig)| {
        let mut rig = Rig { wave_s: Some(2e-3), ..sound() };
        change(&mut rig);
        rig
    };
    for (what, rig, taps, [code, channel, words]) in [
        ("sign", with(|r| r.scales[0] = -1.0), false, ["polarity", "A1", "sign is turned"]),
        ("sign of an axial one", with(|r| r.scales[2] = -1.0), false, ["polarity", "B1", "sign is turned"]),
        ("unit", with(|r| r.scales[1] = 9.806_65), false, ["scale", "A2", "factor between two units"]),
        ("mV for V", with(|r| r.scales[1] = 1000.0), false, ["scale", "A2", "factor between two units"]),
        ("scale", with(|r| r.scales[0] = 10.0), false, ["scale", "A1", "times as much"]),
        ("axes", with(|r| r.columns = [2, 1, 0]), false, ["scale", "A1", "B1 reads what this one should"]),
        ("axis", with(|r| r.felt[0] = 0.2588), false, ["scale", "A1", "other axis"]),
        (
            "AC called DC",
            with(|r| (r.felt[0], r.offsets_g[0]) = (0.0, 0.0)),
            false,
            ["ac_coupled", "A1", "AC-coupled"],
        ),
        ("offset", with(|r| r.offsets_g[0] = 3.0), false, ["scale", "A1", "balance the amplifier"]),
        (
            "dead",
            with(|r| (r.scales[1], r.offsets_g[1]) = (0.0, 0.97)),
            false,
            ["dead_channel", "A2", "one value"],
        ),
        ("copied", with(|r| r.columns = [0, 0, 2]), false, ["copied_channel", "A2", "samples of A1"]),
        ("hum", with(|r| r.hum_g = 2.0), false, ["hum", "A1", "hums with"]),
        ("noise", with(|r| r.noise_g = 60.0), false, ["noise", "A1", "noise of A1"]),
        ("range", with(|r| r.full_scale = 100.0), false, ["clipped", "A1", "range of 100 g"]),
        ("rate", with(|r| r.rate_hz = 400.0), false, ["low_rate", "A1", "8.0 samples"]),
        ("pre-trigger", with(|r| r.from_s = -0.02), false, ["begins_late", "", "20 ms before zero"]),
        (
            "no blows",
            with(|r| r.lines = "coupling = \"ac\"\ntime_constant_s = 0.3\nlateral_m = 0.0"),
            true,
            ["no_impact", "", "0 blows"],
        ),
        ("ends", blows(|r| r.columns = [1, 0, 2]), true, ["ends_exchanged", "A1", "second end"]),
        ("clocks", blows(|r| r.late_s = 8e-3), true, ["skew", "A2", "8.0 ms behind A1"]),
        (
            "sign of an AC-coupled one",
            blows(|r| {
                r.lines = "coupling = \"ac\"\ntime_constant_s = 0.3";
                (r.felt[0], r.scales[0]) = (0.0, -1.0);
            }),
            true,
            ["polarity", "A1", "swings down"],
        ),
    ] {
        let answer = rig.check(if taps { &["--taps", "--json", "-"] } else { &["--json", "-"] });
        let check = answer.json();
        assert_eq!(answer.status, 1, "{what}: {check:#}");
        let [own_code, own_channel, message] = first_cause(&check).expect("a cause");
        assert_eq!((&own_code[..], &own_channel[..]), (code, channel), "{what}: {check:#}");
        assert!(message.contains(words), "{what}: {message}");
        assert_eq!(check["ready"], false);
        let speaking = check["channels"].as_array().unwrap().iter().filter(|c| c["ready"] == false);
        assert!(channel.is_empty() || speaking.clone().any(|c| c["name"] == channel), "{what}: {check:#}");
    }
}

#[test]
fn sound_set_ups_are_ready() {
    for (what, rig, more) in [
        ("as it is", sound(), &["--json", "-"][..]),
        ("without offsets", Rig { offsets_g: [0.0; 3], ..sound() }, &["--json", "-"]),
        (
            "turned round, as stated",
            Rig { scales: [-1.0, 1.0, 1.0], lines: "polarity = -1", ..sound() },
            &["--json", "-"],
        ),
        ("little hum", Rig { hum_g: 0.1, ..sound() }, &["--json", "-"]),
        ("with a pre-trigger", Rig { from_s: -0.5, ..sound() }, &["--json", "-"]),
        ("one second", Rig { length_s: 1.0, ..sound() }, &["--json", "-"]),
        ("with blows", Rig { wave_s: Some(2e-3), ..sound() }, &["--taps", "--json", "-"]),
        (
            "with blows that reach both ends at once",
            Rig { wave_s: Some(0.0), ..sound() },
            &["--taps", "--json", "-"],
        ),
        (
            "AC-coupled, as stated",
            Rig {
                felt: [0.0, sound().felt[1], sound().felt[2]],
                lines: "coupling = \"ac\"\ntime_constant_s = 0.3",
                ..sound()
            },
            &["--json", "-"],
        ),
    ] {
        let answer = rig.check(more);
        let check = answer.json();
        assert_eq!((answer.status, &check["ready"]), (0, &Value::Bool(true)), "{what}: {check:#}");
        let names: Vec<&str> = check.as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(names, ["channels", "findings", "ready", "schema"]);
        let of_channel: Vec<&str> =
            check["channels"][0].as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(of_channel, ["expected_g", "findings", "name", "noise_g", "reads_g", "ready"]);
    }
    let table = sound().check(&[]).stdout;
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    assert!(
        NAMES.iter().all(|name| table.lines().any(|line| line.contains(name) && line.contains("ready"))),
        "{table}"
    );
}

#[test]
fn what_cannot_be_told_is_no_answer() {
    let short = Rig { length_s: 0.5, ..sound() }.check(&[]);
    assert_eq!(short.status, 2, "{}", short.stdout);
    assert!(short.stderr.contains("lasts 0.50 s"), "{}", short.stderr);
    let none = dropcheck(words!["check", "none.csv"]);
    assert_eq!(none.status, 2);
}
