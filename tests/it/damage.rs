//! From every fixture, damaged in every way that files get damaged, to a result that is right, doubtful or
//! refused.

use crate::iso_mme;
use crate::run::{dropcheck, fixture, number, read_json, truth, words};
use dropcheck::{ingest, report};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use serde_json::Value;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

/// So many damages of each fixture where nobody asks for more by `DROPCHECK_DAMAGES`: a few seconds in all.
const USUAL_DAMAGES: usize = 5;

/// How far beyond its 95 % interval a value under "pass" may lie, in half-widths: 1.5 is 3 standard
/// uncertainties.
const BEYOND: f64 = 1.5;

/// Longer than any sound fixture takes in the slowest profile, a thousandfold: a busy machine is no hang.
const HANG: Duration = Duration::from_mins(5);

/// Recordings that are read within this process; those of the C library are read in one of their own.
const RUST_READ: [&str; 8] = [
    "anf10-plain",
    "anf10-protobuf",
    "anf18-german",
    "anf18-json",
    "damaged-ends-early",
    "damaged-gap",
    "damaged-truncated",
    "esbb-imu",
];
const C_READ: [&str; 3] = ["damaged-clipped", "damaged-zero-shift", "vhlw-rest"];

/// What became of a damaged file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    /// The result is the same to the last digit.
    Same,
    /// Something speaks against the result, and it says what.
    Named,
    /// Another result that passes and holds the truth.
    PassesAndHolds,
    /// A message, and no result.
    Refused,
}

/// A fixture and what is known of it.
struct Subject {
    stem: &'static str,
    bytes: Vec<u8>,
    sound: Value,
    truth: Value,
}

impl Subject {
    fn of(stem: &'static str) -> Self {
        let truth = truth(stem);
        let path = fixture(truth["recording"].as_str().expect("the recording's name"));
        let sound = in_child(&path, stem).expect("a sound fixture");
        Self { stem, bytes: std::fs::read(path).expect("a fixture"), sound, truth }
    }

    /// What became of `bytes` in the file's place; panics with the reason where that must not be.
    #[track_caller]
    fn judged(&self, path: &Path, way: &str, answer: Result<Value, String>) -> Outcome {
        let result = match answer {
            Ok(result) => result,
            Err(message) => {
                assert!(message.contains("damaged") && message.len() > 20, "{way}: {message:?}");
                return Outcome::Refused;
            }
        };
        let kept = path.display();
        if result == self.sound {
            return Outcome::Same;
        }
        if result["verdict"] != "pass" {
            let named = result["quality"].as_array().is_some_and(|issues| !issues.is_empty());
            let compared = result["comparison"]["agrees"] == false;
            assert!(named || compared, "{}, {way}: nothing says why ({kept})", self.stem);
            return Outcome::Named;
        }
        for (pointer, key) in [("/slap_down/speed", "speed"), ("/k", "k")] {
            let expected = number(&self.truth, &format!("/{key}")).expect(key);
            let value = number(&result, &format!("{pointer}/value")).expect("a number under pass");
            let u95 = number(&result, &format!("{pointer}/u95")).expect("an interval");
            let holds = (value - expected).abs() <= BEYOND * u95;
            assert!(holds, "{}, {way}: {key} {value} ± {u95} for {expected} under pass ({kept})", self.stem);
        }
        Outcome::PassesAndHolds
    }
}

/// The result without what names the file, or the message. Its threads are its own: one that waits among
/// those of all tests takes up the work of another test, minutes of it.
fn in_process(path: &Path, stem: &str) -> Result<Value, String> {
    static THREADS: LazyLock<rayon::ThreadPool> =
        LazyLock::new(|| rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads"));
    let begun = Instant::now();
    let answer = THREADS.install(|| {
        catch_unwind(AssertUnwindSafe(|| {
            let file = ingest::cask_file(&fixture(&format!("{stem}.toml"))).expect("a cask file");
            let recording = dropcheck::read(path, &file, &|_| ()).map_err(|error| error.to_string())?;
            let bytes = report::pretty_json(&dropcheck::analyze(&recording, &file).result).expect("JSON");
            Ok(without_input(serde_json::from_slice(&bytes).expect("JSON")))
        }))
    });
    assert!(begun.elapsed() < HANG, "{}: took {:?}", path.display(), begun.elapsed());
    answer.unwrap_or_else(|_| panic!("{} makes the library panic", path.display()))
}

/// The same of the program in a process of its own.
fn in_child(path: &Path, stem: &str) -> Result<Value, String> {
    let begun = Instant::now();
    let answer = crate::run::analyze(path, &fixture(&format!("{stem}.toml")));
    assert!(begun.elapsed() < HANG, "{}: took {:?}", path.display(), begun.elapsed());
    assert!(!answer.stderr.contains("panicked"), "{}: {}", path.display(), answer.stderr);
    match answer.status {
        0 | 1 => Ok(without_input(answer.json())),
        2 => Err(answer.stderr),
        other => panic!("{}: exit status {other}", path.display()),
    }
}

fn without_input(mut result: Value) -> Value {
    if let Some(object) = result.as_object_mut() {
        object.remove("input");
    }
    result
}

/// Places where a record or a line ends.
fn boundaries(bytes: &[u8]) -> Vec<usize> {
    if !bytes.starts_with(b"\x89MCAP") {
        return bytes.iter().enumerate().filter(|(_, b)| **b == b'\n').map(|(at, _)| at + 1).collect();
    }
    let mut at = 8;
    let mut ends = vec![at];
    while let Some(length) = bytes.get(at + 1..at + 9) {
        at += 9 + usize::try_from(u64::from_le_bytes(length.try_into().expect("8 bytes")))
            .unwrap_or(bytes.len());
        if at > bytes.len() {
            break;
        }
        ends.push(at);
    }
    ends
}

/// The file damaged in one of the ways, and the way in words.
fn damaged(sound: &[u8], number: usize, chance: &mut ChaCha8Rng) -> (String, Vec<u8>) {
    let mut bytes = sound.to_vec();
    let at = chance.random_range(0..bytes.len());
    let length = (1 << chance.random_range(0..13)).min(bytes.len() - at);
    let way = match number % 10 {
        0 => {
            bytes.truncate(at);
            format!("cut at {at}")
        }
        1 => {
            let ends = boundaries(sound);
            let end = ends[chance.random_range(0..ends.len())];
            bytes.truncate(end);
            format!("cut at the boundary {end}")
        }
        2 | 3 => {
            bytes[at] ^= 1 << chance.random_range(0..8);
            format!("a bit at {at}")
        }
        4 => {
            for _ in 0..20 {
                let at = chance.random_range(0..bytes.len());
                bytes[at] ^= 1 << chance.random_range(0..8);
            }
            "twenty bits".to_owned()
        }
        5 => {
            bytes[at..at + length].fill(0);
            format!("{length} zeros from {at}")
        }
        6 => {
            bytes.drain(at..at + length);
            format!("{length} bytes lost at {at}")
        }
        7 => {
            let block = bytes[at..at + length].to_vec();
            bytes.splice(at..at, block);
            format!("{length} bytes twice at {at}")
        }
        8 => {
            bytes = with_other_line_ends(sound);
            format!("line ends mangled, {} bytes", bytes.len())
        }
        _ => {
            bytes[at..at + length].iter_mut().for_each(|byte| *byte = chance.random());
            format!("{length} random bytes at {at}")
        }
    };
    (way, bytes)
}

/// As a text-mode copy leaves a file: every line feed with a carriage return, or without one.
fn with_other_line_ends(bytes: &[u8]) -> Vec<u8> {
    let has_returns = bytes.windows(2).any(|pair| pair == b"\r\n");
    let mut out = Vec::with_capacity(bytes.len() + bytes.len() / 8);
    for (at, &byte) in bytes.iter().enumerate() {
        match (byte, has_returns) {
            (b'\r', true) if bytes.get(at + 1) == Some(&b'\n') => {}
            (b'\n', false) => out.extend_from_slice(b"\r\n"),
            _ => out.push(byte),
        }
    }
    out
}

/// Damages every one of `subjects` and counts what became of it.
fn campaign(
    subjects: impl IntoIterator<Item = Subject>,
    each: usize,
    analysed: fn(&Path, &str) -> Result<Value, String>,
) {
    let seed = std::env::var("DROPCHECK_SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(1);
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut counts: BTreeMap<Outcome, usize> = BTreeMap::new();
    let mut defects = Vec::new();
    for subject in subjects {
        let (stem, first) = (subject.stem, chance.random_range(0..10));
        for number in 0..each {
            let (way, bytes) = damaged(&subject.bytes, first + number, &mut chance);
            let path = folder.path().join(format!("damaged-{stem}-{number}"));
            std::fs::write(&path, &bytes).expect("a temporary file");
            let outcome =
                catch_unwind(AssertUnwindSafe(|| subject.judged(&path, &way, analysed(&path, stem))));
            if let Ok(outcome) = outcome {
                *counts.entry(outcome).or_default() += 1;
            } else {
                if let Ok(place) = std::env::var("DROPCHECK_DEFECTS") {
                    std::fs::write(format!("{place}/{stem}-{number}"), bytes).expect("a place for defects");
                }
                defects.push(format!("{stem}, {way}"));
            }
            std::fs::remove_file(&path).expect("a temporary file");
        }
    }
    println!("{counts:?}, {} defects", defects.len());
    assert!(defects.is_empty(), "{defects:#?}");
}

fn asked_for() -> Option<usize> {
    std::env::var("DROPCHECK_DAMAGES").ok().and_then(|text| text.parse().ok())
}

#[test]
fn a_damaged_recording_is_right_doubtful_or_refused() {
    campaign(RUST_READ.map(Subject::of), asked_for().unwrap_or(USUAL_DAMAGES), in_process);
}

#[test]
fn a_damaged_hdf5_file_is_right_doubtful_or_refused() {
    campaign(C_READ.map(Subject::of), asked_for().unwrap_or(USUAL_DAMAGES), in_child);
}

#[test]
fn a_damaged_channel_in_iso_mme_is_right_doubtful_or_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (bytes, path) = (iso_mme::drop_files()[1].1.clone().into_bytes(), folder.path().join("sound"));
    std::fs::write(&path, &bytes).expect("a temporary file");
    let sound = in_iso_mme(&path, "").expect("a sound test");
    let subject = Subject { stem: "anf10-plain", bytes, sound, truth: truth("anf10-plain") };
    campaign([subject], asked_for().unwrap_or(2 * USUAL_DAMAGES), in_iso_mme);
}

/// As [`in_child`] of a test in ISO-MME whose first channel is the file at `path`.
fn in_iso_mme(path: &Path, _: &str) -> Result<Value, String> {
    let folder = path.with_extension("folder");
    let cask = iso_mme::written(&iso_mme::drop_files(), &folder);
    std::fs::copy(path, folder.join("Channel/T1.001")).expect("a temporary file");
    let file = ingest::cask_file(&cask).expect("a cask file");
    let recording = dropcheck::read(&folder, &file, &|_| ()).map_err(|error| error.to_string())?;
    let bytes = report::pretty_json(&dropcheck::analyze(&recording, &file).result).expect("JSON");
    Ok(without_input(serde_json::from_slice(&bytes).expect("JSON")))
}

#[test]
fn an_hdf5_file_that_is_read_for_ever_is_given_up_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut bytes = std::fs::read(fixture("damaged-clipped.h5")).expect("a fixture");
    // The size of the free space of a global heap: with 0 the library stays where it is.
    bytes[3110..3112].fill(0);
    let endless = folder.path().join("a.h5");
    std::fs::write(&endless, bytes).expect("a temporary file");
    let next = folder.path().join("b.h5");
    std::fs::copy(fixture("damaged-clipped.h5"), &next).expect("a temporary file");
    let (cask, out) = (fixture("damaged-clipped.toml"), folder.path().join("out"));
    let answer = dropcheck(words!["batch", endless, next, "--cask", cask, "--out", out]);
    assert_eq!(answer.status, 2, "{}", answer.stderr);
    let table = read_json(&out.join("campaign.json"));
    let error = table["recordings"][0]["error"].as_str().unwrap_or_default();
    assert!(error.contains("more processor time or memory than reading it can need"), "{error}");
    assert!(table["recordings"][1]["verdict"].is_string() && out.join("b/report.html").exists());
    assert!(!out.join("a").exists());
}

#[test]
#[ignore = "cuts at every boundary: .ci/long"]
fn a_recording_cut_at_any_boundary_is_right_doubtful_or_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut counts: BTreeMap<Outcome, usize> = BTreeMap::new();
    for stem in RUST_READ {
        let subject = Subject::of(stem);
        let ends = boundaries(&subject.bytes);
        // Lines of a table are alike: five hundred of them tell what all do.
        for &end in ends.iter().step_by(ends.len().div_ceil(500)) {
            let path = folder.path().join(format!("damaged-{stem}-{end}"));
            std::fs::write(&path, &subject.bytes[..end]).expect("a temporary file");
            let outcome = subject.judged(&path, &format!("cut at {end}"), in_process(&path, stem));
            *counts.entry(outcome).or_default() += 1;
            std::fs::remove_file(&path).expect("a temporary file");
        }
    }
    println!("{counts:?}");
}

#[test]
fn damage_says_so_through_the_program_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("cut.mcap");
    let bytes = std::fs::read(fixture("anf18-json.mcap")).expect("a fixture");
    std::fs::write(&path, &bytes[..bytes.len() / 3]).expect("a temporary file");
    let out = folder.path().join("report");
    let words = words!["analyze", path, "--cask"];
    let cask = fixture("anf18-json.toml");
    let answer = dropcheck(words.into_iter().chain(words![cask, "--out", out]));
    // Whatever it came to, nothing half-written is left.
    assert_eq!(out.join("result.json").exists(), answer.status < 2, "{}", answer.stderr);
    let left = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(left, 1 + usize::from(answer.status < 2));
}
