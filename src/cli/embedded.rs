//! Entry points for another program (the Python module): a command line to its result, which is returned
//! instead of printed.

use super::{Command, CommandLine, analyze, predict, rerun};
use crate::data::{Analysis, HeldSamples};
use crate::{ingest, report};
use clap::Parser;
use std::ffi::OsString;
use std::path::Path;
#[cfg(feature = "lab")]
use std::path::PathBuf;

pub use super::analyze::write;

fn command(words: &[OsString]) -> miette::Result<Command> {
    let named = std::iter::once("dropcheck".into()).chain(words.iter().cloned());
    let line = CommandLine::try_parse_from(named);
    line.map(|line| line.command).map_err(|wrong| {
        // clap begins with its own "error: ", and tells a person at a terminal where to read on.
        let text = wrong.to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        miette::miette!("{}", text.split("\n\nFor more information").next().unwrap_or_default())
    })
}

fn not(what: &str) -> miette::Report {
    miette::miette!("the words are not those of `{what}`")
}

/// The analysis that this command line asks for. `held` replaces the recording by samples in memory; the
/// result then states no command to run it again, since none makes the same.
///
/// # Errors
/// What the command complains of.
pub fn analysis(words: &[OsString], held: Option<&[HeldSamples]>) -> miette::Result<Analysis> {
    let Command::Analyze(arguments) = command(words)? else { return Err(not("analyze")) };
    let mut analysis = analyze::analysis(&arguments, held)?;
    let words = if held.is_none() { rerun::in_text(words) } else { Vec::new() };
    rerun::stamp(&mut analysis.result, words)?;
    Ok(analysis)
}

/// The JSON of `predict`.
///
/// # Errors
/// What the command complains of.
pub fn prediction(words: &[OsString]) -> miette::Result<Vec<u8>> {
    let Command::Predict(arguments) = command(words)? else { return Err(not("predict")) };
    let (file, request) = predict::asked(&arguments)?;
    Ok(report::study_json(&crate::analysis::study(&file, &request))?)
}

/// The JSON of `inspect`.
///
/// # Errors
/// What the command complains of.
pub fn listing(recording: &Path) -> miette::Result<Vec<u8>> {
    Ok(report::pretty_json(&ingest::list(recording, &|_| ())?)?)
}

/// Writes what `synth` makes of these words: recording, cask file, truth.
///
/// # Errors
/// What the command complains of.
#[cfg(feature = "lab")]
pub fn synthetic(words: &[OsString]) -> miette::Result<[PathBuf; 3]> {
    let Command::Synth(arguments) = command(words)? else { return Err(not("synth")) };
    Ok(super::lab::synth::written(&arguments)?.0)
}
