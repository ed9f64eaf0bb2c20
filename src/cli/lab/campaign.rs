//! `validate --campaign`: random scenes, one after the other, to lines, a CSV and tables; and the shards of a
//! campaign to the same.

use super::super::Ending;
use super::super::lines::{self, LineRecord};
use super::super::output::{Folder, print, print_plain, replace, replace_by};
use super::super::progress::CountedProgress;
use super::document::Marks;
use crate::lab::campaign::{self, ScenePlace, Tally};
use crate::lab::data::{CampaignRequest, CampaignRow, CampaignShard};
use clap::Args;
use miette::IntoDiagnostic;
use serde::Deserialize;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What the tables stand between in a document.
const MARKS: Marks = Marks { begin: "<!-- campaign: begin -->", end: "<!-- campaign: end -->" };

/// Files of a campaign's folder.
const NAMES: [&str; 2] = ["campaign.csv", "campaign.md"];

/// Where rows go, one after the other.
type Take<'a> = &'a mut dyn FnMut(&CampaignRow) -> miette::Result<()>;

/// In which parts a campaign is done.
#[derive(Args)]
pub struct Parts {
    /// One line a scene: what was found beside the truth; with - to standard output, and nothing else there
    #[arg(long, value_name = "FILE|-", requires = "campaign")]
    jsonl: Option<PathBuf>,
    /// Only each N-th scene from number I on, from 0; `dropcheck merge` puts the parts together
    #[arg(long, value_name = "I/N", value_parser = lines::part, default_value = "0/1", hide_default_value = true,
        requires = "jsonl", conflicts_with_all = ["out", "into"])]
    shard: (usize, usize),
    /// Go on with the lines of --jsonl that an earlier run of the same words has left
    #[arg(long, requires = "jsonl")]
    resume: bool,
}

/// Draws the scenes and writes what is asked for: lines, the files of the folder `out`, the tables in the
/// document `into`.
pub fn run(
    request: &CampaignRequest,
    parts: &Parts,
    out: Option<&Path>,
    into: Option<&Path>,
) -> miette::Result<Ending> {
    let (index, count) = parts.shard;
    let place = ScenePlace::first(request, CampaignShard { index, count });
    lines::holds_some(parts.shard, place.count)?;
    let document = into.map(|path| MARKS.parts(path).map(|around| (path, around))).transpose()?;
    let to_standard_output = parts.jsonl.as_deref() == Some(Path::new("-"));
    let file = parts.jsonl.as_deref().filter(|_| !to_standard_output);
    let open =
        |path| LineRecord::open(path, parts.resume, &[], |line| own_number(&place, path, line).map(Some));
    let mut file = file.map(open).transpose()?;
    let tables = tabled(request, out, |take| {
        let own = place.count.saturating_sub(index).div_ceil(count);
        let mut progress = CountedProgress::of(own, file.is_some());
        let mut done = 0;
        let earlier = file.as_ref().map(|file| file.lines().clone()).unwrap_or_default();
        while let Some(row) =
            earlier.text(index + done * count).and_then(|line| campaign::read(line.as_bytes()))
        {
            progress.step();
            take(&row)?;
            done += 1;
        }
        campaign::each(request, CampaignShard { index, count }, done, |number, row| {
            let line = campaign::line(&place.at(number), &row).into_diagnostic()?;
            if let Some(file) = &mut file {
                file.put(number, line.as_bytes())?;
            }
            if to_standard_output {
                print_plain(line.as_bytes())?;
            }
            progress.step();
            // As it is written, so that a merge of shards counts the same numbers.
            campaign::read(line.as_bytes()).map_or(Ok(()), |row| take(&row))
        })?;
        file.as_mut().map_or(Ok(()), LineRecord::finish)
    })?;
    if let Some((path, (before, after))) = &document {
        replace(path, format!("{before}\n{tables}{after}").as_bytes())?;
    }
    if count > 1 && !to_standard_output {
        print(&format!("Shard {index}/{count}; `dropcheck merge` makes the tables of all shards.\n"))?;
    } else if out.is_none() && document.is_none() && !to_standard_output {
        print(&tables)?;
    }
    Ok(Ending::Clear)
}

/// The campaign's files of all its shards.
pub fn merge(paths: &[PathBuf], out: &Path) -> miette::Result<Ending> {
    let is_none =
        |line: &Value| CampaignRow::deserialize(line).is_err().then(|| "is no line of a campaign".to_owned());
    let (lines, first) = lines::merged(paths, is_none)?;
    let request: CampaignRequest = serde_json::from_value(first["of"].clone()).into_diagnostic()?;
    tabled(&request, Some(out), |take| {
        lines.each(|line| campaign::read(line).map_or(Ok(()), |row| take(&row)))
    })?;
    print(&format!("Written: {}\n", crate::report::printable(&out.join(NAMES[1]).display().to_string())))?;
    Ok(Ending::Clear)
}

/// The number of a line that an earlier run of the same words has left in the file at `path`.
fn own_number(place: &ScenePlace, path: &Path, line: &Value) -> miette::Result<usize> {
    let number = line["campaign"]["number"].as_u64().and_then(|number| usize::try_from(number).ok());
    let is_own = |number: &usize| {
        let own = place.at(*number);
        let is_here = *number < place.count && own.shard == place.shard;
        is_here && serde_json::to_value(own).is_ok_and(|own| line["campaign"] == own)
    };
    number.filter(is_own).ok_or_else(|| {
        miette::miette!(
            help = "name another file, or leave out --resume to begin anew",
            "{} holds lines of another campaign, of another shard of it, or of another build of dropcheck",
            path.display()
        )
    })
}

/// The tables of all rows that `work` hands over, in a folder beside the rows as CSV where one is named.
fn tabled(
    request: &CampaignRequest,
    out: Option<&Path>,
    work: impl FnOnce(Take) -> miette::Result<()>,
) -> miette::Result<String> {
    let mut tally = Tally::new(request.clone());
    let Some(out) = out else {
        work(&mut |row| {
            tally.add(row);
            Ok(())
        })?;
        return Ok(campaign::markdown(&tally));
    };
    Folder::checked(out, &NAMES, &[])?.make()?;
    let mut is_first = true;
    replace_by(&out.join(NAMES[0]), |write| {
        work(&mut |row| {
            tally.add(row);
            write(&campaign::csv(row, std::mem::take(&mut is_first))?)
        })
    })?;
    let tables = campaign::markdown(&tally);
    replace(&out.join(NAMES[1]), tables.as_bytes())?;
    Ok(tables)
}

/// The words for kinds in one order and each once, so that shards of the same campaign say the same.
pub fn words(kinds: &[&'static str]) -> Vec<String> {
    let mut words: Vec<String> = kinds.iter().map(|word| (*word).to_owned()).collect();
    words.sort();
    words.dedup();
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_said_in_one_order() {
        assert_eq!(words(&["skew", "hum", "skew"]), ["hum", "skew"]);
    }
}
