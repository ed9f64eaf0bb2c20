//! From odd files, each with what a cask file asks of it, to what reading and listing say: the words of
//! `fixtures/odd/outcomes.txt`.
//!
//! `BLESS=1 cargo test --test it -- odd::` writes the outcomes anew; read the difference before committing
//! it.

use crate::moved;
use crate::run::fixtures;
use crate::same::{cask, hash, hash_of, placeless, told};
use crate::stored::stored;
use dropcheck::data::{Channel, Finding};
use dropcheck::ingest;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Where the odd files are stored: the small ones of each reader, and the large ones of all.
const STORES: [&str; 5] =
    ["odd/csv.jsonl", "odd/hdf5.jsonl", "odd/mcap.jsonl", "odd/mme.jsonl", "odd/large.jsonl"];
/// Listed sources that are shown; a hash stands for the others.
const LISTED: usize = 6;
/// Letters of a line that are shown; a hash stands for the others.
const LONGEST: usize = 600;
/// Largest odd file, unpacked.
const MOST_BYTES: usize = 16 << 20;

#[derive(serde::Deserialize)]
struct Cases {
    case: Vec<Case>,
}

#[derive(serde::Deserialize)]
struct Case {
    file: String,
    time: Option<String>,
    #[serde(default)]
    channels: Vec<toml::Table>,
}

/// A channel's clock, unit and samples, which a hash stands for.
fn of_channel(channel: &Channel) -> String {
    let samples = &channel.samples;
    format!(
        "{}: {} samples at {} Hz from {} s, {} ({}) of {} m/s², {}",
        channel.name,
        samples.len(),
        channel.sample_rate_hz,
        channel.start_s,
        channel.unit,
        channel.unit_origin,
        channel.scale_m_s2,
        hash_of((0..samples.len()).map(|i| samples.get(i)))
    )
}

fn of_issue(issue: &Finding) -> String {
    let code = serde_json::to_value(issue.code).expect("a word");
    let channel = issue.channel.as_deref().unwrap_or("the file");
    format!("{:?} {} of {channel}: {}", issue.severity, code.as_str().unwrap_or_default(), issue.message)
}

/// What reading the recording by the cask file says, a line each.
fn reading(recording: &Path, cask: &Path) -> Vec<String> {
    match ingest::cask_file(cask).and_then(|file| dropcheck::read(recording, &file, &|_| ())) {
        Ok(read) => {
            let since = read.start_unix_ns.map(|ns| format!("zero is {ns} ns since 1970"));
            let channels = read.channels.iter().map(of_channel);
            since.into_iter().chain(channels).chain(read.issues.iter().map(of_issue)).collect()
        }
        Err(error) => vec![format!("refused: {}", told(&error))],
    }
}

/// What listing the recording says, a line each.
fn listing(recording: &Path) -> Vec<String> {
    let listing = match ingest::list(recording, &|_| ()) {
        Ok(listing) => listing,
        Err(error) => return vec![format!("not listed: {}", told(&error))],
    };
    let counts = format!("listed {:?} {:?}", listing.counts, listing.facts);
    let mut sources = listing.channels.iter().map(|channel| {
        let Ok(Value::Object(mut said)) = serde_json::to_value(channel) else { return String::new() };
        said.retain(|_, value| !value.is_null());
        Value::Object(said).to_string()
    });
    let mut lines: Vec<String> = [counts].into_iter().chain(sources.by_ref().take(LISTED)).collect();
    let others: Vec<String> = sources.collect();
    if !others.is_empty() {
        lines.push(format!("and {} more, {}", others.len(), hash(&others.join("\n"))));
    }
    lines.extend(listing.issues.iter().map(of_issue));
    lines
}

/// A case's outcome: a line of what is asked, the answers indented below.
fn outcome(case: &Case, files: &BTreeMap<String, Vec<u8>>, folder: &Path, earlier: &mut String) -> String {
    let bytes = files.get(&case.file).unwrap_or_else(|| panic!("{} is not stored", case.file));
    let name = case.file.rsplit('/').next().unwrap_or(&case.file);
    let (name, bytes) = match name.strip_suffix(".gz") {
        None => (name, bytes.clone()),
        Some(name) => (name, unpacked(bytes)),
    };
    let recording = folder.join(name);
    fs::write(&recording, bytes).expect("a temporary file");
    let time = case
        .time
        .as_ref()
        .map_or(String::new(), |time| format!("[recording]\ntime = {}\n", Value::from(&**time)));
    let channels: Vec<String> = case.channels.iter().map(ToString::to_string).collect();
    let cask_path = folder.join("cask.toml");
    fs::write(&cask_path, time.clone() + &cask(&channels)).expect("a temporary file");
    let asked =
        channels.iter().map(|channel| channel.trim().replace('\n', ", ")).collect::<Vec<_>>().join("; ");
    let mut lines = if channels.is_empty() { Vec::new() } else { reading(&recording, &cask_path) };
    // A file is listed once, whatever is asked of it.
    if *earlier != case.file {
        lines.extend(listing(&recording));
        earlier.clone_from(&case.file);
    }
    let mut text = format!("{} · {}{asked}\n", case.file, time.replace('\n', " "));
    for line in lines {
        let line = placeless(&line, &recording, &cask_path).trim_end().replace('\n', "\n    ");
        let shown: String = line.chars().take(LONGEST).collect();
        let rest = if shown == line { String::new() } else { format!("…, {}", hash(&line)) };
        let _ = writeln!(text, "    {shown}{rest}");
    }
    text
}

fn unpacked(packed: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0; MOST_BYTES];
    let count = libdeflater::Decompressor::new().gzip_decompress(packed, &mut bytes).expect("gzip");
    bytes.truncate(count);
    bytes
}

#[test]
fn odd_files_are_read_or_refused_as_written_down() {
    ingest::read_hdf5_with(Path::new(env!("CARGO_BIN_EXE_dropcheck")));
    let cases = fs::read_to_string(fixtures().join("odd/cases.toml")).expect("cases");
    let Cases { case: cases } = toml::from_str(&cases).expect("cases as told at their head");
    let files: BTreeMap<String, Vec<u8>> = STORES.into_iter().flat_map(stored).collect();
    let asked: BTreeSet<&String> = cases.iter().map(|case| &case.file).collect();
    let unasked: Vec<&String> = files.keys().filter(|name| !asked.contains(name)).collect();
    assert!(unasked.is_empty(), "odd/cases.toml asks nothing of {unasked:?}");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut earlier = String::new();
    let found: String = cases.iter().map(|case| outcome(case, &files, folder.path(), &mut earlier)).collect();
    moved::hold(&fixtures().join("odd/outcomes.txt"), &found, apart);
}

/// The outcomes that differ, each with its lines of then and now.
fn apart(old: &str, new: &str) -> Vec<String> {
    // A line that is not indented begins an outcome.
    let blocks = |text: &str| -> BTreeMap<String, String> {
        let text = text.replace("\n    ", "\r    ");
        let blocks = text.lines().map(|block| block.split_once('\r').unwrap_or((block, "")));
        blocks.map(|(asked, lines)| (asked.to_owned(), lines.replace('\r', "\n"))).collect()
    };
    let (old, new) = (blocks(old), blocks(new));
    let asked: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    let none = String::new();
    let pair = |asked| [&old, &new].map(|blocks| blocks.get(asked).unwrap_or(&none).as_str());
    let differ = asked.into_iter().map(|asked| (asked, pair(asked))).filter(|(_, [old, new])| old != new);
    differ.map(|(asked, [old, new])| format!("{asked}\n{}", moved::lines(old, new).join("\n"))).collect()
}
