//! `inspect`: what a recording holds, as a table or JSON.

use super::Ending;
use super::limits::Bounds;
use super::output::{JsonTarget, columns, print};
use super::progress::with_progress;
use crate::{ingest, report};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub struct Arguments {
    /// The recording: MCAP, HDF5, CSV or ISO-MME, told by its content
    recording: PathBuf,
    /// Write the listing as JSON to a file; with - to standard output, and nothing else there
    #[arg(short, long, value_name = "FILE|-")]
    json: Option<PathBuf>,
    #[command(flatten)]
    bounds: Bounds,
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    let json = JsonTarget::checked(arguments.json.as_deref(), &[&arguments.recording])?;
    let listing = with_progress("reading", |progress| {
        ingest::list_within(&arguments.recording, arguments.bounds.limits(), progress)
    })?;
    json.write(|| report::pretty_json(&listing))?;
    if !json.is_standard_output() {
        print(&report::listing_table(&listing, columns()))?;
    }
    let sound = listing.issues.iter().all(|issue| issue.severity == crate::data::Severity::Note);
    Ok(if sound { Ending::Clear } else { Ending::NeedsALook })
}
