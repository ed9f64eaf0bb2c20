//! `check`: checks with a recording at rest before the drop if the set-up is ready, as a table, JSON or a
//! page.

use super::Ending;
use super::limits::Bounds;
use super::output::{Folder, JsonTarget, columns, print};
use super::progress::with_progress;
use crate::{analysis, ingest, report};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = include_str!("help/check.txt"))]
pub struct Arguments {
    /// The recording of the rest: MCAP, HDF5, CSV or ISO-MME, told by its content
    rest: PathBuf,
    /// The cask file (TOML) of the drop; `dropcheck init` writes one to fill in
    #[arg(short, long)]
    cask: PathBuf,
    /// The recording holds one blow on each end, the first end first: they tell ends, clocks and signs
    #[arg(long)]
    taps: bool,
    /// Folder for check.html, a page to print and sign, and check.json, the findings
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the findings as JSON to a file; with - to standard output, and nothing else there
    #[arg(short, long, value_name = "FILE|-")]
    json: Option<PathBuf>,
    #[command(flatten)]
    bounds: Bounds,
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    let Arguments { rest, cask, taps, .. } = arguments;
    let (inputs, names) = ([rest.as_path(), cask], &report::CHECK_NAMES);
    let folder = arguments.out.as_deref().map(|dir| Folder::prepare(dir, names, &inputs)).transpose()?;
    let json = JsonTarget::prepare(arguments.json.as_deref(), &inputs)?;
    let mut file = ingest::cask_file::parse(cask)?;
    if folder.is_some() {
        file = ingest::cask_file::with_photos(file)?;
    }
    let recording = with_progress("reading", |progress| {
        ingest::read_within(rest, &file, arguments.bounds.limits(), progress)
    })?;
    let check = analysis::check(&recording, &file, *taps)?;
    let setup = report::CheckedSetup { check: &check, rest: &recording, file: &file, has_blows: *taps };
    if let Some(folder) = &folder {
        folder.write(&report::check_files(&setup)?)?;
    }
    json.write(|| report::pretty_json(&check))?;
    if !json.is_standard_output() {
        print(&report::check_table(&setup, columns()))?;
        if let Some(folder) = &folder {
            print(&format!("\nPage: {}\n", report::sanitize(&folder.file(names[0]))))?;
        }
    }
    Ok(if check.ready { Ending::Clear } else { Ending::NeedsALook })
}
