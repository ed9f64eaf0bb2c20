//! Writes lines of JSON to a file that grows by one line at a time, and reads such files: finished work is
//! never lost.

use super::super::output::{JsonTarget, read_head, replace_in_pieces};
use crate::ingest::opened;
use miette::{IntoDiagnostic, WrapErr, ensure, miette};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Place of a line: its file, first byte and length in bytes.
#[derive(Debug, Clone, Copy)]
pub struct LinePlace {
    file: usize,
    from: u64,
    length: usize,
}

/// Lines of one or several files, by their numbers in the campaign.
#[derive(Debug, Default, Clone)]
pub struct LineFiles {
    files: Vec<PathBuf>,
    places: BTreeMap<usize, LinePlace>,
}

impl LineFiles {
    /// Adds the lines of a file. `take` gets the lines before, the count from 1 and the text of each, and
    /// returns its number in the campaign; the last line may be incomplete.
    pub fn add(
        &mut self,
        path: &Path,
        mut take: impl FnMut(&Self, usize, &[u8]) -> miette::Result<Option<usize>>,
    ) -> miette::Result<()> {
        let words = || format!("{} cannot be read", path.display());
        let mut reader = BufReader::new(opened(path).into_diagnostic().wrap_err_with(words)?);
        let (mut from, mut line, mut count) = (0, Vec::new(), 0);
        self.files.push(path.to_path_buf());
        loop {
            let length = next_line(&mut reader, &mut line).into_diagnostic().wrap_err_with(words)?;
            if length == 0 {
                return Ok(());
            }
            count += 1;
            if let Some(number) = take(self, count, &line)? {
                self.places.insert(number, LinePlace { file: self.files.len() - 1, from, length });
            }
            from += length as u64;
        }
    }

    /// Lists the numbers that have a line.
    pub fn numbers(&self) -> impl Iterator<Item = usize> {
        self.places.keys().copied()
    }

    /// Index of the file that holds a line.
    pub fn file_index(&self, number: usize) -> Option<usize> {
        self.places.get(&number).map(|place| place.file)
    }

    /// Reads a line, with its line end.
    pub fn text(&self, number: usize) -> Option<String> {
        let place = self.places.get(&number)?;
        let mut file = File::open(&self.files[place.file]).ok()?;
        file.seek(SeekFrom::Start(place.from)).ok()?;
        let mut line = vec![0; place.length];
        file.read_exact(&mut line).ok()?;
        String::from_utf8(line).ok()
    }

    /// Parses a line.
    pub fn line(&self, number: usize) -> Option<Value> {
        serde_json::from_str(&self.text(number)?).ok()
    }

    /// Hands over all lines, sorted by number.
    pub fn for_each(&self, mut take: impl FnMut(&[u8]) -> miette::Result<()>) -> miette::Result<()> {
        for number in self.numbers() {
            let line = self.text(number).ok_or_else(|| miette!("the lines were changed meanwhile"))?;
            take(line.as_bytes())?;
        }
        Ok(())
    }
}

/// File of lines that this run writes.
#[derive(Debug)]
pub struct LineRecord {
    path: PathBuf,
    /// `None` after the lines were put in order.
    file: Option<File>,
    end: u64,
    /// Lines in the file.
    pub lines: LineFiles,
}

impl LineRecord {
    /// Begins the file, or continues an existing one: `number_of` returns the number of a line in this
    /// campaign, `None` if the line must be made again.
    pub fn open(
        path: &Path,
        resume: bool,
        inputs: &[&Path],
        number_of: impl Fn(&Value) -> miette::Result<Option<usize>>,
    ) -> miette::Result<Self> {
        let mut file = open_locked(path, inputs)?;
        let (mut lines, mut end) = (LineFiles::default(), 0);
        if resume {
            lines.add(path, |_, _, line| {
                // The run was stopped while it wrote this last line.
                if !line.ends_with(b"\n") {
                    return Ok(None);
                }
                end += line.len() as u64;
                number_of(&serde_json::from_slice(line).unwrap_or_default())
            })?;
        } else {
            lines.files.push(path.to_path_buf());
        }
        let prepared = file.set_len(end).and_then(|()| file.seek(SeekFrom::Start(end)));
        prepared.into_diagnostic().wrap_err_with(|| format!("{} cannot be written", path.display()))?;
        Ok(Self { path: path.to_path_buf(), file: Some(file), end, lines })
    }

    /// Appends one line.
    pub fn append(&mut self, number: usize, line: &[u8]) -> miette::Result<()> {
        let file = self.file.as_mut().ok_or_else(|| io::Error::other("it was closed"));
        let written = file.and_then(|file| file.write_all(line)).into_diagnostic();
        written.wrap_err_with(|| format!("{} could not be written", self.path.display()))?;
        self.lines.places.insert(number, LinePlace { file: 0, from: self.end, length: line.len() });
        self.end += line.len() as u64;
        Ok(())
    }

    /// Sorts the lines and drops others, if a run that was stopped left them so.
    pub fn finish(&mut self) -> miette::Result<()> {
        let mut due = 0;
        let is_next = |place: &LinePlace| {
            let is_next = place.from == due;
            due += place.length as u64;
            is_next
        };
        if self.lines.places.values().all(is_next) && due == self.end {
            return Ok(());
        }
        replace_in_pieces(&self.path, |write| {
            self.lines.for_each(write)?;
            // Windows does not replace an open file.
            self.file = None;
            Ok(())
        })?;
        let mut numbers = std::mem::take(&mut self.lines).places.into_keys();
        self.lines.add(&self.path, |_, _, _| Ok(numbers.next()))
    }
}

/// Number of attempts to open a file that another run holds, and the time between them.
const TRIES: u32 = 20;
const RETRY_AFTER: Duration = Duration::from_millis(100);

/// Beginning of every line that `--jsonl` writes: the key `campaign` is first, and its `schema` first in it.
const MARK: &[u8] = b"{\"campaign\":{\"schema\":\"dropcheck.";

/// True if a file holds such lines; the first may have been cut short.
pub fn is_line_file(path: &Path) -> bool {
    read_head(path, MARK.len() as u64).is_ok_and(|head| MARK.starts_with(&head))
}

/// Opens and locks the file, to append lines. A file not written by dropcheck is treated like any other
/// output target.
fn open_locked(path: &Path, inputs: &[&Path]) -> miette::Result<File> {
    if path.is_symlink() || !is_line_file(path) {
        JsonTarget::prepare(Some(path), inputs)?;
    }
    // A process that a killed run had started may hold it for a moment longer.
    let is_held = |file: &io::Result<File>| file.as_ref().is_err_and(|e| e.kind() == ErrorKind::WouldBlock);
    let mut file = open_exclusively(path);
    for _ in 0..TRIES {
        if is_held(&file) {
            std::thread::sleep(RETRY_AFTER);
            file = open_exclusively(path);
        }
    }
    ensure!(!is_held(&file), help = "wait for it, or end it", "another run is writing {}", path.display());
    let file = file.into_diagnostic().wrap_err_with(|| format!("{} cannot be written", path.display()))?;
    let is_file = file.metadata().is_ok_and(|there| there.is_file());
    let help = "name a file; --jsonl - writes to standard output";
    ensure!(is_file, help = help, "{} is a pipe or a device", path.display());
    Ok(file)
}

/// Opens the file so that no other run can write it meanwhile; `WouldBlock` if another run has it.
fn open_exclusively(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    // The file is not opened for appending, since Windows cannot shorten such a file.
    options.read(true).write(true).create(true).truncate(false);
    #[cfg(windows)]
    {
        // Others may read and replace it. A lock would prevent this run from reading it by another handle.
        const SHARED: u32 = 0x1 | 0x4;
        const SHARING_VIOLATION: i32 = 32;
        std::os::windows::fs::OpenOptionsExt::share_mode(&mut options, SHARED);
        let is_held = |fault: &io::Error| fault.raw_os_error() == Some(SHARING_VIOLATION);
        options.open(path).map_err(|e| if is_held(&e) { ErrorKind::WouldBlock.into() } else { e })
    }
    #[cfg(not(windows))]
    {
        let file = options.open(path)?;
        // This works if the file system supports locks.
        let is_held = matches!(file.try_lock(), Err(std::fs::TryLockError::WouldBlock));
        if is_held { Err(ErrorKind::WouldBlock.into()) } else { Ok(file) }
    }
}

/// Longest line of a result, bytes.
const MOST_LINE_BYTES: u64 = 32 << 20;

/// Reads the next line into `line`, with its line end, and returns its length: 0 at the end of the file.
pub(super) fn next_line(reader: &mut impl BufRead, line: &mut Vec<u8>) -> io::Result<usize> {
    line.clear();
    let length = reader.take(MOST_LINE_BYTES).read_until(b'\n', line)?;
    let is_whole = (length as u64) < MOST_LINE_BYTES;
    is_whole.then_some(length).ok_or_else(|| io::Error::other("one of its lines has more than 32 MiB"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(number: usize, words: &str) -> Vec<u8> {
        format!("{{\"campaign\":{{\"schema\":\"dropcheck.x/1\"}},\"n\":{number},\"w\":\"{words}\"}}\n")
            .into_bytes()
    }

    #[allow(clippy::unnecessary_wraps, reason = "as it is asked for")]
    fn own(line: &Value) -> miette::Result<Option<usize>> {
        Ok(line["n"].as_u64().and_then(|n| usize::try_from(n).ok()))
    }

    #[test]
    fn a_torn_end_is_cut_off_and_lines_come_back_in_order() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        let mut record = LineRecord::open(&path, false, &[], own).unwrap();
        for number in [0, 3] {
            record.append(number, &line(number, "first")).unwrap();
        }
        assert!(LineRecord::open(&path, true, &[], own).is_err(), "two runs write one file");
        drop(record);
        let mut file = OpenOptions::new().append(true).open(&path).unwrap();
        file.write_all(&line(1, "torn")[..20]).unwrap();
        let mut record = LineRecord::open(&path, true, &[], own).unwrap();
        assert!(record.lines.line(3).is_some() && record.lines.line(1).is_none());
        for number in [1, 2, 3] {
            record.append(number, &line(number, "again")).unwrap();
        }
        record.finish().unwrap();
        let expected = [line(0, "first"), line(1, "again"), line(2, "again"), line(3, "again")].concat();
        assert_eq!(std::fs::read(&path).unwrap(), expected);
        assert_eq!(record.lines.line(2).unwrap()["w"], "again");
    }
}
