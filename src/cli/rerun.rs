//! Records in a result which run made it, and repeats the run of an earlier result to show the differences.

use super::Ending;
use crate::data::{CaskFile, DropResult, Program, shorten};
use crate::ingest::bytes_of;
use crate::{ingest, report};
use miette::{IntoDiagnostic, WrapErr, miette};
use serde_json::Value;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Numbers closer than this share of their magnitude are equal: machines round differently.
const SAME_WITHIN: f64 = 1e-9;

/// Largest number of lines that list differences.
const MOST_LINES: usize = 20;

/// An earlier result, with the record of its run.
pub struct EarlierResult {
    result: Value,
    name: String,
}

/// Returns the words of a command line as a result records them.
pub fn to_text(words: &[OsString]) -> Vec<String> {
    words.iter().map(|word| word.to_string_lossy().into_owned()).collect()
}

/// SHA-256 of the program's file; `None` if it cannot be read, or if an interpreter runs this code.
pub fn program_sha256() -> Option<String> {
    static OWN: OnceLock<Option<String>> = OnceLock::new();
    let file =
        std::env::current_exe().ok().filter(|file| file.file_stem().is_some_and(|own| own == "dropcheck"));
    OWN.get_or_init(|| ingest::sha256(&file?).ok()).clone()
}

/// Records program, command line and time in the result; `SOURCE_DATE_EPOCH` replaces the time if it is set.
pub fn stamp(result: &mut DropResult, command: Vec<String>) -> miette::Result<()> {
    // Only a release states its hash, like its commit.
    let sha256 = if cfg!(debug_assertions) { None } else { program_sha256() };
    result.program = Some(Program { sha256, ..Program::current() });
    result.command = command;
    let now = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(seconds) => {
            let words = || format!("SOURCE_DATE_EPOCH is \"{seconds}\", not a number of seconds since 1970");
            let count = seconds.parse().into_diagnostic().wrap_err_with(words)?;
            jiff::Timestamp::from_second(count).into_diagnostic().wrap_err_with(words)?
        }
        Err(_) => jiff::Timestamp::from_second(jiff::Timestamp::now().as_second()).into_diagnostic()?,
    };
    result.analysed = Some(now.to_string());
    Ok(())
}

impl EarlierResult {
    /// Reads the record in a file that `--json` or `--out` wrote.
    pub fn read(path: &Path) -> miette::Result<Self> {
        let name = path.display().to_string();
        let text = bytes_of(path, 16).into_diagnostic().wrap_err_with(|| format!("{name} cannot be read"))?;
        let result: Value = serde_json::from_slice(&text)
            .into_diagnostic()
            .wrap_err_with(|| format!("{name} is no result of dropcheck: it is not JSON"))?;
        if result["schema"] == "dropcheck.result/1" && result["cask_text"].is_string() {
            return Ok(Self { result, name });
        }
        let mend = "name a result.json that `analyze --json` or `--out` wrote";
        Err(miette!(help = mend, "{name} is no result of dropcheck that holds its cask file"))
    }

    /// Returns the cask file.
    pub fn cask_file(&self) -> miette::Result<CaskFile> {
        let text_at =
            |pointer: &str| self.result.pointer(pointer).and_then(Value::as_str).unwrap_or_default();
        Ok(ingest::cask_file::of_text(Path::new(text_at("/input/cask")), text_at("/cask_text"))?)
    }

    /// Returns the file with the cask at rest before the drop.
    pub fn rest(&self) -> Option<PathBuf> {
        self.result["input"]["rest"].as_str().map(PathBuf::from)
    }

    /// Lists the corrections that its command line disabled, by their keys.
    pub fn disabled_corrections(&self) -> Vec<String> {
        let corrections = self.result["settings"]["corrections"].as_object().into_iter().flatten();
        corrections.filter(|(_, entry)| entry["from"] == "command line").map(|(key, _)| key.clone()).collect()
    }

    /// Gives the repeated result the command line of the first one, if both have the same recording. Returns
    /// a line that says if recording and numbers are equal, a list of the differences except the date, and if
    /// a person should look.
    pub fn repeat(&self, result: &mut DropResult) -> miette::Result<([String; 2], Ending)> {
        let input = &self.result["input"];
        let (before, here) = (&input["recording_sha256"], Value::from(&result.input.recording_sha256[..]));
        let mut recording = format!("Another recording: SHA-256 {here} here, {before} in {}", self.name);
        if *before == here {
            "The same recording".clone_into(&mut recording);
            let name = input["recording"].as_str().unwrap_or(&result.input.recording);
            result.input.recording = name.to_owned();
        }
        let words = self.result["command"].as_array().into_iter().flatten();
        result.command = words.filter_map(|word| word.as_str().map(str::to_owned)).collect();
        let now: Value = serde_json::from_slice(&report::pretty_json(&result)?).into_diagnostic()?;
        let mut found = Vec::new();
        compare("", [&self.result, &now], 0.0, &mut found);
        found.retain(|(_, line)| !line.starts_with("analysed:"));
        // Different settings cause the other differences and come first.
        let is_stated = |line: &str| line.starts_with("settings.");
        found.sort_by(|a, b| is_stated(&b.1).cmp(&is_stated(&a.1)).then(b.0.total_cmp(&a.0)));
        let values = found.iter().filter(|(share, _)| *share > 0.0).count();
        let numbers = match found.first().filter(|_| values > 0) {
            None => "every number within 1e-9".to_owned(),
            Some((_, line)) => format!("{values} of its values differ, most of all {line}"),
        };
        let shown = |line: &str| report::sanitize(&shorten(line));
        let head = format!("{}.\n\n", shown(&format!("{recording}; {numbers}")));
        let title = (!found.is_empty()).then(|| format!("Otherwise than {}:\n", shown(&self.name)));
        let lines = found.iter().take(MOST_LINES).map(|(_, line)| format!("  {}\n", shown(line)));
        let more = found.len().checked_sub(MOST_LINES).filter(|more| *more > 0);
        let more = more.map(|more| format!("  … and {more} more\n"));
        let list = title.into_iter().chain(lines).chain(more).collect();
        let is_same = values == 0 && *before == here;
        Ok(([head, list], if is_same { Ending::Clear } else { Ending::NeedsALook }))
    }
}

/// Adds a line for each value that differs, with its place and the share of its magnitude by which a number
/// differs: infinite for other values, 0 for words. The share refers to the larger of `magnitude` and the
/// numbers themselves.
fn compare(place: &str, [before, now]: [&Value; 2], magnitude: f64, found: &mut Vec<(f64, String)>) {
    let under = |key: &str| if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") };
    match (before, now) {
        (Value::Object(a), Value::Object(_)) => {
            // A value may differ in proportion to its half-width.
            let magnitude = if a.contains_key("u95") { largest(a.values()) } else { 0.0 };
            for (key, before) in a {
                compare(&under(key), [before, &now[key]], magnitude, found);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (i, pair) in a.iter().zip(b).enumerate() {
                compare(&format!("{place}[{i}]"), pair.into(), largest(a.iter()), found);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            found.push((f64::INFINITY, format!("{place}: {} entries before, {} now", a.len(), b.len())));
        }
        (a, b) if a == b => {}
        (a, b) => {
            let share = match (a.as_f64(), b.as_f64()) {
                (Some(a), Some(b)) => (a - b).abs() / magnitude.max(a.abs()).max(b.abs()),
                _ if a.is_string() && b.is_string() => 0.0,
                _ => f64::INFINITY,
            };
            if share == 0.0 || share > SAME_WITHIN {
                found.push((share, format!("{place}: {a} before, {b} now")));
            }
        }
    }
}

/// Returns the largest magnitude of the numbers among the values.
fn largest<'a>(values: impl Iterator<Item = &'a Value>) -> f64 {
    values.filter_map(Value::as_f64).map(f64::abs).fold(0.0, f64::max)
}
