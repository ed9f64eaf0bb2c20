//! From fixtures, corpus and six hundred scenes to what the program says of each: the same as when
//! `tests/same` was written.
//!
//! A change that moves code and no result passes; one that changes results shows which, by the parts of the
//! answer. A run that finds an answer in the table keeps the whole of it in the target folder: against that a
//! later run shows each value that moved. `BLESS=1 cargo test --test it -- same:: --include-ignored` writes
//! the tables anew and shows the same.

use crate::moved::{self, is_renewed};
use crate::run::{analyze, dropcheck, fixture, fixtures, words};
use crate::stored::stored;
use dropcheck::ingest::{self, IngestError};
use dropcheck::lab::data::SceneNumber;
use dropcheck::lab::report::SyntheticFormat;
use dropcheck::{lab, report};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The scenes' campaign.
const SEED: u64 = 20;
/// Scenes of either kind, sound and damaged.
const SCENES: u32 = 300;
/// Of so many scenes one is held by the usual run, whose analysis takes three times as long as a release's.
const STRIDE: usize = 10;
/// How far a number may move on a machine whose sines and powers differ in their last digit, relative.
const OTHER_MACHINE: f64 = 1e-6;

/// What the program says of one recording, without the search for a usual slip: that takes fifteen more
/// analyses of each damaged scene, and the fixtures hold it.
pub struct Said {
    /// Names the recording.
    pub name: String,
    /// The result or why there is none, without names of places.
    pub result: String,
    /// The listing or why there is none.
    pub listing: String,
}

/// What is said of the recording in `folder` by the cask file there.
pub fn said(name: String, recording: &Path, cask: &Path) -> Said {
    ingest::read_hdf5_with(Path::new(env!("CARGO_BIN_EXE_dropcheck")));
    let result = ingest::cask_file(cask).and_then(|file| {
        let read = dropcheck::read(recording, &file, &|_| ())?;
        Ok(report::pretty_json(&dropcheck::stages::measure(&read, &file).result).expect("JSON"))
    });
    let listing =
        ingest::list(recording, &|_| ()).map(|listing| report::pretty_json(&listing).expect("JSON"));
    let text = |said: Result<Vec<u8>, IngestError>| {
        let said = said.unwrap_or_else(|error| told(&error).into_bytes());
        placeless(&String::from_utf8(said).expect("UTF-8"), recording, cask)
    };
    Said { name, result: text(result), listing: text(listing) }
}

/// An error with its remedy.
pub fn told(error: &IngestError) -> String {
    let help = miette::Diagnostic::help(error).map(|help| help.to_string()).unwrap_or_default();
    format!("{error} | {help}")
}

/// The text without names of folders, versions and hashes.
pub fn placeless(text: &str, recording: &Path, cask: &Path) -> String {
    let elsewhere = ["recording", "recording_sha256", "cask", "cask_sha256", "version", "read with"];
    let blanked = |line: &str| {
        let key = line.trim_start().split_once("\": \"").map(|(key, _)| key.trim_start_matches('"'));
        let end = if line.ends_with(',') { "," } else { "" };
        match key.filter(|key| elsewhere.contains(key)) {
            Some(key) => format!("\"{key}\": \"…\"{end}\n"),
            None => format!("{line}\n"),
        }
    };
    let text: String = text.lines().map(blanked).collect();
    let paths = [recording, cask].map(|path| path.display().to_string());
    paths.iter().fold(text, |text, path| text.replace(path, "…"))
}

/// Sixteen digits that stand for a text.
pub fn hash(text: &str) -> String {
    dropcheck::ingest::hexadecimal(&Sha256::digest(text))[..16].to_owned()
}

/// What the sines and powers of this machine give, in sixteen digits.
fn mathematics() -> String {
    let values = (1..20_000).map(|i| {
        let x = f64::from(i) * 0.000_731;
        [x.sin(), x.cos(), x.exp(), x.ln(), x.powf(0.37), x.tanh(), x.atan2(2.0), x.cbrt()]
    });
    hash_of(values.flatten())
}

/// Sixteen digits that stand for numbers, to the last bit.
pub fn hash_of(numbers: impl Iterator<Item = f64>) -> String {
    hash(&numbers.map(|number| number.to_bits().to_string()).collect::<Vec<_>>().join(" "))
}

/// What the cells of a row say.
const COLUMNS: [&str; 8] = ["name", "verdict", "codes", "speed", "k", "result", "listing", "parts"];
/// Cells that another machine gives too: its last digits differ, and with them the hashes.
const CLEAR: usize = 5;

/// A recording's row of the table.
fn row(said: &Said, parts: &[String]) -> [String; COLUMNS.len()] {
    let result: Value = serde_json::from_str(&said.result).unwrap_or(Value::Null);
    let verdict = result["verdict"].as_str().unwrap_or("refused").to_owned();
    let weighty = result["quality"].as_array().into_iter().flatten().filter(|i| i["severity"] != "note");
    let mut codes: Vec<&str> = weighty.filter_map(|issue| issue["code"].as_str()).collect();
    codes.sort_unstable();
    codes.dedup();
    let estimate = |pointer: &str| {
        let number = |key: &str| result.pointer(&format!("{pointer}/{key}")).and_then(Value::as_f64);
        number("value").zip(number("u95")).map_or_else(|| "–".to_owned(), |(v, u95)| format!("{v} ± {u95}"))
    };
    let [speed, k] = [estimate("/slap_down/speed"), estimate("/k")];
    let [whole, listing] = [&said.result, &said.listing].map(|text| hash(text));
    // The hash of the whole holds the answer: two digits of each part only tell where it moved.
    let part = |name: &String| {
        result.get(name).map_or_else(|| "--".to_owned(), |part| hash(&part.to_string())[..2].to_owned())
    };
    let parts = parts.iter().filter(|_| result.is_object()).map(part).collect();
    [said.name.clone(), verdict, codes.join(" "), speed, k, whole, listing, parts]
}

/// A table as it was written.
struct Table {
    is_same_machine: bool,
    /// Top-level keys of the results, in the order of their digits.
    parts: Vec<String>,
    rows: BTreeMap<String, Vec<String>>,
}

impl Table {
    fn read(text: &str) -> Self {
        let cells = |line: &str| {
            let cells = line.split('\t').map(str::to_owned).chain(std::iter::repeat(String::new()));
            cells.take(COLUMNS.len()).collect::<Vec<_>>()
        };
        let head = |word: &str| text.lines().find_map(|line| line.strip_prefix(word)).unwrap_or_default();
        let rows = text.lines().filter(|line| !line.starts_with("# ")).map(cells);
        Self {
            is_same_machine: head("# mathematics ") == mathematics(),
            parts: head("# parts ").split(' ').map(str::to_owned).collect(),
            rows: rows.map(|row| (row[0].clone(), row)).collect(),
        }
    }

    fn written(said: &[Said]) -> String {
        let keys = |said: &Said| serde_json::from_str::<serde_json::Map<_, Value>>(&said.result).ok();
        let parts: BTreeSet<String> =
            said.iter().filter_map(keys).flat_map(|keys| keys.into_iter().map(|(key, _)| key)).collect();
        let parts: Vec<String> = parts.into_iter().collect();
        let head = format!("# mathematics {}\n# parts {}\n", mathematics(), parts.join(" "));
        head + &said.iter().map(|said| row(said, &parts).join("\t") + "\n").collect::<String>()
    }

    /// What differs in a recording's row from the one written; `None` where nothing does.
    fn difference(&self, said: &Said) -> Option<String> {
        let Some(old) = self.rows.get(&said.name) else {
            return Some(format!("{}: not in the table", said.name));
        };
        let new = row(said, &self.parts);
        let (cells, tolerance) =
            if self.is_same_machine { (COLUMNS.len(), 0.0) } else { (CLEAR, OTHER_MACHINE) };
        let differ: Vec<usize> = (0..cells).filter(|&i| !is_alike(&old[i], &new[i], tolerance)).collect();
        if differ.is_empty() {
            return None;
        }
        let clear = differ.iter().filter(|&&i| i < CLEAR).map(|&i| {
            let value = |cell: &str| cell.split(" ± ").next().unwrap_or_default().to_owned();
            let apart = moved::apart(&value(&old[i]), &value(&new[i]));
            format!("{} {} → {}{apart}", COLUMNS[i], old[i], new[i])
        });
        let digits = |row: &[String], i: usize| row[7].get(2 * i..2 * i + 2).map(str::to_owned);
        let parts = (0..self.parts.len()).filter(|&i| digits(old, i) != digits(&new, i));
        let parts = parts.map(|i| format!("/{}", self.parts[i]));
        let whole = [(5, "result", &said.result), (6, "listing", &said.listing)];
        let whole = whole.into_iter().filter(|(i, ..)| differ.contains(i));
        let whole = whole.flat_map(|(i, what, new)| against_kept(&said.name, what, &old[i], new));
        let moved: Vec<String> = clear.chain(parts).chain(whole).collect();
        Some(format!("{}: {}", said.name, moved::first(&moved).replace('\n', "\n    ")))
    }
}

/// Whether both cells say the same, numbers to `tolerance`.
fn is_alike(old: &str, new: &str, tolerance: f64) -> bool {
    let numbers = |cell: &str| -> Option<Vec<f64>> { cell.split(" ± ").map(|n| n.parse().ok()).collect() };
    old == new
        || numbers(old).zip(numbers(new)).is_some_and(|(old, new)| {
            old.iter().zip(&new).all(|(old, new)| (old - new).abs() <= tolerance * old.abs())
        })
}

/// Where whole answers are kept.
fn kept_answers() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("same")
}

/// The whole answer of that name as it was when a run last found it in the table.
fn kept(name: &str, what: &str) -> PathBuf {
    kept_answers().join(format!("{}.{what}", name.replace('/', "_")))
}

/// Where an answer differs from the kept one, if that is the one of the table.
fn against_kept(name: &str, what: &str, of_table: &str, new: &str) -> Vec<String> {
    match fs::read_to_string(kept(name, what)) {
        Ok(old) if hash(&old) == of_table => moved::pointers(&old, new),
        _ => vec![format!("{what}: the whole is kept by a run before the change")],
    }
}

/// Holds what is said against the table of that name, or writes it.
fn hold(table: &str, said: &[Said]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/same").join(format!("{table}.tsv"));
    let stored = Table::read(&fs::read_to_string(&path).unwrap_or_default());
    let differences: Vec<Option<String>> = said.iter().map(|said| stored.difference(said)).collect();
    fs::create_dir_all(kept_answers()).expect("the target folder");
    for (said, difference) in said.iter().zip(&differences) {
        if difference.is_none() || is_renewed() {
            fs::write(kept(&said.name, "result"), &said.result).expect("the target folder");
            fs::write(kept(&said.name, "listing"), &said.listing).expect("the target folder");
        }
    }
    let differ: Vec<String> = differences.into_iter().flatten().collect();
    let told =
        format!("{} of {} differ from {table}.tsv:\n{}", differ.len(), said.len(), moved::first(&differ));
    if is_renewed() {
        fs::write(&path, Table::written(said)).expect("tests/same can be written");
        moved::tell(&told);
    } else {
        assert!(differ.is_empty(), "{told}");
    }
}

#[test]
fn the_fixtures_by_the_program() {
    let mut names: Vec<PathBuf> =
        fs::read_dir(fixture(".")).expect("examples").flatten().map(|e| e.path()).collect();
    names.push(fixtures().join("reference/stored-by-hdf5-2.h5"));
    names.sort_by(|a, b| a.file_name().cmp(&b.file_name()));
    let is_recording =
        |path: &&PathBuf| path.extension().is_some_and(|e| ["mcap", "h5", "csv"].iter().any(|r| e == *r));
    let said: Vec<Said> = names
        .iter()
        .filter(is_recording)
        .map(|recording| {
            let cask = recording.with_extension("toml");
            let listed = dropcheck(words!["inspect", recording, "--json", "-"]);
            let found = analyze(recording, &cask);
            let [result, listing] =
                [found, listed].map(|answer| placeless(&(answer.stdout + &answer.stderr), recording, &cask));
            let name = recording.file_name().expect("a name").to_string_lossy().into_owned();
            Said { name, result, listing }
        })
        .collect();
    hold("fixtures", &said);
}

/// A cask file of the first sources that the recording lists.
fn cask_of(recording: &Path) -> String {
    let listed = ingest::list(recording, &|_| ()).map(|listing| listing.channels).unwrap_or_default();
    let sources = listed.iter().filter(|c| c.unreadable.is_none()).map(|c| c.source.as_str());
    let sources: Vec<&str> = sources.take(3).chain(listed.is_empty().then_some("1")).collect();
    cask(
        &sources
            .iter()
            .map(|source| format!("source = {}\nunit = \"g\"\n", Value::from(*source)))
            .collect::<Vec<_>>(),
    )
}

/// A cask file with channels of which each is given but for its name, end and axis.
pub fn cask(channels: &[String]) -> String {
    let head =
        "[cask]\nmass_kg = 4466\nlength_m = 5.512\nheight_m = 0.792\n[drop]\nheight_m = 9\nangle_deg = 15\n";
    let channels = channels.iter().enumerate().map(|(i, given)| {
        let (end, position_m) = if i % 2 == 0 { ("first", 0.15) } else { ("second", 5.36) };
        let at = format!("end = \"{end}\"\naxis = \"transverse\"\nposition_m = {position_m}");
        format!("[[channel]]\nname = \"C{}\"\n{at}\n{given}", i + 1)
    });
    head.to_owned() + &channels.collect::<String>()
}

#[test]
fn the_corpus() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut all = Vec::new();
    for target in ["csv", "mcap", "cask", "scene"] {
        fs::create_dir(folder.path().join(target)).expect("a temporary folder");
        for (name, bytes) in stored(&format!("corpus/{target}.jsonl")) {
            let path = folder.path().join(&name);
            fs::write(&path, bytes).expect("a temporary file");
            let cask = folder.path().join("cask.toml");
            all.push(match target {
                "cask" => said(name, &fixture("anf18-json.mcap"), &path),
                "scene" => {
                    let scene = lab::scene_file::read(&path).map(|file| format!("{file:?}"));
                    let result = placeless(&scene.unwrap_or_else(|error| told(&error)), &path, &path);
                    Said { name, result, listing: String::new() }
                }
                _ => {
                    fs::write(&cask, cask_of(&path)).expect("a temporary file");
                    said(name, &path, &cask)
                }
            });
        }
    }
    hold("corpus", &all);
}

/// One of every `stride` scenes, in every format.
fn scenes(stride: usize) -> Vec<Said> {
    let formats = [
        ("json.mcap", SyntheticFormat::McapJson),
        ("protobuf.mcap", SyntheticFormat::McapProtobuf),
        ("h5", SyntheticFormat::Hdf5),
        ("csv", SyntheticFormat::Csv),
    ];
    let numbers = (0..SCENES).map(SceneNumber::Undamaged).chain((0..SCENES).map(SceneNumber::Damaged));
    let numbers: Vec<SceneNumber> = numbers.step_by(stride).collect();
    let all = Mutex::new(Vec::new());
    numbers.into_par_iter().for_each(|number| {
        let (scene, recording) = lab::campaign::scene(SEED, number, false);
        for (extension, format) in formats {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let name = format!("drop.{extension}");
            // A table of one rate cannot hold every scene.
            let Ok(files) = lab::report::synthetic_files(&scene, &recording, &name, format) else { continue };
            for (name, bytes) in &files {
                fs::write(folder.path().join(name), bytes).expect("a temporary file");
            }
            let [recording, cask] = [0, 1].map(|i| folder.path().join(&files[i].0));
            let said = said(format!("{number}.{extension}"), &recording, &cask);
            all.lock().expect("no panic").push(said);
        }
    });
    let mut all = all.into_inner().expect("no panic");
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all
}

#[test]
fn a_tenth_of_the_scenes_in_every_format() {
    // The table is written by the run of all.
    if !is_renewed() {
        hold("scenes", &scenes(STRIDE));
    }
}

#[test]
#[ignore = "2,400 analyses: .ci/long"]
fn every_scene_in_every_format() {
    hold("scenes", &scenes(1));
}
