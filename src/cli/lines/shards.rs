//! The shards of a campaign to all of its lines; one that is missing, doubled, cut, foreign or of another
//! version is named.

use super::file::{LineFiles, next_line};
use crate::data::Program;
use crate::ingest::opened;
use miette::miette;
use serde_json::Value;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// What shards must have in common: key of `campaign`, and what another value means.
const COMMON: [(&str, &str); 5] = [
    ("version", "is of another version of dropcheck"),
    ("commit", "is of another build of dropcheck"),
    ("schema", "is of another campaign"),
    ("of", "is of another campaign, or of another state of its manifest or cask file"),
    ("count", "is of another campaign"),
];

/// What a line says of its place in a campaign besides `own`, as JSON: the schema first, by which its file is
/// known, and the program that wrote it.
pub fn place(schema: &str, mut own: Value) -> String {
    let Program { version, commit, .. } = Program::current();
    (own["version"], own["commit"]) = (version.into(), commit.into());
    format!("{{\"schema\":\"{schema}\",{}", &own.to_string()[1..])
}

/// The number of a line, where it is one of `own` and the line says of its place what this run does.
pub fn own_number(line: &Value, own: &[usize], place: impl Fn(usize) -> String) -> Option<usize> {
    let number = whole(&line["campaign"]["number"]).filter(|number| own.binary_search(number).is_ok())?;
    let said: Value = serde_json::from_str(&place(number)).ok()?;
    (line["campaign"] == said).then_some(number)
}

/// A whole number.
fn whole(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

/// The lines of all shards, and what the first of them says of the campaign; `problem` says what makes a line
/// one of none.
pub fn merged(
    shards: &[PathBuf],
    problem: impl Fn(&Value) -> Option<String>,
) -> miette::Result<(LineFiles, Value)> {
    let mut lines = LineFiles::default();
    let mut first: Option<Value> = None;
    // As many as the first line claims.
    let mut all = 0;
    for path in shards {
        schema(path)?;
        lines.add(path, |before, count, bytes| {
            let line: Value = serde_json::from_slice(bytes).unwrap_or_default();
            let own = &line["campaign"];
            let Some(number) = whole(&own["number"]).filter(|_| bytes.ends_with(b"\n")) else {
                return Err(cut(path, count));
            };
            if let Some(problem) = problem(&line) {
                let mend = "run it again: the line was changed, or its disk is damaged";
                return Err(miette!(help = mend, "{}, line {count}: {problem}", path.display()));
            }
            let first = first.get_or_insert_with(|| {
                all = whole(&own["count"]).unwrap_or(0);
                own.clone()
            });
            for (key, words) in COMMON {
                if own[key] != first[key] {
                    let (path, other) = (path.display(), shards[0].display());
                    let mend = "merge shards of one manifest and one version only";
                    let values = format!("{key} {}, there {}", own[key], first[key]);
                    return Err(miette!(help = mend, "{path} {words} than {other} ({values})"));
                }
            }
            match before.home(number) {
                Some(home) => Err(doubled(path, &shards[home], &line)),
                None if number >= all => Err(cut(path, count)),
                None => Ok(Some(number)),
            }
        })?;
    }
    complete(shards, all, &lines)?;
    Ok((lines, first.unwrap_or_default()))
}

/// Names the shards of which something is missing.
fn complete(shards: &[PathBuf], all: usize, lines: &LineFiles) -> miette::Result<()> {
    let count = all - lines.numbers().count();
    if count == 0 {
        return Ok(());
    }
    let missing = lines.numbers().enumerate().find(|(due, own)| due != own);
    let missing = missing.map_or(all - count, |(due, _)| due);
    // Any line says into how many parts its campaign was cut.
    let any = lines.numbers().next().and_then(|number| lines.line(number));
    let parts = any.and_then(|line| whole(&line["campaign"]["shard"][1])).unwrap_or(1).max(1);
    let (own, of_own) = (missing % parts, (missing % parts..all).step_by(parts).len());
    let of_part: Vec<usize> = lines.numbers().filter(|number| number % parts == own).collect();
    let lost = of_own - of_part.len();
    let what = match of_part.first().and_then(|number| lines.home(*number)) {
        None => format!("shard {own}/{parts} is missing"),
        Some(file) => format!(
            "{} is cut: {lost} of the {of_own} lines of shard {own}/{parts} are not in it",
            shards[file].display()
        ),
    };
    let (lost, first) = (format!("{count} of {all} lines are in no shard"), missing + 1);
    let mend = "run that shard again, with --resume what is done is not done again; then name all shards";
    Err(miette!(help = mend, "{what}; {lost}, the first is number {first} of the campaign"))
}

fn cut(path: &Path, line: usize) -> miette::Report {
    let mend = "the run was stopped, or the file was not copied whole: run that shard again with --resume";
    miette!(help = mend, "{}, line {line}: no whole line of a shard", path.display())
}

fn doubled(path: &Path, other: &Path, line: &Value) -> miette::Report {
    let id = ["id", "scene"].iter().find_map(|key| line[key].as_str()).unwrap_or_default();
    let shard = &line["campaign"]["shard"];
    let (path, other, shard) = (path.display(), other.display(), format!("{}/{}", shard[0], shard[1]));
    let mend = "name each shard once";
    miette!(help = mend, "{path} repeats {id} of shard {shard}, which is in {other} already")
}

/// `campaign.schema` of the first line.
pub fn schema(path: &Path) -> miette::Result<String> {
    let unread = |source| miette!("{} cannot be read: {source}", path.display());
    let mut line = Vec::new();
    next_line(&mut BufReader::new(opened(path).map_err(unread)?), &mut line).map_err(unread)?;
    let first: Value = serde_json::from_slice(&line).unwrap_or_default();
    first["campaign"]["schema"].as_str().map(str::to_owned).ok_or_else(|| no_shard(path))
}

/// The refusal of a file that no `--jsonl` of this program wrote.
pub fn no_shard(path: &Path) -> miette::Report {
    let mend = "name what `batch --jsonl FILE` or `validate --campaign N --jsonl FILE` wrote; a run that was \
                stopped goes on with --resume";
    let path = path.display();
    miette!(help = mend, "{path} is no shard of a campaign: its first line does not say of which")
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
    let most = all.max(1);
    let mend = format!("take --shard I/{most} at most; what the other shards wrote can be merged without it");
    Err(miette!(help = mend, "shard {index}/{count} holds none of {all}"))
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
