//! `init`: what a recording holds to a cask file to fill in, on standard output.

use super::Ending;
use super::batch::template;
use super::limits::Bounds;
use super::output::print_plain;
use super::progress::with_progress;
use crate::{ingest, report};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(
    after_help = "Examples:\n  dropcheck init drop.mcap > cask.toml\n  dropcheck init tests > runs.csv"
)]
pub struct Arguments {
    /// The recording: MCAP, HDF5, CSV or ISO-MME, told by its content; or a folder of them, for a manifest
    recording: PathBuf,
    #[command(flatten)]
    bounds: Bounds,
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    if arguments.recording.is_dir() && !ingest::is_recording_folder(&arguments.recording) {
        print_plain(&template(&arguments.recording)?)?;
        return Ok(Ending::Clear);
    }
    let listing = with_progress("reading", |progress| {
        ingest::list_within(&arguments.recording, arguments.bounds.limits(), progress)
    })?;
    print_plain(report::cask_file_template(&listing)?.as_bytes())?;
    Ok(Ending::Clear)
}
