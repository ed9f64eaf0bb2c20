//! `init`: prints a cask file to fill in, from the content of a recording.

use super::Ending;
use super::batch::template;
use super::limits::Bounds;
use super::output::print_bytes;
use super::progress::with_progress;
use super::replace::write_whole;
use crate::{ingest, report};
use clap::Args;
use miette::miette;
use std::path::PathBuf;

#[derive(Args)]
#[command(
    after_help = "Examples:\n  dropcheck init drop.mcap > cask.toml\n  dropcheck init tests > runs.csv"
)]
pub struct Arguments {
    /// The recording: MCAP, HDF5, CSV or ISO-MME, told by its content; or a folder of them, for a manifest
    recording: PathBuf,
    /// Write the channels into a sensor list, a CSV with a row a channel, which the cask file names
    #[arg(long, value_name = "LIST")]
    sensors: Option<PathBuf>,
    #[command(flatten)]
    bounds: Bounds,
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    if arguments.recording.is_dir() && !ingest::is_recording_folder(&arguments.recording) {
        print_bytes(&template(&arguments.recording)?)?;
        return Ok(Ending::Clear);
    }
    let listing = with_progress("reading", |progress| {
        ingest::list_within(&arguments.recording, arguments.bounds.limits(), progress)
    })?;
    let Some(list) = &arguments.sensors else {
        print_bytes(report::cask_file_template(&listing)?.as_bytes())?;
        return Ok(Ending::Clear);
    };
    let rows = report::sensor_list(&listing)?;
    let shown = list.display();
    let mend = "name another file, or delete this one: it may be filled in already";
    write_whole(list, &rows).map_err(|why| miette!(help = mend, "{shown} cannot be written: {why}"))?;
    let name = list.file_name().unwrap_or(list.as_os_str()).to_string_lossy();
    print_bytes(report::cask_file_with_list(&listing, &name).as_bytes())?;
    Ok(Ending::Clear)
}
