//! `validate --campaign`: random scenes, one after the other, to lines and tables; and the shards of a
//! campaign to the same tables.

use super::super::Ending;
use super::super::lines::{self, LineOutput, LineRecord};
use super::super::output::{Folder, print};
use crate::lab::campaign::{self, Tally};
use crate::lab::data::{CampaignRequest, CampaignRow};
use clap::Args;
use miette::{IntoDiagnostic, miette};
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The file in a campaign's folder.
const NAME: &str = "campaign.md";

/// Where lines go, one after the other.
type Take<'a> = &'a mut dyn FnMut(&[u8]) -> miette::Result<()>;

/// In which parts a campaign is done.
#[derive(Args)]
pub struct Parts {
    /// One line a scene: what was found beside the truth; with - to standard output, and nothing else there
    #[arg(long, value_name = "FILE|-", requires = "campaign")]
    jsonl: Option<PathBuf>,
    /// Only each N-th scene from number I on, from 0; `dropcheck merge` puts the parts together
    #[arg(long, value_name = "I/N", value_parser = lines::part, default_value = "0/1",
        hide_default_value = true,
        requires = "jsonl", conflicts_with = "out")]
    shard: (usize, usize),
    /// Go on with the lines of --jsonl that an earlier run of the same words has left
    #[arg(long, requires = "jsonl")]
    resume: bool,
}

/// Draws the scenes and writes what is asked for: lines, and the tables, in the folder `out` where one is
/// named.
pub fn run(request: &CampaignRequest, parts: &Parts, out: Option<&Path>) -> miette::Result<Ending> {
    let (index, count) = parts.shard;
    let numbers = campaign::numbers(request);
    lines::holds_some(parts.shard, numbers.len())?;
    let place = |number: usize| {
        let shard = [number % count, count];
        let own = json!({"of": request, "count": numbers.len(), "number": number, "shard": shard});
        lines::place(campaign::SCHEMA, own)
    };
    let own: Vec<usize> = (index..numbers.len()).step_by(count).collect();
    let open = |path: &PathBuf| {
        let own_number = |line: &Value| lines::own_number(line, &own, place).ok_or_else(|| foreign(path));
        LineRecord::open(path, parts.resume, &[], |line| own_number(line).map(Some))
    };
    let file = parts.jsonl.as_ref().filter(|path| *path != Path::new("-")).map(open).transpose()?;
    let mut output = LineOutput::new(file, parts.jsonl.as_deref());
    let make = |number: usize, earlier: Option<&str>| {
        if earlier.is_some_and(|line| campaign::read(line.as_bytes()).is_some()) {
            return Ok(None);
        }
        let row = campaign::row(request, numbers[number]);
        let row = serde_json::to_string(&row).into_diagnostic()?;
        Ok(Some(format!("{{\"campaign\":{},{}\n", place(number), &row[1..])))
    };
    let tables = tabled(request, out, |take| {
        output.each(own.clone(), rayon::current_num_threads(), make, |line| take(line.as_bytes()))
    })?;
    if count > 1 && !output.is_standard_output {
        print(&format!("Shard {index}/{count}; `dropcheck merge` makes the tables of all shards.\n"))?;
    } else if out.is_none() && !output.is_standard_output {
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
    tabled(&request, Some(out), |take| lines.each(take))?;
    print(&format!("Written: {}\n", crate::report::sanitize(&out.join(NAME).display().to_string())))?;
    Ok(Ending::Clear)
}

/// The refusal of a file with lines of other words.
fn foreign(path: &Path) -> miette::Report {
    let (mend, path) = ("name another file, or leave out --resume to begin anew", path.display());
    let other = "another campaign, of another shard of it, or of another build of dropcheck";
    miette!(help = mend, "{path} holds lines of {other}")
}

/// The tables of all lines that `work` hands over, in a folder where one is named.
fn tabled(
    request: &CampaignRequest,
    out: Option<&Path>,
    work: impl FnOnce(Take) -> miette::Result<()>,
) -> miette::Result<String> {
    let folder = out.map(|out| Folder::checked(out, &[NAME], &[])).transpose()?;
    let mut tally = Tally::new(request.clone());
    // As they are written, so that a merge of shards counts the same numbers.
    work(&mut |line| {
        if let Some(row) = campaign::read(line) {
            tally.add(&row);
        }
        Ok(())
    })?;
    let tables = campaign::markdown(&tally);
    if let Some(folder) = folder {
        folder.write(&[(NAME.to_owned(), tables.clone().into_bytes())])?;
    }
    Ok(tables)
}
