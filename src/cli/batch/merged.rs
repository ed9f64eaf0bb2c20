//! The shards of a campaign to all of its lines; one that is missing, doubled, cut, foreign or of another version is named.

use super::record::LineFiles;
use dropcheck::report;
use dropcheck::report::Batch;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What shards must have in common: key of `campaign`, and what another value means.
const COMMON: [(&str, &str); 5] = [
    ("version", "is of another version of dropcheck"),
    ("commit", "is of another build of dropcheck"),
    ("schema", "is of another campaign"),
    ("of", "is of another campaign, or of another state of its manifest or cask file"),
    ("count", "is of another campaign"),
];

/// The lines of all shards, and the campaign that they make.
pub fn all(shards: &[PathBuf]) -> miette::Result<(LineFiles, Batch)> {
    let mut lines = LineFiles::default();
    let mut first: Option<Value> = None;
    // As many as the first line claims.
    let mut all = 0;
    for path in shards {
        let mut found = 0;
        lines.add(path, |before, count, bytes| {
            let line: Value = serde_json::from_slice(bytes).unwrap_or_default();
            if let Some(problem) = report::impossible(&line) {
                let mend = "run that recording again: the line was changed, or its disk is damaged";
                return Err(refused(mend, &format!("{}, line {count}: {problem}", path.display())));
            }
            let own = &line["campaign"];
            let number = own["number"].as_u64().and_then(|number| usize::try_from(number).ok());
            let Some(number) = number.filter(|_| bytes.ends_with(b"\n")) else {
                return Err(cut(path, count));
            };
            let first = first.get_or_insert_with(|| {
                all = own["count"].as_u64().and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
                own.clone()
            });
            for (key, words) in COMMON {
                if own[key] != first[key] {
                    let (path, other) = (path.display(), shards[0].display());
                    let problem =
                        format!("{path} {words} than {other} ({key} {}, there {})", own[key], first[key]);
                    return Err(refused("merge shards of one manifest and one version only", &problem));
                }
            }
            found += 1;
            match before.home(number) {
                Some(home) => Err(doubled(path, &shards[home], &line)),
                None if number >= all => Err(cut(path, count)),
                None => Ok(Some(number)),
            }
        })?;
        if found == 0 {
            return Err(super::super::shard::no_shard(path));
        }
    }
    complete(shards, all, &lines)?;
    let mut batch = Batch::new(first.unwrap_or_default()["source"].as_str().unwrap_or_default().to_owned());
    lines.each(|line| {
        batch.add(&serde_json::from_slice(line).unwrap_or_default());
        Ok(())
    })?;
    Ok((lines, batch))
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
    let parts =
        lines.numbers().next().and_then(|number| lines.line(number)?["campaign"]["shard"][1].as_u64());
    let parts = parts.map_or(1, |parts| usize::try_from(parts).unwrap_or(1)).max(1);
    let (own, of_own) = (missing % parts, (missing % parts..all).step_by(parts).len());
    let of_part: Vec<usize> = lines.numbers().filter(|number| number % parts == own).collect();
    let lost = of_own - of_part.len();
    let what = match of_part.first().and_then(|number| lines.home(*number)) {
        None => format!("shard {own}/{parts} is missing"),
        Some(file) => format!(
            "{} is cut: {lost} of the {of_own} recordings of shard {own}/{parts} are not in it",
            shards[file].display()
        ),
    };
    Err(miette::miette!(
        help = "run that shard again, with --resume what is done is not done again; then name all shards",
        "{what}; {count} of {} recordings are in no shard, the first is number {} of the campaign",
        all,
        missing + 1
    ))
}

fn refused(mend: &'static str, problem: &str) -> miette::Report {
    miette::miette!(help = mend, "{problem}")
}

fn cut(path: &Path, line: usize) -> miette::Report {
    let mend = "the run was stopped, or the file was not copied whole: run that shard again with --resume";
    refused(mend, &format!("{}, line {line}: no whole line of a shard", path.display()))
}

fn doubled(path: &Path, other: &Path, line: &Value) -> miette::Report {
    let (id, shard) = (line["id"].as_str().unwrap_or_default(), &line["campaign"]["shard"]);
    let (path, other) = (path.display(), other.display());
    let problem =
        format!("{path} repeats {id} of shard {}/{}, which is in {other} already", shard[0], shard[1]);
    refused("name each shard once", &problem)
}
