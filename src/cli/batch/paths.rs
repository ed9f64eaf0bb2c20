//! Expands paths, folders and patterns into the recordings that they name.

use super::super::output::{note, read_head};
use crate::ingest;
use crate::report::Batch;
use miette::{ensure, miette};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// File name endings of the recordings in a folder.
const RECORDING_ENDINGS: [&str; 6] = ["mcap", "h5", "hdf5", "hdf", "csv", "zip"];
/// Further endings, if a reader of other formats is installed.
const CONVERTED_ENDINGS: [&str; 8] = ["tdms", "mf4", "mdf", "uff", "unv", "uf", "mat", "ide"];

/// Lists the recordings: a folder stands for its files, sorted by name, and a pattern for its matches.
pub fn recordings(paths: &[PathBuf]) -> miette::Result<Vec<PathBuf>> {
    let mut recordings = Vec::new();
    for path in paths {
        if path.is_dir() && !ingest::is_recording_folder(path) {
            recordings.extend(recordings_in(path)?);
        } else if is_pattern(path) {
            let pattern = path.display().to_string();
            let found = glob::glob(&pattern).map_err(|fault| miette!("{pattern} is no pattern: {fault}"))?;
            let before = recordings.len();
            recordings.extend(found.flatten().filter(|path| is_recording(path) && !is_summary(path)));
            ensure!(recordings.len() > before, "no file is named like {pattern}");
        } else {
            recordings.push(path.clone());
        }
    }
    // A recording that is named twice, or by itself and by its folder, is one test.
    let mut seen = HashSet::new();
    recordings.retain(|path| std::fs::canonicalize(path).map_or(true, |real| seen.insert(real)));
    Ok(recordings)
}

/// True if the path may be one recording: a file, or a folder in ISO-MME.
fn is_recording(path: &Path) -> bool {
    path.is_file() || ingest::is_recording_folder(path)
}

/// True if the path is a pattern that no shell has expanded.
fn is_pattern(path: &Path) -> bool {
    path.to_string_lossy().contains(['*', '?', '[']) && std::fs::symlink_metadata(path).is_err()
}

/// Lists the recordings of a folder by their endings, sorted by name.
pub fn recordings_in(path: &Path) -> miette::Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(path)
        .map_err(|source| miette!("the folder {} cannot be read: {source}", path.display()))?;
    let mut files: Vec<PathBuf> =
        entries.filter_map(|entry| entry.ok().map(|e| e.path())).filter(|path| is_recording(path)).collect();
    files.sort();
    let (recordings, others): (Vec<PathBuf>, Vec<PathBuf>) =
        files.into_iter().filter(|p| !is_summary(p)).partition(|p| p.is_dir() || has_ending(p));
    note_skipped_files(path, &others);
    let mend = "name the recordings themselves: their content, not their name, tells the format";
    let none = "holds no .mcap, .h5, .hdf5, .hdf, .csv or .zip file, nor a folder in ISO-MME";
    ensure!(!recordings.is_empty(), help = mend, "the folder {} {none}", path.display());
    Ok(recordings)
}

/// Returns a recording's name without folder and ending.
pub fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn has_ending(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let foreign = CONVERTED_ENDINGS.iter().filter(|_| ingest::foreign::has_reader());
    let mut known = RECORDING_ENDINGS.iter().chain(foreign);
    ending.is_some_and(|ending| known.any(|known| *known == ending))
}

/// Notes on standard error which files of a folder were skipped, by their endings; cask files and truths are
/// expected there.
fn note_skipped_files(folder: &Path, others: &[PathBuf]) {
    let endings = others.iter().filter_map(|path| path.extension()?.to_str());
    let mut endings: Vec<&str> =
        endings.filter(|ending| !["toml", "json", "jsonl"].contains(ending)).collect();
    endings.sort_unstable();
    endings.dedup();
    if !endings.is_empty() {
        let (folder, endings) = (folder.display().to_string(), endings.join(", ."));
        note(&format!(
            "note: files of {folder} that end in .{endings} were left out; name a recording among them itself"
        ));
    }
}

/// True if a file is a manifest or the table of an earlier campaign, which may have the ending of a
/// recording.
fn is_summary(path: &Path) -> bool {
    read_head(path, 256).is_ok_and(|head| Batch::begins(&head) || begins_manifest(&head))
}

/// True if the beginning of a file has the heads of a manifest.
fn begins_manifest(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    let first = text.trim_start_matches('\u{feff}').lines().next().unwrap_or_default();
    let heads = |name: &str| first.split(['\t', ';', ',']).any(|head| head.trim_matches(['"', ' ']) == name);
    heads("recording") && (heads("id") || heads("cask"))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(recordings(&[folder.path().join("*.mcap")]).unwrap().len(), 1);
        assert!(recordings(&[folder.path().join("*.none")]).is_err());
        // The table of an earlier campaign and a manifest are not recordings; a recording with such a name
        // is.
        let table = Batch::default().csv_head().unwrap();
        let manifest = b"id,recording,cask\na,b,c\n".to_vec();
        for (content, count) in [(table, 2), (manifest, 2), (b"time_s,A1\n0,1\n".to_vec(), 3)] {
            std::fs::write(folder.path().join("campaign.csv"), content).unwrap();
            assert_eq!(recordings(&[folder.path().to_path_buf()]).unwrap().len(), count);
        }
        // A folder in ISO-MME is one recording, by itself and in a folder.
        let test = folder.path().join("T1");
        std::fs::create_dir(&test).unwrap();
        std::fs::write(test.join("T1.MME"), "").unwrap();
        assert_eq!(recordings(std::slice::from_ref(&test)).unwrap(), std::slice::from_ref(&test));
        assert!(recordings(&[folder.path().to_path_buf()]).unwrap().contains(&test));
        assert!(recordings(&[folder.path().join("T*")]).unwrap().contains(&test));
        let empty = tempfile::tempdir().unwrap();
        assert!(recordings(&[empty.path().to_path_buf()]).is_err());
    }
}
