//! A result to the record of the run that made it, and such a record to the same run again and what differs.

use crate::data::{CaskFile, DropResult, Program, Recording, shortened};
use crate::ingest::bytes_of;
use crate::{ingest, report};
use miette::{IntoDiagnostic, WrapErr};
use serde_json::Value;
use std::ffi::OsString;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Lines on what differs, at most.
const MOST_LINES: usize = 20;

/// What an earlier result says of the run that made it.
pub struct EarlierResult {
    result: Value,
    name: String,
}

/// The words behind the program's name. Under an interpreter they are not those of the process.
static WORDS: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Takes down the words of the command that runs.
pub fn begin(words: &[OsString]) {
    let words = words.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    *WORDS.lock().unwrap_or_else(PoisonError::into_inner) = words;
}

/// The words taken down.
pub fn words() -> Vec<String> {
    WORDS.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Writes down which program ran, with which words and when; `SOURCE_DATE_EPOCH` stands for now where it is
/// set.
pub fn stamp(result: &mut DropResult, command: Vec<String>) -> miette::Result<()> {
    result.program = Some(Program::this());
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
    /// The record in a file that `--json` or `--out` wrote.
    pub fn read(path: &Path) -> miette::Result<Self> {
        let name = path.display().to_string();
        let text = bytes_of(path, 16).into_diagnostic().wrap_err_with(|| format!("{name} cannot be read"))?;
        let result: Value = serde_json::from_slice(&text)
            .into_diagnostic()
            .wrap_err_with(|| format!("{name} is no result of dropcheck: it is not JSON"))?;
        if result["schema"] == "dropcheck.result/1" && result["cask_text"].is_string() {
            return Ok(Self { result, name });
        }
        Err(miette::miette!(
            help = "name a result.json that `analyze --json` or `--out` wrote",
            "{name} is no result of dropcheck that holds its cask file"
        ))
    }

    /// The cask file.
    pub fn cask_file(&self) -> miette::Result<CaskFile> {
        let text_at =
            |pointer: &str| self.result.pointer(pointer).and_then(Value::as_str).unwrap_or_default();
        Ok(ingest::cask_file::of_text(Path::new(text_at("/input/cask")), text_at("/cask_text"))?)
    }

    /// The corrections that were switched off on its command line, by their keys.
    pub fn switched_off(&self) -> impl Iterator<Item = &str> {
        let made = self.result["settings"]["corrections"].as_object().into_iter().flatten();
        made.filter(|(_, of)| of["from"] == "command line").map(|(key, _)| key.as_str())
    }

    /// Gives a result that was made again the words of the first, where it is of the same recording.
    pub fn repeat(&self, recording: &Recording, result: &mut DropResult) {
        let input = &self.result["input"];
        if input["recording_sha256"] == recording.sha256.as_str() {
            let name = input["recording"].as_str().unwrap_or(&result.input.recording);
            result.input.recording = name.to_owned();
        }
        let words = self.result["command"].as_array().into_iter().flatten();
        result.command = words.filter_map(|word| word.as_str().map(str::to_owned)).collect();
    }

    /// What is otherwise than in the record, but for the date, one line each.
    pub fn differences(&self, result: &DropResult) -> miette::Result<String> {
        let now: Value = serde_json::from_slice(&report::result_json(result)?).into_diagnostic()?;
        let mut lines = Vec::new();
        compare("", &self.result, &now, &mut lines);
        lines.retain(|line| !line.starts_with("analysed:"));
        // What was stated otherwise is why the rest is otherwise.
        lines.sort_by_key(|line| !line.starts_with("settings."));
        let name = &self.name;
        if lines.is_empty() {
            return Ok(format!("The same as {name}.\n"));
        }
        let more = lines.len().saturating_sub(MOST_LINES);
        lines.truncate(MOST_LINES);
        let end = if more > 0 { format!("\n  … and {more} more") } else { String::new() };
        let lines: Vec<String> = lines.iter().map(|line| report::printable(&shortened(line))).collect();
        Ok(format!("Otherwise than {}:\n  {}{end}\n", report::printable(name), lines.join("\n  ")))
    }
}

/// Adds a line for each value that differs, by its place.
fn compare(place: &str, before: &Value, now: &Value, lines: &mut Vec<String>) {
    let under = |key: &str| if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") };
    match (before, now) {
        (Value::Object(a), Value::Object(b)) => {
            let added = b.keys().filter(|key| !a.contains_key(*key));
            for key in a.keys().chain(added) {
                compare(&under(key), &before[key], &now[key], lines);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                compare(&format!("{place}[{i}]"), a, b, lines);
            }
        }
        (a, b) if a == b => {}
        (Value::Array(a), Value::Array(b)) => {
            lines.push(format!("{place}: {} entries before, {} now", a.len(), b.len()));
        }
        (a, b) => lines.push(format!("{place}: {a} before, {b} now")),
    }
}
