//! `merge`: the shards of a campaign, as `--jsonl` wrote them on any machines, to the files that one run would have written.

use super::{Ending, batch};
use clap::Args;
use serde_json::Value;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(after_help = "Example:\n  dropcheck merge shard-*.jsonl --out campaign")]
pub struct Arguments {
    /// What `--jsonl` wrote, of every shard
    #[arg(required = true, value_name = "SHARD.jsonl")]
    shards: Vec<PathBuf>,
    /// Folder for the campaign's files
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Exit status 0 also where results want a look; 2 stays for what could not be analysed
    #[arg(long)]
    exit_zero: bool,
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    let (shards, out) = (&arguments.shards[..], arguments.out.as_path());
    let ending = match schema(&shards[0])?.as_str() {
        batch::SHARD_SCHEMA => batch::merge(shards, out)?,
        _ => return Err(no_shard(&shards[0])),
    };
    Ok(ending.or_zero(arguments.exit_zero))
}

/// What every line of a shard says it is a part of: `campaign.schema` of its first.
fn schema(shard: &Path) -> miette::Result<String> {
    let name = shard.display();
    let file = File::open(shard).map_err(|source| miette::miette!("{name} cannot be read: {source}"))?;
    let mut line = Vec::new();
    let read = BufReader::new(file).read_until(b'\n', &mut line);
    read.map_err(|source| miette::miette!("{name} cannot be read: {source}"))?;
    let first: Value = serde_json::from_slice(&line).unwrap_or_default();
    first["campaign"]["schema"].as_str().map(str::to_owned).ok_or_else(|| no_shard(shard))
}

/// The refusal of a file that no `--jsonl` of this program wrote.
pub fn no_shard(shard: &Path) -> miette::Report {
    miette::miette!(
        help = "name what `batch --jsonl FILE` or `validate --campaign N --jsonl FILE` wrote",
        "{} is no shard of a campaign: its first line does not say of which",
        shard.display()
    )
}
