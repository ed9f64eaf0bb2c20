//! Merges the shards of a campaign into all of its lines; names a shard that is missing, repeated, cut,
//! unrelated or of another version.

use super::file::{LineFiles, next_line};
use crate::data::Program;
use crate::ingest::opened;
use miette::miette;
use serde_json::Value;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Keys of `campaign` that all shards have in common, and the meaning of another value.
const COMMON: [(&str, &str); 5] = [
    ("version", "is of another version of dropcheck"),
    ("commit", "is of another build of dropcheck"),
    ("schema", "is of another campaign"),
    ("of", "is of another campaign, or of another state of its manifest or cask file"),
    ("count", "is of another campaign"),
];

/// Writes a line's place in a campaign as JSON: the schema first, which identifies the file, then `place` and
/// the program that wrote it.
pub fn place_json(schema: &str, mut place: Value) -> String {
    let Program { version, commit, .. } = Program::current();
    (place["version"], place["commit"]) = (version.into(), commit.into());
    format!("{{\"schema\":\"{schema}\",{}", &place.to_string()[1..])
}

/// Returns the number of a line if it is one of `due` and the line states the same place as this run.
pub fn line_number(line: &Value, due: &[usize], place: impl Fn(usize) -> String) -> Option<usize> {
    let number = whole_number(&line["campaign"]["number"]).filter(|n| due.binary_search(n).is_ok())?;
    let expected: Value = serde_json::from_str(&place(number)).ok()?;
    (line["campaign"] == expected).then_some(number)
}

/// Reads a whole number.
fn whole_number(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

/// Reads the lines of all shards, and the campaign as the first line states it; `problem` describes a line
/// that is not valid.
pub fn merge_shards(
    shards: &[PathBuf],
    problem: impl Fn(&Value) -> Option<String>,
) -> miette::Result<(LineFiles, Value)> {
    let mut lines = LineFiles::default();
    let mut first: Option<Value> = None;
    // Number of lines that the first one states.
    let mut all = 0;
    for path in shards {
        read_schema(path)?;
        lines.add(path, |before, count, bytes| {
            let line: Value = serde_json::from_slice(bytes).unwrap_or_default();
            let place = &line["campaign"];
            let Some(number) = whole_number(&place["number"]).filter(|_| bytes.ends_with(b"\n")) else {
                return Err(refuse_cut_line(path, count));
            };
            if let Some(problem) = problem(&line) {
                let mend = "run it again: the line was changed, or its disk is damaged";
                return Err(miette!(help = mend, "{}, line {count}: {problem}", path.display()));
            }
            let first = first.get_or_insert_with(|| {
                all = whole_number(&place["count"]).unwrap_or(0);
                place.clone()
            });
            for (key, words) in COMMON {
                if place[key] != first[key] {
                    let (path, other) = (path.display(), shards[0].display());
                    let mend = "merge shards of one manifest and one version only";
                    let values = format!("{key} {}, there {}", place[key], first[key]);
                    return Err(miette!(help = mend, "{path} {words} than {other} ({values})"));
                }
            }
            match before.file_index(number) {
                Some(file) => Err(refuse_repeated_line(path, &shards[file], &line)),
                None if number >= all => Err(refuse_cut_line(path, count)),
                None => Ok(Some(number)),
            }
        })?;
    }
    check_complete(shards, all, &lines)?;
    Ok((lines, first.unwrap_or_default()))
}

/// Refuses shards from which lines are missing, and names them.
fn check_complete(shards: &[PathBuf], all: usize, lines: &LineFiles) -> miette::Result<()> {
    let count = all - lines.numbers().count();
    if count == 0 {
        return Ok(());
    }
    let missing = lines.numbers().enumerate().find(|(expected, number)| expected != number);
    let missing = missing.map_or(all - count, |(expected, _)| expected);
    // Any line states the number of parts of its campaign.
    let any = lines.numbers().next().and_then(|number| lines.line(number));
    let parts = any.and_then(|line| whole_number(&line["campaign"]["shard"][1])).unwrap_or(1).max(1);
    let (part, part_count) = (missing % parts, (missing % parts..all).step_by(parts).len());
    let part_numbers: Vec<usize> = lines.numbers().filter(|number| number % parts == part).collect();
    let lost = part_count - part_numbers.len();
    let what = match part_numbers.first().and_then(|number| lines.file_index(*number)) {
        None => format!("shard {part}/{parts} is missing"),
        Some(file) => format!(
            "{} is cut: {lost} of the {part_count} lines of shard {part}/{parts} are not in it",
            shards[file].display()
        ),
    };
    let (lost, first) = (format!("{count} of {all} lines are in no shard"), missing + 1);
    let mend = "run that shard again, with --resume what is done is not done again; then name all shards";
    Err(miette!(help = mend, "{what}; {lost}, the first is number {first} of the campaign"))
}

fn refuse_cut_line(path: &Path, line: usize) -> miette::Report {
    let mend = "the run was stopped, or the file was not copied whole: run that shard again with --resume";
    miette!(help = mend, "{}, line {line}: no whole line of a shard", path.display())
}

fn refuse_repeated_line(path: &Path, other: &Path, line: &Value) -> miette::Report {
    let id = ["id", "scene"].iter().find_map(|key| line[key].as_str()).unwrap_or_default();
    let shard = &line["campaign"]["shard"];
    let (path, other, shard) = (path.display(), other.display(), format!("{}/{}", shard[0], shard[1]));
    let mend = "name each shard once";
    miette!(help = mend, "{path} repeats {id} of shard {shard}, which is in {other} already")
}

/// Reads `campaign.schema` from the first line.
pub fn read_schema(path: &Path) -> miette::Result<String> {
    let unread = |source| miette!("{} cannot be read: {source}", path.display());
    let mut line = Vec::new();
    next_line(&mut BufReader::new(opened(path).map_err(unread)?), &mut line).map_err(unread)?;
    let first: Value = serde_json::from_slice(&line).unwrap_or_default();
    first["campaign"]["schema"].as_str().map(str::to_owned).ok_or_else(|| refuse_other_file(path))
}

/// Refuses a file that no `--jsonl` of this program wrote.
pub fn refuse_other_file(path: &Path) -> miette::Report {
    let mend = "name what `batch --jsonl FILE` or `validate --campaign N --jsonl FILE` wrote; a run that was \
                stopped goes on with --resume";
    let path = path.display();
    miette!(help = mend, "{path} is no shard of a campaign: its first line does not say of which")
}

/// Parses "I/N": part I, from 0, of N.
pub fn parse_shard(text: &str) -> Result<(usize, usize), String> {
    let parts =
        text.split_once('/').and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
    parts
        .filter(|(i, n)| i < n)
        .ok_or_else(|| "I/N with I from 0 to N - 1, such as 0/3, 1/3 and 2/3".to_owned())
}

/// Refuses a shard without any of the `all` lines: its file would be empty, and look as if it had been cut.
pub fn check_shard((index, count): (usize, usize), all: usize) -> miette::Result<()> {
    if index < all.max(1) {
        return Ok(());
    }
    let most = all.max(1);
    let mend = format!("take --shard I/{most} at most; what the other shards wrote can be merged without it");
    Err(miette!(help = mend, "shard {index}/{count} holds none of {all}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_is_counted_from_nought() {
        assert_eq!(parse_shard("2/3"), Ok((2, 3)));
        for text in ["3/3", "1", "-1/3", "0/0", "a/b"] {
            assert!(parse_shard(text).is_err(), "{text}");
        }
    }
}
