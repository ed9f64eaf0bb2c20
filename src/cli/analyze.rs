//! `analyze`: one recording and one cask file to a table and a report.

use super::Outcome;
use super::output::{Folder, JsonTarget, print};
use super::progress::with_progress;
use clap::Args;
use dropcheck::{ingest, report};
use std::path::PathBuf;

const AFTER_HELP: &str = "\
Examples:
  dropcheck analyze drop.mcap --cask cask.toml
  dropcheck analyze drop.csv --cask cask.toml --out report
  dropcheck analyze drop.h5 --cask cask.toml --json - | jq .k";

#[derive(Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The recording: MCAP, HDF5 or CSV, told by its content
    recording: PathBuf,
    /// The cask file (TOML); `dropcheck init` writes one to fill in
    #[arg(long)]
    cask: PathBuf,
    /// Folder for the report: report.html, result.json, curves.csv, curves.h5, curves.mcap, pictures
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the result as JSON to a file; with - to standard output, and nothing else there
    #[arg(long, value_name = "FILE|-")]
    json: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> miette::Result<Outcome> {
    let inputs = [arguments.recording.as_path(), arguments.cask.as_path()];
    let folder =
        arguments.out.as_deref().map(|dir| Folder::checked(dir, &report::FILE_NAMES, &inputs)).transpose()?;
    let json = JsonTarget::checked(arguments.json.as_deref(), &inputs)?;

    let cask_file = ingest::cask_file(&arguments.cask)?;
    let recording =
        with_progress("reading", |progress| ingest::read(&arguments.recording, &cask_file, progress))?;
    let analysis = dropcheck::analyze(&recording, &cask_file);

    if let Some(folder) = &folder {
        folder.write(&report::files(&analysis)?)?;
    }
    json.write(|| report::result_json(&analysis.result))?;
    if !json.is_standard_output() {
        print(&report::table(&analysis))?;
        if let Some(folder) = &folder {
            print(&format!("\nReport: {}\n", report::printable(&folder.file("report.html"))))?;
        }
    }
    Ok(analysis.result.verdict.into())
}
