//! From set-ups that are wrong in one way each, recorded at rest, to the first cause that `check` names.

use crate::run::{Answer, dropcheck, in_a_browser, root, words};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;

/// End, axis and share of the length of each channel, as far as a rig has them.
const PLACES: [(&str, &str, &str, f64); 8] = [
    ("A1", "first", "transverse", 0.03),
    ("A2", "second", "transverse", 0.97),
    ("B1", "first", "axial", 0.03),
    ("B2", "second", "axial", 0.97),
    ("A3", "first", "transverse", 0.05),
    ("A4", "second", "transverse", 0.95),
    ("A5", "first", "transverse", 0.08),
    ("A6", "second", "transverse", 0.92),
];

/// A cask at rest with transverse channels on both ends and an axial one, as CSV.
#[derive(Clone)]
struct Rig {
    angle_deg: f64,
    length_m: f64,
    lasts_s: f64,
    /// What each channel reads, g, noise and blows included, times this and …
    scales: Vec<f64>,
    /// … this added, g.
    offsets_g: Vec<f64>,
    /// Shares of gravity that each channel feels.
    felt: Vec<f64>,
    noise_g: f64,
    hum_g: f64,
    rate_hz: f64,
    from_s: f64,
    seconds: f64,
    /// Column of which each channel holds the samples.
    columns: Vec<usize>,
    full_scale: f64,
    /// Blows on both ends, how much later the other end feels each, s, and how late A2 is stamped, s.
    wave_s: Option<f64>,
    late_s: f64,
    /// Of the first channel in the cask file.
    lines: &'static str,
}

fn sound() -> Rig {
    rig(3, 15.0)
}

fn rig(count: usize, angle_deg: f64) -> Rig {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let offsets_g = [0.15, -0.2, 0.1, -0.1, 0.05, -0.05, 0.1, 0.2];
    Rig {
        angle_deg,
        length_m: 5.512,
        lasts_s: 0.02,
        scales: vec![1.0; count],
        offsets_g: offsets_g[..count].to_vec(),
        felt: PLACES[..count]
            .iter()
            .map(|(_, _, axis, _)| if *axis == "axial" { sin } else { cos })
            .collect(),
        noise_g: 0.05,
        hum_g: 0.0,
        rate_hz: 10_000.0,
        from_s: 0.0,
        seconds: 1.5,
        columns: (0..count).collect(),
        full_scale: 500.0,
        wave_s: None,
        late_s: 0.0,
        lines: "",
    }
}

/// One of the sound rigs: another cask, angle, number of channels, rate, noise, record each. At these angles
/// 0.4 g tells both axes and an axial sign.
fn variant(i: usize) -> Rig {
    let one = |values: &[f64], step: usize| values[i / step % values.len()];
    Rig {
        length_m: one(&[5.512, 2.4, 4.0, 7.5], 1),
        lasts_s: one(&[0.02, 0.03, 0.012], 2),
        noise_g: one(&[0.05, 0.01, 0.2], 1),
        rate_hz: one(&[10_000.0, 5_000.0, 8_000.0], 3),
        seconds: one(&[1.5, 1.2, 2.0], 2),
        from_s: one(&[0.0, -0.3], 5),
        full_scale: one(&[500.0, 1000.0], 4),
        ..rig(3 + i % 6, one(&[15.0, 18.0, 20.0, 22.0], 2))
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
            let is_second = PLACES[channel].1 == "second";
            let late_s = if channel == 1 { self.late_s } else { 0.0 };
            let [first_s, second_s] = if is_second { [other_s, own_s] } else { [own_s, other_s] };
            blow_g(since_s - 0.6 - first_s - late_s) + blow_g(since_s - 1.1 - second_s - late_s)
        });
        let noise_g = self.noise_g * noise(8 * i + u32::try_from(channel).expect("a small number"));
        self.scales[channel] * (self.felt[channel] + noise_g + struck + hum_g) + self.offsets_g[channel]
    }

    fn table(&self) -> String {
        let names: Vec<&str> = PLACES[..self.columns.len()].iter().map(|place| place.0).collect();
        let mut table = format!("time_s,{}\n", names.join(","));
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
        let count = (self.seconds * self.rate_hz) as u32;
        for i in 0..count {
            let since_s = f64::from(i) / self.rate_hz;
            write!(table, "{:.6}", self.from_s + since_s).expect("room");
            for column in &self.columns {
                write!(table, ",{:.4}", self.reads_g(*column, i, since_s)).expect("room");
            }
            table.push('\n');
        }
        table
    }

    fn cask(&self) -> String {
        let Self { length_m, angle_deg, lasts_s, full_scale, .. } = self;
        let mut cask = format!(
            "[cask]\nname = \"Rig\"\nmass_kg = 4466\nlength_m = {length_m}\nheight_m = 0.792\n[drop]\n\
             height_m = 9\nangle_deg = {angle_deg}\n[contact]\nduration_s = {lasts_s}\n"
        );
        for (i, (name, end, axis, share)) in PLACES[..self.columns.len()].iter().enumerate() {
            writeln!(
                cask,
                "[[channel]]\nname = \"{name}\"\nsource = \"{name}\"\nend = \"{end}\"\naxis = \"{axis}\"\n\
                 unit = \"g\"\nposition_m = {}\n{}{}",
                share * length_m,
                if *full_scale > 0.0 { format!("full_scale = {full_scale}\n") } else { String::new() },
                if i == 0 { self.lines } else { "" }
            )
            .expect("room");
        }
        cask
    }

    fn check(&self, more: &[&str]) -> Answer {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [rest, toml] = ["rest.csv", "cask.toml"].map(|name| folder.path().join(name));
        fs::write(&rest, self.table()).expect("a temporary file");
        fs::write(&toml, self.cask()).expect("a temporary file");
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

/// What is done wrong, whether the rig is struck, and the first cause to be named: code, channel, words.
type Mistake = (&'static str, fn(&mut Rig), bool, [&'static str; 3]);

const MISTAKES: [Mistake; 20] = [
    ("sign", |r| r.scales[0] = -1.0, false, ["polarity", "A1", "sign is turned"]),
    ("sign of an axial one", |r| r.scales[2] = -1.0, false, ["polarity", "B1", "sign is turned"]),
    ("unit", |r| r.scales[1] = 9.806_65, false, ["scale", "A2", "factor between two units"]),
    ("mV for V", |r| r.scales[1] = 1000.0, false, ["scale", "A2", "factor between two units"]),
    ("scale", |r| r.scales[0] = 10.0, false, ["scale", "A1", "times as much"]),
    ("axes", |r| r.columns.swap(0, 2), false, ["scale", "A1", "B1 reads what this one should"]),
    ("axis", |r| r.felt[0] = r.felt[2], false, ["scale", "A1", "other axis"]),
    ("AC called DC", |r| (r.felt[0], r.offsets_g[0]) = (0.0, 0.0), false, ["ac_coupled", "A1", "AC-coupled"]),
    ("offset", |r| r.offsets_g[0] = 3.0, false, ["scale", "A1", "balance the amplifier"]),
    ("dead", |r| (r.scales[1], r.offsets_g[1]) = (0.0, 0.97), false, ["dead_channel", "A2", "one value"]),
    ("copied", |r| r.columns[1] = 0, false, ["copied_channel", "A2", "samples of A1"]),
    ("hum", |r| r.hum_g = 2.0, false, ["hum", "A1", "hums with"]),
    ("noise", |r| r.noise_g = 60.0, false, ["noise", "A1", "noise of A1"]),
    ("range", |r| r.full_scale = 60.0, false, ["clipped", "A1", "range of 60 g"]),
    ("rate", |r| r.rate_hz = 300.0, false, ["low_rate", "A1", "samples"]),
    ("pre-trigger", |r| r.from_s = -0.02, false, ["begins_late", "", "20 ms before zero"]),
    ("no blows", |_| (), true, ["no_impact", "", "0 blows"]),
    (
        "ends",
        |r| {
            r.wave_s = Some(2e-3);
            r.columns.swap(0, 1);
        },
        true,
        ["ends_exchanged", "A1", "second end"],
    ),
    ("clocks", |r| (r.wave_s, r.late_s) = (Some(2e-3), 8e-3), true, ["skew", "A2", "8.0 ms behind A1"]),
    (
        "sign of an AC-coupled one",
        |r| {
            r.lines = "coupling = \"ac\"\ntime_constant_s = 0.3";
            (r.wave_s, r.felt[0], r.scales[0]) = (Some(2e-3), 0.0, -1.0);
        },
        true,
        ["polarity", "A1", "swings down"],
    ),
];

#[test]
fn of_forty_set_ups_with_a_mistake_none_is_ready_and_each_is_told_its_cause_first() {
    for (i, (what, change, taps, [code, channel, words])) in MISTAKES.into_iter().enumerate() {
        for mut rig in [sound(), variant(i)] {
            if taps {
                (rig.seconds, rig.from_s) = (1.5, 0.0);
            }
            change(&mut rig);
            let what = format!("{what} of {} channels at {}°", rig.columns.len(), rig.angle_deg);
            let answer = rig.check(if taps { &["--taps", "--json", "-"] } else { &["--json", "-"] });
            assert_eq!(answer.status, 1, "{what}: {}{}", answer.stdout, answer.stderr);
            let check = answer.json();
            let [own_code, own_channel, message] = first_cause(&check).expect("a cause");
            assert_eq!((&own_code[..], &own_channel[..]), (code, channel), "{what}: {check:#}");
            assert!(message.contains(words), "{what}: {message}");
            assert_eq!(check["ready"], false);
            let mut speaking = check["channels"].as_array().unwrap().iter().filter(|c| c["ready"] == false);
            assert!(channel.is_empty() || speaking.any(|c| c["name"] == channel), "{what}: {check:#}");
        }
    }
}

#[test]
fn every_cause_of_a_channel_is_told() {
    let check = Rig { scales: vec![-1.0, 1.0, 1.0], full_scale: 60.0, ..sound() }.check(&["--json", "-"]);
    let check = check.json();
    let found = check["channels"][0]["findings"].as_array().expect("a list");
    let codes: Vec<&str> = found.iter().filter_map(|finding| finding["code"].as_str()).collect();
    assert_eq!(codes, ["polarity", "clipped"], "{check:#}");
}

/// Forty sound rigs, and whether each is struck.
fn sound_ones() -> Vec<(Rig, bool)> {
    let mut all = vec![
        (sound(), false),
        (Rig { offsets_g: vec![0.0; 3], ..sound() }, false),
        (Rig { scales: vec![-1.0, 1.0, 1.0], lines: "polarity = -1", ..sound() }, false),
        (Rig { hum_g: 0.1, ..sound() }, false),
        (Rig { from_s: -0.5, ..sound() }, false),
        (Rig { seconds: 1.0, ..sound() }, false),
        (Rig { wave_s: Some(2e-3), ..sound() }, true),
        // Blows that reach both ends at once.
        (Rig { wave_s: Some(0.0), ..sound() }, true),
        (
            Rig {
                felt: vec![0.0, sound().felt[1], sound().felt[2]],
                lines: "coupling = \"ac\"\ntime_constant_s = 0.3",
                ..sound()
            },
            false,
        ),
        (Rig { full_scale: 0.0, ..sound() }, false),
    ];
    all.extend((0..30).map(|i| match variant(i) {
        rig if i % 5 == 4 => (Rig { wave_s: Some(1.5e-3), seconds: 1.5, from_s: 0.0, ..rig }, true),
        rig => (rig, false),
    }));
    all
}

#[test]
fn of_forty_sound_set_ups_at_most_one_is_not_ready() {
    let all = sound_ones();
    let told = all
        .iter()
        .map(|(rig, taps)| rig.check(if *taps { &["--taps", "--json", "-"] } else { &["--json", "-"] }));
    let not_ready: Vec<String> = told
        .enumerate()
        .filter(|(_, answer)| answer.status != 0)
        .map(|(i, answer)| format!("{i}: {}{}", answer.stdout, answer.stderr))
        .collect();
    assert_eq!(all.len(), 40);
    assert!(not_ready.len() <= 1, "{}", not_ready.join("\n"));
}

#[test]
fn the_answer_keeps_its_form() {
    let check = sound().check(&["--json", "-"]).json();
    let names = |value: &Value| value.as_object().expect("a table").keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&check), ["channels", "findings", "ready", "schema"]);
    let of_channel = names(&check["channels"][0]);
    assert_eq!(of_channel, ["expected_g", "findings", "name", "noise_g", "reads_g", "ready"]);
    let table = Rig { full_scale: 0.0, ..sound() }.check(&[]).stdout;
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    let is_told = |name: &str| table.lines().any(|line| line.contains(name) && line.contains("ready"));
    assert!(["A1", "A2", "B1"].into_iter().all(is_told), "{table}");
    assert!(table.contains("Range of A1, A2, B1: not stated"), "{table}");
}

/// The folder of a page for eight channels with a photograph, beside what it is made of.
fn page() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rig = rig(8, 15.0);
    fs::write(folder.path().join("rest.csv"), rig.table()).expect("a temporary file");
    fs::copy(root().join("docs/reports/sound.png"), folder.path().join("rig.png")).expect("a photograph");
    let cask = format!("{}[test]\nphotos = [\"rig.png\"]\nsignatures = [\"Test engineer\"]\n", rig.cask());
    fs::write(folder.path().join("cask.toml"), cask).expect("a temporary file");
    let [rest, toml, out] = ["rest.csv", "cask.toml", "out"].map(|name| folder.path().join(name));
    for _ in 0..2 {
        let answer = dropcheck(words!["check", rest, "--cask", toml, "--out", out]);
        assert_eq!(answer.status, 0, "{}{}", answer.stdout, answer.stderr);
        assert!(answer.stdout.contains("check.html"), "{}", answer.stdout);
    }
    folder
}

#[test]
fn the_page_to_sign_holds_what_was_told() {
    let folder = page();
    let page = fs::read_to_string(folder.path().join("out/check.html")).expect("a page");
    for part in
        ["Ready", "A6", "data:image/png", "id=\"setup\"", "Test engineer", "signature", "Not told by rest"]
    {
        assert!(page.contains(part), "{part}");
    }
    let json = fs::read_to_string(folder.path().join("out/check.json")).expect("the findings");
    assert!(json.contains("dropcheck.check/1"));
    fs::write(folder.path().join("out/check.json"), "theirs").expect("a file");
    let [rest, toml, out] = ["rest.csv", "cask.toml", "out"].map(|name| folder.path().join(name));
    let answer = dropcheck(words!["check", rest, "--cask", toml, "--out", out]);
    assert_eq!(answer.status, 2);
    assert!(answer.stderr.contains("not written by dropcheck"), "{}", answer.stderr);
}

#[test]
fn the_page_works_in_a_browser() {
    in_a_browser("check.py", &page().path().join("out/check.html"));
}

#[test]
fn what_cannot_be_told_is_no_answer() {
    let short = Rig { seconds: 0.5, ..sound() }.check(&[]);
    assert_eq!(short.status, 2, "{}", short.stdout);
    assert!(short.stderr.contains("lasts 0.50 s"), "{}", short.stderr);
    let none = dropcheck(words!["check", "none.csv"]);
    assert_eq!(none.status, 2);
}
