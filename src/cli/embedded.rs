//! Entry points for another program (the Python module): each takes a command line and returns its result
//! instead of printing it.

use super::{Command, CommandLine, analyze, predict, rerun};
use crate::data::{Analysis, HeldSamples};
use crate::{ingest, report};
use clap::Parser;
use std::ffi::OsString;
use std::path::Path;
#[cfg(feature = "lab")]
use std::path::PathBuf;

pub use super::analyze::write;

fn parse_command(words: &[OsString]) -> miette::Result<Command> {
    let named = std::iter::once("dropcheck".into()).chain(words.iter().cloned());
    let line = CommandLine::try_parse_from(named);
    line.map(|line| line.command).map_err(|wrong| {
        // clap begins with "error: " and adds a hint for a terminal; both are removed.
        let text = wrong.to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        miette::miette!("{}", text.split("\n\nFor more information").next().unwrap_or_default())
    })
}

fn refuse_command(what: &str) -> miette::Report {
    miette::miette!("the words are not those of `{what}`")
}

/// Runs the analysis that this command line asks for. `held` replaces the recording by samples in memory; no
/// command is then stored in the result, since none repeats it.
///
/// # Errors
/// Those of the command.
pub fn analysis(words: &[OsString], held: Option<&[HeldSamples]>) -> miette::Result<Analysis> {
    let Command::Analyze(arguments) = parse_command(words)? else { return Err(refuse_command("analyze")) };
    let mut analysis = analyze::analyze(&arguments, held)?;
    let words = if held.is_none() { rerun::to_text(words) } else { Vec::new() };
    rerun::stamp(&mut analysis.result, words)?;
    Ok(analysis)
}

/// Returns the JSON of `predict`.
///
/// # Errors
/// Those of the command.
pub fn prediction(words: &[OsString]) -> miette::Result<Vec<u8>> {
    let Command::Predict(arguments) = parse_command(words)? else { return Err(refuse_command("predict")) };
    let (file, request) = predict::read_request(&arguments)?;
    Ok(report::study_json(&crate::analysis::study(&file, &request))?)
}

/// Returns the JSON of `inspect`.
///
/// # Errors
/// Those of the command.
pub fn listing(recording: &Path) -> miette::Result<Vec<u8>> {
    Ok(report::pretty_json(&ingest::list(recording, &|_| ())?)?)
}

/// Writes the files of `synth` for this command line: recording, cask file, truth.
///
/// # Errors
/// Those of the command.
#[cfg(feature = "lab")]
pub fn synthetic(words: &[OsString]) -> miette::Result<[PathBuf; 3]> {
    let Command::Synth(arguments) = parse_command(words)? else { return Err(refuse_command("synth")) };
    Ok(super::lab::synth::write_recording(&arguments)?.0)
}
