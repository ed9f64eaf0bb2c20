//! `inspect`: lists the content of a recording as a table or JSON, and writes a page with every source as a
//! curve.

use super::Ending;
use super::limits::Bounds;
use super::output::{Folder, JsonTarget, columns, print};
use super::progress::with_progress;
use crate::data::Listing;
use crate::{analysis, ingest, report};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub struct Arguments {
    /// The recording: MCAP, HDF5, CSV or ISO-MME, told by its content
    recording: PathBuf,
    /// Folder for recording.html, every source as a curve with its spectrum, and recording.json, the listing
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace what --out holds of another recording
    #[arg(long, requires = "out")]
    force: bool,
    /// Write the listing as JSON to a file; with - to standard output, and nothing else there
    #[arg(short, long, value_name = "FILE|-")]
    json: Option<PathBuf>,
    #[command(flatten)]
    bounds: Bounds,
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    let inputs = [arguments.recording.as_path()];
    let names = &report::FIRST_LOOK_NAMES;
    let folder = arguments.out.as_deref().map(|dir| Folder::prepare(dir, names, &inputs)).transpose()?;
    let json = JsonTarget::prepare(arguments.json.as_deref(), &inputs)?;
    let listing = with_progress("reading", |progress| {
        ingest::list_within(&arguments.recording, arguments.bounds.limits(), progress)
    })?;
    if let Some(folder) = &folder {
        write_page(arguments, &listing, folder)?;
    }
    json.write(|| report::pretty_json(&listing))?;
    if !json.is_standard_output() {
        print(&report::listing_table(&listing, columns()))?;
        if let Some(folder) = &folder {
            print(&format!("\nPage: {}\n", report::sanitize(&folder.file(names[0]))))?;
        }
    }
    let is_sound = listing.issues.iter().all(|issue| issue.severity == crate::data::Severity::Note);
    Ok(if is_sound { Ending::Clear } else { Ending::NeedsALook })
}

/// Writes the page into the folder, one source after the other.
fn write_page(arguments: &Arguments, listing: &Listing, folder: &Folder) -> miette::Result<()> {
    let Arguments { recording, force, bounds, .. } = arguments;
    let sha256 = ingest::sha256(recording)?;
    if !force {
        folder.refuse_other_recording(&sha256)?;
    }
    let drawn = report::drawn_sources(listing);
    let mut page = report::FirstLook::new(listing, &drawn);
    with_progress("drawing", |progress| {
        let add = |number, looked| page.add(number, looked);
        analysis::look_at_each(recording, &drawn, bounds.limits(), progress, add);
    });
    Ok(folder.write(&page.files(&sha256)?)?)
}
