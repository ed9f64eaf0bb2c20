//! `validate --campaign`: analyses random scenes one after the other into lines and tables; and merges the
//! shards of a campaign into the same tables.

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

/// File in a campaign's folder.
const NAME: &str = "campaign.md";

/// Receives lines, one after the other.
type LineSink<'a> = &'a mut dyn FnMut(&[u8]) -> miette::Result<()>;

/// Parts in which a campaign is done.
#[derive(Args)]
pub struct CampaignParts {
    /// One line a scene: what was found beside the truth; with - to standard output, and nothing else there
    #[arg(long, value_name = "FILE|-", requires = "campaign")]
    jsonl: Option<PathBuf>,
    /// Only each N-th scene from number I on, from 0; `dropcheck merge` puts the parts together
    #[arg(long, value_name = "I/N", value_parser = lines::parse_shard, default_value = "0/1",
        hide_default_value = true,
        requires = "jsonl", conflicts_with = "out")]
    shard: (usize, usize),
    /// Go on with the lines of --jsonl that an earlier run of the same words has left
    #[arg(long, requires = "jsonl")]
    resume: bool,
}

/// Draws the scenes and writes the lines, and the tables into the folder `out` if one is given.
pub fn run(request: &CampaignRequest, parts: &CampaignParts, out: Option<&Path>) -> miette::Result<Ending> {
    let (index, count) = parts.shard;
    let numbers = campaign::numbers(request);
    lines::check_shard(parts.shard, numbers.len())?;
    let place = |number: usize| {
        let shard = [number % count, count];
        let place = json!({"of": request, "count": numbers.len(), "number": number, "shard": shard});
        lines::place_json(campaign::SCHEMA, place)
    };
    let due: Vec<usize> = (index..numbers.len()).step_by(count).collect();
    let open = |path: &PathBuf| {
        let number = |line: &Value| lines::line_number(line, &due, place).ok_or_else(|| refuse_other(path));
        LineRecord::open(path, parts.resume, &[], |line| number(line).map(Some))
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
    let tables = make_tables(request, out, |take| {
        output.write_lines(due.clone(), rayon::current_num_threads(), make, |line| take(line.as_bytes()))
    })?;
    if count > 1 && !output.is_standard_output {
        print(&format!("Shard {index}/{count}; `dropcheck merge` makes the tables of all shards.\n"))?;
    } else if out.is_none() && !output.is_standard_output {
        print(&tables)?;
    }
    Ok(Ending::Clear)
}

/// Writes the tables of the campaign from all its shards.
pub fn merge(paths: &[PathBuf], out: &Path) -> miette::Result<Ending> {
    let is_none =
        |line: &Value| CampaignRow::deserialize(line).is_err().then(|| "is no line of a campaign".to_owned());
    let (lines, first) = lines::merge_shards(paths, is_none)?;
    let request: CampaignRequest = serde_json::from_value(first["of"].clone()).into_diagnostic()?;
    make_tables(&request, Some(out), |take| lines.for_each(take))?;
    print(&format!("Written: {}\n", crate::report::sanitize(&out.join(NAME).display().to_string())))?;
    Ok(Ending::Clear)
}

/// Refuses a file with lines of another campaign.
fn refuse_other(path: &Path) -> miette::Report {
    let (mend, path) = ("name another file, or leave out --resume to begin anew", path.display());
    let other = "another campaign, of another shard of it, or of another build of dropcheck";
    miette!(help = mend, "{path} holds lines of {other}")
}

/// Makes the tables of all lines that `work` hands over, and writes them if a folder is given.
fn make_tables(
    request: &CampaignRequest,
    out: Option<&Path>,
    work: impl FnOnce(LineSink) -> miette::Result<()>,
) -> miette::Result<String> {
    let folder = out.map(|out| Folder::prepare(out, &[NAME], &[])).transpose()?;
    let mut tally = Tally::new(request.clone());
    // The lines are counted as written, so that merged shards count the same numbers.
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
