//! A file of lines, as `--jsonl` writes it, to what its lines are of.

use super::output::JsonTarget;
use dropcheck::ingest::opened;
use miette::{IntoDiagnostic, WrapErr};
use serde_json::Value;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;
use std::time::Duration;

/// How often, and after how long, a file that another run holds is tried again.
const TRIES: u32 = 20;
const AGAIN: Duration = Duration::from_millis(100);

/// How every line begins that `--jsonl` writes: the key `campaign` comes first, its `schema` first in it.
const MARK: &[u8] = b"{\"campaign\":{\"schema\":\"dropcheck.";

/// Whether a file holds such lines; the first may have been cut short.
pub fn is_own(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = opened(path).and_then(|file| file.take(MARK.len() as u64).read_to_end(&mut head));
    read.is_ok() && MARK.starts_with(&head)
}

/// The file for this run to write lines at its end, and for no other meanwhile; what is none of this program is looked at as any target is.
pub fn held(path: &Path, inputs: &[&Path]) -> miette::Result<File> {
    if path.is_symlink() || !is_own(path) {
        JsonTarget::checked(Some(path), inputs)?;
    }
    let file = OpenOptions::new().read(true).append(true).create(true).open(path).into_diagnostic();
    let file = file.wrap_err_with(|| format!("{} cannot be written", path.display()))?;
    if !file.metadata().is_ok_and(|there| there.is_file()) {
        let help = "name a file; --jsonl - writes to standard output";
        return Err(miette::miette!(help = help, "{} is a pipe or a device", path.display()));
    }
    // What a killed run had begun to start may hold it for a moment longer.
    let is_held = || matches!(file.try_lock(), Err(TryLockError::WouldBlock));
    let waits = || {
        std::thread::sleep(AGAIN);
        is_held()
    };
    if is_held() && (0..TRIES).all(|_| waits()) {
        let help = "wait for it, or end it";
        return Err(miette::miette!(help = help, "another run is writing {}", path.display()));
    }
    Ok(file)
}

/// A longer line is none of a result.
const MOST_LINE_BYTES: u64 = 32 << 20;

/// Puts the next line into `line`, with its end, and says how long it is: 0 where there is none.
pub fn next_line(reader: &mut impl BufRead, line: &mut Vec<u8>) -> io::Result<usize> {
    line.clear();
    let length = reader.take(MOST_LINE_BYTES).read_until(b'\n', line)?;
    let is_whole = (length as u64) < MOST_LINE_BYTES;
    is_whole.then_some(length).ok_or_else(|| io::Error::other("one of its lines has more than 32 MiB"))
}

/// Leaves so many bytes of a file of lines that this run holds.
pub fn keep(file: &File, path: &Path, bytes: u64) -> miette::Result<()> {
    file.set_len(bytes).into_diagnostic().wrap_err_with(|| format!("{} cannot be written", path.display()))
}

/// `campaign.schema` of the first line.
pub fn schema(path: &Path) -> miette::Result<String> {
    let unread = |source| miette::miette!("{} cannot be read: {source}", path.display());
    let mut line = Vec::new();
    next_line(&mut BufReader::new(opened(path).map_err(unread)?), &mut line).map_err(unread)?;
    let first: Value = serde_json::from_slice(&line).unwrap_or_default();
    first["campaign"]["schema"].as_str().map(str::to_owned).ok_or_else(|| no_shard(path))
}

/// The refusal of a file that no `--jsonl` of this program wrote.
pub fn no_shard(path: &Path) -> miette::Report {
    miette::miette!(
        help = "name what `batch --jsonl FILE` or `validate --campaign N --jsonl FILE` wrote; a run that was stopped goes on with --resume",
        "{} is no shard of a campaign: its first line does not say of which",
        path.display()
    )
}

/// "I/N": part I, from 0, of N.
pub fn part(text: &str) -> Result<(usize, usize), String> {
    let parts =
        text.split_once('/').and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
    parts
        .filter(|(i, n)| i < n)
        .ok_or_else(|| "I/N with I from 0 to N - 1, such as 0/3, 1/3 and 2/3".to_owned())
}

/// Refuses a shard that holds nothing of so many: its file would be empty, and like one that was cut.
pub fn holds_some((index, count): (usize, usize), all: usize) -> miette::Result<()> {
    if index < all.max(1) {
        return Ok(());
    }
    let help = format!(
        "take --shard I/{} at most; what the other shards wrote can be merged without it",
        all.max(1)
    );
    Err(miette::miette!(help = help, "shard {index}/{count} holds none of {all}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_is_counted_from_nought() {
        assert_eq!(part("2/3"), Ok((2, 3)));
        for text in ["3/3", "1", "-1/3", "0/0", "a/b"] {
            assert!(part(text).is_err(), "{text}");
        }
    }
}
