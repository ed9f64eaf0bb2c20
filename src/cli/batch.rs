//! `batch`: a campaign of recordings with one cask file to one table; a recording that fails does not stop the others.

use super::analyze::SwitchedOff;
use super::complaint::sentence;
use super::limits::Bounds;
use super::output::{Folder, columns, print};
use super::progress::with_progress;
use super::record;
use super::{Ending, output::CannotWrite};
use clap::Args;
use dropcheck::data::CaskFile;
use dropcheck::report::{Batch, BatchRow};
use dropcheck::{ingest, report};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// What a file of a folder is named where it is taken for a recording.
const RECORDING_ENDINGS: [&str; 5] = ["mcap", "h5", "hdf5", "hdf", "csv"];

/// What the campaign's folder holds beside the reports.
const SUMMARY: [&str; 2] = ["campaign.json", "campaign.csv"];

/// What every line of a shard says it is: `campaign.schema`.
pub const SHARD_SCHEMA: &str = "dropcheck.batch-shard/1";

#[derive(Args)]
#[command(after_help = "Example:\n  dropcheck batch tests/*.mcap --cask cask.toml --out campaign")]
pub struct Arguments {
    /// Recordings, each counted once; of a folder every .mcap, .h5, .hdf5, .hdf and .csv file in it
    #[arg(required = true, value_name = "PATHS")]
    paths: Vec<PathBuf>,
    /// The cask file (TOML) of all of them
    #[arg(short, long)]
    cask: PathBuf,
    /// Folder for campaign.csv, campaign.json and one report a recording
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    switched_off: SwitchedOff,
    #[command(flatten)]
    bounds: Bounds,
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    let recordings = recordings(&arguments.paths)?;
    let mut inputs: Vec<&Path> = recordings.iter().map(PathBuf::as_path).collect();
    inputs.push(&arguments.cask);
    let folders = match &arguments.out {
        Some(out) => {
            let summary = Folder::checked(out, &SUMMARY, &inputs)?;
            Some((summary, report_folders(out, &recordings, &inputs)?))
        }
        None => None,
    };
    let mut cask_file = ingest::cask_file(&arguments.cask)?;
    arguments.switched_off.in_cask_file(&mut cask_file);
    if let Some(first) = recordings.first() {
        ingest::cask_file::require_channels(&cask_file, first)?;
    }
    let mut rows = Vec::with_capacity(recordings.len());
    for (i, path) in recordings.iter().enumerate() {
        let folder = folders.as_ref().and_then(|(_, folders)| folders.get(i));
        let failed = |complaint| BatchRow::failed(path.display().to_string(), sentence(&complaint));
        rows.push(analysed(path, &cask_file, arguments, folder).unwrap_or_else(failed));
    }
    let campaign = Batch::new(arguments.cask.display().to_string(), rows);
    if let Some((summary, _)) = &folders {
        summary
            .write(&[(SUMMARY[0].to_owned(), campaign.json()?), (SUMMARY[1].to_owned(), campaign.csv()?)])?;
    }
    print(&campaign.table(columns()))?;
    let outcome = |row: &BatchRow| row.verdict.map_or(Ending::NotDone, Ending::from);
    Ok(campaign.recordings.iter().map(outcome).max().unwrap_or(Ending::Clear))
}

/// The campaign's files of all its shards.
pub fn merge(shards: &[PathBuf], out: &Path) -> miette::Result<Ending> {
    let _ = out;
    Err(miette::miette!("{} and {} others: shards of `batch` cannot be merged yet", shards[0].display(), shards.len() - 1))
}

fn analysed(
    path: &Path,
    cask_file: &CaskFile,
    arguments: &Arguments,
    folder: Option<&(String, Folder)>,
) -> miette::Result<BatchRow> {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let limits = arguments.bounds.limits();
    let recording = with_progress(&name, |progress| ingest::read_within(path, cask_file, limits, progress))?;
    let mut analysis = dropcheck::analyze(&recording, cask_file);
    arguments.switched_off.in_settings(&mut analysis.result);
    record::stamp(&mut analysis.result)?;
    let mut row = BatchRow::of(&analysis.result);
    if let Some((name, folder)) = folder {
        folder.write(&report::files(&analysis)?)?;
        row.report = Some(format!("{name}/report.html"));
    }
    Ok(row)
}

/// The recordings, folders replaced by the files in them, by name.
fn recordings(paths: &[PathBuf]) -> miette::Result<Vec<PathBuf>> {
    let mut recordings = Vec::new();
    for path in paths {
        if !path.is_dir() {
            recordings.push(path.clone());
            continue;
        }
        let entries = std::fs::read_dir(path)
            .map_err(|source| miette::miette!("the folder {} cannot be read: {source}", path.display()))?;
        let mut files: Vec<PathBuf> =
            entries.filter_map(|entry| entry.ok().map(|e| e.path())).filter(|p| p.is_file()).collect();
        files.sort();
        let (found, others): (Vec<PathBuf>, Vec<PathBuf>) =
            files.into_iter().filter(|p| !is_summary(p)).partition(|p| has_ending(p));
        tell_left_out(path, &others);
        if found.is_empty() {
            return Err(miette::miette!(
                help = "name the recordings themselves: their content, not their name, tells the format",
                "the folder {} holds no .mcap, .h5, .hdf5, .hdf or .csv file",
                path.display()
            ));
        }
        recordings.extend(found);
    }
    // One named twice, or once by itself and once by its folder, is one test all the same.
    let mut seen = std::collections::HashSet::new();
    recordings.retain(|path| std::fs::canonicalize(path).map_or(true, |real| seen.insert(real)));
    Ok(recordings)
}

fn has_ending(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| RECORDING_ENDINGS.contains(&ending.as_str()))
}

/// Says on standard error which files of a folder were not taken for recordings, by their endings; cask files and truths lie beside them.
fn tell_left_out(folder: &Path, others: &[PathBuf]) {
    let endings = others.iter().filter_map(|path| path.extension()?.to_str());
    let mut endings: Vec<&str> = endings.filter(|ending| !["toml", "json"].contains(ending)).collect();
    endings.sort_unstable();
    endings.dedup();
    if !endings.is_empty() {
        let (folder, endings) = (folder.display().to_string(), endings.join(", ."));
        let words = format!(
            "files of {folder} that end in .{endings} were left out; name a recording among them itself"
        );
        // There is no one left to tell where standard error is closed.
        let _ = writeln!(anstream::stderr(), "note: {}", report::printable(&words));
    }
}

/// Whether a file is the table of an earlier campaign; a recording may have its name.
fn is_summary(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(256).read_to_end(&mut head));
    read.is_ok() && Batch::begins(&head)
}

/// A folder a recording, named by its stem; a second one of the same stem gets a number.
fn report_folders(
    out: &Path,
    recordings: &[PathBuf],
    inputs: &[&Path],
) -> Result<Vec<(String, Folder)>, CannotWrite> {
    let mut folders: Vec<(String, Folder)> = Vec::new();
    for path in recordings {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        // "...csv" has the stem "..", which is a way out of the folder and no name.
        let stem = if stem.trim_matches('.').is_empty() { "recording".to_owned() } else { stem };
        let mut name = stem.clone();
        let mut number = 2;
        while SUMMARY.contains(&name.as_str()) || folders.iter().any(|(taken, _)| *taken == name) {
            name = format!("{stem}-{number}");
            number += 1;
        }
        let folder = Folder::checked(&out.join(&name), &report::FILE_NAMES, inputs)?;
        folders.push((name, folder));
    }
    Ok(folders)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_stems_get_folders_of_their_own() {
        let out = tempfile::tempdir().unwrap();
        let recordings = ["a/t1.mcap", "b/t1.h5", "b/t2.csv"].map(PathBuf::from);
        let folders = report_folders(out.path(), &recordings, &[]).unwrap();
        let names: Vec<&str> = folders.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["t1", "t1-2", "t2"]);
    }

    #[test]
    fn a_recordings_name_leads_nowhere_else() {
        let out = tempfile::tempdir().unwrap();
        let recordings = ["...csv", "..mcap", "a/campaign.json.h5", "b/../..."].map(PathBuf::from);
        let folders = report_folders(out.path(), &recordings, &[]).unwrap();
        let names: Vec<&str> = folders.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["recording", "recording-2", "campaign.json-2", "recording-3"]);
    }

    #[test]
    fn a_folder_stands_for_the_recordings_in_it() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.mcap", "a.CSV", "notes.txt"] {
            std::fs::write(folder.path().join(name), "x").unwrap();
        }
        let found = recordings(&[folder.path().to_path_buf()]).unwrap();
        let names: Vec<_> = found.iter().map(|p| p.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["a.CSV", "b.mcap"]);
        let twice = [folder.path().join("b.mcap"), folder.path().to_path_buf(), folder.path().join("none")];
        assert_eq!(recordings(&twice).unwrap().len(), 3);
        // An earlier campaign's table is none, a recording of its name is one.
        let table = Batch::new("cask.toml".into(), Vec::new()).csv().unwrap();
        for (content, count) in [(table, 2), (b"time_s,A1\n0,1\n".to_vec(), 3)] {
            std::fs::write(folder.path().join("campaign.csv"), content).unwrap();
            assert_eq!(recordings(&[folder.path().to_path_buf()]).unwrap().len(), count);
        }
        let empty = tempfile::tempdir().unwrap();
        assert!(recordings(&[empty.path().to_path_buf()]).is_err());
    }
}
