//! Reads the tests that a manifest lists, a CSV with a row per recording; writes a manifest to fill in for a
//! folder of recordings.

use super::super::output::note;
use super::paths::{recordings_in, stem};
use super::planned::{PlannedTest, find_cask_file};
use crate::ingest::cask_file::{delimiter, key_of_column};
use crate::ingest::{bytes_of, in_utf8};
use crate::report::records::records;
use miette::{ensure, miette};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Columns of a manifest that state what to analyse.
const ID: &str = "id";
const RECORDING: &str = "recording";
const CASK: &str = "cask";

/// Reads the tests of a manifest; `cask` is the cask file of rows that name none and have none beside their
/// recording.
pub fn read(path: &Path, cask: Option<&Path>) -> miette::Result<Vec<PlannedTest>> {
    let name = path.display();
    let bytes =
        bytes_of(path, 64).map_err(|source| miette!("{name}: the manifest cannot be read: {source}"))?;
    let mend = "save it as CSV UTF-8, which every spreadsheet offers";
    let bytes = in_utf8(bytes);
    let text = std::str::from_utf8(&bytes).map_err(|_| miette!(help = mend, "{name} is no text in UTF-8"))?;
    let text = text.trim_start_matches('\u{feff}');
    let mut reader =
        csv::ReaderBuilder::new().delimiter(delimiter(text)).flexible(true).from_reader(text.as_bytes());
    let fault = |error: csv::Error| miette!("{name}: {error}");
    let heads: Vec<String> =
        reader.headers().map_err(fault)?.iter().map(|head| head.trim().to_owned()).collect();
    check_heads(&heads, path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let (mut tests, mut lines) = (Vec::new(), HashMap::new());
    for row in reader.records() {
        let row = row.map_err(fault)?;
        let line = row.position().map_or(0, csv::Position::line);
        if row.iter().all(|cell| cell.trim().is_empty()) {
            continue;
        }
        let (mend, cells, all) = ("put quotes around a cell that holds a comma", row.len(), heads.len());
        ensure!(cells <= all, help = mend, "{name}, line {line}: {cells} cells, and there are {all} columns");
        let cells: Vec<(&str, &str)> =
            heads.iter().map(String::as_str).zip(row.iter().map(str::trim)).collect();
        let test = parse_row(&cells, folder, cask)
            .ok_or_else(|| miette!("{name}, line {line}: the cell of `recording` is empty"))?;
        let has_id = cells.iter().any(|(head, cell)| *head == ID && !cell.is_empty());
        if let Some(first) = lines.insert(test.id.clone(), line).filter(|_| has_id) {
            let (mend, id) = ("give each row an id of its own, or leave the column out", &test.id);
            return Err(miette!(help = mend, "{name}, line {line}: the id {id} stands in line {first} too"));
        }
        tests.push(test);
    }
    ensure!(!tests.is_empty(), help = "write one row a recording", "{name} lists no recording");
    Ok(tests)
}

fn parse_row(cells: &[(&str, &str)], folder: &Path, cask: Option<&Path>) -> Option<PlannedTest> {
    let cell =
        |name| cells.iter().find(|(head, cell)| *head == name && !cell.is_empty()).map(|(_, cell)| *cell);
    let shown = cell(RECORDING)?.to_owned();
    let recording = folder.join(&shown);
    let (cask_shown, cask) = if let Some(stated) = cell(CASK) {
        (Some(stated.to_owned()), Some(folder.join(stated)))
    } else {
        let found = find_cask_file(&recording, cask);
        let shown = |found: &PathBuf| {
            let is_beside = Some(found.as_path()) != cask;
            if is_beside { Path::new(&shown).with_extension("toml") } else { found.clone() }
                .display()
                .to_string()
        };
        (found.as_ref().map(shown), found)
    };
    let mut test = PlannedTest {
        id: cell(ID).map_or_else(|| stem(&recording), str::to_owned),
        cask_shown,
        cask,
        shown,
        recording,
        ..PlannedTest::default()
    };
    for (head, cell) in
        cells.iter().filter(|(head, cell)| ![ID, RECORDING, CASK].contains(head) && !cell.is_empty())
    {
        let is_key = key_of_column(head).is_ok_and(|key| key.is_some());
        let pairs = if is_key { &mut test.stated } else { &mut test.carried };
        pairs.push(((*head).to_owned(), (*cell).to_owned()));
    }
    Some(test)
}

/// Refuses column heads that are missing, repeated or unknown.
fn check_heads(heads: &[String], path: &Path) -> miette::Result<()> {
    let name = path.display();
    let is_there = heads.iter().any(|head| head == RECORDING);
    let mend = "the first line names the columns: id, recording, cask, and what you like; `dropcheck init \
                FOLDER` writes one";
    ensure!(is_there, help = mend, "{name}, line 1: there is no column `recording`");
    let mut seen = HashSet::new();
    for head in heads {
        let is_new = head.is_empty() || seen.insert(head);
        ensure!(is_new, help = "rename one of them", "{name}, line 1: two columns are named {head}");
        let mend = "a column that is only to be carried into the tables needs a name without that table's \
                    word and a point";
        key_of_column(head).map_err(|problem| miette!(help = mend, "{name}, line 1: {problem}"))?;
    }
    Ok(())
}

/// Writes a manifest of the recordings in a folder, each with the cask file beside it, and columns for the
/// values that most often differ.
pub fn template(folder: &Path) -> miette::Result<Vec<u8>> {
    let mut rows = vec![[ID, RECORDING, CASK, "drop.angle_deg", "test.date"].map(str::to_owned)];
    // A shell has already created the output file.
    let is_empty = |path: &PathBuf| std::fs::metadata(path).is_ok_and(|file| file.len() == 0);
    for recording in recordings_in(folder)? {
        if is_empty(&recording) {
            note(&format!("note: {} is empty and was left out", recording.display()));
            continue;
        }
        let cask = find_cask_file(&recording, None).map(|cask| cask.display().to_string());
        let shown = recording.display().to_string();
        rows.push([stem(&recording), shown, cask.unwrap_or_default(), String::new(), String::new()]);
    }
    Ok(records(rows)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Vec<PlannedTest>, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read(file.path(), None).map_err(|report| report.to_string())
    }

    #[test]
    fn a_spreadsheets_manifest_is_read() {
        let tests = of("\u{feff}recording;cask;drop.angle_deg;Halle\r\n\
             a.mcap;c.toml;12,5;3\r\n;;;\r\nx/b.h5;c.toml;;\r\n")
        .unwrap();
        assert_eq!(tests.len(), 2);
        assert_eq!(tests[0].stated, [("drop.angle_deg".to_owned(), "12,5".to_owned())]);
        assert_eq!(tests[0].carried, [("Halle".to_owned(), "3".to_owned())]);
        assert_eq!((tests[1].id.as_str(), tests[1].stated.len()), ("b", 0));
    }

    #[test]
    fn what_windows_powershell_writes_by_itself_is_read() {
        let wide = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), wide("\u{feff}recording,cask\r\nü.mcap,c.toml\r\n")).unwrap();
        assert_eq!(read(file.path(), None).unwrap()[0].shown, "ü.mcap");
        std::fs::write(file.path(), wide("\u{feff}[cask]\r\nmass = 1\r\n")).unwrap();
        let refused = crate::ingest::cask_file(file.path()).unwrap_err().to_string();
        assert!(refused.contains("line 2: [cask] knows no key mass"), "{refused}");
    }

    #[test]
    fn what_cannot_be_meant_is_named_with_its_line() {
        for (text, part) in [
            ("file,cask\na,b\n", "line 1: there is no column `recording`"),
            ("recording,drop.angel_deg\na,5\n", "did you mean drop.angle_deg?"),
            ("id,recording\n1,a\n1,b\n", "line 3: the id 1 stands in line 2 too"),
            ("id,recording\n1,\n", "line 2: the cell of `recording` is empty"),
            ("id,recording\n1,a,b\n", "line 2: 3 cells"),
            ("recording,recording\na,b\n", "two columns are named recording"),
            ("recording\n", "lists no recording"),
        ] {
            let error = of(text).unwrap_err();
            assert!(error.contains(part), "{error}");
        }
    }
}
