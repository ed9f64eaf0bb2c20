//! `validate --campaign`: random scenes, one after the other, to lines, a CSV and tables; and the shards of a campaign to the same.

use super::super::Ending;
use super::super::output::{Folder, print, print_plain, replace, replace_by};
use super::super::progress::CountedProgress;
use super::super::shard;
use super::document::Marks;
use super::shards::{SceneLines, Shards};
use clap::Args;
use dropcheck::lab::campaign::{self, ScenePlace, Tally};
use dropcheck::lab::data::{CampaignRequest, CampaignRow, CampaignShard};
use miette::IntoDiagnostic;
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
    #[arg(long, value_name = "I/N", value_parser = shard::part, default_value = "0/1", hide_default_value = true,
        requires = "jsonl", conflicts_with_all = ["out", "into"])]
    shard: (usize, usize),
    /// Go on with the lines of --jsonl that an earlier run of the same words has left
    #[arg(long, requires = "jsonl")]
    resume: bool,
}

/// Draws the scenes and writes what is asked for: lines, the files of the folder `out`, the tables in the document `into`.
pub fn run(
    request: &CampaignRequest,
    parts: &Parts,
    out: Option<&Path>,
    into: Option<&Path>,
) -> miette::Result<Ending> {
    let (index, count) = parts.shard;
    let place = ScenePlace::first(request, CampaignShard { index, count });
    shard::holds_some(parts.shard, place.count)?;
    let document = into.map(|path| MARKS.parts(path).map(|around| (path, around))).transpose()?;
    let to_standard_output = parts.jsonl.as_deref() == Some(Path::new("-"));
    let file = parts.jsonl.as_deref().filter(|_| !to_standard_output);
    let mut file = file.map(|path| SceneLines::open(path, parts.resume)).transpose()?;
    let tables = tabled(request, out, |take| {
        let own = place.count.saturating_sub(index).div_ceil(count);
        let mut progress = CountedProgress::of(own, file.is_some());
        let mut done = 0;
        if let Some(file) = &mut file {
            done = file.take_over(&place, |row| {
                progress.step();
                take(row)
            })?;
        }
        campaign::each(request, CampaignShard { index, count }, done, |number, row| {
            let line = campaign::line(&place.at(number), &row).into_diagnostic()?;
            if let Some(file) = &mut file {
                file.put(line.as_bytes())?;
            }
            if to_standard_output {
                print_plain(line.as_bytes())?;
            }
            progress.step();
            // As it is written, so that a merge of shards counts the same numbers.
            let read = campaign::read(line.as_bytes());
            read.map_or(Ok(()), |(_, row)| take(&row))
        })?;
        Ok(())
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
    let shards = Shards::open(paths)?;
    let request = shards.request().clone();
    tabled(&request, Some(out), |take| shards.each(take))?;
    print(&format!(
        "Written: {}\n",
        dropcheck::report::printable(&out.join(NAMES[1]).display().to_string())
    ))?;
    Ok(Ending::Clear)
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
